"""Judge of a relations file: every relation in it, and what it says of them."""

from __future__ import annotations

import numpy as np

from symbolic.errors import InputError
from symbolic.gravity import GravityModel
from symbolic.relations import LARGEST_LIST, SymmetryGroup, SymmetryRelation, close
from symbolic.symmetries import primary_symmetries
from verify.relation_files import RelationsFile
from verify.relations import describe_relation, verify_relation, verify_relations
from verify.verdict import Status, Verdict

ROUNDED_BOUND = 1e-9
"""What a printed bound may be below the true one by rounding, relative and in N m."""


def verify_relations_file(
    file: RelationsFile, gravity: GravityModel, tolerance: float = 1e-9
) -> tuple[Verdict, ...]:
    """Judge every claim of a relations file.

    Parameters
    ----------
    file
        From `load_relations`.
    gravity
        The true gravity torque of the arm it is about.
    tolerance
        Torque error that each relation is allowed [N m].

    Returns
    -------
    tuple of Verdict
        One per relation; then, where the file says so, one each on the relations it calls exact,
        on the bounds it gives, on its list being a group, and on its being complete.

    Raises
    ------
    InputError
        If the file is about another number of joints or other joint names.

    Notes
    -----
    A claimed bound is refuted only by a configuration that exceeds it. An ``order`` is the claim
    that the relations form a group. That none is missing is a claim of its own, made by
    ``complete`` and judged against the exact group: a list that lacks some is not wrong in that,
    and where it claims no more it is told how many there are.
    """
    if file.n != gravity.n:
        raise InputError(file.source, "number of joints", file.n, f"{gravity.n}, as the robot has")
    if file.joint_names is not None and file.joint_names != tuple(gravity.joint_names):
        raise InputError(
            file.source, "joints", list(file.joint_names), f"{list(gravity.joint_names)}"
        )
    verdicts = list(verify_relations(file.relations, gravity, tolerance))
    if any(relation.exact for relation in file):
        verdicts.append(_exactness(file, gravity))
    if any(np.isfinite(relation.bound).any() for relation in file):
        verdicts.append(_bounds(file, gravity))
    exact = all(verdict.status is Status.PROVED for verdict in verdicts[: len(file)])
    if file.generate:
        if file.complete or (file.order is not None and exact):
            verdicts.append(_generation(file, gravity))
        elif file.order is not None:
            verdicts.append(_closure(file))
    elif file.complete:
        verdicts.append(_completeness(file, gravity))
    elif file.order is not None and exact:
        whole = _completeness(file, gravity)
        verdicts.append(whole if whole.passed else _closure(file, _there_are(gravity)))
    elif file.order is not None:
        verdicts.append(_closure(file))
    return tuple(verdicts)


def _exactness(file: RelationsFile, gravity: GravityModel) -> Verdict:
    claim = "the relations called exact are exact"
    worst = 0.0
    for number, relation in enumerate(file, 1):
        if relation.exact:
            verdict = verify_relation(relation, gravity, 0.0)
            worst = max(worst, verdict.worst_error)
            if verdict.status is not Status.PROVED:
                words = f"{claim} (relation {number}: {describe_relation(relation)})"
                return Verdict(words, Status.REFUTED, worst, verdict.counterexample)
    return Verdict(claim, Status.PROVED, worst)


def _bounds(file: RelationsFile, gravity: GravityModel) -> Verdict:
    claim, status, worst = "no torque error exceeds the bound given for it", Status.BOUNDED, 0.0
    for number, relation in enumerate(file, 1):
        claimed = np.where(np.isfinite(relation.bound), relation.bound, np.inf)
        allowed = claimed * (1 + ROUNDED_BOUND) + ROUNDED_BOUND
        verdict = verify_relation(relation, gravity, allowed)
        worst = max(worst, verdict.worst_error)
        if verdict.status is Status.REFUTED:
            words = f"{claim} (relation {number}: {describe_relation(relation)})"
            return Verdict(words, Status.REFUTED, worst, verdict.counterexample)
        if verdict.status is Status.TESTED:
            status = Status.TESTED
    return Verdict(claim, status, worst)


def _there_are(gravity: GravityModel) -> int:
    """Number of exact relations that there are."""
    return primary_symmetries(gravity.potential).order


def _completeness(file: RelationsFile, gravity: GravityModel) -> Verdict:
    group = primary_symmetries(gravity.potential)
    free = ~np.any(gravity.potential.frequencies != 0, axis=0)
    listed = [
        SymmetryRelation(r.A, r.d, np.where(free, 1.0, r.Y), group.basis) for r in file.relations
    ]
    found = sum(relation in group for relation in listed)
    distinct = len({group.index(r) for r in listed if r in group})
    claim = f"the {len(file)} relations listed are all that there are ({group.order})"
    whole = found == len(file) and distinct == len(file) == group.order
    return Verdict(claim, Status.PROVED if whole else Status.REFUTED, np.nan)


def _generation(file: RelationsFile, gravity: GravityModel) -> Verdict:
    """Judge whether the relations generate the complete group, of the order claimed."""
    group = primary_symmetries(gravity.potential)
    free = ~np.any(gravity.potential.frequencies != 0, axis=0)
    given = [
        SymmetryRelation(r.A, r.d, np.where(free, 1.0, r.Y), group.basis) for r in file.relations
    ]
    claim = f"the {len(file)} relations listed generate all that there are ({group.order})"
    numbers = {number for number in map(group.find, given) if number is not None}
    whole = len(numbers) == len(file) and file.order in (None, group.order)
    if whole and not {group.find(generator) for generator in group.generators} <= numbers:
        if group.order > LARGEST_LIST:
            accepted = f"those that are written for groups of more than {LARGEST_LIST} relations"
            raise InputError(file.source, "generators", f"{len(file)} others", accepted)
        whole = _generated(group, numbers) == group.order
    return Verdict(claim, Status.PROVED if whole else Status.REFUTED, np.nan)


def _generated(group: SymmetryGroup, numbers: set[int]) -> int:
    """Return how many relations of a group some of them generate."""
    reached, fresh = {0}, [0]
    while fresh:
        products = {group.index(group[g] @ group[x]) for x in fresh for g in numbers}
        fresh = sorted(products - reached)
        reached |= products
    return len(reached)


def _closure(file: RelationsFile, there_are: int | None = None) -> Verdict:
    known = "" if there_are is None else f" (of the {there_are} that there are)"
    claim = f"the {len(file)} relations listed{known} form a group"
    try:
        if file.generate:
            claim = f"the {len(file)} relations listed generate a group of order {file.order}"
            closed = close(file.relations, LARGEST_LIST).order == file.order
        else:
            closed = SymmetryGroup(file.relations).is_closed
    except InputError:  # a matrix that does not map y = B q to itself, or offsets never come back
        closed = False
    return Verdict(claim, Status.TESTED if closed else Status.REFUTED, np.nan)
