"""Plant mutations one by one and print which of them the tests notice.

``python -m tests.mutations --help`` tells the options. Exit status 0: all are killed, or listed as
equivalent; 1: one survived; 2: one is stale or could not be tested.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tests.mutations.catalogue import MUTATIONS
from tests.mutations.run import report, run, share_of, stale


def main(arguments: list[str] | None = None) -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutations", description=__doc__)
    parser.add_argument("--jobs", type=int, default=2, help="processes (default 2)")
    parser.add_argument("--share", type=float, default=1.0, help="try this share of them, 0 to 1")
    parser.add_argument("--seed", type=int, default=0, help="which share (default 0)")
    parser.add_argument("--only", default="", help="try those whose file or text contains this")
    parser.add_argument("--out", type=Path, help="write the table to this file too")
    options = parser.parse_args(arguments)
    if options.jobs < 1 or not 0.0 < options.share <= 1.0:
        parser.error("--jobs is at least 1, --share a number above 0, at most 1")
    wrong = stale(MUTATIONS)
    if wrong:
        print("\n".join(wrong), file=sys.stderr)
        return 2
    chosen = share_of(MUTATIONS, options.share, options.seed)
    chosen = [m for m in chosen if options.only in f"{m.file} {m.original} {m.tests}"]
    if not chosen:
        parser.error(f"no mutation contains {options.only!r}")
    results, status = run(chosen, options.jobs, lambda line: print(line, flush=True))
    text = report(results, options.jobs)
    print(text)
    if options.out is not None:
        options.out.write_text(text, encoding="utf-8")
    return status


if __name__ == "__main__":
    sys.exit(main())
