"""Mass matrix, bias torque and gravity stiffness of a chain in one compiled sweep."""

from __future__ import annotations

from isotorque.learning.simulator.compiled.kernel import kernel, kernel_part
from isotorque.learning.simulator.compiled.links import (
    F,
    H,
    M,
    N,
    S,
    X,
    Z,
    force_link,
    move_link,
    place_link,
    weigh_link,
)
from isotorque.learning.simulator.dynamics.chain import ARMATURE


@kernel
def evaluate(parents, kinds, links, gravity, q, v, rows, mass, bias, stiffness):
    """Fill in the terms of ``mass(q) a + bias(q, v) = torque`` and the gravity stiffness.

    Parameters
    ----------
    parents, kinds, links, gravity
        The arrays of a `Chain`.
    q, v : (n,) arrays
        Joint angles [rad] and velocities [rad/s].
    rows : (n + 1, LINK_ROW) array
        Workspace from `new_rows`.
    mass, stiffness : (n, n) arrays
        Outputs: mass matrix [kg m^2] and ``dg/dq`` [N m/rad]. Only entries on and below the
        diagonal of joints on one branch are written; the others must be zero beforehand.
    bias : (n,) array
        Output: Coriolis, centrifugal and gravity torque [N m]; the gravity torque where v = 0.

    Notes
    -----
    Composite bodies as in Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 6, written
    in the base frame. The acceleration of a body's points is an affine field ``B x + a``,
    ``B = [alpha] + [omega]^2``; with first and second moments of mass h and X, force and moment
    follow without momenta: ``f = m a + B h``, ``n = h x a + vee(B X - (B X)')``.

    The stiffness is ``K_ij = -z_j . (u_i x gravity)`` for j an ancestor of i or i itself, u_i the
    derivative of the first moment of all that joint i carries.
    """
    n = q.shape[0]
    for i in range(n):
        row = rows[i + 1]
        up = rows[parents[i]]
        place_link(row, up, links[i], kinds[i], q[i])
        move_link(row, up, kinds[i], v[i])
        weigh_link(row, links[i])
        force_link(row)
    for i in range(n - 1, -1, -1):
        _joint_terms(parents, rows, i, gravity, mass, bias, stiffness)
        mass[i, i] += links[i, ARMATURE]
        if parents[i] > 0:
            row = rows[i + 1]
            up = rows[parents[i]]
            for c in range(M, N + 3):
                up[c] += row[c]


@kernel_part
def _joint_terms(parents, rows, i, gravity, mass, bias, stiffness):
    """Fill in what joint i, with all it carries in its row, shares with itself and ancestors."""
    row = rows[i + 1]
    sx = row[S]
    sy = row[S + 1]
    sz = row[S + 2]
    zx = row[Z]
    zy = row[Z + 1]
    zz = row[Z + 2]
    force = sx * row[F] + sy * row[F + 1] + sz * row[F + 2]
    bias[i] = force + zx * row[N] + zy * row[N + 1] + zz * row[N + 2]
    m = row[M]
    hx = row[H]
    hy = row[H + 1]
    hz = row[H + 2]
    # Linear and angular momentum per unit of joint velocity.
    ux = m * sx + zy * hz - zz * hy
    uy = m * sy + zz * hx - zx * hz
    uz = m * sz + zx * hy - zy * hx
    trace = row[X] + row[X + 3] + row[X + 5]
    nx = hy * sz - hz * sy + (trace - row[X]) * zx - row[X + 1] * zy - row[X + 2] * zz
    ny = hz * sx - hx * sz - row[X + 1] * zx + (trace - row[X + 3]) * zy - row[X + 4] * zz
    nz = hx * sy - hy * sx - row[X + 2] * zx - row[X + 4] * zy + (trace - row[X + 5]) * zz
    kx = uy * gravity[2] - uz * gravity[1]
    ky = uz * gravity[0] - ux * gravity[2]
    kz = ux * gravity[1] - uy * gravity[0]
    j = i
    while j >= 0:
        other = rows[j + 1]
        linear = other[S] * ux + other[S + 1] * uy + other[S + 2] * uz
        mass[i, j] = linear + other[Z] * nx + other[Z + 1] * ny + other[Z + 2] * nz
        stiffness[i, j] = -(other[Z] * kx + other[Z + 1] * ky + other[Z + 2] * kz)
        j = parents[j] - 1
