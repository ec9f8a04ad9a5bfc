"""The rigid chain as a learner: the whole torque map of an arm from a handful of poses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone

from isotorque.learning.learners.base import SavedLearner
from isotorque.learning.learners.rigid.causes.diagnose import Diagnosis, diagnose
from isotorque.learning.learners.rigid.fitting.acceptance import EXACT, fit_chain
from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit, fit_at
from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    checked_parents,
    serial,
)
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples, noise_by_joint
from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus, NotAccepted
from isotorque.learning.learners.rigid.fitting.gains import (
    GainGroup,
    gain_groups,
    with_fixed_scales,
)
from isotorque.learning.learners.rigid.fitting.joint_columns import ColumnShape, JointColumn
from isotorque.learning.learners.rigid.planning.standard_errors import TorqueErrors
from isotorque.learning.learners.rigid.structure.beside_chain import BesideChain, beside_chain
from isotorque.learning.learners.rigid.structure.chain_symmetries import (
    DEVIATIONS,
    ChainSymmetries,
    chain_symmetries,
)
from isotorque.learning.learners.rigid.structure.snapping import LEVEL, SnappedChain, snapped
from isotorque.learning.learners.sample_checks import (
    checked_configurations,
    checked_directions,
    checked_samples,
    require,
    require_fitted,
)
from isotorque.learning.learners.torque_score import TorqueRegressor
from isotorque.learning.statistics.causes.cause import Cause
from isotorque.learning.statistics.causes.cause_words import causes_in_words
from isotorque.learning.statistics.causes.extension import Kind, Shape, Term
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]

HELD = {Kind.OFFSET, Kind.GAIN, Kind.SIGN, Kind.SPRING, Kind.FRICTION}
"""Causes that a chain can hold itself, or that are taken off its samples: friction."""
TERMS = {ColumnShape.OFFSET: Shape.CONSTANT, ColumnShape.SPRING: Shape.ANGLE}
"""Terms of causes that columns of a chain are."""
ROOM_FOR = {Kind.SPRING, Kind.CABLE}
"""Others that bounds of its relations leave room for."""
STARTS_NEAR = 20
"""Random starts, at most, where the chain is known but for what is added to it."""
ROUNDING_SHARE = 0.1
"""Standard deviation of rounding, as a share of the largest that is called so (`EXACT`), ..."""
MISFITS = 2.0
"""... or as many times what the samples show of it, if that is more."""


class RigidChain(TorqueRegressor, SavedLearner):
    """The torque of an arm of rigid links, geometry and masses unknown.

    Parameters
    ----------
    parents : sequence of int or None
        Joint that carries each joint, -1 for the base; None: joints in series. It is told
        nothing else of the robot.
    torque_noise : float or sequence of float or None
        Standard deviation of the torque error [N m], one for all joints or one each; None: not
        known, samples may be exact; 0: samples are exact.
    angle_noise : float or sequence of float
        Standard deviation of the angle error [rad].
    unknown_gains : bool
        Whether torques are measured in units that differ from joint to joint (motor currents).
    known_gains : sequence of (float or None) or None
        With unknown gains: those that are known, None for the others. One of them fixes the
        common factor of all joints that are coupled with it.
    unknown_offsets : bool or sequence of bool
        Whether torque sensors have an unknown constant error: all, or one entry per joint.
    unknown_springs : bool or sequence of bool
        Whether joints have a spring of unknown rate: all, or one entry per joint. Where it is at
        rest is an unknown constant.
    max_starts : int
        Random starts of the search at most.
    window : int
        Latest samples that ``partial_fit`` keeps.
    random_state : int
        Seed of the random starts.

    Attributes
    ----------
    verdict_ : FitStatus
        Whether the chain that was found may be used. Where not, ``remark_`` says what is missing
        and ``predict`` refuses.
    chain_ : ChainParameters
        The chain.
    fit_ : ChainFit
        Everything about the fit.
    causes_ : tuple of Cause
        What it holds beside gravity because the samples show it (`with_causes`).
    friction_ : (n,) array
        Torque against the direction of the last motion that the samples show [N m], where the
        directions were given. It was taken off the samples: it is no static torque.
    gain_groups_ : tuple of GainGroup
        Joints whose gains are known relative to each other.

    Notes
    -----
    At most 4 n - 1 numbers describe the statics of n joints in series, and each pose gives n
    equations: four to eight poses determine the torque everywhere, whatever n, the kinematics
    unknown (docs/rigid-chain.md). The model contains rigid serial statics and nothing else: no
    springs, no cables, no friction. Prefer it to ``EquivariantTrigonometric`` wherever links are
    rigid. It needs no symmetries: it implies them.

    Examples
    --------
    >>> q = np.array([[0.3, -1.0], [1.1, 0.4], [-2.0, 0.7], [0.2, 2.9]])
    >>> def torque(q):
    ...     lower = 6.13 * np.cos(q.sum(axis=1))
    ...     return np.stack([18.39 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> arm = RigidChain().fit(q, torque(q))
    >>> print(arm.verdict_)
    explains all samples to rounding
    >>> bool(np.abs(arm.predict(q + 1.0) - torque(q + 1.0)).max() < 1e-9)
    True
    >>> print(RigidChain().fit(q[:3], torque(q[:3])).remark_)
    1 more poses: 3 different ones were given, 4 are needed
    """

    _errors: TorqueErrors | None
    _snapped: tuple[float, SnappedChain] | None
    _beside: BesideChain | None
    _diagnosis: Diagnosis | None
    _sides: Array | None
    group: None = None  # symmetries follow from the chain; there is nothing to be told

    def __init__(
        self,
        parents: Sequence[int] | None = None,
        *,
        torque_noise: float | Sequence[float] | None = None,
        angle_noise: float | Sequence[float] = 0.0,
        unknown_gains: bool = False,
        known_gains: Sequence[float | None] | None = None,
        unknown_offsets: bool | Sequence[bool] = False,
        unknown_springs: bool | Sequence[bool] = False,
        max_starts: int = 300,
        window: int = 1000,
        random_state: int = 0,
    ) -> None:
        self.parents = parents
        self.torque_noise = torque_noise
        self.angle_noise = angle_noise
        self.unknown_gains = unknown_gains
        self.known_gains = known_gains
        self.unknown_offsets = unknown_offsets
        self.unknown_springs = unknown_springs
        self.max_starts = max_starts
        self.window = window
        self.random_state = random_state

    def fit(
        self, X: Any, y: Any, sample_weight: Any = None, *, directions: Any = None
    ) -> RigidChain:
        """Fit to samples, forgetting what was before.

        Parameters
        ----------
        X : (m, n) array_like
            Configurations [rad].
        y : (m, n) array_like
            Torques that hold them [N m].
        sample_weight : (m,) array_like, optional
            Weights of the squared errors.
        directions : (m, n) array_like, optional
            Signs of the last motion of every joint before the arm came to rest, 0 where not known:
            friction shows (`with_causes`).

        Returns
        -------
        RigidChain
            Itself; ``verdict_`` says whether it may be used.

        Raises
        ------
        InputError
            If a number is NaN or infinite, a parameter of the learner is unusable, or there is
            not one torque per joint.
        """
        return self._fit(X, y, sample_weight, directions, None)

    def _fit(
        self, X: Any, y: Any, sample_weight: Any, directions: Any, near: ChainParameters | None
    ) -> RigidChain:
        """Fit, from the rotations and gains of another chain first."""
        self._check_parameters()
        q, torque, weights = checked_samples(self, X, y, sample_weight, first=True)
        sides = checked_directions(directions, q.shape)
        self._start(q.shape[1], torque.shape[1], np.ndim(y) == 1)
        self._sides = None if sides is None else sides[weights > 0]
        start, model = None, self._model
        if near is not None:
            gains = np.where(model.free_gains, near.gains, model.gains)
            start = replace(model.start(near.rotations), gains=gains)
        starts = self.max_starts if near is None else min(self.max_starts, STARTS_NEAR)
        return self._learn(self._samples(q, torque, weights), start, starts)

    def partial_fit(self, X: Any, y: Any, sample_weight: Any = None) -> RigidChain:
        """Learn further samples, starting from the chain found before.

        Beyond ``window`` samples the oldest are forgotten.
        """
        if not hasattr(self, "fit_"):
            return self.fit(X, y, sample_weight)
        q, torque, weights = checked_samples(self, X, y, sample_weight, first=False)
        old, seen = self.fit_.samples, self.n_samples_seen_
        both = self._samples(
            np.concatenate([old.q, q]),
            np.concatenate([old.torque, torque]),
            np.concatenate([old.weights, weights]),
        )
        self._sides = None  # those of older samples do not fit these
        self._learn(both.part(slice(-self.window, None)), self.fit_.chain)
        self.n_samples_seen_ = seen + len(q)
        return self

    def predict(self, X: Any) -> Array:
        """Measured torques (m, n) [N m] estimated for configurations (m, n) [rad].

        Raises
        ------
        NotAccepted
            If no chain was accepted.
        """
        q = self._asked(X)
        result = self.chain_.torque(q)
        return result[:, 0] if self._flat else result

    def standard_error(self, X: Any) -> Array:
        """Standard errors of `predict`, (m, n) [N m]; inf where samples leave torques open."""
        return self.errors_.standard_error(self._asked(X))

    def jacobian(self, X: Any) -> Array:
        """Estimated stiffness d torque / d q, (m, n, n) [N m / rad]."""
        return self.chain_.stiffness(self._asked(X))

    def snapped(self, level: float = LEVEL) -> SnappedChain:
        """The chain with right angles and without levers, where samples do not contradict that.

        Parameters
        ----------
        level : float
            Level of the test of every hypothesis.
        """
        if self.chain_ is not None and (self._snapped is None or self._snapped[0] != level):
            self._snapped = (level, snapped(self.fit_, level))
        assert self._snapped is not None
        return self._snapped[1]

    def simplified(self) -> bool:
        """Take the snapped chain for the chain, if it explains exact samples to rounding as well.

        Returns
        -------
        bool
            Whether it was taken. Only where samples are explained to rounding: what poses leave
            nearly open, as where an axis is vertical and hardly moved, then has no error left.
        """
        fit = self.fit_
        if fit.verdict is not FitStatus.ROUNDING:
            return False
        samples, others = fit.samples, (fit.model, fit.asked_gains, fit.verdict, fit.starts)
        limit = EXACT * samples.largest_torque
        # equilibria end where motions are slow enough: their errors are no multiple of rounding
        size = max(ROUNDING_SHARE * limit, MISFITS * _misfit(fit.chain, samples))
        rounding = samples.with_torque_noise(np.full(samples.n, size))
        simple = snapped(fit_at(fit.chain, rounding, *others), LEVEL)
        if _misfit(simple.chain, samples) > limit:
            return False
        self._take(fit_at(simple.chain, samples, *others))
        self._snapped = (LEVEL, simple)
        return True

    def symmetries(self, tolerance: float = 0.0) -> ChainSymmetries:
        """The complete symmetry group of the snapped chain, bounded for the measured arm.

        Parameters
        ----------
        tolerance : float
            Also relations that err by no more in any torque of the snapped chain [N m].

        Examples
        --------
        >>> q = np.random.default_rng(0).uniform(-3, 3, (6, 2))
        >>> lower = 6.13 * np.cos(q.sum(axis=1))
        >>> torque = np.stack([18.39 * np.cos(q[:, 0]) + lower, lower], axis=1)
        >>> RigidChain().fit(q, torque).symmetries().group.order
        8
        """
        said = causes_in_words(self.shown_causes())
        return chain_symmetries(
            self.fit_, self.errors_, self.snapped(), self.beside(), said, tolerance
        )

    def diagnosis(self) -> Diagnosis:
        """What the samples show beside a chain: causes, named; none where it is exact.

        Raises
        ------
        NotAccepted
            If there are too few samples for one.
        """
        require_fitted(self)
        if self.fit_.verdict is not FitStatus.MISFIT:
            self._require_accepted()
        if self._diagnosis is None:
            self._diagnosis = self._diagnosed()
        return self._diagnosis

    def shown_causes(self) -> tuple[Cause, ...]:
        """Causes that the samples show beside the chain, or that make a chain of a misfit.

        Returns
        -------
        tuple of Cause
            Empty where there is no chain, and none with causes that is far better (`is_clear`).
        """
        if not self.verdict_.accepted and self.verdict_ is not FitStatus.MISFIT:
            return ()
        found = self.diagnosis()
        return found.causes if self.verdict_.accepted or found.clear else ()

    def shown_friction(self) -> Array:
        """Friction (n,) [N m] that the samples show, whatever else they show; 0 where none."""
        if self.friction_.any() or not self.shown_causes():
            return self.friction_
        selection = self.diagnosis().selection
        found = np.zeros(self.fit_.model.n)
        for term, value in (selection.fit.values if selection else {}).items():
            if term.shape is Shape.DIRECTION:
                found[term.place] = value[0]
        return found

    def with_causes(self) -> RigidChain | None:
        """The same samples with the constants, springs and gains that they show beside the chain.

        Friction that they show is taken off them (``friction_``).

        Returns
        -------
        RigidChain or None
            None where nothing is shown (`shown_causes`), a cause could be anything but a constant,
            a spring, friction or a gain, or no chain is accepted with them. ``causes_`` of the
            result are those of this one.
        """
        causes = self.shown_causes()
        kinds = {cause.kind for cause in causes}
        rivals = {kind for cause in causes for kind, _ in cause.rivals}
        if not kinds or not kinds <= HELD or not rivals <= HELD | ROOM_FOR:
            return None
        model, samples = self._model, self.fit_.samples
        free = model.free_gains.copy()
        offsets, springs = (
            {column.joint for column in model.columns if column.shape is shape}
            for shape in (ColumnShape.OFFSET, ColumnShape.SPRING)
        )
        for cause in causes:
            joints = cause.joints(model.n)
            if cause.kind in (Kind.GAIN, Kind.SIGN):
                free[joints] = True
                continue
            if cause.kind is Kind.FRICTION:
                continue
            offsets.update(joints)
            springs.update(joints if cause.kind is Kind.SPRING else ())
        again = clone(self).set_params(
            unknown_offsets=[j in offsets for j in range(model.n)],
            unknown_springs=[j in springs for j in range(model.n)],
        )
        if free.any():
            known = [None if f else float(g) for f, g in zip(free, model.gains, strict=True)]
            again.set_params(unknown_gains=True, known_gains=known)
        selection = self.diagnosis().selection
        assert selection is not None  # causes were selected
        fit, torque, friction = selection.fit, samples.torque, self.shown_friction()
        if self._sides is not None:
            torque = torque - friction * self._sides
        again._fit(samples.q, torque, samples.weights, None, fit.chain)
        again.friction_ = friction
        if not again.verdict_.accepted:
            return None
        again.causes_ = causes
        return again

    def beside(self) -> BesideChain:
        """Constants, springs and cables that the samples leave room for beside the chain.

        Raises
        ------
        NotAccepted
            If no chain was accepted.
        """
        self._require_accepted()
        if self._beside is None:
            self._beside = beside_chain(self.fit_, DEVIATIONS)
        return self._beside

    @property
    def verdict_(self) -> FitStatus:
        """Whether the chain may be used, and why."""
        require_fitted(self)
        return self.fit_.verdict

    @property
    def remark_(self) -> str:
        """What is missing or speaks against the chain; empty where it is accepted."""
        require_fitted(self)
        return self.fit_.remark

    @property
    def chain_(self) -> ChainParameters:
        """The chain that was found.

        Raises
        ------
        NotAccepted
            If it was not.
        """
        self._require_accepted()
        return self.fit_.chain

    @property
    def errors_(self) -> TorqueErrors:
        """Standard errors; repeated experiments are kept from one call to the next."""
        require_fitted(self)
        if self._errors is None:
            self._errors = TorqueErrors(self.fit_, self.random_state)
        return self._errors

    @property
    def seen_range_(self) -> tuple[Array, Array]:
        """Lowest and highest angle of every joint among the samples, (n,) each [rad]."""
        require_fitted(self)
        return self.fit_.samples.q.min(axis=0), self.fit_.samples.q.max(axis=0)

    def _diagnosed(self) -> Diagnosis:
        fit = self.fit_
        samples = fit.samples
        if fit.verdict is FitStatus.ROUNDING:
            return Diagnosis((), True, False, samples.torque_noise, None)
        offsets = [Term(TERMS[column.shape], column.joint) for column in fit.model.columns]
        gains = [Term(Shape.GAIN, int(j)) for j in np.flatnonzero(fit.model.free_gains)]
        return diagnose(
            samples.q,
            samples.torque,
            directions=self._sides,
            weight=samples.weights,
            torque_noise=self.torque_noise,
            angle_noise=self.angle_noise,
            parents=self.parents,
            gains=fit.model.gains,
            known=[fit.chain],
            included=[*offsets, *gains],
            random_state=self.random_state,
        )

    def _require_accepted(self) -> None:
        require_fitted(self)
        if not self.fit_.verdict.accepted:
            raise NotAccepted(self.fit_.verdict, self.fit_.remark)

    def _asked(self, X: Any) -> Array:
        require_fitted(self)
        return checked_configurations(self, X, first=False)

    def _samples(self, q: Array, torque: Array, weights: Array) -> ChainSamples:
        n, used = q.shape[1], weights > 0
        stated = 0.0 if self.torque_noise is None else self.torque_noise
        return ChainSamples(
            q[used],
            torque[used],
            noise_by_joint("RigidChain", "torque_noise", stated, n),
            noise_by_joint("RigidChain", "angle_noise", self.angle_noise, n),
            weights[used],
        )

    def _learn(
        self, samples: ChainSamples, warm: ChainParameters | None, starts: int | None = None
    ) -> RigidChain:
        if not len(samples.q):
            raise InputError("sample_weight", "every weight", "zero", "at least one number > 0")
        fit = fit_chain(
            samples,
            self._model,
            np.random.default_rng(self.random_state),
            noise_known=self.torque_noise is not None,
            starts=self.max_starts if starts is None else starts,
            warm=warm,
        )
        self.gain_groups_: tuple[GainGroup, ...] = ()
        if fit.verdict.accepted:
            self.gain_groups_ = gain_groups(fit)
            fit = with_fixed_scales(fit, self.gain_groups_)
        self._take(fit)
        self.n_samples_seen_ = len(samples.q)
        return self

    def _take(self, fit: ChainFit) -> None:
        self.fit_, self._errors, self._snapped = fit, None, None
        self.friction_ = np.zeros(fit.model.n)
        self.causes_: tuple[Cause, ...] = ()
        self._beside, self._diagnosis = None, None

    def parameters(self) -> dict[str, Any]:
        """Settings and counters as plain numbers (JSON)."""
        found = super().parameters()
        settings = found["settings"].items()
        plain = {k: v if v is None or np.isscalar(v) else list(v) for k, v in settings}
        return {"settings": plain, "state": found["state"]}

    def _counters(self) -> dict[str, Any]:
        fit = self.fit_
        return {
            "verdict": fit.verdict.name,
            "starts": fit.starts,
            "p_value": None if np.isnan(fit.p_value) else fit.p_value,
            "held_out": None if np.isnan(fit.held_out) else fit.held_out,
            "causes": [cause.as_json() for cause in self.causes_],
            "groups": [[list(g.joints), g.scale_known] for g in self.gain_groups_],
        }

    def _arrays(self) -> dict[str, NDArray]:
        chain, samples = self.chain_, self.fit_.samples
        return {
            **chain.to_arrays(),
            "q": samples.q,
            "torque": samples.torque,
            "torque_errors": samples.torque_noise,
            "weights": samples.weights,
            "free_gains": self.fit_.model.free_gains,
            "friction": self.friction_,
        }

    def _restore(self, arrays: dict[str, NDArray], state: Mapping[str, Any]) -> None:
        chain = ChainParameters.from_arrays(arrays)
        samples = self._samples(arrays["q"], arrays["torque"], arrays["weights"])
        samples = samples.with_torque_noise(arrays["torque_errors"])
        free = arrays["free_gains"] > 0.5
        model = replace(self._model, free_gains=free, gains=chain.gains)
        more = {
            k: float("nan") if state[k] is None else float(state[k])
            for k in ("p_value", "held_out")
        }
        verdict = FitStatus[state["verdict"]]
        self._take(
            fit_at(
                chain, samples, model, self._model.free_gains, verdict, int(state["starts"]), **more
            )
        )
        self.friction_ = arrays.get("friction", self.friction_)
        self.gain_groups_ = tuple(GainGroup(tuple(j), bool(k)) for j, k in state["groups"])
        self.causes_ = tuple(Cause.from_json(found) for found in state.get("causes", ()))

    def _check_parameters(self) -> None:
        starts, window = self.max_starts, self.window
        require(self, "max_starts", starts == int(starts) and starts >= 1, "a whole number >= 1")
        require(self, "window", window == int(window) and window >= 1, "a whole number >= 1")
        alone = self.known_gains is None or self.unknown_gains
        require(self, "known_gains", alone, "None unless unknown_gains is True")

    def _start(self, joints: int, outputs: int, flat: bool) -> None:
        """Empty state for ``joints`` inputs and ``outputs`` outputs."""
        if outputs != joints:
            raise InputError("y", "number of columns", outputs, f"{joints}, one torque per joint")
        parents = serial(joints) if self.parents is None else checked_parents(self.parents, joints)
        known: Sequence[float | None] = [None] * joints
        if self.known_gains is not None:
            known = self.known_gains
            good = len(known) == joints and all(
                k is None or (np.isfinite(k) and k != 0) for k in known
            )
            require(self, "known_gains", good, f"{joints} numbers other than 0, or None")
        columns: list[JointColumn] = []
        for name, shape in (
            ("unknown_offsets", ColumnShape.OFFSET),
            ("unknown_springs", ColumnShape.SPRING),
        ):
            stated = getattr(self, name)
            one = isinstance(stated, bool | np.bool_)
            wanted = [stated] * joints if one else list(stated) if np.ndim(stated) == 1 else []
            require(self, name, len(wanted) == joints, f"True, False, or {joints} of them")
            columns += [JointColumn(j, shape) for j in range(joints) if wanted[j]]
        self._model = ChainModel(
            parents,
            np.array([1.0 if k is None else k for k in known], dtype=float),
            np.array([self.unknown_gains and k is None for k in known], dtype=bool),
            tuple(columns),
        )
        self._flat = flat
        self._sides = None
        self.n_outputs_ = outputs
        self.n_samples_seen_ = 0


def _misfit(chain: ChainParameters, samples: ChainSamples) -> float:
    """Root mean square of what a chain leaves of the torques [N m]."""
    return float(np.sqrt(np.mean((chain.torque(samples.q) - samples.torque) ** 2)))
