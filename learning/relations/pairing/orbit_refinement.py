"""Joint refinement of relations: completion to their group, orbits in the data, offsets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.pairing.hough_transform import Tolerance
from isotorque.learning.relations.pairing.torque_pairs import TorqueGroups
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import CandidateGroup

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Orbits:
    """Samples of one |tau| that a group connects.

    Attributes
    ----------
    orbit : (N,) int array
        Number of the orbit of each sample, -1 where it stands alone or its place is ambiguous.
    member : (N,) int array
        Which relation leads from the first sample of the orbit to this one.
    count : int
        Number of orbits.
    """

    orbit: Index
    member: Index
    count: int


def find_orbits(groups: TorqueGroups, group: CandidateGroup, tolerance: Tolerance) -> Orbits:
    """Sort samples into orbits of a group, each sample at most once."""
    total = len(groups.q)
    orbit, member = np.full(total, -1, dtype=np.int64), np.full(total, -1, dtype=np.int64)
    widths = tolerance.half_widths(group.A)
    alone = np.ones(total, dtype=bool)
    count = 0
    for root in range(total):
        if not alone[root]:
            continue
        alone[root] = False
        others = np.flatnonzero((groups.torque == groups.torque[root]) & alone)
        images = group.A @ groups.q[root] + group.d
        miss = np.abs(wrap(groups.q[others][:, None] - images[None])) / widths[None]
        signs = groups.signs[others][:, None] == (group.Y * groups.signs[root])[None]
        miss = np.where(signs.all(axis=2), miss.max(axis=2, initial=0.0), np.inf)
        fits = (miss <= 1.0).sum(axis=1)
        taken = others[fits >= 1]
        if not len(taken):
            continue
        alone[taken] = False
        clear = fits == 1
        orbit[root], member[root] = count, 0
        orbit[others[clear]] = count
        member[others[clear]] = miss[clear].argmin(axis=1)
        count += 1
    return Orbits(orbit, member, count)


@dataclass(frozen=True, eq=False)
class Refinement:
    """Offsets of a group refined on all samples at once.

    Attributes
    ----------
    group : CandidateGroup
    offset_errors : (G, n) array
        Standard errors of the offsets [rad].
    sigma : float
        Estimated standard deviation of a measured angle [rad].
    freedom : float
        Degrees of freedom of that estimate.
    """

    group: CandidateGroup
    offset_errors: Array
    sigma: float
    freedom: float


def refine_offsets(
    groups: TorqueGroups, group: CandidateGroup, orbits: Orbits, rounding: float
) -> Refinement:
    """Least squares of all offsets under d_ij = A_i d_j + d_i.

    Parameters
    ----------
    groups : TorqueGroups
    group : CandidateGroup
        Offsets composing exactly.
    orbits : Orbits
    rounding : float
        Smallest credible standard deviation of an angle [rad].

    Notes
    -----
    The composition law leaves a finite group only a shift x of the origin, d_i + (I - A_i) x. Every
    orbit has an unknown base configuration z, and every sample in it must be A_i z + d_i + x: a
    linear least-squares problem with independent residuals, in which no angle is used twice.
    """
    n = group.d.shape[1]
    normal, right = np.zeros((n, n)), np.zeros(n)
    stored = []
    for number in range(orbits.count):
        members = np.flatnonzero(orbits.orbit == number)
        if len(members) < 2:
            continue
        A = group.A[orbits.member[members]]
        predicted = A @ groups.q[members[0]] + group.d[orbits.member[members]]
        residual = wrap(groups.q[members] - predicted)
        design = A.reshape(-1, n)
        q, _ = np.linalg.qr(design)
        origin = np.tile(np.eye(n), (len(members), 1))
        # leave out what the base configuration explains
        seen = origin - q @ (q.T @ origin)
        rest = residual.ravel() - q @ (q.T @ residual.ravel())
        normal += seen.T @ seen
        right += seen.T @ rest
        stored.append((seen, rest, (len(members) - 1) * n))
    inverse = np.linalg.pinv(normal, rcond=1e-9, hermitian=True)
    shift = inverse @ right
    squares = sum(float(((rest - seen @ shift) ** 2).sum()) for seen, rest, _ in stored)
    freedom = sum(f for _, _, f in stored) - int(np.linalg.matrix_rank(normal, tol=1e-6))
    sigma = max(float(np.sqrt(squares / max(freedom, 1))), rounding)
    lever = np.eye(n) - group.A
    offsets = wrap(group.d + lever @ shift)
    variance = np.einsum("gij,jk,gik->gi", lever, inverse, lever)
    refined = CandidateGroup(group.basis, group.A, offsets, group.Y)
    errors = sigma * np.sqrt(np.maximum(variance, 0.0))
    return Refinement(refined, errors, sigma, float(freedom))
