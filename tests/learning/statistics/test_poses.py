"""Rows of one pose are found whatever the jitter, and rows that nobody repeated stay apart."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.statistics.poses import WIDEST, group_poses
from isotorque.symbolic.common.errors import InputError

seeds = st.integers(0, 2**32 - 1)


def spaced_poses(rng, count, joints):
    """Poses at least 0.3 rad apart from each other in some joint, modulo a turn."""
    poses = np.empty((0, joints))
    while len(poses) < count:
        new = rng.uniform(-np.pi, np.pi, joints)
        away = np.abs(np.angle(np.exp(1j * (poses - new)))).max(axis=1, initial=0.0)
        if len(poses) == 0 or away.min() > 0.3:
            poses = np.concatenate([poses, new[None]])
    return poses


@given(seeds, st.integers(2, 5), st.integers(4, 12), st.integers(2, 25), st.floats(-7.0, -3.6))
@settings(max_examples=25)
def test_repeated_poses_are_found_at_any_jitter_and_turn(seed, joints, count, repeats, jitter):
    rng = np.random.default_rng(seed)
    poses = spaced_poses(rng, count, joints)
    label = np.repeat(np.arange(count), repeats)
    q = poses[label] + 10.0**jitter * rng.uniform(-1.0, 1.0, (len(label), joints))
    shuffled = rng.permutation(len(label))
    turned = q[shuffled] + 2.0 * np.pi * rng.integers(-2, 3, q.shape)
    found = group_poses(turned)
    assert found.count == count
    assert len(set(zip(found.label.tolist(), label[shuffled].tolist(), strict=True))) == count
    assert found.rows.sum() == len(label)


@given(seeds, st.integers(1, 7), st.integers(2, 400))
@settings(max_examples=25)
def test_rows_that_nobody_repeated_stay_apart(seed, joints, count):
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, joints))
    assert group_poses(q).count == count


def test_a_slow_sweep_is_no_pose():
    sweep = np.linspace(-2.0, 2.0, 1000)[:, None] * [1.0, 0.5]
    assert group_poses(sweep).count == 1000
    assert group_poses(np.concatenate([sweep, sweep + np.array([0.5, 0.0])])).count == 2000


def test_exact_repetitions_are_one_pose_however_few():
    q = np.random.default_rng(0).uniform(-3.0, 3.0, (20, 2))
    found = group_poses(np.concatenate([q, q[:1], q[3:4] + 2.0 * np.pi]))
    assert found.count == 20
    assert found.label[20] == 0
    assert found.label[21] == 3


def test_turns_count_where_a_joint_does_not_turn_on():
    q = np.repeat(np.random.default_rng(0).uniform(-1.0, 1.0, (6, 2)), 2, axis=0)
    q[1::2, 1] += 2.0 * np.pi
    assert group_poses(q).count == 6
    assert group_poses(q, [True, False]).count == 12


def test_means_and_scatter_are_those_of_numpy():
    rng = np.random.default_rng(1)
    poses = spaced_poses(rng, 5, 2)
    poses[0] = [np.pi, -np.pi]  # rows on both sides of the cut
    q = np.repeat(poses, 40, axis=0) + 1e-4 * rng.normal(size=(200, 2))
    wrapped = np.angle(np.exp(1j * q))
    values = rng.normal(size=(200, 2))
    found = group_poses(wrapped)
    assert found.count == 5
    groups = values.reshape(5, 40, 2)
    np.testing.assert_allclose(found.means(values), groups.mean(axis=1))
    deviation, freedom = found.spread(values)
    assert freedom == 195
    pooled = np.sqrt(groups.var(axis=1, ddof=1).mean(axis=0))
    np.testing.assert_allclose(deviation, pooled)
    off = np.angle(np.exp(1j * (found.configurations(wrapped) - poses)))
    assert np.abs(off).max() < 1e-4


def test_wide_groups_are_not_taken_for_poses():
    rng = np.random.default_rng(2)
    poses = spaced_poses(rng, 6, 3)
    q = np.repeat(poses, 30, axis=0) + 2.0 * WIDEST * rng.uniform(-1.0, 1.0, (180, 3))
    assert group_poses(q).count > 6


def test_nothing_is_one_pose_or_none():
    assert group_poses(np.empty((0, 2))).count == 0
    assert group_poses([[0.1, 0.2]]).count == 1
    with pytest.raises(InputError, match="finite"):
        group_poses([[np.nan]])


@given(st.integers(0, 2**32 - 1), st.integers(1, 30))
def test_poses_are_split_where_values_differ(seed, rows):
    rng = np.random.default_rng(seed)
    poses = group_poses(rng.integers(0, 3, (rows, 2)).astype(float))
    values = rng.choice([-1.0, 0.0, 1.0], (rows, 2))
    split = poses.split(values)
    for i in range(rows):
        for k in range(rows):
            alike = poses.label[i] == poses.label[k] and (values[i] == values[k]).all()
            assert (split.label[i] == split.label[k]) == alike
    assert split.label[split.first].tolist() == list(range(split.count))
    assert (np.diff(split.first) > 0).all()  # numbered as they come
