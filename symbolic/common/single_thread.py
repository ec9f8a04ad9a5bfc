"""Linear algebra in one thread: results do not depend on the number of processors."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

from threadpoolctl import ThreadpoolController


@contextmanager
def single_thread() -> Iterator[None]:
    """Keep numerical libraries to one thread where matrices are small and many.

    Notes
    -----
    Sums are then added up in one order on every machine, so that equal runs are equal bit for bit.
    On a busy machine several threads wait for each other, fifty times longer than they work.

    Examples
    --------
    >>> import numpy as np
    >>> with single_thread():
    ...     (np.eye(3) @ [1.0, 2.0, 3.0]).tolist()
    [1.0, 2.0, 3.0]
    """
    import scipy.linalg  # noqa: F401  (its BLAS must be loaded before it can be limited)

    with _controller(len(sys.modules)).limit(limits=1):
        yield


@lru_cache(maxsize=1)
def _controller(modules: int) -> ThreadpoolController:
    """Return the libraries that are loaded; looking for them takes longer than many a fit.

    They are looked for again when modules were imported since, which may have loaded more.
    """
    return ThreadpoolController()
