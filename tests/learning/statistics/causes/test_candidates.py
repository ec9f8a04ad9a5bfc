"""Candidates: what samples cannot show is not tried; first order is what it says."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.causes.extensible_chain import ExtensibleChain
from isotorque.learning.learners.rigid.fitting.chain_parameters import serial
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel
from isotorque.learning.statistics.causes.candidates import (
    CARRYING_SHARE,
    candidates,
    explained_to_first_order,
)
from isotorque.learning.statistics.causes.extension import Extension, Kind
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

NOISE = 0.05


def model_of(robot, poses, seed, directions=None, change=0.0, noise=NOISE):
    gravity = GravityModel(load_robot(robot))
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.0, 2.0, (poses, gravity.n))
    tau = gravity.torque(q) + noise * rng.normal(size=q.shape) + change
    n = gravity.n
    samples = ChainSamples(q, tau, np.full(n, noise), np.zeros(n), np.ones(poses))
    family = ChainModel(serial(n), np.ones(n), np.zeros(n, dtype=bool), ())
    return ExtensibleChain(samples, family, directions, True, True, np.random.default_rng(seed))


def kinds_by_joint(found):
    return {(extension.kind, extension.joint) for extension in found}


def test_gains_and_compliances_need_a_torque_that_stands_out():
    model = model_of("ur5", 40, 0)  # joints 1 and 5 of it are vertical, joint 6 carries nothing
    found = kinds_by_joint(candidates(model, model.alone(), True))
    assert {j for kind, j in found if kind is Kind.GAIN} == {1, 2}
    assert {j for kind, j in found if kind is Kind.COMPLIANCE} == {1, 2}
    assert {j for kind, j in found if kind is Kind.SCALE} == {1, 2}
    assert {j for kind, j in found if kind is Kind.OFFSET} == {*range(6), None}


def test_small_torques_far_above_their_noise_have_gains_too():
    """Wrist 1 of a UR5 holds less than a hundredth of what its shoulder holds."""
    model = model_of("ur5", 40, 0, noise=0.01)
    fit = model.alone()
    size = np.sqrt(np.mean(model.torque**2, axis=0))
    assert 4.0 * model.noise[3] < size[3] < CARRYING_SHARE * size.max()
    gains = {j for kind, j in kinds_by_joint(candidates(model, fit, True)) if kind is Kind.GAIN}
    assert {1, 2, 3} <= gains


def test_friction_needs_approaches_from_both_sides():
    poses = 40
    sides = np.ones((poses, 2))
    sides[::2, 1] = -1.0
    for directions, expected in [(None, set()), (np.zeros((poses, 2)), set()), (sides, {1})]:
        model = model_of("2r", poses, 1, directions)
        found = kinds_by_joint(candidates(model, model.alone(), True))
        assert {j for kind, j in found if kind is Kind.FRICTION} == expected


def test_what_is_chosen_is_not_tried_again():
    model = model_of("2r", 40, 2)
    chosen = Extension.at(Kind.SPRING, 0)
    fit = model.refitted(chosen.terms, model.alone())
    found = kinds_by_joint(candidates(model, fit, True))
    assert (Kind.SPRING, 0) not in found
    assert (Kind.OFFSET, 0) not in found  # it is a part of the spring
    assert (Kind.OFFSET, 1) in found


@given(st.integers(0, 2**32 - 1), st.integers(0, 1), st.floats(-0.3, 0.3))
@settings(max_examples=20)
def test_first_order_is_what_a_linear_cause_takes(seed, joint, size):
    """A constant is linear and the chain nearly so: what it takes is what a refit shows."""
    model = model_of("2r", 40, seed, change=size * np.eye(2)[joint])
    alone = model.alone()
    extension = Extension.at(Kind.OFFSET, joint)
    (taken,), (degrees,) = explained_to_first_order(alone, [extension])
    refitted = model.refitted(extension.terms, alone, thorough=True)
    assert degrees == 1
    assert abs(alone.cost - refitted.cost - taken) < 0.15 * taken + 1.0


def test_what_a_model_holds_itself_has_no_degrees_of_freedom():
    """The gain of a pendulum goes into its mass; so does another load that is always there."""
    model = model_of("pendulum", 40, 3)
    _, degrees = explained_to_first_order(
        model.alone(), [Extension.at(Kind.GAIN, 0), Extension.payload(0), Extension.payload(20)]
    )
    assert degrees.tolist() == [0, 0, 2]
