"""Relations by a rigid chain where few samples are no obstacle, and silence where it is none."""

import numpy as np
import pytest

from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.identification.chain_identification import (
    MOST_POSES,
    identify_by_chain,
    relations_of_chain,
)
from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.testing.contaminated_arms import Contaminant, Contamination, TrueArm


def recording(name, count, noise=0.0, seed=0):
    gravity = GravityModel(load_robot(name))
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (count, gravity.n))
    return gravity, q, gravity.torque(q) + noise * rng.normal(size=q.shape)


@pytest.mark.parametrize(("name", "count"), [("3r", 6), ("ur5", 7), ("panda", 9)])
def test_the_whole_group_from_a_handful_of_samples(name, count):
    gravity, q, tau = recording(name, count)
    exact = primary_symmetries(gravity.potential)
    found = identify_by_chain(q, tau)
    assert found.order == exact.order
    assert all(relation in exact for relation in found.group)
    assert found.missing is None
    assert max(r.relation.bound.max() for r in found.relations) < 1e-6


def test_bounds_hold_for_the_arm_that_was_measured():
    gravity, q, tau = recording("ur5", 40, 0.05)
    found = identify_by_chain(q, tau, noise=MeasurementNoise(0.0, 0.05))
    test = np.random.default_rng(1).uniform(-np.pi, np.pi, (300, 6))
    truth = gravity.torque(test)
    for entry in found.relations:
        relation = entry.relation
        error = np.abs(gravity.torque(relation.configuration(test)) - relation.Y * truth)
        assert np.all(error.max(axis=0) <= relation.bound + 1e-12)


@pytest.mark.parametrize("spoil", ["few", "zero", "spring", "rough"])
def test_no_chain_no_relations(spoil):
    _, q, tau = recording("panda", 12)
    if spoil == "few":
        q, tau = q[:3], tau[:3]
    elif spoil == "zero":
        tau = 0.0 * tau
    elif spoil == "spring":
        tau = tau + 5.0 * q
    else:  # so much noise that no relation would mean anything
        tau = tau + 3.0 * np.random.default_rng(1).normal(size=q.shape)
    found = identify_by_chain(q, tau)
    assert found.order == 1
    assert found.missing


def beside_gravity(kind, q, joint, size):
    """Torque beside gravity, (m, n) [N m]."""
    values = {"constant": np.ones_like(q), "spring": q, "cable": np.sin(2.0 * q)}[kind]
    return size * values * np.eye(q.shape[1])[joint]


@pytest.mark.parametrize("name", ["ur5", "panda"])
@pytest.mark.parametrize("joint", [1, 2])
def test_constant_torques_leave_the_relations_that_do_not_flip_them(name, joint):
    gravity = GravityModel(load_robot(name))
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.5, 2.5, (40, gravity.n))
    tau = gravity.torque(q) + beside_gravity("constant", q, joint, 0.5)
    found = identify_by_chain(q, tau + 0.05 * rng.normal(size=q.shape))
    assert found.lack.offset_joints.tolist() == [joint]
    assert abs(found.lack.offsets[joint] - 0.5) < 4.0 * found.lack.offset_errors[joint]
    assert f"on joint {joint + 1}" in found.note
    exact = primary_symmetries(gravity.potential)
    # noise may hide what breaks a further relation: bounds allow for that
    assert found.order >= sum(relation.Y[joint] > 0 for relation in exact)
    assert len(found.corrected) >= exact.order - found.order
    assert all(relation.Y[joint] > 0 for relation in found.group)
    test = rng.uniform(-np.pi, np.pi, (300, gravity.n))
    for relation in found.group:  # of the torque as measured, constant included
        image = relation.configuration(test)
        there, here = (
            gravity.torque(x) + beside_gravity("constant", x, joint, 0.5) for x in (image, test)
        )
        error = np.abs(there - relation.Y * here).max(axis=0)
        assert np.all(error <= relation.bound + 1e-12)


def test_gains_break_no_relation():
    gravity = GravityModel(load_robot("panda"))
    rng = np.random.default_rng(3)
    q = rng.uniform(-2.5, 2.5, (40, 7))
    gains = np.array([1.0, 1.0, 1.0, 1.2, 1.0, 1.0, 1.0])
    found = identify_by_chain(q, gains * gravity.torque(q) + 0.05 * rng.normal(size=q.shape))
    assert "gain" in found.note
    assert found.order >= primary_symmetries(gravity.potential).order


