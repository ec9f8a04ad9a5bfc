"""The rigid chain with Gaussian processes: arms with cables, springs and links that bend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.base import SavedLearner
from isotorque.learning.learners.rigid.fitting.acceptance import HELD_OUT_SHARE
from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    checked_parents,
    raw_directions,
    serial,
)
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples, noise_by_joint
from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus, NotAccepted
from isotorque.learning.learners.rigid.fitting.joint_columns import ColumnShape, columns_of
from isotorque.learning.learners.rigid.fitting.start_search import StartSearch
from isotorque.learning.learners.rigid.planning.poses_needed import most_parameters
from isotorque.learning.learners.rigid.process.correlated_fit import (
    CorrelatedSamples,
    correlated_fit,
)
from isotorque.learning.learners.rigid.process.residual_process import (
    OWN_LENGTH,
    OWN_SIZE,
    SIZE,
    ResidualProcess,
)
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.sample_checks import (
    checked_configurations,
    checked_samples,
    require,
    require_fitted,
)
from isotorque.learning.learners.torque_score import TorqueRegressor
from isotorque.learning.statistics.poses import group_poses
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.single_thread import single_thread

Array = NDArray[np.float64]

VARIANTS = (
    (ColumnShape.OFFSET,),
    (ColumnShape.OFFSET, ColumnShape.SPRING),
    (ColumnShape.OFFSET, ColumnShape.SINE, ColumnShape.COSINE),
)
"""What every joint has beside the chain, in the models whose mean is predicted."""
ROUNDS = 3
"""Processes on what the chain leaves, then the chain refitted with their covariance, so often."""
KEPT = 3
"""Minima of the search from which the refit starts."""
WEIGHTLESS = 1e-9
"""A joint whose torque is a smaller share of the largest has none (both RMS)."""
FOLDS = 10
WARM_STEPS = 10
"""Steps of a refit without a fold."""


@dataclass(frozen=True, eq=False)
class ChainWithProcesses:
    """One model: a chain, and a process of each joint's residuals.

    Attributes
    ----------
    chain : ChainParameters
    processes : tuple of ResidualProcess
        Empty where samples are explained without.
    """

    chain: ChainParameters
    processes: tuple[ResidualProcess, ...]

    def torque(self, q: Array) -> Array:
        """Measured torques at configurations (m, n) [rad], (m, n) [N m]."""
        return self.chain.torque(q) + self.beside(q)

    def beside(self, q: Array) -> Array:
        """The processes' part of it."""
        if not self.processes:
            return np.zeros(q.shape)
        return np.stack([process.mean(q) for process in self.processes], axis=1)

    def kernel_tables(self) -> tuple[Array, Array, Array, Array]:
        """The processes as sums of ``w exp(rate . (cos(q - c) - 1))`` over the samples c.

        Returns
        -------
        own_rates, rates : (n,) and (n, n) arrays
            By the own angle of each joint, and by all.
        own_weights, weights : (m, n) arrays
            [N m].
        """
        x = np.stack([process.hyperparameters for process in self.processes])
        weights = np.stack([process.weights for process in self.processes], axis=1)
        own, size = np.exp(x[:, OWN_SIZE]), np.exp(x[:, SIZE])
        rates = np.exp(-2.0 * x[:, SIZE + 1 : -1])
        return np.exp(-2.0 * x[:, OWN_LENGTH]), rates, weights * own, weights * size

    def without(self, out: NDArray[np.bool_], torque: Array) -> ChainWithProcesses:
        """The model of all samples but some, hyperparameters as they are."""
        samples = self.samples(torque).part(~out)
        free = _all_free(self.chain)
        chain, _ = correlated_fit(samples, self.chain, free, WARM_STEPS)
        return conditioned(chain, self.processes, samples.q, samples.torque)

    def samples(self, torque: Array) -> CorrelatedSamples:
        """The samples, correlated as the processes say."""
        whitening = np.stack([process.whitening for process in self.processes])
        return CorrelatedSamples(self.processes[0].q, torque, whitening)

    def variance(self, q: Array, torque: Array) -> Array:
        """Of the torques at configurations (m, n) [rad], (m, n) [N^2 m^2]; inf where open."""
        free = _all_free(self.chain)
        samples = self.samples(torque)
        information = samples.information(self.chain, free)
        directions = raw_directions(self.chain.n)
        here = self.chain.derivatives(q, directions).by_parameters()[:, :, free]
        there = self.chain.derivatives(samples.q, directions).by_parameters()[:, :, free]
        result = np.empty(q.shape)
        for j, process in enumerate(self.processes):
            # process.scale squared times the covariance, whitened on the side of the samples
            across = process.covariance(q) @ process.whitening.T * process.scale**2
            slopes = here[:, j] - across @ (process.whitening @ there[:, j])
            result[:, j] = np.maximum(process.size**2 - np.sum(across**2, axis=1), 0.0)
            result[:, j] += information.variance(slopes)
        return result


