import re

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.readable import (
    gravity_latex,
    gravity_sympy,
    gravity_text,
    latex_name,
)
from isotorque.symbolic.robots.kinematic_tree import human_arm, planar_arm
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import configurations, kinematic_trees


def rows_of(text):
    """Return {left side: right side} of the lines that define something."""
    return dict(re.split(r"\s+=\s+", line, maxsplit=1) for line in text.splitlines())


def read(expression, q):
    """Evaluate the right side of a row of text."""
    code = re.sub(r"(\d) (cos|sin)", r"\1*\2", expression)
    angles = {f"q{i + 1}": float(x) for i, x in enumerate(q)}
    return eval(code, {"cos": np.cos, "sin": np.sin}, angles)


def read_latex(expression, q):
    """Evaluate the right side of a LaTeX row with numbers as coefficients."""
    code = re.sub(r"q_\{(\d+)\}", r"q[\1-1]", expression)
    code = re.sub(r" \\cdot 10\^\{(-?\d+)\}", r"e\1", code)
    code = code.replace(r"\left(", "(").replace(r"\right)", ")")
    code = re.sub(r" \\(cos|sin)", r"*\1", code)
    return eval(code, {"cos": np.cos, "sin": np.sin, "q": q})


@given(kinematic_trees(max_joints=3), st.data())
@settings(max_examples=40)
def test_text_and_latex_read_back_to_the_torque(tree, data):
    q = data.draw(configurations(tree.n))
    gravity = GravityModel(tree)
    tolerance = 1e-5 * (1e-9 + gravity.potential.gradient_bound().max(initial=0.0))
    rows = rows_of(gravity_text(gravity))
    latex = [row.strip("\\ ") for row in gravity_latex(gravity).splitlines()[1:-1]]
    for i, expected in enumerate(gravity.torque(q)):
        assert abs(read(rows[f"g_{i + 1}"], q) - expected) <= tolerance
        left, right = latex[i].split(" &= ")
        assert left == f"g_{{{i + 1}}}"
        assert abs(read_latex(right, q) - expected) <= tolerance
    potential = gravity.potential.evaluate(q)
    assert abs(read(rows["U"], q) - potential) <= tolerance
    assert [rows[f"q{i + 1}"] for i in range(tree.n)] == list(tree.joint_names)


def test_text_of_a_robot_names_its_joints():
    assert gravity_text(GravityModel(load_robot("2r"))).splitlines() == [
        "q1 = shoulder",
        "q2 = elbow",
        "U   = 18.3938 sin(q1) + 6.13125 sin(q1 + q2)",
        "g_1 = 18.3938 cos(q1) + 6.13125 cos(q1 + q2)",
        "g_2 = 6.13125 cos(q1 + q2)",
    ]


def test_text_of_a_joint_without_torque_is_zero():
    rows = rows_of(gravity_text(GravityModel(load_robot("panda"))))
    assert rows["q1"] == "panda_joint1"
    assert rows["g_1"] == "0"


@given(kinematic_trees(max_joints=3), st.data())
@settings(max_examples=20)
def test_sympy_has_the_values_of_the_torque(tree, data):
    q = data.draw(configurations(tree.n))
    gravity = GravityModel(tree)
    angles = dict(zip(sympy.symbols(f"q1:{tree.n + 1}", real=True), map(float, q), strict=True))
    scale = 1e-3 + gravity.potential.gradient_bound().max(initial=0.0)
    for exact in (True, False):
        vector = gravity_sympy(gravity, exact=exact)
        assert vector.shape == (tree.n, 1)
        values = [float(component.subs(angles)) for component in vector]
        np.testing.assert_allclose(values, gravity.torque(q), rtol=0, atol=1e-11 * scale)


def test_sympy_is_exact_or_in_floats():
    gravity = GravityModel(load_robot("2r"))
    exact = gravity_sympy(gravity)[1]
    assert exact.atoms(sympy.Rational)
    assert not exact.atoms(sympy.Float)
    lever = sympy.Rational(*(0.125).as_integer_ratio())
    g = sympy.Rational(*(9.81).as_integer_ratio())
    q1, q2 = sympy.symbols("q1 q2", real=True)
    assert sympy.expand(exact - 5 * g * lever * sympy.cos(q1 + q2)) == 0
    assert gravity_sympy(gravity, exact=False)[1].atoms(sympy.Float)


def test_sympy_takes_the_users_symbols():
    a, b = sympy.symbols("alpha beta")
    vector = gravity_sympy(GravityModel(planar_arm(2)), (a, b))
    assert {a, b} <= vector.free_symbols


def test_sympy_torque_is_the_gradient_of_the_potential():
    gravity = GravityModel(human_arm())
    q = sympy.symbols("q1:4", real=True)
    gradient = [sympy.diff(gravity.potential.to_sympy(q), x) for x in q]
    assert (gravity_sympy(gravity) - sympy.Matrix(gradient)).expand() == sympy.zeros(3, 1)


def test_latex_of_symbols_groups_sums():
    latex = gravity_latex(GravityModel(planar_arm(2)), [r"\theta_1", r"\theta_2"])
    assert latex.splitlines()[1] == (
        r"g_{1} &= g \left(c_{1} m_{1} + l_{1} m_{2}\right) \cos\left(\theta_1\right)"
        r" + c_{2} g m_{2} \cos\left(\theta_1 + \theta_2\right) \\"
    )


def test_latex_writes_tiny_numbers_as_powers_of_ten():
    tree = load_robot("2r").tree
    light = GravityModel(type(tree)(**{**vars(tree), "gravity": tree.gravity * 1e-7}))
    row = gravity_latex(light).splitlines()[2]
    assert row == r"g_{2} &= 6.13125 \cdot 10^{-7} \cos\left(q_{1} + q_{2}\right)"


@pytest.mark.parametrize(
    ("name", "latex"),
    [
        ("elbow", r"\mathrm{elbow}"),
        ("wrist_1", r"\mathrm{wrist\_1}"),
        ("a b", r"\mathrm{a\ b}"),
        ("50%{#$&}", r"\mathrm{50\%\{\#\$\&\}}"),
        ("x^2~\\", r"\mathrm{x\hat{\ }2\sim \backslash }"),
    ],
)
def test_joint_names_are_escaped_for_latex(name, latex):
    assert latex_name(name) == latex