def test_a_chain_that_does_not_fit_is_asked_for_wrong_signs_where_that_is_wanted():
    gravity = GravityModel(load_robot("ur5"))
    rng = np.random.default_rng(5)
    q = rng.uniform(-2.5, 2.5, (40, 6))
    tau = gravity.torque(q) + 0.05 * rng.normal(size=q.shape)
    tau[:, 1] *= -1.0
    found = identify_by_chain(q, tau)
    assert "a wrong sign" in found.note
    assert found.order >= primary_symmetries(gravity.potential).order
    refused = identify_by_chain(q, tau, any_chain=False)
    assert refused.order == 1
    assert refused.lack is None


@pytest.mark.parametrize("name", ["ur5", "panda"])
@pytest.mark.parametrize("seed", range(2))
def test_springs_are_taken_off_and_relations_hold_beside_them(name, seed):
    gravity = GravityModel(load_robot(name))
    rng = np.random.default_rng(seed)
    joint = 1 + seed
    q = rng.uniform(-2.5, 2.5, (60, gravity.n))
    tau = gravity.torque(q) + beside_gravity("spring", q, joint, 0.4)
    found = identify_by_chain(q, tau + 0.05 * rng.normal(size=q.shape))
    assert found.decided
    assert f"on joint {joint + 1}" in found.note
    exact = primary_symmetries(gravity.potential)
    assert len(found.group) + len(found.corrected) >= exact.order
    here = rng.uniform(-np.pi, np.pi, (300, gravity.n))

    def measured(q):
        return gravity.torque(q) + beside_gravity("spring", q, joint, 0.4)

    for relation in (*found.group, *found.corrected):
        there = relation.configuration(here)  # as it is: a turn makes a difference
        missed = np.abs(measured(there) - relation.torque(measured(here), here)).max(axis=0)
        assert (missed <= relation.bound + 1e-9).all()
    for relation in found.corrected:
        assert relation.correction.rate[joint] == pytest.approx(0.4, abs=0.05)


def test_a_spring_on_a_joint_without_gravity_leaves_no_room_for_errors_of_its_angle():
    """The rate takes them up: bounds were larger than all torques of the joint."""
    gravity = GravityModel(load_robot("ur5"))
    rng = np.random.default_rng(1)
    q = rng.uniform(-2.5, 2.5, (40, 6))
    tau = gravity.torque(q) + beside_gravity("spring", q, 0, 1.0)
    found = identify_by_chain(q, tau + 0.02 * rng.normal(size=q.shape))
    assert found.chain.chain_.correction.rate[0] == pytest.approx(1.0, abs=0.05)
    for relation in (*found.group, *found.corrected):
        assert relation.bound[0] < 0.5


def test_what_a_chain_was_told_of_is_taken_off_too():
    gravity = GravityModel(load_robot("3r"))
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.5, 2.5, (40, 3))
    tau = gravity.torque(q) + [0.0, 1.0, 0.0] + 0.02 * rng.normal(size=q.shape)
    told = RigidChain(unknown_offsets=[False, True, False]).fit(q, tau)
    assert told.diagnosis().causes == ()
    found = relations_of_chain(told)
    assert all(relation.Y[1] > 0.0 for relation in found.group)
    assert len(found.corrected) == found.order == 8
    for relation in found.corrected:
        np.testing.assert_allclose(relation.correction.constant, [0.0, 1.0, 0.0], atol=0.05)


def test_nothing_is_claimed_of_an_arm_with_a_cable():
    gravity = GravityModel(load_robot("panda"))
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.5, 2.5, (60, 7))
    tau = gravity.torque(q) + beside_gravity("cable", q, 3, 0.4)
    found = identify_by_chain(q, tau + 0.05 * rng.normal(size=q.shape))
    assert not found.decided
    assert found.order == 1
    assert "twice the angle" in found.missing
    assert "on joint 4" in found.missing
    assert found.lack.failed


