"""Judge of learned inverse statics models."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.joint_limits import finite_limits
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.verify.models.largest_errors import largest_by_joint, require_gravity
from isotorque.verify.models.probes import equivariance_error, moved_to_limits, periodicity_error
from isotorque.verify.models.stability import has_stable_image, is_stable
from isotorque.verify.models.target_sets import TargetSet, dense_targets
from isotorque.verify.verdict import Status, Verdict, sizes

Array = NDArray[np.float64]
Predict = Callable[[Array], ArrayLike]

STABLE_PART = "of it, orbits with a stable member"
UNSTABLE_PART = "of it, orbits without a stable member"
"""Names of the parts of the dense set."""


@dataclass(frozen=True, eq=False)
class TargetResult:
    """Torque error of a model on one set of configurations.

    Attributes
    ----------
    name : str
        The set.
    count : int
        Number of configurations in it.
    rmse : float
        Torque RMSE over configurations and joints, see `torque_rmse` [N m].
    rmse_by_joint, largest_by_joint : (n,) arrays
        Root mean square and largest absolute error joint by joint [N m]; where the set stands for
        a region (the dense set and its parts), the largest found by a search of that region.
    held : int or None
        How many of them the arm kept when it was placed there and given the learned torque; None
        where that was not tried.
    stable : int or None
        How many of them are stable equilibria (and can be held without control).
    """

    name: str
    count: int
    rmse: float
    rmse_by_joint: Array
    largest_by_joint: Array
    held: int | None = None
    stable: int | None = None

    @property
    def largest(self) -> float:
        """Largest torque error of all joints [N m]."""
        return float(self.largest_by_joint.max(initial=0.0))

    @property
    def is_stable_part(self) -> bool:
        """Whether it is the part of the dense set whose orbits have a stable member."""
        return self.name == STABLE_PART

    def holds(self, tolerance: Array) -> bool:
        """Whether RMSE and largest error of every joint are at most a tolerance (n,) [N m]."""
        fits = (self.rmse_by_joint <= tolerance) & (self.largest_by_joint <= tolerance)
        return bool(np.all(fits))


@dataclass(frozen=True, eq=False)
class ModelJudgement:
    """Judgement of a learned model.

    Attributes
    ----------
    targets : tuple of TargetResult
        The dense set first, which stands for the whole space; where they were asked for and both
        exist, its parts whose orbits have a stable member and have none; then the sets that were
        given.
    largest_error : (n,) array
        Largest torque error of each joint that a search of the whole space found [N m].
    worst_configuration : (n,) array
        Where the largest of them was found [rad].
    equivariance_error : float or None
        Largest |predict(A q + d) - Y predict(q)| over the dense set and the group [N m].
    verdicts : tuple of Verdict
        The claims that follow from a tolerance.
    periodicity_error : float
        Largest |predict(q + 2 pi k) - predict(q)| over the dense set, k in {-1, 0, 1} [N m].
    at_limits : TargetResult or None
        Error where one joint is at a limit; None where no joint has limits within a turn.
    tolerance : (n,) array or None
        Error of each joint that was claimed not to be exceeded [N m].
    """

    targets: tuple[TargetResult, ...]
    largest_error: Array
    worst_configuration: Array
    equivariance_error: float | None
    verdicts: tuple[Verdict, ...]
    periodicity_error: float = 0.0
    at_limits: TargetResult | None = None
    tolerance: Array | None = None

    @property
    def rmse(self) -> float:
        """Torque RMSE on the dense set [N m]."""
        return self.targets[0].rmse

    @property
    def rmse_by_joint(self) -> Array:
        """Torque RMSE on the dense set per joint [N m]."""
        return self.targets[0].rmse_by_joint


def verify_model(
    model: Any,
    gravity: GravityModel,
    *,
    limits: ArrayLike | None = None,
    group: SymmetryGroup | None = None,
    orbits: SymmetryGroup | None = None,
    targets: Sequence[TargetSet] = (),
    tolerance: ArrayLike | None = None,
    largest_tolerance: ArrayLike | None = None,
    equivariance_tolerance: float | None = None,
    periodicity_tolerance: float | None = None,
) -> ModelJudgement:
    """Judge a learned model against the true gravity torque, at every joint.

    Parameters
    ----------
    model
        Something with ``predict(q)``, or a function: configurations (m, n) [rad] to torques
        (m, n) [N m].
    gravity
        The true gravity torque.
    limits
        Judge within these joint limits, (n, 2) [rad], infinite where a joint has none; the whole
        torus by default.
    group
        Also measure equivariance under this group.
    orbits
        The true group: also tell configurations apart whose orbits have a stable member, which
        an arm can learn by itself, and have none; claims are judged on the former and on the
        whole, each on its own.
    targets
        More sets of configurations to give the error on.
    tolerance
        Torque RMSE of every joint that is accepted [N m], one number or one per joint; None to
        claim nothing.
    largest_tolerance
        Largest torque error that is accepted likewise [N m]; None to claim nothing.
    equivariance_tolerance
        Departure from equivariance that counts as none [N m]; None to claim nothing.
    periodicity_tolerance
        Change by whole turns that counts as none [N m]; None to claim nothing.

    Returns
    -------
    ModelJudgement

    Raises
    ------
    InputError
        If predictions have a wrong shape or are not finite; for a tolerance that is negative or
        not a number; and where something is claimed of a robot that gravity does not load.

    Notes
    -----
    The largest errors are found by a search (random starts and the worst of the set, then
    climbing): lower bounds of the suprema, hence ``tested`` and never ``bounded``. Joints that
    feel no gravity are judged like the others: their torque is zero.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> gravity = GravityModel(load_robot("2r"))
    >>> judgement = verify_model(lambda q: gravity.torque(q) + 0.01, gravity, tolerance=0.02)
    >>> print(judgement.verdicts[0])
    tested: torque RMSE of each joint, dense set of 2048, is at most 0.02 Nm (RMSE 0.01, largest
    error 0.01)
    """
    n = gravity.n
    predict = checked_predictions(model.predict if hasattr(model, "predict") else model)
    everywhere = np.tile([-np.pi, np.pi], (n, 1))
    box = everywhere if limits is None else finite_limits(limits)
    active = np.array([name not in gravity.free_joints for name in gravity.joint_names])
    allowed = None if tolerance is None else _tolerances("tolerance", tolerance, n)
    largest_allowed = (
        None
        if largest_tolerance is None
        else _tolerances("largest tolerance", largest_tolerance, n)
    )
    claims = (tolerance, largest_tolerance, equivariance_tolerance, periodicity_tolerance)
    if any(claim is not None for claim in claims):
        require_gravity(gravity)
    dense = dense_targets(box)

    def errors(q: Array) -> Array:
        return np.asarray(predict(q) - gravity.torque(q))

    def measured(chosen: TargetSet) -> TargetResult:
        return _on(chosen, errors(chosen.q), active, int(is_stable(chosen.q, gravity).sum()))

    # the dense set covers one turn at most, so it lies within the limits
    largest, worst = largest_by_joint(errors, box, starts=dense.q)
    regions = [(replace(measured(dense), largest_by_joint=largest), worst)]
    for part, inside in _by_stability(dense, gravity, orbits):
        found, at = largest_by_joint(errors, box, starts=part.q, within=inside)
        regions.append((replace(measured(part), largest_by_joint=found), at))
    results = (*(result for result, _ in regions), *(measured(chosen) for chosen in targets))
    broken = None if group is None else equivariance_error(predict, group, dense.q)
    turned = periodicity_error(predict, dense.q)
    at_limits = moved_to_limits(dense, box)
    verdicts: tuple[Verdict, ...] = ()
    for result, at in (*regions[1:2], regions[0]):  # what it could learn; the whole space
        verdicts += _within(result, at, allowed, largest_allowed)
    if broken is not None and equivariance_tolerance is not None:
        claim = f"the model is equivariant within {equivariance_tolerance:g} Nm"
        verdicts += (_searched(claim, broken, equivariance_tolerance),)
    if periodicity_tolerance is not None:
        claim = f"whole turns change no torque by more than {periodicity_tolerance:g} Nm"
        verdicts += (_searched(claim, turned, periodicity_tolerance),)
    return ModelJudgement(
        targets=results,
        largest_error=largest,
        worst_configuration=worst[int(np.argmax(largest))],
        equivariance_error=None if broken is None else broken[0],
        verdicts=verdicts,
        periodicity_error=turned[0],
        at_limits=None if at_limits is None else measured(at_limits),
        tolerance=allowed if allowed is not None else largest_allowed,
    )


def torque_rmse(errors: ArrayLike, active: ArrayLike | None = None) -> float:
    """Return the RMSE of torques per joint that gravity loads; errors of all joints count.

    Parameters
    ----------
    errors
        Torque errors (m, n) [N m].
    active
        Which joints gravity loads, (n,) booleans; all by default.

    Returns
    -------
    float
        Root of the mean over samples of the summed squared errors of all joints, divided by the
        number of active joints (by n where there is none). For a model that knows which torques
        are zero it is the RMSE over the others; torques made up elsewhere add to it.

    Examples
    --------
    >>> round(torque_rmse([[3.0, 0.0], [4.0, 0.0]], [True, False]) ** 2, 9)
    12.5
    >>> torque_rmse([[0.0, 5.0]], [True, False])
    5.0
    """
    values = np.asarray(errors, dtype=float)
    joints = values.shape[1] if active is None else int(np.sum(active)) or values.shape[1]
    return float(np.sqrt(np.mean(np.sum(values**2, axis=1)) / joints)) if values.size else 0.0


def checked_predictions(predict: Predict) -> Callable[[Array], Array]:
    """A model whose predictions are refused where they are no torques (m, n) or not finite."""

    def checked(q: Array) -> Array:
        torque = np.asarray(predict(q), dtype=float)
        if torque.shape != q.shape:
            raise InputError("model", "shape of predictions", torque.shape, f"{q.shape}")
        if not np.all(np.isfinite(torque)):
            at = q[~np.isfinite(torque).all(axis=1)][0]
            raise InputError("model", f"prediction at q = {at.tolist()}", "not finite", "torques")
        return torque

    return checked


def _tolerances(field: str, value: ArrayLike, n: int) -> Array:
    values = np.asarray(value, dtype=float)
    if values.shape not in ((), (n,)) or np.isnan(values).any() or np.any(values < 0):
        accepted = f"a number >= 0 [N m], or {n} of them"
        raise InputError("verify_model", field, value, accepted)
    return np.array(np.broadcast_to(values, (n,)))


def _by_stability(
    dense: TargetSet, gravity: GravityModel, orbits: SymmetryGroup | None
) -> tuple[tuple[TargetSet, Callable[[Array], NDArray[np.bool_]]], ...]:
    if orbits is None:
        return ()
    held = has_stable_image(dense.q, gravity, orbits)
    if held.all() or not held.any():
        return ()
    return (
        (
            TargetSet(STABLE_PART, dense.q[held]),
            lambda q: has_stable_image(q, gravity, orbits),
        ),
        (
            TargetSet(UNSTABLE_PART, dense.q[~held]),
            lambda q: ~has_stable_image(q, gravity, orbits),
        ),
    )


def _on(targets: TargetSet, errors: Array, active: Array, stable: int) -> TargetResult:
    by_joint = np.sqrt(np.mean(errors**2, axis=0))
    largest = np.abs(errors).max(axis=0)
    rmse = torque_rmse(errors, active)
    return TargetResult(targets.name, len(targets.q), rmse, by_joint, largest, stable=stable)


def _within(
    result: TargetResult, at: Array, allowed: Array | None, largest_allowed: Array | None
) -> tuple[Verdict, ...]:
    """Claims on RMSE and largest error of each joint, for one region."""
    name = result.name.replace("of it, ", "")
    where = "on the whole space" if name == result.name else f"on {name}"
    verdicts = []
    if allowed is not None:
        claim = f"torque RMSE of each joint, {name}, is at most {sizes(allowed)} Nm"
        fails = bool(np.any(result.rmse_by_joint > allowed))
        status = Status.REFUTED if fails else Status.TESTED
        rmse = float(result.rmse_by_joint.max())
        verdicts.append(Verdict(claim, status, result.largest, rmse=rmse))
    if largest_allowed is not None:
        claim = f"no torque is wrong by more than {sizes(largest_allowed)} Nm {where}"
        excess = result.largest_by_joint - largest_allowed
        fails = bool(np.any(excess > 0))
        status = Status.REFUTED if fails else Status.TESTED
        farthest = at[int(np.argmax(excess))] if fails else None
        verdicts.append(Verdict(claim, status, result.largest, farthest))
    return tuple(verdicts)


def _searched(claim: str, found: tuple[float, Array], allowed: float) -> Verdict:
    fails = found[0] > allowed
    status = Status.REFUTED if fails else Status.TESTED
    return Verdict(claim, status, found[0], found[1] if fails else None)
