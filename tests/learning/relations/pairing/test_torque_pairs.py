import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.relations.pairing.torque_pairs import group_by_torque, pairs_by_signs


@given(st.integers(0, 2**32 - 1), st.integers(1, 3), st.integers(1, 5), st.integers(1, 6))
def test_pairs_have_one_torque_up_to_the_stated_signs(seed, n, torques, copies):
    rng = np.random.default_rng(seed)
    magnitude = np.repeat(rng.uniform(1.0, 2.0, (torques, n)), copies, axis=0)
    tau = magnitude * rng.choice([-1.0, 1.0], magnitude.shape)
    groups = group_by_torque(rng.normal(size=tau.shape), tau, 1e-9, 0.05)
    assert groups.count == torques
    kinds = pairs_by_signs(groups)
    for pairs in kinds:
        np.testing.assert_array_equal(tau[pairs.s], pairs.Y * tau[pairs.r])
        np.testing.assert_array_equal(pairs.q_r, groups.q[pairs.r])
        np.testing.assert_array_equal(pairs.torque, groups.torque[pairs.s])
        assert (pairs.r != pairs.s).all()
    assert sum(len(pairs) for pairs in kinds) == torques * copies * (copies - 1)
    assert len({tuple(pairs.Y) for pairs in kinds}) == len(kinds)


@given(st.integers(0, 2**32 - 1), st.integers(1, 3), st.integers(1, 40))
def test_samples_are_sorted_as_if_each_were_compared_with_all_others(seed, n, count):
    rng = np.random.default_rng(seed)
    tau = rng.integers(1, 6, (count, n)) * rng.choice([-1.0, 1.0], (count, n))
    tau += 0.1 * rng.uniform(-1.0, 1.0, tau.shape)
    label, distinct = np.full(count, -1), []
    for i, torque in enumerate(np.abs(tau)):
        if label[i] < 0:
            alike = (np.abs(np.abs(tau) - torque) <= 0.1).all(axis=1) & (label < 0)
            label[alike] = len(distinct)
            distinct.append(np.abs(tau)[alike].mean(axis=0))
    groups = group_by_torque(rng.normal(size=tau.shape), tau, 0.1, 0.05)
    np.testing.assert_array_equal(groups.torque, label)
    np.testing.assert_array_equal(groups.magnitudes, distinct)
    seen = [pair for pairs in pairs_by_signs(groups) for pair in zip(pairs.r, pairs.s, strict=True)]
    alike = (label[:, None] == label) & ~np.eye(count, dtype=bool)
    assert sorted(seen) == list(zip(*np.nonzero(alike), strict=True))


def test_torques_within_the_tolerance_are_one():
    tau = np.array([[1.0, 2.0], [-1.0005, 2.0004], [1.5, 2.0]])
    q = np.zeros((3, 2))
    assert group_by_torque(q, tau, 1e-2, 0.05).torque.tolist() == [0, 0, 1]
    assert group_by_torque(q, tau, 1e-5, 0.05).torque.tolist() == [0, 1, 2]


def test_components_near_zero_are_left_out():
    tau = np.array([[1.0, 2.0], [1.0, -0.01], [0.0, 2.0]])
    groups = group_by_torque(np.zeros((3, 2)), tau, 1e-6, 0.05)
    assert groups.left_out == 2
    assert groups.count == 1
    assert pairs_by_signs(groups) == []


def test_no_samples_make_no_groups():
    groups = group_by_torque(np.zeros((0, 2)), np.zeros((0, 2)), 1e-6, 0.05)
    assert groups.count == 0
    assert pairs_by_signs(groups) == []
