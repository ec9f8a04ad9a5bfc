"""The equations |dU/dq| = |torque| in the active coordinates y = B q."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from isotorque.symbolic.common.arrays import Floats
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

RELATIVE = 1e-10
"""Torques that differ by less, relative to the largest the arm can need, count as equal."""
NEAR = 1e-3
"""Only solutions nearer than this [rad] are asked whether they are one."""


@dataclass(frozen=True, eq=False)
class LevelSetEquations:
    """The gravity torque as a function of y = B q, and the targets it is to meet.

    Attributes
    ----------
    potential : TrigonometricPolynomial
        U as a polynomial in y; its gradient h gives the torque B^T h(y).
    basis : (r, n) array
        The rows B.
    lift : (n, r) array
        Right inverse of B: ``q = lift y`` is one configuration for y (others differ along free
        directions).
    scale : float
        Bound on any torque of the arm [N m].
    torques : (s, n) array
        The torques to meet: the given one with any signs, each once, without those that no
        function of y can need.
    targets : (s, r) array
        The gradient h that each of them asks for.
    """

    potential: TrigonometricPolynomial
    basis: Floats
    lift: Floats
    scale: float
    torques: Floats
    targets: Floats

    @property
    def accuracy(self) -> float:
        """Torques nearer than this count as equal [N m]."""
        return RELATIVE * self.scale

    def same(self, first: Floats, second: Floats, target: Floats) -> np.ndarray:
        """Say which of the solutions ``first`` (.., r) and ``second`` (.., r) are one.

        They are where they agree to rounding, or where the middle between them solves the
        equations as well (a double solution, which cannot be found more sharply than that).
        """
        away = np.remainder(second - first + np.pi, 2 * np.pi) - np.pi
        distance = np.abs(away).max(axis=-1, initial=0.0)
        one = distance < 1e-8
        close = ~one & (distance < NEAR)
        if np.any(close):
            middle = (first + away / 2)[close]
            wanted = np.broadcast_to(target, first.shape)[close]
            miss = np.abs(self.potential.gradient(middle) - wanted).max(axis=-1, initial=0.0)
            one[close] = miss <= self.accuracy
        return one


def level_set_equations(
    potential: TrigonometricPolynomial, torque: Floats, group: SymmetryGroup
) -> LevelSetEquations:
    """Write |g(q)| = |torque| in active coordinates.

    Raises
    ------
    InputError
        If the torque has the wrong length or is not finite.
    """
    if torque.shape != (potential.n,):
        raise InputError("level set", "shape of the torque", torque.shape, f"({potential.n},)")
    if not np.isfinite(torque).all():
        raise InputError("level set", "torque", torque.tolist(), "finite numbers [N m]")
    numeric = potential.significant().to_float()
    basis = group.basis.astype(float)
    r = len(basis)
    lift = np.asarray(np.linalg.inv(group.completion)[:, :r], dtype=float)
    frequencies = np.rint(numeric.frequencies @ lift).astype(np.int64)
    inner = TrigonometricPolynomial(frequencies, numeric.cos, numeric.sin)
    scale = float(numeric.gradient_bound().max(initial=0.0)) or 1.0
    choices = [(1.0,) if abs(x) <= 1e-12 * scale else (1.0, -1.0) for x in torque]
    wanted = np.array(list(itertools.product(*choices))) * torque
    targets = wanted @ lift
    reachable = np.abs(wanted - targets @ basis).max(axis=1, initial=0.0) <= RELATIVE * scale
    reachable &= np.all(np.abs(torque) <= numeric.gradient_bound() + RELATIVE * scale)
    return LevelSetEquations(inner, basis, lift, scale, wanted[reachable], targets[reachable])
