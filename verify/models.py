"""Judge of learned inverse statics models."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from symbolic.errors import InputError
from symbolic.gravity import GravityModel
from symbolic.joint_limits import finite_limits
from symbolic.relations import SymmetryGroup
from verify.counterexamples import largest_value
from verify.model_probes import equivariance_error, moved_to_limits, periodicity_error
from verify.stability import has_stable_image, is_stable
from verify.targets import TargetSet, dense_targets
from verify.verdict import Status, Verdict

Array = NDArray[np.float64]
Predict = Callable[[Array], ArrayLike]


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
        Root of the mean, over configurations and active joints, of squared torque errors [N m].
    rmse_by_joint : (n,) array
        The same joint by joint [N m].
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
    held: int | None = None
    stable: int | None = None


@dataclass(frozen=True, eq=False)
class ModelJudgement:
    """What a learned model is worth.

    Attributes
    ----------
    targets : tuple of TargetResult
        The dense set first; where they were asked for and both exist, its parts whose orbits
        have a stable member and have none; then the sets that were given.
    largest_error : (n,) array
        Torque errors at ``worst_configuration`` [N m].
    worst_configuration : (n,) array
        Where a search found the largest error [rad].
    equivariance_error : float or None
        Largest |predict(A q + d) - Y predict(q)| over the dense set and the group [N m].
    verdicts : tuple of Verdict
        The claims that follow from a tolerance.
    periodicity_error : float
        Largest |predict(q + 2 pi k) - predict(q)| over the dense set, k in {-1, 0, 1} [N m].
    at_limits : TargetResult or None
        Error where one joint is at a limit; None where no joint has limits within a turn.
    """

    targets: tuple[TargetResult, ...]
    largest_error: Array
    worst_configuration: Array
    equivariance_error: float | None
    verdicts: tuple[Verdict, ...]
    periodicity_error: float = 0.0
    at_limits: TargetResult | None = None

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
    tolerance: float | None = None,
    largest_tolerance: float | None = None,
    equivariance_tolerance: float | None = None,
    periodicity_tolerance: float | None = None,
) -> ModelJudgement:
    """Judge a learned model against the true gravity torque.

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
        an arm can learn by itself, and have none.
    targets
        More sets of configurations to give the error on.
    tolerance
        Torque RMSE on the dense set that is accepted [N m]; None to claim nothing.
    largest_tolerance
        Largest torque error that is accepted [N m]; None to claim nothing.
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
        If predictions have a wrong shape or are not finite.

    Notes
    -----
    The largest error is found by a search (random starts and the dense set's worst, then
    climbing): it is a lower bound of the supremum, hence ``tested`` and never ``bounded``. Joints
    that feel no gravity (``gravity.free_joints``) do not count in the RMSE over all joints.

    Examples
    --------
    >>> from symbolic.robots import load_robot
    >>> gravity = GravityModel(load_robot("2r"))
    >>> judgement = verify_model(lambda q: gravity.torque(q) + 0.01, gravity, tolerance=0.02)
    >>> print(judgement.verdicts[0])
    tested: torque RMSE on the dense set of 2048 is at most 0.02 Nm (worst error 0.01)
    """
    n = gravity.n
    predict = _checked(model.predict if hasattr(model, "predict") else model, n)
    everywhere = np.tile([-np.pi, np.pi], (n, 1))
    box = everywhere if limits is None else finite_limits(limits)
    active = np.array([name not in gravity.free_joints for name in gravity.joint_names])
    dense = dense_targets(box)

    def errors(q: Array) -> Array:
        return np.asarray(predict(q) - gravity.torque(q))

    sets = (dense, *_by_stability(dense, gravity, orbits), *targets)
    results = tuple(
        _on(chosen, errors, active, int(is_stable(chosen.q, gravity).sum())) for chosen in sets
    )

    def size(q: Array) -> Array:
        return np.abs(errors(q)[:, active]).max(axis=1, initial=0.0)

    # the dense set covers one turn at most, so it lies within the limits
    _, worst = largest_value(size, n, limits=box, starts=dense.q)
    broken = None if group is None else equivariance_error(predict, group, dense.q, active)
    turned = periodicity_error(predict, dense.q, active)
    at_limits = moved_to_limits(dense, box)
    verdicts = _verdicts(
        results[0], size, worst, broken, tolerance, largest_tolerance, equivariance_tolerance
    )
    if periodicity_tolerance is not None:
        claim = f"whole turns change no torque by more than {periodicity_tolerance:g} Nm"
        fails = turned[0] > periodicity_tolerance
        status = Status.REFUTED if fails else Status.TESTED
        verdicts += (Verdict(claim, status, turned[0], turned[1] if fails else None),)
    return ModelJudgement(
        targets=results,
        largest_error=np.abs(errors(worst[None, :])[0]),
        worst_configuration=worst,
        equivariance_error=None if broken is None else broken[0],
        verdicts=verdicts,
        periodicity_error=turned[0],
        at_limits=None
        if at_limits is None
        else _on(at_limits, errors, active, int(is_stable(at_limits.q, gravity).sum())),
    )


def torque_rmse(errors: ArrayLike, active: ArrayLike | None = None) -> float:
    """Return the root of the mean over samples and active joints of squared errors.

    Parameters
    ----------
    errors
        Torque errors (m, n) [N m].
    active
        Which joints count, (n,) booleans; all by default.

    Examples
    --------
    >>> round(torque_rmse([[3.0, 0.0], [4.0, 0.0]], [True, False]) ** 2, 9)
    12.5
    """
    values = np.asarray(errors, dtype=float)
    if active is not None:
        values = values[:, np.asarray(active, dtype=bool)]
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0


def _checked(predict: Predict, n: int) -> Callable[[Array], Array]:
    def checked(q: Array) -> Array:
        torque = np.asarray(predict(q), dtype=float)
        if torque.shape != q.shape:
            raise InputError("model", "shape of predictions", torque.shape, f"{q.shape}")
        if not np.all(np.isfinite(torque)):
            at = q[~np.isfinite(torque).all(axis=1)][0]
            raise InputError("model", f"prediction at q = {at.tolist()}", "not finite", "torques")
        return torque

    return checked


def _by_stability(
    dense: TargetSet, gravity: GravityModel, orbits: SymmetryGroup | None
) -> tuple[TargetSet, ...]:
    if orbits is None:
        return ()
    held = has_stable_image(dense.q, gravity, orbits)
    if held.all() or not held.any():
        return ()
    words = "of it, orbits {} a stable member"
    return (
        TargetSet(words.format("with"), dense.q[held]),
        TargetSet(words.format("without"), dense.q[~held]),
    )


def _on(
    targets: TargetSet, errors: Callable[[Array], Array], active: Array, stable: int
) -> TargetResult:
    found = errors(targets.q)
    by_joint = np.sqrt(np.mean(found**2, axis=0))
    rmse = torque_rmse(found, active)
    return TargetResult(targets.name, len(targets.q), rmse, by_joint, stable=stable)


def _verdicts(
    dense: TargetResult,
    size: Callable[[Array], Array],
    worst: Array,
    broken: tuple[float, Array] | None,
    tolerance: float | None,
    largest_tolerance: float | None,
    equivariance_tolerance: float | None,
) -> tuple[Verdict, ...]:
    verdicts = []
    if tolerance is not None:
        claim = f"torque RMSE on the {dense.name} is at most {tolerance:g} Nm"
        status = Status.TESTED if dense.rmse <= tolerance else Status.REFUTED
        verdicts.append(Verdict(claim, status, dense.rmse))
    if largest_tolerance is not None:
        claim = f"no torque is wrong by more than {largest_tolerance:g} Nm"
        largest = float(size(worst[None, :])[0])
        fails = largest > largest_tolerance
        status = Status.REFUTED if fails else Status.TESTED
        verdicts.append(Verdict(claim, status, largest, worst if fails else None))
    if broken is not None and equivariance_tolerance is not None:
        claim = f"the model is equivariant within {equivariance_tolerance:g} Nm"
        fails = broken[0] > equivariance_tolerance
        status = Status.REFUTED if fails else Status.TESTED
        verdicts.append(Verdict(claim, status, broken[0], broken[1] if fails else None))
    return tuple(verdicts)
