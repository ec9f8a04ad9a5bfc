"""Measure everything that docs/rigid-chain.md says: ``python -m benchmarks.chain [--write]``.

Runs ``benchmarks.chain.fit``, ``.poses``, ``.relations`` and ``.process`` one after the other, some
two hours; each can be run by itself. With --write their tables go into the page. Exit status 1 if
a row does not hold what is demanded.
"""

from __future__ import annotations

import argparse
import subprocess
import sys

TABLES = ("fit", "poses", "relations", "process")


def main() -> int:
    """Run every table in a process of its own; return 1 if a row of one does not hold."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--write", action="store_true", help="put the tables into the page")
    options = sys.argv[1:] if parser.parse_args().write else []
    ends = [
        subprocess.run([sys.executable, "-m", f"benchmarks.chain.{name}", *options], check=False)
        for name in TABLES
    ]
    return int(any(end.returncode != 0 for end in ends))


if __name__ == "__main__":
    sys.exit(main())
