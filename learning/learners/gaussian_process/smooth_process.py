"""The mean of a Gaussian process of long length scale, without the cancellation of its kernel sum.

With a length scale of a turn and more, covariances of all samples are nearly equal, and the mean, a
sum of them with huge weights of both signs, loses up to ten digits. The periodic kernel is also a
series of few waves then,

    exp(-D(y, y') / l^2) = sum over frequencies kappa of c_kappa cos(kappa.(y - y')),

so the process is a regression on these waves with variances c_kappa, whose coefficients are of
the size of the torques: they are found by orthogonal factorisation and summed without loss.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import svd
from scipy.sparse import diags_array
from scipy.special import ive

from isotorque.learning.learners.gaussian_process.symmetric_kernel import distinct_rows
from isotorque.learning.learners.rigid.equivariant_basis import sparse_torque_basis
from isotorque.learning.learners.symmetry_coordinates import SymmetryCoordinates
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Waves of less variance, relative to the kernel's, are left out.
NEGLIGIBLE = (1e-16, 1e-14, 1e-12)
#: The first of these with which there are at most so many waves counts; with none, sums stay.
MOST_WAVES = 10_000


def kernel_waves(
    rows: Array, weights: Array, length_scale: float, negligible: float = NEGLIGIBLE[0]
) -> tuple[Integers, Array] | None:
    """Write ``exp(-sum of w_a (1 - cos a.y) / l^2)`` as a series of cosines.

    Parameters
    ----------
    rows : (k, r) array
        Integer rows a.
    weights : (k,) array
        w_a.
    length_scale : float
        l [rad].
    negligible : float
        Terms that are left out.

    Returns
    -------
    (m, r) int array, (m,) array or None
        Frequencies kappa, one of each pair, and what multiplies ``cos(kappa.y)``;
        None for rows that are not integers and for more than 10,000 frequencies.

    Notes
    -----
    ``exp(z cos t) = sum over all n of I_n(z) cos(n t)`` with the modified Bessel functions I_n;
    the product over rows is a convolution of frequencies (Abramowitz and Stegun 9.6.34).

    Examples
    --------
    >>> kappa, variance = kernel_waves(np.eye(1), np.ones(1), 2.0)
    >>> y = 0.7
    >>> bool(abs(variance @ np.cos(kappa[:, 0] * y) - np.exp((np.cos(y) - 1) / 4)) < 1e-15)
    True
    """
    whole = np.rint(rows).astype(np.int64)
    if np.abs(rows - whole).max(initial=0.0) > 1e-6:
        return None
    found: Integers = np.zeros((1, rows.shape[1]), dtype=np.int64)
    variance: Array = np.ones(1)
    for row, z in zip(whole, np.asarray(weights) / length_scale**2, strict=True):
        order = 0
        while ive(order + 1, z) > negligible:
            order += 1
        n = np.arange(-order, order + 1)
        size = np.outer(variance, ive(np.abs(n), z))
        i, j = np.nonzero(size > negligible)
        if len(i) > 10 * MOST_WAVES:
            return None
        sums = found[i] + n[j, None] * row
        found, member = np.unique(sums, axis=0, return_inverse=True)
        variance = np.asarray(np.bincount(member.ravel(), size[i, j], len(found)))
    leading = np.array([next((x for x in row if x), 0) for row in found.tolist()])
    one = leading >= 0
    if one.sum() > MOST_WAVES:
        return None
    return found[one], variance[one] * np.where(leading[one] > 0, 2.0, 1.0)


def smooth_mean(
    coordinates: SymmetryCoordinates,
    output: int,
    length_scale: float,
    relative_noise: float,
    q: Array,
    values: Array,
) -> TrigonometricPolynomial | None:
    """Return the mean of a process with `SymmetrisedPeriodicKernel`, as waves.

    Parameters
    ----------
    coordinates : SymmetryCoordinates
        The group.
    output : int
        Joint whose signs are meant.
    length_scale : float
        Of the kernel [rad].
    relative_noise : float
        Variance of the errors of the values, in units of the amplitude of the kernel.
    q : (m, n) array
        Configurations of the samples [rad].
    values : (m,) array
        Their values.

    Returns
    -------
    TrigonometricPolynomial or None
        The mean over joint angles; None where there would be too many waves.

    Notes
    -----
    With features F of the waves that the group allows, orthonormal in their coefficients, each
    times the root of its variance, the coefficients minimise ``|F u - values|^2 + noise |u|^2``
    (C. E. Rasmussen and C. K. I. Williams, "Gaussian Processes for Machine Learning", 2006, section
    2.1), by the singular values of F; kernels square its condition number.
    """
    shape = distinct_rows(coordinates.A_sat)
    tried = (kernel_waves(*shape, length_scale, negligible) for negligible in NEGLIGIBLE)
    waves = next((found for found in tried if found is not None), None)
    if waves is None:
        return None
    kappa, variance = waves
    known = output < coordinates.Y.shape[1]
    signs = coordinates.Y[:, output] if known else np.ones(coordinates.order)
    basis = sparse_torque_basis(coordinates, kappa, signs)
    # within an orbit all waves have one variance; the kernel is order times the average
    scaled = diags_array(np.sqrt(coordinates.order * np.tile(variance, 2))) @ basis
    frequencies = kappa @ np.rint(coordinates.basis).astype(np.int64)
    phase = q @ frequencies.T
    features = np.concatenate([np.cos(phase), np.sin(phase)], axis=1) @ scaled
    left, size, right = svd(features, full_matrices=False, check_finite=False)
    gain = size / (size**2 + relative_noise)
    a, b = np.split(scaled @ (right.T @ (gain * (left.T @ values))), 2)
    return TrigonometricPolynomial(frequencies, a, b)
