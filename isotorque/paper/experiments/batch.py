"""Section 7.2: lattices and networks, with and without symmetries (Fig. 14 and 15B)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.paper.equal_errors import samples_needed
from isotorque.paper.experiments.learning_run import DENSE, TestSets
from isotorque.paper.experiments.maintained import maintained
from isotorque.paper.experiments.measured import Effort, Measured
from isotorque.paper.published import (
    BATCH_2R_RMSE,
    BATCH_2R_SAMPLES,
    BATCH_3R_RMSE,
    BATCH_3R_SAMPLES,
    FINE_3R_SAMPLES,
    HIDDEN,
    HIDDEN_FINE,
    PLAIN_2R_SAMPLES,
    PLAIN_3R_SAMPLES,
)
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

Array = NDArray[np.float64]

CURVE_2R = (4, 6, 8, 12, 16, 24, 32, 64, 128)
PLAIN_CURVE_2R = (32, 48, 64, 96, 128, 192, 255, 510, 1020)
CURVE_3R = (8, 12, 16, 24, 32, 48)
PLAIN_CURVE_3R = (65, 130, 200, 300, 425, 600)


class _Arm:
    """The arm with its truth, its regions and its test sets."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.gravity = robot, GravityModel(robot)
        self.group = primary_symmetries(self.gravity.potential)
        self.sets = TestSets.of(robot, self.gravity, self.group)

    def fit(self, samples: int, hidden: int, seed: int, *, symmetric: bool) -> FeedForwardNetwork:
        """Fit the paper's network to a lattice of the BCTS, or of all joint angles."""
        group: SymmetryGroup | None = self.group if symmetric else None
        whole = np.tile([-np.pi, np.pi], (self.robot.n, 1))
        region = (
            SamplingRegion.of_domain(FundamentalDomain(self.group))
            if symmetric
            else SamplingRegion.of_box(whole)
        )
        q = lattice_samples(region, samples, np.random.default_rng(seed)).q
        network = FeedForwardNetwork(hidden, group=group, random_state=seed)
        return network.fit(q, self.gravity.torque(q))

    def errors(self, network: FeedForwardNetwork) -> dict[str, float]:
        return self.sets.errors(network)

    def curve(
        self, counts: tuple[int, ...], hidden: int, seed: int, *, symmetric: bool
    ) -> dict[int, float]:
        """Torque RMSE on the dense set [N m] by number of samples."""
        return {
            count: self.errors(self.fit(count, hidden, seed, symmetric=symmetric))[DENSE]
            for count in counts
        }


def measure_batch_2r(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Fit networks to lattices on the 2R arm, with and without symmetries."""
    arm = _Arm(robot)
    small = effort.of(BATCH_2R_SAMPLES, 16)
    network = arm.fit(small, HIDDEN, seed, symmetric=True)
    plain = arm.fit(effort.of(PLAIN_2R_SAMPLES, 64), HIDDEN, seed, symmetric=False)
    numbers: dict[str, Any] = {}
    for name, key in {"66 targets": "66", "90 targets": "90", DENSE: "dense"}.items():
        numbers[f"rmse_{key}"] = arm.errors(network)[name]
        numbers[f"plain_rmse_{key}"] = arm.errors(plain)[name]
    curves = _curves(arm, effort, seed, CURVE_2R, PLAIN_CURVE_2R)
    curves["symmetric"][small] = numbers["rmse_dense"]
    curves["plain"][effort.of(PLAIN_2R_SAMPLES, 64)] = numbers["plain_rmse_dense"]
    numbers |= _factor(curves, BATCH_2R_RMSE)
    stay = maintained(robot, arm.gravity, network, arm.sets.q["90 targets"])
    return Measured(numbers, {"maintained_90": stay, **_drawn(curves)})


def measure_batch_3r(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Fit networks to lattices on the 3R arm, with and without symmetries."""
    arm = _Arm(robot)
    small, large = effort.of(BATCH_3R_SAMPLES, 16), effort.of(FINE_3R_SAMPLES, 20)
    network = arm.fit(small, HIDDEN, seed, symmetric=True)
    plain = arm.fit(effort.of(PLAIN_3R_SAMPLES, 64), HIDDEN, seed, symmetric=False)
    fine = arm.fit(large, HIDDEN_FINE, seed, symmetric=True)
    numbers: dict[str, Any] = {}
    for name, key in {"64 targets": "64", DENSE: "dense"}.items():
        numbers[f"rmse_{key}"] = arm.errors(network)[name]
        numbers[f"plain_rmse_{key}"] = arm.errors(plain)[name]
        numbers[f"fine_rmse_{key}"] = arm.errors(fine)[name]
    curves = _curves(arm, effort, seed, CURVE_3R, PLAIN_CURVE_3R)
    curves["symmetric"][small] = numbers["rmse_dense"]
    curves["plain"][effort.of(PLAIN_3R_SAMPLES, 64)] = numbers["plain_rmse_dense"]
    numbers |= _factor(curves, BATCH_3R_RMSE)
    targets = arm.sets.q["64 targets"]
    pictures = {
        "maintained_small": maintained(robot, arm.gravity, network, targets),
        "maintained_fine": maintained(robot, arm.gravity, fine, targets),
        **_drawn(curves),
    }
    return Measured(numbers, pictures)


def _curves(
    arm: _Arm, effort: Effort, seed: int, symmetric: tuple[int, ...], plain: tuple[int, ...]
) -> dict[str, dict[int, float]]:
    """Errors of both kinds of lattice by number of samples, the curves' shorter part."""
    few = effort.of(len(symmetric), 2)
    return {
        "symmetric": arm.curve(symmetric[:few], HIDDEN, seed, symmetric=True),
        "plain": arm.curve(plain[:few], HIDDEN, seed, symmetric=False),
    }


def _factor(curves: dict[str, dict[int, float]], error: float) -> dict[str, Any]:
    """Samples needed with and without symmetries for the paper's error, and their ratio."""
    few = samples_needed(curves["symmetric"], error)
    many = samples_needed(curves["plain"], error)
    ratio = None if few is None or many is None else many / few
    return {"samples": few, "plain_samples": many, "factor": ratio}


def _drawn(curves: dict[str, dict[int, float]]) -> dict[str, Any]:
    return {
        name: {"samples": sorted(curve), "dense": [curve[n] for n in sorted(curve)]}
        for name, curve in curves.items()
    }
