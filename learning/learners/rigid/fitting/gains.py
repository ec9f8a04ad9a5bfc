"""Gains of joints: which ratios samples determine, and what fixes their common factor."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit, fit_at
from isotorque.learning.learners.rigid.fitting.chain_search import minimise, polished
from isotorque.learning.learners.rigid.planning.information import Information, probe_poses
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]

OPEN_VALUE = 1e-9
"""Singular values below, relative to the largest, belong to what no torque determines."""
OPEN_SHARE = 1e-5
"""A gain is open if it takes so large a share in one of these directions."""
SAME_COST = 9.0
"""A search that ends with a cost larger by more has found another chain."""


@dataclass(frozen=True)
class GainGroup:
    """Joints whose gains are known relative to each other.

    Attributes
    ----------
    joints : tuple of int
        A joint alone is coupled with none: nothing determines its gain.
    scale_known : bool
        Whether their common factor is determined, by a joint with a known gain.
    """

    joints: tuple[int, ...]
    scale_known: bool


@single_thread()
def gain_groups(fit: ChainFit) -> tuple[GainGroup, ...]:
    """Groups of the joints with unknown gains.

    Notes
    -----
    ``U`` exists only for the right ratios (``dg_i/dq_j = dg_j/dq_i``), so joints that are coupled
    determine them. A common factor of a group goes into levers: no torque tells it. Both are read
    off the parameters' directions that change no torque anywhere.
    """
    free = np.flatnonzero(fit.asked_gains)
    if not len(free):
        return ()
    n, q = fit.model.n, probe_poses(fit.model.n)
    whitening = np.tile(np.eye(n), (len(q), 1, 1))
    mask = fit.model.free
    mask[4 * n : 5 * n] = fit.asked_gains
    anywhere = Information.of(fit.chain, q, whitening, mask)
    open_ = anywhere.vectors[anywhere.values <= OPEN_VALUE * anywhere.values.max(initial=0.0)]
    gains = slice(4 * n, 4 * n + len(free))
    # relative changes, in units in which those of all parameters have length 1
    size = anywhere.scale[gains]
    relative = open_[:, gains] / size / fit.chain.gains[free] * size.max()
    groups: list[list[int]] = []
    for i in range(len(free)):
        for group in groups:
            if np.abs(relative[:, i] - relative[:, group[0]]).max(initial=0.0) <= OPEN_SHARE:
                group.append(i)
                break
        else:
            groups.append([i])
    return tuple(
        GainGroup(
            tuple(int(j) for j in free[group]),
            bool(np.abs(relative[:, group[0]]).max(initial=0.0) <= OPEN_SHARE),
        )
        for group in groups
    )


@single_thread()
def with_fixed_scales(fit: ChainFit, groups: tuple[GainGroup, ...]) -> ChainFit:
    """The same torques, gains of each group relative to that of its most loaded joint."""
    open_groups = [g for g in groups if not g.scale_known]
    if not open_groups:
        return fit
    q = probe_poses(fit.model.n)
    torque = fit.chain.torque(q) - fit.chain.correction.at(q)
    load = np.sqrt(np.mean(torque**2, axis=0))
    gains, free = fit.chain.gains.copy(), fit.model.free_gains.copy()
    for group in open_groups:
        found = [j for j in group.joints if free[j]]
        if not found:
            continue
        reference = max(found, key=lambda j: load[j])
        gains[found] /= gains[reference]
        free[reference] = False
    model = replace(fit.model, gains=gains, free_gains=free)
    minimum = minimise(fit.samples, replace(fit.chain, gains=gains), free, fit.whitening)
    better = polished(fit.samples, minimum, model)
    minimum = better if better.cost <= minimum.cost else minimum
    if not minimum.cost <= fit.cost * (1 + 1e-6) + SAME_COST:
        return fit
    more = {"remark": fit.remark, "p_value": fit.p_value, "held_out": fit.held_out}
    return fit_at(
        minimum.chain, fit.samples, model, fit.asked_gains, fit.verdict, fit.starts, **more
    )
