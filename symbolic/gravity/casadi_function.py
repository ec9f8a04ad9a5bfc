"""The gravity torque as a CasADi function."""

from __future__ import annotations

import casadi

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.straight_line_program import GravityProgram, Terms, cheaper_program


def gravity_casadi(
    model: GravityModel, program: GravityProgram | None = None, name: str = "gravity"
) -> casadi.Function:
    """Return the gravity torque as a CasADi function, for optimal control and code generation.

    Parameters
    ----------
    model
        A gravity model without symbols.
    program
        The form to use; by default the cheaper one of
        `cheaper_program`.
    name
        Name of the function.

    Returns
    -------
    casadi.Function
        ``tau = gravity(q)``, n joint angles [rad] to n torques [N m], made of SX operations;
        differentiate it, ``map`` it over columns or ``save`` it as usual.

    Raises
    ------
    InputError
        If the model contains symbols besides the joint angles.

    References
    ----------
    Andersson et al., CasADi, Mathematical Programming Computation 11, 2019.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> gravity = gravity_casadi(GravityModel(load_robot("2r")))
    >>> gravity
    Function(gravity:(q[2])->(tau[2]) SXFunction)
    >>> print(gravity([0.0, 0.0]))
    [24.525, 6.13125]
    """
    program = program or cheaper_program(model.chain, model.significant_potential)
    q = casadi.SX.sym("q", program.n)
    values: dict[str, casadi.SX] = {}
    for wave in program.waves:
        phase = sum((k * q[i] for i, k in enumerate(wave.frequency) if k), casadi.SX(0))
        values[wave.name] = casadi.cos(phase) if wave.function == "cos" else casadi.sin(phase)

    def total(terms: Terms) -> casadi.SX:
        result = casadi.SX(0)
        for factor, names in terms:
            product = casadi.SX(factor)
            for variable in names:
                product = product * values[variable]
            result = result + product
        return result

    for statement in program.sums:
        values[statement.name] = total(statement.terms)
    torque = casadi.vertcat(*(total(terms) for terms in program.torques))
    return casadi.Function(name, [q], [torque], ["q"], ["tau"])
