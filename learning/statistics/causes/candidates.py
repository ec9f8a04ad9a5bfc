"""Causes that samples can show at all, and what each would explain to first order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.causes.extended_fit import ExtendedFit
from isotorque.learning.statistics.causes.extensible_model import ExtensibleModel, F
from isotorque.learning.statistics.causes.extension import Extension, Kind, Shape

Array = NDArray[np.float64]

CARRYING, CARRYING_SHARE = 4.0, 0.01
"""Gain and compliance are looked for where the torque (RMS) is so many times its noise, or what a
fit leaves that explains nothing, or else this share of that of the most loaded joint: elsewhere
they turn noise into a feature that fits it."""
FELT = 0.02
"""Angle scales are looked for where a radian changes torques by this share of the largest (RMS)."""
TWO_SIDED = 0.999
"""Friction is looked for where approaches come from both sides: mean direction below."""
SPLITS = (0.25, 0.375, 0.5, 0.625, 0.75)
"""Parts of a recording after which another load is looked for."""
ABSORBED = 1e-6
"""Columns that a model holds itself up to this share are its own."""
EVERYWHERE = (Kind.OFFSET, Kind.GAIN, Kind.FRICTION)
"""Kinds that all joints may have at once."""


def candidates(model: ExtensibleModel[F], fit: F, explained: bool) -> list[Extension]:
    """Causes that could be added to a fit.

    Parameters
    ----------
    model : ExtensibleModel
    fit : ExtendedFit
        With what it contains already.
    explained : bool
        Whether the fit explains the samples: otherwise what it leaves says nothing of the noise.
    """
    n = model.q.shape[1]
    size = np.sqrt(np.mean(model.torque**2, axis=0))
    noise = model.noise if explained or model.noise_known else np.zeros(n)
    left = noise if explained else np.sqrt(np.mean(fit.rest**2, axis=0))
    loaded = (size > CARRYING * left) | (size > CARRYING_SHARE * size.max(initial=0.0))
    loaded &= size > CARRYING * noise
    felt = np.sqrt(np.mean(fit.stiffness**2, axis=0)).max(axis=0) > FELT * size.max(initial=0.0)
    sided = np.zeros(n, dtype=bool)
    if model.directions is not None:
        sided = np.abs(model.directions.mean(axis=0)) < TWO_SIDED
        sided &= np.abs(model.directions).mean(axis=0) > 0.5
    possible = {
        Kind.OFFSET: np.ones(n, dtype=bool),
        Kind.GAIN: loaded,
        Kind.SPRING: np.ones(n, dtype=bool),
        Kind.FRICTION: sided,
        Kind.CABLE: np.ones(n, dtype=bool),
        Kind.SCALE: felt,
        Kind.COMPLIANCE: loaded,
    }
    have = set(fit.terms)
    found = []
    for kind, where in possible.items():
        if kind not in model.kinds:
            continue
        joints = [int(j) for j in np.flatnonzero(where)]
        found += [Extension.at(kind, j) for j in joints]
        if kind is Kind.GAIN and joints:  # a common gain is no cause: it goes into the masses
            joints.remove(int(np.argmax(size)))
        if kind in EVERYWHERE and len(joints) > 1:
            found.append(Extension.everywhere(kind, joints))
    loads = any(term.shape is Shape.LOAD for term in fit.terms)
    if Kind.PAYLOAD in model.kinds and not loads:
        splits = sorted({int(len(model.q) * part) for part in SPLITS} - {0})
        found += [Extension.payload(first) for first in splits]
    return [extension for extension in found if not set(extension.terms) <= have]


def explained_to_first_order(
    fit: ExtendedFit, extensions: Sequence[Extension]
) -> tuple[Array, NDArray[np.intp]]:
    """What each cause would take from the cost of a fit, and its degrees of freedom.

    Returns
    -------
    taken : (k,) array
        0 where the model holds the columns itself: nothing tells the cause from gravity.
    degrees : (k,) int array
    """
    basis, residual = fit.basis, fit.residual
    have = set(fit.terms)
    taken, degrees = np.zeros(len(extensions)), np.zeros(len(extensions), dtype=np.intp)
    for i, extension in enumerate(extensions):
        columns = fit.columns([term for term in extension.terms if term not in have])
        rows = (fit.whitening @ columns).reshape(len(residual), -1)
        size = np.linalg.norm(rows, axis=0)
        rows = rows[:, size > 0.0] / size[size > 0.0]
        beyond = rows - basis @ (basis.T @ rows)
        beyond -= basis @ (basis.T @ beyond)
        left, values, _ = np.linalg.svd(beyond, full_matrices=False)
        left = left[:, values > ABSORBED]
        degrees[i] = left.shape[1]
        taken[i] = float(np.sum((left.T @ residual) ** 2))
    return taken, degrees
