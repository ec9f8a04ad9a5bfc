"""Right angles and absent levers that the samples do not contradict."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.chain_search import (
    ROUNDED,
    Constraint,
    SearchedChain,
    minimise,
)
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.planning.information import Information
from isotorque.learning.learners.rigid.structure.canonical_form import RIGHT_ANGLE, CanonicalForm
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LEVEL = 1e-3
"""Chance at which a right angle or an absent lever is given up though it is true."""
TENABLE = 1e-6
"""Chance at which all hypotheses together are given up. Fitted chains with nearly parallel axes
follow the noise with more than their parameters, so it must be small."""
POWER = 0.95
"""A deviation of the size that is called visible would have been seen as often as this."""


@dataclass(frozen=True)
class Hypothesis:
    """One thing that was set to a special value.

    Attributes
    ----------
    joint : int
        From 0.
    kind : str
        ``twist``, ``offset``, ``lever x`` or ``lever y``.
    value : float
        Angle [rad]; 0 for a lever.
    p_value : float
        Chance of a misfit that grows as much, if it is true.
    visible : float
        Deviation [rad or N m] that would have been seen; inf where gravity does not tell.
    """

    joint: int
    kind: str
    value: float
    p_value: float
    visible: float

    def __str__(self) -> str:
        lever = self.kind.startswith("lever")
        size, unit = (self.visible, "N m") if lever else (np.rad2deg(self.visible), "deg")
        seen = f"{size:.2g} {unit} would have been seen"
        if not np.isfinite(size):
            seen = "torques do not tell, to first order"
        if lever:
            return f"joint {self.joint + 1}: {self.kind} is 0 N m (p = {self.p_value:.2g}; {seen})"
        return (
            f"joint {self.joint + 1}: {self.kind} is {np.rad2deg(self.value):.0f} deg "
            f"(p = {self.p_value:.2g}; {seen})"
        )


@dataclass(frozen=True, eq=False)
class SnappedChain:
    """A chain with right angles and without levers where the samples do not contradict that.

    Attributes
    ----------
    form : CanonicalForm
        Its offsets, twists and levers.
    chain : ChainParameters
        The same as a chain; right angles and zeros are exact.
    hypotheses : tuple of Hypothesis
        What was snapped.
    p_value : float
        Of all of them together.
    cost : float
        Sum of squares of whitened torque errors.
    """

    form: CanonicalForm
    chain: ChainParameters
    hypotheses: tuple[Hypothesis, ...]
    p_value: float
    cost: float

    @property
    def smallest_visible_lever(self) -> float:
        """The largest lever [N m] that may have been overlooked; 0 if none was set to zero."""
        return max(
            (
                h.visible
                for h in self.hypotheses
                if h.kind.startswith("lever") and np.isfinite(h.visible)
            ),
            default=0.0,
        )


@single_thread()
def snapped(fit: ChainFit, level: float = LEVEL) -> SnappedChain:
    """Set angles to multiples of a right angle and levers to zero where samples allow it.

    Parameters
    ----------
    fit : ChainFit
        An accepted fit.
    level : float
        Level of the likelihood ratio test of every single hypothesis.

    Notes
    -----
    Base to tip: first twists, until no more can be set, as offsets between parallel axes mean
    nothing; then offsets; then levers, the least significant first. Every hypothesis is tried by
    fitting everything else anew. What comes out is a hypothesis that the samples do not
    contradict, not a finding.
    """
    return _Snapping(fit, level).run()


class _Snapping:
    def __init__(self, fit: ChainFit, level: float) -> None:
        self._fit = fit
        n = fit.model.n
        self._form = CanonicalForm.of(fit.chain)
        self._turns = np.ones(2 * n, dtype=bool)
        self._turns[2 * np.flatnonzero(fit.model.parents < 0)] = False
        self._levers = np.ones(2 * n, dtype=bool)
        exact = fit.verdict is FitStatus.ROUNDING
        degrees = max(fit.degrees, 1)
        self._unit = 1.0
        if fit.verdict is FitStatus.HELD_OUT:
            self._unit = fit.cost / degrees
            self._threshold = float(stats.f.isf(level, 1, degrees)) * self._unit
        else:
            self._threshold = float(stats.chi2.isf(level, 1))
        self._enough = ROUNDED * fit.samples.equations if exact else 0.0
        self._cost = fit.cost
        self._settled = False  # whether twists are done: signs stay as they are from then on
        self._found: list[tuple[int, str, float, float]] = []
        self._visible_at = float(np.sqrt(stats.chi2.isf(level, 1)) + stats.norm.ppf(POWER))

    def run(self) -> SnappedChain:
        self._drop_meaningless()
        better = self._fitted(self._form, self._turns, self._levers)
        if better.cost < self._cost:
            self._accept(better, self._turns, self._levers)
        before = -1
        while len(self._found) > before:  # axes that were set make others better known
            before = len(self._found)
            for joint in range(self._fit.model.n):
                self._try_angle(joint, 1)
        self._settled = True
        for joint in range(self._fit.model.n):
            self._try_angle(joint, 0)
        self._drop_levers()
        chain = self._form.parameters()
        hypotheses = tuple(self._hypotheses(chain))
        return SnappedChain(
            self._form, chain, hypotheses, self._p_value(self._cost, len(hypotheses)), self._cost
        )

    def _p_value(self, cost: float, count: int) -> float:
        """Chance of a misfit that grows as much, if all hypotheses are true."""
        growth, count = max(cost - self._fit.cost, 0.0) / self._unit, max(count, 1)
        if self._fit.verdict is FitStatus.HELD_OUT:
            return float(stats.f.sf(growth / count, count, max(self._fit.degrees, 1)))
        return float(stats.chi2.sf(growth, count))

    def _tenable(self, cost: float) -> bool:
        """Whether one more hypothesis leaves all of them together likely enough."""
        return self._p_value(cost, len(self._found) + 1) >= TENABLE

    def _fitted(self, form: CanonicalForm, turns: Mask, levers: Mask) -> SearchedChain:
        return minimise(
            self._fit.samples,
            form.parameters(),
            self._fit.model.free_gains,
            self._fit.whitening,
            constraint=Constraint(turns, levers),
            progress=1e-9,
            enough=self._enough,
        )

    def _accept(self, found: SearchedChain, turns: Mask, levers: Mask) -> None:
        self._cost, self._turns, self._levers = found.cost, turns, levers
        self._form = (CanonicalForm.read if self._settled else CanonicalForm.of)(found.chain)
        # what was set stays exact
        for joint, kind, value, _ in self._found:
            if kind == "twist":
                self._form.twists[joint] = value
            elif kind == "offset":
                self._form.offsets[joint] = value
        self._form.levers[~levers.reshape(-1, 2)] = 0.0
        self._drop_meaningless()

    def _try_angle(self, joint: int, which: int) -> None:
        """Set a twist (1) or an offset (0) to the nearest right angles, the first that fits."""
        if not self._turns[2 * joint + which]:
            return
        kind = ("offset", "twist")[which]
        angle = float((self._form.offsets, self._form.twists)[which][joint])
        for value in _nearest(angle, which == 1):
            turns = self._turns.copy()
            turns[2 * joint + which] = False
            parallel = which == 1 and value != RIGHT_ANGLE
            turned = (self._form.offsets.copy(), self._form.twists.copy())
            turned[which][joint] = value
            form = replace(self._form, offsets=turned[0], twists=turned[1])
            if parallel:  # the offset means nothing: it moves into the zeros further out
                turns[2 * joint] = False
                form = CanonicalForm.of(form.parameters())
            found = self._fitted(form, turns, self._levers)
            growth = found.cost - self._cost
            if growth < self._threshold and self._tenable(found.cost):
                p = float(stats.chi2.sf(max(growth, 0.0) / self._unit, 1))
                self._found.append((joint, kind, value, p))
                self._accept(found, turns, self._levers)
                return

    def _drop_meaningless(self) -> None:
        """Offsets seen from a vertical axis change nothing, nor do levers of vertical links."""
        parents = self._fit.model.parents
        vertical = np.zeros(self._fit.model.n, dtype=bool)
        for j, p in enumerate(parents):
            straight = not self._turns[2 * j + 1] and np.sin(self._form.twists[j]) < 1e-12
            vertical[j] = straight and (p < 0 or vertical[p])
            if vertical[j]:
                self._levers[2 * j : 2 * j + 2] = False
                self._form.levers[j] = 0.0
            if p >= 0 and vertical[p]:
                self._turns[2 * j] = False
                self._form.offsets[j] = 0.0

    def _drop_levers(self) -> None:
        """Backward elimination: the lever with the least growth of the misfit goes first."""
        while self._levers.any():
            tried = []
            for c in self._candidates():
                levers = self._levers.copy()
                levers[c] = False
                found = self._fitted(self._form, self._turns, levers)
                tried.append((found.cost - self._cost, c, found, levers))
            if not tried:
                return
            growth, c, found, levers = min(tried, key=lambda t: t[0])
            if growth >= self._threshold or not self._tenable(found.cost):
                return
            p = float(stats.chi2.sf(max(growth, 0.0) / self._unit, 1))
            self._found.append((c // 2, f"lever {'xy'[c % 2]}", 0.0, p))
            self._accept(found, self._turns, levers)

    def _candidates(self) -> list[int]:
        """The levers that stand out least, by their linear standard errors."""
        errors = self._standard_errors(self._form.parameters(), self._turns, self._levers)
        n = self._fit.model.n
        z = np.abs(self._form.levers.ravel()) / errors[2 * n : 4 * n]
        order = [int(c) for c in np.argsort(z) if self._levers[c]]
        limit = 2.0 * np.sqrt(self._threshold / self._unit)
        return [c for c in order if z[c] < limit or not np.isfinite(z[c])][:4]

    def _standard_errors(self, chain: ChainParameters, turns: Mask, levers: Mask) -> Array:
        """Of offset, twist (interleaved) and levers, (4 n,); inf where nothing tells."""
        n, fit = chain.n, self._fit
        free = fit.model.free.copy()
        free[: 2 * n], free[2 * n : 4 * n] = turns, levers
        slopes = chain.derivatives(fit.samples.q, self._form.directions()).by_parameters()
        rows = (fit.whitening @ slopes[:, :, free]).reshape(fit.samples.equations, -1)
        information = Information.of_rows(rows, free)
        result = np.full(4 * n, np.inf)
        every = np.linalg.norm(information.factor, axis=1)
        if len(information.null_space):
            share = np.abs(information.vectors[~information.kept]).max(axis=0)
            every = np.where(share > 1e-6, np.inf, every)
        shaped = np.full(len(free), np.inf)
        shaped[free] = every * np.sqrt(self._unit) * fit.spread
        result[:] = shaped[: 4 * n]
        return result

    def _hypotheses(self, chain: ChainParameters) -> Iterator[Hypothesis]:
        n = chain.n
        for joint, kind, value, p in self._found:
            turns, levers = self._turns.copy(), self._levers.copy()
            position = {"offset": 2 * joint, "twist": 2 * joint + 1}.get(kind)
            if position is None:
                lever = 2 * joint + "xy".index(kind[-1])
                levers[lever] = True
                error = self._standard_errors(chain, turns, levers)[2 * n + lever]
            else:
                turns[position] = True
                error = self._standard_errors(chain, turns, levers)[position]
            yield Hypothesis(joint, kind, value, p, float(self._visible_at * error))


def _nearest(angle: float, twist: bool) -> list[float]:
    """Multiples of a right angle, the nearest two (three for twists) first."""
    values = [0.0, RIGHT_ANGLE, 2 * RIGHT_ANGLE] + ([] if twist else [-RIGHT_ANGLE])
    values.sort(key=lambda v: abs(np.angle(np.exp(1j * (angle - v)))))
    return values[: 3 if twist else 2]
