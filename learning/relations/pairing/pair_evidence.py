"""Evidence of recorded pairs for each relation of a group, and pairs that no relation explains."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.learned_symmetries import FreeRegression, RejectedPairs
from isotorque.learning.relations.pairing.a_contrario_test import AcceptedRelation
from isotorque.learning.relations.pairing.free_regression import regress_relation
from isotorque.learning.relations.pairing.hough_transform import Tolerance
from isotorque.learning.relations.pairing.orbit_refinement import Refinement
from isotorque.learning.relations.pairing.torque_pairs import Pairs
from isotorque.learning.statistics.tails import tail_probability
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import SAME_ESTIMATED_OFFSET, CandidateGroup

Array = NDArray[np.float64]


def obeying_pairs(
    kinds: list[Pairs], Y: Array, A: Array, d: Array, tolerance: Tolerance
) -> tuple[Pairs | None, NDArray[np.bool_]]:
    """Pairs with torque signs Y, None if there are none, and which of them obey a relation."""
    for pairs in kinds:
        if np.array_equal(pairs.Y, Y):
            miss = np.abs(wrap(pairs.q_s - pairs.q_r @ A.T - d))
            return pairs, np.asarray((miss <= tolerance.half_widths(A)).all(axis=1))
    return None, np.zeros(0, dtype=bool)


def supports(kinds: list[Pairs], group: CandidateGroup, tolerance: Tolerance) -> NDArray[np.int64]:
    """Number of distinct torques with a pair that obeys each relation, shape (G,)."""
    counts = []
    for A, d, Y in zip(group.A, group.d, group.Y, strict=True):
        pairs, obeying = obeying_pairs(kinds, Y, A, d, tolerance)
        counts.append(0 if pairs is None else len(np.unique(pairs.torque[obeying])))
    return np.array(counts, dtype=np.int64)


class PairEvidence:
    """Pairs of a recording held against a group.

    Parameters
    ----------
    kinds : list of Pairs
        All pairs, one entry per Y.
    refinement : Refinement
        The group, in the coordinates of the pairs, with the noise of the angles.
    accepted : list of AcceptedRelation
        Relations that were found on their own.
    tolerance : Tolerance
        Which pairs obey a relation.
    """

    def __init__(
        self,
        kinds: list[Pairs],
        refinement: Refinement,
        accepted: list[AcceptedRelation],
        tolerance: Tolerance,
    ) -> None:
        self._kinds = kinds
        self._refinement = refinement
        self._accepted = accepted
        group = refinement.group
        self._obeying = [
            obeying_pairs(kinds, Y, A, d, tolerance)
            for A, d, Y in zip(group.A, group.d, group.Y, strict=True)
        ]

    def support(self, i: int) -> int:
        """Number of distinct torques with a pair that obeys relation i."""
        pairs, obeying = self._obeying[i]
        return 0 if pairs is None else len(np.unique(pairs.torque[obeying]))

    def regression(self, i: int) -> FreeRegression | None:
        """Free real regression on the pairs of relation i."""
        pairs, obeying = self._obeying[i]
        if pairs is None:
            return None
        group = self._refinement.group
        return regress_relation(pairs.q_r[obeying], pairs.q_s[obeying], group.A[i], group.d[i])

    def p_value(self, i: int) -> float:
        """Whether the offset of relation i, refined with the group, suits its own pairs."""
        pairs, obeying = self._obeying[i]
        if pairs is None:
            return 1.0
        group = self._refinement.group
        A, n = group.A[i], group.A.shape[1]
        if np.array_equal(A @ A, np.eye(n)):  # every pair counts forwards and backwards
            obeying = obeying & (pairs.r < pairs.s)
        if not obeying.any():
            return 1.0
        residual = wrap(pairs.q_s - pairs.q_r @ A.T - group.d[i])[obeying]
        covariance = self._refinement.sigma**2 * (np.eye(n) + A @ A.T) / len(residual)
        mean = residual.mean(axis=0)
        statistic = float(mean @ np.linalg.solve(covariance, mean))
        return tail_probability(statistic, n, self._refinement.freedom)

    def log10_false_alarms(self, i: int) -> float:
        """Of the accepted relation that relation i is; NaN where it was not found on its own."""
        group = self._refinement.group
        for found in self._accepted:
            if (
                np.array_equal(found.Y, group.Y[i])
                and np.array_equal(found.A, group.A[i])
                and (np.abs(wrap(found.d - group.d[i])) < SAME_ESTIMATED_OFFSET).all()
            ):
                return found.log10_false_alarms
        return float("nan")

    def rejected(self) -> tuple[RejectedPairs, ...]:
        """Pairs that no relation of the group explains: secondary symmetries, or errors."""
        out = []
        for pairs in self._kinds:
            explained = np.zeros(len(pairs), dtype=bool)
            for other, obeying in self._obeying:
                if other is pairs:
                    explained |= obeying
            left = ~explained & (pairs.r < pairs.s)
            if left.any():
                out.append(
                    RejectedPairs(pairs.Y, pairs.q_r[left], pairs.q_s[left], pairs.torque[left])
                )
        return tuple(out)
