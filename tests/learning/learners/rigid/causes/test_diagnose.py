"""Diagnoses of simulated recordings: the right cause with its size, none where there is none."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.causes.diagnose import diagnose
from isotorque.learning.statistics.causes.extension import Kind
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners.rigid.random_chains import KINDS, random_chain, random_poses

NOISE = 0.05


def recorded(robot, kind, joint, seed, poses=40):
    """Rows of an arm with one cause of ordinary size."""
    gravity = GravityModel(load_robot(robot))
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.0, 2.0, (poses, gravity.n))
    tau = gravity.torque(q)
    largest = np.abs(tau[:, joint]).max()
    sides = rng.choice([-1.0, 1.0], q.shape)
    read = q.copy()
    if kind is Kind.OFFSET:
        tau[:, joint] += 0.05 * largest
    elif kind is Kind.GAIN:
        tau[:, joint] *= 1.1
    elif kind is Kind.SIGN:
        tau[:, joint] *= -1.0
    elif kind is Kind.SPRING:
        tau[:, joint] += 0.025 * largest * q[:, joint]
    elif kind is Kind.FRICTION:
        tau[:, joint] += 0.03 * largest * sides[:, joint]
    elif kind is Kind.CABLE:
        tau[:, joint] += 0.03 * largest * np.sin(2.0 * q[:, joint] + 0.5)
    elif kind is Kind.SCALE:
        read[:, joint] /= 1.02
    elif kind is Kind.COMPLIANCE:
        read[:, joint] += 0.02 * tau[:, joint] / largest
    return read, tau + NOISE * rng.normal(size=q.shape), sides


@pytest.mark.parametrize("kind", [kind for kind in Kind if kind is not Kind.PAYLOAD])
@pytest.mark.parametrize(("robot", "joint"), [("ur5", 1), ("panda", 3)])
@pytest.mark.parametrize("known", [True, False])
def test_the_right_cause_is_named(kind, robot, joint, known):
    q, tau, sides = recorded(robot, kind, joint, seed=11)
    found = diagnose(q, tau, directions=sides, torque_noise=NOISE if known else None)
    assert found.adequate
    first = found.causes[0]
    # of two coupled joints only the ratio of gains is known
    assert (kind, joint) in first.rivals
    assert len(found.causes) == 1
    if kind in (Kind.OFFSET, Kind.GAIN) and first.joint == joint:
        gravity = GravityModel(load_robot(robot))
        rng = np.random.default_rng(11)
        largest = np.abs(gravity.torque(rng.uniform(-2.0, 2.0, q.shape))[:, joint]).max()
        true = 0.05 * largest if kind is Kind.OFFSET else 1.1
        assert abs(first.size[0] - true) < 5.0 * first.standard_error[0]


@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.sampled_from(KINDS), st.booleans())
@settings(max_examples=20)
def test_rigid_chains_have_no_cause(seed, n, kind, exact):
    """Of any geometry; one alarm in a hundred is what the level allows, so effects are tested."""
    rng = np.random.default_rng(seed)
    chain = random_chain(rng, n, kind)
    q = random_poses(rng, 30, n)
    noise = 0.0 if exact else 1e-3
    tau = chain.torque(q) + noise * rng.normal(size=q.shape)
    found = diagnose(q, tau)
    for cause in found.causes:
        assert cause.effect < 3.0 * noise
    assert not (exact and found.causes)


def test_another_payload_is_named_with_its_first_sample():
    gravity = GravityModel(load_robot("panda"))
    loaded = GravityModel(load_robot("panda", payload="1.0,0.03,0.02,0.06"))
    rng = np.random.default_rng(4)
    q = rng.uniform(-2.0, 2.0, (60, 7))
    tau = np.concatenate([gravity.torque(q[:30]), loaded.torque(q[30:])])
    found = diagnose(q, tau + NOISE * rng.normal(size=q.shape))
    assert found.causes[0].kind is Kind.PAYLOAD


def test_rows_of_one_pose_count_once_but_from_either_side():
    q, tau, sides = recorded("2r", Kind.FRICTION, 0, seed=3)
    gravity = GravityModel(load_robot("2r"))
    again = gravity.torque(q) + NOISE * np.random.default_rng(8).normal(size=q.shape)
    again[:, 0] -= 0.03 * np.abs(gravity.torque(q)[:, 0]).max() * sides[:, 0]
    both = np.concatenate([sides, sides * [-1.0, 1.0]])
    found = diagnose(np.concatenate([q, q]), np.concatenate([tau, again]), directions=both)
    assert (found.causes[0].kind, found.causes[0].joint) == (Kind.FRICTION, 0)
    again = diagnose(np.repeat(q, 5, axis=0), np.repeat(tau, 5, axis=0))
    once = diagnose(q, tau)
    assert again.noise == pytest.approx(once.noise, rel=0.05)  # not smaller by the root of five


def test_weights_count():
    """A constant that the good rows show is lost among the others, unless these weigh less."""
    gravity = GravityModel(load_robot("2r"))
    rng = np.random.default_rng(4)
    q = rng.uniform(-2.0, 2.0, (160, 2))
    noise = np.where(np.arange(160) < 40, 0.02, 0.2)[:, None]
    tau = gravity.torque(q) + [0.0, 0.03] + noise * rng.normal(size=q.shape)
    weight = noise[:, 0] ** -2.0
    assert diagnose(q, tau).causes == ()
    (cause,) = diagnose(q, tau, weight=weight).causes
    assert (cause.kind, cause.joint) == (Kind.OFFSET, 1)
    assert cause.size[0] == pytest.approx(0.03, abs=4.0 * cause.standard_error[0])
    # rows of no weight may show what they like
    tau = gravity.torque(q) + NOISE * rng.normal(size=q.shape)
    tau[40:, 1] += 0.5
    weight = np.where(np.arange(160) < 40, 1.0, 1e-6)
    assert diagnose(q, tau).causes
    assert diagnose(q, tau, weight=weight).causes == ()
    # a gross error in a second row of every pose
    rows, torques = np.repeat(q[:40], 2, axis=0), np.repeat(tau[:40], 2, axis=0)
    torques[1::2, 1] += 3.0
    twice = diagnose(rows, torques, weight=np.tile([1.0, 1e-6], 40))
    assert twice.causes == ()
    np.testing.assert_allclose(twice.noise, diagnose(q[:40], tau[:40]).noise, rtol=0.1)
    # only how they differ counts: not the noise, nor what is seen in it
    same, double = (diagnose(q, tau, weight=w, torque_noise=NOISE) for w in (weight, 7.0 * weight))
    assert same.selection.fit.cost == pytest.approx(double.selection.fit.cost, rel=1e-6)


def test_a_spring_that_stands_out_is_no_cable():
    """With the weights of a chain alone all causes of the joint that is badly fitted look alike."""
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.0, 2.0, (40, 2))
    lower = 6.1 * np.cos(q.sum(axis=1))
    tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    tau = tau + 0.1 * q * [0.0, 1.0] + 0.002 * rng.normal(size=q.shape)
    (cause,) = diagnose(q, tau).causes
    assert cause.rivals == ((Kind.SPRING, 1),)


def test_too_few_poses_are_told():
    q = np.random.default_rng(0).uniform(-2.0, 2.0, (5, 7))
    found = diagnose(q, np.cos(q))
    assert found.causes == ()
    assert not found.adequate
    assert found.missing == "1 more poses: 5 different ones were given"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda q, tau: ((q, tau), {"torque_noise": -1.0}), "torque_noise"),
        (lambda q, tau: ((q, tau[:, :1]), {}), "shape"),
        (lambda q, tau: ((q, np.where(q > 1.0, np.nan, tau)), {}), "finite"),
        (lambda q, tau: ((q, tau), {"directions": np.ones(2)}), "directions"),
        (lambda q, tau: ((q, tau), {"weight": np.ones(2)}), "weight"),
        (lambda q, tau: ((q, tau), {"weight": np.zeros(len(q))}), "weight"),
        (lambda q, tau: ((q, tau), {"directions": np.full(q.shape, np.nan)}), "directions"),
    ],
)
def test_what_does_not_fit_is_refused(change, said):
    q = np.random.default_rng(0).uniform(-2.0, 2.0, (12, 2))
    given, options = change(q, np.cos(q))
    with pytest.raises(InputError, match=said):
        diagnose(*given, **options)


@pytest.mark.parametrize(
    "spoil", ["joint at rest", "joint without torque", "same pose", "one joint"]
)
def test_samples_that_say_little_are_no_obstacle(spoil):
    gravity = GravityModel(load_robot("2r"))
    rng = np.random.default_rng(1)
    q = rng.uniform(-2.0, 2.0, (30, 2))
    if spoil == "joint at rest":
        q[:, 1] = 0.3
    if spoil == "same pose":
        q[:] = q[0]
    tau = gravity.torque(q) + NOISE * rng.normal(size=q.shape)
    if spoil == "joint without torque":
        tau[:, 1] = 0.0
    if spoil == "one joint":
        q, tau = q[:, :1], np.cos(q[:, :1]) + NOISE * rng.normal(size=(30, 1))
    found = diagnose(q, tau)
    assert all(np.isfinite(cause.size).all() for cause in found.causes)
    if spoil == "same pose":
        assert found.missing


def test_one_seed_one_result():
    q, tau, sides = recorded("ur5", Kind.CABLE, 1, seed=2)
    first, second = (diagnose(q, tau, directions=sides) for _ in range(2))
    assert first.causes[0].size.tolist() == second.causes[0].size.tolist()
