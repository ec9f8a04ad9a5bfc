"""Samples for the benchmark of relation learning: recordings of arms whose truth is known."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.level_sets.level_set import level_set
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

Array = NDArray[np.float64]
Samples = tuple[Array, Array]

SMALLEST_TORQUE = 0.05
"""Random torques have every component above this share of the joint's largest: below, its sign
says nothing."""


@dataclass(frozen=True, eq=False)
class Truth:
    """Gravity potential and exact group of an arm."""

    potential: TrigonometricPolynomial
    group: SymmetryGroup


@cache
def truth(robot: str) -> Truth:
    """Derive an arm's potential and group."""
    exact = GravityModel(load_robot(robot)).potential
    return Truth(exact.to_float(), primary_symmetries(exact))


@cache
def stable_samples(robot: str, count: int, seed: int) -> Samples:
    """Configurations an arm without a controller rests at, uniform over them, and their torques."""
    potential, rng = truth(robot).potential, np.random.default_rng(seed)
    acting = potential.frequencies.any(axis=0)
    found = np.empty((0, potential.n))
    while len(found) < count:
        q = rng.uniform(-np.pi, np.pi, (40 * count, potential.n))
        stiffness = potential.hessian(q)[:, acting][:, :, acting]
        found = np.concatenate([found, q[np.linalg.eigvalsh(stiffness).min(axis=1) > 0.0]])
    return found[:count], potential.gradient(found[:count])


@cache
def level_set_samples(robot: str, torques: int, seed: int) -> Samples:
    """Level sets of random torques, each configuration kept with one probability of 30-60 %."""
    arm, rng = truth(robot), np.random.default_rng(seed)
    potential, group = arm.potential, arm.group
    anywhere = rng.uniform(-np.pi, np.pi, (2000, potential.n))
    smallest = SMALLEST_TORQUE * np.abs(potential.gradient(anywhere)).max(axis=0)
    kept = rng.uniform(0.3, 0.6)
    q: list[Array] = []
    tau: list[Array] = []
    while len(q) < torques:
        torque = potential.gradient(rng.uniform(-np.pi, np.pi, potential.n))
        if (np.abs(torque) < smallest).any():
            continue
        found = level_set(potential, torque, group=group, max_starts=400)
        chosen = rng.random(len(found)) < kept
        if chosen.any():
            free = rng.uniform(-np.pi, np.pi, (int(chosen.sum()), len(group.free_directions)))
            q.append(wrap(found.configurations[chosen] + free @ group.free_directions))
            tau.append(found.torques[chosen])
    return np.concatenate(q), np.concatenate(tau)