def conditioned(
    chain: ChainParameters, processes: Sequence[ResidualProcess], q: Array, torque: Array
) -> ChainWithProcesses:
    """A chain, and processes conditioned on what it leaves of samples."""
    rest = torque - chain.torque(q)
    return ChainWithProcesses(
        chain, tuple(p.conditioned_on(q, rest[:, j]) for j, p in enumerate(processes))
    )


class RigidChainProcess(TorqueRegressor, SavedLearner):
    """The torque of an arm that is nearly rigid: a rigid chain, and Gaussian processes.

    Parameters
    ----------
    parents : sequence of int or None
        Joint that carries each joint, -1 for the base; None: joints in series.
    torque_noise : float or sequence of float or None
        Standard deviation of the torque error [N m]; None: not known.
    starts : int
        Random starts of the search for each chain.
    random_state : int
        Seed of the random starts.

    Attributes
    ----------
    models_ : tuple of ChainWithProcesses
        Their mean is predicted. One without processes where a chain explains all samples to
        rounding.
    process_share_ : (n,) array
        RMS of the processes' part at the samples over the RMS of the torque, of every joint.
    held_out_ : float
        RMS torque error at poses left out of the fit [N m]; NaN where none were.
    verdict_ : FitStatus
        Whether the model may be used; where not, ``remark_`` says why and ``predict`` refuses.

    Notes
    -----
    `RigidChain` holds rigid statics and nothing else. What cables, springs and bending add is
    learned here by a process of each joint's residuals (`ResidualProcess`). A chain fitted first
    and left as it is would have absorbed part of it: it is fitted again with the covariance of the
    processes, in turn with them. The mean of three models, which differ in what a joint has beside
    the chain (a constant; a spring, too; a wave of its own angle, too), errs less than each.
    Far from samples the processes fade and the chain remains; `standard_error` says how far it can
    be trusted there. No relations are claimed: what is beside the chain has none of its symmetries.

    Examples
    --------
    A pendulum with a cable:

    >>> q = np.linspace(-3.0, 3.0, 20)[:, None]
    >>> def torque(q): return 6.0 * np.cos(q) + 0.4 * np.sin(2.0 * q)
    >>> arm = RigidChainProcess().fit(q, torque(q))
    >>> bool(np.abs(arm.predict(q + 0.1) - torque(q + 0.1)).max() < 0.02)
    True
    >>> bool(0.03 < arm.process_share_[0] < 0.12)
    True
    """

    group: None = None

    def __init__(
        self,
        parents: Sequence[int] | None = None,
        *,
        torque_noise: float | Sequence[float] | None = None,
        starts: int = 20,
        random_state: int = 0,
    ) -> None:
        self.parents = parents
        self.torque_noise = torque_noise
        self.starts = starts
        self.random_state = random_state

    @single_thread()
    def fit(self, X: Any, y: Any) -> RigidChainProcess:
        """Fit to samples, forgetting what was before.

        Parameters
        ----------
        X : (m, n) array_like
            Configurations [rad].
        y : (m, n) array_like
            Torques that hold them [N m].

        Raises
        ------
        InputError
            If a number is NaN or infinite, a parameter of the learner is unusable, or there is
            not one torque per joint.
        """
        self.models_: tuple[ChainWithProcesses, ...] = ()
        self._check_parameters()
        q, torque, _ = checked_samples(self, X, y, first=True)
        self._start(q.shape[1], torque.shape[1], np.ndim(y) == 1)
        self._q, self._torque, self.held_out_ = q, torque, float("nan")
        self.n_samples_seen_ = len(q)
        rigid = RigidChain(
            self.parents, torque_noise=self.torque_noise, random_state=self.random_state
        ).fit(q, torque)
        if rigid.verdict_ in (FitStatus.ROUNDING, FitStatus.TOO_FEW):
            if rigid.verdict_.accepted:
                self.models_ = (ChainWithProcesses(rigid.chain_, ()),)
            return self._judged(rigid.verdict_, rigid.remark_)
        poses = group_poses(q)
        model = ChainModel(self._parents, np.ones(q.shape[1]), np.zeros(q.shape[1], bool), ())
        columns = max(len(columns_of(q.shape[1], *shapes)) for shapes in VARIANTS)
        needed = -(-(most_parameters(model) + columns) // q.shape[1]) + 2
        if poses.count < needed:
            remark = (
                f"{needed - poses.count} more poses: {poses.count} different ones were given, "
                f"{needed} are needed to tell what is beside a rigid chain"
            )
            return self._judged(FitStatus.TOO_FEW, remark)
        rng = np.random.default_rng(self.random_state)
        self.models_ = tuple(self._fitted(shapes, rigid.fit_.chain, rng) for shapes in VARIANTS)
        self.held_out_ = self._held_out_error(poses.label)
        size = float(np.sqrt(np.mean(torque**2)))
        if self.held_out_ <= HELD_OUT_SHARE * size:
            return self._judged(FitStatus.HELD_OUT, "")
        remark = (
            f"chain and processes err by {self.held_out_:.3g} N m (RMS) at poses left out of the "
            f"fit, {HELD_OUT_SHARE * size:.3g} are accepted: more samples are needed, or the "
            "torque depends on more than the angles (friction)"
        )
        return self._judged(FitStatus.MISFIT, remark)

    def predict(self, X: Any) -> Array:
        """Measured torques (m, n) [N m] estimated for configurations (m, n) [rad].

        Raises
        ------
        NotAccepted
            If no model was accepted.
        """
        q = self._asked(X)
        result = self._mean(self.models_, q)
        return result[:, 0] if self._flat else result

    def standard_error(self, X: Any) -> Array:
        """Standard errors of `predict`, (m, n) [N m]; inf where samples leave torques open.

        Of the processes, of the chain as far as they allow to know it, and what the models differ.
        """
        q = self._asked(X)
        if not self.models_[0].processes:
            return np.zeros(q.shape)
        means = np.stack([model.torque(q) for model in self.models_])
        variance = np.mean([model.variance(q, self._torque) for model in self.models_], axis=0)
        return np.asarray(np.sqrt(variance + means.var(axis=0)))

    @property
    def seen_range_(self) -> tuple[Array, Array]:
        """Lowest and highest angle of every joint among the samples, (n,) each [rad]."""
        require_fitted(self)
        return self._q.min(axis=0), self._q.max(axis=0)

    @property
    def samples_(self) -> tuple[Array, Array]:
        """Configurations and torques (m, n) that it was fitted to [rad], [N m]."""
        require_fitted(self)
        return self._q, self._torque

    @property
    def accepted_models(self) -> tuple[ChainWithProcesses, ...]:
        """The models whose mean is predicted.

        Raises
        ------
        NotAccepted
            If none was accepted.
        """
        require_fitted(self)
        if not self._verdict.accepted:
            raise NotAccepted(self._verdict, self._remark)
        return self.models_

    @property
    def verdict_(self) -> FitStatus:
        """Whether the model may be used, and why."""
        require_fitted(self)
        return self._verdict

    @property
    def remark_(self) -> str:
        """What is missing or speaks against the model; empty where it is accepted."""
        require_fitted(self)
        return self._remark

    @property
    def process_share_(self) -> Array:
        """What part of the torque at the samples is the processes', (n,)."""
        require_fitted(self)
        beside = np.mean([model.beside(self._q) for model in self.models_], axis=0)
        size = np.sqrt(np.mean(self._torque**2, axis=0))
        loaded = size > WEIGHTLESS * size.max(initial=0.0)
        return np.where(loaded, np.sqrt(np.mean(beside**2, axis=0)) / np.where(loaded, size, 1), 0)

    def _asked(self, X: Any) -> Array:
        _ = self.accepted_models
        return checked_configurations(self, X, first=False)

    def _judged(self, verdict: FitStatus, remark: str) -> RigidChainProcess:
        self._verdict, self._remark = verdict, remark
        return self

    @staticmethod
    def _mean(models: Sequence[ChainWithProcesses], q: Array) -> Array:
        return np.asarray(np.mean([model.torque(q) for model in models], axis=0))

    def _fitted(
        self, shapes: Sequence[ColumnShape], rigid: ChainParameters, rng: np.random.Generator
    ) -> ChainWithProcesses:
        """Fit one of the models."""
        q, torque, n = self._q, self._torque, self._q.shape[1]
        columns = columns_of(n, *shapes)
        model = ChainModel(self._parents, np.ones(n), np.zeros(n, dtype=bool), columns)
        noise = self._noise()
        rest = torque - rigid.torque(q)
        levels = np.sqrt(np.mean(rest**2, axis=0)) + 1e-6 * np.abs(torque).max(initial=0.0)
        samples = ChainSamples(q, torque, levels, np.zeros(n), np.ones(len(q)))
        search = StartSearch(samples, model, rng, self.starts)
        search.try_start(model.start(rigid.rotations))
        while not search.exhausted:
            search.try_random()
        starts = [found.chain for found in sorted(search.found, key=lambda f: f.cost)[:KEPT]]
        free = model.free
        chain = starts[0]
        processes: tuple[ResidualProcess, ...] = ()
        for _ in range(ROUNDS):
            rest = torque - chain.torque(q)
            slopes = chain.derivatives(q, raw_directions(n)).by_parameters()[:, :, free]
            processes = tuple(
                ResidualProcess.fitted_to(
                    j,
                    q,
                    rest[:, j],
                    slopes=slopes[:, j],
                    noise=None if noise is None else float(noise[j]),
                    start=processes[j].hyperparameters if processes else None,
                )
                for j in range(n)
            )
            whitening = np.stack([process.whitening for process in processes])
            correlated = CorrelatedSamples(q, torque, whitening)
            tried = [correlated_fit(correlated, start, free) for start in (chain, *starts)]
            chain, _ = min(tried, key=lambda found: found[1])
        return conditioned(chain, processes, q, torque)

    def _noise(self) -> Array | None:
        if self.torque_noise is None:
            return None
        n = self.n_features_in_
        return noise_by_joint("RigidChainProcess", "torque_noise", self.torque_noise, n)

    def _held_out_error(self, pose: NDArray[np.int64]) -> float:
        """RMS torque error at poses left out [N m]; rows of one pose are left out together."""
        count = int(pose.max()) + 1
        folds = min(FOLDS, count)
        fold = np.random.default_rng(count).permutation(count)[pose] % folds
        total = 0.0
        for k in range(folds):
            out = fold == k
            kept = [model.without(out, self._torque) for model in self.models_]
            total += float(np.sum((self._torque[out] - self._mean(kept, self._q[out])) ** 2))
        return float(np.sqrt(total / self._torque.size))

    def parameters(self) -> dict[str, Any]:
        """Settings and counters as plain numbers (JSON)."""
        found = super().parameters()
        settings = found["settings"].items()
        plain = {k: v if v is None or np.isscalar(v) else list(v) for k, v in settings}
        return {"settings": plain, "state": found["state"]}

    def _counters(self) -> dict[str, Any]:
        return {
            "verdict": self._verdict.name,
            "remark": self._remark,
            "held_out": None if np.isnan(self.held_out_) else self.held_out_,
            "models": len(self.models_),
            "processes": bool(self.models_ and self.models_[0].processes),
        }

    def _arrays(self) -> dict[str, NDArray]:
        arrays = {"q": self._q, "torque": self._torque}
        for k, model in enumerate(self.models_):
            arrays |= {f"{name}_{k}": a for name, a in model.chain.to_arrays().items()}
            if model.processes:
                arrays[f"scale_{k}"] = np.array([p.scale for p in model.processes])
                arrays[f"hyperparameters_{k}"] = np.array(
                    [p.hyperparameters for p in model.processes]
                )
        return arrays

    def _restore(self, arrays: dict[str, NDArray], state: Mapping[str, Any]) -> None:
        self._q, self._torque = arrays["q"], arrays["torque"]
        held_out = state["held_out"]
        self.held_out_ = float("nan") if held_out is None else float(held_out)
        models = []
        for k in range(int(state["models"])):
            mine = {
                name[: -len(f"_{k}")]: a for name, a in arrays.items() if name.endswith(f"_{k}")
            }
            chain = ChainParameters.from_arrays(mine)
            model = ChainWithProcesses(chain, ())
            if state["processes"]:
                rest = self._torque - chain.torque(self._q)
                both = zip(mine["scale"], mine["hyperparameters"], strict=True)
                processes = [
                    ResidualProcess(j, self._q, rest[:, j], float(scale), x)
                    for j, (scale, x) in enumerate(both)
                ]
                model = replace(model, processes=tuple(processes))
            models.append(model)
        self.models_ = tuple(models)
        self._judged(FitStatus[state["verdict"]], str(state["remark"]))

    def _check_parameters(self) -> None:
        require(self, "starts", self.starts == int(self.starts) >= 1, "a whole number >= 1")

    def _start(self, joints: int, outputs: int, flat: bool) -> None:
        if outputs != joints:
            raise InputError("y", "number of columns", outputs, f"{joints}, one torque per joint")
        self._parents = (
            serial(joints) if self.parents is None else checked_parents(self.parents, joints)
        )
        self._flat = flat
        self.n_outputs_ = outputs
        self.n_samples_seen_ = 0


def _all_free(chain: ChainParameters) -> NDArray[np.bool_]:
    n = chain.n
    return np.concatenate(
        [np.ones(4 * n, bool), np.zeros(n, bool), np.ones(len(chain.columns), bool)]
    )
