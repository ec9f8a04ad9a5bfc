"""The default model of recordings: the simplest that errs no more than the best elsewhere."""

import numpy as np
import pytest

from isotorque.learning.files.static_samples import StaticSamples
from isotorque.runs.from_data.model_choice import (
    MANY,
    PARAMETRIC,
    RIGID,
    WITH_PROCESS,
    choice_in_words,
    choose_model,
)
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

NOISE = 0.05


def poses(arm, count, seed):
    return np.random.default_rng(seed).uniform(-2.0, 2.0, (count, arm.n))


def noisy(torque, seed):
    return torque + NOISE * np.random.default_rng([seed, 1]).normal(size=torque.shape)


@pytest.fixture(scope="module")
def arm():
    return GravityModel(load_robot("3r"))


@pytest.mark.parametrize("robot", [None, "3r"])
def test_rigid_arms_need_no_process(arm, robot):
    q = poses(arm, 40, 0)
    found = choose_model(StaticSamples(q, noisy(arm.torque(q), 0)), robot)
    assert found.chosen.name == (RIGID if robot is None else PARAMETRIC)
    assert found.causes == ()
    assert {c.name for c in found.contenders} >= {RIGID, WITH_PROCESS}
    fresh = poses(arm, 500, 1)
    error = np.sqrt(
        np.mean((found.chosen.learner.predict(fresh) - noisy(arm.torque(fresh), 2)) ** 2)
    )
    assert 0.8 < found.chosen.held_out.rmse / error < 1.25


def test_a_drawing_with_a_wrong_encoder_zero_loses_to_the_chain():
    """Planar arms take it for other centres of mass; where axes cross it is no such arm."""
    panda = GravityModel(load_robot("panda"))
    q = poses(panda, 40, 3)
    zero = np.array([0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0])
    found = choose_model(StaticSamples(q, noisy(panda.torque(q + zero), 3)), "panda")
    assert found.chosen.name == RIGID
    by_name = {c.name: c.held_out.rmse for c in found.contenders}
    assert by_name[PARAMETRIC] > 2.0 * by_name[RIGID]
    assert RIGID in choice_in_words(found)[0]


def test_smooth_torques_beside_the_links_are_learned_by_processes(arm):
    q = poses(arm, 50, 4)
    tau = noisy(arm.torque(q) + 0.8 * np.sin(3.0 * q) * [0.0, 1.0, 0.0], 4)
    found = choose_model(StaticSamples(q, tau))
    assert found.chosen.name == WITH_PROCESS
    fresh = poses(arm, 300, 5)
    truth = arm.torque(fresh) + 0.8 * np.sin(3.0 * fresh) * [0.0, 1.0, 0.0]
    chain = next(c for c in found.contenders if c.name == RIGID)
    assert chain.held_out is None or chain.held_out.rmse > 3.0 * found.chosen.held_out.rmse
    assert np.sqrt(np.mean((found.chosen.learner.predict(fresh) - truth) ** 2)) < 0.15


@pytest.mark.parametrize("robot", [None, "3r"])
def test_friction_is_taken_off_and_is_no_error(arm, robot):
    q = poses(arm, 40, 6)
    sides = np.random.default_rng(6).choice([-1.0, 1.0], q.shape)
    tau = noisy(arm.torque(q) + [0.5, 0.3, 0.0] * sides, 6)
    found = choose_model(StaticSamples(q, tau, directions=sides), robot)
    np.testing.assert_allclose(found.friction, [0.5, 0.3, 0.0], atol=0.04)
    assert found.chosen.held_out.rmse == pytest.approx(NOISE, rel=0.3)
    fresh = poses(arm, 300, 7)
    error = found.chosen.learner.predict(fresh) - arm.torque(fresh)
    assert np.sqrt(np.mean(error**2)) < 0.03


@pytest.mark.parametrize("robot", [None, "3r"])
def test_the_model_is_of_the_arm_before_its_payload_changed(arm, robot):
    heavier = GravityModel(load_robot("3r", payload="0.5"))
    q, change = poses(arm, 60, 8), 37
    tau = noisy(np.concatenate([arm.torque(q[:change]), heavier.torque(q[change:])]), 8)
    found = choose_model(StaticSamples(q, tau), robot)
    assert found.left_out == 60 - change
    assert (found.label[:change] >= 0).all()
    assert (found.label[change:] == -1).all()
    assert "the payload changes with pose 38 of 60" in " ".join(found.remarks)
    fresh = poses(arm, 300, 9)
    error = found.chosen.learner.predict(fresh) - arm.torque(fresh)
    assert np.sqrt(np.mean(error**2)) < 0.03


def test_rows_of_one_pose_count_once(arm):
    """What sticks for a whole pose would be predicted by its other rows."""
    q = poses(arm, 25, 10)
    tau = arm.torque(q) + 0.5 * np.random.default_rng(11).normal(size=q.shape)
    rows = np.repeat(np.arange(25), 8)
    found = choose_model(StaticSamples(q[rows], tau[rows]), "3r")
    assert len(found.samples.q) == 25
    assert found.chosen.held_out.poses.count == 25
    assert found.chosen.held_out.rmse > 0.4


def test_both_sides_of_a_pose_are_left_out_together(arm):
    q = np.repeat(poses(arm, 25, 12), 2, axis=0)
    sides = np.tile([[1.0] * 3, [-1.0] * 3], (25, 1))
    found = choose_model(StaticSamples(q, noisy(arm.torque(q), 12), directions=sides), "3r")
    assert len(found.samples.q) == 50
    assert found.chosen.held_out.poses.count == 25


def test_outliers_are_rows_and_are_found_in_the_choice(arm):
    q = poses(arm, 40, 13)
    tau = noisy(arm.torque(q), 13)
    tau[17] += 4.0
    found = choose_model(StaticSamples(q, tau), "3r")
    assert np.flatnonzero(found.outliers).tolist() == [17]


def test_degrees_are_said_and_nothing_is_chosen(arm):
    q = poses(arm, 30, 14)
    found = choose_model(StaticSamples(np.rad2deg(q), noisy(arm.torque(q), 14)))
    assert found.chosen is None
    assert "degrees" in found.reading


def test_too_many_poses_for_a_process_are_said(arm):
    q = poses(arm, MANY + 1, 15)
    found = choose_model(StaticSamples(q, noisy(arm.torque(q), 15)))
    assert {c.name for c in found.contenders} == {RIGID}
    assert "no process was tried" in " ".join(found.remarks)


def test_one_seed_one_choice(arm):
    q = poses(arm, 20, 16)
    samples = StaticSamples(q, noisy(arm.torque(q), 16))
    first, second = (choose_model(samples, "3r", seed=4) for _ in range(2))
    for a, b in zip(first.contenders, second.contenders, strict=True):
        np.testing.assert_array_equal(a.held_out.errors, b.held_out.errors)
