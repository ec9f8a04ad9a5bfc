"""Decision which causes a recording shows: one after the other, by likelihood ratio."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Generic

import numpy as np
from scipy import stats

from isotorque.learning.statistics.causes.candidates import candidates, explained_to_first_order
from isotorque.learning.statistics.causes.extended_fit import ExtendedFit
from isotorque.learning.statistics.causes.extensible_model import ExtensibleModel, F
from isotorque.learning.statistics.causes.extension import Extension, Kind, Term

FAMILY_WISE, LATER = 0.005, 0.001
"""Chance that anything is named where there is nothing, over all candidates; that anything is
named beside the first cause where there is nothing else."""
TIED = 6.0
"""Candidates whose scores (2 log Bayes factor) differ by less cannot be told apart."""
SAYS_MORE = 0.05
"""A cause that contains the one that is named is told beside it if its further unknowns explain so
much that chance would more rarely than this: it is compatible in any case."""
MOST = 3
"""Causes that are named at most."""
LOOKED_AT = 4
"""Best candidates that are fitted from other starts as well, and whose chains the model without
causes is fitted from again: it must be as well optimised as they are."""
OTHER_STARTS = 4
WORTHWHILE = 6.0
"""Where a model explains its samples, only causes that would take so much from the cost are
fitted: less is never significant."""
ADEQUATE, ADEQUATE_SHARE = 1e-4, 0.02
"""A model explains its samples: chance of the misfit where noise is known, else share of torque."""
NEGLIGIBLE = 1e-6
"""Causes below this share of the largest torque are where motions ended."""
MUCH = 5.0
"""Times that causes must lower what a model leaves of the joint it explains worst, to make a model
of samples that are none as they stand: an arm that is no chain comes nearer with any cause."""
SAME = 3.0
"""A gain is a wrong sign if -1 lies within so many standard errors, ..."""
NEAR = 0.05
"""... or within this."""


@dataclass(frozen=True, eq=False)
class Candidate(Generic[F]):
    """A cause with a fit that contains it.

    Attributes
    ----------
    extension : Extension
    fit : ExtendedFit
    degrees : int
        Unknowns that it adds.
    ratio : float
        Twice the logarithm of the likelihood ratio.
    score : float
        The same less ``degrees log N`` (Schwarz).
    log_p : float
        Logarithm of the chance of such a ratio without the cause.
    """

    extension: Extension
    fit: F
    degrees: int
    ratio: float
    score: float
    log_p: float


@dataclass(frozen=True, eq=False)
class Choice:
    """A cause that was chosen.

    Attributes
    ----------
    extension : Extension
    p_value : float
        Without the cause, over all candidates (Bonferroni).
    rivals : tuple of Extension
        Causes that explain the samples as well, this one first.
    """

    extension: Extension
    p_value: float
    rivals: tuple[Extension, ...]


@dataclass(frozen=True, eq=False)
class Selection(Generic[F]):
    """Result of a selection.

    Attributes
    ----------
    model : ExtensibleModel
        With the noise as it was estimated last.
    fit : ExtendedFit
        With all causes that were chosen.
    choices : tuple of Choice
    adequate : bool
        Whether nothing is left to be explained.
    """

    model: ExtensibleModel[F]
    fit: F
    choices: tuple[Choice, ...]
    adequate: bool


def selected(model: ExtensibleModel[F], null: F, *, level: float = FAMILY_WISE) -> Selection[F]:
    """Choose the causes that samples show beside a model.

    Parameters
    ----------
    model : ExtensibleModel
    null : ExtendedFit
        Of the model alone, with what it contains anyway.
    level : float
        Chance that anything is named where there is nothing, over all candidates.

    Notes
    -----
    Every cause is added to the model and fitted with it. The best score counts; of those that
    cannot be told apart from it the one with the fewest unknowns, among those whose likelihood
    ratio is significant at ``level`` over all candidates (chi-square where the noise is known,
    else F). Where a model has many minima, comparing the best of many candidates with one minimum
    of the model alone finds causes in clean samples: the model alone is therefore fitted again
    from the chains of the best candidates. After `MOST` causes, or when none is significant, those
    that the later ones made superfluous are dropped.
    """
    fit = null
    choices: list[Choice] = []
    for _ in range(MOST):
        fit, found, tried = _best(model, fit)
        if not found:
            break
        least = np.log(min(LATER, level) if choices else level) - np.log(tried)
        significant = [candidate for candidate in found if candidate.log_p < least]
        if not significant:
            break
        best, rivals = _simplest(significant, found)
        largest = float(np.abs(model.torque).max())
        if np.abs(best.fit.effect(best.extension.terms)).max() < NEGLIGIBLE * largest:
            break
        if best.extension.kind is Kind.PAYLOAD:
            best = _at_its_first_sample(model, fit, best)
        named = tuple(_renamed(c.extension, c.fit) for c in (best, *rivals))
        choices.append(Choice(named[0], float(np.exp(best.log_p) * tried), named))
        fit = model.refitted(best.fit.terms, best.fit, thorough=True)
        model = model.reweighted(fit)
        fit = model.refitted(fit.terms, fit, thorough=True)
        if best.extension.kind is Kind.PAYLOAD:
            break
    fit, choices = _without_superfluous(model, fit, choices, null.terms, level)
    return Selection(model, fit, tuple(choices), is_adequate(model, fit))


def is_clear(selection: Selection[F], alone: F) -> bool:
    """Whether causes make a model of samples that are none as they stand: they leave far less.

    Parameters
    ----------
    selection : Selection
    alone : ExtendedFit
        Of the model without causes.
    """
    before, left = (np.sqrt(np.mean(f.rest**2, axis=0)) for f in (alone, selection.fit))
    joint = int(np.argmax(before))
    return bool(selection.adequate and before[joint] > MUCH * left[joint])


def is_adequate(model: ExtensibleModel[F], fit: F) -> bool:
    """Whether a fit explains the samples but for noise."""
    if model.noise_known:
        return bool(stats.chi2.sf(fit.cost, fit.spare) > ADEQUATE)
    left, size = np.sqrt(np.mean(fit.rest**2)), np.sqrt(np.mean(model.torque**2))
    return bool(left < ADEQUATE_SHARE * size)


def _best(model: ExtensibleModel[F], fit: F) -> tuple[F, list[Candidate[F]], int]:
    """The fit without more causes, candidates by score, and how many were tried."""
    adequate = is_adequate(model, fit)
    possible = candidates(model, fit, adequate)
    taken, degrees = explained_to_first_order(fit, possible)
    room = fit.spare - model.q.shape[1]
    seen = [
        (extension, int(df), more)
        for extension, df, more in zip(possible, degrees, taken, strict=True)
        if 0 < df <= room
    ]
    least = -np.inf
    if adequate:
        least = WORTHWHILE * (1.0 if model.noise_known else fit.cost / fit.spare)
    fits: list[tuple[Extension, int, F]] = []
    for extension, df, more in seen:
        if more <= least:
            continue
        terms = _with(fit.terms, extension)
        near = [model.refitted(terms, fit)]
        if not adequate and extension.kind is Kind.GAIN and extension.joint is not None:
            near += model.others(extension, terms, OTHER_STARTS)
        plausible = [found for found in near if found.plausible()]
        if plausible:
            fits.append((extension, df, min(plausible, key=lambda f: f.cost)))
    fits.sort(key=lambda entry: entry[2].cost + entry[1] * np.log(model.q.size))
    for i, (extension, df, found) in enumerate(fits[:LOOKED_AT]):
        others = model.others(extension, found.terms, OTHER_STARTS)
        better = [other for other in others if other.plausible() and other.cost < found.cost]
        if better:
            fits[i] = (extension, df, min(better, key=lambda f: f.cost))
    for _, _, found in fits[:LOOKED_AT]:
        again = model.refitted(fit.terms, found, thorough=True)
        if again.cost < fit.cost and again.plausible():
            fit = again
    scored = [_scored(model, fit, *entry) for entry in fits]
    scored.sort(key=lambda candidate: -candidate.score)
    return fit, scored, len(seen)


def _at_its_first_sample(model: ExtensibleModel[F], fit: F, best: Candidate[F]) -> Candidate[F]:
    """A change of the payload at the sample that explains most: it was sought at few."""
    every = [Extension.payload(first) for first in range(1, len(model.q))]
    taken, degrees = explained_to_first_order(fit, every)
    taken[degrees < best.degrees] = 0.0  # too few samples on one side
    better = every[int(np.argmax(taken))]
    again = model.refitted(_with(fit.terms, better), best.fit)
    if not again.plausible() or again.cost >= best.fit.cost:
        return best
    return replace(best, extension=better, fit=again)


def _with(terms: Sequence[Term], extension: Extension) -> tuple[Term, ...]:
    return (*terms, *(term for term in extension.terms if term not in terms))


def _scored(
    model: ExtensibleModel[F], null: F, extension: Extension, df: int, fit: F
) -> Candidate[F]:
    """Likelihood ratio, score and chance of a cause."""
    without, cost = null.cost, max(min(fit.cost, null.cost), 1e-300)
    left = max(null.spare - df, 1)
    # every joint has a level of noise of its own: it is known with its own degrees of freedom
    own = max(left / model.q.shape[1], 1.0)
    log_p = float(stats.f.logsf((without - cost) / df / (cost / left), df, own))
    if model.noise_known:
        ratio = without - cost
        by_noise = float(stats.chi2.logsf(max(ratio, 0.0), df))
        # what is left is noise as well where it is more than was stated
        explained = stats.chi2.sf(cost, left) > ADEQUATE
        log_p = by_noise if explained else max(by_noise, log_p)
    else:
        ratio = _ratio_by_joint(model, null, fit)
    if not np.isfinite(log_p):
        log_p = -ratio / 2.0
    score = ratio - df * float(np.log(model.q.size))
    return Candidate(extension, fit, df, ratio, score, log_p)


def _ratio_by_joint(model: ExtensibleModel[F], null: F, fit: F) -> float:
    """Twice the logarithm of the likelihood ratio, every joint with the noise that is left of it.

    The weights of a fit are those of the model alone: of a joint with a cause they are too small,
    and all causes at that joint that explain most of it would seem alike.
    """
    m, n = model.q.shape
    least = m * (NEGLIGIBLE * np.abs(model.torque).max() / model.noise) ** 2
    before, after = (
        np.maximum(np.sum(f.residual.reshape(m, n) ** 2, axis=0), least) for f in (null, fit)
    )
    return float(null.spare / n * np.sum(np.log(before / after)))


def _simplest(
    significant: Sequence[Candidate[F]], found: Sequence[Candidate[F]]
) -> tuple[Candidate[F], list[Candidate[F]]]:
    """Of those that cannot be told apart, the one with the fewest unknowns; and the others.

    One that contains it is another only where its further unknowns explain something.
    """
    least = significant[0].score - TIED
    best = min((c for c in significant if c.score > least), key=lambda c: (c.degrees, -c.score))
    near = sorted((c for c in found if c.score > least), key=lambda c: (c.degrees, -c.score))
    inside = set(best.extension.terms)

    def is_another(other: Candidate[F]) -> bool:
        more = other.degrees - best.degrees
        if not inside < set(other.extension.terms) or more < 1:
            return True
        return bool(other.ratio - best.ratio > stats.chi2.isf(SAYS_MORE, more))

    return best, [other for other in near if other is not best and is_another(other)]


def _renamed(extension: Extension, fit: ExtendedFit) -> Extension:
    """A gain of -1 is a wrong sign, of the torque or of the angle."""
    if extension.kind is Kind.GAIN and extension.joint is not None:
        value, error = fit.estimate(extension.terms[0])
        if abs(value[0] + 1.0) < max(SAME * error[0], NEAR):
            return replace(extension, kind=Kind.SIGN)
    return extension


def _without_superfluous(
    model: ExtensibleModel[F],
    fit: F,
    choices: list[Choice],
    always: tuple[Term, ...],
    level: float,
) -> tuple[F, list[Choice]]:
    """Drop causes that are not significant beside the others."""
    while len(choices) > 1:
        tried = len(candidates(model, fit, is_adequate(model, fit)))
        for dropped in choices:
            kept = [choice for choice in choices if choice is not dropped]
            terms = always
            for choice in kept:
                terms = _with(terms, choice.extension)
            without = fit
            if len(terms) < len(fit.terms):  # else the others contain it
                without = model.refitted(terms, fit, thorough=True)
            df = max(without.spare - fit.spare, 1)
            found = _scored(model, without, dropped.extension, df, fit)
            if found.log_p + np.log(tried) >= np.log(level):
                fit, choices = without, kept
                break
        else:
            break
    return fit, choices
