"""Conversion of values to those that JSON knows."""

from __future__ import annotations

import math
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
