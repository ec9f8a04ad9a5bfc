"""Learned symmetries of an arm, and how they are known."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.lack_of_fit import LackOfFit
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation, identity

Array = NDArray[np.float64]


class Knowledge(StrEnum):
    """Source of the knowledge of a relation."""

    OBSERVED = "observed"
    """Pairs of recorded configurations obey it."""
    IMPLIED = "implied by the group"
    """It is a product of observed relations."""
    IDENTIFIED = "identified"
    """The potential fitted to the samples has it: that of a rigid chain, or one of waves."""


@dataclass(frozen=True, eq=False)
class FreeRegression:
    """Real relation q_s = A q_r + d by multiple linear regression on the pairs of a relation.

    Attributes
    ----------
    A, A_error : (n, n) arrays
        Coefficients and their standard errors; a joint that did not vary has error infinity.
    d, d_error : (n,) arrays
        Offset and standard errors [rad].
    pairs : int
        Number of pairs.

    Notes
    -----
    The paper's section 4.2: ``M q_r + N q_s = d`` with N = I, M = -A. Angles are taken on the
    branch modulo 2 pi that the integer relation predicts.
    """

    A: Array
    A_error: Array
    d: Array
    d_error: Array
    pairs: int

    @property
    def M(self) -> Array:
        """M of the paper's Eq. 5, shape (n, n)."""
        return -self.A + 0.0

    @property
    def N(self) -> Array:
        """N of the paper's Eq. 5, shape (n, n)."""
        return np.eye(len(self.d))


@dataclass(frozen=True, eq=False)
class LearnedRelation:
    """A symmetry relation learned from data.

    Attributes
    ----------
    relation : SymmetryRelation
        With integer A; its ``bound`` is what the data guarantee at three standard errors [N m]
        (NaN where no potential could be fitted).
    known : Knowledge
        How it is known.
    support : int
        Number of distinct torques |tau| among the pairs that obey it; 0 if none was recorded.
    standard_error : (r,) array
        Standard error of d in y = B q coordinates [rad], as measured.
    p_value : float
        Probability of a misfit at least as large if the relation holds: small speaks against it.
    log10_false_alarms : float
        Expected number of relations as well supported as this among random configurations, as a
        decimal logarithm; NaN where it was not found by pairing.
    regression : FreeRegression or None
        Free real regression on the pairs.
    snapped : bool
        Whether d was rounded to multiples of a right angle, with which the measured d agrees.
    """

    relation: SymmetryRelation
    known: Knowledge
    support: int
    standard_error: Array
    p_value: float
    log10_false_alarms: float = float("nan")
    regression: FreeRegression | None = None
    snapped: bool = False


@dataclass(frozen=True, eq=False)
class RejectedPairs:
    """Pairs with equal |torque| that no accepted relation connects.

    Attributes
    ----------
    Y : (n,) array
        Torque signs between the two configurations.
    q_r, q_s : (m, n) arrays
        The configurations [rad].
    torque_index : (m,) int array
        Which torque they belong to.
    """

    Y: Array
    q_r: Array
    q_s: Array
    torque_index: NDArray[np.int64]

    def __len__(self) -> int:
        """Number of pairs."""
        return len(self.q_r)


@dataclass(frozen=True, eq=False)
class LearnedSymmetries:
    """Group of symmetries learned from static samples.

    Attributes
    ----------
    group : SymmetryGroup
        The relations as a closed group; only the identity where nothing is known.
    relations : tuple of LearnedRelation
        In the order of ``group``.
    missing : str or None
        What is missing before (more) relations can be claimed, or what they do not speak of;
        None where nothing is.
    method : str
        What the relations follow from, in words; what was asked as a second opinion is named too.
    fit : FittedPotential or None
        The potential of waves fitted to the samples, with its covariance; None where there are too
        few for one, and where a rigid chain of many joints makes it needless.
    rejected : tuple of RejectedPairs
        Secondary pairs, by torque signs.
    contradicted : tuple of LearnedRelation
        Relations that pairs seem to show and the fitted potential excludes.
    lack : LackOfFit or None
        What the residuals of the fit say: constant torques, and torques that are no rigid gravity.
    corrected : tuple of SymmetryRelation
        Relations that hold of gravity but not of the measured torque, because they flip a joint
        with a constant torque, or move one with a spring; they are not in the group. With their
        ``correction``, the constant and the spring, they hold of the measured torque, within their
        bounds.
    unmoved : tuple of int
        Joints that never moved: the relations hold at the one angle of each.
    chain : RigidChain or None
        The chain fitted to the samples, where the relations are its.
    """

    group: SymmetryGroup
    relations: tuple[LearnedRelation, ...]
    missing: str | None
    method: str
    fit: FittedPotential | None = None
    rejected: tuple[RejectedPairs, ...] = field(default=())
    contradicted: tuple[LearnedRelation, ...] = field(default=())
    lack: LackOfFit | None = None
    corrected: tuple[SymmetryRelation, ...] = ()
    unmoved: tuple[int, ...] = ()
    chain: RigidChain | None = None

    @property
    def decided(self) -> bool:
        """Whether all relations are known that the joints which moved can show."""
        return self.missing is None or bool(self.unmoved)

    @property
    def note(self) -> str | None:
        """What was found beside gravity and what that means for the relations, if anything was."""
        if self.lack is None or self.lack.failed or not self.lack.said:
            return None
        said = f"beside gravity the samples show {self.lack.said}"
        if self.corrected:
            said += (
                f"; {len(self.corrected)} relations that change such a joint hold of gravity "
                "alone, of the measured torque with a correction, and are listed apart"
            )
        return said

    @property
    def order(self) -> int:
        """Number of relations, the identity included."""
        return self.group.order


def nothing_learned(
    n: int,
    missing: str,
    method: str,
    fit: FittedPotential | None = None,
    lack: LackOfFit | None = None,
) -> LearnedSymmetries:
    """Only the identity of n joints, and why.

    Examples
    --------
    >>> nothing_learned(2, "samples", "identification").order
    1
    """
    unit = identity(n)
    relation = LearnedRelation(unit, Knowledge.IDENTIFIED, 0, np.zeros(n), 1.0)
    return LearnedSymmetries(SymmetryGroup([unit]), (relation,), missing, method, fit, lack=lack)
