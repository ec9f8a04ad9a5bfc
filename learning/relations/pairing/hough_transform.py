"""Hough votes of configuration pairs for the rows of an integer relation."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.pairing.torque_pairs import Pairs
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.compiled import compiled

Array = NDArray[np.float64]
Index = NDArray[np.int64]

WINDOWS_PER_ROW = 4
BEAM = 96


@dataclass(frozen=True, eq=False)
class VotedRelation:
    """A relation q_s = A q_r + d that many pairs obey.

    Attributes
    ----------
    A : (n, n) int array
        Linear part, determinant +-1.
    d : (n,) array
        Offset [rad].
    inliers : (P,) array of bool
        Which pairs obey it.
    """

    A: Index
    d: Array
    inliers: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Tolerance:
    """Tolerance of a pair's deviation from a relation.

    Attributes
    ----------
    sigma : float
        Standard deviation of a measured angle [rad].
    deviations : float
        Allowed deviation in units of the standard deviation of the residual.
    """

    sigma: float
    deviations: float = 3.5

    def half_widths(self, rows: Array | Index) -> Array:
        """Allowed residual of q_s - a.q_r for integer rows a (..., n) [rad]."""
        return self.deviations * self.sigma * np.sqrt(1.0 + (np.asarray(rows) ** 2).sum(axis=-1))


def voted_relations(
    pairs: Pairs, torques: int, tolerance: Tolerance, least_torques: int, largest_entry: int
) -> list[VotedRelation]:
    """Integer relations that pairs of many torques obey.

    Parameters
    ----------
    pairs : Pairs
        All of one Y.
    torques : int
        Number of distinct torques in the whole recording.
    tolerance : Tolerance
    least_torques : int
        A relation needs pairs from so many torques.
    largest_entry : int
        Entries of A are tried from -largest_entry to largest_entry.

    Returns
    -------
    list of VotedRelation
        Those with most inliers first. Purely a proposal: chance is judged elsewhere.

    Notes
    -----
    A torque map with period lattice 2 pi Z^n admits only A in GL(n, Z), and its rows are small.
    For row i every integer vector a turns each pair into an angle q_s,i - a.q_r; a relation shows
    as a narrow peak of these angles on the circle (a Hough transform [1]_, with the offset as its
    one continuous parameter). The next row is voted for by the inliers of the rows before (a beam
    search that keeps the rows whose peaks are least explained by chance).

    References
    ----------
    .. [1] R. O. Duda, P. E. Hart, "Use of the Hough transformation to detect lines and curves in
       pictures", Communications of the ACM 15 (1972).
    """
    n = pairs.q_r.shape[1]
    entries = range(-largest_entry, largest_entry + 1)
    rows = np.array([a for a in itertools.product(entries, repeat=n) if any(a)], dtype=np.int64)
    widths = tolerance.half_widths(rows)
    beam = [_Branch((), (), np.arange(len(pairs)), 0.0)]
    for joint in range(n):
        beam = _grown(pairs, beam, joint, torques, rows, widths, least_torques)
    found = []
    for branch in beam:
        A = rows[list(branch.rows)]
        if round(abs(np.linalg.det(A))) == 1:
            relation = _centred(pairs, A, np.array(branch.centres), widths[list(branch.rows)])
            if len(np.unique(pairs.torque[relation.inliers])) >= least_torques:
                found.append(relation)
    found.sort(key=lambda relation: (-int(relation.inliers.sum()), int(np.abs(relation.A).sum())))
    return found


@dataclass(frozen=True, eq=False)
class _Branch:
    """Some rows chosen: pairs that obey them, and how little chance explains their number."""

    rows: tuple[int, ...]
    centres: tuple[float, ...]
    members: Index
    log_chance: float


def _grown(
    pairs: Pairs,
    beam: list[_Branch],
    joint: int,
    torques: int,
    rows: Index,
    widths: Array,
    least_torques: int,
) -> list[_Branch]:
    """Best branches with one more row."""
    parent, row, centre, log_chance, surprise = [], [], [], [], []
    for number, branch in enumerate(beam):
        members = branch.members
        found, at, votes = _windows(
            pairs.q_r[members],
            pairs.q_s[members, joint],
            pairs.torque[members],
            torques,
            rows,
            widths,
            least_torques,
            WINDOWS_PER_ROW,
        )
        chance = branch.log_chance + np.log(np.minimum(widths[found] / np.pi, 0.99))
        parent.append(np.full(len(found), number))
        row.append(found)
        centre.append(at)
        log_chance.append(chance)
        surprise.append(_surprise(votes, len(pairs), chance))
    if not parent:
        return []
    parents, found_rows = np.concatenate(parent), np.concatenate(row)
    centres, chances = np.concatenate(centre), np.concatenate(log_chance)
    surprises = np.concatenate(surprise)
    grown = []
    for i in np.argsort(-surprises, kind="stable")[:BEAM].tolist():
        branch, index = beam[parents[i]], int(found_rows[i])
        members = branch.members
        residual = pairs.q_s[members, joint] - pairs.q_r[members] @ rows[index] - centres[i]
        near = np.abs(wrap(residual)) <= widths[index]
        grown.append(
            _Branch(
                (*branch.rows, index),
                (*branch.centres, float(centres[i])),
                members[near],
                float(chances[i]),
            )
        )
    return grown


def _surprise(votes: Array | Index, pairs: int, log_chance: Array) -> Array:
    """Minus the log of the chance of so many votes (Chernoff bound of the binomial tail)."""
    share = np.clip(np.asarray(votes) / pairs, 1e-300, 1.0)
    rest = np.maximum(1.0 - share, 1e-300)
    other = np.log1p(-np.exp(log_chance))
    divergence = share * (np.log(share) - log_chance) + rest * (np.log(rest) - other)
    return np.where(share > np.exp(log_chance), pairs * divergence, 0.0)


def _centred(pairs: Pairs, A: Index, centres: Array, widths: Array) -> VotedRelation:
    """Move the offset to the circular mean of its inliers."""
    offset = centres
    linear = pairs.q_s - pairs.q_r @ A.T
    for _ in range(4):
        inliers = (np.abs(wrap(linear - offset)) <= widths).all(axis=1)
        if not inliers.any():
            break
        offset = wrap(offset + wrap(linear[inliers] - offset).mean(axis=0))
    inliers = (np.abs(wrap(linear - offset)) <= widths).all(axis=1)
    return VotedRelation(A, offset, np.asarray(inliers))


@compiled
def _windows(q_r, q_s, torque, torques, rows, widths, least_torques, most):
    """Best windows of every row: arrays of row, centre of the window, pairs in it.

    For each row at most `most` windows that do not overlap, with pairs of `least_torques`.
    """
    pairs = len(q_s)
    n = rows.shape[1]
    out_row = np.empty(len(rows) * most, dtype=np.int64)
    out_centre = np.empty(len(rows) * most)
    out_votes = np.empty(len(rows) * most, dtype=np.int64)
    found = 0
    turn = 2.0 * np.pi
    phase = np.empty(pairs)
    inside = np.empty(torques, dtype=np.int64)
    for row in range(len(rows)):
        for p in range(pairs):
            x = q_s[p]
            for j in range(n):
                x -= rows[row, j] * q_r[p, j]
            phase[p] = x - turn * np.floor(x / turn)
        order = np.argsort(phase)
        span = min(2.0 * widths[row], turn)
        votes = np.zeros(pairs, dtype=np.int64)
        inside[:] = 0
        distinct = 0
        end = 0  # window of sorted pairs left ... end - 1, running over the turn
        for left in range(pairs):
            while end < left + pairs:
                position = end if end < pairs else end - pairs
                angle = phase[order[position]] + (0.0 if end < pairs else turn)
                if angle > phase[order[left]] + span:
                    break
                k = torque[order[position]]
                if inside[k] == 0:
                    distinct += 1
                inside[k] += 1
                end += 1
            if distinct >= least_torques:
                votes[left] = end - left
            k = torque[order[left]]
            inside[k] -= 1
            if inside[k] == 0:
                distinct -= 1
        for _ in range(most):
            best = int(np.argmax(votes))
            if votes[best] == 0:
                break
            first = phase[order[best]]
            total = 0.0
            for p in range(votes[best]):
                position = best + p
                angle = phase[order[position % pairs]] - first
                total += angle + (turn if position >= pairs else 0.0)
            out_row[found] = row
            out_centre[found] = first + total / votes[best]
            out_votes[found] = votes[best]
            found += 1
            low = first - span
            for p in range(pairs):
                gap = phase[order[p]] - low
                gap -= turn * np.floor(gap / turn)
                if gap <= 2.0 * span:
                    votes[p] = 0
    return out_row[:found], out_centre[:found], out_votes[:found]
