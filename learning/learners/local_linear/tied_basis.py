"""Tied basis: local linear features, summed over a symmetry group so that they are equivariant.

A prototype stands for its whole orbit. With relations ``y -> A y + d``, ``tau -> Y tau``, local
offset ``x_gi = L (A_g y + d_g - p_i) / d`` and kernel ``h``, the estimate of joint j is

    tau_j(y) = sum_g Y_gj sum_i h(|x_gi|) (o_ij + W_ij . x_gi)  /  sum_g sum_i h(|x_gi|),

linear in (o, W). Moving y by a relation permutes the copies and multiplies by one sign: every such
function has the group's symmetry exactly, whatever its parameters. Periodic images are summed as
well, so it is smooth on the torus. Joints with the same column of Y share their features.
"""

from __future__ import annotations

import numpy as np

from isotorque.learning.learners.local_linear.cell_list_search import find_far, find_near
from isotorque.symbolic.common.compiled import compiled


@compiled
def copies_of(symmetries, q, images):
    """Wrapped coordinates of all symmetric copies of q (n,), into ``images`` (G, r)."""
    basis, A_sat, d_sat = symmetries
    order, rank, _ = A_sat.shape
    y = np.zeros(rank)
    for i in range(rank):
        for j in range(q.size):
            y[i] += basis[i, j] * q[j]
    for g in range(order):
        for i in range(rank):
            value = d_sat[g, i]
            for j in range(rank):
                value += A_sat[g, i, j] * y[j]
            images[g, i] = value - 2 * np.pi * np.floor(value / (2 * np.pi) + 0.5)


@compiled
def near_or_far(grid, counts, y, work, far):
    """What ``find_near`` finds at y, or ``find_far`` if so told."""
    if far:
        return find_far(grid, counts[0], y, work.found, work.offset, work.squared)
    return find_near(grid, y, work.found, work.offset, work.squared)


@compiled
def least_distance(grid, counts, images, work):
    """Squared distance from an orbit (G, r) to the nearest prototype."""
    least = np.inf
    for far in (False, True):
        for g in range(images.shape[0]):
            least = min(least, near_or_far(grid, counts, images[g], work, far)[1])
        if least < np.inf:
            break
    return least


@compiled
def tied_features(grid, counts, images, signs, radius, kernel, work, features):
    """Features of one configuration, given its copies ``images`` (G, r).

    Out of reach of all kernels the nearest prototypes answer.

    Parameters
    ----------
    grid, counts
        Cell list of the prototypes and [prototypes, entries].
    images : (G, r) array
        All copies of the configuration.
    signs : (c, G) array
        Sign of every copy, for each group of joints that share their signs.
    radius, kernel : float
        Unit of the offsets and width of the kernel [rad].
    work : Scratch
        Scratch.
    features : (c, M (1 + r)) array
        Result; per prototype the offset first.
    """
    rank = images.shape[1]
    scale = -1.0 / (kernel * kernel)
    features[:] = 0.0
    total = 0.0
    reference = 0.0
    for far in (False, True):
        if far:
            reference = least_distance(grid, counts, images, work)
        for g in range(images.shape[0]):
            found, _ = near_or_far(grid, counts, images[g], work, far)
            for e in range(found):
                weight = np.exp((work.squared[e] - reference) * scale)
                total += weight
                column = work.found[e] * (1 + rank)
                for c in range(signs.shape[0]):
                    signed = signs[c, g] * weight
                    features[c, column] += signed
                    for k in range(rank):
                        features[c, column + 1 + k] += signed * work.offset[e, k] / radius
        if total > 0.0:
            break
    features /= total


@compiled
def tied_features_batch(grid, counts, symmetries, signs, q, radius, kernel, work, result):
    """Features of configurations q (m, n), into ``result`` (c, m, M (1 + r))."""
    images = np.empty((symmetries[1].shape[0], symmetries[1].shape[1]))
    row = np.empty((signs.shape[0], result.shape[2]))
    for s in range(q.shape[0]):
        copies_of(symmetries, q[s], images)
        tied_features(grid, counts, images, signs, radius, kernel, work, row)
        for c in range(signs.shape[0]):
            for column in range(result.shape[2]):
                result[c, s, column] = row[c, column]
