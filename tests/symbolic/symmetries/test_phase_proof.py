"""Proofs of the search agree with those of the verifier, which shares no code with them."""

import itertools

import numpy as np
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.frequency_support import FrequencySupport
from isotorque.symbolic.symmetries.phase_proof import PhaseProof
from isotorque.verify.relations.exact_proof import prove_relation

UNITS = [(fmpq(1), fmpq(0)), (fmpq(0), fmpq(1)), (fmpq(-1), fmpq(0)), (fmpq(0), fmpq(-1))]
TURNED = [(fmpq(3, 5), fmpq(4, 5)), (fmpq(5, 13), fmpq(-12, 13)), (fmpq(-8, 17), fmpq(15, 17))]
ONE, SMALL = UNITS[0], fmpq(1, 10**30)
NUDGES = [  # what floats cannot see: none, an angle, an amplitude
    ONE,
    ((1 - SMALL**2) / (1 + SMALL**2), 2 * SMALL / (1 + SMALL**2)),
    (1 + SMALL, fmpq(0)),
]


def times(a, b):
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


@st.composite
def dependent_potentials(draw):
    """More frequencies than joints, few amplitudes, phases of right and of rational angles."""
    n = draw(st.integers(1, 3))
    every = [k for k in itertools.product([0, 1, -1], repeat=n) if any(k)]
    every = [k for k in every if next(x for x in k if x) > 0]
    K = draw(st.lists(st.sampled_from(every), min_size=1, max_size=n + 2, unique=True))
    phases = st.sampled_from(UNITS if draw(st.booleans()) else UNITS + TURNED)
    cos, sin = [], []
    for _ in K:
        x, y = times(draw(phases), draw(st.sampled_from(NUDGES)))
        size = draw(st.sampled_from([1, 1, 2]))
        cos.append(size * x)
        sin.append(size * y)
    return TrigonometricPolynomial(K, np.array(cos, dtype=object), np.array(sin, dtype=object))


def candidates(support, classes):
    """Every (Y, s, d) whose frequencies fit, phases or not."""
    for Y, s in support.structures(classes):
        for z in support.lattice.cosets():
            yield Y, s, support.offset(Y, s, z)


@given(dependent_potentials(), st.integers(0, 2**32 - 1))
@settings(max_examples=60)
def test_what_is_proved_here_is_proved_by_the_verifier_and_nothing_else(potential, seed):
    rng = np.random.default_rng(seed)
    numeric = potential.to_float()
    support = FrequencySupport.of(numeric, np.ones(len(numeric), dtype=bool))
    proof = PhaseProof(potential, support, True)
    for Y, s, d_sat in candidates(support, np.zeros(len(support.K), dtype=np.int64)):
        holds = proof.holds(Y, s, d_sat)
        relation = support.relation(numeric, Y, s, d_sat, True)
        if holds:
            relation = proof.rounded(relation, Y, s)
        again = prove_relation(relation.A, relation.unwrapped_d, Y, potential)
        assert holds == again.holds
        # an offset somewhere else, or of another coset, is no exact one
        for other in (d_sat + rng.choice([-1, 1]) * 1e-6, rng.uniform(-np.pi, np.pi, len(d_sat))):
            moved = support.lift(support.linear_part(Y, s), other)[1]
            if not prove_relation(relation.A, moved, Y, potential).offset_error < 1e-8:
                assert not proof.holds(Y, s, other)


@given(dependent_potentials())
@settings(max_examples=20)
def test_nothing_is_proved_of_a_potential_that_has_more_terms(potential):
    numeric = potential.to_float()
    support = FrequencySupport.of(numeric, np.ones(len(numeric), dtype=bool))
    partial = PhaseProof(potential, support, False)
    for Y, s, d_sat in candidates(support, np.zeros(len(support.K), dtype=np.int64)):
        assert not partial.holds(Y, s, d_sat)


def test_amplitudes_that_differ_by_less_than_a_float_are_unequal_even_if_products_agree():
    """Here every product of the phases comes out right, but for |C_Yk| = |C_k|."""
    K = [[1, -1, 1], [1, 1, 1], [1, 1, -1], [1, -1, -1]]
    amplitudes = [fmpq(1) + x * SMALL for x in (-2, -1, 1, -1)]
    potential = TrigonometricPolynomial(
        K, np.array(amplitudes, dtype=object), np.array([fmpq(0)] * 4, dtype=object)
    )
    support = FrequencySupport.of(potential.to_float(), np.ones(4, dtype=bool))
    proof = PhaseProof(potential, support, True)
    Y, s = np.array([1, -1, -1]), np.ones(4, dtype=np.int64)
    d_sat = np.zeros(len(support.B))
    assert not proof.holds(Y, s, d_sat)
    assert proof.holds(np.ones(3, dtype=np.int64), s, d_sat)
