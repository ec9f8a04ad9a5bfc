"""A chain in the form in which equal torques mean equal numbers: offsets, twists, levers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters

Array = NDArray[np.float64]

PARALLEL = 1e-9
"""Axes with a smaller sine of their angle have no offset between them."""
RIGHT_ANGLE = np.pi / 2


@dataclass(frozen=True, eq=False)
class CanonicalForm:
    """Rotations ``F_j = Rz(offset_j) Rx(twist_j)``, zeros of the angles absorbed.

    Attributes
    ----------
    offsets, twists : (n,) arrays
        [rad]; twists in [0, pi]. The first joint's twist is the tilt of its axis against gravity,
        its offset is 0. Offsets between parallel axes mean nothing and are 0 where they are
        exactly parallel.
    levers : (n, 2) array
        [N m], in the frames that follow.
    chain : ChainParameters
        The chain that this was made of: parents, gains, columns.

    Examples
    --------
    >>> quarter = [[0.0, -1.0, 0], [1, 0, 0], [0, 0, 1]]
    >>> sideways = [[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]
    >>> form = CanonicalForm.of(ChainParameters.of([sideways, quarter], [[18.0, 0], [6, 0]]))
    >>> np.rad2deg(form.twists).tolist(), form.levers.round(9).tolist()
    ([90.0, 0.0], [[18.0, 0.0], [0.0, 6.0]])
    """

    offsets: Array
    twists: Array
    levers: Array
    chain: ChainParameters

    @classmethod
    def of(cls, chain: ChainParameters) -> CanonicalForm:
        """Bring a chain into this form; its torques stay the same."""
        n = chain.n
        offsets, twists, turned = np.zeros(n), np.zeros(n), np.zeros(n)
        levers = np.empty((n, 2))
        for j, p in enumerate(chain.parents):
            F = chain.rotations[j]
            if p >= 0:  # what the parent was turned by about its own axis
                F = _about_z(turned[p]) @ F
            x, y, z = F[:, 2]
            sine = np.hypot(x, y)
            twists[j] = np.arctan2(sine, z)
            offsets[j] = np.arctan2(x, -y) if sine > PARALLEL else 0.0
            rest = rotation(offsets[j], twists[j]).T @ F
            turned[j] = np.arctan2(rest[1, 0], rest[0, 0])
            if p < 0:  # turning about the vertical changes nothing
                offsets[j] = 0.0
            levers[j] = (_about_z(turned[j])[:2, :2]) @ chain.levers[j]
        return cls(offsets, twists, levers, chain)

    @classmethod
    def read(cls, chain: ChainParameters) -> CanonicalForm:
        """Read off the numbers of a chain whose rotations are of this form, whatever the signs."""
        F = chain.rotations
        offsets = np.arctan2(F[:, 1, 0], F[:, 0, 0])
        twists = np.arctan2(F[:, 2, 1], F[:, 2, 2])
        return cls(offsets, twists, chain.levers.copy(), chain)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.twists)

    def parameters(self) -> ChainParameters:
        """The chain with these rotations; right angles are exact."""
        rotations = np.array(
            [rotation(o, t) for o, t in zip(self.offsets, self.twists, strict=True)]
        )
        return replace(self.chain, rotations=rotations, levers=self.levers)

    def directions(self) -> Array:
        """Tangents of offset and twist, (n, 2, 3): about the parent's z, and about x."""
        result = np.zeros((self.n, 2, 3))
        result[:, 0, 1], result[:, 0, 2] = np.sin(self.twists), np.cos(self.twists)
        result[:, 1, 0] = 1.0
        return result


def rotation(offset: float, twist: float) -> Array:
    """``Rz(offset) Rx(twist)``, exact at multiples of a right angle."""
    c, s = exact_cos(twist), exact_cos(twist - RIGHT_ANGLE)
    return np.asarray(_about_z(offset) @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]))


def exact_cos(angle: float) -> float:
    """Cosine that is exactly -1, 0 or 1 at multiples of a right angle."""
    turns = angle / RIGHT_ANGLE
    if abs(turns - round(turns)) < 1e-14:
        return (1.0, 0.0, -1.0, 0.0)[round(turns) % 4]
    return float(np.cos(angle))


def _about_z(angle: float) -> Array:
    c, s = exact_cos(angle), exact_cos(angle - RIGHT_ANGLE)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
