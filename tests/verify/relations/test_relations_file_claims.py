"""Every claim of a relations file is judged: relations, exactness, bounds, completeness."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.ball_bounds import relation_error_bound
from isotorque.verify.relations.relation_files import (
    RelationsFile,
    load_relations,
    relations_document,
)
from isotorque.verify.relations.relations_file_claims import verify_relations_file
from isotorque.verify.relations.verify_relation import verify_relation
from isotorque.verify.verdict import Status, all_passed


def file_of(relations, order=None, joint_names=None, complete=False):
    return RelationsFile("r.json", tuple(relations), joint_names, order, complete)


@pytest.mark.parametrize("name", ["pendulum", "2r", "3r", "4r-planar"])
def test_a_true_file_passes_whole(tmp_path, arms, name):
    arm = arms[name]
    path = tmp_path / "r.json"
    path.write_text(json.dumps(relations_document(arm.group, arm.gravity.joint_names)))
    verdicts = verify_relations_file(load_relations(path), arm.gravity)
    assert all_passed(verdicts)
    assert len(verdicts) == arm.group.order + 3
    assert f"all that there are ({arm.group.order})" in verdicts[-1].claim


def test_a_missing_relation_is_noticed_only_if_the_file_claims_completeness(two_link):
    some = list(two_link.group)[:5]
    claimed = verify_relations_file(file_of(some, order=5, complete=True), two_link.gravity)
    assert [verdict.passed for verdict in claimed[-2:]] == [True, False]
    assert "all that there are (8)" in claimed[-1].claim
    assert not verify_relations_file(file_of(some, order=5), two_link.gravity)[
        -1
    ].passed  # no group
    assert all_passed(verify_relations_file(file_of(some), two_link.gravity))
    # a subgroup lacks some and is wrong in nothing; how many there are is told
    part = [r for r in two_link.group if (r.Y == 1).all()]
    verdicts = verify_relations_file(file_of(part, order=len(part)), two_link.gravity)
    assert all_passed(verdicts)
    assert (
        verdicts[-1].claim
        == f"the {len(part)} relations listed (of the 8 that there are) form a group"
    )


def test_completeness_is_read_from_the_file(tmp_path, two_link):
    path = tmp_path / "r.json"
    document = relations_document(list(two_link.group)[:4], two_link.gravity.joint_names)
    for complete, passed in ((True, False), (False, True)):
        path.write_text(json.dumps(document | {"complete": complete}))
        assert load_relations(path).complete is complete
        assert all_passed(verify_relations_file(load_relations(path), two_link.gravity)) is passed
    path.write_text(json.dumps(document | {"complete": "yes"}))
    with pytest.raises(InputError, match='complete is "yes"; accepted: true or false'):
        load_relations(path)


def test_a_relation_listed_twice_does_not_complete_the_list(two_link):
    twice = [*list(two_link.group)[:7], two_link.group[3]]
    verdict = verify_relations_file(file_of(twice, order=8), two_link.gravity)[-1]
    assert verdict.status is Status.REFUTED


def test_a_false_exact_claim_is_refuted_where_the_relation_itself_passes(two_link):
    near = SymmetryRelation(np.eye(2), [1e-6, 0.0], [1, 1], exact=True)
    relation, exactness = verify_relations_file(file_of([near]), two_link.gravity, 1e-3)
    assert relation.status is Status.BOUNDED
    assert exactness.status is Status.REFUTED
    assert exactness.counterexample is not None


@pytest.mark.parametrize(("bound", "status"), [(20e-6, "bounded"), (17e-6, "refuted")])
def test_claimed_bounds_are_judged(two_link, bound, status):
    # the error of joint 1 reaches A 1e-6 = 18.4e-6 Nm, that of joint 2 nothing
    near = SymmetryRelation([[1, 0], [0, 1]], [1e-6, -1e-6], [1, 1], bound=[bound, 1e-12])
    verdict = verify_relations_file(file_of([near]), two_link.gravity, 1.0)[-1]
    assert verdict.status == status
    assert verdict.worst_error == pytest.approx(18.4e-6, rel=1e-2)


@pytest.mark.parametrize(("factor", "status"), [(1.0, "bounded"), (1 - 1e-6, "refuted")])
def test_bounds_of_light_arms_are_judged_by_their_own_rounding(two_link, factor, status):
    light = GravityModel(replace(two_link.gravity.tree, masses=np.array([5e-9, 5e-9])))
    true_size = 18.39375e-9 * 1e-3
    near = SymmetryRelation(
        np.eye(2), [1e-3, -1e-3], [1, 1], bound=[true_size * factor, 1e-3 * true_size]
    )
    assert verify_relations_file(file_of([near]), light, 1.0)[-1].status == status


def test_the_bound_of_a_proved_relation_is_about_its_exact_offset(two_link):
    turn = SymmetryRelation(np.eye(2), [np.pi, 0], [-1, -1], bound=[0.0, 0.0])
    verdicts = verify_relations_file(file_of([turn]), two_link.gravity, 0.0)
    assert [verdict.status for verdict in verdicts] == [Status.PROVED, Status.BOUNDED]
    assert 0.0 < verdicts[0].worst_error < 1e-14


def test_an_exact_claim_with_an_offset_two_units_off_is_refuted(two_link):
    d = np.pi + 2 * np.spacing(np.pi)
    turn = SymmetryRelation(np.eye(2), [d, 0], [-1, -1], exact=True)
    relation, exactness = verify_relations_file(file_of([turn]), two_link.gravity)
    assert relation.status is Status.BOUNDED
    assert exactness.status is Status.REFUTED


def test_completeness_names_the_terms_it_leaves_out(two_link):
    tree = replace(two_link.gravity.tree, masses=np.array([5.0, 5e-13]))
    gravity = GravityModel(tree)
    assert len(gravity.neglected) == 1
    eight = list(two_link.group)  # true of every 2R arm, whatever its masses
    verdict = verify_relations_file(file_of(eight, order=8), gravity)[-1]
    assert verdict.status is Status.PROVED
    assert verdict.claim.endswith("all that there are (8)")
    for some in (eight[:4], list(primary_symmetries(gravity.potential))):
        file = replace(file_of(some, order=4), complete=True)
        verdict = verify_relations_file(file, gravity)[-1]
        assert verdict.passed == (some[1] not in eight)
        assert verdict.claim.endswith(
            "(4), up to 1e-12 of the largest amplitude and without a term of at most 6.13e-13 N m"
        )


def test_groups_without_the_tiny_terms_are_bounded_not_complete(two_link):
    gravity = GravityModel(replace(two_link.gravity.tree, masses=np.array([5.0, 5e-13])))
    four = list(primary_symmetries(gravity.potential))
    *relations, bounds, closed = verify_relations_file(file_of(four, order=4), gravity)
    assert {v.status for v in relations} == {Status.PROVED, Status.BOUNDED}
    assert bounds.passed
    assert closed.claim == "the 4 relations listed form a group"
    assert closed.status is Status.TESTED


def test_approximate_relations_are_judged_as_a_group(two_link):
    flip = SymmetryRelation([[-1, 0], [2, 1]], [1e-5, -1e-5], [1, 1])
    still = SymmetryRelation(np.eye(2), [0, 0], [1, 1])
    verdicts = verify_relations_file(file_of([still, flip], order=2), two_link.gravity, 0.01)
    assert verdicts[-1].claim == "the 2 relations listed form a group"
    assert verdicts[-1].passed
    turn = SymmetryRelation(np.eye(2), [0.001, 0], [1, 1])
    verdicts = verify_relations_file(file_of([still, turn], order=2), two_link.gravity, 0.1)
    assert not verdicts[-1].passed


@pytest.mark.parametrize("size", [3.0, 2.0**40, 1e200])
def test_groups_of_huge_matrices_are_multiplied_exactly(two_link, size):
    still = SymmetryRelation(np.eye(2), [0, 0], [1, 1])
    shear = SymmetryRelation([[1, size], [0, -1]], [0, 0], [1, 1])  # its square is still
    verdicts = verify_relations_file(file_of([still, shear], order=2), two_link.gravity)
    assert verdicts[-1].claim == "the 2 relations listed form a group"
    assert verdicts[-1].passed
    grows = SymmetryRelation([[1, size], [0, 1]], [0, 0], [1, 1])
    verdicts = verify_relations_file(file_of([still, grows], order=2), two_link.gravity)
    assert not verdicts[-1].passed


def test_files_about_other_arms_are_refused(arms):
    three = file_of(arms["3r"].group)
    with pytest.raises(InputError, match="number of joints is 3; accepted: 2"):
        verify_relations_file(three, arms["2r"].gravity)
    named = file_of(arms["2r"].group, joint_names=("a", "b"))
    with pytest.raises(InputError, match="joints is"):
        verify_relations_file(named, arms["2r"].gravity)


def test_bounds_of_which_one_was_only_tested_are_only_tested(arms):
    """Between the largest error found and the sum of all waves nothing is bounded or refuted."""
    gravity = arms["3r"].gravity  # four waves, but only three free phases
    near = SymmetryRelation(np.eye(3), [2e-3, 0.0, 3e-3], np.ones(3))
    worst = verify_relation(near, gravity, 1e-9).worst_error
    whole = relation_error_bound(near.A, near.unwrapped_d, near.Y, gravity.potential).max()
    assert worst < 0.999 * whole
    still = SymmetryRelation(np.eye(3), np.zeros(3), np.ones(3), bound=np.full(3, 1.0))
    for claimed, status in (
        (1.0001 * worst, Status.TESTED),
        (1.0001 * whole, Status.BOUNDED),
        (0.99 * worst, Status.REFUTED),
    ):
        bounded = SymmetryRelation(near.A, near.d, near.Y, bound=np.full(3, claimed))
        for order in ([bounded], [bounded, still], [still, bounded]):
            verdict = verify_relations_file(file_of(order), gravity, 1.0)[-1]
            assert verdict.status is status


@pytest.mark.parametrize("error", [1e-14, 1e-9, 5e-7])
def test_a_list_of_relations_that_are_only_nearly_true_is_not_complete(two_link, error):
    """Near enough to be recognised as one of the group, and not proved."""
    eight = list(two_link.group)
    near = SymmetryRelation(eight[3].A, eight[3].d + np.array([error, -error]), eight[3].Y)
    file = file_of([*eight[:3], near, *eight[4:]], order=8, complete=True)
    *_, last = verify_relations_file(file, two_link.gravity, 1e-3)
    assert "all that there are" in last.claim
    assert last.status is Status.REFUTED
    assert verify_relations_file(file_of(eight, order=8, complete=True), two_link.gravity)[
        -1
    ].passed
