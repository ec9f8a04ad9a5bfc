"""How commands speak: JSON or text on standard output, everything else on standard error."""

from __future__ import annotations

import json
import math
import sys
from typing import Any

import numpy as np


def plain(value: Any) -> Any:
    """Return a value made of what JSON knows; NaN and infinities become null.

    Examples
    --------
    >>> plain({"q": np.array([1.0, np.nan]), "n": np.int64(3)})
    {'q': [1.0, None], 'n': 3}
    """
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value + 0.0 if math.isfinite(value) else None
    return value


def emit_json(document: Any) -> None:
    """Print one JSON document on standard output."""
    json.dump(plain(document), sys.stdout, indent=1, allow_nan=False)
    sys.stdout.write("\n")


def say(message: str, quiet: bool = False) -> None:
    """Print a message on standard error."""
    if not quiet:
        print(message, file=sys.stderr)


def row(values: Any, digits: int = 6) -> str:
    """Return numbers in one line.

    Examples
    --------
    >>> row([1.0, -0.5])
    '(1, -0.5)'
    """
    return "(" + ", ".join(f"{float(x) + 0.0:.{digits}g}" for x in values) + ")"
