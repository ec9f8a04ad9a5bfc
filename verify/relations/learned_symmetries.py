"""Judge of learned symmetries: each relation beside the true one it stands for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.learned_symmetries import LearnedSymmetries
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.ball_bounds import learned_map_bound, relation_error_bound
from isotorque.verify.relations.verify_relation import describe_relation, verify_relation
from isotorque.verify.verdict import Status, Verdict

Array = NDArray[np.float64]

SAME_RELATION = 0.2
"""A learned offset within this of the true one stands for it [rad]; true ones of equal A and Y
differ by much more."""


def judge_symmetries(
    learned: LearnedSymmetries,
    gravity: GravityModel,
    *,
    tolerance: float = 0.01,
    truth: SymmetryGroup | None = None,
) -> SymmetryReport:
    """Judge learned relations one by one and as a group.

    Parameters
    ----------
    learned
        What was learned from recordings.
    gravity
        The true gravity torque.
    tolerance
        Torque error a learned relation may cause [N m].
    truth
        The exact group, where it is known already.

    Returns
    -------
    SymmetryReport
        Relations in the learned order.
    """
    group = primary_symmetries(gravity.potential) if truth is None else truth
    entries = [
        _judged(
            number,
            entry.relation,
            group,
            gravity,
            tolerance,
            known=str(entry.known),
            standard_error=entry.standard_error,
            support=entry.support,
        )
        for number, entry in enumerate(learned.relations, 1)
    ]
    return SymmetryReport(group, tuple(entries), learned.method, learned.missing or "")


def judge_relations(
    relations: Sequence[SymmetryRelation],
    gravity: GravityModel,
    *,
    method: str,
    tolerance: float = 0.01,
    truth: SymmetryGroup | None = None,
) -> SymmetryReport:
    """Judge relations of which nothing else is known, e.g. those a run was given.

    Parameters are those of `judge_symmetries`; ``method`` says where the relations come from.
    """
    group = primary_symmetries(gravity.potential) if truth is None else truth
    entries = [
        _judged(number, relation, group, gravity, tolerance, known=method)
        for number, relation in enumerate(relations, 1)
    ]
    return SymmetryReport(group, tuple(entries), method)


def soundness(report: SymmetryReport) -> Verdict:
    """Return the verdict on the claim that no relation learned is false.

    Notes
    -----
    That none is missing is another claim, which a learner that stops at enough relations does not
    make; ``SymmetryReport.complete`` says whether it would hold.
    """
    order = report.truth.order
    claim = f"{report.found} of {order} relations learned, {report.false} false"
    return Verdict(claim, Status.REFUTED if report.false else Status.TESTED, np.nan)


def _judged(
    number: int,
    relation: SymmetryRelation,
    truth: SymmetryGroup,
    gravity: GravityModel,
    tolerance: float,
    *,
    known: str,
    standard_error: Array | None = None,
    support: int | None = None,
) -> RelationReport:
    place, error = _place(relation, truth)
    integer = np.array_equal(relation.A, np.round(relation.A))
    bound = (relation_error_bound if integer else learned_map_bound)(
        relation.A, relation.unwrapped_d, relation.Y, gravity.potential
    )
    claim = f"relation {number}: {describe_relation(relation)}"
    return RelationReport(
        relation=relation,
        verdict=verify_relation(relation, gravity, tolerance, claim=claim),
        bound=bound,
        known=known,
        place=place,
        offset_error=error,
        standard_error=standard_error,
        support=support,
    )


def _place(relation: SymmetryRelation, truth: SymmetryGroup) -> tuple[int | None, float | None]:
    """Return the number of the true relation that a learned one stands for, and its offset error.

    Both are compared in the true group's coordinates y = B q; signs of joints that feel no
    gravity do not matter.
    """
    touched = np.any(truth.basis != 0, axis=0)
    same_frame = SymmetryRelation(
        np.round(relation.A), relation.d, np.where(touched, relation.Y, 1.0), truth.basis
    )
    try:
        A_sat, d_sat = same_frame.A_sat, same_frame.d_sat
    except InputError:  # does not even map y = B q to itself
        return None, None
    best: tuple[int | None, float | None] = (None, None)
    for number, true in enumerate(truth, 1):
        if np.array_equal(true.Y, same_frame.Y) and np.allclose(true.A_sat, A_sat, atol=1e-6):
            error = float(np.abs(wrap(d_sat - true.d_sat)).max(initial=0.0))
            if error <= SAME_RELATION and (best[1] is None or error < best[1]):
                best = (number, error)
    return best


@dataclass(frozen=True, eq=False)
class RelationReport:
    """One learned relation beside the truth.

    Attributes
    ----------
    relation : SymmetryRelation
        As learned.
    verdict : Verdict
        Judged on its own.
    bound : (n,) array
        Torque error it can cause, over all configurations [N m].
    known : str
        How it is known: observed, implied by the group, identified, exact ...
    place : int or None
        Number, from 1, of the true relation it stands for; None for a false one.
    offset_error : float or None
        Largest error of its offset d, modulo 2 pi [rad].
    standard_error : (r,) array or None
        What the data say of that error [rad].
    support : int or None
        Number of distinct torques whose recorded configurations obey it.
    executable : bool or None
        Whether some configuration within the joint limits has its image within them; else the
        relation labels torques, and the arm cannot follow it. None where that was not asked.
    """

    relation: SymmetryRelation
    verdict: Verdict
    bound: Array
    known: str
    place: int | None
    offset_error: float | None = None
    standard_error: Array | None = None
    support: int | None = None
    executable: bool | None = None


@dataclass(frozen=True, eq=False)
class SymmetryReport:
    """Learned relations beside the complete true group.

    Attributes
    ----------
    truth : SymmetryGroup
        The exact group.
    relations : tuple of RelationReport
        What was learned; empty where relations were given.
    method : str
        How.
    missing : str
        What the data could not tell; empty where nothing is missing.
    secondary_pairs : int
        Pairs of recorded configurations with equal |torque| that no relation explains.
    contradicted : int
        Relations that such pairs seemed to show, rejected because other samples exclude them.
    """

    truth: SymmetryGroup
    relations: tuple[RelationReport, ...]
    method: str
    missing: str = ""
    secondary_pairs: int = 0
    contradicted: int = 0

    @property
    def found(self) -> int:
        """Number of true relations among the learned ones."""
        return len({entry.place for entry in self.relations if entry.place is not None})

    @property
    def false(self) -> int:
        """Number of learned relations that stand for no true one."""
        return sum(entry.place is None for entry in self.relations)

    @property
    def complete(self) -> bool:
        """Whether every true relation is among the learned ones."""
        return self.found == self.truth.order
