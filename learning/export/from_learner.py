"""The torque form of every learner."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.canonical_copy import CanonicalCopy
from isotorque.learning.export.forms.chain_recursion import ChainRecursion
from isotorque.learning.export.forms.chain_with_kernels import ChainWithKernels
from isotorque.learning.export.forms.kernels import Kernels
from isotorque.learning.export.forms.local_functions import LocalFunctions
from isotorque.learning.export.forms.symmetric_copies import Copies
from isotorque.learning.export.forms.tanh_units import TanhUnits
from isotorque.learning.export.forms.torque_form import TorqueForm
from isotorque.learning.export.forms.waves import Waves
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.gaussian_process.symmetric_kernel import distinct_rows
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from isotorque.learning.learners.memory.dictionary_learner import DictionaryLearner
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.rigid.fitting.chain_parameters import ChainParameters
from isotorque.learning.learners.rigid.fitting.joint_columns import ColumnShape
from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.learning.learners.rigid.structure.canonical_form import CanonicalForm
from isotorque.learning.learners.sample_checks import require_fitted
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]
MOST_JOINTS = 10  # 3^n torques make the waves of a static regressor


def torque_form(learner: Any) -> TorqueForm:
    """Write what a learner predicts as constant tables and one formula.

    Parameters
    ----------
    learner
        A fitted learner of this package. Of a `DictionaryLearner` the regressor in it counts.

    Returns
    -------
    TorqueForm
        `Waves`, `TanhUnits`, `Kernels`, `LocalFunctions` or `ChainRecursion`.

    Raises
    ------
    InputError
        If it is of another kind or not fitted, or if a static regressor has more than 10 joints.

    Examples
    --------
    >>> from isotorque.learning.export.forms.torque_form import evaluate
    >>> q = np.linspace(-3.0, 3.0, 9)[:, None]
    >>> pendulum = EquivariantTrigonometric().fit(q, 5.0 * np.cos(q))
    >>> form = torque_form(pendulum)
    >>> bool(np.abs(evaluate(form, q) - 5.0 * np.cos(q)).max() < 1e-12)
    True
    """
    for kind, convert in CONVERSIONS.items():
        if isinstance(learner, kind):
            require_fitted(learner)
            return convert(learner)
    accepted = ", ".join(kind.__name__ for kind in CONVERSIONS)
    raise InputError("export", "learner", type(learner).__name__, f"one of {accepted}")


def _trigonometric(learner: EquivariantTrigonometric) -> Waves:
    arrays = learner.to_arrays()
    a, b = np.split(arrays["coefficients"], 2)
    if learner.potential:
        waves = Waves.of_potential(arrays["frequencies"], a[:, 0], b[:, 0])
        return waves.with_constants(arrays["offsets"])
    return Waves(np.rint(arrays["frequencies"]).astype(np.int64), a, b).without_rounding()


def _static_regressor(learner: StaticRegressor) -> Waves:
    n = learner.n_features_in_
    if n > MOST_JOINTS:
        raise InputError("export", "number of joints", n, f"at most {MOST_JOINTS}")
    angles = np.meshgrid(*[2 * np.pi / 3 * np.arange(3)] * n, indexing="ij")
    q = np.stack(angles, axis=-1).reshape(-1, n)
    beside = learner.beside_
    gravity = beside.gains * learner.gravity(q)
    waves = Waves.of_samples_on_grid(gravity.reshape(*[3] * n, n))
    constant, springs, *twice = beside.coefficients.T
    return waves.with_constants(constant).with_own_angles(np.stack(twice, axis=1), springs)


def _network(learner: FeedForwardNetwork) -> TanhUnits:
    arrays, group = learner.to_arrays(), learner._coordinates
    periodic = learner.inputs == "sincos"
    outputs = learner.n_outputs_
    copies: Copies | CanonicalCopy
    if learner.symmetries == "canonical" and learner.group is not None:
        assert learner._inputs.canonical is not None
        copies = CanonicalCopy.of_domain(learner._inputs.canonical.domain)
    elif learner.symmetries == "averaged":
        copies = Copies.of_group(group, outputs, wrapped=not periodic)
    else:
        copies = Copies.plain(group.basis, outputs, wrapped=not periodic)
    hidden, output = learner._layer.split(arrays["weights"])
    return TanhUnits(copies, periodic, hidden, output * arrays["scale"][:, None])


def _gaussian_process(learner: SymmetricGaussianProcess) -> Kernels | Waves:
    arrays, group = learner.to_arrays(), learner._coordinates
    outputs, scale = range(learner.n_outputs_), arrays["scale"]
    waves = _waves_of_means(learner, scale)
    sums = [learner.covariance_sum(j) for j in outputs]
    # a joint whose torque is always zero needs neither
    alive = np.array([learner.waves_[j] is None and sums[j][0].any() for j in outputs], dtype=bool)
    if not alive.any():
        return waves
    rows, shares = distinct_rows(group.A_sat)
    radii = np.sqrt(shares)
    phase = arrays["q"] @ group.basis.T @ rows.T
    centres = np.concatenate([radii * np.cos(phase), radii * np.sin(phase)], axis=1)
    return Kernels(
        Copies.of_group(group, learner.n_outputs_),
        rows,
        radii,
        centres,
        np.where(alive, np.array([weights for weights, _ in sums]).T * scale, 0.0),
        np.array([length for _, length in sums]),
        waves,
    )


def _waves_of_means(learner: SymmetricGaussianProcess, scale: Array) -> Waves:
    """The joints whose means are waves, on the frequencies of all of them."""
    means = [(j, found) for j, found in enumerate(learner.waves_) if found is not None]
    none = np.zeros((0, learner.n_features_in_), dtype=np.int64)
    rows = np.concatenate([none, *(found.frequencies for _, found in means)])
    joint = np.repeat([j for j, _ in means], [len(found) for _, found in means]).astype(int)
    k, member = np.unique(rows, axis=0, return_inverse=True)
    cos, sin = np.zeros((2, len(k), learner.n_outputs_))
    for table, parts in ((cos, [f.cos for _, f in means]), (sin, [f.sin for _, f in means])):
        table[member.ravel(), joint] = np.concatenate([[], *parts]) * scale[joint]
    return Waves(k, cos, sin).without_rounding()


def _local_linear_map(learner: LocalLinearMap) -> LocalFunctions:
    group = learner._coordinates
    kernel = learner.kernel_width * learner.radius
    return LocalFunctions.around(
        Copies.plain(group.basis, learner.n_outputs_, wrapped=True),
        learner.prototypes_,
        group.isometry,
        np.concatenate([learner.offsets_[:, :, None], learner.slopes_], axis=2),
        float(learner.radius),
        float(kernel),
        float(learner.cutoff * kernel),
        bool(learner._grid.start.size),
    )


def _recursive_least_squares(learner: RecursiveLeastSquares) -> LocalFunctions:
    group = learner._coordinates
    values = np.empty((learner.n_prototypes_, learner.n_outputs_, 1 + group.rank))
    for joints, solution in zip(learner._classes, learner._solve(), strict=True):
        shape = (len(values), values.shape[2], len(joints))
        values[:, joints] = solution.reshape(shape).transpose(0, 2, 1)
    kernel = learner.kernel_width * learner.radius
    return LocalFunctions.around(
        Copies.of_group(group, learner.n_outputs_, wrapped=True),
        learner.prototypes_,
        group.isometry,
        values,
        float(learner.radius),
        float(kernel),
        float(learner.cutoff * kernel),
        bool(learner._grid.start.size),
    )


def _rigid_chain(learner: RigidChain) -> ChainRecursion | ChainWithKernels:
    chain = learner.chain_
    if not chain.coefficient(ColumnShape.SPRING).any():
        return _recursion(chain)
    return _with_kernels([chain], np.zeros((0, chain.n)), [])


def _recursion(chain: ChainParameters) -> ChainRecursion:
    form = CanonicalForm.of(chain)
    return ChainRecursion.of(
        chain.parents,
        form.offsets,
        form.twists,
        form.levers,
        chain.gains,
        chain.coefficient(ColumnShape.OFFSET),
    )


def _rigid_chain_process(learner: RigidChainProcess) -> ChainWithKernels:
    models = learner.accepted_models
    tables = [model.kernel_tables() for model in models if model.processes]
    chains = [model.chain for model in models]
    q = models[0].processes[0].q if tables else np.zeros((0, chains[0].n))
    return _with_kernels(chains, q, tables)


def _with_kernels(
    chains: Sequence[ChainParameters], q: Array, tables: Sequence[tuple[Array, ...]]
) -> ChainWithKernels:
    springs, sines, cosines = (
        np.mean([chain.coefficient(shape) for chain in chains], axis=0)
        for shape in (ColumnShape.SPRING, ColumnShape.SINE, ColumnShape.COSINE)
    )
    n = chains[0].n
    empty = (np.zeros((0, n)), np.zeros((0, n, n)), np.zeros((0, 0, n)), np.zeros((0, 0, n)))
    stacked = [np.stack(part) for part in zip(*tables, strict=True)] if tables else empty
    own_rates, rates, own_weights, weights = stacked
    return ChainWithKernels(
        tuple(_recursion(chain) for chain in chains),
        springs,
        sines,
        cosines,
        q,
        own_rates,
        rates,
        own_weights / len(chains),
        weights / len(chains),
    )


def _dictionary(learner: DictionaryLearner) -> TorqueForm:
    learner.predict(np.zeros((1, learner.n_features_in_)))  # fits anew where samples have come
    return torque_form(learner.regressor_)


CONVERSIONS: dict[type, Any] = {
    EquivariantTrigonometric: _trigonometric,
    StaticRegressor: _static_regressor,
    FeedForwardNetwork: _network,
    SymmetricGaussianProcess: _gaussian_process,
    LocalLinearMap: _local_linear_map,
    RecursiveLeastSquares: _recursive_least_squares,
    RigidChain: _rigid_chain,
    RigidChainProcess: _rigid_chain_process,
    DictionaryLearner: _dictionary,
}
"""Learners that can be exported."""
