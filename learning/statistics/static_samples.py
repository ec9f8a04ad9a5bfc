"""Static samples as arrays: checked, and grouped by the torque they share."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


def static_samples(q: ArrayLike, tau: ArrayLike) -> tuple[Array, Array]:
    """Check samples (q, tau).

    Parameters
    ----------
    q : (N, n) array_like
        Configurations [rad].
    tau : (N, n) array_like
        Torques that held them [N m].

    Returns
    -------
    q, tau : (N, n) arrays of float

    Raises
    ------
    InputError
        If the shapes do not agree or a number is not finite.
    """
    configurations = np.asarray(q, dtype=float)
    torques = np.asarray(tau, dtype=float)
    if configurations.ndim != 2 or configurations.shape[1] == 0:
        raise InputError("samples", "shape of q", configurations.shape, "(N, n), n >= 1")
    if torques.shape != configurations.shape:
        raise InputError("samples", "shape of tau", torques.shape, str(configurations.shape))
    for name, values in (("q", configurations), ("tau", torques)):
        bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
        if len(bad):
            where = f"{name} of sample {bad[0]}"
            raise InputError("samples", where, values[bad[0]], "finite numbers")
    return configurations, torques
