"""Learned relations are matched with the true ones, false ones are counted as false."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.learning.relations.learned_symmetries import (
    Knowledge,
    LearnedRelation,
    LearnedSymmetries,
)
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.learned_symmetries import (
    judge_relations,
    judge_symmetries,
    soundness,
)
from isotorque.verify.verdict import Status


def learned(relations, group):
    entries = [
        LearnedRelation(r, Knowledge.IDENTIFIED, 3, np.full(len(r.basis), 1e-4), 0.5)
        for r in relations
    ]
    return LearnedSymmetries(group, tuple(entries), None, "identification")


def moved(relation, size):
    return SymmetryRelation(relation.A, relation.d + size, relation.Y, relation.basis)


@pytest.mark.parametrize("name", ["pendulum", "2r", "3r", "4r-planar"])
def test_noisy_relations_are_recognised(arms, name):
    arm, rng = arms[name], np.random.default_rng(0)
    order = rng.permutation(arm.group.order)
    noise = rng.uniform(-1e-3, 1e-3, (arm.group.order, arm.gravity.n))
    noisy = [moved(arm.group[int(i)], e) for i, e in zip(order, noise, strict=True)]
    report = judge_symmetries(learned(noisy, arm.group), arm.gravity, tolerance=1.0)
    assert [entry.place for entry in report.relations] == (order + 1).tolist()
    assert report.found == arm.group.order
    assert report.false == 0
    for entry, error in zip(report.relations, noise, strict=True):
        assert entry.offset_error == pytest.approx(np.abs(error).max())
        assert entry.verdict.status is Status.BOUNDED
        assert entry.known == "identified"
        assert entry.support == 3
        q = rng.uniform(-3, 3, (200, arm.gravity.n))
        found = arm.gravity.torque(entry.relation.configuration(q))
        expected = entry.relation.torque(arm.gravity.torque(q))
        assert np.all(np.abs(found - expected).max(axis=0) <= entry.bound)
    assert soundness(report).passed


def test_a_false_relation_is_false_and_a_missing_one_missing(two_link):
    false = SymmetryRelation([[-1, 0], [2, -1]], [0, 0], [1, 1])
    some = [*list(two_link.group)[:6], false]
    report = judge_symmetries(learned(some, two_link.group), two_link.gravity)
    assert report.found == 6
    assert report.false == 1
    assert report.relations[-1].place is None
    assert report.relations[-1].verdict.status is Status.REFUTED
    verdict = soundness(report)
    assert verdict.claim == "6 of 8 relations learned, 1 false"
    assert verdict.status is Status.REFUTED


def test_a_relation_learned_twice_counts_once(two_link):
    twice = [two_link.group[1], moved(two_link.group[1], 1e-4)]
    report = judge_relations(twice, two_link.gravity, method="given")
    assert report.found == 1
    assert report.false == 0
    assert not report.complete


def test_a_list_that_lacks_some_is_not_false(two_link):
    report = judge_relations(list(two_link.group)[:5], two_link.gravity, method="given")
    verdict = soundness(report)
    assert verdict.passed
    assert verdict.claim == "5 of 8 relations learned, 0 false"
    assert np.isnan(verdict.worst_error)
    assert verdict.to_json()["worst_error"] is None
    assert not report.complete


def test_an_offset_far_off_is_another_relation(two_link):
    far = moved(two_link.group[1], np.array([0.5, 0.0]))
    assert judge_relations([far], two_link.gravity, method="given").false == 1


def test_free_joints_do_not_matter(upright):
    gravity = GravityModel(upright)
    truth = primary_symmetries(gravity.potential)
    # learned in all joints, with an arbitrary row and sign for the free one
    relation = SymmetryRelation([[7, 0], [0, 1]], [1.2, np.pi], [-1, -1])
    report = judge_relations([relation], gravity, method="given", truth=truth)
    assert report.relations[0].place is not None
    assert report.relations[0].verdict.status is Status.PROVED


def test_a_matrix_that_mixes_in_a_free_joint_is_false(upright):
    relation = SymmetryRelation([[1, 0], [1, 1]], [0.0, 0.0], [1, 1])
    report = judge_relations([relation], GravityModel(upright), method="given")
    assert report.false == 1


def test_real_matrices_are_bounded_and_matched(two_link):
    real = SymmetryRelation([[-1.0002, 0.0], [2.0, 1.0001]], [0.0, 0.0], [1, 1])
    report = judge_relations([real], two_link.gravity, method="regression", tolerance=0.1)
    assert two_link.group[report.relations[0].place - 1].A.tolist() == [[-1, 0], [2, 1]]
    assert report.relations[0].verdict.status is Status.BOUNDED
    assert isinstance(report.truth, SymmetryGroup)
