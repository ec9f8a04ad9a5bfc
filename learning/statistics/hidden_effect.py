"""How large an effect can be that a small residual hides, whatever the noise."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy import optimize, stats

CHANCE = 2.0 * float(stats.norm.sf(3.0))
"""With which a larger effect leaves as small a residual: that of three standard errors."""
LEVELS = np.geomspace(0.2, 5.0, 200)
"""Noise levels that are tried, relative to the likeliest to hide an effect."""


@lru_cache
def hidden_effect(freedom: int) -> float:
    """Largest effect relative to the residual that it was seen with.

    Parameters
    ----------
    freedom : int
        Number of residuals that are left, at least 1.

    Notes
    -----
    A residual is an effect of length mu and normal noise of unknown level in so many directions.
    Its squared length, over the variance, has a noncentral chi-square distribution; noise must just
    cancel the effect for it to be short. The chance of that is largest at a level near mu over the
    square root of the freedom, and is compared there: nothing is assumed of the noise but that it
    is normal and the same everywhere.

    Examples
    --------
    One residual hides much, as noise may cancel by chance; several do not:

    >>> [round(hidden_effect(m), 1) for m in (1, 2, 4, 8)]
    [179.2, 11.7, 3.2, 1.7]
    """

    def excess(logarithm: float) -> float:
        effect = float(np.exp(logarithm))
        level = LEVELS * effect / np.sqrt(freedom)
        chance = stats.ncx2.cdf(level**-2.0, freedom, (effect / level) ** 2)
        return float(np.log(max(float(chance.max()), 1e-300)) - np.log(CHANCE))

    return float(np.exp(optimize.brentq(excess, 0.0, 8.0)))
