import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.straight_line_program import (
    cheaper_program,
    expanded_program,
    recursion_program,
)
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import configurations, kinematic_trees


def run(program, q):
    """Run the statements one after the other; every name must have been defined."""
    values = {}
    for wave in program.waves:
        values[wave.name] = getattr(math, wave.function)(float(np.dot(wave.frequency, q)))

    def total(terms):
        return sum(factor * math.prod(values[name] for name in names) for factor, names in terms)

    for statement in program.sums:
        assert statement.name not in values
        values[statement.name] = total(statement.terms)
    return np.array([float(total(terms)) for terms in program.torques]), values


def forms(gravity):
    return expanded_program(gravity.significant_potential), recursion_program(gravity.chain)


@given(kinematic_trees(max_joints=5), st.data())
@settings(max_examples=60)
def test_both_forms_agree_with_the_model(tree, data):
    q = data.draw(configurations(tree.n))
    gravity = GravityModel(tree)
    scale = max(gravity.potential.gradient_bound().max(initial=0.0), 1e-3)
    for program in forms(gravity):
        assert program.n == tree.n
        np.testing.assert_allclose(
            run(program, q)[0], gravity.torque(q), rtol=0, atol=1e-12 * scale
        )


@given(kinematic_trees(max_joints=4))
@settings(max_examples=40)
def test_nothing_is_computed_in_vain(tree):
    for program in forms(GravityModel(tree)):
        used = {
            name
            for terms in (*(s.terms for s in program.sums), *program.torques)
            for _, names in terms
            for name in names
        }
        assert used == {w.name for w in program.waves} | {s.name for s in program.sums}
        for terms in (*(s.terms for s in program.sums), *program.torques):
            assert all(factor != 0 and len(names) <= 2 for factor, names in terms)


@pytest.mark.parametrize(
    ("name", "form"),
    [("pendulum", 0), ("2r", 0), ("3r", 0), ("4r-planar", 0), ("ur5", 0), ("panda", 1)],
)
def test_the_cheaper_form_is_taken(name, form):
    """Expanded while there are few frequencies, recursion where there are hundreds."""
    gravity = GravityModel(load_robot(name))
    both = forms(gravity)
    assert cheaper_program(gravity.chain, gravity.significant_potential) == both[form]
    assert both[form].cost <= both[1 - form].cost


def test_cost_counts_every_wave_and_operation():
    f = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 3.0], [2.0, 4.0])
    program = expanded_program(f)
    # cos q1; cos and sin of q1 + q2 (one addition more); t = 4 cos - 3 sin; 2 cos q1 + t; t
    assert program.cost == 40 + (40 + 1 + 20) + (1 + 1 + 1) + (1 + 1) + 0


def test_no_frequencies_no_statements():
    program = expanded_program(TrigonometricPolynomial(np.zeros((0, 3)), [], []))
    assert program.torques == ((), (), ())
    assert program.cost == 0
    assert run(program, np.zeros(3))[0].tolist() == [0, 0, 0]


def test_constant_factors_are_folded_into_the_numbers():
    """The recursion of a pendulum is one wave and one product."""
    program = recursion_program(GravityModel(load_robot("pendulum")).chain)
    assert [wave.function for wave in program.waves] == ["cos"]
    assert len(program.sums) <= 1
