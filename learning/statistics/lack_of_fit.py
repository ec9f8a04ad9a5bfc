"""Lack of fit: whether the form that was fitted explains the samples.

Whatever a model has no term for ends up in its residuals, is taken for noise there and averaged
away as if it were noise; claims then come with bounds that shrink with the number of samples and
are wrong. So nothing is claimed before this test has been passed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.learning.statistics.added_terms import (
    added_terms,
    in_words,
    second_harmonics,
    springs,
)
from isotorque.learning.statistics.constant_torques import constants_in_words
from isotorque.learning.statistics.poses import Poses
from isotorque.learning.statistics.tails import tail_probability

Array = NDArray[np.float64]

SIGNIFICANCE = 1e-3
"""Chance with which samples of a rigid arm are said to be misfitted, over all alternatives."""
NEGLIGIBLE = 1e-6
"""Misfits below this share of the largest torque are where motions ended; bounds allow for them."""
PURE_ERROR_SIGNIFICANCE, PURE_ERROR_SHARE = 1e-4, 0.02
"""Where poses repeat, the misfit must be this significant and this share of the torque (RMS)."""
KINDS, WIDEST = 2, 2
"""Alternatives, and terms per joint of the widest one."""


@dataclass(frozen=True, eq=False)
class Alternative:
    """The fitted model with further terms.

    Attributes
    ----------
    name : str
        What the terms are.
    fit : FittedPotential
        Coefficients, offsets and their errors if the terms are there.
    size : (n,) array
        Largest torque that each joint's terms may have within half a turn [N m], noise included.
    p_value : float
        Chance of such an improvement, or a larger one, if the terms are not there.
    misfit : (n,) array
        Root mean square over the samples of what the terms explain better [N m].
    said : str
        The terms in words, with numbers.
    bounded : bool
        Whether samples were too few to look for them, and only bound them.
    """

    name: str
    fit: FittedPotential
    size: Array
    p_value: float
    misfit: Array
    said: str
    bounded: bool = False


@dataclass(frozen=True, eq=False)
class LackOfFit:
    """Lack of fit of a potential, as its residuals show it.

    Attributes
    ----------
    offset_joints : (k,) int array
        Joints with a constant torque beside gravity.
    offsets, offset_errors : (n,) arrays
        Constant torques and their standard errors [N m].
    alternatives : tuple of Alternative
        All that there were samples enough for.
    misfit : (n,) array
        Root mean square of what the form cannot explain [N m]; zero where the test is passed.
    said : str
        What is wrong, with its size; empty where the test is passed and there is no offset.
    """

    offset_joints: NDArray[np.intp]
    offsets: Array
    offset_errors: Array
    alternatives: tuple[Alternative, ...]
    misfit: Array
    said: str

    @property
    def failed(self) -> bool:
        """Whether the samples show what the form has no term for: nothing may be claimed."""
        return bool(self.misfit.any())


def lack_of_fit(
    fit: FittedPotential,
    tau: Array,
    *,
    poses: Poses | None = None,
    rows: Array | None = None,
    deviations: float = 3.0,
) -> LackOfFit:
    """Look for what a potential and constant torques cannot explain.

    Parameters
    ----------
    fit : FittedPotential
        Of one sample per pose.
    tau : (N, n) array
        Torques of these samples [N m].
    poses : Poses, optional
        How rows were grouped into samples.
    rows : (N', n) array, optional
        Torques of the rows [N m]; needed with ``poses``.
    deviations : float
        Standard errors that ``Alternative.size`` allows for.

    Returns
    -------
    LackOfFit

    Notes
    -----
    Terms that are tried on every joint beside the potential and its constant: a torque that grows
    with the joint's angle (a spring), and one of twice its angle (a cable over a pulley, a bent
    link). If the form is right they explain the residuals no better than chance: a Wald test with a
    noise level of each joint, of its own (F distributed; chi-square where the noise is known).
    Where poses repeat, the scatter within poses says how large the residuals may be [1]_; that also
    finds what has no name. With too few samples for a term it is not tried: then there are only a
    few degrees of freedom, and Student's factors are large; with a few less than a test takes, it
    is only said how large they may be for residuals as small as these.

    References
    ----------
    .. [1] N. R. Draper, H. Smith, "Applied Regression Analysis", 3rd ed., Wiley 1998, section 2.1.

    Examples
    --------
    >>> from isotorque.learning.relations.potential.potential_fit import all_frequencies
    >>> from isotorque.learning.relations.potential.potential_fit import fit_potential
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-3.0, 3.0, (40, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> tau += 0.02 * rng.normal(size=tau.shape)
    >>> def examined(tau):
    ...     return lack_of_fit(fit_potential(q, tau, all_frequencies(2)), tau)
    >>> examined(tau).said
    ''
    >>> examined(tau + [0.0, 0.3]).said
    'a constant torque of +0.304 N m on joint 2 (standard error 0.003), or friction approached from
    one side: not to be told apart without approach directions'
    >>> examined(tau + [0.0, 0.2] * q).said
    'a torque that grows with its angle (a spring), +0.194 N m/rad on joint 2'
    """
    n = len(fit.offsets)
    largest = max(float(np.abs(tau).max(initial=0.0)), 1e-300)
    found = tuple(_alternatives(fit, deviations))
    nothing = np.zeros(n)
    worst = min(found, key=lambda a: a.p_value, default=None)
    joints = _offset_joints(fit, largest)
    misfit, said = nothing, constants_in_words(joints, fit.offsets, fit.offset_errors)
    if worst is not None and worst.p_value < SIGNIFICANCE / len(found):
        if worst.misfit.max() > NEGLIGIBLE * largest:
            misfit, said = worst.misfit, worst.said
    elif poses is not None and rows is not None and poses.repeated:
        scattered = _beyond_pure_error(fit, poses, rows)
        size = float(np.sqrt(np.mean(tau**2)))
        if scattered.max(initial=0.0) > PURE_ERROR_SHARE * size:
            misfit = scattered
            said = (
                f"the {poses.count} poses miss the form of gravity by "
                f"{_listed(scattered)} N m RMS by joint, far more than the rows of one pose scatter"
            )
    if not misfit.any() and np.isinf(fit.freedom):
        beyond = _beyond_known_noise(fit)
        if beyond.max(initial=0.0) > NEGLIGIBLE * largest:
            misfit = beyond
            said = f"residuals of {_listed(beyond)} N m RMS by joint, more than the given noise"
    return LackOfFit(joints, fit.offsets, fit.offset_errors, found, misfit, said)


def samples_for_alternatives(fit: FittedPotential) -> int:
    """Samples from which every alternative is bounded."""
    samples = fit.whitened
    joints = len(samples.joints)
    return -(-(samples.design.shape[1] + WIDEST * joints) // joints)


def _listed(values: Array) -> str:
    return ", ".join(f"{x:.2g}" for x in values)


def _offset_joints(fit: FittedPotential, largest: float) -> NDArray[np.intp]:
    """Joints whose constants noise does not explain."""
    joints = fit.whitened.joints
    size, error = np.abs(fit.offsets[joints]), fit.offset_errors[joints]
    ratio = np.divide(size, error, out=np.zeros_like(size), where=error > 0.0)
    chance = np.array([tail_probability(float(z**2), 1, fit.freedom) for z in ratio])
    seen = (chance < SIGNIFICANCE / max(1, len(joints))) & (size > NEGLIGIBLE * largest)
    return np.asarray(joints[seen])


def _alternatives(fit: FittedPotential, deviations: float) -> list[Alternative]:
    """The fit with springs on every joint, and with second harmonics on every joint."""
    q = fit.whitened.q
    reach = np.maximum(np.pi, np.abs(q).max(axis=0))
    kinds = {
        "spring": (springs(q), reach),
        "second harmonic": (second_harmonics(q), np.ones(q.shape[1])),
    }
    found = []
    for name, (values, size) in kinds.items():
        alternative = _alternative(fit, name, values, size, deviations)
        if alternative is not None:
            found.append(alternative)
    return found


def _alternative(
    fit: FittedPotential, name: str, values: Array, reach: Array, deviations: float
) -> Alternative | None:
    samples = fit.whitened
    known = not np.isfinite(fit.freedom)
    added = added_terms(
        samples.design,
        samples.residual,
        samples.whitening,
        values,
        floor=1.0 if known else samples.floor,
        known_noise=known,
        allowed=deviations,
    )
    if added is None:
        return None
    k = len(samples.joints)
    offsets, errors = fit.offsets.copy(), fit.offset_errors.copy()
    offsets[samples.joints] += added.change[:k]
    errors[samples.joints] = np.sqrt(errors[samples.joints] ** 2 + np.diag(added.more)[:k])
    extended = replace(
        fit,
        coefficients=fit.coefficients + added.change[k:],
        root=_root(fit.root, added.more[k:, k:]),
        offsets=offsets,
        offset_errors=errors,
    )
    misfit, largest = np.zeros((2, len(fit.offsets)))
    misfit[samples.joints] = added.misfit
    largest[samples.joints] = added.largest(deviations, reach)
    said = in_words(added, samples.joints)
    return Alternative(name, extended, largest, added.p_value, misfit, said, added.bounded)


def _root(root: Array, more: Array) -> Array:
    """Root of the inverse of a covariance ``(root^T root)^-1 + more``."""
    # (I + root more root^T) is well conditioned whatever the units of the coefficients
    inner = np.eye(len(root)) + root @ more @ root.T
    return np.asarray(np.linalg.solve(np.linalg.cholesky((inner + inner.T) / 2.0), root))


def _residual_torque(fit: FittedPotential) -> Array:
    """Residuals (N, n) [N m], as large as if no degrees of freedom had been spent."""
    samples = fit.whitened
    count, k, _ = samples.whitening.shape
    torque = np.linalg.solve(samples.whitening, samples.residual.reshape(count, k, 1))[:, :, 0]
    found = np.zeros((count, len(fit.offsets)))
    spent = samples.design.shape[1] / (count * k)
    found[:, samples.joints] = torque / np.sqrt(max(1.0 - spent, 1.0 / (count * k)))
    return found


def _beyond_pure_error(fit: FittedPotential, poses: Poses, rows: Array) -> Array:
    """Root mean square residuals (n,) where scatter within poses does not explain them, or 0."""
    deviation, freedom = poses.spread(rows)
    residual = _residual_torque(fit)
    if len(residual) != poses.count:
        return np.zeros(len(deviation))
    left = len(residual) - fit.whitened.design.shape[1] / max(1, len(fit.whitened.joints))
    found = np.sqrt(np.mean(residual**2, axis=0))
    for joint, sigma in enumerate(deviation):
        weighted = float((residual[:, joint] ** 2 @ poses.rows) / len(residual))
        ratio = weighted / max(float(sigma) ** 2, 1e-30 * weighted, 1e-300)
        own = max(left, 0.5)
        chance = tail_probability(ratio * own, int(np.ceil(own)), float(freedom))
        if chance > PURE_ERROR_SIGNIFICANCE / len(deviation):
            found[joint] = 0.0
    return np.asarray(found)


def _beyond_known_noise(fit: FittedPotential) -> Array:
    """Root mean square residuals (n,) where the given noise does not explain them, else 0."""
    samples = fit.whitened
    degrees = samples.residual.size - samples.design.shape[1]
    squares = float(samples.residual @ samples.residual)
    if tail_probability(squares, degrees, np.inf) > PURE_ERROR_SIGNIFICANCE:
        return np.zeros(len(fit.offsets))
    return np.asarray(np.sqrt(np.mean(_residual_torque(fit) ** 2, axis=0)))
