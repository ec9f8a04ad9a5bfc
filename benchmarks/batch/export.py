"""Exported gravity as compiled C beside Pinocchio called from Python, interleaved.

Usage: python -m benchmarks.batch.export [--write]

``C, loop``: called over and over from C. ``C, ctypes``: called from Python through ctypes.
``Pinocchio``: ``computeGeneralizedGravity`` called from Python. Each the least of 15 rounds in
which all take turns; ratios say how many times faster than Pinocchio.
"""

from __future__ import annotations

import argparse
import ctypes
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import pinocchio as pin

from benchmarks.shared.document import write_between
from isotorque.learning.export.c_export import c_source
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.learners.registry import online_learner
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.symbolic.gravity.c_source import gravity_c
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

PAGE = Path(__file__).parents[2] / "docs" / "export.md"
ROUNDS, CALLS = 15, 2000
CALLER = """
void isotorque_gravity(const double *q, double *tau);
double repeat(long count, double *q, double *tau);
double repeat(long count, double *q, double *tau)
{
    double sum = 0.0;
    for (long i = 0; i < count; i++) {
        q[0] += 1e-9;
        isotorque_gravity(q, tau);
        sum += tau[0];
    }
    return sum;
}
"""


def sources(name: str) -> dict[str, str]:
    """C of the analytic and of learned models of a robot."""
    gravity = GravityModel(load_robot(name))
    group = primary_symmetries(gravity.potential)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (200, gravity.n))
    torque = gravity.torque(q)
    made = {"analytic": gravity_c(gravity)}
    quick = {"restarts": 1, "iterations": 3, "trial_iterations": 2}
    learners = {
        "parametric": StaticRegressor(name),
        "network, 18 units": FeedForwardNetwork(18, group=group, **quick),
        "network, 18 units, canonical": FeedForwardNetwork(
            18, group=group, symmetries="canonical", **quick
        ),
    }
    if name == "2r":
        learners["local-linear-map"] = online_learner("local-linear-map", group)
        learners["recursive-least-squares"] = online_learner("recursive-least-squares", group)
    for kind, learner in learners.items():
        if kind.endswith("canonical") and gravity.n > 3:
            continue
        made[kind] = c_source(torque_form(learner.fit(q, torque)))
    return made


def compiled(source: str, folder: Path) -> ctypes.CDLL:
    """A library with the gravity, and a loop around it in another file so that nothing inlines."""
    (folder / "gravity.c").write_text(source)
    (folder / "caller.c").write_text(CALLER)
    compiler = shutil.which("cc") or "cc"
    flags = ["-O2", "-std=c99", "-shared", "-fPIC", "gravity.c", "caller.c", "-o", "g.so", "-lm"]
    subprocess.run([compiler, *flags], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "g.so"))


def contestants(name: str, source: str, folder: Path) -> dict[str, Callable[[], float]]:
    """Seconds per call, each time they are called."""
    library = compiled(source, folder)
    doubles = ctypes.POINTER(ctypes.c_double)
    model = load_robot(name).model
    data, q, tau = model.createData(), np.full(model.nq, 0.3), np.zeros(model.nq)
    pointers = q.ctypes.data_as(doubles), tau.ctypes.data_as(doubles)
    library.repeat.argtypes = [ctypes.c_long, doubles, doubles]
    library.repeat.restype = ctypes.c_double
    gravity = library.isotorque_gravity
    gravity.argtypes, gravity.restype = [doubles, doubles], None

    def timed(work: Callable[[], object], count: int) -> float:
        start = time.perf_counter()
        work()
        return (time.perf_counter() - start) / count

    def through_ctypes() -> None:
        for _ in range(CALLS):
            gravity(*pointers)

    def pinocchio() -> None:
        compute = pin.computeGeneralizedGravity
        for _ in range(CALLS):
            compute(model, data, q)

    return {
        "loop": lambda: timed(lambda: library.repeat(CALLS, *pointers), CALLS),
        "ctypes": lambda: timed(through_ctypes, CALLS),
        "pinocchio": lambda: timed(pinocchio, CALLS),
    }


def table() -> str:
    """Times and ratios as Markdown."""
    head = ["robot", "model", "C, loop [us]", "C, ctypes [us]", "Pinocchio [us]"]
    head += ["loop: times faster", "ctypes: times faster"]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for name in ("2r", "ur5", "panda"):
        for kind, source in sources(name).items():
            with tempfile.TemporaryDirectory() as folder:
                runners = contestants(name, source, Path(folder))
                best = {
                    key: min(values)
                    for key, values in zip(
                        runners,
                        zip(
                            *([run() for run in runners.values()] for _ in range(ROUNDS)),
                            strict=True,
                        ),
                        strict=True,
                    )
                }
            cells = [name, kind, *(f"{1e6 * x:.3g}" for x in best.values())]
            cells += [f"{best['pinocchio'] / best[k]:.2g}" for k in ("loop", "ctypes")]
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE.name}")
    options = parser.parse_args()
    text = table()
    print(text)
    if options.write:
        write_between(PAGE, "export", text)


if __name__ == "__main__":
    main()
