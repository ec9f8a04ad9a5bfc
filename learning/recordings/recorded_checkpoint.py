"""A learner's or algorithm's state at a point of a run: named arrays, no pickle."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """Named arrays saved with a run.

    Attributes
    ----------
    name : str
        What was saved.
    number : int
        Commands the arm had been given when it was saved.
    arrays : mapping of str to array
        What was saved.
    """

    name: str
    number: int
    arrays: Mapping[str, NDArray[Any]]


def pack_arrays(arrays: Mapping[str, ArrayLike]) -> bytes:
    """Write named arrays as the bytes of an ``.npz`` file.

    Raises
    ------
    InputError
        If an array holds Python objects, which only pickle could write.

    Notes
    -----
    The same arrays give the same bytes (no time stamps).

    Examples
    --------
    >>> unpack_arrays(pack_arrays({"weights": [1.0, 2.0]}))["weights"]
    array([1., 2.])
    """
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, values in arrays.items():
            array = np.asanyarray(values)
            if array.dtype.hasobject:
                raise InputError("checkpoint", name, f"of type {array.dtype}", "numbers or text")
            member = io.BytesIO()
            np.lib.format.write_array(member, array, allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(name + ".npy"), member.getvalue())
    return buffer.getvalue()


def unpack_arrays(blob: bytes) -> dict[str, NDArray[Any]]:
    """Read what ``pack_arrays`` wrote."""
    with np.load(io.BytesIO(blob), allow_pickle=False) as archive:
        return dict(archive)
