"""Largest subgroup that samples support, and the relations that they contradict.

Springs, cables and bent links break symmetries that rigid, straight arms have. A learner that ties
its model to a group cannot see that; so ask before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.relations.testing.judge_candidates import Judgement
from isotorque.learning.relations.testing.subgroup_test import GroupTrial, over_joints
from isotorque.learning.statistics.poses import by_pose
from isotorque.learning.statistics.static_samples import static_samples
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.subgroups import generated, largest_subgroups
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation, identity

Array = NDArray[np.float64]

LEVEL = 1e-3
"""Probability with which any relation of a group that holds is called contradicted."""


@dataclass(frozen=True, eq=False)
class TestedRelation:
    """One relation and its test by samples.

    Attributes
    ----------
    relation : SymmetryRelation
    judgement : Judgement
    p_value : float
        Probability of a misfit like this, or a larger one, if the relation holds; joints are
        accounted for, the number of relations is not. NaN where untested.
    violation : (n,) array
        Root mean square, over the samples, by which the torques miss the relation [N m].
    resolution : (n,) array
        How large that would be by noise alone [N m]: smaller violations stay hidden.
    """

    __test__ = False  # no test class, whatever pytest thinks

    relation: SymmetryRelation
    judgement: Judgement
    p_value: float
    violation: Array
    resolution: Array


@dataclass(frozen=True, eq=False)
class SupportedGroup:
    """The part of a group that samples support.

    Attributes
    ----------
    group : SymmetryGroup
        The largest subgroup without a contradicted relation, for learners to use. Where torques
        depend on directions that the group calls free: the identity, on all joints.
    tested : tuple of TestedRelation
        Every relation but the identity, in the order of the group asked about.
    p_value : float
        Of all relations of ``group`` at once; 1 where there is nothing to test.
    free_p_value : float
        Of the claim that the free directions of the group are free; 1 where it has none.
    """

    group: SymmetryGroup
    tested: tuple[TestedRelation, ...]
    p_value: float
    free_p_value: float

    @property
    def contradicted(self) -> tuple[TestedRelation, ...]:
        """Relations that do not hold on this arm."""
        return tuple(t for t in self.tested if t.judgement is Judgement.CONTRADICTED)

    @property
    def whole(self) -> bool:
        """Whether the whole group is left."""
        return self.group.order == len(self.tested) + 1

    @property
    def testable(self) -> bool:
        """Whether there were samples enough to test every relation."""
        return all(t.judgement is not Judgement.UNTESTABLE for t in self.tested)

    def __str__(self) -> str:
        order = len(self.tested) + 1
        if not self.testable:
            return f"too few samples to test all {order} relations; those untested are kept"
        if self.whole:
            return f"the samples contradict none of {order} relations"
        worst = max((float(t.violation.max()) for t in self.contradicted), default=0.0)
        return (
            f"{len(self.contradicted)} of {order} relations do not hold on this arm (a spring, a "
            f"cable, a bent link?): torques miss them by up to {worst:.2g} N m RMS; "
            f"{self.group.order} are used"
        )


def supported_group(
    group: SymmetryGroup,
    q: ArrayLike,
    tau: ArrayLike,
    noise: MeasurementNoise | None = None,
    *,
    level: float = LEVEL,
) -> SupportedGroup:
    """Test every relation of a group against static samples before a learner enforces it.

    Parameters
    ----------
    group : SymmetryGroup
        Derived from a drawing, learned from other samples, or learned from these.
    q : (N, n) array_like
        Configurations at rest [rad].
    tau : (N, n) array_like
        Torques that held them [N m]; outliers should be out.
    noise : MeasurementNoise, optional
        Noise levels where known; estimated otherwise.
    level : float
        Probability of calling any relation of a group that holds contradicted.

    Returns
    -------
    SupportedGroup

    Raises
    ------
    InputError
        If the arrays do not fit together or to the group, or the level is no probability.

    Notes
    -----
    Rows of one pose count as one sample.
    The torque of each joint is fitted twice by least squares: by functions of y = B q that have the
    symmetry (`torque_basis`), and by more. If the symmetry holds, the further functions explain
    the residuals of the first fit no better than chance: F test, or chi-square where the noise is
    known; joints and relations are accounted for by Bonferroni's inequality. Nothing says that the
    torque is the derivative of a potential, nor that it is periodic.

    The further functions are all products of 1, cos q_j, sin q_j, and `breaking_functions`; where
    there are fewer than two samples for each of these, the latter alone (too few then to see every
    bend of a link). Relations that cannot be tested
    even so are kept, and said to be untestable. A torque that is not periodic (a spring) is taken
    to have only symmetries that exchange, mirror or leave alone the angles it depends on. What
    these functions cannot show (third harmonics, say) goes unnoticed.

    References
    ----------
    G. A. F. Seber, A. J. Lee, "Linear Regression Analysis", 2nd ed., Wiley 2003, section 4.3.

    Examples
    --------
    >>> from isotorque.symbolic.groups.symmetry_group import close
    >>> arm = close([
    ...     SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1]),
    ...     SymmetryRelation([[1, 0], [0, 1]], [np.pi, 0], [-1, -1]),
    ... ])
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-3.0, 3.0, (60, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> tau += 0.02 * rng.normal(size=tau.shape)
    >>> supported_group(arm, q, tau).group.order
    4
    >>> found = supported_group(arm, q, tau + [0.0, 0.3])  # a cable pulls the second joint
    >>> found.group.order, found.contradicted[0].violation.round(1).tolist()
    (2, [0.0, 0.3])
    """
    configurations, torques = static_samples(q, tau)
    if configurations.shape[1] != group.n:
        raise InputError("samples", "number of joints", configurations.shape[1], f"{group.n}")
    if not 0.0 < level < 1.0:
        raise InputError("supported group", "level", level, "0 < number < 1")
    _, configurations, torques = by_pose(configurations, torques)
    trial = GroupTrial(group, configurations, torques, noise)
    free = trial.free_directions()
    if free < level:
        whole = SymmetryGroup([identity(group.n)])
        return SupportedGroup(whole, tuple(_tested(trial, group, level)), 1.0, free)
    tested = _tested(trial, group, level)
    allowed = np.ones(group.order, dtype=bool)
    allowed[1:] = [t.judgement is not Judgement.CONTRADICTED for t in tested]

    def agreement(members: Sequence[int]) -> float:
        p_value = trial.p_value(members)
        return 1.0 if np.isnan(p_value) else p_value * (p_value >= level)

    best = largest_subgroups(group.multiplication_table, allowed, agreement)
    return SupportedGroup(
        SymmetryGroup(group[i] for i in best), tuple(tested), agreement(best), free
    )


def _tested(trial: GroupTrial, group: SymmetryGroup, level: float) -> list[TestedRelation]:
    """Each relation but the identity by itself, through the subgroup it generates."""
    results = []
    for i in range(1, group.order):
        found = trial.comparisons(sorted(generated(group.multiplication_table, frozenset({0, i}))))
        p_value = over_joints([c.p_value for c in found if c is not None])
        judgement = Judgement.CONSISTENT
        if np.isnan(p_value):
            judgement = Judgement.UNTESTABLE
        elif p_value < level / (group.order - 1):
            judgement = Judgement.CONTRADICTED
        nothing = (np.nan, np.nan)
        numbers = [nothing if c is None else (c.difference, c.resolution) for c in found]
        violation, resolution = np.array(numbers).T
        results.append(TestedRelation(group[i], judgement, p_value, violation, resolution))
    return results
