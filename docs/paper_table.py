"""Put the table of ``isotorque paper`` into docs/paper.md: ``python -m docs.paper_table DIR``."""

from __future__ import annotations

import sys
from pathlib import Path

from isotorque.paper.table.text import with_table

PAGE = Path(__file__).parent / "paper.md"


def main(arguments: list[str]) -> int:
    """Take the table from ``DIR/paper.md``, which `isotorque paper all --out DIR` wrote."""
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    table = (Path(arguments[0]) / "paper.md").read_text(encoding="utf-8").strip()
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8"), table), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
