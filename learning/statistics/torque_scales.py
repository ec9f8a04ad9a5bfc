"""Scales and signs of single joints' torques that differ from those of the others.

Torques of one potential belong together: the derivative of joint i's torque by angle j is that of
joint j's by angle i. A sensor that shows 1.3 times the torque, or its opposite, breaks that, and no
number of samples mends it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.potential.errors_in_variables import torque_features
from isotorque.learning.relations.potential.potential_fit import Frequencies
from isotorque.learning.statistics.tails import tail_probability

Array = NDArray[np.float64]

STEPS, SETTLED = 20, 1e-9
"""Steps of Gauss and Newton, from a start that is exact without noise, and when they end."""
MOST_COLUMNS = 300
"""Larger fits are not tried: five joints have 242 coefficients, six 728."""
SIGNIFICANCE, SURE, SMALLER = 1e-6, 5.0, 3.0
"""Scales are told if chance does so well more rarely than this, their distance from 1 is that many
standard errors, and they leave so many times smaller residuals."""
OPPOSITE = 0.1
"""Scales so near to -1 are called a sign."""


@dataclass(frozen=True, eq=False)
class TorqueScales:
    """Factors of the joints' torques with which one potential explains them.

    Attributes
    ----------
    joints : (k,) int array
        Joints that have torques and are coupled.
    scales, errors : (k,) arrays
        What is measured over what the potential says, 1 for most joints, and standard errors.
    p_value : float
        Chance of such an improvement, or a larger one, if all scales are equal.
    residual : float
        Root mean square of what is left [N m].
    """

    joints: NDArray[np.intp]
    scales: Array
    errors: Array
    p_value: float
    residual: float

    def __str__(self) -> str:
        odd = np.flatnonzero(np.abs(self.scales - 1.0) > SURE * self.errors)
        names = [f"the torque of joint {j + 1}" for j in self.joints]
        if len(names) == 2:
            scale, j = self.scales[odd[0]], int(odd[0])
            if abs(scale) < 1.0 - OPPOSITE:
                scale, j = 1.0 / scale, 1 - j
            error = float(self.errors.max()) * max(1.0, scale**2)
            other = f"beside {names[1 - j]}, or the other way round: two joints do not tell"
            return f"{names[j]} {_said(scale, error)} {other}"
        parts = [f"{names[j]} {_said(self.scales[j], self.errors[j])}" for j in odd]
        return f"beside the other joints {'; '.join(parts)}"


def _said(scale: float, error: float) -> str:
    if abs(scale + 1.0) < OPPOSITE:
        return "has the wrong sign"
    return f"is {scale:.3g} (standard error {error:.1g}) times what one potential allows"


def torque_scales(q: Array, tau: Array, frequencies: Frequencies) -> TorqueScales | None:
    """Look for factors of single joints' torques with which one potential fits far better.

    Parameters
    ----------
    q, tau : (N, n) arrays
        One sample per pose [rad], [N m].
    frequencies : (m, n) int array
        Those that the potential may have.

    Returns
    -------
    TorqueScales or None
        None where equal scales do as well, or the samples do not tell.

    Notes
    -----
    One scale is free: a potential may be that many times larger. It is chosen so that as many
    scales as possible are 1; of two joints nobody can say which is wrong. A constant torque of each
    joint is fitted too. Least squares with ``c_j tau_j = g_j(q)`` is the start, which noise of the
    torques biases; Gauss-Newton steps on ``tau_j - g_j(q) / c_j`` end there.

    Examples
    --------
    >>> from isotorque.learning.relations.potential.potential_fit import all_frequencies
    >>> q = np.random.default_rng(0).uniform(-3.0, 3.0, (40, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, -lower], axis=1)
    >>> print(torque_scales(q, tau, all_frequencies(2)))
    the torque of joint 2 has the wrong sign beside the torque of joint 1, or the other way round:
    two joints do not tell
    """
    joints = np.flatnonzero(frequencies.any(axis=0) & tau.any(axis=0))
    k, count = len(joints), len(q)
    # the joint with the largest torque is the unit at first
    joints = joints[np.argsort(-np.abs(tau[:, joints]).max(axis=0, initial=0.0), kind="stable")]
    features = torque_features(frequencies, q)[:, joints]
    constants = np.broadcast_to(np.eye(k), (count, k, k))
    columns = np.concatenate([constants, features], axis=2)
    width = columns.shape[2]
    freedom = count * k - width - (k - 1)
    if k < 2 or freedom < 2 or width > MOST_COLUMNS:
        return None
    measured = tau[:, joints]
    design, target = columns.reshape(count * k, width), measured.ravel()
    plain = target - design @ np.linalg.lstsq(design, target, rcond=None)[0]
    own = np.zeros((count, k, k - 1))
    for j in range(1, k):
        own[:, j, j - 1] = -measured[:, j]
    first = np.zeros((count, k))
    first[:, 0] = measured[:, 0]
    whole = np.concatenate([columns, own], axis=2).reshape(count * k, -1)
    found = np.linalg.lstsq(whole, first.ravel(), rcond=None)[0]
    inverse = np.concatenate([[1.0], found[width:]])
    if np.abs(inverse).min() < 1e-6 * np.abs(inverse).max():
        return None
    scales, estimate = 1.0 / inverse, found[:width]
    jacobian, left = whole, plain
    for _ in range(STEPS):
        torque = columns @ estimate
        own = np.zeros((count, k, k - 1))
        for j in range(1, k):
            own[:, j, j - 1] = torque[:, j]
        jacobian = np.concatenate([scales[:, None] * columns, own], axis=2).reshape(count * k, -1)
        left = (measured - scales * torque).ravel()
        step, _, rank, _ = np.linalg.lstsq(jacobian, left, rcond=1e-10)
        estimate, scales = estimate + step[:width], scales + np.append(0.0, step[width:])
        if np.abs(step[width:]).max() < SETTLED * np.abs(scales).max():
            break
    if rank < jacobian.shape[1]:  # joints that are not coupled have scales of their own
        return None
    squares, before = float(left @ left), float(plain @ plain)
    variance = max(squares, 1e-24 * float(target @ target)) / freedom
    covariance = variance * np.linalg.inv(jacobian.T @ jacobian)[width:, width:]
    statistic = (before - squares) / variance
    p_value = tail_probability(statistic, k - 1, float(freedom))
    if not p_value < SIGNIFICANCE or before < SMALLER**2 * squares:
        return None
    scales, errors = _with_most_equal(scales, covariance)
    if not (np.abs(scales - 1.0) > SURE * errors).any():
        return None
    order = np.argsort(joints)
    residual = float(np.sqrt(squares / (count * k)))
    return TorqueScales(joints[order], scales[order], errors[order], p_value, residual)


def _with_most_equal(scales: Array, covariance: Array) -> tuple[Array, Array]:
    """Divide by the scale that most others share, and propagate the errors."""
    k = len(scales)
    whole = np.zeros((k, k))
    whole[1:, 1:] = covariance
    best: tuple[int, Array, Array] | None = None
    for r in range(k):
        ratio = scales / scales[r]
        slope = np.eye(k) / scales[r]
        slope[:, r] -= ratio / scales[r]
        errors = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slope, whole, slope), 0.0))
        equal = int((np.abs(ratio - 1.0) <= SURE * errors).sum())
        if best is None or equal > best[0]:
            best = (equal, ratio, errors)
    assert best is not None
    return best[1], best[2]
