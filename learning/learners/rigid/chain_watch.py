"""A rigid chain found while the samples come in, and tried on every sample that comes later."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.fitting.acceptance import EXACT
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus, NotAccepted
from isotorque.learning.learners.rigid.planning.poses_needed import fewest_poses
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.symbolic.common.angles import wrap

Array = NDArray[np.float64]

ROWS_AT_FIRST = 64
"""Rows that memory is taken for at first."""
ONE_POSE = 0.1
"""Configurations nearer than this in every joint [rad] are one pose: it is taken once. Torques that
grow step by step, to find out how much a joint takes, hardly move an arm at first."""
STARTS = 100
"""Random starts of a search at most: the next pose brings another one."""
CLOSELY = 8
"""So many poses, from the fewest on, a chain is looked for after each; then it is ..."""
GROWTH = 1.5
"""... when their number has grown by this factor."""
AGREES = 1e-6
"""A chain that explains its samples to rounding predicts others to this share of the torque."""
DEVIATIONS = 6.0
"""Where there is noise, others are predicted within so many standard deviations."""
KNOWN_WITHIN = 0.01
"""A chain knows the map if, noise apart, it errs by no more than this share of the torque."""
CHECKS = 10
"""A chain is confirmed by so many later samples in a row that all agree."""
MOST_ROWS = 500
"""The final chain is fitted to no more samples, evenly taken."""


@dataclass(frozen=True, eq=False)
class ChainKnowledge:
    """Chain after all samples, or why there is none.

    Attributes
    ----------
    learner : RigidChain or None
        Fitted to all samples; None where none was accepted and confirmed.
    poses : int
        Different poses that were seen.
    known_after : int or None
        The fewest poses after which a chain was found that agreed with all samples that came
        later; None without a learner.
    later : int
        Samples that came later: none of them is in the fit that they check.
    largest_error : float
        Of that fit at any joint in those samples [N m]; NaN without a learner.
    taken_free : tuple of int
        Joints that hold no torque and never moved: gravity is taken not to reach them.
    said : str
        The verdict on the learner; without one, what is missing or speaks against it.
    """

    learner: RigidChain | None
    poses: int
    known_after: int | None
    later: int
    largest_error: float
    said: str
    taken_free: tuple[int, ...] = ()


class ChainWatch:
    """Looks for the rigid chain behind the samples of an arm, as early as they allow.

    Parameters
    ----------
    joints : int
        Number of joints n.
    parents : sequence of int or None
        Joint that carries each joint, -1 for the base; None: joints in series.
    random_state : int
        Seed of random starts.

    Attributes
    ----------
    unloaded : (n,) array of bool
        Joints that were found to hold no torque. While they never move, samples tell nothing of
        other angles of them: gravity is taken not to reach them, until they do.

    Notes
    -----
    It is told nothing of the arm beside that. A chain is looked for as soon as `poses_needed`
    poses are known, and accepted by the learner's own test (`RigidChain.verdict_`). Every later
    sample is then predicted *before* it may be learned: one that does not agree starts the search
    anew, with all samples. So what counts in the end is how many poses a chain was found from
    that all later ones agree with.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> watch = ChainWatch(2)
    >>> for q in rng.uniform(-3, 3, (20, 2)):
    ...     lower = 6.13 * np.cos(q.sum())
    ...     watch.add(q, [18.39 * np.cos(q[0]) + lower, lower])
    >>> known = watch.knowledge()
    >>> known.known_after, known.later
    (4, 15)
    """

    def __init__(
        self, joints: int, parents: Sequence[int] | None = None, random_state: int = 0
    ) -> None:
        self.parents, self.random_state = parents, random_state
        self._q, self._torque = np.empty((2, ROWS_AT_FIRST, joints))
        self._rng = np.random.default_rng(random_state)
        self._elsewhere = np.empty_like(self._q)
        self.unloaded = np.zeros(joints, dtype=bool)
        self.poses = 0
        self._fits: list[tuple[int, RigidChain]] = []
        self._agreed = 0
        self._stands = False
        self._said = "no samples"
        self._known: ChainKnowledge | None = None
        self._fewest = self._next = fewest_poses(joints, parents)

    @property
    def samples(self) -> tuple[Array, Array]:
        """Different poses (m, n) [rad] and the torques that held them (m, n) [N m]."""
        return self._q[: self.poses], self._torque[: self.poses]

    @property
    def learner(self) -> RigidChain | None:
        """The chain that was accepted last, if it stands against all samples since."""
        return self._fits[-1][1] if self._stands else None

    @property
    def confirmed(self) -> RigidChain | None:
        """The same, once enough later samples agree with it."""
        return self.learner if self._agreed >= CHECKS else None

    def add(self, q: ArrayLike, torque: ArrayLike) -> None:
        """Take in the torque (n,) [N m] that held a configuration (n,) [rad]."""
        configuration, held = np.asarray(q, dtype=float), np.asarray(torque, dtype=float)
        near = np.abs(wrap(self._q[: self.poses] - configuration)) < ONE_POSE
        if np.any(np.all(near, axis=1)):
            return
        if self._stands:
            if np.all(_agreement(self._fits[-1][1], configuration[None], held[None])):
                self._agreed += 1
            else:
                self._stands, self._agreed = False, 0
                self._next = min(self._next, self.poses + 1)
        if self.poses == len(self._q):
            self._q, self._torque, self._elsewhere = (
                np.concatenate([x, np.empty_like(x)])
                for x in (self._q, self._torque, self._elsewhere)
            )
        self._q[self.poses], self._torque[self.poses] = configuration, held
        self._elsewhere[self.poses] = self._rng.uniform(-np.pi, np.pi, len(held))
        self.poses += 1
        exact = self._stands and self._fits[-1][1].verdict_ is FitStatus.ROUNDING
        if self.poses >= self._next and not exact:
            self._search()

    def partial_fit(self, X: Any, y: Any, sample_weight: Any = None) -> ChainWatch:
        """Take in samples (m, n) [rad], (m, n) [N m]; weights do not matter."""
        for q, torque in zip(np.asarray(X), np.asarray(y), strict=True):
            self.add(q, torque)
        return self

    def predict(self, X: Any) -> Array:
        """Torques (m, n) [N m] by the chain that was accepted last, standing or not.

        Raises
        ------
        NotAccepted
            If none was accepted yet.
        """
        if not self._fits:
            raise NotAccepted(FitStatus.TOO_FEW, self._said)
        return self._fits[-1][1].predict(X)

    def fits(self) -> tuple[tuple[int, RigidChain], ...]:
        """Every chain that was accepted, with the number of poses it was fitted to."""
        return tuple(self._fits)

    def knowledge(self) -> ChainKnowledge:
        """Fit the chain to all samples, if one was found that later samples agree with."""
        if self._known is None or self._known.poses != self.poses:
            self._known = self._conclude()
        return self._known

    def _conclude(self) -> ChainKnowledge:
        q, torque = self.samples
        agreeing = [
            (count, learner)
            for count, learner in self._fits
            if np.all(_agreement(learner, q[count:], torque[count:]))
            and (self.poses - count >= CHECKS or learner.verdict_ is FitStatus.ROUNDING)
        ]
        if not agreeing:
            return ChainKnowledge(None, self.poses, None, 0, math.nan, self._against())
        final = self._final(agreeing[0][1])
        if not final.verdict_.accepted:
            said = _said(final)
            return ChainKnowledge(None, self.poses, None, 0, math.nan, said)
        # few noisy samples say little, and then much agrees with it: that is not to know the map
        largest = float(np.abs(torque).max())
        near = KNOWN_WITHIN * largest + DEVIATIONS * final.fit_.samples.torque_noise
        for count, learner in agreeing:
            later = self.poses - count
            if np.all(np.abs(learner.predict(q[count:]) - torque[count:]) <= near):
                break
        free = tuple(np.flatnonzero(self._taken_free()).tolist())
        error = np.abs(learner.predict(q[count:]) - torque[count:]).max(initial=0.0)
        said = str(final.verdict_)
        return ChainKnowledge(final, self.poses, count, later, float(error), said, free)

    def _taken_free(self) -> NDArray[np.bool_]:
        """Joints that hold no torque and never moved."""
        q, _ = self.samples
        return self.unloaded & (np.ptp(q, axis=0) < ONE_POSE)

    @property
    def learned(self) -> tuple[Array, Array]:
        """The samples as they are learned: at any angle of a joint that gravity does not reach."""
        q, torque = self.samples
        return np.where(self._taken_free(), self._elsewhere[: self.poses], q), torque

    def _final(self, found: RigidChain) -> RigidChain:
        """The chain of all samples, with right angles and without levers where they allow it."""
        q, torque = self.learned
        rows = np.unique(np.linspace(0, self.poses - 1, MOST_ROWS).round().astype(int))
        final = self._new()
        final.fit(q[rows], torque[rows])
        if final.verdict_.accepted:
            final.simplified()
            return final
        # joints that hardly moved leave a general chain open, and not one with right angles
        simple = copy.deepcopy(found)
        limit = EXACT * float(np.abs(torque).max())
        if simple.simplified() and np.sqrt(np.mean((simple.predict(q) - torque) ** 2)) <= limit:
            return simple
        return final

    def _new(self) -> RigidChain:
        return RigidChain(self.parents, max_starts=STARTS, random_state=self.random_state)

    def _search(self) -> None:
        q, torque = self.learned
        if self._stands:  # a better fit of the same chain
            done, last = self._fits[-1]
            learner = copy.deepcopy(last)
            learner.partial_fit(q[done:], torque[done:])
        else:
            learner = self._new()
            learner.fit(q[-learner.window :], torque[-learner.window :])
        close = self.poses < self._fewest + CLOSELY
        self._next = self.poses + 1 if close else math.ceil(GROWTH * self.poses)
        if learner.verdict_.accepted:
            if not self._stands:
                self._agreed = 0
            self._stands = True
            self._fits.append((self.poses, learner))
        self._said = _said(learner)

    def _against(self) -> str:
        if self.poses < self._fewest:
            return f"{self.poses} poses are too few: {self._fewest} are needed"
        if not self._fits:
            return self._said
        return f"later samples contradicted what was found from {self._fits[-1][0]} poses"


def _said(learner: RigidChain) -> str:
    verdict = str(learner.verdict_)
    return f"{verdict}: {learner.remark_}" if learner.remark_ else verdict


def _agreement(learner: RigidChain, q: Array, torque: Array) -> NDArray[np.bool_]:
    """Which torques (m, n) agree with what a chain predicts, having not been told them."""
    if not len(q):
        return np.ones(q.shape, dtype=bool)
    error = np.abs(learner.predict(q) - torque)
    samples = learner.fit_.samples
    largest = max(samples.largest_torque, float(np.abs(torque).max()))
    if learner.verdict_ is FitStatus.ROUNDING:
        return np.asarray(error <= AGREES * largest)
    deviation = np.hypot(samples.torque_noise, learner.standard_error(q))
    return np.asarray(error <= np.maximum(DEVIATIONS * deviation, AGREES * largest))
