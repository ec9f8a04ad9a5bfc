"""The learners by the names the command line knows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup

FEW, SOME = 18, 30
"""Hidden units of a network, as in the paper: for two joints or few samples, and otherwise."""
MANY_SAMPLES = 150


@dataclass(frozen=True)
class LearningTask:
    """Expected samples and torques of a task; they decide the settings of batch learners.

    Attributes
    ----------
    joints : int
        Number of joints; 0 where it is not known.
    samples : int
        Number of samples to come; 0 where it is not known.
    noisy : bool
        Whether the samples have errors that must not be learned.
    robot : RobotOptions, str or None
        Built-in name or file of the arm, for ``parametric``, which is told the kinematics.
    seed : int
        Seed of random starts.
    turning : tuple of bool or None
        Joints whose angles count modulo a full turn; None: all.
    parameters : mapping
        Parameters of the learner that replace its usual ones, by name.
    """

    joints: int = 0
    samples: int = 0
    noisy: bool = False
    robot: RobotOptions | str | None = None
    seed: int = 0
    turning: tuple[bool, ...] | None = None
    parameters: Mapping[str, Any] = field(default_factory=dict)


Factory = Callable[[SymmetryGroup | None, LearningTask], Any]


def _local_linear_map(group: SymmetryGroup | None, task: LearningTask) -> Any:
    from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap

    return LocalLinearMap(radius=0.15, group=group)


def _local_linear_map_it(group: SymmetryGroup | None, task: LearningTask) -> Any:
    from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap

    return LocalLinearMap(
        radius=0.3,
        kernel_width=2.5,
        inner_iterations=None,
        relaxation=0.6,
        replay=60,
        group=group,
    )


def _recursive_least_squares(group: SymmetryGroup | None, task: LearningTask) -> Any:
    from isotorque.learning.learners.local_linear.recursive_least_squares import (
        RecursiveLeastSquares,
    )

    return RecursiveLeastSquares(group=group)


def _trigonometric(group: SymmetryGroup | None, task: LearningTask) -> Any:
    from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric

    return EquivariantTrigonometric(group=group)


def _gaussian_process(group: SymmetryGroup | None, task: LearningTask) -> Any:
    from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
        SymmetricGaussianProcess,
    )

    noise = None if task.noisy else 0.0
    return SymmetricGaussianProcess(noise, group=group, random_state=task.seed)


def _network(group: SymmetryGroup | None, task: LearningTask) -> Any:
    from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork

    return FeedForwardNetwork(
        SOME if task.joints > 2 and task.samples >= MANY_SAMPLES else FEW,
        validation_fraction=0.15 if task.noisy else 0.0,
        group=group,
        random_state=task.seed,
    )


def _parametric(group: SymmetryGroup | None, task: LearningTask) -> Any:
    from isotorque.learning.learners.rigid.static_regressor import StaticRegressor

    # the kinematics implies the relations; copies by measured ones would add their errors
    return StaticRegressor(task.robot, group=None if task.noisy else group)


def _rigid_chain(group: SymmetryGroup | None, task: LearningTask) -> Any:
    from isotorque.learning.learners.rigid.rigid_chain import RigidChain

    # no group: a chain has the symmetries of what it explains
    return RigidChain(random_state=task.seed)


def _rigid_chain_process(group: SymmetryGroup | None, task: LearningTask) -> Any:
    from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess

    return RigidChainProcess(random_state=task.seed)


ONLINE_LEARNERS: dict[str, Factory] = {
    "local-linear-map": _local_linear_map,
    "local-linear-map-it": _local_linear_map_it,
    "recursive-least-squares": _recursive_least_squares,
}
"""Learners that take samples one by one (``partial_fit``) and estimate from the first one on."""

BATCH_LEARNERS: dict[str, Factory] = {
    "trigonometric": _trigonometric,
    "gaussian-process": _gaussian_process,
    "network": _network,
    "parametric": _parametric,
    "rigid-chain": _rigid_chain,
    "rigid-chain+gaussian-process": _rigid_chain_process,
}
"""Learners that are fitted to all samples at once (``fit``)."""

LEARNERS = {**ONLINE_LEARNERS, **BATCH_LEARNERS}

LEADER = "local-linear-map-it"
"""The online learner that leads an arm where the samples are for a batch learner."""

EQUIVARIANT_LEARNERS = frozenset({"recursive-least-squares", "trigonometric", "network"})
"""Learners whose predictions obey the relations they exploit exactly, to rounding."""


SAVED_LEARNERS = (
    "EquivariantTrigonometric",
    "FeedForwardNetwork",
    "LocalLinearMap",
    "RecursiveLeastSquares",
    "RigidChain",
    "RigidChainProcess",
    "StaticRegressor",
    "SymmetricGaussianProcess",
)
"""Classes of learners, by the names that saved models give them."""


def learner_class(name: str) -> Any:
    """Return a class of `SAVED_LEARNERS`, imported when it is first asked for.

    Raises
    ------
    InputError
        If there is none of that name.

    Examples
    --------
    >>> learner_class("LocalLinearMap").__name__
    'LocalLinearMap'
    """
    match name:
        case "EquivariantTrigonometric":
            from isotorque.learning.learners.rigid.equivariant_trigonometric import (
                EquivariantTrigonometric,
            )

            return EquivariantTrigonometric
        case "FeedForwardNetwork":
            from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork

            return FeedForwardNetwork
        case "LocalLinearMap":
            from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap

            return LocalLinearMap
        case "RecursiveLeastSquares":
            from isotorque.learning.learners.local_linear.recursive_least_squares import (
                RecursiveLeastSquares,
            )

            return RecursiveLeastSquares
        case "RigidChain":
            from isotorque.learning.learners.rigid.rigid_chain import RigidChain

            return RigidChain
        case "RigidChainProcess":
            from isotorque.learning.learners.rigid.process.rigid_chain_process import (
                RigidChainProcess,
            )

            return RigidChainProcess
        case "StaticRegressor":
            from isotorque.learning.learners.rigid.static_regressor import StaticRegressor

            return StaticRegressor
        case "SymmetricGaussianProcess":
            from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
                SymmetricGaussianProcess,
            )

            return SymmetricGaussianProcess
        case _:
            raise InputError("learner", "class", name, ", ".join(SAVED_LEARNERS))


def check_learner(name: str) -> str:
    """Return the name of a learner, checked.

    Raises
    ------
    InputError
        If there is no learner of that name.
    """
    if name not in LEARNERS:
        raise InputError("learner", "name", name, ", ".join(sorted(LEARNERS)))
    return name


def learner_by_name(name: str, group: SymmetryGroup | None, task: LearningTask) -> Any:
    """Return a fresh learner, with ``fit`` and ``predict``.

    Parameters
    ----------
    name
        ``local-linear-map``: Eq. 17-22 as printed. ``local-linear-map-it``: each sample learned
        to convergence, wider kernels and replay. ``recursive-least-squares``: all parameters
        jointly, on an exactly equivariant basis. ``trigonometric``: the form of rigid gravity with
        unknown coefficients. ``gaussian-process``, ``network``: any smooth torque.
        ``parametric``: masses and first moments of the arm of ``task.robot``. ``rigid-chain``:
        rigid links in series, geometry and masses unknown; needs no relations.
        ``rigid-chain+gaussian-process``: the same, with cables, springs and bending.
    group
        Relations to exploit; None: no symmetries.
    task
        What is known of the samples.

    Raises
    ------
    InputError
        If there is no learner of that name.

    Examples
    --------
    >>> learner_by_name("network", None, LearningTask(joints=3, samples=300)).hidden
    30
    """
    learner = LEARNERS[check_learner(name)](group, task)
    if task.parameters:
        learner.set_params(**task.parameters)
        learner._check_parameters()
    return learner


def online_learner(
    name: str, group: SymmetryGroup | None, parameters: Mapping[str, Any] | None = None
) -> Any:
    """Return a fresh learner that takes samples one by one.

    Parameters
    ----------
    name, group
        As of `learner_by_name`.
    parameters
        Parameters that replace the usual ones, by name.

    Raises
    ------
    InputError
        If there is no online learner of that name.

    Examples
    --------
    >>> online_learner("local-linear-map", None).radius
    0.15
    """
    if name not in ONLINE_LEARNERS:
        raise InputError("learner", "name", name, ", ".join(sorted(ONLINE_LEARNERS)))
    return learner_by_name(name, group, LearningTask(parameters=parameters or {}))
