"""Multiple linear regression of a relation between configurations (paper, section 4.2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.learned_symmetries import FreeRegression
from isotorque.symbolic.common.angles import wrap

Array = NDArray[np.float64]

DEPENDENT = 1e-9


def regress_relation(q_r: Array, q_s: Array, A: Array, d: Array) -> FreeRegression | None:
    """Regress q_s on q_r over the reals.

    Parameters
    ----------
    q_r, q_s : (P, n) arrays
        Pairs that obey the relation [rad].
    A : (n, n) array
        Integer linear part; with `d` it tells the branch of the angles q_s modulo 2 pi.
    d : (n,) array
        Offset [rad].

    Returns
    -------
    FreeRegression or None
        None if the pairs do not determine A and d with at least one pair to spare.

    References
    ----------
    N. R. Draper, H. Smith, "Applied Regression Analysis", Wiley 1998, chapter 5.

    Examples
    --------
    >>> q_r = np.random.default_rng(0).uniform(-1, 1, (6, 1))
    >>> found = regress_relation(q_r, wrap(np.pi - q_r), -np.eye(1), np.array([3.0]))
    >>> found.M.round(9).tolist(), found.d.round(9).tolist()
    ([[1.0]], [3.141592654])
    """
    pairs, n = q_r.shape
    freedom = pairs - n - 1
    if freedom < 1:
        return None
    predicted = q_r @ A.T + d
    target = predicted + wrap(q_s - predicted)
    design = np.concatenate([q_r, np.ones((pairs, 1))], axis=1)
    solution, _, _, singular = np.linalg.lstsq(design, target, rcond=None)
    if singular[-1] < DEPENDENT * singular[0]:
        return None
    residual = target - design @ solution
    variance = (residual**2).sum(axis=0) / freedom
    spread = np.diag(np.linalg.inv(design.T @ design))
    error = np.sqrt(spread[:, None] * variance[None, :])
    return FreeRegression(solution[:n].T, error[:n].T, solution[n], error[n], pairs)
