"""Pairs of configurations that were held by the same torque up to signs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

ROUNDING = 1e-15
"""Of a difference of torques, relative to the largest: looked at beyond the tolerance."""


@dataclass(frozen=True, eq=False)
class TorqueGroups:
    """Samples sorted by |tau|.

    Attributes
    ----------
    q : (N, n) array
        Configurations [rad].
    signs : (N, n) array
        Signs of the torque components.
    torque : (N,) int array
        Number of the distinct |tau| that a sample belongs to, 0 ... K - 1.
    magnitudes : (K, n) array
        The distinct |tau| [N m].
    left_out : int
        Samples left out because a component is too near to zero for its sign to mean anything.
    """

    q: Array
    signs: Array
    torque: Index
    magnitudes: Array
    left_out: int

    @property
    def count(self) -> int:
        """Number K of distinct |tau|."""
        return len(self.magnitudes)


@dataclass(frozen=True, eq=False)
class Pairs:
    """Ordered pairs (r, s), r != s, of samples with one |tau| and torque signs Y between them.

    Attributes
    ----------
    Y : (n,) array
        tau_s = Y tau_r.
    r, s : (P,) int arrays
        Samples.
    q_r, q_s : (P, n) arrays
        Their configurations [rad].
    torque : (P,) int array
        Number of the |tau|.
    """

    Y: Array
    r: Index
    s: Index
    q_r: Array
    q_s: Array
    torque: Index

    def __len__(self) -> int:
        """Number of pairs."""
        return len(self.r)


def group_by_torque(q: Array, tau: Array, tolerance: float, smallest_share: float) -> TorqueGroups:
    """Sort samples by |tau|.

    Parameters
    ----------
    q, tau : (N, n) arrays
        Samples [rad], [N m]; joints that never need torque left out.
    tolerance : float
        |tau| that differ by less in every component are one [N m].
    smallest_share : float
        Samples with a component below this share of the joint's largest torque are left out.

    Examples
    --------
    >>> q = np.zeros((4, 1))
    >>> groups = group_by_torque(q, np.array([[1.0], [-1.0], [2.0], [0.01]]), 1e-9, 0.05)
    >>> groups.torque.tolist(), groups.left_out
    ([0, 0, 1], 1)
    """
    magnitude = np.abs(tau)
    clear = (magnitude >= smallest_share * magnitude.max(axis=0, initial=0.0)).all(axis=1)
    magnitude, signs = magnitude[clear], np.sign(tau[clear])
    label = np.full(len(magnitude), -1, dtype=np.int64)
    distinct: list[Array] = []
    # only samples whose first components are near can be alike
    order = np.argsort(magnitude[:, 0], kind="stable")
    first = magnitude[order, 0]
    reach = tolerance + ROUNDING * first.max(initial=0.0)
    low = np.searchsorted(first, magnitude[:, 0] - reach, "left")
    high = np.searchsorted(first, magnitude[:, 0] + reach, "right")
    for i in range(len(magnitude)):
        if high[i] - low[i] == 1:
            label[i] = len(distinct)
            distinct.append(magnitude[i])
        elif label[i] < 0:
            near = np.sort(order[low[i] : high[i]])
            alike = (np.abs(magnitude[near] - magnitude[i]) <= tolerance).all(axis=1)
            alike = near[alike & (label[near] < 0)]
            label[alike] = len(distinct)
            distinct.append(magnitude[alike].mean(axis=0))
    return TorqueGroups(
        q[clear], signs, label, np.array(distinct).reshape(-1, q.shape[1]), int((~clear).sum())
    )


def pairs_by_signs(groups: TorqueGroups) -> list[Pairs]:
    """All ordered pairs within the groups, one entry per Y that occurs."""
    firsts, seconds = [], []
    several = np.flatnonzero(np.bincount(groups.torque, minlength=groups.count) > 1)
    order = np.argsort(groups.torque, kind="stable")
    ordered = groups.torque[order]
    first = np.searchsorted(ordered, several, "left")
    end = np.searchsorted(ordered, several, "right")
    for begin, beyond in zip(first, end, strict=True):
        members = order[begin:beyond]
        r, s = np.meshgrid(members, members, indexing="ij")
        off_diagonal = r != s
        firsts.append(r[off_diagonal])
        seconds.append(s[off_diagonal])
    if not firsts:
        return []
    r, s = np.concatenate(firsts), np.concatenate(seconds)
    flips = groups.signs[r] * groups.signs[s]
    kinds, kind = np.unique(flips, axis=0, return_inverse=True)
    found = []
    for number, Y in enumerate(kinds):
        chosen = kind.ravel() == number
        i, j = r[chosen], s[chosen]
        found.append(Pairs(Y, i, j, groups.q[i], groups.q[j], groups.torque[i]))
    return found
