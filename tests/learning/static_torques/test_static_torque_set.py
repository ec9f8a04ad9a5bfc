import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.exploration.static_projection import nearest_admissible
from isotorque.learning.static_torques import static_torque_set
from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet
from isotorque.symbolic.common.errors import InputError
from tests.learning.static_data import known_potential

seeds = st.integers(0, 2**32 - 1)


@given(seeds, st.integers(1, 5), st.integers(1, 80))
def test_every_stored_torque_is_admitted_and_its_own_nearest(seed, n, count):
    rng = np.random.default_rng(seed)
    held = StaticTorqueSet(n)
    held.add(rng.normal(size=(count, n)) * 10.0 ** rng.uniform(-2, 2, n))
    assert held.contains(held.torques).all()
    np.testing.assert_array_equal(held.nearest(held.torques), held.torques)


@given(seeds, st.integers(1, 4))
def test_torques_beyond_all_held_ones_are_not_admitted(seed, n):
    rng = np.random.default_rng(seed)
    torques = rng.uniform(-1.0, 1.0, (60, n)) * [20.0, 5.0, 1.0, 0.3][:n]
    held = StaticTorqueSet(n)
    held.add(torques)
    assert not held.contains(3.0 * torques[np.abs(torques).argmax(axis=0)]).any()


@given(seeds, st.integers(1, 3))
def test_nearest_is_nearest_in_units_of_the_range(seed, n):
    rng = np.random.default_rng(seed)
    held = StaticTorqueSet(n, resolution=1e-6)
    held.add(rng.uniform(-1.0, 1.0, (50, n)) * 2.0 ** np.arange(n))
    scale = 2.0 ** np.ceil(np.log2(np.ptp(held.torques, axis=0)))
    for query in rng.uniform(-2.0, 2.0, (20, n)) * 2.0 ** np.arange(n):
        distance = np.linalg.norm((held.torques - query) / scale, axis=1)
        np.testing.assert_array_equal(held.nearest(query), held.torques[distance.argmin()])


@given(seeds, st.integers(1, 3), st.lists(st.booleans(), min_size=1, max_size=6))
def test_the_last_observation_of_a_torque_wins(seed, n, observations):
    rng = np.random.default_rng(seed)
    held = StaticTorqueSet(n)
    held.add(rng.normal(size=(30, n)))
    torque = rng.normal(size=n)
    for was_held in observations:
        if was_held:
            held.add(torque)
        else:
            held.mark_inadmissible(torque)
    if not observations[-1]:
        assert not held.contains(torque)
        assert (held.nearest(torque) != torque).any()
    elif False not in observations:
        assert held.contains(held.nearest(torque))


