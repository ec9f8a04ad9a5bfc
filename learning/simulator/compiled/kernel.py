"""The decorator of every compiled function of the simulator."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from numba import njit

from isotorque.symbolic.common.compiled import cache_folder, cache_in, source_folder

_SHARED = ("chain.py", "plant.py", "step_control.py")


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function with numba, caching the result on disk.

    Parameters
    ----------
    function
        A function of scalars and arrays that creates no array: workspaces come in from outside.

    Returns
    -------
    numba dispatcher
        The compiled function.

    Notes
    -----
    Numba renews a cached function only when the function's own file changes, though it contains
    the code and the constants of other files. The cache is therefore kept in a folder named for
    the contents of all files that kernels are made of, where `compiled` keeps the
    others. References are not counted (``_nrt=False``): counting the arrays of
    a call costs as much as the dynamics of a two-joint arm, and nothing is created or freed.
    """
    return _compiled(function, "never")


def kernel_part(function: Callable[..., Any]) -> Any:
    """Compile a function as a part of every kernel that calls it, which saves the calls.

    For functions that are called once or twice in the innermost loops; see `kernel`.
    """
    return _compiled(function, "always")


def _compiled(function: Callable[..., Any], inline: str) -> Any:
    folder = source_folder(function)
    place = cache_folder(folder)
    if place is not None:
        place = place / f"kernels-{_fingerprint(folder)}"
    with cache_in(place) as kept:
        # No fastmath: with it the last bits depend on how functions happened to be compiled
        # together, and a process that compiles ends otherwise than one that loads the cache.
        return njit(cache=kept, error_model="numpy", inline=inline, _nrt=False)(function)


@cache
def _fingerprint(folder: Path) -> str:
    """Return a short hash of the files that the kernels of a folder are made of."""
    sha = hashlib.sha256()
    for path in sources(folder):
        sha.update(path.read_bytes())
    return sha.hexdigest()[:16]


def sources(folder: Path) -> list[Path]:
    """Return the files of a folder that kernels are made of: with code, layouts or constants."""
    return sorted([*folder.glob("*.py"), *(folder.parent / "dynamics" / name for name in _SHARED)])
