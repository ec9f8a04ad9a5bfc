"""Potential fitted to the poses of a recording, examined before anything is claimed from it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.lack_of_fit import (
    KINDS,
    LackOfFit,
    lack_of_fit,
    samples_for_alternatives,
)
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.learning.relations.potential.inactive_joints import fit_on_active_joints
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.learning.relations.potential.samples_needed import samples_needed
from isotorque.learning.statistics.poses import by_pose
from isotorque.learning.statistics.tails import quantile

Array = NDArray[np.float64]

EXACT = 1e-6
"""Residuals below this share of the largest torque are where motions ended."""
LARGEST_ERROR = 0.05
"""Relations are claimed if the data exclude larger RMS torque errors, relative to RMS torque."""
BOUND_DEVIATIONS = 3.0
"""Errors are stated at as small a chance as three standard errors of a normal variable."""


def could_be_wrong(samples: int, excess: float) -> str:
    """Say how many samples would allow relations to be claimed.

    Parameters
    ----------
    samples : int
        Number of samples.
    excess : float
        Largest error that a relation may have, divided by the one that is allowed.

    Examples
    --------
    >>> could_be_wrong(20, 2.0)
    'about 60 more samples: relations could still be wrong by 10 % of the torque, 5 % are allowed'
    """
    percent = 100.0 * LARGEST_ERROR
    return (
        f"{samples_needed(samples, excess)}: relations could still be wrong by "
        f"{percent * excess:.2g} % of the torque, {percent:.0f} % are allowed"
    )


@dataclass(frozen=True, eq=False)
class ExaminedFit:
    """A fitted potential and what its residuals say.

    Attributes
    ----------
    fit : FittedPotential
    lack : LackOfFit
    unmoved : list of int
        Joints without torque that never moved.
    """

    fit: FittedPotential
    lack: LackOfFit
    unmoved: list[int]

    @property
    def deviations(self) -> float:
        """Standard errors that bounds allow for."""
        return quantile(BOUND_DEVIATIONS, self.fit.freedom)

    @property
    def obstacle(self) -> str:
        """What stands in the way of claims where the form of rigid gravity does not fit."""
        return f"an arm whose torque is rigid gravity and constants: there is {self.lack.said}"


def examined_fit(q: Array, tau: Array, noise: MeasurementNoise | None) -> ExaminedFit:
    """Fit a potential and constants to the poses of a recording, and look at the residuals.

    Parameters
    ----------
    q, tau : (N, n) arrays
        Rows [rad], [N m]; those of one pose count as one sample.
    noise : MeasurementNoise or None
        Noise levels where known.

    Raises
    ------
    Undetermined
        If the poses do not determine the potential, or not whether a joint matters; and if they
        are too few to bound every kind of torque beside gravity. Then only samples that are
        explained to rounding say that there is none: errors of anything else look like noise.
    """
    poses, q, torques = by_pose(q, tau)
    fit, unmoved = fit_on_active_joints(q, torques, noise, LARGEST_ERROR)
    deviations = quantile(BOUND_DEVIATIONS, fit.freedom)
    lack = lack_of_fit(fit, poses=poses, rows=tau, deviations=deviations)
    if len(lack.alternatives) < KINDS and not _explained(fit, torques):
        least = samples_for_alternatives(fit)
        raise Undetermined(
            f"{least - fit.samples} more samples: {fit.samples} different ones were given, which "
            f"rigid gravity and constants do not explain exactly; {least} show how large a spring "
            "or a cable may be"
        )
    carrying = fit.frequencies.any(axis=0)
    silent = np.where(carrying, 0.0, np.abs(torques).max(axis=0))
    return ExaminedFit(fit, replace(lack, silent=silent), unmoved)


def _explained(fit: FittedPotential, tau: Array) -> bool:
    """Whether a fit leaves nothing but rounding of the torques."""
    left = np.abs(fit.whitened.torques(fit.whitened.residual)).max()
    return bool(left <= EXACT * np.abs(tau).max())
