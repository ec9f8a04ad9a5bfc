"""Claims are wrong where the arm as measured does not obey them, and nowhere else."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.claims import claims
from benchmarks.claims.data_sets import Setting, draw, true_arm
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


def data_set(pool, robot="3r", index=3, noise=0.05, poses=20):
    return draw(Setting(robot, pool, poses, noise, index, 0))


def learned(relations):
    """What a learner would return that claims these."""
    group = list(relations)
    listed = tuple(SimpleNamespace(relation=relation) for relation in group)
    return SimpleNamespace(group=group, order=len(group), relations=listed, corrected=())


def exact_claims(robot, bound):
    """The exact group of gravity, claimed with a bound [N m]."""
    group = primary_symmetries(true_arm(robot).gravity.potential)
    return [
        r if r.is_identity else SymmetryRelation(r.A, r.d, r.Y, r.basis, bound=np.full(r.n, bound))
        for r in group
    ]


@pytest.mark.parametrize(
    ("pool", "wrong"),
    [
        ("clean", False),
        ("gain", False),
        ("amperes", False),
        ("friction", False),
        ("hidden friction", False),
        ("outliers", False),
        ("offset", True),
        ("one-sided friction", True),
        ("spring", True),
        ("cable", True),
        ("compliance", True),
        ("scale", True),
    ],
)
def test_relations_of_gravity_hold_of_what_is_measured_or_do_not(pool, wrong, monkeypatch):
    monkeypatch.setattr(
        claims, "learn_relations", lambda *_, **__: learned(exact_claims("3r", 1e-6))
    )
    found = claims.judged_claims("3r", data_set(pool))
    assert found.relations == 15
    assert (found.wrong > 0) == wrong
    assert (found.worst > 1.0) == wrong


def test_a_claim_with_a_bound_that_holds_is_not_wrong(monkeypatch):
    data = data_set("offset")
    monkeypatch.setattr(
        claims, "learn_relations", lambda *_, **__: learned(exact_claims("3r", 3 * abs(data.size)))
    )
    found = claims.judged_claims("3r", data)
    assert found.wrong == 0
    assert 0.3 < found.worst < 1.0


def test_after_a_payload_came_both_arms_have_to_obey():
    data = data_set("payload", "2r", poses=100)
    before, after = data.recorded.truth
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (50, 2))
    relation = exact_claims("2r", 1e-6)[1]
    errors = []
    for one in (before, after):
        data.recorded.__dict__["truth"] = (one,)
        errors.append(claims.excess(relation, data, q))
    data.recorded.__dict__["truth"] = (before, after)
    assert claims.excess(relation, data, q) == max(errors)


def test_a_claim_without_bound_is_counted_apart(monkeypatch):
    monkeypatch.setattr(
        claims, "learn_relations", lambda *_, **__: learned(exact_claims("3r", np.nan))
    )
    found = claims.judged_claims("3r", data_set("offset"))
    assert (found.unbounded, found.wrong) == (15, 0)


def test_what_an_arm_does_not_feel_makes_no_group_larger(monkeypatch):
    """Turns of the UR5's last joint, and the sign of its torque, which is none."""
    group = exact_claims("ur5", 1.0)
    flip = np.diag([1.0, 1, 1, 1, 1, -1])
    double = [
        *group,
        *(SymmetryRelation(r.A @ flip, r.d, r.Y @ flip, np.eye(6), bound=r.bound) for r in group),
    ]
    monkeypatch.setattr(claims, "learn_relations", lambda *_, **__: learned(double))
    found = claims.judged_claims("ur5", data_set("clean", "ur5"))
    assert found.order == found.exact == found.most == 16


def test_a_larger_group_has_to_be_within_the_errors(monkeypatch):
    """Panda: exact order 2; larger groups err, and are allowed where the errors are as large."""
    identity, other = exact_claims("panda", 1.0)
    many = [identity, *[other] * 7]
    monkeypatch.setattr(claims, "learn_relations", lambda *_, **__: learned(many))
    data = data_set("clean", "panda")
    allowed = []
    for deviations in (1e-3, 1.0, 30.0):
        monkeypatch.setattr(claims, "DEVIATIONS", deviations)
        found = claims.judged_claims("panda", data)
        assert found.exact == 2
        allowed.append(found.most)
    assert allowed[0] == 2
    assert allowed == sorted(allowed)
    assert allowed[2] > 2


def test_least_standard_errors_shrink_with_poses():
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (40, 3))
    few, many = (claims.least_standard_error(data_set("clean", poses=n), q) for n in (20, 500))
    assert np.all(many < few)
    assert (few / many).mean() == pytest.approx(5.0, rel=0.3)
