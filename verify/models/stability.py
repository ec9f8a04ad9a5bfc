"""Stability: the configurations that an arm can hold by a constant torque alone."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup


def is_stable(q: ArrayLike, gravity: GravityModel) -> NDArray[np.bool_]:
    """Say whether configurations are stable equilibria under their own gravity torque.

    Parameters
    ----------
    q
        Configurations (m, n) [rad].
    gravity
        The gravity torque.

    Returns
    -------
    (m,) bool array
        Whether the stiffness dg/dq is positive definite on the combinations of joints that the
        torque depends on; along other directions nothing pushes back and nothing needs to.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> gravity = GravityModel(load_robot("2r"))
    >>> is_stable([[-1.5, 0.0], [1.5, 0.0]], gravity)
    array([ True, False])
    """
    span = scipy.linalg.orth(gravity.potential.frequencies.T.astype(float))
    if not span.size:
        return np.ones(len(np.asarray(q)), dtype=bool)
    stiffness = span.T @ gravity.stiffness(q) @ span
    return np.asarray(np.linalg.eigvalsh(stiffness)[:, 0] > 0)


def has_stable_image(
    q: ArrayLike, gravity: GravityModel, group: SymmetryGroup
) -> NDArray[np.bool_]:
    """Say for which configurations (m, n) some symmetric one is stable.

    What is learned there by an arm that must hold itself reaches these configurations and no
    others: all of the 2R arm's, a fifth of the 3R arm's.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
    >>> gravity = GravityModel(load_robot("3r"))
    >>> q = np.random.default_rng(0).uniform(-np.pi, np.pi, (4000, 3))
    >>> share = has_stable_image(q, gravity, primary_symmetries(gravity.potential)).mean()
    >>> bool(0.20 < share < 0.23)
    True
    """
    found = np.zeros(len(np.asarray(q)), dtype=bool)
    for image in group.orbit(q):
        found |= is_stable(image, gravity)
    return found
