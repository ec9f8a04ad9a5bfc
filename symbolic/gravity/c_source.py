"""The gravity torque as C source for a controller."""

from __future__ import annotations

import re
import textwrap

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.straight_line_program import (
    GravityProgram,
    Terms,
    Wave,
    cheaper_program,
)


def gravity_c(model: GravityModel, program: GravityProgram | None = None) -> str:
    """Write the gravity torque as one C99 function that needs nothing but ``math.h``.

    Parameters
    ----------
    model
        A gravity model without symbols.
    program
        The form to write; by default the cheaper one of
        `cheaper_program`.

    Returns
    -------
    str
        Source of ``void isotorque_gravity(const double *q, double *tau)``: n joint angles [rad]
        in, n torques that hold the arm at rest [N m] out; no other symbol, no memory, no state.
        ``q`` and ``tau`` may be the same array.

    Raises
    ------
    InputError
        If the model contains symbols besides the joint angles.

    Notes
    -----
    Numbers are written so that C reads back the same doubles. ``examples/call_gravity.c`` calls
    the function.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> print(gravity_c(GravityModel(load_robot("pendulum"))).partition("#include <math.h>")[2])
    <BLANKLINE>
    <BLANKLINE>
    void isotorque_gravity(const double *q, double *tau)
    {
        const double cos1 = cos(q[0]);
        tau[0] = 6.13125... * cos1;
    }
    <BLANKLINE>
    """
    program = program or cheaper_program(model.chain, model.significant_potential)
    lines = [_statement(f"const double {w.name}", _wave(w)) for w in program.waves]
    lines += [_statement(f"const double {s.name}", _sum(s.terms)) for s in program.sums]
    lines += [_statement(f"tau[{i}]", _sum(t)) for i, t in enumerate(program.torques)]
    if not program.waves:
        lines.insert(0, "    (void)q;")
    return "\n".join(
        [
            _header(model),
            "#include <math.h>",
            "",
            "void isotorque_gravity(const double *q, double *tau)",
            "{",
            *lines,
            "}",
            "",
        ]
    )


def _header(model: GravityModel) -> str:
    text = [f"Gravity torque of {model.name}, written by Isotorque.", ""]
    text += [f"Warning: {warning}" for warning in model.warnings] + [""] * bool(model.warnings)
    text += ["q: joint angles [rad]; tau: torques that hold the arm at rest [N m]; in this order:"]
    text += [f"  {i} {name}" for i, name in enumerate(model.joint_names)]
    text += ["", "Compile with `cc -O2 -c`, link with -lm."]
    # A name must neither end the comment nor open another one.
    safe = [re.sub(r"[*\\?\x00-\x1f]", "_", line) for line in text]
    return "/* " + "\n".join(f" * {line}".rstrip() for line in safe)[3:] + "\n */"


def _statement(left: str, right: str) -> str:
    return textwrap.fill(
        f"{left} = {right};",
        100,
        initial_indent="    ",
        subsequent_indent="        ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def _wave(wave: Wave) -> str:
    phase = ""
    for joint, factor in enumerate(wave.frequency):
        if factor:
            size = f"q[{joint}]" if abs(factor) == 1 else f"{abs(factor)} * q[{joint}]"
            sign = "-" if factor < 0 else "+"
            phase += (f" {sign} " if phase else sign.strip("+")) + size
    return f"{wave.function}({phase})"


def _sum(terms: Terms) -> str:
    text = ""
    for factor, names in terms:
        sign = "-" if factor < 0 else "+"
        size = [] if abs(factor) == 1 and names else [repr(abs(factor))]
        text += (f" {sign} " if text else sign.strip("+")) + " * ".join([*size, *names])
    return text or "0.0"
