"""Fitted learners of every kind, small enough to be fitted in tests."""

import numpy as np

from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from isotorque.learning.learners.memory.dictionary_learner import DictionaryLearner
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


class WithCables(RigidChainProcess):
    """The learner of arms with cables; of an arm without, it would be a chain alone."""

    def fit(self, X, y):
        """Fit to the samples with a cable of 4 % at every joint."""
        q = np.asarray(X)
        return super().fit(q, y + 0.04 * np.abs(y).max() * np.sin(2.0 * q))


class WithSpring(StaticRegressor):
    """The parametric learner of an arm with a spring at joint 1 and a cable at joint 2."""

    def fit(self, X, y):
        """Fit to the samples with both."""
        q = np.asarray(X)
        beside = 0.5 * q[:, :1] * [1.0, 0.0] + 0.2 * np.cos(2.0 * q[:, 1:]) * [0.0, 1.0]
        return super().fit(q, y + beside)


QUICK = {"restarts": 1, "iterations": 10, "trial_iterations": 5}
#: Learners by name: from a robot's name and its group.
MAKERS = {
    "local-linear-map": lambda robot, group: LocalLinearMap(0.3, group=group),
    "local-linear-map-it": lambda robot, group: LocalLinearMap(
        0.5, kernel_width=2.5, inner_iterations=None, group=group
    ),
    "recursive-least-squares": lambda robot, group: RecursiveLeastSquares(group=group),
    "averaged": lambda robot, group: FeedForwardNetwork(8, group=group, **QUICK),
    "augmented": lambda robot, group: FeedForwardNetwork(
        8, symmetries="augmented", inputs="raw", group=group, **QUICK
    ),
    "canonical": lambda robot, group: FeedForwardNetwork(
        8, symmetries="canonical", group=group, **QUICK
    ),
    "canonical raw": lambda robot, group: FeedForwardNetwork(
        8, symmetries="canonical", inputs="raw", group=group, **QUICK
    ),
    "trigonometric": lambda robot, group: EquivariantTrigonometric(group=group),
    "joint by joint": lambda robot, group: EquivariantTrigonometric(False, group=group),
    "gaussian-process": lambda robot, group: SymmetricGaussianProcess(
        length_scale=2.0, group=group
    ),
    # its length scales are sought, and are long
    "smooth gaussian-process": lambda robot, group: SymmetricGaussianProcess(group=group),
    "noisy gaussian-process": lambda robot, group: SymmetricGaussianProcess(None, group=group),
    "parametric": lambda robot, group: StaticRegressor(robot),
    "parametric with spring": lambda robot, group: WithSpring(robot),
    "rigid-chain": lambda robot, group: RigidChain(unknown_offsets=True),
    "rigid-chain+gaussian-process": lambda robot, group: WithCables(starts=5),
    "dictionary": lambda robot, group: DictionaryLearner(
        EquivariantTrigonometric(group=group), budget=30, group=group
    ),
}
TIED = [name for name in MAKERS if "parametric" not in name and "rigid" not in name]


def samples(robot, count, seed=0):
    """Configurations [rad] and exact torques [N m]."""
    gravity = GravityModel(load_robot(robot))
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, gravity.n))
    return q, gravity.torque(q)


def fitted_learner(name, robot="2r", symmetric=True, count=60):
    """One of `MAKERS`, fitted, with or without the robot's group."""
    group = primary_symmetries(GravityModel(load_robot(robot)).potential) if symmetric else None
    q, torque = samples(robot, count)
    return MAKERS[name](robot, group).fit(q, torque)


def far_queries(joints, count=40):
    """Configurations beyond one turn, some on angles that are special."""
    rng = np.random.default_rng(1)
    q = rng.uniform(-7.0, 7.0, (count, joints))
    return np.concatenate([q, 0.3 + 1e-3 * rng.normal(size=(4, joints))])
