"""Short vectors of shifted integer lattices: LLL reduction and Fincke-Pohst enumeration."""

from __future__ import annotations

import numpy as np
from flint import fmpz_mat

from isotorque.symbolic.common.arrays import Floats, Integers
from isotorque.symbolic.common.errors import InputError


def reduced_basis(gram: Integers) -> Integers:
    """Return an LLL-reduced basis of Z^r for the scalar product ``x . gram . y``.

    Parameters
    ----------
    gram : (r, r) int array
        Symmetric positive definite.

    Returns
    -------
    (r, r) int array
        Basis vectors in its rows; determinant +-1.

    References
    ----------
    Lenstra, Lenstra, Lovasz, Factoring polynomials with rational coefficients, Mathematische
    Annalen 261, 1982.

    Examples
    --------
    >>> reduced_basis(np.array([[1, 3], [3, 10]])).tolist()
    [[1, 0], [-3, 1]]
    """
    if len(gram) == 0:
        return np.zeros((0, 0), dtype=np.int64)
    _, transform = fmpz_mat(gram.tolist()).lll(True, 0.99, 0.51, "gram")
    return np.array([[int(x) for x in row] for row in transform.tolist()], dtype=np.int64)


def covering_radius_bound(gram: Floats, basis: Integers) -> float:
    """Return a bound on the distance of any point from the nearest point of Z^r.

    Parameters
    ----------
    gram : (r, r) array
        Scalar product.
    basis : (r, r) int array
        A reduced basis in its rows.

    Returns
    -------
    float
        Half the root of the summed squares of the Gram-Schmidt lengths of the basis (Babai).
    """
    steps = np.linalg.cholesky(basis @ gram @ basis.T).diagonal() if len(basis) else np.zeros(0)
    return float(np.sqrt((steps**2).sum()) / 2)


def lattice_points_within(
    gram: Floats, basis: Integers, offsets: Floats, radius: float, limit: int = 2_000_000
) -> tuple[Integers, Integers]:
    """Find all lattice points z with ``|z + offset| <= radius``, for many offsets at once.

    Parameters
    ----------
    gram : (r, r) array
        Scalar product that measures lengths.
    basis : (r, r) int array
        A reduced basis of Z^r in its rows (keeps the search narrow; any basis gives the points).
    offsets : (m, r) array
        The shifts.
    radius : float
        Length bound.
    limit : int
        Largest number of points to hold at once.

    Returns
    -------
    index : (p,) int array
        Which offset each point belongs to.
    points : (p, r) int array
        The points z.

    Raises
    ------
    InputError
        If there are more than ``limit`` points.

    References
    ----------
    Fincke, Pohst, Improved methods for calculating vectors of short length in a lattice,
    Mathematics of Computation 44, 1985.

    Examples
    --------
    >>> gram, basis = np.eye(2), np.eye(2, dtype=int)
    >>> index, points = lattice_points_within(gram, basis, np.array([[0.5, 0.0]]), 0.6)
    >>> points.tolist()
    [[-1, 0], [0, 0]]
    """
    r = len(gram)
    index = np.arange(len(offsets))
    if r == 0:
        return index, np.zeros((len(offsets), 0), dtype=np.int64)
    upper = np.linalg.cholesky(basis @ gram @ basis.T).T
    shift = offsets @ np.linalg.inv(basis)
    left = np.full(len(offsets), radius**2 * (1 + 1e-12))
    chosen = np.zeros((len(offsets), r))  # coordinates of z + offset in the basis
    for i in range(r - 1, -1, -1):
        tail = chosen[:, i + 1 :] @ upper[i, i + 1 :] / upper[i, i]
        reach = np.sqrt(left) / upper[i, i]
        first = np.ceil(-reach - tail - shift[index, i] - 1e-12)
        last = np.floor(reach - tail - shift[index, i] + 1e-12)
        count = np.maximum(last - first + 1, 0).astype(np.int64)
        if count.sum() > limit:
            raise InputError(
                "fundamental domain",
                "number of images to compare",
                f"more than {limit}",
                "a symmetry group of lower rank or order",
            )
        parent = np.repeat(np.arange(len(index)), count)
        step = np.arange(len(parent)) - np.repeat(np.cumsum(count) - count, count)
        index, chosen = index[parent], chosen[parent]
        chosen[:, i] = first[parent] + step + shift[index, i]
        left = np.maximum(left[parent] - (upper[i, i] * (chosen[:, i] + tail[parent])) ** 2, 0.0)
    points = np.rint(chosen - shift[index]).astype(np.int64) @ basis
    order = np.lexsort((*points.T[::-1], index))
    return index[order], points[order]
