"""Judge of learned symmetries: each relation beside the true one it stands for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from learning.relations.learned_symmetries import LearnedSymmetries
from symbolic.errors import InputError
from symbolic.gravity import GravityModel
from symbolic.relations import SymmetryGroup, SymmetryRelation, wrap
from symbolic.symmetries import primary_symmetries
from verify.bounds import learned_map_bound, relation_error_bound
from verify.relations import describe_relation, verify_relation
from verify.run_parts import RelationReport, SymmetryReport
from verify.verdict import Status, Verdict

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
            number, entry.relation, group, gravity, tolerance,
            known=str(entry.known), standard_error=entry.standard_error, support=entry.support,
        )
        for number, entry in enumerate(learned.relations, 1)
    ]  # fmt: skip
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
