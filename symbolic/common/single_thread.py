"""Linear algebra in one thread: results do not depend on the number of processors."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


@contextmanager
def single_thread() -> Iterator[None]:
    """Keep BLAS to one thread where matrices are small and many.

    Notes
    -----
    Sums are then added up in one order on every machine, so that equal runs are equal bit for bit.
    On a busy machine several threads wait for each other and cost ten times the time of one.
    """
    with threadpool_limits(limits=1):
        yield
