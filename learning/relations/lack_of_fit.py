"""Lack of fit: whether the form that was fitted explains the samples.

Whatever a model has no term for ends up in its residuals, is taken for noise there and averaged
away as if it were noise; claims then come with bounds that shrink with the number of samples and
are wrong. So nothing is claimed before this test has been passed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.potential.extensible_waves import ADDING, extensible_waves
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.learning.statistics.added_terms import added_terms, second_harmonics, springs
from isotorque.learning.statistics.causes.cause import Cause, causes_of
from isotorque.learning.statistics.causes.cause_words import causes_in_words
from isotorque.learning.statistics.causes.extended_fit import ExtendedFit
from isotorque.learning.statistics.causes.extension import Kind
from isotorque.learning.statistics.causes.selection import is_clear, selected
from isotorque.learning.statistics.causes.unexplained import (
    beyond_scatter,
    beyond_stated_noise,
    unspent,
)
from isotorque.learning.statistics.poses import Poses
from isotorque.symbolic.groups.correction import Correction

Array = NDArray[np.float64]

SIGNIFICANCE = 1e-3
"""Chance with which samples of a rigid arm are said to be misfitted. Relations are refused then, so
it is smaller than that of naming causes; what is not seen is in every bound."""
NEGLIGIBLE = 1e-6
"""Misfits below this share of the largest torque are where motions ended; bounds allow for them."""
KINDS, WIDEST = 2, 2
"""Alternatives, and terms per joint of the widest one."""
NOISY = 0.1
"""Torque sensors leave less than this share of the torques (RMS) unexplained, unless said."""
OF_A_CHAIN = {Kind.GAIN, Kind.SIGN, Kind.SPRING}
"""Gains break no relation, and springs can be taken off."""


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
    bounded : bool
        Whether samples were too few to estimate them, and only bound them.
    """

    name: str
    fit: FittedPotential
    size: Array
    bounded: bool = False


@dataclass(frozen=True, eq=False)
class LackOfFit:
    """What samples show beside gravity.

    Attributes
    ----------
    causes : tuple of Cause
        In the order in which they were named.
    offset_joints : (k,) int array
        Joints with a constant torque beside gravity.
    offsets, offset_errors : (n,) arrays
        Constant torques and their standard errors [N m].
    alternatives : tuple of Alternative
        Further terms as large as the samples leave room for, where they bound them.
    failed : bool
        Whether the samples show what the form has no term for: nothing may be claimed.
    said : str
        What there is, with its size; empty where there is nothing.
    left : str
        What is left, if that is more than sensors leave: further samples will not help.
    rates : (n,) array or None
        Spring rates that a chain holds [N m/rad].
    silent : (n,) array or None
        Largest torque seen of joints that were taken for joints without any [N m], 0 for others.
    """

    causes: tuple[Cause, ...]
    offset_joints: NDArray[np.intp]
    offsets: Array
    offset_errors: Array
    alternatives: tuple[Alternative, ...]
    failed: bool
    said: str
    left: str = ""
    rates: Array | None = None
    silent: Array | None = None

    @property
    def correction(self) -> Correction:
        """What may be taken off the measured torques: constants that were seen, and springs."""
        constant = np.zeros(len(self.offsets))
        constant[self.offset_joints] = self.offsets[self.offset_joints]
        return Correction(constant, self.rates)

    @property
    def of_a_chain(self) -> bool:
        """Whether all that the form has no term for is what a chain can hold: gains, springs."""
        kinds = {cause.kind for cause in self.causes}
        return self.failed and bool(kinds & OF_A_CHAIN) and kinds <= OF_A_CHAIN | {Kind.OFFSET}


