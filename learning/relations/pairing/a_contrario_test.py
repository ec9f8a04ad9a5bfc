"""A-contrario test over distinct torques: whether chance could have made a voted relation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from isotorque.learning.relations.pairing.hough_transform import Tolerance, VotedRelation
from isotorque.learning.relations.pairing.torque_pairs import Pairs
from isotorque.symbolic.common.angles import wrap

Array = NDArray[np.float64]

MOST_ROW_ALARMS = -1.0
"""Largest accepted decimal logarithm of the false alarms of a single row."""
RING = 5.0
"""Pairs up to so many half widths off tell how dense near misses are."""


@dataclass(frozen=True, eq=False)
class AcceptedRelation:
    """A voted relation that chance does not explain.

    Attributes
    ----------
    Y : (n,) array
        Torque signs.
    A, d : (n, n), (n,) arrays
        q_s = A q_r + d [rad].
    torques : int
        Number of distinct torques among its pairs.
    log10_false_alarms : float
        Decimal logarithm of the expected number of such relations among random pairs.
    p_value : float
        Of the size of the residuals; small if they are too large for the noise.
    """

    Y: Array
    A: NDArray[np.int64]
    d: Array
    torques: int
    log10_false_alarms: float
    p_value: float


def accepted_relations(
    pairs: Pairs,
    voted: list[VotedRelation],
    torques: int,
    tolerance: Tolerance,
    least_torques: int,
    hypotheses_per_row: int,
    *,
    most_false_alarms: float = 1e-3,
    significance: float = 1e-3,
) -> list[AcceptedRelation]:
    """Voted relations that hold across torques and that no better one explains.

    Parameters
    ----------
    pairs : Pairs
    voted : list of VotedRelation
        From the same pairs.
    torques : int
        Number of distinct torques in the whole recording.
    tolerance : Tolerance
        The one they were voted with.
    least_torques : int
        Support that a relation needs, in distinct torques.
    hypotheses_per_row : int
        Number of integer rows that were tried.
    most_false_alarms : float
        Largest accepted number of false alarms of a whole relation.
    significance : float
        Relations whose residuals are larger than the noise allows at this level are dropped.

    Returns
    -------
    list of AcceptedRelation

    Notes
    -----
    Support is counted in distinct torques, for a secondary pair looks linear near one torque and
    never across many. The number of false alarms [1]_ is the expected number of relations with at
    least this support among all hypotheses if pairs fell at random. Since torque maps relate some
    joints exactly and others not, every row must also stand on its own, given that the others
    hold; there chance is measured by how many pairs miss the row by little. A pair belongs to at
    most one relation: pairs of a better relation no longer count for the next.

    References
    ----------
    .. [1] A. Desolneux, L. Moisan, J.-M. Morel, "From Gestalt Theory to Image Analysis: A
       Probabilistic Approach", Springer 2008.
    """
    free = np.ones(len(pairs), dtype=bool)
    accepted = []
    for relation in voted:
        widths = tolerance.half_widths(relation.A)
        residual = wrap(pairs.q_s - pairs.q_r @ relation.A.T - relation.d)
        miss = np.abs(residual) / widths
        inliers = relation.inliers & free
        support = len(np.unique(pairs.torque[inliers]))
        if support < least_torques or inliers.sum() < 0.5 * relation.inliers.sum():
            continue
        p_value = _residual_p_value(relation, residual[inliers] / tolerance.sigma)
        if p_value < significance:
            continue
        rows = len(relation.A)
        log_alarms = _log10_tail(
            pairs, free, float(np.prod(np.minimum(widths / np.pi, 1.0))), torques, support
        )
        log_alarms += rows * np.log10(hypotheses_per_row) + np.log10(len(pairs))
        if log_alarms > np.log10(most_false_alarms):
            continue
        if all(
            _row_stands_out(pairs, free, miss, widths, i, torques, support, hypotheses_per_row)
            for i in range(rows)
        ):
            free &= ~relation.inliers
            accepted.append(
                AcceptedRelation(
                    pairs.Y, relation.A, relation.d, support, float(log_alarms), p_value
                )
            )
    return accepted


def _row_stands_out(
    pairs: Pairs,
    free: NDArray[np.bool_],
    miss: Array,
    widths: Array,
    row: int,
    torques: int,
    support: int,
    hypotheses: int,
) -> bool:
    """Whether chance does not explain one row, given that all others hold."""
    others = free & (np.delete(miss, row, axis=1) <= 1.0).all(axis=1)
    ring = others & (miss[:, row] > 1.0) & (miss[:, row] <= RING)
    near_misses = ring.sum() / (RING - 1.0)
    chance = max(float(widths[row] / np.pi), near_misses / max(1, int(others.sum())))
    log_alarms = _log10_tail(pairs, others, min(chance, 1.0), torques, support)
    return bool(log_alarms + np.log10(hypotheses) < MOST_ROW_ALARMS)


def _log10_tail(
    pairs: Pairs, counted: NDArray[np.bool_], chance: float, torques: int, support: int
) -> float:
    """Chance that `support` - 1 or more torques have a pair that fits (one defines the offset)."""
    trials = np.bincount(pairs.torque[counted], minlength=torques)
    hit = -np.expm1(trials * np.log1p(-min(chance, 1.0 - 1e-12)))
    distribution = np.zeros(torques + 1)
    distribution[0] = 1.0
    for probability in hit:
        distribution[1:] = distribution[1:] * (1 - probability) + distribution[:-1] * probability
        distribution[0] *= 1 - probability
    return float(np.log10(max(distribution[max(0, support - 1) :].sum(), 1e-300)))


def _residual_p_value(relation: VotedRelation, scaled: Array) -> float:
    """Chi-square test of residuals in units of an angle's deviation, too large only."""
    n = len(relation.A)
    covariance = np.eye(n) + relation.A @ relation.A.T
    squares = float((scaled * np.linalg.solve(covariance, scaled.T).T).sum())
    involution = (np.eye(n) == relation.A @ relation.A).all()
    independent = 0.5 if involution else 1.0  # then every pair counts forwards and backwards
    degrees = n * (independent * len(scaled) - 1.0)
    if degrees <= 0.0:
        return 1.0
    return float(stats.chi2.sf(independent * squares, degrees))
