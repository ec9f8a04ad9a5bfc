"""Parallel work on many processors: local processes, or a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Any, TypeVar

from isotorque.symbolic.common.errors import InputError

Task = TypeVar("Task")
Result = TypeVar("Result")

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
ATTEMPTS = 3
"""How often work is given out again after the process that did it was lost."""


def in_processes(
    work: Callable[[Task], Result], tasks: Sequence[Task], jobs: int = 2
) -> Iterator[tuple[Task, Result]]:
    """Do work in local processes; yield each task with its result, as they are finished.

    Parameters
    ----------
    work
        A function of a module (other processes import it).
    tasks
        In the order in which they are begun.
    jobs
        Number of processes; 1 works in this one. Each uses one thread.

    Raises
    ------
    InputError
        If processes are lost again and again (killed from outside, or out of memory).

    Notes
    -----
    Work whose process was lost is done again. Errors of the work itself are raised here. When the
    caller stops (an error, Ctrl-C), work that has not begun is dropped, work that has begun is
    ended, and no process is left.

    Examples
    --------
    >>> list(in_processes(abs, [-1], jobs=1))
    [(-1, 1)]
    """
    if jobs < 1:
        raise InputError("parallel", "jobs", jobs, "at least 1")
    if jobs == 1:
        for task in tasks:
            yield task, work(task)
        return
    left = list(range(len(tasks)))
    for _ in range(ATTEMPTS):
        for place, result in _one_pool(work, tasks, left.copy(), jobs):
            left.remove(place)
            yield tasks[place], result
        if not left:
            return
    raise InputError(
        "parallel", "processes", f"lost {ATTEMPTS} times", "work that no process is killed in"
    )


def _one_pool(
    work: Callable[[Task], Result], tasks: Sequence[Task], places: list[int], jobs: int
) -> Iterator[tuple[int, Result]]:
    """Yield places and results until all is done or a process is lost."""
    before = set(multiprocessing.active_children())
    with _one_thread_each():
        pool = ProcessPoolExecutor(
            min(jobs, len(places)), multiprocessing.get_context("spawn"), _leave_with_parent
        )
        futures: dict[Future[Result], int] = {pool.submit(work, tasks[p]): p for p in places}
    try:
        while futures:
            done, _ = wait(futures, return_when=FIRST_COMPLETED)
            for future in done:
                place = futures.pop(future)
                try:
                    result = future.result()
                except BrokenProcessPool:
                    continue
                yield place, result
    finally:
        if futures:  # given up: nobody waits for what is still being done
            for process in set(multiprocessing.active_children()) - before:
                process.terminate()
        pool.shutdown(cancel_futures=True)  # which waits until every process has ended


def _leave_with_parent() -> None:
    """End this process, without a word, when the one that began it is interrupted or gone."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes begun inside use one thread each: numerical libraries ask when they are loaded."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def on_cluster(
    work: Callable[[Task], Result], tasks: Sequence[Task], address: str
) -> Iterator[tuple[Task, Result]]:
    """Do work on an existing Dask cluster; yield each task with its result, as they are finished.

    Parameters
    ----------
    work
        A function of a module that the workers can import.
    tasks
        In the order in which they are begun.
    address
        Of the scheduler, e.g. ``tcp://host:8786``.

    Raises
    ------
    InputError
        If Dask is not installed, or no scheduler answers there.

    Notes
    -----
    The scheduler gives the work of a lost worker to another one.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError(
            "parallel", "--scheduler", address, "Dask: pip install 'isotorque[cluster]'"
        ) from None
    try:
        client = Client(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(
            "parallel", "--scheduler", address, f"the address of a Dask scheduler ({error})"
        ) from None
    with client, client.as_current():
        futures: dict[Any, int] = {
            client.submit(work, task, pure=False, priority=-place): place
            for place, task in enumerate(tasks)
        }
        for future, result in as_completed(list(futures), with_results=True):
            yield tasks[futures[future]], result
