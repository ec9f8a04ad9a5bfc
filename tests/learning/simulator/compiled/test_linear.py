"""The compiled linear algebra against NumPy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.simulator.compiled.linear import factorise, multiply, solve, solve_step

SIZES = st.integers(1, 8)
SEEDS = st.integers(0, 2**32 - 1)


def definite(n, rng):
    a = rng.normal(size=(n, n))
    return a @ a.T + 0.1 * np.eye(n)


@given(SIZES, SEEDS)
def test_factors_solve_the_system(n, seed):
    rng = np.random.default_rng(seed)
    a, b = definite(n, rng), rng.normal(size=n)
    lower, pivots, x = np.tril(a), np.empty(n), b.copy()
    assert factorise(lower, pivots)
    solve(lower, pivots, x)
    assert np.allclose(a @ x, b, atol=1e-9)


@given(SIZES, SEEDS)
def test_what_is_not_definite_is_noticed(n, seed):
    rng = np.random.default_rng(seed)
    a = definite(n, rng)
    eigenvalues, vectors = np.linalg.eigh(a)
    eigenvalues[rng.integers(n)] *= -1.0
    indefinite = vectors @ np.diag(eigenvalues) @ vectors.T
    assert not factorise(np.tril(indefinite), np.empty(n))


@given(SIZES, SEEDS)
def test_a_step_in_one_go(n, seed):
    rng = np.random.default_rng(seed)
    mass, stiffness = definite(n, rng), rng.normal(size=(n, n))
    stiffness = stiffness + stiffness.T
    damping, b = rng.uniform(0, 2, n), rng.normal(size=n)
    h, hh = rng.uniform(0, 0.5), rng.uniform(0, 0.25)
    whole = mass + h * np.diag(damping) + hh * stiffness
    x = b.copy()
    solved = solve_step(
        np.tril(mass), np.tril(stiffness), damping, h, hh, np.zeros((n, n)), np.empty(n), x
    )
    assert solved == (np.linalg.eigvalsh(whole)[0] > 0)
    if solved:
        # Backward error: the residual is of the size of rounding in the products of the factors.
        scale = np.abs(whole).max() * max(np.abs(x).max(), 1.0)
        assert np.abs(whole @ x - b).max() <= 1e-10 * scale


@given(SIZES, SEEDS)
def test_product_with_a_lower_triangle(n, seed):
    rng = np.random.default_rng(seed)
    a, x, out = definite(n, rng), rng.normal(size=n), np.empty(n)
    multiply(np.tril(a), x, out)
    assert np.allclose(out, a @ x, atol=1e-12 * n)
