"""Rows that were recorded in one pose: what counts as one configuration of the arm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree
from scipy.special import rel_entr

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]
Labels = NDArray[np.intp]

TURN = 2.0 * np.pi
ROUNDING = 1e-8
"""Configurations so near to each other [rad] are one, whatever the rest looks like."""
WIDEST = 0.02
"""Widest a pose may be [rad]: what stands further apart is two."""
FARTHEST = 1.0
"""How far distances are tried [rad]."""
LEVEL = 3.0
"""Distances are tried in steps of this ratio."""
GAPS = (2, 3, 4)
"""Steps that a gap may last: the first is the least."""
CLEAR = 0.9
"""Least share of the rows joined beyond the gap that were joined before it."""
CHANCE = 1e-4
"""Largest chance with which rows that nobody repeated are taken for repeated ones."""


@dataclass(frozen=True, eq=False)
class Poses:
    """Rows grouped into poses.

    Attributes
    ----------
    label : (N,) int array
        Pose of every row, numbered in the order in which the rows first reach it.
    count : int
        Number of poses.
    """

    label: Labels
    count: int

    @property
    def repeated(self) -> bool:
        """Whether any pose has more than one row."""
        return self.count < len(self.label)

    @property
    def rows(self) -> NDArray[np.int64]:
        """Number of rows of every pose, (count,)."""
        return np.bincount(self.label, minlength=self.count)

    def means(self, values: Array, weight: Array | None = None) -> Array:
        """Mean over the rows of every pose, (count, k), of values (N, k), weighed by (N,)."""
        sums = np.zeros((self.count, values.shape[1]))
        np.add.at(sums, self.label, values if weight is None else values * weight[:, None])
        total = self.rows if weight is None else np.bincount(self.label, weight, self.count)
        return np.asarray(sums / np.maximum(total, 1e-300)[:, None])

    def configurations(self, q: Array) -> Array:
        """Mean configurations (count, n) of rows q (N, n) [rad], turns of the first row kept."""
        first = q[self.first]
        return np.asarray(first + self.means(wrap(q - first[self.label])))

    def spread(self, values: Array) -> tuple[Array, int]:
        """Pure error: scatter within poses.

        Returns
        -------
        deviation : (k,) array
            Standard deviation of the rows (N, k) of one pose; NaN where no pose is repeated.
        freedom : int
            Degrees of freedom, the rows less the poses.
        """
        freedom = len(self.label) - self.count
        if not freedom:
            return np.full(values.shape[1], np.nan), 0
        squares = ((values - self.means(values)[self.label]) ** 2).sum(axis=0)
        return np.sqrt(squares / freedom), freedom

    def taken(self, rows: NDArray[np.bool_]) -> Poses:
        """The poses of some of the rows (N,)."""
        return _in_order(self.label[rows])

    def split(self, values: Array) -> Poses:
        """Rows of one pose that differ in values (N, k) are different ones."""
        keys = np.column_stack([self.label, values])
        return _in_order(np.unique(keys, axis=0, return_inverse=True)[1].ravel())

    @property
    def first(self) -> Labels:
        """First row of every pose, (count,)."""
        return np.unique(self.label, return_index=True)[1]


def group_poses(q: ArrayLike, turning: ArrayLike | None = None) -> Poses:
    """Group rows that were recorded in one pose.

    Parameters
    ----------
    q : (N, n) array_like
        Configurations [rad], as measured.
    turning : (n,) array_like of bool, optional
        Joints whose angles count modulo a full turn; all of them by default.

    Returns
    -------
    Poses

    Raises
    ------
    InputError
        If q is no table of finite numbers.

    Notes
    -----
    How near is near enough follows from the data: rows of one pose scatter by what the encoders and
    the repeatability of the arm leave, different poses stand further apart, and in between lies a
    gap. Rows nearer than a distance r are joined, for growing r. Rows that nobody repeated, strewn
    along a curve, have a share ``F(r) = 1 - exp(-c r)`` joined (in a volume it grows faster); so of
    the k' rows joined by the distance g r, about ``k' (1 - (1 - F)^(1/g)) / F`` were by r. Where
    that many more were that chance explains it with less than ``CHANCE`` (Chernoff's bound of the
    binomial distribution) lies a gap; the widest distance with one counts. Poses wider than
    ``WIDEST`` are none. Rows nearer than ``ROUNDING`` are always one pose.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> poses = rng.uniform(-3.0, 3.0, (8, 2))
    >>> rows = np.repeat(poses, 25, axis=0) + 1e-4 * rng.normal(size=(200, 2))
    >>> group_poses(rows).count, group_poses(rng.uniform(-3.0, 3.0, (200, 2))).count
    (8, 200)
    """
    rows = np.asarray(q, dtype=float)
    if rows.ndim != 2 or not np.isfinite(rows).all():
        raise InputError("poses", "q", f"shape {rows.shape}", "a table (N, n) of finite numbers")
    count, n = rows.shape
    if not count or not n:
        return Poses(np.arange(count) if n else np.zeros(count, dtype=np.intp), min(count, 1))
    around = np.ones(n, dtype=bool) if turning is None else np.asarray(turning, dtype=bool)
    places = np.where(around, np.mod(rows, TURN), rows)
    places = np.where(around & (places >= TURN), 0.0, places)
    box = np.where(around, TURN, 0.0)
    label = _joined(places, box, ROUNDING)
    exact = int(label.max()) + 1
    return _in_order(_repeated(places, box, label) if exact > 1 else label)


def by_pose(q: Array, tau: Array) -> tuple[Poses, Array, Array]:
    """Group rows by pose and average them: one sample per pose.

    Parameters
    ----------
    q, tau : (N, n) arrays
        Rows [rad], [N m].

    Returns
    -------
    poses : Poses
    q, tau : (count, n) arrays
        The rows themselves where no pose is repeated.

    Examples
    --------
    >>> poses, q, tau = by_pose(np.array([[0.5], [1.5], [0.5]]), np.array([[1.0], [4.0], [2.0]]))
    >>> q.tolist(), tau.tolist()
    ([[0.5], [1.5]], [[1.5], [4.0]])
    """
    poses = group_poses(q)
    if not poses.repeated:
        return poses, q, tau
    return poses, poses.configurations(q), poses.means(tau)


def poses_and_sides(q: Array, sides: Array | None) -> Poses:
    """Group rows by pose, and by the side from which it was reached where these are known."""
    poses = group_poses(q)
    return poses if sides is None or not poses.repeated else poses.split(sides)


def by_pose_and_side(
    q: Array, tau: Array, sides: Array | None, weight: Array, *, summed: bool = True
) -> tuple[Array, Array, Array | None, Array]:
    """One sample per pose, and per side from which it was reached: weighted means.

    What is fitted to them is what the rows would give; what is left over counts by pose.

    Parameters
    ----------
    q, tau : (N, n), (N, k) arrays
        Rows [rad], [N m].
    sides : (N, n) array or None
        Signs of the last motion of every joint; None where not known.
    weight : (N,) array
        Of the squared errors of the rows.
    summed : bool
        Whether the weights of a sample's rows are summed; otherwise their mean counts.

    Examples
    --------
    >>> q, tau, weight = np.array([[0.5], [0.5]]), np.array([[1.0], [4.0]]), np.array([2.0, 1.0])
    >>> [x.tolist() for x in by_pose_and_side(q, tau, None, weight) if x is not None]
    [[[0.5]], [[2.0]], [3.0]]
    >>> [len(x) for x in by_pose_and_side(q, tau, np.array([[1.0], [-1.0]]), weight)]
    [2, 2, 2, 2]
    """
    split = poses_and_sides(q, sides)
    if not split.repeated:
        return q, tau, sides, weight
    first = q[split.first]
    at = first + split.means(wrap(q - first[split.label]), weight)
    total = np.bincount(split.label, weight, split.count).astype(float)
    total = total if summed else total / split.rows
    return at, split.means(tau, weight), None if sides is None else sides[split.first], total


def _repeated(places: Array, box: Array, exact: Labels) -> Labels:
    """Labels at the largest distance with a gap beyond; the exact ones where there is none."""
    labels, total = [exact], len(places)
    distances = ROUNDING * LEVEL ** np.arange(int(np.log(FARTHEST / ROUNDING) / np.log(LEVEL)) + 1)
    for i, r in enumerate(distances[1:]):
        near = labels[max(0, i - 1)]  # rows far nearer than r are looked at once
        centers = _centers(places, box, near, np.bincount(near))
        labels.append(_joined(centers, box, float(r))[near])
    joined = np.array([total - int(label.max()) - 1 for label in labels], dtype=float)
    for i in np.flatnonzero(distances[: -GAPS[0]] <= WIDEST)[::-1]:
        chance = 0.0
        for gap in GAPS:
            later = joined[min(i + gap, len(joined) - 1)]
            if not later or joined[i] < CLEAR * later:
                break
            share = later / (total - 1)
            expected = (1.0 - (1.0 - share) ** (LEVEL**-gap)) / share
            chance = min(chance, -later * _divergence(joined[i] / later, expected))
        if chance < np.log(CHANCE) and _widths(places, box, labels[i]).max() <= WIDEST:
            return labels[i]
    return exact


def _divergence(found: float, expected: float) -> float:
    """Kullback-Leibler divergence of two shares; 0 where no more are found than expected."""
    if found <= expected:
        return 0.0
    return float(rel_entr(found, expected) + rel_entr(1.0 - found, 1.0 - expected))


def _joined(places: Array, box: Array, distance: float) -> Labels:
    """Connected components of places nearer than a distance in every joint."""
    pairs = KDTree(places, boxsize=box).query_pairs(distance, p=np.inf, output_type="ndarray")
    size = len(places)
    if not len(pairs):
        return np.arange(size)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (size, size))
    return np.asarray(connected_components(graph, directed=False)[1])


def _offsets(places: Array, box: Array, label: Labels) -> tuple[Array, Array]:
    """First place of every group, and how far each place is from that of its group."""
    first = places[np.unique(label, return_index=True)[1]]
    away = places - first[label]
    turned = box > 0.0
    away[:, turned] = wrap(away[:, turned])
    return first, away


def _centers(places: Array, box: Array, label: Labels, members: NDArray[np.int64]) -> Array:
    first, away = _offsets(places, box, label)
    sums = np.zeros_like(first)
    np.add.at(sums, label, away)
    centers = first + sums / members[:, None]
    turned = np.mod(centers, TURN)
    return np.where(box > 0.0, np.where(turned >= TURN, 0.0, turned), centers)


def _widths(places: Array, box: Array, label: Labels) -> Array:
    """Largest extent of every group over the joints [rad]."""
    first, away = _offsets(places, box, label)
    low, high = np.zeros_like(first), np.zeros_like(first)
    np.minimum.at(low, label, away)
    np.maximum.at(high, label, away)
    return np.asarray((high - low).max(axis=1))


def _in_order(label: Labels) -> Poses:
    """Number the groups in the order of their first rows."""
    _, first, index = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(len(first))
    return Poses(rank[index.ravel()], len(first))
