"""Mass matrix check: refusal of arms whose mass matrix is singular."""

from __future__ import annotations

import numpy as np

from isotorque.learning.simulator.dynamics.equations import Equations
from isotorque.symbolic.common.errors import InputError

_SAMPLES = 16
_SMALLEST = 1e-9
_ROUNDING = 1e-14  # of the arm's largest inertia


def check_mass_matrix(equations: Equations, where: str, joint_names: tuple[str, ...]) -> None:
    """Make sure that every torque has a finite acceleration.

    Parameters
    ----------
    equations
        Equations of motion of the arm.
    where
        What to call the robot in an error.
    joint_names
        Names of the joints.

    Raises
    ------
    InputError
        Naming the joint that moves next to no inertia in some configuration.

    Notes
    -----
    A massless link is legal elsewhere, and here as long as what it carries has inertia. The matrix
    is scaled to a unit diagonal first, so light joints beside heavy ones are no trouble.
    """
    rng = np.random.default_rng(0)
    for q in rng.uniform(-np.pi, np.pi, (_SAMPLES, equations.n)):
        mass = equations.mass_matrix(q)
        diagonal = np.diag(mass)
        ratio = 0.0
        joint = int(np.argmin(diagonal))
        if diagonal[joint] > _ROUNDING * diagonal.max():
            scale = diagonal**-0.5
            values, vectors = np.linalg.eigh(mass * np.outer(scale, scale))
            ratio = float(values[0])
            joint = int(np.argmax(abs(vectors[:, 0])))
        if not ratio > _SMALLEST:
            raise InputError(
                where,
                f"inertia moved by joint '{joint_names[joint]}'",
                "zero or not positive: the mass matrix is singular",
                "links with mass and inertia, such that the mass matrix is positive definite",
            )
