"""Every claim of a relations file is judged: relations, exactness, bounds, completeness."""

from __future__ import annotations

import json

import numpy as np
import pytest

from symbolic.errors import InputError
from symbolic.relations import SymmetryRelation
from verify.claims import verify_relations_file
from verify.relation_files import RelationsFile, load_relations, relations_document
from verify.verdict import Status, all_passed


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


def test_approximate_relations_are_judged_as_a_group(two_link):
    flip = SymmetryRelation([[-1, 0], [2, 1]], [1e-5, -1e-5], [1, 1])
    still = SymmetryRelation(np.eye(2), [0, 0], [1, 1])
    verdicts = verify_relations_file(file_of([still, flip], order=2), two_link.gravity, 0.01)
    assert verdicts[-1].claim == "the 2 relations listed form a group"
    assert verdicts[-1].passed
    turn = SymmetryRelation(np.eye(2), [0.001, 0], [1, 1])
    verdicts = verify_relations_file(file_of([still, turn], order=2), two_link.gravity, 0.1)
    assert not verdicts[-1].passed


def test_files_about_other_arms_are_refused(arms):
    three = file_of(arms["3r"].group)
    with pytest.raises(InputError, match="number of joints is 3; accepted: 2"):
        verify_relations_file(three, arms["2r"].gravity)
    named = file_of(arms["2r"].group, joint_names=("a", "b"))
    with pytest.raises(InputError, match="joints is"):
        verify_relations_file(named, arms["2r"].gravity)
