"""Tests of equivariant trigonometric regression: exact from few samples, equivariant always."""

import itertools
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.equivariant_basis import (
    multi_affine_frequencies,
    torque_basis,
)
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates
from isotorque.learning.sampling.lattice import lattice_samples
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.learning.learners import planar_arm
from tests.learning.learners.random_groups import groups, worst_asymmetry


def rms_error(learner, gravity):
    q = np.random.default_rng(99).uniform(-np.pi, np.pi, (1500, gravity.n))
    return np.sqrt(np.mean((learner.predict(q) - gravity.torque(q)) ** 2))


@pytest.mark.parametrize(
    ("robot", "potential", "samples"),
    [
        ("2r", True, 1),
        ("2r", False, 2),
        ("3r", True, 1),
        ("3r", False, 4),
        ("4r-planar", True, 1),
        ("ur5", True, 2),
        ("ur5", False, 6),
    ],
)
def test_exact_from_a_handful_of_samples(robot, potential, samples):
    gravity = GravityModel(load_robot(robot))
    group = primary_symmetries(gravity.potential)
    region = SamplingRegion.of_domain(FundamentalDomain(group))
    for seed in range(3):
        q = lattice_samples(region, samples, np.random.default_rng(seed)).q
        learner = EquivariantTrigonometric(potential, group=group).fit(q, gravity.torque(q))
        assert rms_error(learner, gravity) < 1e-12


@pytest.mark.parametrize(("potential", "samples"), [(True, 9), (False, 27)])
def test_exact_without_a_group_from_more(potential, samples):
    gravity = GravityModel(load_robot("3r"))
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (samples, 3))
    learner = EquivariantTrigonometric(potential).fit(q, gravity.torque(q))
    assert rms_error(learner, gravity) < 1e-9


@given(group=groups(), seed=st.integers(0, 2**32 - 1), potential=st.booleans())
def test_equivariant_whatever_was_learned(group, seed, potential):
    rng = np.random.default_rng(seed)
    q, labels = rng.uniform(-np.pi, np.pi, (2, 20, group.n))
    learner = EquivariantTrigonometric(potential, group=group, ridge=1e-3).fit(q, labels)
    assert worst_asymmetry(learner.predict, group, q[:4]) < 1e-12


@settings(max_examples=25)
@given(group=groups(max_joints=2), sign=st.integers(0, 1))
def test_the_basis_holds_all_functions_there_are(group, sign):
    """Dimension and span as a numerical null space of the conditions says."""
    coordinates = SymmetryCoordinates.of(group, group.n)
    column = group.Y[:, min(sign, group.n - 1)]
    k = multi_affine_frequencies(coordinates.basis)
    y = np.random.default_rng(0).uniform(-np.pi, np.pi, (60, group.rank))

    def features(y):
        return np.concatenate([np.cos(y @ k.T), np.sin(y @ k.T)], axis=1)

    conditions = np.concatenate(
        [
            features(y @ A.T + d) - s * features(y)
            for A, d, s in zip(group.A_sat, group.d_sat, column, strict=True)
        ]
    )
    _, values, rows = np.linalg.svd(conditions)
    # the sine of frequency 0 is no function
    null = int(np.sum(values < 1e-9 * max(values.max(), 1.0)) + 2 * len(k) - len(values))
    basis = torque_basis(coordinates, k, column)
    # sin 0 = 0 satisfies everything, in the null space; the basis may have it as well
    used = np.abs(features(y) @ basis).max(axis=0) > 1e-9 if basis.size else np.zeros(0, bool)
    assert used.sum() == null - 1
    assert np.abs(conditions @ basis).max(initial=0.0) < 1e-9
    assert rows.shape[1] == 2 * len(k)


@given(rank=st.integers(1, 3), seed=st.integers(0, 2**32 - 1))
def test_frequencies_are_those_that_use_no_joint_twice(rank, seed):
    rng = np.random.default_rng(seed)
    basis = rng.integers(-1, 2, (rank, rank + 1))
    if np.linalg.matrix_rank(basis) < rank:
        return
    found = {tuple(row) for row in multi_affine_frequencies(basis).tolist()}
    for kappa in itertools.product(range(-4, 5), repeat=rank):
        admitted = np.abs(np.array(kappa) @ basis).max() <= 1
        assert admitted == (kappa in found or tuple(-x for x in kappa) in found)
    assert not any(tuple(-x for x in kappa) in found for kappa in found if any(kappa))


@pytest.mark.parametrize("potential", [True, False])
def test_jacobian_is_the_stiffness(potential):
    gravity = GravityModel(load_robot("3r"))
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (40, 3))
    learner = EquivariantTrigonometric(potential).fit(q, gravity.torque(q))
    assert np.abs(learner.jacobian(q) - gravity.stiffness(q)).max() < 1e-9


def test_the_potential_is_the_arms():
    gravity = GravityModel(load_robot("2r"))
    q = np.random.default_rng(2).uniform(-np.pi, np.pi, (6, 2))
    learner = EquivariantTrigonometric().fit(q, gravity.torque(q))
    difference = learner.fitted_potential() - gravity.potential.to_float()
    assert difference.gradient_bound().max() < 1e-10
    with pytest.raises(InputError, match="potential"):
        EquivariantTrigonometric(False).fit(q, gravity.torque(q)).fitted_potential()


def test_noise_is_averaged_out():
    """With the group the error is far below that of the samples, and of the fit without."""
    gravity = GravityModel(load_robot("2r"))
    group = primary_symmetries(gravity.potential)
    rng = np.random.default_rng(3)
    q = rng.uniform(-np.pi, np.pi, (100, 2))
    noisy = gravity.torque(q) + rng.normal(0, 0.1, q.shape)
    errors = [
        rms_error(EquivariantTrigonometric(group=g).fit(q, noisy), gravity) for g in (group, None)
    ]
    assert errors[0] < 0.03
    assert errors[0] < errors[1] < 0.1


@pytest.mark.parametrize("potential", [True, False])
def test_saved_and_restored(potential):
    rng = np.random.default_rng(4)
    group = primary_symmetries(GravityModel(load_robot("ur5")).potential)
    q = rng.uniform(-np.pi, np.pi, (10, 6))
    learner = EquivariantTrigonometric(potential, group=group).fit(q, rng.normal(size=q.shape))
    saved = json.loads(json.dumps(learner.parameters()))
    again = EquivariantTrigonometric.from_arrays(learner.to_arrays(), saved)
    assert np.array_equal(again.predict(q), learner.predict(q))
    wrong = learner.to_arrays() | {"frequencies": np.zeros((1, 6))}
    with pytest.raises(InputError, match="frequencies"):
        EquivariantTrigonometric.from_arrays(wrong, saved)


def test_weights_and_single_columns():
    q = np.random.default_rng(5).uniform(-np.pi, np.pi, (20, 1))
    torque = np.cos(q[:, 0])
    wrong = np.append(torque, 100.0)
    learner = EquivariantTrigonometric(potential=False)
    learner.fit(np.append(q, [[0.3]], axis=0), wrong, np.append(np.ones(20), 0.0))
    assert learner.predict(q) == pytest.approx(torque)


def test_refuses_what_does_not_fit():
    with pytest.raises(InputError, match="ridge"):
        EquivariantTrigonometric(ridge=-1.0).fit([[0.0]], [[1.0]])
    with pytest.raises(InputError, match="infinity"):
        EquivariantTrigonometric().fit([[0.0]], [[np.inf]])
    with pytest.raises(InputError, match="number of columns"):
        EquivariantTrigonometric(group=planar_arm.group()).fit([[0.0, 0.0]], [[1.0]])
