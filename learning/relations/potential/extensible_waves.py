"""A fitted potential as a model that causes can be added to."""

from __future__ import annotations

import numpy as np

from isotorque.learning.relations.potential.errors_in_variables import (
    stiffness_matrices,
    torque_features,
)
from isotorque.learning.relations.potential.potential_fit import FittedPotential
from isotorque.learning.statistics.causes.linear_model import ADDING, KINDS, LinearModel, deviations

MOST_COLUMNS = 300
"""Beyond, only what adds to the torque is tried: five joints have 242 coefficients, six 728."""


def extensible_waves(fit: FittedPotential) -> LinearModel:
    """The potential of a fit without constants, at the samples and with the weights of the fit.

    Parameters
    ----------
    fit : FittedPotential

    Returns
    -------
    LinearModel
        Of the joints that the potential knows (``fit.whitened.joints``), in their order.

    Examples
    --------
    >>> from isotorque.learning.relations.potential.potential_fit import all_frequencies
    >>> from isotorque.learning.relations.potential.potential_fit import fit_potential
    >>> from isotorque.learning.statistics.causes.cause import causes_of
    >>> from isotorque.learning.statistics.causes.selection import selected
    >>> rng = np.random.default_rng(0)
    >>> q = rng.uniform(-3.0, 3.0, (40, 2))
    >>> lower = 6.1 * np.cos(q[:, 0] + q[:, 1])
    >>> tau = np.stack([18.4 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> tau += [0.0, 0.3] + 0.02 * rng.normal(size=tau.shape)
    >>> model = extensible_waves(fit_potential(q, tau, all_frequencies(2)))
    >>> [str(cause.kind) for cause in causes_of(selected(model, model.alone()))]
    ['offset']
    """
    samples = fit.whitened
    frequencies = fit.frequencies[:, samples.joints]
    # not the angles that the fit has corrected: it took for their errors what is to be found
    q = samples.measured_q
    own = torque_features(frequencies, q)
    noise = deviations(samples.whitening)
    known = bool(np.isinf(fit.freedom))
    model = LinearModel(
        q,
        samples.measured_torque,
        own,
        samples.whitening,
        noise,
        known,
        np.sqrt(samples.floor) * noise,
        kinds=KINDS if own.shape[2] <= MOST_COLUMNS else ADDING,
        stiffness_of=lambda x: stiffness_matrices(frequencies, x, q),
    )
    return model.reweighted(model.alone())
