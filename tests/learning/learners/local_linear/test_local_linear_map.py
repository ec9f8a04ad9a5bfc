"""Tests of the local linear map against Eq. 17-22 written down a second time, slowly."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.peers.literal_map import LiteralMap
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.symbolic.common.errors import InputError
from tests.learning.learners import planar_arm

GROUP = planar_arm.group()


def walk(rng, samples, joints):
    """Samples that stay in reach of each other, with some jumps, as exploration makes them."""
    steps = rng.normal(0, 0.12, (samples, joints))
    steps[rng.random(samples) < 0.1] *= 12
    q = np.cumsum(steps, axis=0)
    return q, np.stack([np.sin(q @ rng.normal(size=joints)) * 5 for _ in range(joints)], axis=1)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    joints=st.sampled_from([1, 2, 3]),
    kappa=st.sampled_from([1.0, 1.5]),
    iterations=st.sampled_from([1, 3]),
)
def test_equals_the_printed_equations(seed, joints, kappa, iterations):
    """Offsets, slopes and estimates equal Eq. 17-22 to 1e-12, sample weights included."""
    rng = np.random.default_rng(seed)
    q, torque = walk(rng, 60, joints)
    weights = rng.random(60)
    slow = LiteralMap(0.3, 0.4, kappa, iterations, distance=np.eye(joints))
    for sample in zip(q, torque, weights, strict=True):
        slow.learn(*sample)
    fast = LocalLinearMap(
        0.3, learning_rate=0.4, kernel_width=kappa, inner_iterations=iterations, cutoff=6.5
    ).fit(q, torque, weights)
    assert fast.n_prototypes_ == len(slow.prototypes)
    assert np.abs(fast.offsets_ - slow.o).max() < 1e-12
    assert np.abs(fast.slopes_ - slow.W).max() < 1e-12
    queries = q[::7] + rng.normal(0, 0.1, q[::7].shape)
    expected = np.array([slow.value(x) for x in queries])
    assert np.abs(fast.predict(queries) - expected).max() < 1e-12


def test_equals_the_printed_equations_for_every_symmetric_copy():
    """With a group: all copies in order, distances in the averaged metric."""
    rng = np.random.default_rng(5)
    q = rng.uniform(-np.pi, np.pi, (80, 2))
    torque = planar_arm.torque(q)
    metric = sum(A.T @ A for A in GROUP.A_sat)
    distance = np.linalg.cholesky(metric / np.sqrt(np.linalg.det(metric))).T
    slow = LiteralMap(0.3, 0.5, distance=distance)
    for x, tau in zip(q, torque, strict=True):
        for A, d, Y in zip(GROUP.A_sat, GROUP.d_sat, GROUP.Y, strict=True):
            slow.learn(A @ x + d, Y * tau)
    fast = LocalLinearMap(0.3, group=GROUP, cutoff=6.5).fit(q, torque)
    assert np.abs(fast.slopes_ - slow.W).max() < 1e-12
    expected = np.array([slow.value(x) for x in q[:20]])
    assert np.abs(fast.predict(q[:20]) - expected).max() < 1e-12


@pytest.mark.parametrize("iterations", [1, 2, 30])
@pytest.mark.parametrize("kernel_width", [1.0, 2.0])
def test_inner_iterations_in_closed_form_equal_the_loop(iterations, kernel_width):
    """LLM_it: k steps at once are k steps one by one (wide kernels see images twice)."""
    rng = np.random.default_rng(1)
    q = rng.uniform(-np.pi, np.pi, (300, 2))
    both = [
        LocalLinearMap(
            0.5, inner_iterations=iterations, kernel_width=kernel_width, group=GROUP, looped=looped
        ).fit(q, planar_arm.torque(q))
        for looped in (False, True)
    ]
    assert np.abs(both[0].predict(q) - both[1].predict(q)).max() < 1e-10


def test_iterating_to_the_end_takes_the_error_away():
    """With inner_iterations=None the last sample is reproduced, with many steps nearly so."""
    rng = np.random.default_rng(2)
    q = rng.uniform(-1, 1, (100, 2))
    for iterations, tolerance in ((None, 1e-12), (200, 1e-6)):
        learner = LocalLinearMap(0.2, inner_iterations=iterations).fit(q, planar_arm.torque(q))
        assert np.abs(learner.predict(q[-1:]) - planar_arm.torque(q[-1])).max() < tolerance


def test_inserting_keeps_the_estimate_and_its_slope_near_but_not_far():
    """Eq. 19: value and Jacobian stay at a new prototype; Eq. 22: beyond 2 d the sample counts."""
    rng = np.random.default_rng(3)
    q = rng.uniform(-1, 1, (400, 2))
    learner = LocalLinearMap(0.4, inner_iterations=None).fit(q, planar_arm.torque(q))
    near = np.array([[1.0, 1.0]]) + 0.45
    value, slope = learner.predict(near), learner.jacobian(near)
    before = learner.n_prototypes_
    learner.partial_fit(near, planar_arm.torque(near), [0.0])
    assert learner.n_prototypes_ == before + 1
    assert np.abs(learner.offsets_[-1] - value).max() < 1e-12
    assert np.abs(learner.slopes_[-1] - 0.4 * slope).max() < 1e-12
    far = np.array([[3.0, 3.0]])
    learner.partial_fit(far, [[7.0, -7.0]], [0.0])
    assert learner.offsets_[-1].tolist() == [7.0, -7.0]
    assert not learner.slopes_[-1].any()


def test_jacobian_is_the_derivative_of_the_estimate():
    """Against central differences, in joint coordinates and with a group's metric."""
    rng = np.random.default_rng(4)
    q = rng.uniform(-np.pi, np.pi, (500, 2))
    learner = LocalLinearMap(0.4, group=GROUP, kernel_width=1.5).fit(q, planar_arm.torque(q))
    exact = learner.jacobian(q[:30])
    for joint in range(2):
        step = np.eye(2)[joint] * 1e-5
        difference = (learner.predict(q[:30] + step) - learner.predict(q[:30] - step)) / 2e-5
        assert np.abs(difference - exact[:, :, joint]).max() < 1e-4


