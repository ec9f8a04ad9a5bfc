"""Checks of a body for numbers that no arm has, before they do harm."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from isotorque.symbolic.common.errors import InputError

if TYPE_CHECKING:
    from isotorque.symbolic.robots.arm_body import ArmBody

LARGEST = 1e50
"""No number of an arm is that large; squares of products of three still fit into a double."""
SMALLEST_MASS = 1e-12
"""No arm weighs less [kg]; Pinocchio takes inertias of 1e-16 kg and less for none."""


def check_body(body: ArmBody, where: str) -> None:
    """Refuse an arm with numbers that no arm has.

    Parameters
    ----------
    body
        The arm.
    where
        What to call it in an error.

    Raises
    ------
    InputError
        For numbers that are not finite, negative masses or damping, and placements that are not
        rotations, naming the joint; for masses of all links that Pinocchio cannot add. Limits are
        looked at where they matter (`check_limits`).
    """
    for field, accepted in (
        ("masses", "finite masses [kg]"),
        ("levers", "finite centres of mass [m]"),
        ("inertias", "finite inertias [kg m^2]"),
        ("translations", "finite positions [m]"),
        ("rotations", "rotation matrices"),
        ("axes", "unit axes"),
        ("damping", "finite damping [N m s/rad]"),
    ):
        for name, values in zip(body.joint_names, getattr(body, field), strict=True):
            if not np.all(np.abs(values) < LARGEST):
                raise InputError(where, f"{field} of joint '{name}'", values, accepted)
    if not np.all(np.abs(body.gravity) < LARGEST):
        raise InputError(where, "gravity", body.gravity, "a finite acceleration [m/s^2]")
    weight = float(np.abs(body.masses).sum())
    if 0.0 < weight < SMALLEST_MASS:
        accepted = f"0, or at least {SMALLEST_MASS:g} kg"
        raise InputError(where, "mass of all moving links", f"{weight:.3g} kg", accepted)
    for i, name in enumerate(body.joint_names):
        if body.masses[i] < 0:
            raise InputError(where, f"mass of joint '{name}'", body.masses[i], "a number >= 0 [kg]")
        if body.damping[i] < 0:
            raise InputError(where, f"damping of joint '{name}'", body.damping[i], "a number >= 0")
        if np.isnan(body.limits[i]).any():
            raise InputError(where, f"limits of joint '{name}'", body.limits[i], "numbers [rad]")
        rotation = body.rotations[i]
        if abs(rotation @ rotation.T - np.eye(3)).max() > 1e-6 or np.linalg.det(rotation) < 0:
            raise InputError(
                where, f"placement of joint '{name}'", rotation.tolist(), "a rotation matrix"
            )
