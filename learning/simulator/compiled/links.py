"""Placement, motion, mass and force of one link after the other, compiled.

Everything is written in the base frame and, where a point of reference is needed, about its
origin. Each link has a row of numbers; the base has one too, before the others.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.simulator.compiled.kernel import kernel_part
from isotorque.learning.simulator.dynamics.chain import (
    LEVER,
    MASS,
    MOMENTS,
    PRISMATIC,
    ROTATION,
    TRANSLATION,
    Chain,
)

# Columns of a link's row.
E = 0  # 9: rotation of the link; its last column is the joint axis
P = 9  # 3: origin of the joint frame
S = 12  # 3: velocity of the base origin, moved along, per unit of joint velocity
Z = 15  # 3: angular velocity per unit of joint velocity
W = 18  # 3: angular velocity
A = 21  # 3: acceleration of the base origin, moved along with the link
B = 24  # 9: the link's point at x is accelerated by B x + A
M = 33  # mass
H = 34  # 3: first moment of mass
X = 37  # 6: second moments of mass, xx xy xz yy yz zz
F = 43  # 3: force that moves the link
N = 46  # 3: moment that moves the link
LINK_ROW = 49


def new_rows(chain: Chain) -> NDArray[np.float64]:
    """Create the rows (n + 1, LINK_ROW) of a chain; that of the base is filled in for good.

    Gravity enters as an acceleration of the base upwards.
    """
    rows = np.zeros((chain.n + 1, LINK_ROW))
    rows[0, E : E + 9] = np.eye(3).ravel()
    rows[0, A : A + 3] = -chain.gravity
    return rows


@kernel_part
def place_link(row, up, link, kind, q):
    """Place a link and its joint axis, given its parent's row and the joint coordinate q."""
    cosine = 1.0
    sine = 0.0
    slide = q
    if kind != PRISMATIC:
        cosine = math.cos(q)
        sine = math.sin(q)
        slide = 0.0
    for r in range(3):
        ux = up[E + 3 * r]
        uy = up[E + 3 * r + 1]
        uz = up[E + 3 * r + 2]
        x = ux * link[ROTATION] + uy * link[ROTATION + 3] + uz * link[ROTATION + 6]
        y = ux * link[ROTATION + 1] + uy * link[ROTATION + 4] + uz * link[ROTATION + 7]
        z = ux * link[ROTATION + 2] + uy * link[ROTATION + 5] + uz * link[ROTATION + 8]
        shift = ux * link[TRANSLATION] + uy * link[TRANSLATION + 1] + uz * link[TRANSLATION + 2]
        row[E + 3 * r] = cosine * x + sine * y
        row[E + 3 * r + 1] = cosine * y - sine * x
        row[E + 3 * r + 2] = z
        row[P + r] = up[P + r] + shift + slide * z
    zx = row[E + 2]
    zy = row[E + 5]
    zz = row[E + 8]
    if kind == PRISMATIC:
        row[S] = zx
        row[S + 1] = zy
        row[S + 2] = zz
        row[Z] = 0.0
        row[Z + 1] = 0.0
        row[Z + 2] = 0.0
    else:
        row[S] = row[P + 1] * zz - row[P + 2] * zy
        row[S + 1] = row[P + 2] * zx - row[P] * zz
        row[S + 2] = row[P] * zy - row[P + 1] * zx
        row[Z] = zx
        row[Z + 1] = zy
        row[Z + 2] = zz


@kernel_part
def move_link(row, up, kind, v):
    """Fill in a link's velocity and acceleration for the joint velocity v, not accelerated."""
    wx = up[W]
    wy = up[W + 1]
    wz = up[W + 2]
    zx = row[E + 2]
    zy = row[E + 5]
    zz = row[E + 8]
    # What the turning of the joint axis adds to the acceleration.
    bx = v * (wy * zz - wz * zy)
    by = v * (wz * zx - wx * zz)
    bz = v * (wx * zy - wy * zx)
    if kind == PRISMATIC:
        for r in range(3):
            row[W + r] = up[W + r]
        for r in range(9):
            row[B + r] = up[B + r]
        row[A] = up[A] + 2.0 * bx
        row[A + 1] = up[A + 1] + 2.0 * by
        row[A + 2] = up[A + 2] + 2.0 * bz
        return
    wx += v * zx
    wy += v * zy
    wz += v * zz
    row[W] = wx
    row[W + 1] = wy
    row[W + 2] = wz
    # The antisymmetric part of the parent's B is its angular acceleration.
    bx += 0.5 * (up[B + 7] - up[B + 5])
    by += 0.5 * (up[B + 2] - up[B + 6])
    bz += 0.5 * (up[B + 3] - up[B + 1])
    row[B] = -wy * wy - wz * wz
    row[B + 1] = wx * wy - bz
    row[B + 2] = wx * wz + by
    row[B + 3] = wx * wy + bz
    row[B + 4] = -wx * wx - wz * wz
    row[B + 5] = wy * wz - bx
    row[B + 6] = wx * wz - by
    row[B + 7] = wy * wz + bx
    row[B + 8] = -wx * wx - wy * wy
    # Parent and link agree on the acceleration of the joint's origin.
    for r in range(3):
        k = B + 3 * r
        row[A + r] = (
            up[A + r]
            + (up[k] - row[k]) * row[P]
            + (up[k + 1] - row[k + 1]) * row[P + 1]
            + (up[k + 2] - row[k + 2]) * row[P + 2]
        )


