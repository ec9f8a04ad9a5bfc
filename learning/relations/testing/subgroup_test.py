"""Samples of torques held against subgroups of a symmetry group, joint by joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.equivariant_basis import (
    multi_affine_frequencies,
    torque_basis,
)
from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.relations.testing.basis_functions import (
    Functions,
    angles,
    breaking_functions,
    waves,
)
from isotorque.learning.relations.testing.nested_models import (
    Comparison,
    Scales,
    compare,
    rank_of,
    scales,
)
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SAME_ANGLE

Array = NDArray[np.float64]

SPARE = 2
"""Samples wanted beyond the functions that are fitted, to know the noise."""
AMPLE = 2
"""Samples wanted for each function before all products of waves are among them."""


class GroupTrial:
    """Samples held against subgroups of a group.

    Parameters
    ----------
    group : SymmetryGroup
    q, tau : (N, n) arrays
        Configurations [rad] and torques [N m].
    noise : MeasurementNoise or None
        Noise levels where known.
    """

    def __init__(
        self, group: SymmetryGroup, q: Array, tau: Array, noise: MeasurementNoise | None
    ) -> None:
        self._group, self._tau = group, tau
        self._coordinates = SymmetryCoordinates.of(group, group.n)
        rows = np.rint(self._coordinates.basis).astype(np.int64)
        kappa = multi_affine_frequencies(self._coordinates.basis)
        single = np.abs(kappa @ rows).sum(axis=1) == 1
        self._kappa = np.concatenate([kappa, 2 * kappa[single]])
        self._of_y = waves(q, self._kappa @ rows)
        self._angles = angles(q)
        self._more = breaking_functions(q)
        everything = self._of_y.beside(self._more)
        self._all = everything if len(q) >= AMPLE * rank_of(everything) else None
        self._known: dict[tuple[int, ...], list[Comparison | None]] = {}
        everyone = range(group.order)
        widest = [self._wide(self._tied(everyone, joint)) for joint in range(group.n)]
        self._scales: list[Scales] = scales(widest, tau, noise)

    def p_value(self, members: Sequence[int]) -> float:
        """Of all relations of a subgroup at once, over all joints; NaN where untestable."""
        found = self.comparisons(members)
        return over_joints([c.p_value for c in found if c is not None])

    def free_directions(self) -> float:
        """P-value of the claim that torques depend on y = B q only."""
        if len(self._group.free_directions) == 0:
            return 1.0
        narrow = self._of_y.beside(self._angles.combined(self._coordinates.basis.T))
        wide = narrow.beside(self._more)
        found = []
        if len(self._tau) >= rank_of(wide) + SPARE:
            torques = zip(self._tau.T, self._scales, strict=True)
            found = [compare(narrow, wide, torque, scale) for torque, scale in torques]
        p_value = over_joints([c.p_value for c in found if c is not None])
        return 1.0 if np.isnan(p_value) else p_value

    def comparisons(self, members: Sequence[int]) -> list[Comparison | None]:
        """A subgroup tested on each joint; None where there are too few samples."""
        key = tuple(members)
        if key not in self._known:
            torques = zip(self._tau.T, self._scales, strict=True)
            self._known[key] = [
                self._comparison(self._tied(members, joint), torque, scale)
                for joint, (torque, scale) in enumerate(torques)
            ]
        return self._known[key]

    def _comparison(self, small: Functions, torque: Array, scale: Scales) -> Comparison | None:
        large = self._wide(small)
        if not scale.known and len(torque) < rank_of(large) + SPARE:
            return None
        return compare(small, large, torque, scale)

    def _tied(self, members: Sequence[int], joint: int) -> Functions:
        """Functions with the relations of a subgroup, for the torque of one joint."""
        index = np.array(members)
        chosen = self._coordinates
        part = SymmetryCoordinates(
            chosen.basis, chosen.A_sat[index], chosen.d_sat[index], chosen.Y[index], chosen.isometry
        )
        tied = self._of_y.combined(torque_basis(part, self._kappa, part.Y[:, joint]))
        return tied.beside(self._angles.combined(self._tied_angles(index, joint)))

    def _tied_angles(self, index: NDArray[np.int64], joint: int) -> Array:
        """Columns v (n, p): v.q is what a spring may add without breaking the relations.

        That is v A = Y v, where all angles in v.q are only exchanged or mirrored: a torque that
        grows with an angle does not come back after a turn.
        """
        A, d = self._group.A[index], wrap(self._group.d[index])
        alone = (np.abs(A).sum(axis=2) == 1) & (np.abs(d) < SAME_ANGLE)
        rows = self._coordinates.basis
        visible = np.abs(np.linalg.pinv(rows) @ rows - np.eye(len(d[0]))).max(axis=0) < 1e-9
        joints = np.flatnonzero(alone.all(axis=0) & visible)
        signs = self._coordinates.Y[index, joint]
        average = np.einsum("g,gij->ji", signs / len(index), A[:, joints][:, :, joints])
        left, singular, _ = np.linalg.svd(average)
        columns = np.zeros((len(d[0]), int((singular > 0.5).sum())))
        columns[joints] = left[:, singular > 0.5]
        return columns

    def _wide(self, small: Functions) -> Functions:
        """More functions: all that there are samples for."""
        return self._all if self._all is not None else small.beside(self._more)


def over_joints(p_values: Sequence[float]) -> float:
    """Bonferroni's bound for the smallest of several; NaN if there is none."""
    return min(1.0, min(p_values) * len(p_values)) if p_values else float("nan")
