import dataclasses

import numpy as np
import pytest
import sympy
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.kinematic_tree import KinematicTree, human_arm, planar_arm, rational
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import kinematic_trees

FIELDS = ("rotations", "translations", "axes", "masses", "levers", "gravity")


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_rational_is_the_float_itself(x):
    exact = rational(x)
    assert int(exact.p) / int(exact.q) == x
    assert rational(exact) is exact


@given(kinematic_trees(max_joints=3))
def test_exact_keeps_every_number(tree):
    exact = tree.exact()
    assert (exact.joint_names, exact.parents) == (tree.joint_names, tree.parents)
    for field in FIELDS:
        converted = getattr(exact, field)
        assert all(isinstance(x, fmpq) for x in converted.flat)
        back = [int(x.p) / int(x.q) for x in converted.flat]
        np.testing.assert_array_equal(back, getattr(tree, field).ravel())
    assert exact.exact() is exact


def test_exact_leaves_symbols_alone():
    tree = planar_arm(2)
    assert tree.exact() is tree


@pytest.mark.parametrize("field", FIELDS)
def test_a_wrong_shape_is_named(field):
    tree = load_robot("2r").tree
    with pytest.raises(InputError, match=f"shape of {field}"):
        dataclasses.replace(tree, **{field: np.zeros((5, 5))})


@pytest.mark.parametrize(("parents", "joint"), [((0, 0), "shoulder"), ((-1, 1), "elbow")])
def test_a_joint_hangs_on_an_earlier_one(parents, joint):
    with pytest.raises(InputError, match=f"parent of joint '{joint}'"):
        dataclasses.replace(load_robot("2r").tree, parents=parents)


def test_number_of_parents_is_checked():
    with pytest.raises(InputError, match="shape of parents"):
        dataclasses.replace(load_robot("2r").tree, parents=(-1,))


def test_substitute_puts_numbers_in_by_name():
    tree = planar_arm(2).substitute({"m1": 3, "l1": sympy.Rational(1, 4)})
    assert tree.masses[0] == 3
    assert tree.translations[1, 0] == sympy.Rational(1, 4)
    assert {x.name for x in tree.levers[1, 0].free_symbols} == {"c2"}


def test_substitute_refuses_a_name_that_does_not_occur():
    with pytest.raises(InputError, match="symbol is M1; accepted: c1, c2, g, l1, m1, m2"):
        planar_arm(2).substitute({"M1": 3})


def test_the_parametric_human_arm_becomes_the_built_in_3r():
    values = {"m1": 1.0, "c1": 0.0, "l1": 0.25, "m2": 5.0, "c2": 0.25, "g": 9.81}
    mine, built_in = human_arm().substitute(values), load_robot("3r").tree
    assert mine.parents == built_in.parents
    for field in FIELDS:
        numbers = np.array(getattr(mine, field), dtype=float)
        np.testing.assert_array_equal(numbers, getattr(built_in, field))


def test_planar_arm_is_a_chain_of_parallel_axes():
    tree = planar_arm(4)
    assert isinstance(tree, KinematicTree)
    assert tree.parents == (-1, 0, 1, 2)
    assert all(tuple(axis) == (0, -1, 0) for axis in tree.axes)
