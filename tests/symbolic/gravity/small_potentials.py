"""Gravity potentials for tests of groups, domains and level sets: known arms and random ones."""

from __future__ import annotations

import itertools

import numpy as np
from hypothesis import strategies as st

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

A, B = 18.39, 6.13  # torque amplitudes of the paper's 2R arm [N m]


def two_r(a: float = A, b: float = B) -> TrigonometricPolynomial:
    """Potential of the 2R arm: g1 = a cos q1 + b cos(q1 + q2), g2 = b cos(q1 + q2)."""
    return TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [a, b])


def three_r(a: float = 12.26, b: float = 12.26) -> TrigonometricPolynomial:
    """Potential of the paper's 3R arm: cos q1 (b sin q2 + a sin(q2 + q3))."""
    k = [[1, 1, 0], [1, -1, 0], [1, 1, 1], [1, -1, -1]]
    return TrigonometricPolynomial(k, [0.0] * 4, [b / 2, -b / 2, a / 2, -a / 2])


def planar(amplitudes: list[float]) -> TrigonometricPolynomial:
    """Potential of a planar arm whose first link lies level at q = 0."""
    n = len(amplitudes)
    return TrigonometricPolynomial(np.tril(np.ones((n, n), dtype=int)), [0.0] * n, amplitudes)


@st.composite
def potentials(draw: st.DrawFn, max_joints: int = 4) -> TrigonometricPolynomial:
    """Random potentials: few frequencies, often equal amplitudes, any rank from 0 to n."""
    n = draw(st.integers(1, max_joints))
    every = [k for k in itertools.product([0, 1, -1], repeat=n) if any(k)]
    every = [k for k in every if next(x for x in k if x) > 0]
    k = draw(st.lists(st.sampled_from(every), max_size=min(5, len(every)), unique=True))
    amplitude = [draw(st.sampled_from([1.0, 2.0, 0.7])) for _ in k]
    phase = np.array([draw(st.sampled_from([0.0, np.pi / 2, 0.3, 2.1])) for _ in k])
    cos, sin = amplitude * np.cos(phase), amplitude * np.sin(phase)
    return TrigonometricPolynomial(np.array(k, dtype=int).reshape(-1, n), cos, sin)
