"""Judge of a relations file: every relation in it, and what it says of them."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import LARGEST_LIST, SymmetryGroup, close
from isotorque.symbolic.groups.symmetry_relation import SAME_ANGLE, SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.exact_symmetries import RELATIVE, exact_symmetries
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.exact_numbers import (
    angle,
    exact_matrix,
    exact_vector,
    maps,
    nearest,
    times,
)
from isotorque.verify.relations.exact_proof import exact_potential, prove_relation
from isotorque.verify.relations.relation_files import RelationsFile
from isotorque.verify.relations.verify_relation import (
    describe_relation,
    verify_relation,
    verify_relations,
)
from isotorque.verify.verdict import Status, Verdict

LARGE = 2.0**15
"""Entries beyond are multiplied as integers of any size."""


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
    A claimed bound is refuted only by a configuration that exceeds it by more than rounding, in
    proportion to the arm (`GravityModel.rounding`); that of a proved relation is about its exact
    offset. An ``order`` is the claim that the relations form a group. That none is missing is a
    claim of its own, made by ``complete`` and judged against the exact group: a list that lacks
    some is not wrong in that, and where it claims no more it is told how many there are. The words
    name the terms of the potential that the exact group was found without, where there are any.
    """
    if file.n != gravity.n:
        raise InputError(file.source, "number of joints", file.n, f"{gravity.n}, as the robot has")
    if file.joint_names is not None and file.joint_names != tuple(gravity.joint_names):
        raise InputError(
            file.source, "joints", list(file.joint_names), f"{list(gravity.joint_names)}"
        )
    verdicts = list(verify_relations(file.relations, gravity, tolerance))
    if any(relation.exact for relation in file):
        verdicts.append(_exactness(file, gravity, verdicts))
    if any(np.isfinite(relation.bound).any() for relation in file):
        verdicts.append(_bounds(file, gravity, verdicts))
    exact = all(verdict.status is Status.PROVED for verdict in verdicts[: len(file)])
    if file.generate:
        if file.complete or (file.order is not None and exact):
            verdicts.append(_generation(file, gravity))
        elif file.order is not None:
            verdicts.append(judge_closure(file))
    elif file.complete:
        verdicts.append(_completeness(file, gravity))
    elif file.order is not None and exact:
        whole = _completeness(file, gravity)
        verdicts.append(whole if whole.passed else judge_closure(file, _there_are(gravity)))
    elif file.order is not None:
        verdicts.append(judge_closure(file))
    return tuple(verdicts)


def _exactness(file: RelationsFile, gravity: GravityModel, verdicts: list[Verdict]) -> Verdict:
    claim = "the relations called exact are exact"
    worst = 0.0
    for number, (relation, verdict) in enumerate(zip(file, verdicts, strict=False), 1):
        if relation.exact:
            if verdict.status is not Status.PROVED:
                strict = verify_relation(relation, gravity, 0.0)
                words = f"{claim} (relation {number}: {describe_relation(relation)})"
                return Verdict(words, Status.REFUTED, strict.worst_error, strict.counterexample)
            worst = max(worst, verdict.worst_error)
    return Verdict(claim, Status.PROVED, worst)


def _bounds(file: RelationsFile, gravity: GravityModel, verdicts: list[Verdict]) -> Verdict:
    claim = f"no torque error is {gravity.rounding:.1g} N m above the bound given for it"
    status, worst = Status.BOUNDED, 0.0
    for number, (relation, known) in enumerate(zip(file, verdicts, strict=False), 1):
        if known.status is Status.PROVED:  # the error of its exact offset is none
            continue
        claimed = np.where(np.isfinite(relation.bound), relation.bound, np.inf)
        verdict = verify_relation(relation, gravity, claimed + gravity.rounding)
        worst = max(worst, verdict.worst_error)
        if verdict.status is Status.REFUTED:
            words = f"{claim} (relation {number}: {describe_relation(relation)})"
            return Verdict(words, Status.REFUTED, worst, verdict.counterexample)
        if verdict.status is Status.TESTED:
            status = Status.TESTED
    return Verdict(claim, status, worst)


def _there_are(gravity: GravityModel) -> int:
    """Number of exact relations that there are."""
    return _exact_order(_literal_group(gravity))


