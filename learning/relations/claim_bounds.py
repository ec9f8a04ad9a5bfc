"""Bounds of relations of the measured torque: gravity and what else the joints carry."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.identification.group_fit import torque_uncertainty
from isotorque.learning.relations.lack_of_fit import LackOfFit
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.symbolic.groups.group_arrays import CandidateGroup, lifted_relations

Array = NDArray[np.float64]


def claim_bounds(
    fit: FittedPotential,
    lack: LackOfFit,
    group: CandidateGroup,
    deviations: float,
    *,
    corrected: bool = False,
) -> tuple[Array, Array]:
    """Bounds on the error of each relation of the measured torque.

    Parameters
    ----------
    fit : FittedPotential
    lack : LackOfFit
        Of the same fit.
    group : CandidateGroup
    deviations : float
        Number of standard errors added everywhere.
    corrected : bool
        Of the torque less the constants of ``lack.offset_joints``, not of the torque as measured.

    Returns
    -------
    bound : (G, n) array
        Over all q [N m]: the largest over the fitted form and every alternative to it that the
        samples do not exclude, each with its own coefficients.
    rms : (G, n) array
        Root mean square over all q of the gravity part [N m], if the joints that showed no
        constant torque have none: how well the samples know gravity. The bound takes nothing of
        that kind for granted.

    Notes
    -----
    A relation ``tau' = Y tau`` of the measured torque is off by ``(I - Y) b`` through constants b,
    and by up to twice the size of any other torque that does not follow it. An alternative that
    was not seen may still be there, as large as its estimate and so many standard errors. A joint
    whose torque never stood out of the noise may hold as much as was seen of it.
    """
    bound, _ = torque_uncertainty(fit, group, deviations)
    gravity = fit.without_constants(lack.offset_joints)
    _, rms = torque_uncertainty(gravity, group, deviations)
    taken = lack.offsets.copy() if corrected else np.zeros(len(lack.offsets))
    taken[np.setdiff1d(np.arange(len(taken)), lack.offset_joints)] = 0.0
    bound = bound + _of_constants(fit, group, deviations, taken)
    relations = lifted_relations(group)
    unit = np.eye(group.Y.shape[1])
    for other in lack.alternatives:
        wider, _ = torque_uncertainty(other.fit, group, deviations)
        wider = wider + _of_constants(other.fit, group, deviations, taken)
        for i, relation in enumerate(relations):
            if other.name == "spring":
                kept = (relation.Y[:, None] * unit == relation.A).all(axis=1) & (relation.d == 0.0)
            else:
                kept = (unit == relation.A).all(axis=1) & (relation.d == 0.0) & (relation.Y > 0.0)
            wider[i] += np.where(kept, 0.0, 2.0 * other.size)
        bound = np.maximum(bound, wider)
    if lack.silent is not None:
        moved = [not relation.is_identity for relation in relations]
        bound = bound + np.outer(moved, 2.0 * lack.silent)
    return bound, rms


def _of_constants(
    fit: FittedPotential, group: CandidateGroup, deviations: float, taken: Array
) -> Array:
    limit = np.abs(fit.offsets - taken) + deviations * fit.offset_errors
    return np.asarray((1.0 - group.Y) * limit)