@pytest.mark.parametrize("seed", range(3))
def test_no_relation_is_claimed_that_could_be_wrong_by_a_twentieth(seed):
    """Whatever the noise that is stated: gravity obeys what is claimed to 5 % of the torque."""
    gravity = GravityModel(load_robot("ur5"))
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (14, 6))
    torque = gravity.torque(q)
    claimed = []
    for noise in (0.01, 0.3, 1.0, 3.0):
        measured = torque + noise * rng.normal(size=q.shape)
        found = identify_by_chain(q, measured, noise=MeasurementNoise(0.0, noise))
        claimed.append(found.decided)
        if found.decided:
            assert found.chain.symmetries().gravity_bounds.max() <= 0.05 * np.abs(measured).max()
        elif found.chain is None and "could still be wrong" in found.missing:
            assert "more samples" in found.missing
    assert claimed[0]
    assert not all(claimed)


@pytest.mark.parametrize(("kind", "size"), [("constant", 0.05), ("spring", 0.02)])
def test_bounds_hold_for_torques_that_hide_in_the_noise(kind, size):
    """A constant or a spring too small to be seen: the measured torque keeps the bounds."""
    gravity, q, tau = recording("ur5", 30, 0.1)
    test = np.random.default_rng(1).uniform(-np.pi, np.pi, (300, 6))
    claims = 0
    for joint in (1, 4):

        def beside(q, joint=joint):
            values = np.ones_like(q) if kind == "constant" else q
            return size * values * np.eye(6)[joint]

        found = identify_by_chain(q, tau + beside(q), noise=MeasurementNoise(0.0, 0.1))
        truth = gravity.torque(test) + beside(test)
        for entry in found.relations if found.decided else ():
            image = wrap(entry.relation.configuration(test))
            there = gravity.torque(image) + beside(image)
            error = np.abs(there - entry.relation.Y * truth).max(axis=0)
            claims += 1
            assert np.all(error <= entry.relation.bound + 1e-12)
    assert claims > 5


@pytest.mark.parametrize("kind", [Contaminant.SCALE, Contaminant.COMPLIANCE])
@pytest.mark.parametrize("name", ["2r", "3r"])
def test_bounds_hold_for_errors_of_angles_that_hide_in_the_noise(kind, name):
    """Angles that are read a little wrong: the torque at the angles as read keeps the bounds."""
    arm, noise, claims = TrueArm.of(load_robot(name)), 0.02, 0
    test = np.random.default_rng(1).uniform(-np.pi, np.pi, (300, arm.n))
    for seed in range(12):
        rng = np.random.default_rng(seed)
        q = rng.uniform(-np.pi, np.pi, (40, arm.n))
        wrong = Contamination.drawn(arm, kind, q, rng, joint=int(rng.integers(arm.n)))
        size = 3.0 * wrong.standard_error(noise)  # hardly ever named
        measured = wrong.measured(size, noise, rng)
        found = identify_by_chain(measured.q, measured.tau, noise=MeasurementNoise(0.0, noise))
        truth = wrong.truth(size)
        for entry in found.relations if found.decided else ():
            image = wrap(entry.relation.configuration(test))
            error = np.abs(truth(image) - entry.relation.Y * truth(test)).max(axis=0)
            claims += not entry.relation.is_identity
            assert np.all(error <= entry.relation.bound + 1e-12)
    assert claims > 20


def test_many_poses_are_thinned():
    _, q, tau = recording("2r", 3 * MOST_POSES, 0.05)
    found = identify_by_chain(q, tau)
    assert found.order == 8
    assert len(found.chain.fit_.samples.q) == MOST_POSES


def test_samples_too_few_to_show_a_spring_are_not_enough_unless_they_are_exact():
    noise = MeasurementNoise(0.0, 0.05)
    claimed = []
    for count in range(5, 12):
        _, q, tau = recording("2r", count, 0.05, seed=3)
        found = identify_by_chain(q, tau, noise=noise)
        claimed.append(found.decided)
        if found.decided:
            assert found.chain.beside().complete
        elif "not explain exactly" in found.missing:
            assert "a spring or a cable" in found.missing
    assert not claimed[0]
    assert not claimed[1]
    assert claimed[-1]
    _, q, tau = recording("2r", 4)
    assert identify_by_chain(q, tau).order == 8