def _completeness(file: RelationsFile, gravity: GravityModel) -> Verdict:
    """Judge the claim that no relation is missing.

    It is about the arm as given, if the relations are exactly its group; otherwise about its
    potential up to terms and differences that only stand for rounding, which the words say.
    """
    count, words = len(file), ""
    group = _literal_group(gravity)
    order = _exact_order(group)
    whole = count == order and _are_members(file, group)
    whole = whole and all(_proved(relation, gravity.potential) for relation in file)
    if not whole and (len(gravity.neglected) or not group.exact):
        group = exact_symmetries(exact_potential(gravity.significant_potential))
        order = group.order
        whole = count == order and _are_members(file, group)
        words = _up_to(gravity)
    claim = f"the {count} relations listed are all that there are ({order}){words}"
    return Verdict(claim, Status.PROVED if whole else Status.REFUTED, np.nan)


def _literal_group(gravity: GravityModel) -> SymmetryGroup:
    """Return what may be a symmetry of the potential with all its terms; some may be exact."""
    return exact_symmetries(exact_potential(gravity.potential), neglected=0.0)


def _exact_order(group: SymmetryGroup) -> int:
    return group.order if group.exact else sum(relation.exact for relation in group)


def _are_members(file: RelationsFile, group: SymmetryGroup) -> bool:
    """Say whether all relations are in the group, and all different."""
    free = ~np.any(group.basis != 0, axis=0)  # the signs of joints without torque do not matter
    listed = [
        SymmetryRelation(r.A, r.d, np.where(free, 1.0, r.Y), group.basis) for r in file.relations
    ]
    if not all(relation in group for relation in listed):
        return False
    return len({group.index(relation) for relation in listed}) == len(listed)


def _proved(relation: SymmetryRelation, potential: TrigonometricPolynomial) -> bool:
    return prove_relation(relation.A, relation.unwrapped_d, relation.Y, potential).holds


def _up_to(gravity: GravityModel) -> str:
    """Say up to what a group is complete that is not that of the arm as given."""
    words = f", up to {RELATIVE:g} of the largest amplitude"
    terms = len(gravity.neglected)
    if terms:
        count = "a term" if terms == 1 else f"{terms} terms"
        words += f" and without {count} of at most {gravity.neglected_bound.max():.3g} N m"
    return words


def _generation(file: RelationsFile, gravity: GravityModel) -> Verdict:
    """Judge whether the relations generate the complete group, of the order claimed."""
    group = primary_symmetries(gravity.potential)
    free = ~np.any(gravity.potential.frequencies != 0, axis=0)
    given = [
        SymmetryRelation(r.A, r.d, np.where(free, 1.0, r.Y), group.basis) for r in file.relations
    ]
    words = "" if group.exact else _up_to(gravity)
    claim = f"the {len(file)} relations listed generate all that there are ({group.order}){words}"
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
    generators = [group[number] for number in numbers]
    reached, fresh = {0}, [0]
    while fresh:
        products = {group.index(g @ x) for x in map(group.relation, fresh) for g in generators}
        fresh = sorted(products - reached)
        reached |= products
    return len(reached)


def judge_closure(file: RelationsFile, there_are: int | None = None) -> Verdict:
    """Judge whether the relations form, or generate, a group: no robot is needed for that.

    Parameters
    ----------
    file
        With an ``order``.
    there_are
        How many exact relations there are, where that is known.
    """
    known = "" if there_are is None else f" (of the {there_are} that there are)"
    claim = f"the {len(file)} relations listed{known} form a group"
    members = [relation.of_measured(None) for relation in file]
    try:
        huge = any(np.abs(relation.A_sat).max(initial=0.0) > LARGE for relation in file)
        if file.generate:
            claim = f"the {len(file)} relations listed generate a group of order {file.order}"
            closed = not huge and close(members, LARGEST_LIST).order == file.order
        else:
            closed = _closed_exactly(file) if huge else SymmetryGroup(members).is_closed
    except InputError:  # a matrix that does not map y = B q to itself, or offsets never come back
        closed = False
    return Verdict(claim, Status.TESTED if closed else Status.REFUTED, np.nan)


def _closed_exactly(file: RelationsFile) -> bool:
    """Say whether all products are listed, with integers of any size."""
    entries = [(exact_matrix(r.A_sat), exact_vector(r.d_sat), tuple(r.Y)) for r in file]
    listed: dict[tuple[Any, ...], list[Any]] = {}
    for A, d, Y in entries:
        listed.setdefault((tuple(map(tuple, A)), Y), []).append([float(x) for x in d])
    for (A, d, Y), (B, e, Z) in itertools.product(entries, repeat=2):
        signs = tuple(y * z for y, z in zip(Y, Z, strict=True))
        offset = [nearest(angle(x)) for x in maps(A, d, e)]
        known = listed.get((tuple(times(A, B)), signs), [])
        if not any(np.all(np.abs(wrap(np.subtract(offset, x))) < SAME_ANGLE) for x in known):
            return False
    return True
