"""A lattice over what an arm can reach: within its limits, by symmetric copies where need be."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.arm import GuidedArm, Outcome
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.joint_limits import one_turn
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup

Array = NDArray[np.float64]

PROBES = 2000
"""Configurations by which the share of the region is estimated that can be reached."""
MARGIN = 1e-6
"""Distance kept from limits [rad]; an arm at a limit has hit it."""


@dataclass(frozen=True, eq=False)
class ReachableLattice:
    """Configurations to be visited, all within limits.

    Attributes
    ----------
    q : (m, n) array
        Configurations [rad], in random order: what is visited first is spread evenly too.
    reachable : float
        Share of the region that can be reached, 0 to 1; the rest is left out.
    """

    q: Array
    reachable: float


def reachable_lattice(
    group: SymmetryGroup | None,
    limits: ArrayLike,
    count: int,
    home: ArrayLike,
    rng: np.random.Generator,
) -> ReachableLattice:
    """Spread configurations over the BCTS, or over all joint angles, within limits.

    Parameters
    ----------
    group
        Symmetry relations: one configuration per orbit is enough, and of an orbit the member is
        taken that lies within the limits. None: all joint angles are sampled.
    limits : (n, 2) array
        Joint limits [rad], infinite where a joint has none.
    count
        Number of configurations wanted; a denser lattice makes up for those out of reach. The
        nearest number that the lattice can give is taken.
    home : (n,) array
        Home configuration [rad]; the BCTS is taken near it, free joints stay there.
    rng
        Shifts the lattice and shuffles the points.

    Raises
    ------
    InputError
        If next to nothing is within limits.

    Examples
    --------
    >>> right = reachable_lattice(None, [[0.0, 1.0]], 5, [0.5], np.random.default_rng(0))
    >>> len(right.q), right.reachable
    (5, 1.0)
    """
    box = np.asarray(limits, dtype=float)
    turning = np.ptp(box, axis=1) >= 2 * np.pi
    if group is None:
        low = np.where(turning, -np.pi, box[:, 0] + MARGIN)
        high = np.where(turning, np.pi, box[:, 1] - MARGIN)
        region = SamplingRegion.of_box(np.stack([low, high], axis=1))
        return ReachableLattice(_shuffled(region, box, count, None, rng), 1.0)
    if group.rank == 0:
        raise InputError("lattice", "joints that the torque depends on", "none", "at least one")
    domain = FundamentalDomain.near(group, home)
    region = SamplingRegion.of_domain(domain)
    probes = domain.sample(np.random.default_rng(0), PROBES)
    reachable = np.zeros(PROBES, dtype=bool)
    for relation in group:
        reachable |= within(relation.configuration(probes), box)
    q = _shuffled(region, box, count, group, rng)
    return ReachableLattice(q, float(reachable.mean()))


def turned_into(q: Array, limits: Array) -> Array:
    """Configurations (m, n), turned by full turns to where limits (n, 2) may hold them [rad]."""
    middle = one_turn(limits).mean(axis=1)
    return np.asarray(middle + wrap(q - middle))


def within(q: Array, limits: Array) -> NDArray[np.bool_]:
    """Whether configurations (m, n) lie within limits (n, 2), up to full turns: (m,)."""
    turned = turned_into(q, limits)
    inside = (turned > limits[:, 0] + MARGIN) & (turned < limits[:, 1] - MARGIN)
    return np.asarray(inside.all(axis=1))


def _shuffled(
    region: SamplingRegion,
    limits: Array,
    count: int,
    group: SymmetryGroup | None,
    rng: np.random.Generator,
) -> Array:
    points = lattice_samples(
        region, count, rng, admit=lambda q: within(q, limits), images=group, exact=False
    ).q
    return turned_into(rng.permutation(points), limits)


def visit(arm: GuidedArm, q: Array) -> Iterator[Outcome]:
    """Place an arm at configurations (m, n) [rad], one after the other, and hold it there.

    Yields
    ------
    Outcome
        Configuration and holding torque as measured.
    """
    for configuration in q:
        arm.place(configuration)
        yield arm.hold()
