"""The complete group of primary symmetries of a gravity potential."""

from __future__ import annotations

import numpy as np

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.approximate_symmetries import maximal_groups
from isotorque.symbolic.symmetries.exact_symmetries import exact_symmetries


def primary_symmetries(potential: TrigonometricPolynomial, tolerance: float = 0.0) -> SymmetryGroup:
    """Return all affine maps q -> A q + d with g(A q + d) = Y g(q), Y = diag(+-1), g = grad U.

    Parameters
    ----------
    potential
        Gravity potential U [J] (or a fitted one), with float, exact or SymPy coefficients.
    tolerance
        0 for the symmetries of U itself. A positive tolerance [N m] gives the largest
        eps-symmetry group: the exact group of a nearby symmetric potential, every relation of
        which errs by at most ``tolerance`` in any torque, proved. See
        `maximal_groups` for all maximal ones.

    Returns
    -------
    SymmetryGroup
        Its ``order`` counts relations modulo free directions and 2 pi. ``exact`` relations are
        proved over the rationals (bound 0); the others carry a proved bound [N m].

    Raises
    ------
    InputError
        If the tolerance is negative or not a number.

    Notes
    -----
    (A, d, Y) is such a map iff there are signs s_k with A^T k = s_k Y k and
    C_{s_k Y k} = s_k C_k exp(i k.d) for every frequency k of U. The signs are constant on the
    connected components of the linear matroid of the frequencies; Y must map the support to
    itself; d solves congruences on a basis of the lattice of frequencies. Nothing is searched
    numerically, so the list is complete.

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> group = primary_symmetries(U)
    >>> group.order
    8
    >>> print(max(float(r.bound.max()) for r in group) < 1e-13)
    True
    """
    if not (np.isfinite(tolerance) and tolerance >= 0):
        raise InputError("symmetries", "tolerance", tolerance, "a number >= 0 [N m]")
    if tolerance > 0:
        return maximal_groups(potential, tolerance)[0]
    return exact_symmetries(potential)
