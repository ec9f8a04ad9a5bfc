"""Check that the torque really does not depend on the joints that never needed one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.learning.relations.potential.potential_fit import (
    FittedPotential,
    all_frequencies,
    fit_potential,
    present_frequencies,
)
from isotorque.learning.relations.potential.samples_needed import (
    samples_needed,
    samples_with_torque_needed,
)
from isotorque.symbolic.common.angles import wrap

Array = NDArray[np.float64]

NEVER_MOVED = 1e-6
"""A joint without torque that moved no more than this [rad] stood still."""
BARELY_MOVED = 0.01
"""One that moved no more than this [rad], too little for the samples to tell, stood still too:
other joints shake a joint that nothing holds and that no static torque can drive."""
LEVEL = 1e-4
ZERO_TORQUE = 1e-9


def active_joints(tau: Array, noise: MeasurementNoise | None) -> NDArray[np.bool_]:
    """Which joints ever needed a torque, shape (n,), from torques (N, n) [N m]."""
    magnitude = np.abs(tau)
    level = ZERO_TORQUE * float(magnitude.max(initial=0.0))
    level = max(level, 5.0 * noise.torque if noise else 0.0)
    active: NDArray[np.bool_] = magnitude.max(axis=0, initial=0.0) > level
    return active


def fit_on_active_joints(
    q: Array, tau: Array, noise: MeasurementNoise | None, largest_error: float
) -> tuple[FittedPotential, list[int]]:
    """Fit a potential of the joints that matter.

    Parameters
    ----------
    q, tau : (N, n) arrays
        Samples [rad], [N m].
    noise : MeasurementNoise, optional
    largest_error : float
        See `depends_on_joint`.

    Returns
    -------
    fit : FittedPotential
    unmoved : list of int
        Joints without torque that never moved, so that nothing is known about them.

    Raises
    ------
    Undetermined
        If the samples do not determine the potential, or not whether a joint matters.
    """
    active = active_joints(tau, noise)
    if not active.any():
        raise Undetermined(samples_with_torque_needed(*tau.shape))
    while True:
        fit = fit_potential(q, tau, all_frequencies(q.shape[1], active), noise)
        involved, unmoved = silent_dependence(q, tau, fit, active, largest_error, noise)
        if not involved:
            return fit, unmoved
        active[involved] = True


def depends_on_joint(
    q: Array,
    tau: Array,
    joint: int,
    fit: FittedPotential,
    largest_error: float,
    noise: MeasurementNoise,
) -> bool:
    """Say whether the torque depends on a joint whose own torque was always zero.

    Parameters
    ----------
    q, tau : (N, n) arrays
        Samples [rad], [N m].
    joint : int
        The joint in question.
    fit : FittedPotential
        Potential fitted without it.
    largest_error : float
        Torque an undetected dependence may cause, RMS, relative to the RMS torque.
    noise : MeasurementNoise
        Given or estimated without the joint; its own zero torques would feign precision.

    Returns
    -------
    bool

    Raises
    ------
    Undetermined
        If the samples cannot tell. That is so where a joint that does need torque was only ever
        seen at configurations where it needs none.

    Notes
    -----
    The potential is fitted again with more frequencies: e_j, and k + e_j, k - e_j for all present
    k. A joint that acts on the torque does so through one of them. Where the samples do not
    suffice for all old frequencies beside the new ones, only the present old ones are kept.
    """
    present = fit.frequencies[present_frequencies(fit, LEVEL)]
    unit = np.zeros(q.shape[1], dtype=np.int64)
    unit[joint] = 1
    new = np.concatenate([unit[None], present + unit, present - unit])
    try:
        wider = fit_potential(q, tau, np.concatenate([fit.frequencies, new]), noise)
    except Undetermined:
        wider = fit_potential(q, tau, np.concatenate([present, new]), noise)
    added = wider.frequencies[:, joint] != 0
    if (present_frequencies(wider, LEVEL) & added).any():
        return True
    m = len(added)
    error = np.hypot(wider.standard_error[:m], wider.standard_error[m:])[added]
    doubt = np.sqrt(0.5 * (3.0 * error) ** 2 @ wider.frequencies[added].astype(float) ** 2).max()
    excess = float(doubt / (largest_error * np.sqrt(np.mean(tau**2))))
    if excess > 1.0:
        raise Undetermined(
            f"{samples_needed(wider.samples, excess)}: whether the torque depends on joint "
            f"{joint + 1}, whose own torque was always zero, is lost in the noise"
        )
    return False


def stood_still(
    q: Array, joint: int, noise: MeasurementNoise | None, allowed: float = NEVER_MOVED
) -> bool:
    """Say whether a joint stayed within ``allowed`` [rad] of one angle in all samples."""
    allowed = max(allowed, 6.0 * noise.angle if noise else 0.0)
    return bool((np.abs(wrap(q[:, joint] - q[0, joint])) <= allowed).all())


def silent_dependence(
    q: Array,
    tau: Array,
    fit: FittedPotential,
    active: NDArray[np.bool_],
    largest_error: float,
    noise: MeasurementNoise | None,
) -> tuple[list[int], list[int]]:
    """Examine all joints whose torque was always zero.

    Returns
    -------
    involved : list of int
        Joints the torque depends on after all.
    unmoved : list of int
        Joints that never moved, or too little to tell, so that nothing is known about them.

    Raises
    ------
    Undetermined
        See `depends_on_joint`.
    """
    involved, unmoved = [], []
    for joint in np.flatnonzero(~active).tolist():
        if stood_still(q, joint, noise):
            unmoved.append(joint)
            continue
        try:
            dependent = depends_on_joint(q, tau, joint, fit, largest_error, noise or fit.noise)
        except Undetermined as lacking:
            if stood_still(q, joint, noise, BARELY_MOVED):
                unmoved.append(joint)
                continue
            raise Undetermined(
                f"torque on joint {joint + 1}: it was zero in all samples, and they cannot tell "
                f"whether the other torques depend on its angle ({lacking})"
            ) from None
        if dependent:
            involved.append(joint)
    return involved, unmoved
