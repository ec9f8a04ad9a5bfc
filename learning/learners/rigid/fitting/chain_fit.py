"""A chain fitted to static samples, accepted or not."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.fitting.joint_columns import ColumnShape
from isotorque.learning.learners.rigid.planning.information import Information

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ChainFit:
    """Result of a search for a chain.

    Attributes
    ----------
    verdict : FitStatus
        Whether the chain may be used, and why.
    chain : ChainParameters
        The best chain found. Where the verdict is not an acceptance it must not be used.
    samples : ChainSamples
        What it was fitted to, with the noise levels that were stated or estimated.
    model : ChainModel
        What was free.
    asked_gains : (n,) bool array
        Which gains are unknown; those of joints without torque stay what they were.
    cost : float
        Sum of squares of whitened torque errors.
    information : Information
        What the samples tell about the parameters.
    starts : int
        Random starts, the one that was given not counted.
    remark : str
        What is missing, or what speaks against the chain; empty where it is accepted.
    p_value : float
        Of the misfit where noise was stated, NaN otherwise.
    held_out : float
        RMS torque error at poses left out [N m] where noise was estimated, NaN otherwise.
    missing : int
        Poses that are missing at least, where that can be counted.
    """

    verdict: FitStatus
    chain: ChainParameters
    samples: ChainSamples
    model: ChainModel
    asked_gains: NDArray[np.bool_]
    cost: float
    whitening: Array = field(repr=False)
    information: Information = field(repr=False)
    starts: int
    remark: str = ""
    p_value: float = float("nan")
    held_out: float = float("nan")
    missing: int = 0

    @property
    def degrees(self) -> int:
        """Measured torques minus parameters that they determine."""
        return self.samples.equations - self.information.rank

    @property
    def spread(self) -> float:
        """Factor from stated or estimated noise to what the errors are known to be.

        1 where noise was stated. Where it was estimated, three standard errors are made to mean
        what they mean for a normal variable (Student's quantile, degrees of freedom per joint).
        For exact samples whatever rounding there is.
        """
        if self.verdict is FitStatus.ROUNDING:
            return max(1e-4, float(np.sqrt(self.cost / max(self.degrees, 1))))
        if self.verdict is FitStatus.HELD_OUT:
            freedom = max(self.degrees / self.model.n, 1.0)
            return float(stats.t.isf(stats.norm.sf(3.0), freedom)) / 3.0
        return 1.0

    @property
    def offset_errors(self) -> Array:
        """Standard errors of the offsets (n,) [N m]; 0 where none was asked for."""
        result = np.zeros(self.model.n)
        columns = self.model.columns
        count = len(self.information.scale)
        rows = np.eye(count)[count - len(columns) :]
        spread = self.spread * np.sqrt(self.information.variance(rows))
        for column, error in zip(columns, spread, strict=True):
            if column.shape is ColumnShape.OFFSET:
                result[column.joint] = error
        return result

    def standard_error(self, q: Array) -> Array:
        """Of the torques at q (m, n) [rad], (m, n) [N m]; inf where they are not determined."""
        return self.spread * self.information.standard_error(self.chain, np.atleast_2d(q))


def fit_at(
    chain: ChainParameters,
    samples: ChainSamples,
    model: ChainModel,
    asked_gains: NDArray[np.bool_],
    verdict: FitStatus,
    starts: int,
    **more: Any,
) -> ChainFit:
    """What is known of a chain that was found; see `ChainFit` for the arguments."""
    whitening = samples.whitening(chain)
    rest = np.einsum("kij,kj->ki", whitening, samples.torque - chain.torque(samples.q))
    return ChainFit(
        verdict,
        chain,
        samples,
        model,
        asked_gains,
        float(np.sum(rest**2)),
        whitening,
        Information.of(chain, samples.q, whitening, model.free),
        starts,
        **more,
    )
