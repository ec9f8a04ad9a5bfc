"""Symmetry groups that a fitted potential may have, and the largest one the data agree with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.identification.group_fit import GroupFit, fit_group
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import CandidateGroup
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.frequency_support import FrequencySupport

Array = NDArray[np.float64]
Table = NDArray[np.intp]


def candidate_relations(
    fit: FittedPotential, keep: NDArray[np.bool_], deviations: float
) -> CandidateGroup:
    """All relations whose signs fit the kept frequencies and whose coefficients agree roughly.

    Parameters
    ----------
    fit : FittedPotential
    keep : (m,) array of bool
        Frequencies that count as present.
    deviations : float
        Largest misfit of a single coefficient, in standard errors.

    Returns
    -------
    CandidateGroup
        The identity first. Not necessarily closed.

    Notes
    -----
    Signs and linear parts are enumerated exactly (docs/theory.md) as if all kept amplitudes
    were equal; offsets solve the phase congruences on a basis of the lattice and are then
    improved on all kept frequencies, weighted by how well their phases are known.
    """
    m = len(fit.frequencies)
    kept = TrigonometricPolynomial(
        fit.frequencies[keep], fit.coefficients[:m][keep], fit.coefficients[m:][keep]
    )
    error = np.hypot(fit.standard_error[:m], fit.standard_error[m:])[keep] / 2.0
    support = FrequencySupport.of(kept, np.ones(len(kept), dtype=bool))
    rank = len(support.B)
    A: list[Array] = []
    d: list[Array] = []
    Y: list[Array] = []
    for signs, s in support.structures(np.zeros(len(kept), dtype=np.int64)):
        position, image = support.image(signs, s)
        limit = deviations * np.hypot(error, error[position])
        if (np.abs(np.abs(image) - support.amplitude) > limit).any():
            continue
        linear = support.linear_part(signs, s)
        if not np.array_equal(linear, np.round(linear)):
            continue
        for start in support.offsets(signs, s, np.inf):
            offset = _improved_offset(support, s, image, start, limit)
            turned = s * support.C * np.exp(1j * (support.coordinates @ offset))
            if (np.abs(image - turned) <= limit).all():
                A.append(linear)
                d.append(offset)
                Y.append(signs.astype(float))
    found = CandidateGroup(
        support.B,
        np.array(A).reshape(-1, rank, rank),
        np.array(d).reshape(-1, rank),
        np.array(Y).reshape(-1, kept.n),
    )
    return found.take(np.argsort(~found.is_identity(), kind="stable"))


def _improved_offset(
    support: FrequencySupport, s: NDArray[np.int64], image: NDArray, start: Array, limit: Array
) -> Array:
    """Least squares of all phases, from the solution on a basis of the lattice."""
    phase = np.angle(image * s / support.C)
    weight = support.amplitude / limit
    offset = start
    for _ in range(3):
        misfit = wrap(phase - support.coordinates @ offset) * weight
        design = support.coordinates * weight[:, None]
        offset = offset + np.linalg.lstsq(design, misfit, rcond=None)[0]
    return wrap(offset)


def largest_consistent_group(
    fit: FittedPotential, candidates: CandidateGroup, significance: float
) -> GroupFit:
    """Largest closed set of candidates that the data do not contradict.

    Parameters
    ----------
    fit : FittedPotential
    candidates : CandidateGroup
        The identity first.
    significance : float
        A group is contradicted if its p-value is below this.

    Returns
    -------
    GroupFit
        Of the largest group; among equally large ones, of the best p-value. If even the identity
        (the potential on the kept frequencies) is contradicted, its fit, with its p-value.
    """
    whole = candidates.composed()
    if whole is not None:
        best = fit_group(fit, whole)
        if best.p_value >= significance:
            return best
    table, _ = candidates.products()
    verdicts: dict[frozenset[int], GroupFit | None] = {}

    def consistent(members: frozenset[int]) -> GroupFit | None:
        if members not in verdicts:
            group = candidates.take(np.array(sorted(members))).composed()
            result = None if group is None else fit_group(fit, group)
            good = result is not None and result.p_value >= significance
            verdicts[members] = result if good else None
        return verdicts[members]

    trivial = frozenset({0})
    best = consistent(trivial) or fit_group(fit, candidates.take(np.array([0])))
    explored: list[frozenset[int]] = []
    for seed in range(1, len(candidates)):
        members = _generated(table, trivial, seed)
        if members is None or any(members <= e for e in explored) or not consistent(members):
            continue
        for newcomer in range(1, len(candidates)):
            if newcomer not in members:
                larger = _generated(table, members, newcomer)
                if larger is not None and consistent(larger):
                    members = larger
        explored.append(members)
        result = consistent(members)
        assert result is not None
        if (len(result.group), result.p_value) > (len(best.group), best.p_value):
            best = result
    return best


def _generated(table: Table, members: frozenset[int], newcomer: int) -> frozenset[int] | None:
    """Members and a newcomer with all their products; None where one is not a candidate."""
    closed, queue = set(members) | {newcomer}, [newcomer]
    while queue:
        x = queue.pop()
        for y in tuple(closed):
            for product in (int(table[x, y]), int(table[y, x])):
                if product < 0:
                    return None
                if product not in closed:
                    closed.add(product)
                    queue.append(product)
    return frozenset(closed)
