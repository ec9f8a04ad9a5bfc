"""Remaining errors: what explains the errors of a model at fresh poses, in words."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.causes.cause import Cause, causes_of
from isotorque.learning.statistics.causes.cause_words import causes_in_words
from isotorque.learning.statistics.causes.extension import Kind
from isotorque.learning.statistics.causes.linear_model import ADDING, LinearModel
from isotorque.learning.statistics.causes.selection import selected
from isotorque.learning.statistics.fresh_errors import LEAST_POSES, FreshErrors

Array = NDArray[np.float64]

DEVIATIONS = 3.0
"""A model's own standard error explains errors of so many times its size."""


def explained(
    found: FreshErrors,
    standard_error: Array | None = None,
    q: Array | None = None,
    directions: Array | None = None,
) -> tuple[str, ...]:
    """Say what explains the errors of a model at fresh poses: noise, its own errors, causes.

    Parameters
    ----------
    found
        The errors.
    standard_error : (P, n) array or None
        Of the model's predictions at the poses [N m], infinite where its data leave them open;
        None where it states none.
    q : (P, n) array, optional
        The poses [rad]: springs, cables and friction are looked for, too; without them constants.
    directions : (P, n) array, optional
        Signs of the last motion of every joint before the arm came to rest.

    Returns
    -------
    tuple of str
        One sentence part each.

    Examples
    --------
    >>> from isotorque.learning.statistics.fresh_errors import fresh_errors
    >>> noise = 0.1 * np.random.default_rng(0).normal(size=(30, 1))
    >>> def said(errors):
    ...     return explained(fresh_errors(errors, np.full((30, 1), 0.1), np.inf, np.array([0.05])))
    >>> said(noise)
    ('noise alone explains the errors',)
    >>> print(said(noise + 0.5)[1])
    the errors show a constant torque of +0.488 N m on joint 1 (standard error 0.02), or friction
    approached from one side: not to be told apart without approach directions; without it the RMSE
    is 0.0809 N m
    """
    by_noise = found.within(np.zeros(len(found.tolerance)))
    said = [_noise_in_words(found, by_noise, standard_error)]
    causes, left = _causes(found, q, directions)
    if causes:
        sizes = ", ".join(f"{x:.3g}" for x in left)
        said.append(
            f"the errors show {causes_in_words(causes)}; without it the RMSE is {sizes} N m"
        )
    return tuple(part for part in said if part)


def constants(found: FreshErrors) -> NDArray[np.intp]:
    """Joints, from 0 on, whose mean error is a significant constant."""
    joints = {cause.joint for cause in _causes(found, None, None)[0] if cause.joint is not None}
    return np.array(sorted(joints), dtype=np.intp)


def _causes(
    found: FreshErrors, q: Array | None, directions: Array | None
) -> tuple[tuple[Cause, ...], Array]:
    """What errors show, and the RMSE without it of the joints concerned [N m]."""
    errors, n = found.errors, found.errors.shape[1]
    if not errors.any() or found.poses < LEAST_POSES:
        return (), np.zeros(0)
    model = LinearModel.of(
        np.zeros(errors.shape) if q is None else q,
        errors,
        np.zeros((*errors.shape, 0)),
        directions=directions,
        kinds=(Kind.OFFSET,) if q is None else (*ADDING, Kind.FRICTION),
    )
    selection = selected(model, model.alone())
    causes = causes_of(selection)
    joints = sorted({j for cause in causes for j in cause.joints(n)})
    return causes, np.sqrt(np.mean(selection.fit.rest[:, joints] ** 2, axis=0))


def _noise_in_words(
    found: FreshErrors, by_noise: NDArray[np.bool_], standard_error: Array | None
) -> str:
    if not found.deviation.any() and standard_error is None:
        return ""
    if by_noise.all():
        return "noise alone explains the errors"
    beyond = ~by_noise
    if standard_error is None:
        return "noise alone does not explain the errors"
    own = np.sqrt(np.mean(standard_error**2, axis=0))
    sizes = ", ".join(f"{x:.2g}" for x in own)
    words = f"(RMS by joint {sizes} N m)"
    if not np.isfinite(own[beyond]).all():
        return f"the model's own standard error is infinite there {words}: its data leave it open"
    if found.within(DEVIATIONS * own)[beyond].all():
        return f"noise and the model's own standard error {words} explain the errors"
    return f"noise and the model's own standard error {words} do not explain the errors"
