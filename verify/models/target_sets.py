"""Configurations on which learned models are tested."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.joint_limits import one_turn

Array = NDArray[np.float64]

DENSE = 2048
"""Size of the dense test set; the project demands at least 1500."""


@dataclass(frozen=True, eq=False)
class TargetSet:
    """A named set of test configurations.

    Attributes
    ----------
    name : str
        What the set is, in a few words.
    q : (m, n) array
        Configurations [rad].
    """

    name: str
    q: Array


def dense_targets(limits: ArrayLike, *, samples: int = DENSE, seed: int = 20180815) -> TargetSet:
    """Return the dense test set: uniform over the joint limits, one turn where they allow it.

    Parameters
    ----------
    limits
        Joint limits (n, 2) [rad], infinite where a joint has none.
    samples
        Number of configurations.
    seed
        Its own seed, so that every model of an arm is tested on the same set.

    Raises
    ------
    InputError
        If limits are reversed or no numbers.

    Examples
    --------
    >>> dense_targets([[-np.pi, np.pi], [0, 1]]).q.shape
    (2048, 2)
    """
    box = np.asarray(limits, dtype=float)
    if box.ndim != 2 or box.shape[1] != 2 or not np.all(box[:, 0] <= box[:, 1]):
        raise InputError("dense targets", "limits", box.tolist(), "(n, 2), lower <= upper [rad]")
    low, high = one_turn(box).T
    q = np.random.default_rng(seed).uniform(low, high, (samples, len(box)))
    return TargetSet(f"dense set of {samples}", q)


def scattered_targets(limits: ArrayLike, count: int, *, seed: int) -> TargetSet:
    """Return random configurations within limits (n, 2) [rad], as the paper's 90 and 84.

    Examples
    --------
    >>> scattered_targets([[-np.pi, np.pi]] * 2, 90, seed=1).name
    '90 scattered targets'
    """
    q = dense_targets(limits, samples=count, seed=seed).q
    return TargetSet(f"{count} scattered targets", q)


def grid_targets(origin: ArrayLike, edges: ArrayLike, counts: Sequence[int]) -> TargetSet:
    """Return a regular grid in a parallelepiped, its faces included.

    Parameters
    ----------
    origin
        A corner (n,) [rad].
    edges
        The edges that leave it, as rows (n, n) [rad].
    counts
        Number of grid points along each edge.

    Notes
    -----
    The paper's 66 targets are read as 6 x 11 in its 2R parallelogram q1 in [0, pi/2], q1 + q2 in
    [0, pi], and its 64 as 4 x 4 x 4; it does not say.

    Examples
    --------
    >>> paper = grid_targets([0, 0], [[np.pi / 2, -np.pi / 2], [0, np.pi]], (6, 11))
    >>> paper.name, paper.q.shape
    ('6 x 11 grid', (66, 2))
    """
    corner, sides = np.asarray(origin, dtype=float), np.asarray(edges, dtype=float)
    steps = np.meshgrid(*(np.linspace(0.0, 1.0, count) for count in counts), indexing="ij")
    share = np.stack([step.ravel() for step in steps], axis=-1)
    return TargetSet(" x ".join(map(str, counts)) + " grid", corner + share @ sides)
