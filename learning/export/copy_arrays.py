"""Symmetric copies as arrays of a file, and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from learning.export.copies import Copies
from learning.export.folded_copy import FoldedCopy


def copies_to_arrays(copies: Copies | FoldedCopy) -> dict[str, NDArray]:
    """Arrays by name, each name beginning with ``copy_``."""
    arrays = {"linear": copies.linear, "offset": copies.offset, "signs": copies.signs}
    if isinstance(copies, FoldedCopy):
        arrays |= {"basis": copies.basis, "halfspaces": copies.halfspaces}
    else:
        arrays["wrapped"] = np.array(copies.wrapped)
    return {f"copy_{name}": array for name, array in arrays.items()}


def copies_from_arrays(arrays: dict[str, NDArray]) -> Copies | FoldedCopy:
    """Inverse of `copies_to_arrays`."""
    linear, offset, signs = (arrays[f"copy_{name}"] for name in ("linear", "offset", "signs"))
    if "copy_halfspaces" in arrays:
        basis, halfspaces = arrays["copy_basis"], arrays["copy_halfspaces"]
        return FoldedCopy(basis, linear, offset, signs, halfspaces)
    return Copies(linear, offset, signs, bool(arrays["copy_wrapped"]))
