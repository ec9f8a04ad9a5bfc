"""Linear algebra in one thread: matrices of a chain are too small to be shared."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import scipy.linalg  # noqa: F401  (its BLAS must be loaded before it can be limited)
from threadpoolctl import ThreadpoolController


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep BLAS to one thread.

    On a busy machine several threads wait for each other, fifty times longer than they work; and
    sums are added up in one order, so that equal fits are equal bit for bit.
    """
    with _controller().limit(limits=1, user_api="blas"):
        yield


@cache
def _controller() -> ThreadpoolController:
    """Return the controller; looking for libraries takes longer than a fit."""
    return ThreadpoolController()
