"""A learned model as a CasADi function, for optimal control."""

from __future__ import annotations

from typing import Any

import casadi
import numpy as np
from numpy.typing import ArrayLike

from isotorque.learning.export.forms.torque_form import TorqueForm


class CasadiSpace:
    """CasADi's matrix expressions as a `Space`."""

    def constant(self, table: ArrayLike) -> Any:
        """See `Space`."""
        return casadi.MX(casadi.DM(np.asarray(table, dtype=float)))

    def cos(self, x: Any) -> Any:
        """See `Space`."""
        return casadi.cos(x)

    def sin(self, x: Any) -> Any:
        """See `Space`."""
        return casadi.sin(x)

    def exp(self, x: Any) -> Any:
        """See `Space`."""
        return casadi.exp(x)

    def tanh(self, x: Any) -> Any:
        """See `Space`."""
        return casadi.tanh(x)

    def floor(self, x: Any) -> Any:
        """See `Space`."""
        return casadi.floor(x)

    def above(self, parts: list[Any]) -> Any:
        """See `Space`."""
        return casadi.vertcat(*parts)

    def beside(self, parts: list[Any]) -> Any:
        """See `Space`."""
        return casadi.horzcat(*parts)

    def smallest(self, x: Any) -> Any:
        """See `Space`."""
        return casadi.mmin(x)

    def at_most(self, x: Any, limit: Any) -> Any:
        """See `Space`."""
        return x <= limit

    def choose(self, condition: Any, yes: Any, no: Any) -> Any:
        """See `Space`."""
        return casadi.if_else(condition, yes, no)


def casadi_function(form: TorqueForm, name: str = "gravity") -> casadi.Function:
    """Write a torque form as a CasADi function.

    Parameters
    ----------
    form
        What to write, see `torque_form`.
    name
        Name of the function.

    Returns
    -------
    casadi.Function
        ``tau = gravity(q)``, n joint angles [rad] to n torques [N m], made of MX operations on
        whole tables: a local linear map of thousands of prototypes is some dozen nodes.
        Differentiate it, ``map`` it over columns or ``save`` it as usual.

    References
    ----------
    Andersson et al., CasADi, Mathematical Programming Computation 11, 2019.

    Examples
    --------
    >>> from isotorque.learning.export.forms.waves import Waves
    >>> gravity = casadi_function(Waves(np.array([[1]]), np.array([[6.13]]), np.array([[0.0]])))
    >>> print(gravity([0.0]))
    6.13
    """
    q = casadi.MX.sym("q", form.joints)
    return casadi.Function(name, [q], [form.torque(CasadiSpace(), q)], ["q"], ["tau"])
