"""Compiled torque of a rigid chain, and its derivatives by everything that is unknown in it.

Arguments used throughout: ``parents`` (n,) int array, -1 for the base, always smaller than the
joint's own index; ``rotations`` (n, 3, 3), F of every joint; ``levers`` (n, 2) [N m], s across the
joint's own axis; ``q`` (m, n) [rad]; ``directions`` (n, 2, 3), two tangent vectors per rotation.
"""

from __future__ import annotations

import numpy as np

from isotorque.symbolic.common.compiled import compiled


@compiled(error_model="numpy")
def sweep(parents, rotations, levers, cosines, sines, placed, gravity, moments):
    """Walk out for gravity in every frame, and back for the moments carried, of one pose.

    Parameters
    ----------
    cosines, sines : (n,) arrays
        Of the joint angles.
    placed : (n, 3, 3) array
        Receives ``F_j Rz(q_j)``.
    gravity : (n, 3) array
        Receives the upward direction, seen from link j.
    moments : (n, 3) array
        Receives weight times lever of all that link j carries, seen from it [N m].
    """
    n = len(parents)
    for j in range(n):
        c, s = cosines[j], sines[j]
        for a in range(3):
            x, y = rotations[j, a, 0], rotations[j, a, 1]
            placed[j, a, 0] = x * c + y * s
            placed[j, a, 1] = y * c - x * s
            placed[j, a, 2] = rotations[j, a, 2]
        p = parents[j]
        for a in range(3):
            if p < 0:
                gravity[j, a] = placed[j, 2, a]
            else:
                gravity[j, a] = (
                    placed[j, 0, a] * gravity[p, 0]
                    + placed[j, 1, a] * gravity[p, 1]
                    + placed[j, 2, a] * gravity[p, 2]
                )
        moments[j, 0], moments[j, 1], moments[j, 2] = levers[j, 0], levers[j, 1], 0.0
    for j in range(n - 1, -1, -1):
        p = parents[j]
        if p >= 0:
            for a in range(3):
                moments[p, a] += (
                    placed[j, a, 0] * moments[j, 0]
                    + placed[j, a, 1] * moments[j, 1]
                    + placed[j, a, 2] * moments[j, 2]
                )


@compiled(error_model="numpy")
def turns_of(angles, cosines, sines):
    """Cosines and sines of the joint angles of one pose."""
    for j in range(len(angles)):
        cosines[j], sines[j] = np.cos(angles[j]), np.sin(angles[j])


@compiled(error_model="numpy")
def chain_torques(parents, rotations, levers, q, torque):
    """Torques that hold several chains of one tree: what depends on angles alone is shared.

    Parameters
    ----------
    rotations, levers : (r, n, 3, 3), (r, n, 2) arrays
        Of every chain.
    torque : (r, m, n) array
        Receives the torques [N m].
    """
    m, n = q.shape
    cosines, sines = np.empty(n), np.empty(n)
    placed, gravity, moments = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3))
    for k in range(m):
        turns_of(q[k], cosines, sines)
        for r in range(len(rotations)):
            sweep(parents, rotations[r], levers[r], cosines, sines, placed, gravity, moments)
            for j in range(n):
                torque[r, k, j] = moments[j, 0] * gravity[j, 1] - moments[j, 1] * gravity[j, 0]


