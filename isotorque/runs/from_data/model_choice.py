"""The model that recordings are learned with unless one is named: by errors at poses left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.learners.cross_validation import CrossValidation, cross_validate
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.misread_samples import other_reading
from isotorque.learning.learners.rigid.near_fit import near_fit
from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.learning.statistics.causes.cause import Cause
from isotorque.learning.statistics.causes.cause_words import causes_in_words
from isotorque.learning.statistics.causes.extension import Kind
from isotorque.learning.statistics.poses import by_pose_and_side, group_poses, poses_and_sides
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.load_robot import Robot

Array = NDArray[np.float64]

PARAMETRIC, RIGID, WITH_PROCESS = CHOICES = (
    "parametric",
    "rigid-chain",
    "rigid-chain+gaussian-process",
)
"""Simplest first: known kinematics, any rigid links, any smooth rest beside them."""
FOLDS = 10
LEAVE_ONE_OUT = 20
"""Up to so many poses each is left out by itself."""
WORSE = 2.0
"""A simpler model is worse than the best if its squared errors at poses left out are larger by so
many standard errors of the difference, ..."""
NOTICEABLE = 1.1
"""... and its RMS error by this factor."""
FEW, MANY = 12, 200
"""Poses from which processes are tried, and to which: their time grows with the cube."""


@dataclass(frozen=True, eq=False)
class Contender:
    """A model that was tried.

    Attributes
    ----------
    name : str
        As the registry of learners knows it.
    learner : RigidChain, StaticRegressor or RigidChainProcess
        Fitted to all samples.
    held_out : CrossValidation or None
        Its errors at poses left out; None where it cannot be used, or there is one pose.
    reason : str
        Why it cannot be used; empty where it can.
    """

    name: str
    learner: Any
    held_out: CrossValidation | None
    reason: str = ""

    @property
    def usable(self) -> bool:
        """Whether it may be asked for torques."""
        return not self.reason

    @property
    def causes(self) -> tuple[Cause, ...]:
        """What it names beside gravity."""
        return tuple(getattr(self.learner, "causes_", ()))


@dataclass(frozen=True, eq=False)
class ModelChoice:
    """What was tried, and what was chosen.

    Attributes
    ----------
    samples : StaticSamples
        One per pose and direction of approach, those after a change of the payload left out.
    label : (N,) int array
        Which of the samples every row belongs to; -1: to none of them.
    still : (m, n) array
        Their torques without friction [N m].
    friction : (n,) array
        Torque against the direction of the last motion [N m].
    causes : tuple of Cause
        What the samples show beside gravity, by the model that was chosen.
    contenders : tuple of Contender
    chosen : Contender or None
        None where nothing can be used.
    left_out : int
        Poses after a change of the payload.
    reading : str or None
        What would make the samples those of a rigid chain, where they are none as they stand.
    remarks : tuple of str
    """

    samples: StaticSamples
    label: NDArray[np.intp]
    still: Array
    friction: Array
    causes: tuple[Cause, ...]
    contenders: tuple[Contender, ...]
    chosen: Contender | None
    left_out: int
    reading: str | None
    remarks: tuple[str, ...]

    @property
    def outliers(self) -> NDArray[np.bool_]:
        """Rows (N,) that stand out at poses left out, by the model that was chosen."""
        found = None if self.chosen is None else self.chosen.held_out
        if found is None:
            return np.zeros(len(self.label), dtype=bool)
        return np.asarray(found.outliers[self.label] & (self.label >= 0))

    @property
    def rigid(self) -> RigidChain:
        """The rigid chain, accepted or not."""
        (chain,) = (c.learner for c in self.contenders if c.name == RIGID)
        return chain


def choose_model(
    samples: StaticSamples,
    robot: RobotOptions | Robot | str | None = None,
    *,
    torque_noise: float | None = None,
    angle_noise: float = 0.0,
    seed: int = 0,
    joint_names: tuple[str, ...] = (),
    report: Callable[[str], Any] = lambda _: None,
) -> ModelChoice:
    """Learn samples with every model that may hold, and choose by errors at poses left out.

    Parameters
    ----------
    samples : StaticSamples
        Rows of one pose count as one, those from either side as one of either.
    robot : Robot, RobotOptions or str, optional
        The arm, if its kinematics is known: masses are not looked at.
    torque_noise, angle_noise : float
        Standard deviations where they are known [N m], [rad].
    seed : int
        Of random starts and of the parts that are left out.
    joint_names : tuple of str
        For remarks; by default joints are numbered from 1.
    report : callable
        Called with the name of each model before it is learned.

    Returns
    -------
    ModelChoice

    Notes
    -----
    The simplest model is chosen that is not clearly worse than the best at poses left out
    (`WORSE`). What is left out is left out of every fit; both sides of one pose are left out
    together. Friction that the directions show is taken off first, and so are samples after a
    change of the payload. A process beside the rigid chain is learned from `FEW` to `MANY` poses.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-2.0, 2.0, (30, 2))
    >>> lower = 6.13 * np.cos(q.sum(axis=1))
    >>> tau = np.stack([18.39 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> tau += 0.05 * rng.normal(size=q.shape) + [0.0, 0.4]
    >>> found = choose_model(StaticSamples(q, tau))
    >>> print(found.chosen.name, [str(cause.kind) for cause in found.causes])
    rigid-chain ['offset']
    >>> bool(0.04 < found.chosen.held_out.rmse < 0.065)  # the noise is 0.05
    True
    """
    rows = np.ones(len(samples.q))
    q, tau, sides, _ = by_pose_and_side(samples.q, samples.tau, samples.directions, rows)
    label = poses_and_sides(samples.q, samples.directions).label
    joint_names = joint_names or tuple(f"joint {j + 1}" for j in range(q.shape[1]))
    chooser = _Chooser(robot, torque_noise, angle_noise, seed, joint_names, report)
    return chooser.choose(StaticSamples(q, tau, directions=sides), label)


@dataclass(frozen=True, eq=False)
class _Chooser:
    robot: RobotOptions | Robot | str | None
    torque_noise: float | None
    angle_noise: float
    seed: int
    names: tuple[str, ...]
    report: Callable[[str], Any]

    def choose(self, samples: StaticSamples, label: NDArray[np.intp]) -> ModelChoice:
        """Learn, and choose."""
        remarks: list[str] = []
        parametric, chain = self._rigid(samples)
        since = _load_changes(parametric, chain)
        left_out = 0 if since is None else len(samples.q) - since
        if since is not None:
            remarks.append(
                f"the payload changes with pose {since + 1} of {len(samples.q)}: the model is of "
                f"the arm before, from {since} poses"
            )
            samples = samples.part(np.arange(since))
            label = np.where(label < since, label, -1)
            parametric, chain = self._rigid(samples)
        friction = _friction(parametric, chain)
        still = samples.tau
        if samples.directions is not None:
            still = still - friction * samples.directions
        poses = group_poses(samples.q)
        learners: list[tuple[str, Any, str]] = []
        if parametric is not None:
            learners.append((PARAMETRIC, parametric, ""))
        learners.append((RIGID, chain, "" if chain.verdict_.accepted else chain.remark_))
        exact, reading = chain.verdict_ is FitStatus.ROUNDING, None
        if chain.verdict_ is FitStatus.MISFIT:
            reading = other_reading(chain, samples.q, still, self.names)
        if reading is not None:
            remarks.append(f"a rigid chain explains all of them if {reading}")
        elif not exact and FEW <= poses.count <= MANY:
            self.report(WITH_PROCESS)
            process = RigidChainProcess(torque_noise=self.torque_noise, random_state=self.seed).fit(
                samples.q, still
            )
            learners.append(
                (WITH_PROCESS, process, "" if process.verdict_.accepted else process.remark_)
            )
        elif not exact and poses.count > MANY:
            remarks.append(f"no process was tried beside the chain: more than {MANY} poses")
        contenders = tuple(
            Contender(name, learner, self._held_out(learner, samples.q, still, reason), reason)
            for name, learner, reason in learners
        )
        chosen = _chosen(contenders)
        causes = () if chosen is None else chosen.causes
        if chosen is not None and not causes:  # a process names nothing
            causes = _first_causes(parametric, chain)
        return ModelChoice(
            samples,
            label,
            still,
            friction,
            causes,
            contenders,
            chosen,
            left_out,
            reading,
            tuple(remarks),
        )

    def _rigid(self, samples: StaticSamples) -> tuple[StaticRegressor | None, RigidChain]:
        """The models of rigid links, with what the samples show beside them."""
        parametric = None
        if self.robot is not None:
            self.report(PARAMETRIC)
            parametric = StaticRegressor(self.robot).fit(
                samples.q, samples.tau, directions=samples.directions
            )
        self.report(RIGID)
        stated = self.torque_noise is not None or self.angle_noise
        chain = RigidChain(
            torque_noise=(self.torque_noise or 0.0) if stated else None,
            angle_noise=self.angle_noise,
            random_state=self.seed,
        ).fit(samples.q, samples.tau, directions=samples.directions)
        return parametric, chain.with_causes() or chain

    def _held_out(
        self, learner: Any, q: Array, still: Array, reason: str
    ) -> CrossValidation | None:
        poses = group_poses(q)
        if reason or poses.count < 2:
            return None
        folds = poses.count if poses.count <= LEAVE_ONE_OUT else FOLDS
        rng = np.random.default_rng(self.seed)
        return cross_validate(lambda: near_fit(learner), q, still, rng, folds=folds, poses=poses)


def _load_changes(parametric: StaticRegressor | None, chain: RigidChain) -> int | None:
    """First sample with another payload; None where there is none."""
    for cause in _first_causes(parametric, chain):
        if cause.kind is Kind.PAYLOAD:
            return cause.since
    return None


def _first_causes(parametric: StaticRegressor | None, chain: RigidChain) -> tuple[Cause, ...]:
    """What the samples show, by the model that knows the kinematics if there is one."""
    if parametric is not None:
        return parametric.causes_
    return chain.causes_ or chain.shown_causes()


def _friction(parametric: StaticRegressor | None, chain: RigidChain) -> Array:
    if parametric is not None:
        return parametric.beside_.friction
    return chain.shown_friction()


def _chosen(contenders: tuple[Contender, ...]) -> Contender | None:
    """The simplest that is not clearly worse than the best."""
    usable = [c for c in contenders if c.usable]
    tried = [c for c in usable if c.held_out is not None]
    if not tried:
        return usable[0] if usable else None
    kept = ~np.any([_outliers(c) for c in tried], axis=0)
    kept = kept if kept.any() else np.ones(len(kept), dtype=bool)
    squares = [_squares(c)[kept] for c in tried]
    best = min(range(len(tried)), key=lambda i: float(squares[i].mean()))
    for contender, own in zip(tried, squares, strict=True):
        more = own - squares[best]
        error = np.std(more, ddof=1) / np.sqrt(len(more)) if len(more) > 1 else 0.0
        noticeable = own.mean() > NOTICEABLE**2 * squares[best].mean()
        if not (noticeable and more.mean() > WORSE * error):
            return contender
    return tried[best]


def _squares(contender: Contender) -> Array:
    """Squared error of every pose left out, summed over joints."""
    assert contender.held_out is not None
    return contender.held_out.poses.means(contender.held_out.errors**2).sum(axis=1)


def _outliers(contender: Contender) -> NDArray[np.bool_]:
    """Poses with a sample that stands out."""
    found = contender.held_out
    assert found is not None
    return np.bincount(found.poses.label, found.outliers, found.poses.count) > 0


def choice_in_words(choice: ModelChoice, names: tuple[str, ...] = ()) -> tuple[str, ...]:
    """What was tried and chosen, one sentence each."""
    said = []
    for contender in choice.contenders:
        if contender.held_out is not None:
            said.append(f"{contender.name} {contender.held_out.rmse_of_others:.3g} N m")
        elif contender.reason:
            said.append(f"{contender.name}: {contender.reason}")
    chosen = "nothing" if choice.chosen is None else choice.chosen.name
    lines = [f"chosen: {chosen} (errors at poses left out: {'; '.join(said)})"]
    if choice.causes:
        lines.append(f"beside gravity: {causes_in_words(choice.causes, names)}")
    return (*lines, *choice.remarks)
