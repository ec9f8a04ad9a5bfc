"""Diagnosis of a recording: causes of torques beside gravity, named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.causes.extended_chain import ExtendedChain
from isotorque.learning.learners.rigid.causes.extensible_chain import AGAIN, ExtensibleChain
from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    checked_parents,
    serial,
)
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples, noise_by_joint
from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel
from isotorque.learning.learners.rigid.planning.poses_needed import poses_needed
from isotorque.learning.learners.sample_checks import checked_directions
from isotorque.learning.statistics.causes.cause import Cause, causes_of
from isotorque.learning.statistics.causes.extension import Term
from isotorque.learning.statistics.causes.selection import Selection, is_clear, selected
from isotorque.learning.statistics.poses import by_pose_and_side
from isotorque.learning.statistics.static_samples import static_samples
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]

LIGHT = 1e-3
"""Rows of less weight, relative to the largest, are left out: they would count among the degrees of
freedom."""
SPARE_POSES = 2
"""Poses more than determine a chain, from which causes are looked for."""


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What a recording shows beside gravity.

    Attributes
    ----------
    causes : tuple of Cause
        In the order in which they were named.
    adequate : bool
        Whether chain and causes explain the samples but for noise.
    noise : (n,) array
        Standard deviation of the torque errors, stated or estimated [N m].
    clear : bool
        Whether they do, and leave far less than a chain alone (`is_clear`).
    selection : Selection or None
        The fit; None where there are too few poses for a diagnosis.
    missing : str
        What stands in the way of a diagnosis.
    """

    causes: tuple[Cause, ...]
    adequate: bool
    clear: bool
    noise: Array
    selection: Selection[ExtendedChain] | None
    missing: str = ""


@single_thread()
def diagnose(
    q: ArrayLike,
    tau: ArrayLike,
    *,
    directions: ArrayLike | None = None,
    weight: ArrayLike | None = None,
    torque_noise: float | Sequence[float] | None = None,
    angle_noise: float | Sequence[float] = 0.0,
    parents: Sequence[int] | None = None,
    gains: Sequence[float] | NDArray[np.float64] | None = None,
    known: Sequence[ChainParameters] = (),
    included: Sequence[Term] = (),
    random_state: int = 0,
) -> Diagnosis:
    """Name what explains a recording beside the gravity of a rigid chain.

    Parameters
    ----------
    q, tau : (N, n) array_like
        Rows: configurations [rad] and torques [N m].
    directions : (N, n) array_like, optional
        Signs of the last motion of every joint before the arm came to rest; 0 where not known.
    weight : (N,) array_like, optional
        Of the squared errors of rows, above 0; what counts is how they differ.
    torque_noise : float or sequence of float, optional
        Standard deviation of the torque error [N m]; estimated for every joint by default.
    angle_noise : float or sequence of float
        Standard deviation of the angle error [rad].
    parents : sequence of int, optional
        Joint that carries each joint, -1 for the base; in series by default.
    gains : (n,) sequence of float, optional
        Measured torques over true ones, where that is known: no causes, and the gains that are
        found are relative to them.
    known : sequence of ChainParameters
        Chains to start from, where some were fitted before.
    included : sequence of Term
        Causes that are known to be there, whatever their size: they are not named.
    random_state : int
        Seed of the random starts.

    Returns
    -------
    Diagnosis

    Raises
    ------
    InputError
        If the arrays do not fit together.

    Notes
    -----
    The kinematics are unknown; zeros of encoders, the direction of gravity and a constant payload
    are no causes: a chain holds them itself. See `selected` for the decision.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-2.0, 2.0, (40, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> tau += 0.02 * rng.normal(size=tau.shape)
    >>> diagnose(q, tau).causes
    ()
    >>> cause, = diagnose(q, tau + [0.0, 0.3]).causes
    >>> print(cause.kind, cause.joint, cause.size.round(2))
    offset 1 [0.3]
    """
    configurations, torques = static_samples(q, tau)
    sides = checked_directions(directions, configurations.shape)
    weights = np.ones(len(torques)) if weight is None else np.asarray(weight, dtype=float)
    if weights.shape != torques.shape[:1] or not (np.isfinite(weights) & (weights > 0.0)).all():
        accepted = f"a number above 0 for every row, shape {torques.shape[:1]}"
        raise InputError("diagnose", "weight", f"shape {weights.shape}", accepted)
    kept = weights > LIGHT * weights.max(initial=0.0)
    configurations, torques, weights = configurations[kept], torques[kept], weights[kept]
    sides = None if sides is None else sides[kept]
    configurations, torques, sides, weights = by_pose_and_side(
        configurations, torques, sides, weights, summed=False
    )
    m, n = configurations.shape
    stated = 0.0 if torque_noise is None else torque_noise
    samples = ChainSamples(
        configurations,
        torques,
        noise_by_joint("diagnose", "torque_noise", stated, n),
        noise_by_joint("diagnose", "angle_noise", angle_noise, n),
        weights / weights.mean() if m else weights,
    )
    family = ChainModel(
        serial(n) if parents is None else checked_parents(parents, n),
        np.ones(n) if gains is None else np.array(gains, dtype=float),
        np.zeros(n, dtype=bool),
        (),
    )
    given, needed = samples.poses, poses_needed(family) + SPARE_POSES
    if given < needed or not torques.any():
        missing = f"{needed - given} more poses: {given} different ones were given"
        if not torques.any():
            missing = "samples with a torque"
        return Diagnosis((), False, False, samples.torque_noise, None, missing)
    model = ExtensibleChain(
        samples,
        family,
        sides,
        torque_noise is not None,
        bool(samples.angle_noise.any()),
        np.random.default_rng(random_state),
    )
    alone = model.alone(known, included)
    model = model.reweighted(alone)
    if not model.noise_known:
        alone = model.alone([alone.chain], included, AGAIN)
    selection = selected(model, alone)
    causes = causes_of(selection)
    clear = is_clear(selection, alone)
    return Diagnosis(causes, selection.adequate, clear, selection.model.noise, selection)
