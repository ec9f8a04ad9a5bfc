"""Optimal design: the configurations to measure next that leave least in doubt."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.rigid.equivariant_basis import (
    multi_affine_frequencies,
    potential_basis,
)
from isotorque.learning.learners.sample_checks import require_fitted
from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    torque_features,
)
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

Array = NDArray[np.float64]

PRIOR = 1e-9
"""Information on every coefficient before any sample, relative to that of a typical sample."""
EXCHANGES = 20
"""Most rounds of Fedorov's exchange."""
STEP = 1e-3
"""Half the distance over which slopes of a Gaussian process are measured [rad]."""
WORTH = 1e-9
"""Gains in log det below it are rounding."""


@dataclass(frozen=True, eq=False)
class Design:
    """Configurations to be measured.

    Attributes
    ----------
    q : (m, n) array
        Configurations [rad], among the candidates.
    chosen : (m,) int array
        Their rows in the candidates; a row may come more than once.
    value : float
        What was optimised: log det of the information on the coefficients, or the mean posterior
        variance over the candidates as a share of the variance before.
    """

    q: Array
    chosen: NDArray[np.int64]
    value: float


def d_optimal(
    group: GroupArrays | None,
    candidates: ArrayLike,
    count: int,
    *,
    noise: MeasurementNoise | None = None,
    potential: TrigonometricPolynomial | None = None,
    known: ArrayLike | None = None,
) -> Design:
    """Configurations that tell most about the coefficients of the gravity potential.

    Parameters
    ----------
    group : SymmetryGroup or None
        Relations that the potential has, exactly; every sample then counts for its whole orbit.
    candidates : (c, n) array_like
        Configurations that can be visited [rad]: of the BCTS, within limits, stable if the arm
        has to hold itself (`lattice_samples` with ``admit`` makes them).
    count : int
        Number of configurations to choose.
    noise : MeasurementNoise, optional
        Errors of angles and torques; torques alone by default.
    potential : TrigonometricPolynomial, optional
        What is known of the potential so far, such as a first fit. Needed where angles have
        errors: they matter in proportion to the stiffness.
    known : (m, n) array_like, optional
        Configurations measured already.

    Returns
    -------
    Design
        The same configuration comes several times where measuring it again is worth more than
        another one.

    Raises
    ------
    InputError
        If shapes do not fit, there is no candidate or no count, or the noise of angles is given
        without a potential.

    Notes
    -----
    Maximises the determinant of ``sum J^T S^-1 J`` with J the derivative of a sample's torques by
    the coefficients of the tied basis (`potential_basis`), and S the covariance of its errors,
    ``sigma_torque^2 I + sigma_angle^2 H H^T`` with the stiffness H: greedily first, then by
    Fedorov's exchange of one configuration for another as long as that gains.

    References
    ----------
    V. V. Fedorov, "Theory of Optimal Experiments", Academic Press 1972. A. C. Atkinson, A. N.
    Donev, R. D. Tobias, "Optimum Experimental Designs, with SAS", Oxford 2007, chapter 12.

    Examples
    --------
    A pendulum of which nothing is known is best measured on two lines at right angles:

    >>> angles = np.linspace(-np.pi, np.pi, 8, endpoint=False)[:, None]
    >>> design = d_optimal(None, angles, 2)
    >>> round(float(abs(np.sin(design.q[0, 0] - design.q[1, 0]))), 9)
    1.0
    """
    points = _configurations("candidates", candidates)
    if count < 1:
        raise InputError("design", "number of configurations", count, "at least 1")
    everything = points
    if known is not None:
        earlier = _configurations("known configurations", known, points.shape[1])
        everything = np.concatenate([points, earlier])
    rows, before = np.split(_informative(group, everything, noise, potential), [len(points)])
    size = rows.shape[2]
    typical = float(np.mean(np.einsum("cnp,cnp->c", rows, rows))) / max(size, 1)
    information = PRIOR * max(typical, 1e-300) * np.eye(size)
    information = information + np.einsum("cnp,cnq->pq", before, before)
    chosen: list[int] = []
    for _ in range(count):
        best = int(np.argmax(_gains(rows, information)))
        chosen.append(best)
        information = information + rows[best].T @ rows[best]
    for _ in range(EXCHANGES):
        gained = False
        for place in range(count):
            old = rows[chosen[place]]
            without = information - old.T @ old
            gains = _gains(rows, without)
            best = int(np.argmax(gains))
            if gains[best] > gains[chosen[place]] + WORTH:
                chosen[place], gained = best, True
                information = without + rows[best].T @ rows[best]
        if not gained:
            break
    index = np.array(chosen, dtype=np.int64)
    return Design(points[index], index, float(np.linalg.slogdet(information)[1]))


