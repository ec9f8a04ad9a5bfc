"""Tests of the region that exploration uses against the domain it comes from and a QP solver."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from isotorque.learning.exploration.exploration_region import ExplorationRegion
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


@pytest.fixture(scope="module", params=["2r", "3r", "ur5"])
def domain(request):
    return FundamentalDomain(primary_symmetries(GravityModel(load_robot(request.param)).potential))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_contains_what_the_domain_contains(domain, seed):
    """Random points, full turns added, and points of the domain itself."""
    rng = np.random.default_rng(seed)
    region = ExplorationRegion(domain)
    n = domain.basis.shape[1]
    for q in rng.uniform(-np.pi, np.pi, (5, n)) + 2 * np.pi * rng.integers(-2, 3, (5, n)):
        assert region.contains(q) == domain.contains(q)
    for q in domain.sample(rng, 3):
        assert region.contains(q)


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_nearest_is_the_solution_of_the_quadratic_program(domain, seed):
    """SciPy's SLSQP on the half-spaces in the averaged metric finds the same point."""
    rng = np.random.default_rng(seed)
    region = ExplorationRegion(domain)
    inside = domain.sample(rng, 1)[0]
    outside = inside + rng.normal(0, 0.7, len(inside))
    moved = region.nearest(outside)
    assert domain.contains(moved) or np.abs(domain.representatives(moved).q - moved).max() < 1e-6
    metric = np.einsum("gki,gkj->ij", domain.group.A_sat, domain.group.A_sat)
    metric /= np.linalg.det(metric) ** (1 / len(metric))
    rows = domain.halfspaces
    y = domain.basis @ outside
    if (rows[:, :-1] @ (domain.basis @ inside) > rows[:, -1]).any():
        return  # the sample came in another turn
    best = minimize(
        lambda x: (x - y) @ metric @ (x - y),
        domain.basis @ inside,
        jac=lambda x: 2 * metric @ (x - y),
        constraints={
            "type": "ineq",
            "fun": lambda x: rows[:, -1] - rows[:, :-1] @ x,
            "jac": lambda x: -rows[:, :-1],
        },
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 300},
    )
    step = domain.basis @ (moved - outside)
    assert step @ metric @ step <= best.fun + 1e-7


def test_points_inside_stay(domain):
    region = ExplorationRegion(domain)
    for q in domain.sample(np.random.default_rng(0), 20):
        assert np.array_equal(region.nearest(q), q)
