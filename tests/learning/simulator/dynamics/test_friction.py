"""Coulomb friction: both solvers against every combination of sticking and slipping."""

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.simulator.compiled.friction import solve_with_friction as compiled
from isotorque.learning.simulator.dynamics.friction import _coordinate_descent
from isotorque.learning.simulator.dynamics.friction import solve_with_friction as plain

SEEDS = st.integers(0, 2**32 - 1)


def solve_compiled(a, b, friction, guess):
    n = len(b)
    x = guess.copy()
    compiled(np.tril(a), b, friction, np.zeros((n, n)), np.empty(n), np.empty(n), x)
    return x


def brute_force(a, b, friction):
    """Return the minimum of x'Ax/2 - b'x + sum f|x| among all combinations of signs."""
    n = len(b)
    best, least = np.zeros(n), 0.0
    for signs in itertools.product((-1.0, 0.0, 1.0), repeat=n):
        signs = np.array(signs)
        moving = np.flatnonzero(signs)
        x = np.zeros(n)
        if len(moving):
            grid = np.ix_(moving, moving)
            x[moving] = np.linalg.solve(a[grid], (b - signs * friction)[moving])
        if (x * signs < 0).any():
            continue
        value = 0.5 * x @ a @ x - b @ x + friction @ np.abs(x)
        if value < least:
            best, least = x, value
    return best


@given(st.integers(1, 5), SEEDS)
def test_both_solvers_find_the_minimum(n, seed):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(n, n))
    a = root @ root.T + 0.05 * np.eye(n)
    b, guess = rng.normal(size=n), rng.normal(size=n) * rng.integers(0, 2, n)
    friction = rng.uniform(0, 1.5, n) * rng.integers(0, 2, n)
    expected = brute_force(a, b, friction)
    for solver in (solve_compiled, plain):
        x = solver(a, b, friction, guess)
        assert np.allclose(x, expected, atol=1e-9)
        assert ((x == 0) == (expected == 0)).all()  # sticking is exact


@given(st.integers(1, 4), SEEDS)
def test_what_goes_on_should_the_active_sets_cycle(n, seed):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(n, n))
    a, b = root @ root.T + 0.5 * np.eye(n), rng.normal(size=n)
    friction = rng.uniform(0, 1, n)
    x = _coordinate_descent(a, b, friction, np.zeros(n))
    assert np.allclose(x, brute_force(a, b, friction), atol=1e-8)


def test_strong_friction_holds_everything():
    a, b = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([1.0, -1.0])
    for solver in (solve_compiled, plain):
        assert np.array_equal(solver(a, b, np.ones(2), np.ones(2)), np.zeros(2))
