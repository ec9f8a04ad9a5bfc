"""Work in several processes: every task once, lost processes, interruption."""

import math
import multiprocessing
import os
import signal
import time
from pathlib import Path

import pytest

from isotorque.parallel import in_processes, on_cluster
from isotorque.symbolic.common.errors import InputError


def die_once(mark: str) -> str:
    """Kill this process the first time; write down that it lived the second time."""
    path = Path(mark)
    if path.suffix and not path.exists():
        path.write_text("was here")
        os.kill(os.getpid(), signal.SIGKILL)
    return path.stem


def die(_: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def threads(_: int) -> str:
    return os.environ["OMP_NUM_THREADS"]


def wait_for(seconds: float) -> float:
    time.sleep(seconds)
    return seconds


def test_one_process_works_in_order():
    assert list(in_processes(math.factorial, [3, 1, 4], jobs=1)) == [(3, 6), (1, 1), (4, 24)]


def test_two_processes_do_every_task_once():
    found = dict(in_processes(math.factorial, range(12), jobs=2))
    assert found == {n: math.factorial(n) for n in range(12)}


def test_work_of_a_lost_process_is_done_again(tmp_path):
    tasks = [str(tmp_path / "a.mark"), "b", "c", "d"]
    found = dict(in_processes(die_once, tasks, jobs=2))
    assert sorted(found.values()) == ["a", "b", "c", "d"]
    assert (tmp_path / "a.mark").exists()


def test_processes_that_always_die_are_given_up():
    with pytest.raises(InputError, match="lost 3 times"):
        list(in_processes(die, [1, 2], jobs=2))


def test_each_process_has_one_thread_and_the_environment_stays(monkeypatch):
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    assert {count for _, count in in_processes(threads, [0, 1], jobs=2)} == {"1"}
    assert "OMP_NUM_THREADS" not in os.environ


def test_errors_of_the_work_are_raised():
    with pytest.raises(ValueError, match="not defined for negative"):
        list(in_processes(math.factorial, [1, -1], jobs=2))


def own_process(_: int) -> int:
    time.sleep(0.05)  # long enough for both processes to get some of the work
    return os.getpid()


@pytest.mark.parametrize("seconds", [0.0, 600.0], ids=["idle", "at work"])
def test_a_caller_that_stops_leaves_no_process_behind(seconds):
    before = set(multiprocessing.active_children())
    results = in_processes(wait_for, [0.0, seconds, seconds], jobs=2)
    assert next(results) == (0.0, 0.0)
    begun = set(multiprocessing.active_children()) - before
    assert begun
    results.close()
    assert not begun & set(multiprocessing.active_children())
    for process in begun:
        with pytest.raises(ProcessLookupError):
            os.kill(process.pid, 0)


def test_finished_work_leaves_no_process_behind():
    for pid in {pid for _, pid in in_processes(own_process, range(8), jobs=2)}:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


@pytest.mark.parametrize("jobs", [0, -1])
def test_no_process_at_all_is_refused(jobs):
    with pytest.raises(InputError, match="jobs"):
        list(in_processes(abs, [1], jobs=jobs))


@pytest.mark.slow
def test_a_scheduler_that_is_not_there_is_refused():
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match="--scheduler"):
        list(on_cluster(abs, [1], "tcp://127.0.0.1:9"))
