"""Output of commands: JSON or text on standard output, everything else on standard error."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from isotorque.plain import plain


def emit_json(document: Any) -> None:
    """Print one JSON document on standard output."""
    json.dump(plain(document), sys.stdout, indent=1, allow_nan=False)
    sys.stdout.write("\n")


def say(message: str, quiet: bool = False) -> None:
    """Print a message on standard error."""
    if not quiet:
        print(message, file=sys.stderr)


def say_if_first(quiet: bool) -> None:
    """Tell who waits at a terminal that the first use compiles what moves and learns."""
    if quiet or not sys.stderr.isatty():
        return
    from isotorque.learning.simulator.compiled import engine
    from isotorque.symbolic.common.compiled import is_kept

    if not is_kept(Path(engine.__file__).parent):
        say("first use: compiling what moves and learns, about a minute")


def row(values: Any, digits: int = 6) -> str:
    """Return numbers in one line.

    Examples
    --------
    >>> row([1.0, -0.5])
    '(1, -0.5)'
    """
    return "(" + ", ".join(f"{float(x) + 0.0:.{digits}g}" for x in values) + ")"
