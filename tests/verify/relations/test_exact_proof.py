"""Proofs: exact phases that no float could tell apart, and failures that say why."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.verify.relations.exact_proof import OFFSET_ROUNDING, prove_relation

TRIPLES = [(3, 4, 5), (5, 12, 13), (8, 15, 17), (7, 24, 25)]
MANY = settings(max_examples=60, deadline=None, derandomize=True)


def shifted_even(frequencies, centre, amplitudes):
    """U(q) = sum of amplitude cos(k.(q - c)) with exp(i c_j) rational: even about q = c."""
    cos, sin = [], []
    for k, size in zip(frequencies, amplitudes, strict=True):
        real, imaginary = fmpq(1), fmpq(0)
        for power, (x, y) in zip(k, centre, strict=True):
            for _ in range(abs(power)):
                y_signed = y if power > 0 else -y
                real, imaginary = real * x - imaginary * y_signed, real * y_signed + imaginary * x
        cos.append(size * real)
        sin.append(size * imaginary)
    return TrigonometricPolynomial(
        frequencies, np.array(cos, dtype=object), np.array(sin, dtype=object)
    )


FREQUENCIES = [[1, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 1], [0, 1, -1], [1, -1, 1]]


@st.composite
def even_potentials(draw):
    centre = []
    for _ in range(3):
        a, b, c = draw(st.sampled_from(TRIPLES))
        centre.append((fmpq(a, c), fmpq(draw(st.sampled_from([1, -1])) * b, c)))
    angles = np.array(
        [np.arctan2(float(y.p) / float(y.q), float(x.p) / float(x.q)) for x, y in centre]
    )
    amplitudes = [fmpq(draw(st.integers(1, 9))) for _ in FREQUENCIES]
    return shifted_even(FREQUENCIES, centre, amplitudes), angles


@MANY
@given(even_potentials())
def test_a_point_reflection_about_any_centre_is_proved(drawn):
    potential, centre = drawn
    # U(2c - q) = U(q): A = -I, g changes sign as a whole
    assert prove_relation(-np.eye(3), 2 * centre, [-1, -1, -1], potential).holds
    assert not prove_relation(-np.eye(3), 2 * centre, [1, -1, -1], potential).holds


@MANY
@given(even_potentials(), st.integers(0, 5))
def test_a_phase_wrong_by_1e_30_is_noticed(drawn, place):
    potential, centre = drawn
    cos, sin = potential.cos.copy(), potential.sin.copy()
    turn = fmpq(1, 10**30)
    cos[place], sin[place] = cos[place] - turn * sin[place], sin[place] + turn * cos[place]
    nudged = TrigonometricPolynomial(potential.frequencies, cos, sin)
    assert np.array_equal(nudged.to_float().cos, potential.to_float().cos)
    proof = prove_relation(-np.eye(3), 2 * centre, [-1, -1, -1], nudged)
    assert not proof.holds
    assert proof.reason == "the phases admit no offset d"


@MANY
@given(even_potentials(), st.integers(0, 2), st.sampled_from([1e-6, -1e-9, 1e-12]))
def test_an_offset_that_is_not_the_rounding_of_an_exact_one_is_not_proved(drawn, joint, error):
    potential, centre = drawn
    offset = 2 * centre
    offset[joint] += error
    proof = prove_relation(-np.eye(3), offset, [-1, -1, -1], potential)
    assert not proof.holds
    assert proof.offset_error == pytest.approx(abs(error), rel=1e-2)


def test_a_frequency_of_two_needs_euclid():
    # rows (2) and (3) generate (1): u_2 and u_3 must belong to one d
    potential = TrigonometricPolynomial([[2], [3]], [1.0, 1.0], [0.0, 0.0])
    assert prove_relation([[1]], [0.0], [1], potential).holds
    assert prove_relation([[-1]], [0.0], [-1], potential).holds
    half_turn = prove_relation([[1]], [np.pi], [1], potential)
    assert half_turn.reason == "d is 3.14 rad from the exact offset"


PI_AND_MORE = np.pi + np.spacing(np.pi) * np.arange(-4, 5)


@pytest.mark.parametrize("d", PI_AND_MORE)
def test_only_a_float_within_one_unit_of_the_exact_offset_is_proved(d):
    potential = TrigonometricPolynomial([[1]], [0.0], [1.0])
    with mpmath.workdps(50):
        away = float(abs(mpmath.mpf(float(d)) - mpmath.pi))
    proof = prove_relation([[1]], [d], [-1], potential)
    assert proof.holds == (away <= OFFSET_ROUNDING)
    assert away <= proof.offset_error <= away * (1 + 1e-9)


@pytest.mark.parametrize("turns", [1.0, 1e3, 1e15, -1e15, 1e300])
def test_turns_of_rounded_floats_are_no_whole_turns(turns):
    potential = TrigonometricPolynomial([[1]], [0.0], [1.0])
    d = 2 * np.pi * turns
    with mpmath.workdps(400):
        turn = 2 * mpmath.pi
        away = mpmath.mpf(d) - turn * mpmath.nint(mpmath.mpf(d) / turn)
    proof = prove_relation([[1]], [d], [1], potential)
    assert proof.offset_error == pytest.approx(float(abs(away)), rel=1e-12)
    assert proof.holds == (turns == 1.0)


def test_offsets_along_free_directions_are_free():
    # only q1 + q2 matters: any two offsets that add up to pi will do, however they are rounded
    potential = TrigonometricPolynomial([[1, 1]], [0.0], [1.0])
    assert prove_relation(np.eye(2), [1.0, np.pi - 1.0], [-1, -1], potential).holds
    assert prove_relation(np.eye(2), [1e6, np.pi], [-1, -1], potential).holds is False
    assert prove_relation([[3, 2], [-2, -1]], [2.5, -2.5], [1, 1], potential).holds


@pytest.mark.parametrize("entry", [2**62, 2**63, 2**64, -(2**63), 10**45, 2.0**63, 1e308])
def test_entries_of_any_size_are_exact(entry):
    potential = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    A = np.array([[1, entry], [0, 1]], dtype=object)
    assert not prove_relation(A, [0, 0], [1, 1], potential).holds
    whole = np.array([[1, entry], [0, 1 - int(entry)]], dtype=object)  # q1 + q2 stays, q1 not
    assert prove_relation(whole, [0, 0], [1, 1], potential).reason.endswith("k = (1, 0)")
    single = TrigonometricPolynomial([[1, 1]], [0.0], [18.4])
    assert prove_relation(whole, [0, 0], [1, 1], single).holds


def test_a_real_matrix_is_proved_where_only_free_joints_feel_it():
    potential = TrigonometricPolynomial([[0, 1]], [0.0], [1.0])
    assert prove_relation([[0.3, 1e-9], [0, -1]], [0.1, 0], [1, 1], potential).holds
    assert not prove_relation([[1, 0], [1e-300, 1]], [0, 0], [1, 1], potential).holds


@pytest.mark.parametrize(
    ("A", "Y", "reason"),
    [
        ([[0.5]], [1], "A^T k is neither Y k nor -Y k at k = (1)"),
        ([[2]], [1], "A^T k is neither Y k nor -Y k at k = (1)"),
    ],
)
def test_reasons(A, Y, reason):
    potential = TrigonometricPolynomial([[1]], [1.0], [0.5])
    assert prove_relation(A, [0.0], Y, potential).reason == reason


def test_unequal_amplitudes_are_named():
    potential = TrigonometricPolynomial([[1, 0], [0, 1], [1, 1], [1, -1]], [1, 1, 2, 3], [0] * 4)
    proof = prove_relation(np.diag([1, -1]), [0, 0], [1, -1], potential)
    assert proof.holds is False
    assert proof.reason == "|C_Yk| differs from |C_k| at k = (1, 1)"


def test_the_verifier_and_the_search_agree(arms):
    for arm in arms.values():
        for relation in arm.group:
            assert relation.exact
            assert prove_relation(relation.A, relation.d, relation.Y, arm.gravity.potential).holds
