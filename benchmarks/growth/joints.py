"""Costs against the number of joints, of random arms and of planar chains."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from benchmarks.growth.arms import planar_chain, random_arm
from benchmarks.growth.curves import Curve, Work
from isotorque.learning.arm import OutcomeKind
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.gravity.recursion import GravityChain
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

JOINTS = tuple(range(2, 11))
PANELS = ("random arms", "planar chains")
RANDOM_ARMS = 3
"""Random arms of each number of joints that settle: some are stiffer than others."""
QUERIES, SETTLED = 5000, 20
"""Configurations of a batch, and samples that each arm settles."""
DISTANCE = 0.1
"""Samples start so far from where the arm comes to rest [rad]."""


def curves(joints: Sequence[int] = JOINTS) -> list[Curve]:
    """All curves; the normal form of a random arm has about 3^n / 2 terms."""
    found = []
    for panel in PANELS:
        whats: dict[str, Callable[[str, int], Work]] = {
            "gravity model": _model,
            "symmetry group": _group,
            "torque, of a batch": _torque,
            "settling one sample": _settle,
            "step of settling": _step,
        }
        for what, prepare in whats.items():
            by_factor = what == "symmetry group" or (what, panel) == ("gravity model", PANELS[0])

            def at(n: int, prepare: Callable = prepare, panel: str = panel) -> Work:
                return prepare(panel, n)

            found.append(Curve(what, tuple(joints), at, panel, "joint" if by_factor else ""))
    return found


@cache
def _robot(panel: str, joints: int, seed: int = 0) -> Robot:
    return random_arm(joints, seed) if panel == PANELS[0] else planar_chain(joints)


@cache
def _potential(panel: str, joints: int) -> TrigonometricPolynomial:
    return derive_potential(_robot(panel, joints).tree)


def _model(panel: str, joints: int) -> Work:
    """The normal form, checked against Pinocchio."""
    robot = _robot(panel, joints)
    return Work(lambda: GravityModel(robot))


def _group(panel: str, joints: int) -> Work:
    potential = _potential(panel, joints)
    return Work(lambda: primary_symmetries(potential))


def _torque(panel: str, joints: int) -> Work:
    chain = GravityChain.of(_robot(panel, joints).tree)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (QUERIES, joints))
    return Work(lambda: chain.torque(q), QUERIES)


def _settle(panel: str, joints: int) -> Work:
    works = _settling(panel, joints)
    return Work(lambda: [run() for run, _ in works], len(works) * SETTLED)


def _step(panel: str, joints: int) -> Work:
    works = _settling(panel, joints)
    return Work(lambda: [run() for run, _ in works], sum(steps for _, steps in works))


@cache
def _settling(panel: str, joints: int) -> list[tuple[Callable[[], object], int]]:
    """For each arm, what settles its samples, and the steps that this takes.

    Raises
    ------
    RuntimeError
        If a sample does not settle.
    """
    found: list[tuple[Callable[[], object], int]] = []
    for seed in range(RANDOM_ARMS if panel == PANELS[0] else 1):
        arm = SimulatedArm(_robot(panel, joints, seed), limits="none")
        away = np.random.default_rng(seed).normal(size=(SETTLED, joints))
        starts = arm.home + DISTANCE * away / np.linalg.norm(away, axis=1, keepdims=True)
        torques = np.tile(arm.equations.gravity_torque(arm.home), (SETTLED, 1))
        ends = arm.settle_each(starts, torques)
        if any(kind is not OutcomeKind.SETTLED for kind in ends.kinds):
            raise RuntimeError(f"{arm.robot.name}: a sample does not settle")

        def run(
            arm: SimulatedArm = arm, q: np.ndarray = starts, tau: np.ndarray = torques
        ) -> object:
            return arm.settle_each(q, tau)

        found.append((run, int(ends.steps.sum())))
    return found
