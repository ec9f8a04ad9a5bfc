"""A chain fitted to static samples, accepted or not."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from learning.learners.rigid.chain_parameters import ChainParameters, raw_directions
from learning.learners.rigid.chain_samples import LEAST_FLOOR, ChainSamples
from learning.learners.rigid.chain_search import (
    ChainModel,
    SearchedChain,
    best_of,
    minimise,
    polished,
    search,
    whitened_residuals,
)
from learning.learners.rigid.information import Information, identifiable_count, probe_poses
from learning.learners.rigid.one_thread import one_thread
from learning.learners.rigid.verdict import Verdict

Array = NDArray[np.float64]

EXACT = 1e-9
"""Residuals below, relative to the largest torque, are rounding (of a settling simulator too)."""
KNOWN_EVERYWHERE = 1e-6
"""Exact samples determine a chain if rounding errs by less anywhere, relative to the largest."""
FEWEST_STARTS = 5
"""With noise, the best of at least so many starts counts."""
UNKNOWN_NOISE_STARTS = 20
"""As many where only the samples themselves tell how large the noise is."""
AT_ONCE = 0.05
"""A misfit as likely as this ends the search after the fewest starts."""
LEAST_LIKELY = 1e-4
"""Chains with a less likely misfit are not accepted."""
CARRYING = 4.0
"""The gain of a joint can be found if its torque varies by so many standard errors (RMS),"""
CARRYING_SHARE = (1e-6, 1e-2)
"""and by these shares of the largest: exact samples, noise not stated."""
HELD_OUT_SHARE = 0.05
"""Accepted where noise is unknown: error at poses left out, relative to the torque (both RMS);
less in proportion where there are fewer than four equations per joint to spare."""
FOLDS = 10
RIVAL_COST = 30.0
"""Chains that cost more by this are excluded (likelihood ratio 3e-7)."""
RIVAL_SHARE = 0.05
"""Chains whose torques differ by more, anywhere, relative to the torque (RMS), are others."""
SHRINKING = 3.0
"""Degrees of freedom with which the noise of all joints counts for the noise of each."""


@dataclass(frozen=True, eq=False)
class ChainFit:
    """What a search for a chain ended with.

    Attributes
    ----------
    verdict : Verdict
        Whether the chain may be used, and why.
    chain : ChainParameters
        The best chain found. Where the verdict is not an acceptance it must not be used.
    samples : ChainSamples
        What it was fitted to, with the noise levels that were stated or estimated.
    model : ChainModel
        What was free.
    asked_gains : (n,) bool array
        Which gains are unknown; those of joints without torque stay what they were.
    cost : float
        Sum of squares of whitened torque errors.
    information : Information
        What the samples tell about the parameters.
    starts : int
        Random starts, the one that was given not counted.
    remark : str
        What is missing, or what speaks against the chain; empty where it is accepted.
    p_value : float
        Of the misfit where noise was stated, NaN otherwise.
    held_out : float
        RMS torque error at poses left out [N m] where noise was estimated, NaN otherwise.
    """

    verdict: Verdict
    chain: ChainParameters
    samples: ChainSamples
    model: ChainModel
    asked_gains: NDArray[np.bool_]
    cost: float
    whitening: Array = field(repr=False)
    information: Information = field(repr=False)
    starts: int
    remark: str = ""
    p_value: float = float("nan")
    held_out: float = float("nan")

    @property
    def degrees(self) -> int:
        """Measured torques minus parameters that they determine."""
        return self.samples.equations - self.information.rank

    @property
    def spread(self) -> float:
        """Factor from stated or estimated noise to what the errors are known to be.

        1 with noise; for exact samples whatever rounding there is.
        """
        if self.verdict is Verdict.ROUNDING:
            return max(1e-4, float(np.sqrt(self.cost / max(self.degrees, 1))))
        return 1.0

    def standard_error(self, q: Array) -> Array:
        """Of the torques at q (m, n) [rad], (m, n) [N m]; inf where they are not determined."""
        return self.spread * self.information.standard_error(self.chain, np.atleast_2d(q))


def fit_at(
    chain: ChainParameters,
    samples: ChainSamples,
    model: ChainModel,
    asked_gains: NDArray[np.bool_],
    verdict: Verdict,
    starts: int,
    **more: Any,
) -> ChainFit:
    """What is known of a chain that was found; see `ChainFit` for the arguments."""
    whitening = samples.whitening(chain)
    rest = np.einsum("kij,kj->ki", whitening, samples.torque - chain.torque(samples.q))
    return ChainFit(
        verdict,
        chain,
        samples,
        model,
        asked_gains,
        float(np.sum(rest**2)),
        whitening,
        Information.of(chain, samples.q, whitening, model.free),
        starts,
        **more,
    )


@one_thread()
def fit_chain(
    samples: ChainSamples,
    model: ChainModel,
    rng: np.random.Generator,
    *,
    noise_known: bool,
    starts: int = 300,
    warm: ChainParameters | None = None,
) -> ChainFit:
    """Find the chain behind static samples.

    Parameters
    ----------
    samples
        Static samples with noise levels. If all levels are zero, samples are exact, or the noise
        is unknown.
    model
        What is unknown.
    rng
        Of the random starts.
    noise_known
        Whether the noise levels were stated.
    starts
        Random starts at most.
    warm
        A chain to start from first.

    Notes
    -----
    Starts go on until one explains the samples within their noise (chi-square), to rounding, or,
    where the noise is unknown, predicts poses that were left out. False minima are common (four
    starts of ten end in one on a seven-joint arm), the same ones again and again, so agreement of
    starts is not looked at.
    """
    stated = noise_known and bool(samples.torque_noise.any() or samples.angle_noise.any())
    share = 0.0 if stated else CARRYING_SHARE[0]
    fit = _Search(samples, model, rng, starts)
    fit.model = _with_findable_gains(samples, model, share)
    if warm is not None:
        fit.try_start(warm, warm=True)
    if stated:
        return _within_noise(fit)
    # with gains or offsets unknown, more starts end in false minima
    some = UNKNOWN_NOISE_STARTS * (5 if model.free_gains.any() or model.columns else 1)
    exact = _to_rounding(fit, starts if noise_known else min(starts, some))
    if exact is not None or noise_known:
        return exact or fit.refused(Verdict.MISFIT, _misfit(fit))
    fewer = _with_findable_gains(samples, model, CARRYING_SHARE[1])
    if not np.array_equal(fewer.free_gains, fit.model.free_gains):
        fit.model, fit.found = fewer, []
    return _by_held_out(fit)


def _with_findable_gains(samples: ChainSamples, model: ChainModel, share: float) -> ChainModel:
    """The model with gains free only where the joint carries a torque that stands out.

    The gain of a joint without torque would run away: it lets noise be fitted by a tiny torque.
    """
    varies = np.std(samples.torque, axis=0)
    least = np.maximum(CARRYING * samples.torque_noise, share * samples.largest_torque)
    return replace(model, free_gains=model.free_gains & (varies > least))


class _Search:
    """Starts one after the other; the minima they lead to."""

    def __init__(
        self, samples: ChainSamples, model: ChainModel, rng: np.random.Generator, most: int
    ) -> None:
        self.samples, self.model, self.most = samples, model, most
        self.asked_gains = model.free_gains
        self._rng = rng
        self.found: list[SearchedChain] = []
        self.starts = 0

    @property
    def exhausted(self) -> bool:
        return self.starts >= self.most

    def try_start(self, start: ChainParameters, *, warm: bool = False) -> SearchedChain:
        least = min((f.cost for f in self.found), default=np.inf)
        found = search(
            self.samples, start, self.model.free_gains, worthwhile=4.0 * least, warm=warm
        )
        if np.isfinite(found.cost):
            self.found.append(found)
        return found

    def try_random(self) -> SearchedChain:
        self.starts += 1
        return self.try_start(self.model.random_start(self._rng))

    def best(self) -> SearchedChain:
        if not self.found:  # no start led anywhere: zero levers
            start = self.model.random_start(self._rng)
            whitening = self.samples.whitening()
            rest = np.einsum("kij,kj->ki", whitening, self.samples.torque)
            return SearchedChain(start, float(np.sum(rest**2)), whitening)
        return best_of(self.found)

    def result(self, verdict: Verdict, found: SearchedChain, **more: Any) -> ChainFit:
        return fit_at(
            found.chain, self.samples, self.model, self.asked_gains, verdict, self.starts, **more
        )

    def refused(self, verdict: Verdict, remark: str, **more: Any) -> ChainFit:
        return self.result(verdict, self.best(), remark=remark, **more)


def poses_needed(model: ChainModel) -> int:
    """Different poses that determine a chain of this kind and leave something to check it."""
    return -(-(_most_parameters(model) + 1) // model.n)


def _too_few(fit: _Search, needed: int = 0) -> str:
    """Say how many poses are missing."""
    poses, needed = fit.samples.poses, max(needed, poses_needed(fit.model))
    if poses < needed:
        return (
            f"{needed - poses} more poses: {poses} different ones were given, {needed} are needed"
        )
    return (
        f"poses that differ more: the {poses} given leave the torque elsewhere open "
        "(take some in which every joint moves)"
    )


def _too_few_to_hold_out(fit: _Search) -> str:
    needed = poses_needed(fit.model) + 2
    while needed - -(-needed // FOLDS) <= poses_needed(fit.model):
        needed += 1
    poses = fit.samples.poses
    return (
        f"{max(needed - poses, 1)} more poses: {poses} different ones were given, which are not "
        f"explained exactly; {needed} are needed to estimate the noise (fewer where it is stated)"
    )


def _misfit(fit: _Search) -> str:
    best, samples = fit.best(), fit.samples
    rest = samples.torque - best.chain.torque(samples.q)
    worst = np.sqrt(np.mean(rest**2, axis=0))
    joint = int(np.argmax(worst))
    size = np.sqrt(np.mean(samples.torque**2, axis=0))[joint]
    return (
        f"the best of {fit.starts} starts leaves {worst[joint]:.3g} N m (RMS) at joint "
        f"{joint + 1}, of {size:.3g} N m; the arm is no rigid chain, the samples have other errors "
        "than stated, or more starts are needed"
    )


def _to_rounding(fit: _Search, starts: int) -> ChainFit | None:
    """The chain that explains all samples exactly, if a start finds it."""
    samples = fit.samples
    limit = max(EXACT * samples.largest_torque / samples.floor, 1.0) ** 2 * samples.equations
    tried = 0
    while True:
        for found in fit.found[tried:]:
            near = found.cost < 1e4 * limit
            better = polished(samples, found, fit.model) if near else found
            if better.cost <= limit:
                return _exact(fit, better)
        tried = len(fit.found)
        if fit.starts >= starts:
            return None
        fit.try_random()


def _exact(fit: _Search, found: SearchedChain) -> ChainFit:
    result = fit.result(Verdict.ROUNDING, found)
    error = result.standard_error(probe_poses(fit.model.n)).max()
    if result.degrees < 1 or not error < KNOWN_EVERYWHERE * fit.samples.largest_torque:
        weightless = fit.samples.largest_torque <= LEAST_FLOOR
        if weightless and fit.samples.poses >= poses_needed(fit.model):
            return result
        fit.found = [found]
        return fit.refused(Verdict.TOO_FEW, _too_few(fit))
    return result


def _within_noise(fit: _Search) -> ChainFit:
    """The chain that chi-square accepts."""
    samples, model = fit.samples, fit.model
    firm = fit.samples.equations - _most_parameters(model)
    if firm < model.n or samples.poses < poses_needed(model) + 1:
        fit.try_random()
        return fit.refused(Verdict.TOO_FEW, _too_few(fit, poses_needed(model) + 1))
    # few equations to spare say little: more starts, to see whether there are rivals
    fewest = FEWEST_STARTS if firm >= 2 * model.n else UNKNOWN_NOISE_STARTS
    warm = bool(fit.found)
    while True:
        if fit.found and (warm or fit.starts >= min(fewest, fit.most)):
            best = fit.best()
            likely = _p_value(fit, best)
            patient = fit.starts >= min(UNKNOWN_NOISE_STARTS, fit.most)
            if likely >= AT_ONCE or (patient and likely >= LEAST_LIKELY):
                break
        warm = False
        if fit.exhausted:
            best = fit.best()
            remark = f"{_misfit(fit)} (chance {_p_value(fit, best):.2g})"
            return fit.refused(Verdict.MISFIT, remark, p_value=_p_value(fit, best))
        fit.try_random()
    better = polished(samples, best, model)
    if better.cost <= best.cost:
        best = better
    likely = _p_value(fit, best)
    rival = _rival(fit, best)
    if rival is not None:
        remark = (
            f"more poses: chains whose torques differ by {rival:.3g} N m (RMS) elsewhere explain "
            "the samples equally well"
        )
        return fit.result(Verdict.AMBIGUOUS, best, remark=remark, p_value=likely)
    result = fit.result(Verdict.CHI_SQUARE, best, p_value=likely)
    if not np.isfinite(result.standard_error(probe_poses(model.n))).all():
        return fit.result(Verdict.TOO_FEW, best, remark=_too_few(fit), p_value=likely)
    return result


def _most_parameters(model: ChainModel) -> int:
    """Number of parameters that torques can tell apart, of a generic chain."""
    if model.n == 1:
        return 2 + len(model.columns)
    firsts = int(np.sum(model.parents < 0))
    gains = max(int(model.free_gains.sum()) - 1, 0)
    return 4 * model.n - firsts + gains + len(model.columns)


def _p_value(fit: _Search, found: SearchedChain) -> float:
    """Chance of a larger misfit; parameters are counted as in a generic chain."""
    count = min(identifiable_count(found.chain, fit.model.free), fit.samples.equations - 1)
    return float(stats.chi2.sf(found.cost, fit.samples.equations - count))


def _rival(fit: _Search, best: SearchedChain) -> float | None:
    """Largest RMS difference of torques between the best chain and others that fit as well."""
    q = probe_poses(fit.model.n)
    torque = best.chain.torque(q)
    size = float(np.sqrt(np.mean(torque**2)))
    worst = 0.0
    for other in fit.found:
        if other.cost < best.cost + RIVAL_COST:
            worst = max(worst, float(np.sqrt(np.mean((other.chain.torque(q) - torque) ** 2))))
    return worst if worst > RIVAL_SHARE * size else None


def _by_held_out(fit: _Search) -> ChainFit:
    """The chain that predicts poses left out, noise estimated from the residuals."""
    model, exact = fit.model, fit.samples
    # what is left when a fold is left out must still determine the chain
    if exact.poses - -(-exact.poses // FOLDS) <= poses_needed(model):
        exhaustive = _to_rounding(fit, fit.most)
        return exhaustive or fit.refused(Verdict.TOO_FEW, _too_few_to_hold_out(fit))
    size = float(np.sqrt(np.mean(exact.torque**2)))
    spare = exact.equations - _most_parameters(model)
    accepted = HELD_OUT_SHARE * min(1.0, spare / (4 * model.n)) * size
    judged: ChainFit | None = None
    least = np.inf
    while True:
        best = best_of(fit.found) if fit.found else None
        if best is not None and best.cost < (1 - 1e-6) * least:
            least = best.cost
            noisy, found = with_estimated_noise(exact, best, model)
            fit.samples = noisy
            error = held_out_error(noisy, found, model)
            result = fit.result(Verdict.HELD_OUT, found, held_out=error)
            fit.samples = exact
            if error <= accepted:
                if np.isfinite(result.standard_error(probe_poses(model.n))).all():
                    return result
                fit.samples = noisy
                return fit.result(Verdict.TOO_FEW, found, remark=_too_few(fit), held_out=error)
            judged = result
        if fit.exhausted:
            break
        again = _to_rounding(fit, fit.starts + 1)
        if again is not None:
            return again
    remark = _misfit(fit)
    if judged is None:
        return fit.refused(Verdict.MISFIT, remark)
    remark += (
        f"; it errs by {judged.held_out:.3g} N m (RMS) at poses left out of the fit, "
        f"{accepted:.3g} are accepted where the noise is not stated"
    )
    fit.samples = judged.samples
    found = SearchedChain(judged.chain, judged.cost, judged.whitening)
    return fit.result(Verdict.MISFIT, found, remark=remark, held_out=judged.held_out)


def with_estimated_noise(
    samples: ChainSamples, found: SearchedChain, model: ChainModel, rounds: int = 3
) -> tuple[ChainSamples, SearchedChain]:
    """Noise of every joint from the residuals, and the chain refitted with it.

    Squares of residuals are divided by what the fit leaves of them (one minus leverage); joints
    with few of them lean on the others.
    """
    for _ in range(rounds):
        found, samples = _reweighted(samples, found, model)
    return samples, found


def _reweighted(
    samples: ChainSamples, found: SearchedChain, model: ChainModel
) -> tuple[SearchedChain, ChainSamples]:
    information = Information.of(found.chain, samples.q, found.whitening, model.free)
    slopes = found.chain.derivatives(samples.q, raw_directions(model.n))
    rows = found.whitening @ slopes.by_parameters()[:, :, model.free]
    leverage = np.sum((rows @ information.factor) ** 2, axis=2)
    left = np.maximum(1.0 - leverage, 0.0).sum(axis=0)
    rest = samples.torque - slopes.torque
    square = (rest**2 * samples.weights[:, None]).sum(axis=0)
    pooled = square.sum() / max(left.sum(), 1e-3)
    variance = (square + SHRINKING * pooled * 1e-2) / (left + SHRINKING * 1e-2 + 1e-3)
    if samples.angle_noise.any():
        leaning = slopes.stiffness * samples.angle_noise
        variance = np.maximum(variance - np.mean((leaning**2).sum(axis=2), axis=0), 0.01 * variance)
    noisy = samples.with_torque_noise(np.sqrt(variance))
    again = search(noisy, found.chain, model.free_gains, warm=True)
    return again, noisy


def held_out_error(samples: ChainSamples, found: SearchedChain, model: ChainModel) -> float:
    """RMS torque error [N m] at poses left out, tenth by tenth; equal poses are left out together.

    Every refit starts from the chain of all samples.
    """
    _, pose = np.unique(samples.q.round(9), axis=0, return_inverse=True)
    poses = int(pose.max()) + 1
    fold = np.random.default_rng(poses).permutation(poses)[pose.ravel()] % min(FOLDS, poses)
    total = 0.0
    for k in range(min(FOLDS, poses)):
        out = fold == k
        kept = samples.part(~out)
        refit = minimise(kept, found.chain, model.free_gains, found.whitening[~out])
        rest = samples.torque[out] - refit.chain.torque(samples.q[out])
        total += float(np.sum(rest**2))
    return float(np.sqrt(total / samples.equations))


def residuals(fit: ChainFit) -> Array:
    """Torque errors of a fit in units of their standard deviations, (m, n)."""
    found = SearchedChain(fit.chain, fit.cost, fit.whitening)
    return whitened_residuals(fit.samples, found)