def test_nearest_never_gives_a_torque_that_failed_last():
    held = StaticTorqueSet(2)
    held.add([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    held.mark_inadmissible([1.0, 1.0])
    assert held.nearest([1.1, 1.1]).tolist() in ([1.0, 0.0], [0.0, 1.0])
    assert len(held) == 3


def test_bulk_and_single_updates_store_the_same_torques():
    torques = np.random.default_rng(5).normal(size=(500, 3))
    bulk, single = StaticTorqueSet(3), StaticTorqueSet(3)
    bulk.add(torques[:1])
    bulk.add(torques)
    for torque in torques:
        single.add(torque)
    # the range is known earlier in bulk: cells differ a little, the region does not
    probe = np.random.default_rng(6).normal(size=(4000, 3)) * 1.5
    assert abs(len(bulk) - len(single)) < 0.1 * len(bulk)
    bulk.region(), single.region()
    assert (bulk.contains(probe) == single.contains(probe)).mean() > 0.98


def limited_arm():
    """2R arm with limits that make its set of static torques non-convex."""
    potential, _ = known_potential("2r")
    return potential, np.array([-1.0, -2.0]), np.array([2.0, 1.2])


def test_agrees_with_the_true_set_of_a_limited_arm():
    potential, low, high = limited_arm()
    rng = np.random.default_rng(0)
    held = StaticTorqueSet(2)
    held.add(potential.gradient(rng.uniform(low, high, (3000, 2))))
    edges = [np.linspace(-30, 30, 121), np.linspace(-8, 8, 121)]
    fine = np.stack(np.meshgrid(*np.linspace(low, high, 1200).T), axis=-1).reshape(-1, 2)
    image = potential.gradient(fine)
    true = np.histogram2d(image[:, 0], image[:, 1], bins=edges)[0] > 0
    centres = [0.5 * (e[1:] + e[:-1]) for e in edges]
    grid = np.stack(np.meshgrid(*centres, indexing="ij"), axis=-1).reshape(-1, 2)
    found = held.contains(grid).reshape(true.shape)
    assert (found & true).sum() > 0.9 * true.sum()
    assert (found & ~true).sum() < 0.01 * true.sum()
    # the convex hull of the same torques would admit much more
    hull = static_torque_set.AlphaShape(image[::97] / [32.0, 16.0], edge_factor=1e9)
    admitted = hull.contains(grid / [32.0, 16.0]).reshape(true.shape)
    assert (admitted & ~true).sum() > 3 * (found & ~true).sum()


def test_an_inadmissible_torque_carves_out_its_neighbourhood_only():
    rng = np.random.default_rng(1)
    held = StaticTorqueSet(2)
    held.add(rng.uniform(-1, 1, (400, 2)))
    held.mark_inadmissible([0.2, 0.2])
    assert not held.contains([0.2, 0.2])
    assert not held.contains([0.201, 0.2])
    assert held.contains([0.6, 0.2])
    assert held.inadmissible.tolist() == [[0.2, 0.2]]


def test_admit_changes_only_inadmissible_torques():
    held = StaticTorqueSet(2)
    held.add(np.random.default_rng(2).uniform(-1, 1, (300, 2)))
    np.testing.assert_array_equal(held.admit([0.1, 0.2]), [0.1, 0.2])
    moved = held.admit([4.0, 0.0])
    assert (held.torques == moved).all(axis=1).any()


def test_a_free_joint_must_have_its_one_torque():
    rng = np.random.default_rng(3)
    torques = np.zeros((300, 4))
    torques[:, 1:3] = rng.uniform(-1, 1, (300, 2))
    held = StaticTorqueSet(4)
    held.add(torques)
    assert held.active.tolist() == [False, True, True, False]
    assert held.contains([0.0, 0.1, 0.2, 0.0])
    assert not held.contains([0.3, 0.1, 0.2, 0.0])
    points, simplices = held.region()
    assert points.shape[1] == 2
    assert simplices.shape[1] == 3


def test_beyond_three_joints_neighbours_cover():
    rng = np.random.default_rng(4)
    torques = rng.normal(size=(4000, 4))
    torques /= np.linalg.norm(torques, axis=1, keepdims=True)  # a hollow sphere
    held = StaticTorqueSet(4)
    held.add(torques)
    other = rng.normal(size=(500, 4))
    other /= np.linalg.norm(other, axis=1, keepdims=True)
    assert held.contains(other).mean() > 0.9
    assert not held.contains(0.3 * other).any()
    assert held.region()[0].size == 0


def test_what_is_stored_and_rebuilt_stays_bounded(monkeypatch):
    built = []
    original = static_torque_set.AlphaShape
    monkeypatch.setattr(
        static_torque_set,
        "AlphaShape",
        lambda points, factor: (built.append(len(points)), original(points, factor))[1],
    )
    rng = np.random.default_rng(7)
    held = StaticTorqueSet(2, resolution=1 / 32)
    for torque in rng.uniform(-1.0, 1.0, (3000, 2)):
        held.add(torque)
        held.contains(torque)
    assert len(held) <= 33**2
    # rebuilt when grown by a quarter: a constant number of points per update
    assert sum(built) < 6 * len(held) + 200


def test_one_torque_is_admitted_alone():
    held = StaticTorqueSet(2)
    assert held.contains([0.0, 0.0]) is False
    held.add([1.0, 2.0])
    assert held.contains([1.0, 2.0]) is True
    assert held.contains([1.0, 2.1]) is False
    assert held.active.tolist() == [False, False]


def test_bad_input_names_the_field():
    with pytest.raises(InputError, match="number of joints"):
        StaticTorqueSet(0)
    with pytest.raises(InputError, match="resolution"):
        StaticTorqueSet(2, resolution=2.0)
    held = StaticTorqueSet(2)
    with pytest.raises(InputError, match="shape of torque"):
        held.add([1.0, 2.0, 3.0])
    with pytest.raises(InputError, match="finite"):
        held.contains([np.nan, 1.0])
    with pytest.raises(InputError, match="number of held torques"):
        held.nearest([1.0, 1.0])


def test_the_set_grows_to_its_border_while_few_torques_fail():
    rng = np.random.default_rng(8)
    half = np.array([16.0, 4.0])  # the true set: a box
    held = StaticTorqueSet(2, resolution=1 / 64)
    held.add(rng.uniform(-0.8, 0.8, (400, 2)) * half)
    before = np.prod(np.ptp(held.torques, axis=0) / (2 * half))
    failed = 0
    for _ in range(500):
        wanted = nearest_admissible(held, rng.choice([-1.2, 1.2]) * rng.random(2) * half, True)
        if (np.abs(wanted) <= half).all():
            held.add(wanted)
        else:
            failed += 1
            held.mark_inadmissible(wanted)
    assert failed <= 2 + 0.008 * (400 + 500)
    assert np.prod(np.ptp(held.torques, axis=0) / (2 * half)) > before + 0.15


def test_nothing_is_tried_beyond_the_mesh_while_too_many_admitted_torques_failed():
    rng = np.random.default_rng(10)
    held = StaticTorqueSet(2, resolution=1 / 16)
    held.add(rng.uniform(-1, 1, (100, 2)))
    corner = held.torques[held.torques.sum(axis=1).argmax()]
    beyond = corner + 1e-3
    assert held.contains(beyond)
    for inside in ([0.0, 0.0], [-0.5, 0.1], [0.2, -0.4]):
        held.mark_inadmissible(inside)
    assert not held.contains(beyond)
    held.add(rng.uniform(-0.9, 0.9, (400, 2)))
    assert held.contains(beyond)


def test_near_the_border_torques_are_stored_closer_together_but_not_without_end():
    rng = np.random.default_rng(9)
    held = StaticTorqueSet(2, resolution=1 / 16)
    held.add(rng.uniform(-1, 1, (600, 2)))
    before = len(held)
    held.mark_inadmissible([0.2, 0.2])
    held.add(rng.uniform(0.15, 0.25, (500, 2)))
    near = np.linalg.norm(held.torques - [0.2, 0.2], axis=1) < 0.05
    assert near.sum() > 10
    held.add(rng.uniform(0.15, 0.25, (5000, 2)))
    assert len(held) - before < 400
