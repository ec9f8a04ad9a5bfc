import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.relations.pairing.hough_transform import Tolerance
from isotorque.learning.relations.pairing.orbit_refinement import find_orbits, refine_offsets
from isotorque.learning.relations.pairing.torque_pairs import group_by_torque
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.group_arrays import CandidateGroup, completed
from isotorque.verify.testing.strategies import known_arms
from tests.learning.static_data import known_potential, recording, with_angle_noise


def some_of(group, chosen):
    return CandidateGroup(group.basis, group.A_sat[chosen], group.d_sat[chosen], group.Y[chosen])


@given(known_arms(min_joints=1, max_joints=3), st.integers(0, 2**32 - 1))
def test_any_relations_of_a_group_are_completed_within_it(arm, seed):
    rng = np.random.default_rng(seed)
    chosen = rng.integers(0, arm.group.order, rng.integers(1, 4))
    generators = some_of(arm.group, chosen)
    whole = completed(generators)
    assert whole is not None
    assert arm.group.order % len(whole) == 0  # Lagrange
    table, defects = whole.products()
    assert (table >= 0).all()
    assert np.abs(defects).max(initial=0.0) < 1e-9
    for A, d, Y in zip(whole.A, whole.d, whole.Y, strict=True):
        known = (arm.group.Y == Y).all(axis=1) & (arm.group.A_sat == A).all(axis=(1, 2))
        assert (np.abs(wrap(arm.group.d_sat[known] - d)).max(axis=1, initial=0.0) < 1e-6).any()


def test_offsets_that_do_not_fit_together_do_not_close():
    unit = np.eye(1)
    turns = CandidateGroup(unit.astype(int), unit[None], np.array([[1.0]]), np.ones((1, 1)))
    assert completed(turns, 1e-3) is None
    assert completed(turns, 0.3).d.shape == (6, 1)  # six of them are nearly a whole turn


def test_one_map_with_two_signs_does_not_close():
    unit = np.eye(1)
    both = CandidateGroup(
        unit.astype(int), -np.stack([unit, unit]), np.zeros((2, 1)), np.array([[1.0], [-1.0]])
    )
    assert completed(both) is None


def grouped_recording(name, seed, torques, degrees):
    potential, group = known_potential(name)
    rng = np.random.default_rng(seed)
    q, tau = recording(potential, group, rng, torques)
    return group_by_torque(with_angle_noise(q, degrees, rng), tau, 1e-6, 0.02), group


def test_samples_of_an_orbit_are_found_again():
    groups, group = grouped_recording("2r", 0, 6, 0.0)
    orbits = find_orbits(groups, some_of(group, slice(None)), Tolerance(1e-8))
    for number in range(orbits.count):
        members = np.flatnonzero(orbits.orbit == number)
        images = group.orbit(groups.q[members[0]])[orbits.member[members]]
        assert np.abs(wrap(images - groups.q[members])).max() < 1e-7
        assert len(np.unique(orbits.member[members])) == len(members)
    # every other sample of a primary set was found: no two orbits of a torque touch
    for a in range(len(groups.q)):
        for b in range(a):
            reached = np.abs(wrap(group.orbit(groups.q[a]) - groups.q[b])).max(axis=1) < 1e-7
            if reached.any() and groups.torque[a] == groups.torque[b]:
                assert orbits.orbit[a] == orbits.orbit[b] >= 0


def test_refined_offsets_are_as_good_as_their_standard_errors_say():
    pulls, levels = [], []
    for seed in range(40):
        groups, group = grouped_recording("2r", seed, 6, 0.3)
        exact = some_of(group, slice(None))
        orbits = find_orbits(groups, exact, Tolerance(np.deg2rad(0.3)))
        shift = np.array([0.004, -0.003])
        moved = exact.d + np.einsum("gij,j->gi", np.eye(2) - exact.A, shift)
        start = CandidateGroup(exact.basis, exact.A, wrap(moved), exact.Y)
        found = refine_offsets(groups, start, orbits, 1e-9)
        assert found.group.composed() is not None
        moving = found.offset_errors > 0.0
        pulls.append((wrap(found.group.d - exact.d)[moving] / found.offset_errors[moving])[0])
        levels.append(np.rad2deg(found.sigma))
    assert 0.7 < np.std(pulls) < 1.35
    assert abs(np.mean(levels) - 0.3) < 0.03


def test_exact_samples_give_exact_offsets():
    groups, group = grouped_recording("3r", 1, 3, 0.0)
    exact = some_of(group, slice(None))
    wrong = np.einsum("gij,j->gi", np.eye(3) - exact.A, np.full(3, 1e-8))
    start = CandidateGroup(exact.basis, exact.A, wrap(exact.d + wrong), exact.Y)
    orbits = find_orbits(groups, start, Tolerance(1e-7))
    found = refine_offsets(groups, start, orbits, 1e-9)
    assert np.abs(wrap(found.group.d - exact.d)).max() < 1e-10