def lack_of_fit(
    fit: FittedPotential,
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
    Causes are added to the potential and decided upon as to any model (`selected`): constants,
    which the form of measured torques has a term for, and what it has none for. Where poses repeat,
    the scatter within poses says how large the residuals may be, and where the noise is known the
    noise does (`beyond_scatter`, `beyond_stated_noise`): that also finds what has no name. With too
    few samples for a cause it is not tried: then there are only a few degrees of freedom, and
    Student's factors are large. How large springs and cables may be that are not named is bounded
    in any case, the model's coefficients giving way (``alternatives``).

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
    ...     return lack_of_fit(fit_potential(q, tau, all_frequencies(2)))
    >>> examined(tau).said
    ''
    >>> examined(tau + [0.0, 0.3]).said
    'a constant torque of +0.304 N m on joint 2 (standard error 0.003), or friction approached from
    one side: not to be told apart without approach directions'
    >>> examined(tau + [0.0, 0.2] * q).said
    'a torque that grows with its angle (a spring) of +0.194 N m/rad on joint 2 (standard error
    0.003)'
    """
    model = extensible_waves(fit)
    alone = model.alone()
    selection = selected(model, alone, level=SIGNIFICANCE)
    joints = fit.whitened.joints
    left = _left(selection.fit)
    causes = causes_of(selection, joints.tolist())
    if left and not is_clear(selection, alone):  # samples of no arm come nearer with any cause
        causes = tuple(cause for cause in causes if cause.kind in ADDING)
    constant = [j for c in causes if c.kind is Kind.OFFSET for j in c.joints(len(fit.offsets))]
    offset_joints = np.intersect1d(joints, np.array(constant, dtype=np.intp))
    said, failed = causes_in_words(causes), any(cause.kind is not Kind.OFFSET for cause in causes)
    if not failed:
        beyond = _unexplained(selection.fit, selection.model.noise_known, joints, poses, rows)
        failed, said = bool(beyond), "; ".join(part for part in (said, beyond) if part)
    alternatives = tuple(_alternatives(fit, deviations))
    return LackOfFit(
        causes, offset_joints, fit.offsets, fit.offset_errors, alternatives, failed, said, left
    )


def _left(found: ExtendedFit) -> str:
    """What is left in words, if it is more than sensors leave."""
    spread, size = (
        np.sqrt(np.mean(torque**2, axis=0)) for torque in (unspent(found), found.torque)
    )
    share = float(np.linalg.norm(spread) / max(float(np.linalg.norm(size)), 1e-300))
    if not share > NOISY:
        return ""
    return (
        f"an error of {_listed(spread)} N m RMS by joint that rigid gravity and constants leave, "
        f"{100 * share:.2g} % of the torques: unless the torques were measured that badly more "
        "samples will not help (a sign or a scale, the order of columns, degrees, friction)"
    )


def _unexplained(
    found: ExtendedFit,
    noise_known: bool,
    joints: NDArray[np.intp],
    poses: Poses | None,
    rows: Array | None,
) -> str:
    """What noise does not explain, in words."""
    if poses is not None and rows is not None:
        scattered = beyond_scatter(found, poses, rows[:, joints])
        if scattered.any():
            return (
                f"the {poses.count} poses miss the form of gravity by "
                f"{_listed(scattered)} N m RMS by joint, far more than the rows of one pose scatter"
            )
    if noise_known:
        beyond = beyond_stated_noise(found)
        if beyond.max(initial=0.0) > NEGLIGIBLE * float(np.abs(found.torque).max()):
            return f"residuals of {_listed(beyond)} N m RMS by joint, more than the given noise"
    return ""


def samples_for_alternatives(fit: FittedPotential) -> int:
    """Samples from which every alternative is bounded."""
    samples = fit.whitened
    joints = len(samples.joints)
    return -(-(samples.design.shape[1] + WIDEST * joints) // joints)


def _listed(values: Array) -> str:
    return ", ".join(f"{x:.2g}" for x in values)


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
    largest = np.zeros(len(fit.offsets))
    largest[samples.joints] = added.largest(deviations, reach)
    return Alternative(name, extended, largest, added.bounded)


def _root(root: Array, more: Array) -> Array:
    """Root of the inverse of a covariance ``(root^T root)^-1 + more``."""
    # (I + root more root^T) is well conditioned whatever the units of the coefficients
    inner = np.eye(len(root)) + root @ more @ root.T
    return np.asarray(np.linalg.solve(np.linalg.cholesky((inner + inner.T) / 2.0), root))
