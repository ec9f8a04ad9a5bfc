"""The pose that tells an arm most of its chain, among those that it can hold by itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.planning.pose_plan import plan_poses

Array = NDArray[np.float64]

PROPOSALS, DRAWN, REGION = 300, 1200, 200
"""Poses that are chosen from, that are drawn for it, and at which the torque is to be known."""
FARTHER = 1.5
"""Poses are drawn within so many times what each joint has moved from home."""
STIFF = 0.3
"""Least stiffness in any direction on the way to a pose, relative to home: soft ones may fall."""
SURE, SUREST = 0.1, 0.25
"""Largest standard error of a torque, by the stiffness at home [rad]; this share of the proposals,
those that are known best, are chosen from at least."""
WAY = (0.25, 0.5, 0.75, 1.0)
"""Where on the straight way from home the stiffness is asked."""
FELT = 1e-6
"""Joints less stiff at home, relative to the stiffest, are not felt by gravity."""


def telling_pose(
    fit: ChainFit,
    q: Array,
    torque: Array,
    home: Array,
    rng: np.random.Generator,
    *,
    refused: ArrayLike | None = None,
) -> Array | None:
    """Choose a pose that an arm without a controller can be sent to with one torque.

    Parameters
    ----------
    fit : ChainFit
        The chain as far as it is known.
    q, torque : (m, n) arrays
        Samples there are, those of the fit and later ones [rad], [N m].
    home : (n,) array
        Where the arm begins, and stays [rad].
    rng : numpy.random.Generator
        Source of proposals.
    refused : (k, n) array_like, optional
        Torques under which the arm did not settle [N m].

    Returns
    -------
    (n,) array or None
        The pose [rad]; the torque to command is the chain's. None where the chain knows of none.

    Notes
    -----
    Proposals go somewhat farther than the arm has been. By the chain they, and the way there, are
    stable, and its torque errs little, or less than elsewhere; it is nearer to a torque that was
    held than to any that was refused. Of those the one that lowers the standard errors of the
    torque on the whole torus most is chosen (`plan_poses`).

    Examples
    --------
    A pendulum that has hung nearly still is sent away from there:

    >>> from isotorque.learning.learners.rigid.rigid_chain import RigidChain
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-0.3, 0.3, (20, 1)) - np.pi / 2
    >>> torque = 6.0 * np.cos(q) + 0.01 * rng.normal(size=q.shape)
    >>> fit = RigidChain().fit(q, torque).fit_
    >>> home = np.array([-np.pi / 2])
    >>> found = telling_pose(fit, q, torque, home, rng)
    >>> bool(0.35 < abs(found - home)[0] < 0.45)
    True
    """
    chain = fit.chain
    at_home = _symmetric(chain, home[None])[0]
    felt = np.diag(at_home) > FELT * np.diag(at_home).max()
    if not felt.any():
        return None
    unit = 1.0 / np.sqrt(np.diag(at_home)[felt])

    def softest(poses: Array) -> Array:
        stiffness = _symmetric(chain, poses)[:, felt][:, :, felt]
        return np.asarray(np.linalg.eigvalsh(stiffness * unit[:, None] * unit)[:, 0])

    least = float(softest(home[None])[0])
    if least <= 0.0:
        return None
    reach = FARTHER * np.abs(q - home).max(axis=0)
    way = rng.uniform(-reach, reach, (DRAWN, len(home)))
    stable = np.all([softest(home + share * way) > STIFF * least for share in WAY], axis=0)
    proposed = (home + way)[stable][:PROPOSALS]
    if refused is not None and np.size(refused):
        needed, size = chain.torque(proposed), np.abs(torque).max(axis=0)
        size = np.where(size > 0.0, size, 1.0)
        nearest = [
            (np.abs(needed[:, None] - np.asarray(some)) / size).max(axis=2).min(axis=1)
            for some in (torque, refused)
        ]
        proposed = proposed[nearest[0] < nearest[1]]
    if len(proposed):
        error = (fit.standard_error(proposed)[:, felt] * unit**2).max(axis=1)
        proposed = proposed[error <= max(SURE, float(np.quantile(error, SUREST)))]
    if not len(proposed):
        return None
    known = fit.samples
    seen = ChainSamples(q, torque, known.torque_noise, known.angle_noise, np.ones(len(q)))
    region = rng.uniform(-np.pi, np.pi, (REGION, len(home)))
    return plan_poses(chain, fit.information.free, seen, proposed, region, 1).poses[0]


def _symmetric(chain: ChainParameters, q: Array) -> Array:
    """Stiffness (m, n, n) [N m/rad] at poses (m, n), symmetric whatever the gains."""
    stiffness = chain.stiffness(q)
    return np.asarray((stiffness + stiffness.transpose(0, 2, 1)) / 2.0)
