"""The paper's experiments on a real Dask cluster of separate processes, one of which is killed."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from isotorque.paper.work import Piece, perform
from isotorque.parallel import in_processes, on_cluster

pytest.importorskip("distributed")
pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
PIECES = [Piece("discovery-2r", seed, 0.3) for seed in range(5)] + [
    Piece("ranges-3r", 0),
    Piece("domain-2r", 0),
]


def begin(*arguments):
    """A process of the cluster, which imports this project and nothing of this test's session."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(
        [sys.executable, "-m", *arguments],
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def wait_until(true, seconds=120):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "the cluster did not come up"
        time.sleep(0.1)


@pytest.fixture
def cluster(tmp_path):
    """Address of a scheduler and its two workers."""
    from distributed import Client

    file = tmp_path / "scheduler.json"
    scheduler = "distributed.cli.dask_scheduler --host 127.0.0.1 --port 0 --no-dashboard"
    processes = [begin(*scheduler.split(), "--scheduler-file", str(file))]
    try:
        wait_until(file.exists)
        address = None
        with Client(scheduler_file=str(file), set_as_default=False) as client:
            address = client.scheduler.address
            for name in ("first", "second"):
                processes.append(
                    begin(
                        *("distributed.cli.dask_worker", address, "--name", name),
                        *("--local-directory", str(tmp_path / name)),
                        *["--nthreads", "1", "--no-nanny", "--no-dashboard"],
                    )
                )
            client.wait_for_workers(2, timeout=120)
        yield address, processes[1:]
    finally:
        for process in reversed(processes):
            process.kill()
            process.wait()


def test_a_cluster_gives_the_same_results_though_a_worker_is_killed(cluster):
    address, workers = cluster
    found = {}
    for piece, result in on_cluster(perform, PIECES, address):
        if not found:
            os.kill(workers[0].pid, signal.SIGKILL)
        found[piece] = result
    assert workers[0].wait(30) == -signal.SIGKILL
    assert workers[1].poll() is None
    assert set(found) == set(PIECES)
    assert found == dict(in_processes(perform, PIECES, jobs=1))
