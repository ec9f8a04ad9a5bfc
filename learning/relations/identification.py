"""Symmetries identified from static samples through one fitted potential, without pairing."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from learning.relations.errors_in_variables import MeasurementNoise, Undetermined
from learning.relations.group_fit import GroupFit, torque_uncertainty
from learning.relations.group_search import candidate_relations, largest_consistent_group
from learning.relations.learned_symmetries import Knowledge, LearnedRelation, LearnedSymmetries
from learning.relations.lifting import lifted_relations
from learning.relations.offset_snapping import snapped_offsets
from learning.relations.potential_fit import FittedPotential, present_frequencies, quantile
from learning.relations.samples import static_samples
from learning.relations.silent_joints import fit_on_active_joints
from learning.relations.wanted_samples import wanted_samples
from symbolic.relations import SymmetryGroup, identity

Array = NDArray[np.float64]

SIGNIFICANCE = 1e-4
"""Hypotheses with a smaller p-value are contradicted by the data."""
PRESENCE = (1e-2, 1e-4, 1e-6)
"""Levels at which a frequency counts as present; each gives candidate groups."""
SCREEN = 1e-9
"""Candidates are dropped unseen if one coefficient is off by this small a chance."""
LARGEST_ERROR = 0.05
"""Relations are claimed if the data exclude larger RMS torque errors, relative to RMS torque."""
BOUND_DEVIATIONS = 3.0
"""Errors are stated at as small a chance as three standard errors of a normal variable."""


def identify(
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
    One potential is fitted to all samples (theory.md, section 5). Frequencies whose coefficients
    differ significantly from zero give candidate relations; the largest closed set of them whose
    symmetric potential explains the data as well as an unrestricted one (F or chi-square test)
    is the group. It is claimed only if the data would have shown a violation: the torque error
    that every relation may have at three standard errors must be small. Offsets and their errors
    come from the symmetric fit, so they compose exactly.

    Joints whose torque is zero in all samples are left out, after a check that the torque does not
    depend on them.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> q = rng.uniform([-1.5, -1.5], [-0.1, 0.1], (5, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> found = identify(q, tau)
    >>> found.order, found.missing
    (8, None)
    >>> identify(q[:3], tau[:3]).missing
    '2 more samples: 3 different ones were given, 5 determine 8 coefficients and check them'
    """
    configurations, torques = static_samples(q, tau)
    n = configurations.shape[1]
    try:
        fit, unmoved = fit_on_active_joints(configurations, torques, noise, LARGEST_ERROR)
    except Undetermined as lacking:
        return _nothing(n, str(lacking))
    best = _best_group(fit)
    if best is None:
        missing = "more samples: no coefficient of the fitted potential stands out of the noise"
        return _nothing(n, missing, fit)
    return claim(fit, best, unmoved, snap)


def _nothing(n: int, missing: str, fit: FittedPotential | None = None) -> LearnedSymmetries:
    unit = identity(n)
    zero = np.zeros(n)
    relation = LearnedRelation(unit, Knowledge.IDENTIFIED, 0, zero, 1.0)
    return LearnedSymmetries(SymmetryGroup([unit]), (relation,), missing, "identification", fit)


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


def claim(
    fit: FittedPotential, best: GroupFit, unmoved: list[int], snap: bool
) -> LearnedSymmetries:
    """State a group that the data agree with, or say how much data would be needed to claim it.

    Parameters
    ----------
    fit : FittedPotential
    best : GroupFit
        Of the same fit.
    unmoved : list of int
        Joints that never moved.
    snap : bool
        Round offsets to multiples of a right angle where they agree.
    """
    rounded = snapped_offsets(best.group, best.offset_errors) if snap else None
    group = rounded or best.group
    bound, rms = torque_uncertainty(fit, group, quantile(BOUND_DEVIATIONS, fit.freedom))
    n = bound.shape[1]
    size = fit.rms_torque()
    involved = group.basis.any(axis=0)
    excess = float((rms / np.where(size > 0.0, size, np.inf))[:, involved].max(initial=0.0))
    excess /= LARGEST_ERROR
    if excess > 1.0:
        missing = (
            f"{wanted_samples(fit.samples, excess)}: relations could still be wrong by "
            f"{100.0 * LARGEST_ERROR * excess:.2g} % of the torque, {100.0 * LARGEST_ERROR:.0f} % "
            "are allowed"
        )
        return _nothing(n, missing, fit)
    relations = lifted_relations(group, bound)
    learned = tuple(
        LearnedRelation(
            r, Knowledge.IDENTIFIED, 0, error, best.p_value, snapped=rounded is not None
        )
        for r, error in zip(relations, best.offset_errors, strict=True)
    )
    unknown = None
    if unmoved:
        names = ", ".join(str(joint + 1) for joint in unmoved)
        unknown = f"samples in which joint {names} moves: the relations hold at its one angle"
    return LearnedSymmetries(SymmetryGroup(relations), learned, unknown, "identification", fit)
