import itertools

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.robots.kinematic_tree import KinematicTree, human_arm, planar_arm
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import configurations, kinematic_trees
from tests.symbolic.robots.transforms import precise_potential, transform_potential


@given(st.data())
@settings(max_examples=40)
def test_potential_equals_the_product_of_transforms_to_forty_digits(data):
    tree = data.draw(kinematic_trees(max_joints=4))
    q = data.draw(configurations(tree.n))
    U = derive_potential(tree)
    with mpmath.workdps(50):
        zero = mpmath.mpf(0)
        # The constant is left out: compare with the mean over half turns, which is the constant.
        points = [mpmath.mpf(float(x)) for x in q]
        shifts = itertools.product([zero, mpmath.pi], repeat=tree.n)
        shifted = [[x + s for x, s in zip(points, shift, strict=True)] for shift in shifts]
        constant = sum(precise_potential(tree, x) for x in shifted) / len(shifted)
        expected = precise_potential(tree, points) - constant
        found = zero
        for k, a, b in zip(U.frequencies.tolist(), U.cos, U.sin, strict=True):
            phase = sum((f * x for f, x in zip(k, points, strict=True)), zero)
            found += mpmath.mpf(int(a.p)) / int(a.q) * mpmath.cos(phase)
            found += mpmath.mpf(int(b.p)) / int(b.q) * mpmath.sin(phase)
        assert abs(found - expected) < mpmath.mpf(10) ** -40 * (1 + abs(expected))


@given(kinematic_trees(max_joints=3, planted=True))
@settings(max_examples=10)
def test_potential_equals_sympy_expanding_the_product_of_transforms(tree):
    q = sympy.symbols(f"q1:{tree.n + 1}", real=True)

    def number(x):
        return sympy.Rational(*float(x).as_integer_ratio())

    product = transform_potential(
        tree, [sympy.cos(x) for x in q], [sympy.sin(x) for x in q], number
    )
    mine = derive_potential(tree).to_sympy(q)
    difference = sympy.expand(sympy.expand_trig(mine) - product)
    assert not difference.free_symbols  # the constant, which the potential leaves out


@given(kinematic_trees(max_joints=5))
@settings(max_examples=30)
def test_frequencies_are_minus_one_zero_one_and_never_constant(tree):
    U = derive_potential(tree)
    assert np.all(np.abs(U.frequencies) <= 1)
    assert np.all(np.any(U.frequencies != 0, axis=1))
    assert U.is_exact
    assert U.names == tree.joint_names


@given(kinematic_trees(max_joints=5, branched=True))
@settings(max_examples=30)
def test_only_joints_on_one_branch_share_a_frequency(tree):
    above = [set() for _ in range(tree.n)]
    for i, parent in enumerate(tree.parents):
        above[i] = {i} | (above[parent] if parent >= 0 else set())
    for k in derive_potential(tree).frequencies:
        active = np.flatnonzero(k)
        assert set(active) <= above[active[-1]]


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_planar_arm_gives_the_textbook_formula(n):
    """Siciliano et al. 2009, section 7.3.2, for any number of links."""
    tree = planar_arm(n)
    q = sympy.symbols(f"q1:{n + 1}", real=True)
    g = tree.gravity[2]
    height, textbook = sympy.Integer(0), sympy.Integer(0)
    for i in range(n):
        level = sympy.sin(sympy.Add(*q[: i + 1]))
        textbook += -g * tree.masses[i] * (height + tree.levers[i, 0] * level)
        if i + 1 < n:
            height += tree.translations[i + 1, 0] * level
    U = derive_potential(tree)
    assert sympy.expand(U.to_sympy(q) - textbook) == 0
    assert len(U) == n


def test_human_arm_gives_the_papers_potential():
    q1, q2, q3 = q = sympy.symbols("q1:4", real=True)
    m1, c1, l1, m2, c2, g = sympy.symbols("m1 c1 l1 m2 c2 g", positive=True)
    U = derive_potential(human_arm())
    b, a = m1 * c1 + m2 * l1, m2 * c2
    expected = g * sympy.cos(q1) * (b * sympy.sin(q2) + a * sympy.sin(q2 + q3))
    assert sympy.simplify(sympy.expand_trig(U.to_sympy(q) - expected)) == 0
    assert len(U) == 4


def test_built_in_3r_has_the_papers_torque_ranges():
    """The paper's ranges are 24.4, 24.2 and 12.4 N m; a = b = 12.26 N m fits them (physics.md)."""
    U = derive_potential(load_robot("3r").tree)
    np.testing.assert_allclose(2 * U.amplitudes(), 5 * 9.81 * 0.25)


def test_a_link_that_balances_drops_out_exactly():
    tree = planar_arm(2).substitute({"m2": 0})
    assert derive_potential(tree).frequencies.tolist() == [[1, 0]]


def test_terms_that_cancel_symbolically_are_left_out():
    """An elbow folded back onto a counterweight: m1 c1 + m2 l1 = 0 in symbols."""
    m2, l1 = sympy.symbols("m2 l1", positive=True)
    c1, m1 = sympy.symbols("c1 m1", positive=True)
    tree = planar_arm(2).map(lambda x: x.subs({c1: -m2 * l1 / m1}))
    assert derive_potential(tree).frequencies.tolist() == [[1, 1]]


def test_no_gravity_no_potential():
    tree = load_robot("2r").tree
    weightless = KinematicTree(**{**vars(tree), "gravity": np.zeros(3)})
    U = derive_potential(weightless)
    assert len(U) == 0
    assert U.n == 2


def test_talos_sized_arm_has_hundreds_of_frequencies():
    """Seven generic joints give (3^7 - 1) / 2 frequencies."""
    rng = np.random.default_rng(0)
    n = 7
    rotations = np.array([np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(n)])
    axes = rng.normal(size=(n, 3))
    tree = KinematicTree(
        tuple(f"j{i}" for i in range(n)),
        tuple(range(-1, n - 1)),
        rotations,
        rng.normal(size=(n, 3)),
        axes / np.linalg.norm(axes, axis=1)[:, None],
        rng.random(n),
        rng.normal(size=(n, 3)),
        rng.normal(size=3),
    )
    assert len(derive_potential(tree)) == (3**n - 1) // 2
