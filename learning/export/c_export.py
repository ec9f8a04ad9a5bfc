"""A learned model as C source for a controller."""

from __future__ import annotations

from collections.abc import Sequence

from isotorque.learning.export.forms.c_tables import comment
from isotorque.learning.export.forms.torque_form import TorqueForm
from isotorque.symbolic.common.errors import InputError


def c_source(form: TorqueForm, about: Sequence[str] = (), joints: Sequence[str] = ()) -> str:
    """Write a torque form as one C99 function that needs nothing but ``math.h``.

    Parameters
    ----------
    form
        What to write, see `torque_form`.
    about
        Lines for the comment at its head: what was learned, on which robot.
    joints
        Names of the joints, for the same comment.

    Returns
    -------
    str
        Source of ``void isotorque_gravity(const double *q, double *tau)``: n joint angles [rad]
        in, n torques that hold the arm at rest [N m] out. Everything else in it is ``static``; it
        allocates nothing and has no state but constant tables. ``q`` and ``tau`` may be the same
        array.

    Raises
    ------
    InputError
        If there is not one torque per joint.

    Examples
    --------
    >>> import numpy as np
    >>> from isotorque.learning.export.forms.waves import Waves
    >>> pendulum = Waves(np.array([[1]]), np.array([[6.13]]), np.array([[0.0]]))
    >>> [line for line in c_source(pendulum).splitlines() if line.startswith("void")]
    ['void isotorque_gravity(const double *q, double *tau)']
    """
    if form.outputs != form.joints:
        raise InputError("export", "torques per sample", form.outputs, f"{form.joints} (joints)")
    lines = [*about, ""] if about else []
    lines += ["q: joint angles [rad]; tau: torques that hold the arm at rest [N m]"]
    if joints:
        lines[-1] += "; in this order:"
        lines += [f"  {i} {name}" for i, name in enumerate(joints)]
    lines += ["", "Compile with `cc -O2 -c`, link with -lm."]
    return f"{comment(lines)}\n#include <math.h>\n\n{form.c_source()}"