@pytest.mark.parametrize("options", [{"radius": 0.15}, {"kernel_width": 2.0, "radius": 0.3}])
def test_learns_the_whole_torus_from_a_quarter(options):
    """Samples where the arm can hold itself only; judged everywhere."""
    rng = np.random.default_rng(0)
    sums = np.stack([rng.uniform(-np.pi / 2, 0, 8000), rng.uniform(-np.pi, 0, 8000)], axis=1)
    q = np.stack([sums[:, 0], sums[:, 1] - sums[:, 0]], axis=1)
    learner = LocalLinearMap(group=GROUP, **options).fit(q, planar_arm.torque(q))
    dense = rng.uniform(-np.pi, np.pi, (1500, 2))
    error = learner.predict(dense) - planar_arm.torque(dense)
    assert np.sqrt(np.mean(error**2)) < 0.03
    turned = learner.predict(dense + 2 * np.pi * rng.integers(-3, 4, dense.shape))
    assert np.abs(turned - learner.predict(dense)).max() < 1e-9


def test_a_wide_cutoff_hardly_changes_the_default():
    """The default cutoff of four kernel widths against the printed sum over all prototypes."""
    rng = np.random.default_rng(6)
    q = rng.uniform(-np.pi, np.pi, (3000, 2))
    narrow, wide = (
        LocalLinearMap(0.2, cutoff=cutoff).fit(q, planar_arm.torque(q)) for cutoff in (4.0, 6.5)
    )
    assert np.abs(narrow.predict(q) - wide.predict(q)).max() < 1e-4


def test_pieces_and_a_stop_in_the_middle_change_nothing():
    """Samples one by one, and saved and restored halfway, give the same map bit by bit."""
    rng = np.random.default_rng(7)
    q = rng.uniform(-np.pi, np.pi, (200, 2))
    torque = planar_arm.torque(q)
    options = {"radius": 0.3, "replay": 3, "memory": 50, "group": GROUP, "inner_iterations": None}
    whole = LocalLinearMap(**options).fit(q, torque)
    pieces = LocalLinearMap(**options)
    for i in range(120):
        pieces.partial_fit(q[i : i + 1], torque[i : i + 1])
    saved = json.loads(json.dumps(pieces.parameters()))
    resumed = LocalLinearMap.from_arrays(pieces.to_arrays(), saved)
    assert np.abs(resumed.predict(q) - pieces.predict(q)).max() < 1e-12
    resumed.partial_fit(q[120:], torque[120:])
    assert resumed.n_prototypes_ == whole.n_prototypes_
    assert resumed.n_samples_seen_ == 200
    assert np.abs(resumed.predict(q) - whole.predict(q)).max() < 1e-9


def test_survives_constant_targets_and_repeated_samples():
    """Nothing diverges and nothing grows when there is nothing to learn."""
    q = np.tile([[0.3, -0.2]], (2000, 1))
    learner = LocalLinearMap(replay=2).fit(q, np.tile([[1.0, 2.0]], (2000, 1)))
    assert learner.n_prototypes_ == 1
    assert np.abs(learner.predict(q[:1]) - [1.0, 2.0]).max() < 1e-12


def test_survives_samples_far_apart():
    """Angles a million radians apart are angles; a query far from all samples is answered."""
    q = np.array([[0.0, 0.0], [1e6 + 1, -1e6], [2e6, 1e6 + 3]])
    learner = LocalLinearMap().fit(q, planar_arm.torque(q))
    assert np.abs(learner.predict(q) - planar_arm.torque(q)).max() < 1e-9
    assert np.isfinite(learner.predict([[3.0, 3.0]])).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_refuses_what_is_no_number_and_stays_as_it_was(bad):
    """NaN in any argument: one clear line, nothing learned."""
    learner = LocalLinearMap().fit([[0.0, 0.0]], [[1.0, 2.0]])
    for arguments in (
        ([[bad, 0.0]], [[1.0, 2.0]]),
        ([[1.0, 0.0]], [[1.0, bad]]),
        ([[1.0, 0.0]], [[1.0, 2.0]], [bad]),
    ):
        with pytest.raises(InputError, match="finite"):
            learner.partial_fit(*arguments)
    with pytest.raises(InputError, match="finite"):
        learner.predict([[bad, 0.0]])
    assert learner.n_samples_seen_ == 1


@pytest.mark.parametrize(
    "options",
    [
        {"radius": 0.0},
        {"kernel_width": -1.0},
        {"inner_iterations": 0},
        {"looped": True, "inner_iterations": None},
        {"relaxation": 2.5},
        {"replay": -1},
        {"cutoff": 1.0},
    ],
)
def test_refuses_unusable_settings(options):
    """Each unusable setting is named."""
    with pytest.raises(InputError, match=next(iter(options))):
        LocalLinearMap(**options).fit([[0.0, 0.0]], [[1.0, 2.0]])


def test_refuses_a_group_of_another_arm():
    """A group for two joints cannot be used with three."""
    with pytest.raises(InputError, match="joints"):
        LocalLinearMap(group=GROUP).fit(np.zeros((1, 3)), np.zeros((1, 3)))
