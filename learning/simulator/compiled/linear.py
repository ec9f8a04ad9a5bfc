"""Small dense symmetric systems, compiled."""

from __future__ import annotations

from isotorque.learning.simulator.compiled.kernel import kernel


@kernel
def factorise(a, pivots):
    """Factor a symmetric matrix as L D L' in place.

    Parameters
    ----------
    a : (n, n) array
        Lower triangle in, strict lower triangle of L out.
    pivots : (n,) array
        Output: reciprocals of D.

    Returns
    -------
    bool
        Whether the matrix is positive definite; the factors are of use only then.
    """
    n = a.shape[0]
    for i in range(n):
        for j in range(i):
            s = a[i, j]
            for k in range(j):
                s -= a[i, k] * a[j, k]
            a[i, j] = s
        d = a[i, i]
        for k in range(i):
            s = a[i, k]
            l = s * pivots[k]
            d -= s * l
            a[i, k] = l
        if not d > 0.0:
            return False
        pivots[i] = 1.0 / d
    return True


@kernel
def solve(a, pivots, x):
    """Solve with the factors of `factorise`; x (n,) holds the right side, then the solution."""
    n = a.shape[0]
    for i in range(n):
        s = x[i]
        for k in range(i):
            s -= a[i, k] * x[k]
        x[i] = s
    for i in range(n - 1, -1, -1):
        s = x[i] * pivots[i]
        for k in range(i + 1, n):
            s -= a[k, i] * x[k]
        x[i] = s


@kernel
def solve_step(mass, stiffness, damping, h, hh, factor, pivots, x):
    """Solve ``(M + h D + hh K) y = x`` in one go; no friction but the viscous.

    Parameters
    ----------
    mass, stiffness : (n, n) arrays
        M and K, lower triangles.
    damping : (n,) array
        The diagonal of D.
    h, hh : float
        Factors of D and K.
    factor : (n, n) array
        Workspace.
    pivots : (n,) array
        Workspace.
    x : (n,) array
        Right side in, solution out.

    Returns
    -------
    bool
        Whether the matrix is positive definite; if not, x is spoilt.

    Notes
    -----
    `factorise` and `solve` with the assembly of the matrix and the first substitution drawn into
    the elimination: half of the time for two joints, where loops cost more than sums.
    """
    n = x.shape[0]
    for i in range(n):
        d = mass[i, i] + hh * stiffness[i, i] + h * damping[i]
        y = x[i]
        for j in range(i):
            s = mass[i, j] + hh * stiffness[i, j]
            for k in range(j):
                s -= factor[i, k] * factor[j, k]
            factor[i, j] = s
        for k in range(i):
            s = factor[i, k]
            l = s * pivots[k]
            d -= s * l
            y -= l * x[k]
            factor[i, k] = l
        if not d > 0.0:
            return False
        pivots[i] = 1.0 / d
        x[i] = y
    for i in range(n - 1, -1, -1):
        y = x[i] * pivots[i]
        for k in range(i + 1, n):
            y -= factor[k, i] * x[k]
        x[i] = y
    return True


@kernel
def multiply(a, x, out):
    """Write ``a x`` to out (n,) for a symmetric matrix of which the lower triangle is given."""
    n = a.shape[0]
    for i in range(n):
        s = a[i, i] * x[i]
        for j in range(i):
            s += a[i, j] * x[j]
            out[j] += a[i, j] * x[i]
        out[i] = s
