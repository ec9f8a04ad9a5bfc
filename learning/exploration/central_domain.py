"""Choice among equivalent fundamental domains: the one an arm should explore."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup

Array = NDArray[np.float64]

ENOUGH = 0.5
"""Share of the best-filled cell's settled samples that makes a cell eligible."""


def central_domain(group: SymmetryGroup, settled: Array, seen: Array) -> FundamentalDomain:
    """The domain in which the arm holds itself often, farthest from where joints were stopped.

    Parameters
    ----------
    group : SymmetryGroup
        The relations.
    settled : (m, n) array
        Configurations in which the arm has settled [rad]; none: the domain around the middle of
        ``seen`` is taken.
    seen : (k, n) array
        All configurations observed, those at joint limits among them [rad].

    Returns
    -------
    FundamentalDomain
        An image of the default domain under one of the relations, turned into the range seen.

    Notes
    -----
    All images hold one configuration per orbit, but an arm under constant torques settles only in
    stable ones, and a domain that borders on joint limits is lost there again and again. Of the
    images that hold at least half as many settled samples as the best, the one whose centre is
    farthest from the extreme angles seen is taken.
    """
    default = FundamentalDomain(group)
    if not len(settled):
        return FundamentalDomain.near(group, np.mean(seen, axis=0))
    held = np.bincount(default.representatives(settled).relation.ravel(), minlength=group.order)
    low, high = np.min(seen, axis=0), np.max(seen, axis=0)
    best, best_margin = default.center, -np.inf
    for count, relation in zip(held, group, strict=True):
        if count < ENOUGH * held.max():
            continue
        center = relation.inverse().configuration(default.center)
        turns = np.round((center - 0.5 * (low + high)) / (2 * np.pi))
        center = center - 2 * np.pi * turns
        margin = float(np.minimum(center - low, high - center).min())
        if margin > best_margin + 1e-9:
            best, best_margin = center, margin
    return FundamentalDomain(group, best)
