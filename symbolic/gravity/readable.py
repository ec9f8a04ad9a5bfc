"""The gravity torque to read: as text, as LaTeX and as SymPy expressions."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.polynomials.coefficients import is_expression, is_zero, to_float
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

if TYPE_CHECKING:
    import sympy


def gravity_text(model: GravityModel) -> str:
    """Write the potential and the torque of every joint, one line each.

    Parameters
    ----------
    model
        Any gravity model.

    Returns
    -------
    str
        Lines ``U = ...`` [J] and ``g_i = ...`` [N m] in angles q1, q2, .. [rad], before them
        what is doubtful about the robot's masses, and the joint that each angle belongs to, where
        its name is another.

    Examples
    --------
    >>> from isotorque.symbolic.robots.kinematic_tree import planar_arm
    >>> print(gravity_text(GravityModel(planar_arm(2))))
    U   = g*(c1*m1 + l1*m2)*sin(q1) + c2*g*m2*sin(q1 + q2)
    g_1 = g*(c1*m1 + l1*m2)*cos(q1) + c2*g*m2*cos(q1 + q2)
    g_2 = c2*g*m2*cos(q1 + q2)
    """
    names = [f"q{i + 1}" for i in range(model.n)]
    lines = [f"warning: {warning}" for warning in model.warnings]
    lines += [
        f"{q} = {joint}" for q, joint in zip(names, model.joint_names, strict=True) if q != joint
    ]
    rows = {"U": model.significant_potential}
    rows |= {f"g_{i + 1}": f for i, f in enumerate(model.components)}
    width = max(map(len, rows))
    lines += [f"{row:{width}} = {f.renamed(names)}" for row, f in rows.items()]
    return "\n".join(lines)


def gravity_latex(model: GravityModel, symbols: Sequence[str] | None = None) -> str:
    r"""Write the torque as a LaTeX ``aligned`` block.

    Parameters
    ----------
    model
        Any gravity model.
    symbols
        LaTeX of the joint angles, by default ``q_{1}``, ``q_{2}``, ..; use
        ``[latex_name(x) for x in model.joint_names]`` for the names of the joints.

    Returns
    -------
    str
        One row ``g_{i} &= ...`` per joint, coefficients in N m with six digits; before it comments
        with what is doubtful about the robot's masses.

    Examples
    --------
    >>> from isotorque.symbolic.robots.kinematic_tree import planar_arm
    >>> print(gravity_latex(GravityModel(planar_arm(1))))
    \begin{aligned}
    g_{1} &= c_{1} g m_{1} \cos\left(q_{1}\right)
    \end{aligned}
    """
    names = symbols or [f"q_{{{i + 1}}}" for i in range(model.n)]
    rows = [
        f"g_{{{i + 1}}} &= {_polynomial_latex(f, names)}" for i, f in enumerate(model.components)
    ]
    said = "".join(f"% warning: {warning}\n" for warning in model.warnings)
    return said + "\\begin{aligned}\n" + " \\\\\n".join(rows) + "\n\\end{aligned}"


def latex_name(name: str) -> str:
    r"""Return a joint name as upright LaTeX, with special characters escaped.

    Examples
    --------
    >>> print(latex_name("wrist_1"))
    \mathrm{wrist\_1}
    """
    special = {"\\": r"\backslash ", "^": r"\hat{\ }", "~": r"\sim ", " ": r"\ "}
    escaped = re.sub(
        r"[\\^~ #$%&_{}]", lambda found: special.get(found[0], "\\" + found[0]), str(name)
    )
    return rf"\mathrm{{{escaped}}}"


def gravity_sympy(
    model: GravityModel,
    symbols: Sequence[sympy.Symbol] | None = None,
    *,
    exact: bool = True,
) -> sympy.Matrix:
    """Return the torque as a column of SymPy expressions.

    Parameters
    ----------
    model
        Any gravity model.
    symbols
        The joint angles, by default real symbols q1, q2, ..
    exact
        Whether numbers are the exact rationals that the floats of a robot stand for, or floats.

    Returns
    -------
    sympy.Matrix
        Shape (n, 1) [N m].

    Examples
    --------
    >>> from isotorque.symbolic.robots.kinematic_tree import planar_arm
    >>> gravity_sympy(GravityModel(planar_arm(2)))[1]
    c2*g*m2*cos(q1 + q2)
    """
    import sympy

    q = tuple(symbols or sympy.symbols(f"q1:{model.n + 1}", real=True))
    components = model.components
    if not (exact or model.is_symbolic):
        components = tuple(f.to_float() for f in components)
    return sympy.Matrix([f.to_sympy(q) for f in components])


def _polynomial_latex(f: TrigonometricPolynomial, names: Sequence[str]) -> str:
    text = ""
    for k, a, b in zip(f.frequencies.tolist(), f.cos, f.sin, strict=True):
        phase = _phase_latex(k, names)
        for value, function in ((a, r"\cos"), (b, r"\sin")):
            if is_zero(value):
                continue
            wave = rf" {function}\left({phase}\right)" if phase else ""
            sign, size = _coefficient_latex(value)
            text += (f" {sign} " if text else sign.strip("+")) + size + wave
    return text or "0"


def _coefficient_latex(value: Any) -> tuple[str, str]:
    """Return sign and absolute value of a coefficient."""
    if is_expression(value):
        import sympy

        factored = sympy.factor_terms(value)
        negative = factored.could_extract_minus_sign()
        size = sympy.latex(-factored if negative else factored)
        if isinstance(factored, sympy.Add):
            size = rf"\left({size}\right)"
        return "-" if negative else "+", size
    number = to_float(value)
    mantissa, _, exponent = f"{abs(number):.6g}".partition("e")
    power = rf" \cdot 10^{{{int(exponent)}}}" if exponent else ""
    return "-" if number < 0 else "+", mantissa + power


def _phase_latex(k: Sequence[int], names: Sequence[str]) -> str:
    text = ""
    for factor, name in zip(k, names, strict=True):
        if factor:
            sign = "-" if factor < 0 else "+"
            size = name if abs(factor) == 1 else f"{abs(factor)} {name}"
            text += (f" {sign} " if text else sign.strip("+")) + size
    return text
