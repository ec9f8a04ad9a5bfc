"""Components of a support that share one frequency sign, and when a sign is admitted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.lattices.integer_lattice import generate_lattice, saturation
from isotorque.symbolic.symmetries.frequency_support import FrequencySupport

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SignComponent:
    """Frequencies of one component of the linear matroid.

    Attributes
    ----------
    members : (p,) int array
        Rows of the support.
    generators : (g,) int array
        Rows of the support that generate the same lattice.
    expressed : (p, g) int array
        The members as integer combinations of the generators.

    Notes
    -----
    Integer relations between frequencies never mix components, so the condition on the phases
    ``exp(i k.d) = u_k`` splits: for each component it says that the phases of the members are
    those combinations of the generators' phases, modulo 2 pi.
    """

    members: NDArray[np.int64]
    generators: NDArray[np.int64]
    expressed: NDArray[np.int64]

    @classmethod
    def of(cls, support: FrequencySupport, members: NDArray[np.int64]) -> SignComponent:
        """Collect what is needed for some rows of a support."""
        if len(members) == len(support.K):
            coordinates, lattice = support.coordinates, support.lattice
        else:
            K = support.K[members]
            B, V = saturation(K)
            inverse = np.linalg.inv(V.astype(float))[:, : len(B)]
            coordinates = np.round(K @ inverse).astype(np.int64)
            lattice = generate_lattice(coordinates)
        rows = members[list(lattice.rows)]
        return cls(members, rows, lattice.coordinates(coordinates) @ lattice.T)

    def misfit(self, support: FrequencySupport, image: NDArray[np.complex128], s: int) -> float:
        """Return the largest |C_{s Y k} - s C_k exp(i k.d)| for the offset of the generators.

        ``image`` holds C_{s Y k} for all rows of the support.
        """
        own, value = support.C[self.members], image[self.members]
        phase = np.angle(s * image[self.generators] / support.C[self.generators])
        turned = s * own * np.exp(1j * (self.expressed @ phase))
        return float(np.abs(value - turned).max(initial=0.0))


def sign_components(support: FrequencySupport) -> list[SignComponent]:
    """Return the components of a support, in the order of their labels."""
    count = int(support.components.max(initial=-1)) + 1
    return [
        SignComponent.of(support, np.flatnonzero(support.components == label))
        for label in range(count)
    ]
