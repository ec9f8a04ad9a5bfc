"""Number of further samples that an undecided question takes, in words."""

from __future__ import annotations

import numpy as np

MOST = 100_000
"""More samples than this are not counted out: other torques would tell sooner."""


def samples_needed(given: int, excess: float) -> str:
    """Say how many more samples bring an error down to what is allowed.

    Parameters
    ----------
    given : int
        Number of samples.
    excess : float
        Present error divided by the allowed one, above 1. It falls with the square root of the
        number of samples, as long as these are like the given ones.

    Examples
    --------
    >>> samples_needed(20, 2.0)
    'about 60 more samples'
    >>> samples_needed(20, 1e5)
    'more than 100000 more samples like these 20, or other torques'
    """
    more = given * (excess**2 - 1.0)
    if more > MOST:
        return f"more than {MOST} more samples like these {given}, or other torques"
    return f"about {max(1, int(np.ceil(more)))} more samples"


def samples_with_torque_needed(given: int, joints: int) -> str:
    """Say what is missing where no sample has a torque.

    Parameters
    ----------
    given : int
        Number of samples, all without torque.
    joints : int
        Number of joints n: (3^n - 1)/n + 1 samples fix a potential and constants, one more equation
        checks them.

    Examples
    --------
    >>> samples_with_torque_needed(0, 2)
    '6 samples with a torque: none was given'
    """
    wanted = -(-(3**joints) // joints) + 1
    found = "all given torques are zero" if given else "none was given"
    return f"{wanted} samples with a torque: {found}"
