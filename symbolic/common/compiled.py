"""Compilation of functions by numba, wherever their machine code may be kept."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from numba import config, njit

# The only private part of a dependency: numba has no public way to set an entry of a tuple, and
# vectors of a few numbers are twice as fast as tuples, which stay in registers, as in arrays.
from numba.cpython.unsafe.tuple import tuple_setitem as tuple_setitem

from isotorque.symbolic.common.cache_folders import can_write, user_cache

PACKAGE = Path(__file__).parents[2]


def compiled(function: Callable[..., Any] | None = None, /, **options: Any) -> Any:
    """Compile a function with numba when it is first called, and keep the result on disk.

    Parameters
    ----------
    function
        A function of a module; without one, a decorator is returned.
    **options
        As ``numba.njit`` takes them.

    Returns
    -------
    numba dispatcher
        The compiled function.

    Notes
    -----
    The result is kept in ``$NUMBA_CACHE_DIR``, beside the source, or in the cache of the user,
    whichever can be written first, and nowhere if none can: then it is compiled in each process.
    Results name the modules of what they were compiled with, and cannot be read once one of these
    has another name, in a later version say: folders are named after the names of all modules.

    Examples
    --------
    >>> import isotorque.symbolic.gravity.recursion as module
    >>> folder = cache_folder(Path(module.__file__).parent)
    >>> folder is None or folder.name.startswith("numba-")
    True
    """
    if function is None:
        return lambda f: compiled(f, **options)
    with cache_in(cache_folder(source_folder(function))) as kept:
        return njit(cache=kept, **options)(function)


def source_folder(function: Callable[..., Any]) -> Path:
    """Return the folder of the file that a function stands in."""
    return Path(function.__code__.co_filename).resolve().parent


def cache_folder(beside: Path) -> Path | None:
    """Return the folder to keep compiled functions of a source folder in; None if there is none."""
    given = [Path(config.CACHE_DIR).absolute()] if config.CACHE_DIR else []
    places = (folder for folder in (*given, beside / "__pycache__") if can_write(folder))
    place = next(places, None) or user_cache()
    return None if place is None else place / f"numba-{module_names(PACKAGE)}"


def is_kept(beside: Path) -> bool:
    """Say whether an earlier process kept compiled functions of a source folder."""
    folder = cache_folder(beside)
    return folder is not None and next(folder.glob("**/*.nbi"), None) is not None


@cache
def module_names(package: Path) -> str:
    """Return a short hash of the names of all modules of a package, its links followed."""
    names = hashlib.sha256()
    for folder, inside, files in os.walk(package, followlinks=True):
        inside.sort()
        modules = sorted(name for name in files if name.endswith(".py"))
        if modules:  # else a folder of caches, which this name must not depend on
            names.update(f"{os.path.relpath(folder, package)}: {modules}\n".encode())
    return names.hexdigest()[:12]


@contextmanager
def cache_in(folder: Path | None) -> Iterator[bool]:
    """Let numba keep what is decorated inside in a folder; yield whether there is one."""
    before = config.CACHE_DIR
    config.CACHE_DIR = "" if folder is None else str(folder)
    try:
        yield folder is not None
    finally:
        config.CACHE_DIR = before
