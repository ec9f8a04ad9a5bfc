"""Time the derivation of gravity torque and symmetry group beside other ways to get the torque.

Usage: python -m benchmarks.derive [--json] [--repeats 5] [--limit 20] [ROBOT ...]

All run in one process after import, taking turns, on the same URDF files: the built-in arms and,
where the package example-robot-data is installed, three arms from it. Times are medians of CPU
time (all is single-threaded), so that other load on the machine disturbs them little. Each result
is compared with Pinocchio at one configuration.

* normal form: the exact potential.
* isotorque: the exact potential, then the complete symmetry group, with proofs.
* SymPy: product of 4x4 transforms in floats, potential, derivatives, expanded.
* adam: adam-robotics' CasADi function of the gravity term (no formula to read).
* CasADi: gradient of the potential from a product of 4x4 transforms (no formula to read).
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import casadi
import numpy as np
import pinocchio as pin
import sympy

from benchmarks.shared.clear_errors import clear_errors
from benchmarks.shared.time_limit import OutOfTimeError, at_most
from benchmarks.shared.urdf_arms import Subject, subjects
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.robots.kinematic_tree import KinematicTree, human_arm, planar_arm
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

try:
    from adam.casadi import KinDynComputations
except ImportError:
    KinDynComputations = None

DEMANDED = {"panda": 0.2, "talos_left_arm": 1.0}
DEMANDED_SMALL = 0.05  # arms of six or seven joints with up to 60 frequencies
DEMANDED_PARAMETRIC = 2.0


# -- the four ways ------------------------------------------------------------------------------
# Each derives something; the function returned evaluates the torque, outside the time taken.


def normal_form(subject: Subject) -> Callable[[np.ndarray], np.ndarray]:
    return derive_potential(subject.robot.tree).gradient


def isotorque(subject: Subject) -> Callable[[np.ndarray], np.ndarray]:
    potential = derive_potential(subject.robot.tree)
    primary_symmetries(potential)
    return potential.gradient


def plain_sympy(subject: Subject) -> Callable[[np.ndarray], np.ndarray]:
    tree = subject.robot.tree
    q = sympy.symbols(f"q1:{tree.n + 1}", real=True)
    U = transform_potential(tree, q, sympy.cos, sympy.sin, lambda rows: sympy.Matrix(rows))
    torque = [sympy.expand(sympy.diff(U, x)) for x in q]
    return lambda point: np.array([float(g.subs(dict(zip(q, point, strict=True)))) for g in torque])


def adam(subject: Subject) -> Callable[[np.ndarray], np.ndarray]:
    joints = list(subject.robot.joint_names)
    gravity = np.array([*subject.robot.tree.gravity, 0, 0, 0])
    function = KinDynComputations(str(subject.urdf), joints, gravity=gravity).gravity_term_fun()
    return lambda point: np.array(function(np.eye(4), point)).ravel()[-len(joints) :]


def casadi_gradient(subject: Subject) -> Callable[[np.ndarray], np.ndarray]:
    tree = subject.robot.tree
    q = casadi.SX.sym("q", tree.n)
    U = transform_potential(
        tree,
        casadi.vertsplit(q),
        casadi.cos,
        casadi.sin,
        lambda rows: casadi.vertcat(*(casadi.horzcat(*row) for row in rows)),
    )
    function = casadi.Function("g", [q], [casadi.gradient(U, q)])
    return lambda point: np.array(function(point)).ravel()


def transform_potential(
    tree: KinematicTree, q: Any, cos: Callable, sin: Callable, matrix: Callable
) -> Any:
    """Return -sum m gravity . (centre of mass) by multiplying 4x4 transforms, as in a textbook."""
    worlds: list[Any] = []
    total = 0
    for i, parent in enumerate(tree.parents):
        placement = np.eye(4)
        placement[:3, :3], placement[:3, 3] = tree.rotations[i], tree.translations[i]
        a = tree.axes[i]
        fixed, cross = np.outer(a, a), np.cross(np.eye(3), a)
        rows = [
            [
                fixed[r, c] + (np.eye(3) - fixed)[r, c] * cos(q[i]) + cross[r, c] * sin(q[i])
                for c in range(3)
            ]
            + [0]
            for r in range(3)
        ]
        local = matrix(placement.tolist()) @ matrix([*rows, [0, 0, 0, 1]])
        worlds.append(local if parent < 0 else worlds[parent] @ local)
        if tree.masses[i]:
            centre = worlds[i] @ matrix([[x] for x in (*tree.levers[i].tolist(), 1.0)])
            for r in range(3):
                total = total - float(tree.masses[i] * tree.gravity[r]) * centre[r]
    return total


METHODS: dict[str, Callable[[Subject], Callable[[np.ndarray], np.ndarray]]] = {
    "normal form": normal_form,
    "isotorque": isotorque,
    "SymPy": plain_sympy,
    **({"adam": adam} if KinDynComputations else {}),
    "CasADi": casadi_gradient,
}


# -- measuring ----------------------------------------------------------------------------------


def measure(subject: Subject, repeats: int, limit: float) -> dict[str, Any]:
    robot = subject.robot
    gravity = GravityModel(robot)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, robot.n)
    data = robot.model.createData()
    truth = pin.computeGeneralizedGravity(robot.model, data, q)
    times: dict[str, list[float]] = {name: [] for name in METHODS}
    errors: dict[str, float] = {}
    late: set[str] = set()
    for turn in range(repeats):
        for name, derive in METHODS.items():
            if name in late:
                continue
            sympy.core.cache.clear_cache()  # SymPy would remember the last turn
            start = time.process_time()
            try:
                with at_most(limit):
                    torque = derive(subject)
                    times[name].append(time.process_time() - start)
                    if turn == 0:
                        errors[name] = float(np.abs(torque(q) - truth).max())
            except OutOfTimeError:
                late.add(name)
    allowed = float(np.max(robot.snap_bound)) + 1e-9
    for name, error in errors.items():
        if error > (1e-9 if name != "adam" else allowed):  # adam reads the file, unsnapped
            print(f"{subject.name}: {name} is off by {error:.2g} N m", file=sys.stderr)
    frequencies = len(gravity.significant_potential)
    demanded = DEMANDED.get(subject.name)
    if demanded is None and frequencies <= 60:
        demanded = DEMANDED_SMALL
    return {
        "robot": subject.name,
        "joints": robot.n,
        "frequencies": frequencies,
        "order": primary_symmetries(gravity.potential).order,
        "demanded_seconds": demanded,
        "seconds": {k: statistics.median(v) if v else None for k, v in times.items()},
        "limit_seconds": limit,
        "error_vs_pinocchio": errors,
    }


def measure_parametric(name: str, tree: KinematicTree, repeats: int) -> dict[str, Any]:
    derived, times = [], []
    for _ in range(repeats):
        sympy.core.cache.clear_cache()
        start = time.process_time()
        gravity = GravityModel(tree)
        components = gravity.components
        derived.append(time.process_time() - start)
        group = primary_symmetries(gravity.potential)
        times.append(time.process_time() - start)
    return {
        "robot": name,
        "joints": tree.n,
        "frequencies": len(gravity.potential),
        "order": group.order,
        "demanded_seconds": DEMANDED_PARAMETRIC,
        "seconds": {
            "normal form": statistics.median(derived),
            "isotorque": statistics.median(times),
        },
        "components": [str(f) for f in components],
    }


def table(rows: list[dict[str, Any]]) -> str:
    others = [name for name in METHODS if name not in ("isotorque", "normal form")]
    head = ["robot", "joints", "frequencies", "order"]
    head += ["normal form [ms]", "isotorque [ms]", "demanded [ms]"]
    head += [f"{name} [ms] (times isotorque)" for name in others]
    lines = [" | ".join(head), " | ".join(["---"] * len(head))]
    for row in rows:
        mine = row["seconds"]["isotorque"]
        cells = [row[field] for field in ("robot", "joints", "frequencies", "order")]
        cells += [f"{1e3 * row['seconds']['normal form']:.1f}", f"{1e3 * mine:.1f}"]
        cells.append(f"{1e3 * row['demanded_seconds']:.0f}" if row["demanded_seconds"] else "")
        for name in others:
            seconds = row["seconds"].get(name, "")
            if seconds is None:
                limit = row["limit_seconds"]
                cells.append(f"> {1e3 * limit:.0f} (> {limit / mine:.0f})")
            else:
                cells.append(seconds and f"{1e3 * seconds:.1f} ({seconds / mine:.2g})")
        lines.append(" | ".join(map(str, cells)))
    return "\n".join(f"| {line} |" for line in lines)


@clear_errors
def main() -> int:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("robots", nargs="*", help="names of arms, all by default")
    parser.add_argument("--json", action="store_true", help="write JSON instead of a table")
    parser.add_argument("--repeats", type=int, default=5, help="turns of each method")
    parser.add_argument("--limit", type=float, default=20.0, help="seconds after which to give up")
    options = parser.parse_args()
    rows = []
    with TemporaryDirectory() as folder:
        for subject in subjects(options.robots, Path(folder)):
            print(subject.name, file=sys.stderr)
            rows.append(measure(subject, options.repeats, options.limit))
    for name, tree in (
        ("2r parametric", planar_arm(2)),
        ("3r parametric", human_arm()),
        ("3r planar parametric", planar_arm(3)),
    ):
        if not options.robots:
            rows.append(measure_parametric(name, tree, options.repeats))
    print(json.dumps(rows, indent=1) if options.json else table(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
