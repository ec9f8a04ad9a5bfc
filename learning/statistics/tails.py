"""Chances of large deviations, the noise being known or estimated."""

from __future__ import annotations

import numpy as np
from scipy import stats


def quantile(deviations: float, freedom: float) -> float:
    """Standard errors that are exceeded as rarely as `deviations` by a normal variable.

    More if the noise was estimated with few degrees of freedom (Student's t).
    """
    if np.isinf(freedom):
        return deviations
    return float(stats.t.isf(stats.norm.sf(deviations), freedom))


def tail_probability(statistic: float, degrees: int, freedom: float) -> float:
    """P(misfit >= statistic): chi-square with `degrees`, or F where the noise was estimated."""
    if degrees <= 0:
        return 1.0
    if np.isinf(freedom):
        return float(stats.chi2.sf(statistic, degrees))
    return float(stats.f.sf(statistic / degrees, degrees, freedom))