@kernel_part
def weigh_link(row, link):
    """Fill in a link's moments of mass."""
    m = link[MASS]
    sxx = link[MOMENTS]
    sxy = link[MOMENTS + 1]
    sxz = link[MOMENTS + 2]
    syy = link[MOMENTS + 3]
    syz = link[MOMENTS + 4]
    szz = link[MOMENTS + 5]
    ax = row[E]
    ay = row[E + 1]
    az = row[E + 2]
    bx = row[E + 3]
    by = row[E + 4]
    bz = row[E + 5]
    cx = row[E + 6]
    cy = row[E + 7]
    cz = row[E + 8]
    lx = link[LEVER]
    ly = link[LEVER + 1]
    lz = link[LEVER + 2]
    x = row[P] + ax * lx + ay * ly + az * lz
    y = row[P + 1] + bx * lx + by * ly + bz * lz
    z = row[P + 2] + cx * lx + cy * ly + cz * lz
    row[M] = m
    row[H] = m * x
    row[H + 1] = m * y
    row[H + 2] = m * z
    tx = ax * sxx + ay * sxy + az * sxz
    ty = ax * sxy + ay * syy + az * syz
    tz = ax * sxz + ay * syz + az * szz
    row[X] = m * x * x + tx * ax + ty * ay + tz * az
    row[X + 1] = m * x * y + tx * bx + ty * by + tz * bz
    row[X + 2] = m * x * z + tx * cx + ty * cy + tz * cz
    tx = bx * sxx + by * sxy + bz * sxz
    ty = bx * sxy + by * syy + bz * syz
    tz = bx * sxz + by * syz + bz * szz
    row[X + 3] = m * y * y + tx * bx + ty * by + tz * bz
    row[X + 4] = m * y * z + tx * cx + ty * cy + tz * cz
    tx = cx * sxx + cy * sxy + cz * sxz
    ty = cx * sxy + cy * syy + cz * syz
    tz = cx * sxz + cy * syz + cz * szz
    row[X + 5] = m * z * z + tx * cx + ty * cy + tz * cz


@kernel_part
def force_link(row):
    """Fill in the force and the moment a link's motion takes: sums of B x + A over its mass."""
    m = row[M]
    hx = row[H]
    hy = row[H + 1]
    hz = row[H + 2]
    mxx = row[X]
    mxy = row[X + 1]
    mxz = row[X + 2]
    myy = row[X + 3]
    myz = row[X + 4]
    mzz = row[X + 5]
    ax = row[A]
    ay = row[A + 1]
    az = row[A + 2]
    b0 = row[B]
    b1 = row[B + 1]
    b2 = row[B + 2]
    b3 = row[B + 3]
    b4 = row[B + 4]
    b5 = row[B + 5]
    b6 = row[B + 6]
    b7 = row[B + 7]
    b8 = row[B + 8]
    row[F] = m * ax + b0 * hx + b1 * hy + b2 * hz
    row[F + 1] = m * ay + b3 * hx + b4 * hy + b5 * hz
    row[F + 2] = m * az + b6 * hx + b7 * hy + b8 * hz
    zy = b6 * mxy + b7 * myy + b8 * myz
    yz = b3 * mxz + b4 * myz + b5 * mzz
    xz = b0 * mxz + b1 * myz + b2 * mzz
    zx = b6 * mxx + b7 * mxy + b8 * mxz
    yx = b3 * mxx + b4 * mxy + b5 * mxz
    xy = b0 * mxy + b1 * myy + b2 * myz
    row[N] = hy * az - hz * ay + zy - yz
    row[N + 1] = hz * ax - hx * az + xz - zx
    row[N + 2] = hx * ay - hy * ax + yx - xy
