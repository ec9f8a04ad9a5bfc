"""Starts until a chain can be accepted, or the reason why none can."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from scipy import stats

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.chain_samples import LEAST_FLOOR, ChainSamples
from isotorque.learning.learners.rigid.fitting.chain_search import (
    ChainModel,
    SearchedChain,
    best_of,
    polished,
)
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.fitting.noise_estimate import (
    FOLDS,
    held_out_error,
    with_estimated_noise,
)
from isotorque.learning.learners.rigid.fitting.start_search import StartSearch
from isotorque.learning.learners.rigid.planning.information import identifiable_count, probe_poses
from isotorque.learning.learners.rigid.planning.poses_needed import most_parameters, poses_needed
from isotorque.symbolic.common.single_thread import single_thread

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
RIVAL_COST = 30.0
"""Chains that cost more by this are excluded (likelihood ratio 3e-7)."""
RIVAL_SHARE = 0.05
"""Chains whose torques differ by more, anywhere, relative to the torque (RMS), are others."""
OPEN_SHARE = 1.0
"""A torque whose standard error elsewhere is as large as itself (both RMS) is not known."""


@single_thread()
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
    fit = StartSearch(samples, model, rng, starts)
    fit.model = _with_findable_gains(samples, model, share)
    if warm is not None:
        fit.try_start(warm, warm=True)
    if stated:
        return _within_noise(fit)
    # with gains or offsets unknown, more starts end in false minima
    some = UNKNOWN_NOISE_STARTS * (5 if model.free_gains.any() or model.columns else 1)
    exact = _to_rounding(fit, starts if noise_known else min(starts, some))
    if exact is not None or noise_known:
        return exact or fit.refused(FitStatus.MISFIT, _misfit(fit))
    fewer = _with_findable_gains(samples, model, CARRYING_SHARE[1])
    if not np.array_equal(fewer.free_gains, fit.model.free_gains):
        known = [fit.best().chain] if fit.found else []
        fit.begin_anew(fewer)
        for chain in known if warm is None else [warm, *known]:
            gains = np.where(fewer.free_gains, chain.gains, fewer.gains)
            fit.try_start(replace(chain, gains=gains), warm=True)
    return _by_held_out(fit)


def _with_findable_gains(samples: ChainSamples, model: ChainModel, share: float) -> ChainModel:
    """The model with gains free only where the joint carries a torque that stands out.

    The gain of a joint without torque would run away: it lets noise be fitted by a tiny torque.
    """
    varies = np.std(samples.torque, axis=0)
    least = np.maximum(CARRYING * samples.torque_noise, share * samples.largest_torque)
    return replace(model, free_gains=model.free_gains & (varies > least))


def _to_rounding(fit: StartSearch, starts: int) -> ChainFit | None:
    """The chain that explains all samples exactly, if a start finds it."""
    samples = fit.samples
    limit = max(EXACT * samples.largest_torque / samples.floor, 1.0) ** 2 * samples.equations
    while True:
        for found in fit.not_looked_at():
            near = found.cost < 1e4 * limit
            better = polished(samples, found, fit.model) if near else found
            if better.cost <= limit:
                return _exact(fit, better)
        if fit.starts >= starts:
            return None
        fit.try_random()


def _exact(fit: StartSearch, found: SearchedChain) -> ChainFit:
    result = fit.result(FitStatus.ROUNDING, found)
    error = result.standard_error(probe_poses(fit.model.n)).max()
    if result.degrees < 1 or not error < KNOWN_EVERYWHERE * fit.samples.largest_torque:
        weightless = fit.samples.largest_torque <= LEAST_FLOOR
        if weightless and fit.samples.poses >= poses_needed(fit.model):
            return result
        fit.found = [found]
        return fit.refused(FitStatus.TOO_FEW, **_too_few(fit))
    return result


def _within_noise(fit: StartSearch) -> ChainFit:
    """The chain that chi-square accepts."""
    samples, model = fit.samples, fit.model
    firm = fit.samples.equations - most_parameters(model)
    if firm < model.n or samples.poses < poses_needed(model) + 1:
        fit.try_random()
        return fit.refused(FitStatus.TOO_FEW, **_too_few(fit, poses_needed(model) + 1))
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
            return fit.refused(FitStatus.MISFIT, remark, p_value=_p_value(fit, best))
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
        return fit.result(FitStatus.AMBIGUOUS, best, remark=remark, p_value=likely)
    result = fit.result(FitStatus.CHI_SQUARE, best, p_value=likely)
    if not _known_elsewhere(result):
        return fit.result(FitStatus.TOO_FEW, best, p_value=likely, **_too_few(fit))
    return result


def _known_elsewhere(result: ChainFit) -> bool:
    """Whether the samples say something of the torque at other poses."""
    q = probe_poses(result.chain.n)
    error = result.standard_error(q)
    if not np.isfinite(error).all():
        return False
    size = float(np.sqrt(np.mean(result.chain.torque(q) ** 2)))
    return float(np.sqrt(np.mean(error**2))) < OPEN_SHARE * size


def _p_value(fit: StartSearch, found: SearchedChain) -> float:
    """Chance of a larger misfit; parameters are counted as in a generic chain."""
    count = min(identifiable_count(found.chain, fit.model.free), fit.samples.equations - 1)
    return float(stats.chi2.sf(found.cost, fit.samples.equations - count))


def _rival(fit: StartSearch, best: SearchedChain) -> float | None:
    """Largest RMS difference of torques between the best chain and others that fit as well."""
    q = probe_poses(fit.model.n)
    torque = best.chain.torque(q)
    size = float(np.sqrt(np.mean(torque**2)))
    worst = 0.0
    for other in fit.found:
        if other.cost < best.cost + RIVAL_COST:
            worst = max(worst, float(np.sqrt(np.mean((other.chain.torque(q) - torque) ** 2))))
    return worst if worst > RIVAL_SHARE * size else None


def _by_held_out(fit: StartSearch) -> ChainFit:
    """The chain that predicts poses left out, noise estimated from the residuals."""
    model, exact = fit.model, fit.samples
    # what is left when a fold is left out must still determine the chain
    if exact.poses - -(-exact.poses // FOLDS) <= poses_needed(model):
        exhaustive = _to_rounding(fit, fit.most)
        return exhaustive or fit.refused(FitStatus.TOO_FEW, **_too_few_to_hold_out(fit))
    size = float(np.sqrt(np.mean(exact.torque**2)))
    spare = exact.equations - most_parameters(model)
    accepted = HELD_OUT_SHARE * min(1.0, spare / (4 * model.n)) * size
    judged: ChainFit | None = None
    left_open: ChainFit | None = None
    least = np.inf
    while True:
        best = best_of(fit.found) if fit.found else None
        if best is not None and best.cost < (1 - 1e-6) * least:
            least = best.cost
            noisy, found = with_estimated_noise(exact, best, model)
            fit.samples = noisy
            error = held_out_error(noisy, found, model)
            result = fit.result(FitStatus.HELD_OUT, found, held_out=error)
            fit.samples = exact
            if error <= accepted:
                if _known_elsewhere(result):
                    return result
                fit.samples = noisy
                left_open = fit.result(FitStatus.TOO_FEW, found, held_out=error, **_too_few(fit))
                fit.samples = exact  # go on: another start may explain the samples exactly
            judged = result
        if fit.exhausted:
            break
        again = _to_rounding(fit, fit.starts + 1)
        if again is not None:
            return again
    if left_open is not None:
        return left_open
    remark = _misfit(fit)
    if judged is None:
        return fit.refused(FitStatus.MISFIT, remark)
    remark += (
        f"; it errs by {judged.held_out:.3g} N m (RMS) at poses left out of the fit, "
        f"{accepted:.3g} are accepted where the noise is not stated"
    )
    fit.samples = judged.samples
    found = SearchedChain(judged.chain, judged.cost, judged.whitening)
    return fit.result(FitStatus.MISFIT, found, remark=remark, held_out=judged.held_out)


def _too_few(fit: StartSearch, needed: int = 0) -> dict[str, Any]:
    """Say how many poses are missing (0: what counts is how they differ)."""
    poses, needed = fit.samples.poses, max(needed, poses_needed(fit.model))
    if poses < needed:
        remark = (
            f"{needed - poses} more poses: {poses} different ones were given, {needed} are needed"
        )
        return {"remark": remark, "missing": needed - poses}
    remark = (
        f"poses that differ more: the {poses} given leave the torque elsewhere open "
        "(take some in which every joint moves)"
    )
    return {"remark": remark, "missing": 0}


def _too_few_to_hold_out(fit: StartSearch) -> dict[str, Any]:
    needed = poses_needed(fit.model) + 2
    while needed - -(-needed // FOLDS) <= poses_needed(fit.model):
        needed += 1
    poses = fit.samples.poses
    missing = max(needed - poses, 1)
    remark = (
        f"{missing} more poses: {poses} different ones were given, which are not "
        f"explained exactly; {needed} are needed to estimate the noise (fewer where it is stated)"
    )
    return {"remark": remark, "missing": missing}


def _misfit(fit: StartSearch) -> str:
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
