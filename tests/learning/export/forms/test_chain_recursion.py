"""The recursion: compiled, in CasADi and as arrays the same as the chain, whatever its form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.export.c_export import c_source
from isotorque.learning.export.casadi_export import casadi_function
from isotorque.learning.export.forms.chain_recursion import ChainRecursion
from isotorque.learning.export.forms.torque_form import evaluate
from isotorque.learning.learners.rigid.structure.canonical_form import CanonicalForm
from tests.learning.export.compiled_source import build, call, needs_cc
from tests.learning.learners.rigid.random_chains import KINDS, random_chain


def recursion(chain, gains, biases):
    form = CanonicalForm.of(chain)
    return ChainRecursion.of(chain.parents, form.offsets, form.twists, form.levers, gains, biases)


@st.composite
def recursions(draw):
    """A chain or tree with gains and biases (or none), and its recursion."""
    n = draw(st.integers(1, 6))
    forks = draw(st.booleans())
    parents = [draw(st.integers(-1, j - 1)) for j in range(n)] if forks else None
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    chain = random_chain(rng, n, draw(st.sampled_from(KINDS)), parents)
    plain = draw(st.booleans())
    gains = np.ones(n) if plain else rng.uniform(-2, 2, n)
    biases = np.zeros(n) if plain else rng.normal(size=n)
    return chain, gains, biases, recursion(chain, gains, biases), rng


@given(recursions())
@settings(max_examples=40)
def test_formula_and_arrays_are_the_chain(case):
    chain, gains, biases, form, rng = case
    q = rng.uniform(-7, 7, (4, chain.n))
    expected = gains * chain.torque(q) + biases
    assert np.abs(evaluate(form, q) - expected).max() < 1e-11
    again = ChainRecursion.from_arrays(form.to_arrays())
    np.testing.assert_array_equal(evaluate(again, q), evaluate(form, q))
    assert np.abs(np.array(casadi_function(form)(q[0])).ravel() - expected[0]).max() < 1e-11


@needs_cc
@given(case=recursions())
@settings(max_examples=12)
def test_compiled_c_is_the_chain(case, tmp_path_factory):
    """Strictly compiled, without a warning; many turns away, and at quarter turns."""
    chain, gains, biases, form, rng = case
    q = np.concatenate(
        [
            rng.uniform(-7, 7, (30, chain.n)),
            np.pi / 4 * rng.integers(-9, 9, (30, chain.n)) - form.shifts,
            rng.uniform(-9e4, 9e4, (5, chain.n)),
            rng.uniform(-1e7, 1e7, (5, chain.n)),
        ]
    )
    expected = gains * chain.torque(q) + biases
    _, library = build(c_source(form), tmp_path_factory.mktemp("c"))
    for in_place in (False, True):
        error = np.abs(call(library, q, in_place) - expected)
        assert error[:60].max() < 1e-12 * 100
        # angles beyond are themselves rounded when the shift is added
        assert error[60:65].max() < 1e-8
        assert error[65:].max() < 1e-5


@needs_cc
@pytest.mark.parametrize("levers", [[[0.0, 0.0], [0.0, 0.0]], [[3.0, 0.0], [0.0, 0.0]]])
def test_joints_that_carry_nothing_have_no_torque(levers, tmp_path):
    """And no unused variable, which a strict compiler would refuse."""
    chain = random_chain(np.random.default_rng(0), 2).with_levers(np.array(levers))
    form = recursion(chain, np.ones(2), np.array([0.0, 0.25]))
    _, library = build(c_source(form), tmp_path)
    q = np.random.default_rng(1).uniform(-3, 3, (5, 2))
    assert np.abs(call(library, q) - chain.torque(q) - [0.0, 0.25]).max() < 1e-12


def test_right_angles_cost_no_multiplication():
    """Constants 0 and 1 are not in the source."""
    chain = random_chain(np.random.default_rng(5), 3, "parallel")
    source = recursion(chain, np.ones(3), np.zeros(3)).c_source()
    body = source[source.index("isotorque_gravity") :]
    assert "1.0 *" not in body
    assert "0.0 *" not in body
