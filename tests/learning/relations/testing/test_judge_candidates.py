import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.relations.testing.judge_candidates import Judgement, judge_candidates
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.verify.testing.strategies import known_arms, lies
from tests.learning.static_data import known_potential, stable_samples, with_angle_noise


@given(st.data(), known_arms(min_joints=1, max_joints=3), st.integers(0, 2**32 - 1))
def test_the_truth_is_consistent_and_lies_are_contradicted(data, arm, seed):
    potential = arm.gravity.potential.to_float()
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (60, potential.n))
    lie = data.draw(lies(arm.group, arm.active))
    *true, false = judge_candidates([*arm.group, lie], q, potential.gradient(q))
    assert {found.judgement for found in true} == {Judgement.CONSISTENT}
    assert false.judgement is Judgement.CONTRADICTED
    scale = potential.gradient_bound().max()
    assert all(found.relation.bound.max() < 1e-6 * scale for found in true)


@given(st.data(), known_arms(min_joints=1, max_joints=3), st.integers(0, 2**32 - 1))
def test_the_bound_holds_for_lies_too(data, arm, seed):
    potential = arm.gravity.potential.to_float()
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (60, potential.n))
    lie = data.draw(lies(arm.group, arm.active))
    found = judge_candidates([lie], q, potential.gradient(q))[0]
    probes = rng.uniform(-np.pi, np.pi, (200, potential.n))
    image = potential.gradient(lie.configuration(probes))
    error = np.abs(image - lie.torque(potential.gradient(probes))).max(axis=0)
    assert (error <= found.relation.bound * (1 + 1e-9) + 1e-9).all()


def test_noise_leaves_small_lies_open_and_refutes_large_ones():
    potential, group = known_potential("2r")
    rng = np.random.default_rng(0)
    q, tau = stable_samples(potential, rng, 40)
    noisy = with_angle_noise(q, 0.1, rng)
    true = group[3]
    large = SymmetryRelation(true.A, true.d + np.array([0.05, 0.0]), true.Y)
    small = SymmetryRelation(true.A, true.d + np.array([1e-5, 0.0]), true.Y)
    found = judge_candidates([true, large, small], noisy, tau)
    assert [f.judgement for f in found] == [
        Judgement.CONSISTENT,
        Judgement.CONTRADICTED,
        Judgement.CONSISTENT,
    ]


def test_few_or_noisy_samples_leave_the_question_open():
    potential, group = known_potential("2r")
    rng = np.random.default_rng(1)
    q, tau = stable_samples(potential, rng, 6)
    few = judge_candidates(group, q[:3], tau[:3])
    assert all(f.judgement is Judgement.UNTESTABLE for f in few)
    assert "3 more samples" in few[0].reason
    q, tau = stable_samples(potential, rng, 20)
    noisy = judge_candidates([group[1]], with_angle_noise(q, 8.0, rng), tau)[0]
    assert noisy.judgement is Judgement.UNTESTABLE
    assert "a violation could hide in the noise" in noisy.reason


def test_another_number_of_joints_is_refused():
    with pytest.raises(InputError, match="number of joints"):
        judge_candidates(known_potential("2r")[1], np.zeros((3, 3)), np.zeros((3, 3)))


@given(
    st.sampled_from(["2r", "3r", "ur5"]),
    st.integers(0, 5),
    st.sampled_from([0.0, 1e-9, 1e-7]),
    st.integers(0, 2**32 - 1),
)
@settings(max_examples=12)
def test_a_joint_that_stood_still_makes_no_true_relation_contradicted(name, joint, sway, seed):
    potential, group = known_potential(name)
    rng = np.random.default_rng(seed)
    joint %= potential.n
    q = rng.uniform(-np.pi, np.pi, (120, potential.n))
    q[:, joint] = rng.uniform(-3, 3) + sway * rng.uniform(size=120)
    judged = {f.judgement for f in judge_candidates(group, q, potential.gradient(q))}
    felt = potential.frequencies[:, joint].any()
    assert judged == {Judgement.UNTESTABLE if felt else Judgement.CONSISTENT}


def test_where_a_joint_that_stood_still_is_carried_nothing_was_measured():
    potential, _ = known_potential("ur5")
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (120, 6))
    q[:, 0] = 0.7
    turned, mirrored = np.eye(6), np.eye(6)
    mirrored[0, 0] = -1.0
    claims = [
        SymmetryRelation(turned, np.eye(6)[0], np.ones(6)),
        SymmetryRelation(mirrored, np.zeros(6), np.ones(6)),
        SymmetryRelation(turned, 0.3 * np.eye(6)[1], np.ones(6)),
    ]
    judged = judge_candidates(claims, q, potential.gradient(q))
    untestable = Judgement.UNTESTABLE
    assert [f.judgement for f in judged] == [untestable, untestable, Judgement.CONTRADICTED]
    assert "joint 1 never moved" in judged[0].reason
