"""Relations are proved, bounded or refuted rightly; no lie passes."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.robots.kinematic_tree import planar_arm
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.ball_bounds import learned_map_bound, relation_error_bound
from isotorque.verify.relations.verify_relation import (
    IN_THE_BOX,
    describe_relation,
    verify_relation,
    verify_relations,
)
from isotorque.verify.testing import strategies
from isotorque.verify.verdict import Status, all_passed

FEW = settings(
    max_examples=15, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
TOLERANCE = 1e-9


def pinocchio_error(name, relation, q):
    """Error of a relation at one configuration, from Pinocchio alone [N m]."""
    robot = load_robot(name)
    data = robot.source_model.createData()
    here, there = (
        pin.computeGeneralizedGravity(robot.source_model, data, robot.source_configuration(x))
        for x in (q, relation.A @ q + relation.d)
    )
    return np.abs(there - relation.Y * here).max()


@pytest.mark.parametrize("name", ["pendulum", "2r", "3r", "4r-planar"])
def test_every_relation_of_the_built_in_arms_is_proved(arms, name):
    verdicts = verify_relations(arms[name].group, arms[name].gravity, tolerance=0.0)
    assert {verdict.status for verdict in verdicts} == {Status.PROVED}
    assert max(verdict.worst_error for verdict in verdicts) < 1e-13
    assert all_passed(verdicts)


@pytest.mark.parametrize(("name", "tolerance"), [("ur5", 0.0), ("panda", 0.0), ("panda", 0.1)])
def test_six_and_seven_joints(name, tolerance):
    """Free directions, frequencies by the hundred, and an approximate group."""
    gravity = GravityModel(load_robot(name))
    group = primary_symmetries(gravity.potential, tolerance)
    verdicts = verify_relations(group, gravity, tolerance)
    assert all_passed(verdicts)
    assert (tolerance > 0.0) == any(verdict.status == "bounded" for verdict in verdicts)
    for relation, verdict in zip(group, verdicts, strict=True):
        assert verdict.status in ({"proved"} if relation.exact else {"proved", "bounded"})
        assert verdict.worst_error <= max(tolerance, 1e-13)


def planted_lies():
    """Fifty lies, of each kind, spread over arms and relations."""
    rng = np.random.default_rng(1)
    for i in range(50):
        name = ("2r", "3r", "pendulum", "4r-planar")[i % 4]
        place = ("Y", "A", "d")[i % 3]
        yield pytest.param(name, place, int(rng.integers(2**32)), id=f"{i}-{name}-{place}")


@pytest.mark.parametrize(("name", "place", "seed"), list(planted_lies()))
def test_planted_lies_are_refuted(arms, name, place, seed):
    arm, rng = arms[name], np.random.default_rng(seed)
    true = arm.group[int(rng.integers(arm.group.order))]
    A, d, Y = true.A.copy(), true.d.copy(), true.Y.copy()
    i, j = rng.integers(true.n, size=2)
    sign = rng.choice([-1, 1])
    if place == "Y":
        Y[i] *= -1
    elif place == "A":
        A[i, j] += sign
    else:
        d[i] += sign * 1e-6
    lie = SymmetryRelation(A, d, Y)
    verdict = verify_relation(lie, arm.gravity, TOLERANCE)
    assert verdict.status is Status.REFUTED
    assert not verdict.passed
    assert verdict.counterexample is not None
    error = pinocchio_error(name, lie, verdict.counterexample)
    assert TOLERANCE < error <= verdict.worst_error * (1 + 1e-9)


def test_the_map_of_the_issue_is_proved_and_its_neighbour_refuted(two_link):
    true = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
    assert true in two_link.group
    assert verify_relation(true, two_link.gravity, 0.0).status is Status.PROVED
    neighbour = SymmetryRelation([[-1, 0], [2, -1]], [0, 0], [1, 1])
    verdict = verify_relation(neighbour, two_link.gravity, TOLERANCE)
    assert verdict.status is Status.REFUTED
    assert verdict.counterexample.tolist() == [0.1, 0.1]  # both joints must move; no less will do
    assert pinocchio_error("2r", neighbour, verdict.counterexample) > TOLERANCE


def judged_rightly(data):
    arm = data.draw(strategies.known_arms(1, 3))
    true = data.draw(strategies.relations(arm.group))
    assert verify_relation(true, arm.gravity, 0.0).status is Status.PROVED
    lie = data.draw(strategies.lies(arm.group, arm.active))
    verdict = verify_relation(lie, arm.gravity, 0.0)
    assert verdict.status is Status.REFUTED
    q = verdict.counterexample
    error = np.abs(
        arm.gravity.potential.gradient(lie.configuration(q))
        - lie.torque(arm.gravity.potential.gradient(q))
    ).max()
    assert 0.0 < error <= verdict.worst_error * (1 + 1e-6) + 1e-12


@FEW
@given(st.data())
def test_random_arms_truth_is_proved_and_lies_are_refuted(data):
    judged_rightly(data)


@pytest.mark.slow
@settings(FEW, max_examples=500)
@given(st.data())
def test_five_hundred_random_arms(data):
    judged_rightly(data)


def test_a_small_error_is_bounded_and_the_bound_is_sharp(two_link):
    near = SymmetryRelation([[-1, 0], [2, 1]], [1e-3, 0], [1, 1])
    verdict = verify_relation(near, two_link.gravity, 0.1)
    assert verdict.status is Status.BOUNDED
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (20000, 2))
    error = two_link.gravity.torque(near.configuration(q)) - two_link.gravity.torque(q)
    assert 0.99 * verdict.worst_error < np.abs(error).max() <= verdict.worst_error
    assert verify_relation(near, two_link.gravity, 0.99 * verdict.worst_error).passed is False


def test_a_bound_above_the_tolerance_without_counterexample_is_only_tested(arms):
    arm = arms["3r"]  # four waves, but only three free phases: the peaks never all meet
    near = SymmetryRelation(np.eye(3), [2e-3, 0.0, 3e-3], np.ones(3))
    strict = verify_relation(near, arm.gravity, 1e-9)
    between = 1.001 * strict.worst_error
    verdict = verify_relation(near, arm.gravity, between)
    assert verdict.status is Status.TESTED
    assert verdict.passed
    assert verdict.worst_error == pytest.approx(strict.worst_error, rel=1e-9)
    assert verify_relation(near, arm.gravity, 2 * between).status is Status.BOUNDED


@pytest.mark.parametrize(("tolerance", "status"), [(0.2, "bounded"), (0.01, "refuted")])
def test_a_learned_real_matrix_is_bounded_or_refuted(two_link, tolerance, status):
    learned = SymmetryRelation([[-1.0005, 2e-4], [2.0001, 0.9998]], [1e-4, -2e-4], [1, 1])
    verdict = verify_relation(learned, two_link.gravity, tolerance)
    assert verdict.status == status


def test_a_real_matrix_that_keeps_the_waves_is_bounded_everywhere():
    """Torque that depends on q1 + q2 alone: what keeps the sum, nearly, holds everywhere."""
    model = load_robot("2r").model.copy()
    model.inertias[1] = pin.Inertia(0.0, np.zeros(3), np.zeros((3, 3)))
    model.jointPlacements[2].translation = np.zeros(3)
    gravity = GravityModel(load_robot(model))
    relation = SymmetryRelation([[0.25, 0.75], [0.75, 0.25]], [1e-5, 0.0], [1, 1])
    verdict = verify_relation(relation, gravity, 1e-3)
    assert verdict.status is Status.BOUNDED
    assert "for q within" not in verdict.claim  # but for every q
    assert 6e-5 < verdict.worst_error < 7e-5


def test_tolerances_may_differ_from_joint_to_joint(two_link):
    near = SymmetryRelation(np.eye(2), [0.0, 1e-3], [1, 1])  # 6 mNm on both joints
    assert verify_relation(near, two_link.gravity, [0.01, 0.01]).status is Status.BOUNDED
    assert verify_relation(near, two_link.gravity, [np.inf, 0.01]).status is Status.BOUNDED
    for tolerance in ([0.001, 0.01], [0.01, 0.001], [np.inf, 0.001]):
        verdict = verify_relation(near, two_link.gravity, tolerance)
        assert verdict.status is Status.REFUTED
        assert pinocchio_error("2r", near, verdict.counterexample) > 0.001


def test_the_same_question_has_the_same_answer(two_link):
    lie = SymmetryRelation([[1, 0], [0, 1]], [0.3, 0.0], [1, -1])
    first, second = (verify_relation(lie, two_link.gravity, TOLERANCE) for _ in range(2))
    assert first.to_json() == second.to_json()


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-3])
def test_the_smallest_contradiction_that_is_no_rounding_is_refused(monkeypatch, size):
    broken = GravityModel(load_robot("2r"))
    assert broken.rounding < 1e-10
    torque = broken.torque
    monkeypatch.setattr(broken, "torque", lambda q: torque(q) + np.array([0.0, size]))
    with pytest.raises(InputError, match="difference of torque and potential"):
        verify_relation(SymmetryRelation(np.eye(2), [np.pi, 0], [-1, -1]), broken)
    # a claim that is only bounded is held against it too
    with pytest.raises(InputError, match="difference of torque and potential"):
        verify_relation(SymmetryRelation(np.eye(2), [np.pi - 1e-13, 0], [-1, -1]), broken, 1e-11)


def test_a_gravity_model_that_contradicts_itself_is_refused(two_link, monkeypatch):
    broken = GravityModel(load_robot("2r"))
    torque = broken.torque
    monkeypatch.setattr(broken, "torque", lambda q: torque(q) + np.array([0.0, 0.01]))
    flip = SymmetryRelation(np.eye(2), [np.pi, 0], [-1, -1])
    assert verify_relation(flip, two_link.gravity).status is Status.PROVED
    with pytest.raises(InputError, match=r"difference of torque and potential is 0\.02"):
        verify_relation(flip, broken)


def test_float_potentials_are_judged_up_to_rounding(two_link, monkeypatch):
    gravity = GravityModel(load_robot("2r"))
    monkeypatch.setattr(gravity, "potential", gravity.potential.to_float())
    for relation in two_link.group:
        assert verify_relation(relation, gravity, 0.0).passed


HOSTILE = {
    "d of 1e15 rounded turns": ("2r", np.eye(2), [2 * np.pi * 1e15, 0], [1, 1]),
    "an entry of 1e45": ("2r", [[1, 0], [1e45, 1]], [0, 0], [1, 1]),
    "entries of 2^63": ("3r", [[1, 0, 2.0**63], [0, 1, 2.0**63], [0, 0, 1]], [0, 0, 0], [1, 1, 1]),
    "the largest float": ("2r", [[1e308, 1e308], [1e308, 1e308]], [1e308, 1e308], [1, 1]),
    "denormal entries": ("2r", [[5e-324, 0], [0, 1]], [0, 0], [1, 1]),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_extreme_lies_are_refuted_where_they_fail(arms, name):
    arm, A, d, Y = HOSTILE[name]
    lie, gravity = SymmetryRelation(A, d, Y), arms[arm].gravity
    verdict = verify_relation(lie, gravity, 1e-9)
    assert verdict.status is Status.REFUTED
    with mpmath.workdps(700):  # forward in q, with all digits
        q = [mpmath.mpf(x) for x in verdict.counterexample.tolist()]
        image = [
            mpmath.fsum(mpmath.mpf(a) * x for a, x in zip(row, q, strict=True)) + mpmath.mpf(t)
            for row, t in zip(np.array(A, dtype=float).tolist(), np.array(d).tolist(), strict=True)
        ]
        turned = [float(x - 2 * mpmath.pi * mpmath.nint(x / (2 * mpmath.pi))) for x in image]
    error = gravity.torque(turned) - Y * gravity.torque(verdict.counterexample)
    assert np.abs(error).max() > 1e-9
    assert verdict.worst_error < 50


@pytest.mark.parametrize("row", [[1.0, 0.3], [1.0, 1e45], [0.25, 1e-300], [1e308, 5e-324]])
def test_what_joints_without_torque_do_does_not_matter(row):
    tree = load_robot("2r").tree
    upright = replace(tree, axes=np.array([[0.0, 0.0, -1.0], [0.0, -1.0, 0.0]]))
    gravity = GravityModel(upright)
    relation = SymmetryRelation([row, [0.0, -1.0]], [1e300, 0.0], [-1, 1])
    assert verify_relation(relation, gravity, 0.0).status is Status.PROVED


@pytest.mark.parametrize("scale", [1e-300, 1e-30, 1e-9, 1.0, 1e9, 1e300])
def test_verdicts_do_not_depend_on_the_size_of_the_arm(two_link, scale):
    tree = two_link.gravity.tree
    gravity = GravityModel(replace(tree, masses=tree.masses * scale))
    for true in two_link.group:
        assert verify_relation(true, gravity, 0.0).status is Status.PROVED
    lie = SymmetryRelation(np.eye(2), [1e-9, 0.0], [1, 1])
    verdict = verify_relation(lie, gravity, 0.0)
    assert verdict.status is Status.REFUTED
    assert verdict.worst_error == pytest.approx(24.525e-9 * scale, rel=1e-6)
    assert verify_relation(lie, gravity, 24.6e-9 * scale).status is Status.BOUNDED


def test_a_balanced_arm_is_judged_by_what_it_feels():
    """Hardly any torque is left of masses and lengths; rounding of the recursion is not."""
    tree = load_robot("pendulum").tree
    axis = np.array([[1.1e-5, 0.0, 1.0]])
    axis /= np.linalg.norm(axis)
    down = replace(tree, axes=axis, levers=np.array([[0.125, 0.03, 0.25]]))
    gravity = GravityModel(down)
    size = np.abs(gravity.torque(np.linspace(-3, 3, 99)[:, None])).max()
    assert size < 1e-4
    for true in primary_symmetries(gravity.potential):
        assert verify_relation(true, gravity, 0.0).status is Status.PROVED
    near = SymmetryRelation([[1]], [1e-9], [1])
    assert verify_relation(near, gravity, 1e-12).status is Status.BOUNDED
    assert verify_relation(near, gravity, 1e-16).status is Status.REFUTED


def test_a_real_matrix_is_bounded_in_a_box_that_the_claim_names(two_link):
    near = SymmetryRelation([[1 + 1e-6, 0], [0, 1]], [0, 0], [1, 1])
    verdict = verify_relation(near, two_link.gravity, 1e-3)
    assert verdict.status is Status.BOUNDED
    assert verdict.claim.endswith(", for q within a turn around zero")
    assert verify_relation(near, two_link.gravity, 1e3).claim.endswith("tau' = tau")


@given(st.integers(0, 10**6), st.floats(1e-9, 0.3), st.floats(1e-3, 100.0))
@settings(FEW, max_examples=25)
def test_bounds_for_every_q_come_before_those_in_a_box(two_link, seed, size, tolerance):
    rng = np.random.default_rng(seed)
    relation = rng.choice(list(two_link.group))
    A = relation.A + size * rng.normal(size=(2, 2)) * rng.integers(0, 2, (2, 2))
    claimed = SymmetryRelation(A, relation.d, relation.Y)
    verdict = verify_relation(claimed, two_link.gravity, tolerance, simplify=False)
    everywhere = relation_error_bound(A, relation.d, relation.Y, two_link.gravity.potential)
    near = learned_map_bound(A, relation.d, relation.Y, two_link.gravity.potential)
    if (everywhere <= tolerance).all():
        assert verdict.worst_error == everywhere.max()
        assert verdict.claim == describe_relation(claimed)
    elif (np.minimum(near, everywhere) <= tolerance).all():
        assert verdict.status is Status.BOUNDED
        assert verdict.worst_error <= near.max()
        assert verdict.claim == describe_relation(claimed) + IN_THE_BOX
    else:
        assert verdict.status in (Status.TESTED, Status.REFUTED)


def test_relations_are_written_readably():
    relation = SymmetryRelation([[0, 0], [1.5, -1]], [np.pi / 2, -0.25], [1, 1])
    assert describe_relation(relation) == "q1' = pi/2, q2' = 1.5 q1 - q2 - 0.25, tau' = tau"
    almost = SymmetryRelation([[1 + 1e-12]], [0], [1])
    assert describe_relation(almost).startswith("q1' = 1.00000000000")
    still = SymmetryRelation(np.zeros((1, 1)), [0], [-1])
    assert describe_relation(still) == "q1' = 0, tau1' = -tau1"


@pytest.mark.parametrize("tolerance", [-1.0, np.nan, [1.0, 1.0, 1.0], [0.1, np.nan]])
def test_impossible_tolerances_are_refused(two_link, tolerance):
    with pytest.raises(InputError, match="tolerance"):
        verify_relation(two_link.group[0], two_link.gravity, tolerance)


def test_relations_of_another_arm_are_refused(arms):
    with pytest.raises(InputError, match="number of joints is 3; accepted: 2"):
        verify_relation(arms["3r"].group[0], arms["2r"].gravity)


def test_symbolic_models_are_refused():
    gravity = GravityModel(planar_arm(1))
    with pytest.raises(InputError, match="substitute the symbols"):
        verify_relation(SymmetryRelation([[1]], [0], [1]), gravity)
