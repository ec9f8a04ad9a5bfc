"""Symmetries identified from static samples through one fitted potential of waves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from isotorque.learning.relations.claim_bounds import claim_bounds
from isotorque.learning.relations.examined_fit import (
    LARGEST_ERROR,
    ExaminedFit,
    could_be_wrong,
    examined_fit,
)
from isotorque.learning.relations.identification.group_fit import GroupFit
from isotorque.learning.relations.identification.group_search import (
    candidate_relations,
    largest_consistent_group,
)
from isotorque.learning.relations.identification.offset_snapping import snapped_offsets
from isotorque.learning.relations.learned_symmetries import (
    Knowledge,
    LearnedRelation,
    LearnedSymmetries,
    nothing_learned,
)
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.learning.relations.potential.potential_fit import (
    FittedPotential,
    present_frequencies,
)
from isotorque.learning.statistics.static_samples import static_samples
from isotorque.learning.statistics.tails import quantile
from isotorque.symbolic.groups.group_arrays import CandidateGroup, lifted_relations
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]

METHOD = "identification"
SIGNIFICANCE = 1e-4
"""Hypotheses with a smaller p-value are contradicted by the data."""
PRESENCE = (1e-2, 1e-4, 1e-6)
"""Levels at which a frequency counts as present; each gives candidate groups."""
SCREEN = 1e-9
"""Candidates are dropped unseen if one coefficient is off by this small a chance."""


def identify_by_waves(
    q: ArrayLike,
    tau: ArrayLike,
    *,
    noise: MeasurementNoise | None = None,
    snap: bool = True,
) -> LearnedSymmetries:
    """Find the symmetry group of the torque map behind static samples.

    Parameters
    ----------
    q : (N, n) array_like
        Configurations at rest [rad].
    tau : (N, n) array_like
        Torques that held them [N m].
    noise : MeasurementNoise, optional
        Noise levels where known; estimated from the misfit otherwise.
    snap : bool
        Round offsets to multiples of a right angle where all of them agree (`snapped_offsets`);
        every relation says whether that was done.

    Returns
    -------
    LearnedSymmetries
        ``missing`` says what the data lack; where it is not None only the identity is claimed,
        unless it speaks of joints that never moved.

    Raises
    ------
    InputError
        If the arrays do not fit together.

    Notes
    -----
    One potential is fitted to all samples (docs/theory.md, "Identification"). Frequencies whose
    coefficients differ significantly from zero give candidate relations; the largest closed set of
    them whose symmetric potential explains the data as well as an unrestricted one (F or chi-square
    test) is the group. It is claimed only if the data would have shown a violation: the torque
    error that every relation may have at three standard errors must be small. Offsets and their
    errors come from the symmetric fit, so they compose exactly.

    Joints whose torque is zero in all samples are left out, after a check that the torque does not
    depend on them.

    Rows of one pose count as one sample (`group_poses`). Before anything is claimed the samples
    must not show what the form has no term for (`lack_of_fit`), and a constant torque of a joint is
    part of the form: relations that flip it are not claimed of the measured torque.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> q = rng.uniform([-1.5, -1.5], [-0.1, 0.1], (6, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> found = identify_by_waves(q, tau)
    >>> found.order, found.missing
    (8, None)
    >>> print(identify_by_waves(q[:3], tau[:3]).missing)
    3 more samples: 3 different ones were given, 6 determine 8 coefficients and 2 constants and
    check them
    """
    configurations, torques = static_samples(q, tau)
    n = configurations.shape[1]
    try:
        examined = examined_fit(configurations, torques, noise)
    except Undetermined as lacking:
        return nothing_learned(n, str(lacking), METHOD)
    fit, lack = examined.fit, examined.lack
    if lack.failed:
        return nothing_learned(n, examined.obstacle, METHOD, fit, lack)
    best = _best_group(fit)
    if best is None:
        missing = "more samples: no coefficient of the fitted potential stands out of the noise"
        found = nothing_learned(n, missing, METHOD, fit, lack)
    else:
        found = claim(examined, best, snap)
    return found if found.decided else replace(found, missing=examined.lack.left or found.missing)


def _corrected(
    examined: ExaminedFit, whole: CandidateGroup, kept: NDArray[np.intp]
) -> tuple[SymmetryRelation, ...]:
    """The relations that flip constants, of the torque less these."""
    flipping = whole.take(np.setdiff1d(np.arange(len(whole)), kept))
    if not len(flipping):
        return ()
    fit, lack = examined.fit, examined.lack
    bound, _ = claim_bounds(fit, lack, flipping, examined.deviations, corrected=True)
    return tuple(r.of_measured(lack.correction) for r in lifted_relations(flipping, bound))


def _best_group(fit: FittedPotential) -> GroupFit | None:
    """Largest consistent group over several ideas of which frequencies are present."""
    deviations = quantile(float(stats.norm.isf(SCREEN)), fit.freedom)
    best: GroupFit | None = None
    tried: set[bytes] = set()
    for level in PRESENCE:
        keep = present_frequencies(fit, level)
        if not keep.any() or keep.tobytes() in tried:
            continue
        tried.add(keep.tobytes())
        candidates = candidate_relations(fit, keep, deviations)
        found = largest_consistent_group(fit, candidates, SIGNIFICANCE)
        if found.p_value < SIGNIFICANCE:
            continue
        if best is None or len(found.group) > len(best.group):
            best = found
    return best


def claim(examined: ExaminedFit, best: GroupFit, snap: bool) -> LearnedSymmetries:
    """State a group that the data agree with, or say how much data would be needed to claim it.

    Parameters
    ----------
    examined : ExaminedFit
        Without lack of fit.
    best : GroupFit
        Of the same fit.
    snap : bool
        Round offsets to multiples of a right angle where they agree.

    Notes
    -----
    Relations are claimed of the torque that was measured. Where a joint carries a constant torque
    b beside gravity, those that flip its sign hold of gravity alone: they miss the measured torque
    by 2 b, and are left out (the others form a subgroup).
    """
    fit, lack, unmoved = examined.fit, examined.lack, examined.unmoved
    rounded = snapped_offsets(best.group, best.offset_errors) if snap else None
    whole = rounded or best.group
    kept = np.flatnonzero((whole.Y[:, lack.offset_joints] > 0.0).all(axis=1))
    group = whole.take(kept)
    bound, rms = claim_bounds(fit, lack, group, examined.deviations)
    n = bound.shape[1]
    size = fit.rms_torque()
    involved = group.basis.any(axis=0)
    excess = float((rms / np.where(size > 0.0, size, np.inf))[:, involved].max(initial=0.0))
    if any(other.bounded for other in lack.alternatives):
        # what was not looked for must not matter: the bound itself has to be small
        excess = max(excess, float(bound.max(initial=0.0)) / float(size.max()))
    excess /= LARGEST_ERROR
    if excess > 1.0:
        missing = could_be_wrong(fit.samples, excess)
        return nothing_learned(n, missing, METHOD, fit, lack)
    relations = lifted_relations(group, bound)
    learned = tuple(
        LearnedRelation(
            r, Knowledge.IDENTIFIED, 0, error, best.p_value, snapped=rounded is not None
        )
        for r, error in zip(relations, best.offset_errors[kept], strict=True)
    )
    unknown = None
    if unmoved:
        names = ", ".join(str(joint + 1) for joint in unmoved)
        unknown = f"samples in which joint {names} moves: the relations hold at its one angle"
    return LearnedSymmetries(
        SymmetryGroup(relations),
        learned,
        unknown,
        METHOD,
        fit,
        lack=lack,
        corrected=_corrected(examined, whole, kept),
        unmoved=tuple(unmoved),
    )
