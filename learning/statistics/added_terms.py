"""Further terms of single joints' torques, tried beside a model that was fitted to samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.statistics.hidden_effect import hidden_effect

Array = NDArray[np.float64]

SPARE = 2
"""Degrees of freedom that terms must leave, to know the noise."""
DEPENDENT = 1e-6
"""Directions of the terms' columns that the model holds up to this share are its own."""


@dataclass(frozen=True, eq=False)
class AddedTerms:
    """Further terms, w of them at each of k joints, as samples show them.

    Attributes
    ----------
    terms, errors : (k, w) arrays
        Estimates and standard errors.
    change : (p,) array
        Of the model's parameters, if the terms are there.
    more : (p, p) array
        Covariance that the terms add to theirs.
    freedom : float
        Degrees of freedom of the noise level of each joint; infinite where noise is known.
    bounded : bool
        Whether samples are too few to estimate them beside noise, and only tell how large they may
        be at most: estimates are zero then, and nothing is tested.
    """

    terms: Array
    errors: Array
    change: Array
    more: Array
    freedom: float
    bounded: bool = False

    def largest(self, deviations: float, reach: Array) -> Array:
        """Largest torque (k,) [N m] so many standard errors allow, functions as large as reach."""
        limit = np.abs(self.terms) + deviations * self.errors
        return np.asarray(np.linalg.norm(limit, axis=1) * reach)


def added_terms(
    design: Array,
    residual: Array,
    whitening: Array,
    values: Array,
    *,
    floor: float,
    known_noise: bool,
    allowed: float | None = None,
) -> AddedTerms | None:
    """Try terms on every joint beside a model.

    Parameters
    ----------
    design : (N k, p) array
        Derivatives of the whitened torques by the model's parameters, of full rank.
    residual : (N k,) array
        What the model leaves, whitened.
    whitening : (N, k, k) array
        What torques are multiplied with.
    values : (N, k, w) or (N, k, k, w) array
        Functions of the terms at the samples: torque of the joint itself; or of all joints (second
        axis) for one unit of a term of one joint (third axis).
    floor : float
        Least mean square of a residual: what arithmetic leaves, or 1 for known noise (noise that
        was given too small is no further term).
    known_noise : bool
        Whether the noise level was given; otherwise every joint has one of its own.
    allowed : float, optional
        Standard errors that are allowed for afterwards. If given, terms that leave too few degrees
        of freedom to know the noise are bounded: so many of their ``errors`` are the bound.

    Returns
    -------
    AddedTerms or None
        None where the samples are too few.

    Notes
    -----
    Terms are bounded by the whole residual, be it noise or what the model leaves of them: larger
    ones would leave as little with a chance of no more than three standard errors', however large
    the noise is (`hidden_effect`).
    """
    if values.ndim == 3:
        values = values[:, :, None, :] * np.eye(values.shape[1])[:, :, None]
    count, k, _, width = values.shape
    left_over = count * k - design.shape[1] - k * width
    bounded = left_over < SPARE
    if left_over < (0 if allowed is not None else SPARE):
        return None
    span, root = np.linalg.qr(design)
    size = np.sqrt(np.mean(np.sum(values**2, axis=1), axis=0)) + 1e-300  # (k, width)
    columns = np.einsum("Nil,Nljw->Nijw", whitening, values / size)
    columns = columns.reshape(count * k, k * width)
    held = span.T @ columns
    beyond = columns - span @ held
    again = span.T @ beyond
    beyond, held = beyond - span @ again, held + again
    left, singular, right = np.linalg.svd(beyond, full_matrices=False)
    whole = np.linalg.norm(columns, axis=0).max()
    seen = singular > DEPENDENT * whole
    left, singular, right = left[:, seen], singular[seen], right[seen]
    if bounded:
        assert allowed is not None
        free = count * k - span.shape[1]
        size_left = np.sqrt(max(float(residual @ residual), free * floor))
        error = hidden_effect(free) * size_left / allowed
        back, effect = right.T / singular, np.linalg.solve(root, held)
        covariance = error**2 * back @ back.T
        return AddedTerms(
            np.zeros((k, width)),
            np.sqrt(np.diag(covariance)).reshape(k, width) / size,
            np.zeros(design.shape[1]),
            effect @ covariance @ effect.T,
            np.inf,
            bounded=True,
        )
    coordinates = left.T @ residual
    rest = residual - left @ coordinates
    lever = (span**2).sum(axis=1) + (left**2).sum(axis=1)
    degrees = int(seen.sum())
    freedom = count * k - span.shape[1] - degrees
    own = np.maximum(count - lever.reshape(count, k).sum(axis=0), 1e-9)
    level = (rest.reshape(count, k) ** 2).sum(axis=0) / own
    if own.min() < SPARE:  # too few to tell joints apart
        level = np.full(k, float(rest @ rest) / max(1, freedom))
    level = np.maximum(level, floor)
    weight = np.tile(level, count)
    spread = (left * weight[:, None]).T @ left  # covariance of the coordinates
    own_freedom = np.inf if known_noise else float(freedom) / k
    back = right.T / singular
    terms = back @ coordinates
    covariance = back @ spread @ back.T
    effect = np.linalg.solve(root, held)  # what one unit of a term takes from the parameters
    return AddedTerms(
        terms.reshape(k, width) / size,
        np.sqrt(np.maximum(np.diag(covariance), 0.0)).reshape(k, width) / size,
        -effect @ terms,
        effect @ covariance @ effect.T,
        own_freedom,
    )


def springs(q: Array) -> Array:
    """Torques that grow with the angle of their own joint, (N, k, 1) at q (N, k) [rad]."""
    return q[:, :, None]


def second_harmonics(q: Array) -> Array:
    """Torques of twice the angle of their own joint (cables, bent links), (N, k, 2)."""
    turns = 2.0 * q
    return np.stack([np.cos(turns), np.sin(turns)], axis=2)
