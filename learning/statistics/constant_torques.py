"""Constant torques of joints that samples show beside a model that has no term for them.

A torque sensor's zero, a cable that always pulls, friction approached from one side: none of it is
gravity. Left out of a fit it bends the coefficients and passes for noise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.tails import tail_probability

Array = NDArray[np.float64]

OR_FRICTION = (
    ", or friction approached from one side: not to be told apart without approach directions"
)
"""Said wherever constants are named: joints that always stop moving the same way show the same."""

SIGNIFICANCE = 1e-4
"""Chance with which a constant is seen on any joint where there is none."""
NEGLIGIBLE = 1e-6
"""Constants below this share of the largest torque are where motions ended."""
DEPENDENT = 1e-6
"""Constants that the model holds itself, up to this share, are its own."""
SPARE = 2
"""Degrees of freedom that must be left per joint, to know its noise."""
SPARE_NOISY = 10.0
"""The same where samples are not exact: errors of angles are larger where the torque is steep, and
few samples do not show that."""
EXACT = 1e-9
"""Residuals below this share of the largest torque are rounding."""


def constants_in_words(joints: NDArray[np.intp], sizes: Array, errors: Array) -> str:
    """Name constant torques with their standard errors, and what else shows the same.

    Parameters
    ----------
    joints : (k,) array
        Those that have one, numbered from 0.
    sizes, errors : (n,) arrays
        Of all joints [N m].

    Examples
    --------
    >>> said = constants_in_words(np.array([1]), np.array([0.0, 0.3]), np.array([0.1, 0.004]))
    >>> said.startswith("a constant torque of +0.3 N m on joint 2 (standard error 0.004), or ")
    True
    """
    named = "; ".join(
        f"a constant torque of {sizes[j]:+.3g} N m on joint {j + 1} (standard error "
        f"{errors[j]:.1g})"
        for j in joints
    )
    return f"{named}{OR_FRICTION}" if named else ""


def constant_torques(features: Array, torque: Array, weight: Array) -> NDArray[np.intp]:
    """Joints whose torque contains a constant that the columns of a model do not explain.

    Parameters
    ----------
    features : (m, n, p) array
        Columns of a linear model, one sample per pose, not weighted.
    torque : (m, n) array
        Torques [N m].
    weight : (m,) array
        Of the squared errors.

    Returns
    -------
    (k,) int array
        None where samples are too few to tell: there must be two more per joint than coefficients
        and constants.

    Notes
    -----
    All constants are fitted with the model, then the least certain left out one by one until each
    is significant (Student's t, Bonferroni), the noise of every joint being its own.

    Examples
    --------
    >>> q = np.linspace(-1.0, 2.0, 8)
    >>> features, torque = np.cos(q)[:, None, None], 3.0 * np.cos(q)[:, None]
    >>> constant_torques(features, torque, np.ones(8)).tolist()
    []
    >>> constant_torques(features, torque + 0.2, np.ones(8)).tolist()
    [0]
    """
    used = weight > 0.0
    root = np.sqrt(weight[used])[:, None]
    m, n = len(root), torque.shape[1]
    design = (features[used] * root[:, :, None]).reshape(m * n, -1)
    target = (torque[used] * root).ravel()
    largest = float(np.abs(torque).max(initial=0.0))
    left, singular, _ = np.linalg.svd(design, full_matrices=False)
    left = left[:, singular > 1e-11 * singular.max(initial=0.0)]
    if m * n < left.shape[1] + n + SPARE * n:
        return np.zeros(0, dtype=np.intp)
    columns = (root[:, :, None] * np.eye(n)).reshape(m * n, n)
    beyond = columns - left @ (left.T @ columns)
    beyond -= left @ (left.T @ beyond)
    rest = target - left @ (left.T @ target)
    size = np.linalg.norm(beyond, axis=0) / np.linalg.norm(columns, axis=0)
    joints = np.flatnonzero(size > DEPENDENT)
    while len(joints):
        span, triangle = np.linalg.qr(beyond[:, joints])
        if np.abs(np.diag(triangle)).min() < DEPENDENT * np.abs(np.diag(triangle)).max():
            return np.zeros(0, dtype=np.intp)
        inverse = np.linalg.inv(triangle)
        found = inverse @ (span.T @ rest)
        residual = rest - span @ (span.T @ rest)
        lever = (left**2).sum(axis=1) + (span**2).sum(axis=1)
        spare = np.maximum(m - lever.reshape(m, n).sum(axis=0), 0.5)
        level = (residual.reshape(m, n) ** 2).sum(axis=0) / spare
        level = np.maximum(level, (1e-12 * largest) ** 2)
        spread = (span * np.tile(level, m)[:, None]).T @ span
        error = np.sqrt(np.einsum("ij,jk,ik->i", inverse, spread, inverse))
        chance = np.array(
            [
                tail_probability(float((c / e) ** 2), 1, float(spare[j]))
                for c, e, j in zip(found, error, joints, strict=True)
            ]
        )
        chance[np.abs(found) <= NEGLIGIBLE * largest] = 1.0
        few = (spare < SPARE_NOISY) & (level > (EXACT * largest) ** 2)
        chance[few[joints]] = 1.0
        worst = int(np.argmax(chance))
        if chance[worst] < SIGNIFICANCE / n:
            break
        joints = np.delete(joints, worst)
    return joints
