"""Approximate groups: bounds are never exceeded, groups grow with the tolerance."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.approximate_symmetries import maximal_groups
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.testing.strategies import kinematic_trees

amounts = st.floats(1e-4, 0.3)


def disturbed(potential, amount, seed):
    """Change every coefficient, and add a small term, by about ``amount``."""
    rng = np.random.default_rng(seed)
    m = len(potential)
    f = potential.to_float()
    return TrigonometricPolynomial(
        f.frequencies,
        f.cos + amount / max(m, 1) * rng.uniform(-1, 1, m),
        f.sin + amount / max(m, 1) * rng.uniform(-1, 1, m),
    )


@given(kinematic_trees(min_joints=1, max_joints=3, planted=True), amounts, st.integers(0, 99))
@settings(max_examples=40)
def test_bounds_hold_and_groups_close(tree, tolerance, seed):
    potential = disturbed(derive_potential(tree), tolerance, seed)
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (200, potential.n))
    torque = potential.gradient(q)
    groups = maximal_groups(potential, tolerance)
    assert groups[0].order == max(g.order for g in groups)
    for group in groups:
        assert group.is_closed
        for relation in group:
            error = np.abs(potential.gradient(relation.configuration(q)) - relation.torque(torque))
            assert np.all(error <= relation.bound + 1e-12)
            assert np.all(relation.bound <= tolerance + 1e-12)


@given(kinematic_trees(min_joints=1, max_joints=3, planted=True), st.integers(0, 99))
@settings(max_examples=30)
def test_the_true_group_comes_back_from_a_slightly_disturbed_arm(tree, seed):
    potential = derive_potential(tree)
    if not len(potential) or potential.amplitudes().min() < 0.5:
        return
    true = primary_symmetries(potential)
    found = maximal_groups(disturbed(potential, 1e-3, seed), 0.05)[0]
    assert found.order >= true.order


@given(kinematic_trees(min_joints=1, max_joints=3), st.floats(1e-3, 1.0), st.floats(1.0, 4.0))
@settings(max_examples=30)
def test_the_largest_group_grows_with_the_tolerance(tree, tolerance, factor):
    potential = derive_potential(tree)
    small, large = (maximal_groups(potential, t) for t in (tolerance, tolerance * factor))
    assert max(g.order * 10 ** (potential.n - g.rank) for g in large) >= max(
        g.order * 10 ** (potential.n - g.rank) for g in small
    )


def test_one_small_phase_error_is_averaged_away():
    U = TrigonometricPolynomial([[1, 0], [1, 1], [2, 1]], [0.0, 0.01, 0.002], [18.4, 6.1, 0.0])
    assert primary_symmetries(U).order < 8
    group = primary_symmetries(U, tolerance=0.05)
    assert group.order == 8
    assert 0 < max(r.bound.max() for r in group) <= 0.05
    assert primary_symmetries(U, tolerance=1e-5).order == primary_symmetries(U).order


@pytest.mark.parametrize("tolerance", [1e-20, 1e-300, 5e-324])
def test_a_tolerance_below_rounding_gives_the_exact_group(tolerance):
    """Offsets that are no multiples of pi: not even the identity errs by less than rounding."""
    phases = np.array([0.3, 2.2e-5, 1.7])
    U = TrigonometricPolynomial(
        [[1, 0, 0], [1, 1, 0], [1, 1, 1]], 18.4 * np.cos(phases), 18.4 * np.sin(phases)
    )
    exact = primary_symmetries(U).order
    assert [g.order for g in maximal_groups(U, tolerance)] == [exact]
    assert primary_symmetries(U, tolerance).order == exact