@compiled(error_model="numpy")
def chain_jacobian(parents, rotations, levers, directions, q, torque, turned, leant, stiffness):
    """Torques and their derivatives.

    Parameters
    ----------
    torque : (m, n) array
        Receives the torques [N m].
    turned : (m, n, 2 n) array
        Receives derivatives by ``F_j -> F_j exp(directions[j, a])``, column ``2 j + a`` [N m/rad].
    leant : (m, n, 2 n) array
        Receives derivatives by the levers, column ``2 j + a``.
    stiffness : (m, n, n) array
        Receives derivatives by q [N m/rad].

    Notes
    -----
    The torque of joint i is ``u.h_i = w.v_i`` with v upward, h the moment, ``u = v x e_z`` and
    ``w = e_z x h``. A change further out changes h_i: u is carried outwards to where it happens.
    A change further in changes v_i: w is carried inwards. Both are one walk per torque, so the
    whole costs O(n^2) per pose.
    """
    m, n = q.shape
    placed, gravity, moments = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3))
    cosines, sines = np.empty(n), np.empty(n)
    before, swung = np.empty((n, 3)), np.empty((n, 3))
    carried, below = np.empty((n, 3)), np.empty(n, dtype=np.bool_)
    turned[:] = 0.0
    leant[:] = 0.0
    stiffness[:] = 0.0
    for k in range(m):
        turns_of(q[k], cosines, sines)
        sweep(parents, rotations, levers, cosines, sines, placed, gravity, moments)
        for j in range(n):
            c, s = cosines[j], sines[j]
            h, v = moments[j], gravity[j]
            # moment and upward direction in the frame between F and the joint's own turn
            swung[j, 0], swung[j, 1], swung[j, 2] = c * h[0] - s * h[1], s * h[0] + c * h[1], h[2]
            before[j, 0], before[j, 1] = c * v[0] - s * v[1], s * v[0] + c * v[1]
            before[j, 2] = v[2]
        for i in range(n):
            torque[k, i] = moments[i, 0] * gravity[i, 1] - moments[i, 1] * gravity[i, 0]
            for b in range(i, n):
                p = parents[b]
                below[b] = b == i or (p >= i and below[p])
                if not below[b]:
                    continue
                if b == i:
                    carried[b, 0], carried[b, 1], carried[b, 2] = gravity[i, 1], -gravity[i, 0], 0.0
                else:
                    F, x = rotations[b], carried[p]
                    y0 = F[0, 0] * x[0] + F[1, 0] * x[1] + F[2, 0] * x[2]
                    y1 = F[0, 1] * x[0] + F[1, 1] * x[1] + F[2, 1] * x[2]
                    y2 = F[0, 2] * x[0] + F[1, 2] * x[1] + F[2, 2] * x[2]
                    h = swung[b]
                    c0, c1, c2 = h[1] * y2 - h[2] * y1, h[2] * y0 - h[0] * y2, h[0] * y1 - h[1] * y0
                    for a in range(2):
                        d = directions[b, a]
                        turned[k, i, 2 * b + a] += d[0] * c0 + d[1] * c1 + d[2] * c2
                    stiffness[k, i, b] += c2
                    c, s = cosines[b], sines[b]
                    carried[b, 0], carried[b, 1], carried[b, 2] = (
                        c * y0 + s * y1,
                        c * y1 - s * y0,
                        y2,
                    )
                leant[k, i, 2 * b] = carried[b, 0]
                leant[k, i, 2 * b + 1] = carried[b, 1]
            z0, z1, z2 = -moments[i, 1], moments[i, 0], 0.0
            b = i
            while b >= 0:
                c, s = cosines[b], sines[b]
                z0, z1 = c * z0 - s * z1, s * z0 + c * z1
                f, F = before[b], rotations[b]
                c0, c1, c2 = z1 * f[2] - z2 * f[1], z2 * f[0] - z0 * f[2], z0 * f[1] - z1 * f[0]
                for a in range(2):
                    d = directions[b, a]
                    turned[k, i, 2 * b + a] += d[0] * c0 + d[1] * c1 + d[2] * c2
                stiffness[k, i, b] += c2
                z0, z1, z2 = (
                    F[0, 0] * z0 + F[0, 1] * z1 + F[0, 2] * z2,
                    F[1, 0] * z0 + F[1, 1] * z1 + F[1, 2] * z2,
                    F[2, 0] * z0 + F[2, 1] * z1 + F[2, 2] * z2,
                )
                b = parents[b]