def least_variance(
    process: SymmetricGaussianProcess,
    candidates: ArrayLike,
    count: int,
    *,
    noise: MeasurementNoise | None = None,
) -> Design:
    """Configurations that lower the posterior variance of a Gaussian process most.

    Parameters
    ----------
    process : SymmetricGaussianProcess
        Fitted to what was measured so far; its kernel and noise are taken as known.
    candidates : (c, n) array_like
        Configurations that can be visited [rad], spread over the region that matters: they are
        also where the variance counts. A thousand or so.
    count : int
        Number of configurations to choose.
    noise : MeasurementNoise, optional
        Errors of angles and torques. Those of angles matter in proportion to the slope of the
        estimated torque, so level places are preferred. Without it every place is as noisy as the
        process takes its samples to be; then even samples, a lattice, are hard to beat.

    Returns
    -------
    Design

    Raises
    ------
    InputError
        If shapes do not fit, or there is no candidate or no count.

    Notes
    -----
    Greedy: each configuration is the one that, once measured, leaves the least variance of the
    torques, summed over joints (each in units of its own torque) and candidates. (The
    configuration of largest variance, the usual rule, sits in corners of the region.) The group is
    in the kernel.

    References
    ----------
    D. A. Cohn, "Neural network exploration using optimal experiment design", NIPS 6 (1994).

    Examples
    --------
    >>> angles = np.linspace(-np.pi, np.pi, 16, endpoint=False)[:, None]
    >>> first = SymmetricGaussianProcess(0.1, length_scale=2.0).fit([[0.0]], [[5.0]])
    >>> design = least_variance(first, angles, 3)
    >>> design.value < 0.1, len(set(design.chosen))
    (True, 3)
    """
    require_fitted(process)
    points = _configurations("candidates", candidates, process.n_features_in_)
    if count < 1:
        raise InputError("design", "number of configurations", count, "at least 1")
    covariances, variances = _posterior(process, points)
    if noise is not None:
        variances = _place_by_place(process, points, noise)
    before = float(np.trace(covariances, axis1=1, axis2=2).sum())
    chosen: list[int] = []
    for _ in range(count):
        pivots = np.diagonal(covariances, axis1=1, axis2=2) + variances
        best = int(np.argmax((np.einsum("jrc,jrc->jc", covariances, covariances) / pivots).sum(0)))
        chosen.append(best)
        column = covariances[:, :, best] / np.sqrt(pivots[:, best])[:, None]
        covariances = covariances - column[:, :, None] * column[:, None, :]
    after = float(np.trace(covariances, axis1=1, axis2=2).sum())
    index = np.array(chosen, dtype=np.int64)
    return Design(points[index], index, after / max(before, 1e-300))


def _informative(
    group: GroupArrays | None,
    q: Array,
    noise: MeasurementNoise | None,
    potential: TrigonometricPolynomial | None,
) -> Array:
    """Derivatives of whitened torques by the tied coefficients, (c, n, p)."""
    joints = q.shape[1]
    coordinates = SymmetryCoordinates.of(group, joints)
    kappa = multi_affine_frequencies(coordinates.basis)
    basis = potential_basis(coordinates, kappa)
    frequencies = kappa @ np.rint(coordinates.basis).astype(np.int64)
    rows = torque_features(frequencies, q) @ basis
    # directions that no torque can show, such as the constant
    left, singular, _ = np.linalg.svd(np.einsum("cnp,cnq->pq", rows, rows))
    rows = rows @ left[:, singular > 1e-12 * max(float(singular.max(initial=0.0)), 1e-300)]
    if noise is None:
        return rows
    if noise.angle == 0.0:
        return np.asarray(rows / max(noise.torque, 1e-300))
    if potential is None:
        raise InputError("design", "potential", "none", "one, where angles have errors")
    stiffness = potential.hessian(q)
    floor = 1e-6 * noise.angle * float(np.abs(stiffness).max(initial=0.0))
    spread = noise.angle**2 * stiffness @ np.swapaxes(stiffness, 1, 2)
    covariance = spread + max(noise.torque, floor, 1e-300) ** 2 * np.eye(joints)
    return np.asarray(np.linalg.solve(np.linalg.cholesky(covariance), rows))


def _gains(rows: Array, information: Array) -> Array:
    """What every candidate adds to log det of the information, (c,)."""
    root = np.linalg.cholesky(information)
    white = np.linalg.solve(root, np.swapaxes(rows, 1, 2))
    gram = np.swapaxes(white, 1, 2) @ white
    return np.asarray(np.linalg.slogdet(np.eye(rows.shape[1]) + gram)[1])


def _posterior(process: SymmetricGaussianProcess, points: Array) -> tuple[Array, Array]:
    """Covariances (n, c, c) of each joint's torque, and variances (n, 1) of its noise."""
    result, variances = [], []
    for model in process.processes_:
        kernel, samples = model.kernel_, model.X_train_
        # a WhiteKernel shows only where one set of points is compared with itself
        prior = kernel(points, points.copy())
        noise = float(np.mean(kernel.diag(points) - np.diag(prior))) + float(np.max(model.alpha))
        half = np.linalg.solve(model.L_, kernel(samples, points))
        result.append(prior - half.T @ half)
        variances.append(max(noise, 1e-12 * float(np.diag(prior).max(initial=0.0))))
    return np.array(result), np.array(variances)[:, None]


def _place_by_place(
    process: SymmetricGaussianProcess, points: Array, noise: MeasurementNoise
) -> Array:
    """Variances (n, c) of what would be measured, each joint in units of its torque."""
    squares = np.zeros(points.shape)
    for move in STEP * np.eye(points.shape[1]):
        change = process.predict(points + move) - process.predict(points - move)
        squares += (change.reshape(points.shape) / (2 * STEP)) ** 2
    variances = noise.torque**2 + noise.angle**2 * squares
    floor = 1e-12 * float(variances.max(initial=0.0)) + np.finfo(float).tiny
    return np.asarray(np.maximum(variances, floor).T / process._scale[:, None] ** 2)


def _configurations(what: str, q: ArrayLike, joints: int | None = None) -> Array:
    points = np.asarray(q, dtype=float)
    wanted = f"(m, {joints or 'n'}), m >= 1"
    if points.ndim != 2 or 0 in points.shape or joints not in (None, points.shape[1]):
        raise InputError("design", f"shape of {what}", points.shape, wanted)
    if not np.isfinite(points).all():
        raise InputError("design", what, "not finite", "finite angles [rad]")
    return points
