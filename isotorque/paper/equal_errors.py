"""Number of samples that an error takes, read off a curve of errors by samples."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np


def samples_needed(curve: Mapping[int, float], error: float) -> float | None:
    """Return the number of samples from which on a curve stays at or below an error.

    Parameters
    ----------
    curve
        Torque RMSE by number of samples [N m].
    error
        The error wanted [N m].

    Returns
    -------
    float or None
        Interpolated between logarithms; the least number tried where that suffices already, None
        where the most does not.

    Examples
    --------
    >>> round(samples_needed({10: 1.0, 40: 0.25, 100: 0.01}, 0.5), 6)
    20.0
    >>> samples_needed({10: 1.0}, 0.5) is None, samples_needed({10: 0.1}, 0.5)
    (True, 10.0)
    """
    counts = sorted(curve)
    first = None
    for place in range(len(counts) - 1, -1, -1):
        if curve[counts[place]] > error:
            break
        first = place
    if first is None:
        return None
    if first == 0:
        return float(counts[0])
    before, after = counts[first - 1], counts[first]
    if curve[after] <= 0.0:
        return float(after)
    share = np.log(curve[before] / error) / np.log(curve[before] / curve[after])
    return float(before * (after / before) ** share)
