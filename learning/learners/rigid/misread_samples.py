"""Recordings that are a rigid chain's once they are read rightly: degrees, columns, signs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone

from isotorque.learning.learners.rigid.rigid_chain import RigidChain

Array = NDArray[np.float64]

STARTS = 40
"""Random starts at most of the fit to each other reading."""


def other_reading(learner: RigidChain, q: Array, torque: Array, names: Sequence[str]) -> str | None:
    """What would make samples those of a rigid chain, if they are none as they stand.

    Parameters
    ----------
    learner
        How the samples were fitted; its settings are those of the fits to other readings.
    q, torque : (m, n) arrays
        Configurations and torques as recorded.
    names
        Of the joints.

    Returns
    -------
    str or None
        The reading, as the end of a sentence; None if there is none.

    Notes
    -----
    Tried are angles in degrees (where some exceed a turn), two torque columns swapped, two angle
    columns swapped, the sign of one joint's torque, and torques taken for angles. Samples of a
    rigid arm have few more equations than the chain has numbers only if there are few poses, so a
    reading that fits is hardly ever an accident; it is told, not applied.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-3.0, 3.0, (12, 2))
    >>> lower = 6.0 * np.cos(q.sum(axis=1))
    >>> torque = np.stack([18.0 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> other_reading(RigidChain(), np.rad2deg(q), torque, ["a", "b"])
    'the angles are in degrees'
    >>> other_reading(RigidChain(), q, torque[:, ::-1], ["a", "b"])
    'the torque columns of a and b are swapped'
    """
    for angles, torques, said in _readings(q, torque, names):
        trial = clone(learner).set_params(max_starts=STARTS)
        if trial.fit(angles, torques).verdict_.accepted:
            return said
    return None


def _readings(q: Array, torque: Array, names: Sequence[str]) -> Iterator[tuple[Array, Array, str]]:
    """Yield other readings of the columns, the likely ones first."""
    n = q.shape[1]
    if np.abs(q).max(initial=0.0) > 2.0 * np.pi:
        yield np.deg2rad(q), torque, "the angles are in degrees"
    yield torque, q, "the columns of angles and torques are exchanged"
    for j in range(n):
        signs = np.ones(n)
        signs[j] = -1.0
        yield q, torque * signs, f"the torque of {names[j]} has the wrong sign"
    pairs = list(combinations(range(n), 2))
    swaps = [(i, j, _swapped(n, i, j)) for i, j in pairs]
    for i, j, order in swaps:
        yield q, torque[:, order], f"the torque columns of {names[i]} and {names[j]} are swapped"
    for i, j, order in swaps:
        yield q[:, order], torque, f"the angle columns of {names[i]} and {names[j]} are swapped"


def _swapped(n: int, i: int, j: int) -> list[int]:
    order = list(range(n))
    order[i], order[j] = j, i
    return order
