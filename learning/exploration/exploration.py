"""The loop that every exploration shares: target, estimate, noise, static torques, apply, learn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import Arm, Outcome, Settled
from isotorque.learning.exploration.exploratory_noise import ExploratoryNoise
from isotorque.learning.exploration.explored_share import ExploredShare
from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.exploration.static_projection import StaticTorques, nearest_admissible
from isotorque.learning.exploration.targets import Domain, Phase, Target, TargetSource
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError

Vector = NDArray[np.float64]


class Learner(Protocol):
    """Learner as exploration needs it (scikit-learn's interface)."""

    def partial_fit(self, X: Any, y: Any, sample_weight: Any = None) -> Any:
        """Learn samples (m, n) [rad], (m, n) [N m] with weights (m,)."""
        ...

    def predict(self, X: Any) -> Any:
        """Torques (m, n) [N m] for configurations (m, n) [rad]."""
        ...


@dataclass
class _Window:
    """The samples of the present iteration."""

    q: list[Vector] = field(default_factory=list)
    torque: list[Vector] = field(default_factory=list)


class Exploration:
    """The loop of Algorithm 2: target, estimate, noise, static torques, apply, learn.

    Use one of the named explorations below; this class is what they share.

    Parameters
    ----------
    arm : Arm
        Anything with ``apply``, ``go_home`` and ``q``.
    learner : Learner
        Regressor from configurations to torques; exploits symmetries by itself if at all.
    rng : numpy.random.Generator
        Source of randomness.
    torque_range : (n,) array
        Largest torque of each joint [N m], the unit of the noise. Zero marks a free joint: it is
        commanded zero torque and left out of directions.
    home_torque : (n,) array or None
        Torque that holds the home configuration [N m]; None: zero torque. What it holds is
        observed in the first step and taken as home.
    static_torques : StaticTorques or None
        Set of static torques; None: every torque is applied as it is.
    domain : Domain or None
        Where targets may lie (the BCTS); None: anywhere.
    settings : ExplorationSettings
        Numbers.
    explored : ExploredShare or None
        Watches the share of the domain that has been explored.

    Attributes
    ----------
    counts : Counts
        Running totals.
    finished : bool
        Whether e_max was reached as ``settings`` demand.
    home : (n,) array or None
        Home configuration [rad], known after the first step.
    """

    def __init__(
        self,
        arm: Arm,
        learner: Learner,
        rng: np.random.Generator,
        *,
        torque_range: Any,
        home_torque: Any = None,
        static_torques: StaticTorques | None = None,
        domain: Domain | None = None,
        settings: ExplorationSettings | None = None,
        explored: ExploredShare | None = None,
    ) -> None:
        self.settings = settings if settings is not None else ExplorationSettings()
        self.counts = Counts()
        self.finished = False
        self.home: Vector | None = None
        self._arm = arm
        self._learner = learner
        self._rng = rng
        self._range = _finite_vector("torque_range", torque_range)
        if (self._range < 0).any() or not self._range.any():
            raise InputError("exploration", "torque_range", torque_range, "numbers >= 0, not all 0")
        self._active = self._range > 0
        joints = len(self._range)
        self._home_torque = (
            np.zeros(joints)
            if home_torque is None
            else _finite_vector("home_torque", home_torque, joints)
        )
        weights = self.settings.joint_weights
        self._weights = np.where(
            self._active, 1.0 if weights is None else _finite_vector("joint_weights", weights), 0.0
        )
        self._static_torques = static_torques
        self._domain = domain
        self._explored = explored
        self._noise = ExploratoryNoise(
            self.settings.noise * self._range, self.settings.noise_drift, rng
        )
        self._targets: TargetSource | None = None
        self._previous = np.zeros(joints)
        self._window = _Window()
        self._below = 0

    def steps(self, commands: int) -> Iterator[ExplorationStep]:
        """Command up to ``commands`` torques and yield every step; call again to go on.

        The first step of all applies the home torque from home. Ends early when ``finished``.

        Raises
        ------
        InputError
            If the home torque does not hold the arm.
        """
        for _ in range(commands):
            if self.finished:
                return
            if self.home is None:
                yield self._first_step()
            else:
                yield self._step(self.home)

    def _make_targets(self, home: Vector) -> TargetSource | None:
        raise NotImplementedError

    def _command(self, home: Vector) -> tuple[Target | None, Vector]:
        """Choose a target and the noisy estimate of the torque that holds it (Eq. 14)."""
        assert self._targets is not None
        target = self._targets.next(self._rng)
        estimate = np.asarray(self._learner.predict(target.q[None]))[0]
        torque = estimate + self._noise(np.where(self._active, wrap(target.q - home), 0.0))
        self._noise.step()
        return target, torque

    def _hold_home(self) -> Outcome:
        return self._arm.apply(self._home_torque.copy())

    def _execute(self, target: Target | None, torque: Vector) -> Outcome:
        return self._arm.apply(torque.copy())

    def _first_step(self) -> ExplorationStep:
        self._arm.go_home()
        outcome = self._hold_home()
        self.counts.commands += 1
        if not isinstance(outcome, Settled):
            raise InputError(
                "exploration", "home torque", self._home_torque, "a torque that holds the arm"
            )
        home = self._previous = np.asarray(outcome.q, dtype=float)
        self._targets = self._make_targets(home)
        self.home = home
        self._learn(outcome, 1.0)
        return ExplorationStep(
            0,
            Phase.START,
            home,
            outcome.torque,
            False,
            outcome,
            True,
            1.0,
            np.nan,
            False,
            self._share(),
            self._end_of_window(),
        )

    def _step(self, home: Vector) -> ExplorationStep:
        target, torque = self._command(home)
        wanted = np.where(self._active, torque, 0.0)
        torque = nearest_admissible(self._static_torques, wanted, self.settings.to_boundary)
        projected = torque is not wanted
        self.counts.projected += projected
        outcome = self._execute(target, torque)
        number = self.counts.commands
        self.counts.commands += 1
        settled = isinstance(outcome, Settled)
        weight, alpha, turned = 0.0, np.nan, False
        if settled:
            weight, alpha, turned = self._judge(target, np.asarray(outcome.q, dtype=float))
        learned = settled or self.settings.learn_inadmissible
        if learned:
            weight = weight if settled else 1.0
            self._learn(outcome, weight)
        if settled:
            if turned:
                self.counts.turns += 1
                self._restart(self._previous)
            self._previous = np.asarray(outcome.q, dtype=float)
        else:
            self.counts.inadmissible += 1
            if self._static_torques is not None:
                self._static_torques.mark_inadmissible(outcome.torque)
            self._previous = np.asarray(self._arm.q, dtype=float)
            self._restart(self._previous)
        return ExplorationStep(
            number,
            target.phase if target is not None else Phase.MOTOR,
            target.q if target is not None else None,
            torque,
            projected,
            outcome,
            learned,
            weight,
            alpha,
            turned,
            self._share(),
            self._end_of_window(),
        )

    def _judge(self, target: Target | None, q: Vector) -> tuple[float, float, bool]:
        """Weight (Eq. 16), alpha (Eq. 15) and whether the direction was lost.

        Differences are wrapped and weighted with w; where arm or target do not move at all the
        angle is undefined and its cosine taken as zero.
        """
        if target is None:
            return 1.0, np.nan, False
        moved = self._weights * wrap(q - self._previous)
        wanted = self._weights * wrap(target.q - self._previous)
        lengths = float(np.linalg.norm(wanted) * np.linalg.norm(moved))
        cosine = float(wanted @ moved) / lengths if lengths > 0 else 0.0
        weight = 0.5 * (1.0 + min(1.0, max(-1.0, cosine)))
        if target.phase is not Phase.DIRECTION or target.step is None:
            return weight, np.nan, False
        step = self._weights * target.step
        alpha = float(step @ moved)
        least = np.cos(self.settings.turn_angle) * np.linalg.norm(step) * np.linalg.norm(moved)
        return weight, alpha, bool(alpha < least - 1e-15)

    def _learn(self, outcome: Outcome, weight: float) -> None:
        q = np.asarray(outcome.q, dtype=float)
        torque = np.asarray(outcome.torque, dtype=float)
        self._learner.partial_fit(q[None], torque[None], np.array([weight]))
        self._window.q.append(q)
        self._window.torque.append(torque)
        if isinstance(outcome, Settled):
            self.counts.settled += 1
            if self._static_torques is not None:
                self._static_torques.add(torque)
            if self._explored is not None:
                self._explored.add(q)

    def _restart(self, q: Vector) -> None:
        if self._targets is not None:
            self._targets.restart(q)

    def _share(self) -> float | None:
        return None if self._explored is None else self._explored.value

    def _end_of_window(self) -> float | None:
        """e_val on randomly chosen samples of the iteration, if it is complete (section 5.4)."""
        window = self._window
        if len(window.q) < self.settings.window:
            return None
        self._window = _Window()
        count = min(self.settings.window_samples, len(window.q))
        chosen = self._rng.choice(len(window.q), size=count, replace=False)
        q = np.array(window.q)[chosen]
        error = np.asarray(self._learner.predict(q)) - np.array(window.torque)[chosen]
        rmse = float(np.sqrt(np.mean(error[:, self._active] ** 2)))
        target = self.settings.target_error
        if target is not None:
            self._below = self._below + 1 if rmse <= target else 0
            share = 1.0 if self._explored is None else self._explored.value
            self.finished = (
                self._below >= self.settings.windows_below and share >= self.settings.required_share
            )
        return rmse


def _finite_vector(name: str, value: Any, length: int | None = None) -> Vector:
    vector = np.asarray(value, dtype=float)
    if vector.ndim != 1 or not np.isfinite(vector).all() or length not in (None, len(vector)):
        wanted = "finite numbers" if length is None else f"{length} finite numbers"
        raise InputError("exploration", name, value, f"{wanted}, one per joint")
    return vector


@dataclass(frozen=True, eq=False)
class ExplorationStep:
    """One commanded torque and what became of it.

    Attributes
    ----------
    number : int
        Counts commands from 0 on.
    phase : Phase
        Why the target was chosen.
    target : (n,) array or None
        q*_t [rad]; None in motor babbling.
    torque : (n,) array
        Commanded torque tau+_t [N m].
    projected : bool
        Whether the torque was moved to the nearest static torque.
    outcome : Outcome
        What the arm did.
    learned : bool
        Whether the sample went to the learner.
    weight : float
        w_dir of Eq. 16 (0 where nothing was learned).
    alpha : float
        Eq. 15 [rad^2]; NaN where no direction was followed.
    turned : bool
        Whether the arm left the intended direction: a new one follows from where it was before.
    explored : float or None
        Share of the domain explored so far, where that is watched.
    window_error : float or None
        e_val [N m] where this step ended an iteration.
    """

    number: int
    phase: Phase
    target: Vector | None
    torque: Vector
    projected: bool
    outcome: Outcome
    learned: bool
    weight: float
    alpha: float
    turned: bool
    explored: float | None
    window_error: float | None


@dataclass
class Counts:
    """Running totals of an exploration.

    Attributes
    ----------
    commands, settled, inadmissible, projected, turns : int
        Torques commanded; settled under them; ended at a limit or in a time out; moved to the
        nearest static torque before; directions given up.
    """

    commands: int = 0
    settled: int = 0
    inadmissible: int = 0
    projected: int = 0
    turns: int = 0
