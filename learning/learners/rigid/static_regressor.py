"""Parametric identification: least squares on Pinocchio's torque regressor at rest."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.linalg import lstsq

from isotorque.learning.learners.base import SavedLearner
from isotorque.learning.learners.rigid.causes.beside_gravity import (
    HELD,
    BesideGravity,
    ShownBeside,
    shown_beside,
)
from isotorque.learning.learners.sample_checks import (
    checked_configurations,
    checked_directions,
    checked_samples,
    require,
    require_fitted,
)
from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.learning.learners.torque_score import TorqueRegressor
from isotorque.learning.statistics.causes.cause import Cause
from isotorque.learning.statistics.causes.extended_fit import cause_columns
from isotorque.learning.statistics.causes.extension import Term
from isotorque.learning.statistics.noise_levels import whitening_of
from isotorque.learning.statistics.poses import by_pose_and_side
from isotorque.learning.statistics.shrinkage import shrunk_least_squares
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.load_robot import STANDARD_INPUT, Robot, load_robot

Array = NDArray[np.float64]


class StaticRegressor(TorqueRegressor, SavedLearner):
    """Masses and first moments of an arm whose kinematics is known.

    Parameters
    ----------
    robot : Robot, RobotOptions, str or None
        The arm, a built-in name or a file, with options if wanted; its masses are not looked at,
        only its kinematics and gravity. A model can be saved only if it was given as a name or
        file.
    snap : bool
        Whether rounded angles are snapped in a file that is given by its name alone.
    ridge : float
        Penalty on the squares of the parameters (mass [kg], first moments [kg m]); 0: as much as
        the residuals and the size of the torques call for, and the smallest parameters where the
        samples leave some open (most always are: only the base parameters matter for torques).
    group : SymmetryGroup or None
        Relations to exploit: every sample is fitted with all its symmetric copies, which settles
        parameters that the samples leave open. Needed rarely.

    Attributes
    ----------
    parameters_ : (4 n,) array
        For every joint's body: mass [kg] and mass times centre of mass in the joint's frame
        [kg m]. Physical only as far as identifiable.
    beside_ : BesideGravity
        Gains, constants, springs and cables of the joints that the samples show beside gravity;
        ``predict`` contains them. Friction that they show is no static torque: it is not in it.
    causes_ : tuple of Cause
        The same by name, and causes that are no part of the model (angle scale, compliance, a
        change of payload: the model is of the arm before it).
    offsets_ : (n,) array
        Constants among them [N m]; 0 where the samples show none.
    levels_ : (n,) array
        Standard deviation of the torque errors of every joint relative to the others.
    rank_ : int
        Number of combinations of parameters that the samples determine.

    Notes
    -----
    What a user with a URDF whose inertias are not trusted would do, hence the strongest
    competitor: torques are linear in at most 4 n parameters, so a handful of samples gives the
    exact torque of a rigid arm. Prefer it whenever the kinematics is known and the arm is rigid.
    It is wrong where lengths or angles are; the learners that know nothing about the arm are not.

    What is predicted is the torque that would be measured: of gravity, and what the samples show
    beside it (`shown_beside`), say a sensor's zero. Every joint has its own noise, and angles have
    if residuals spread that way. Rows of one pose count as one sample in standard errors.

    The regressor is Pinocchio's ``computeJointTorqueRegressor`` without velocity and acceleration:
    of each body's ten columns the first four, mass and first moments. (``computeStaticRegressor``
    is another thing: it gives the arm's centre of mass, three rows, not the torques.)

    References
    ----------
    W. Khalil, E. Dombre, "Modeling, Identification and Control of Robots", 2002, chapter 12.

    Examples
    --------
    >>> q = np.array([[0.3, -1.0], [1.1, 0.4]])
    >>> lower = 6.131 * np.cos(q.sum(axis=1))
    >>> torque = np.stack([18.394 * np.cos(q[:, 0]) + lower, lower], axis=1)
    >>> arm = StaticRegressor("2r").fit(q, torque)
    >>> bool(np.abs(arm.predict([[0.0, 0.0]]) - [24.525, 6.131]).max() < 1e-9), arm.rank_
    (True, 4)
    """

    _root: Array | None
    _shown: ShownBeside | None

    def __init__(
        self,
        robot: Robot | RobotOptions | str | None = None,
        *,
        snap: bool = True,
        ridge: float = 0.0,
        group: GroupArrays | None = None,
    ) -> None:
        self.robot = robot
        self.snap = snap
        self.ridge = ridge
        self.group = group

    def fit(
        self, X: Any, y: Any, sample_weight: Any = None, *, directions: Any = None
    ) -> StaticRegressor:
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
            Signs of the last motion of every joint before the arm came to rest; 0 where not known.

        Returns
        -------
        StaticRegressor
            Itself.

        Raises
        ------
        InputError
            If a number is NaN or infinite, there is no robot, or it has another number of joints.
        """
        self._check_parameters()
        q, torque, weights = checked_samples(self, X, y, sample_weight, first=True)
        sides = checked_directions(directions, q.shape)
        self._start(q.shape[1], torque.shape[1], np.ndim(y) == 1)
        self.n_samples_seen_ = len(q)
        q, torque, sides, weights = by_pose_and_side(q, torque, sides, weights)
        own = self._regressors(q)
        shown = shown_beside(
            q, torque, own, weights, directions=sides, stiffness_of=self._stiffness_of(q)
        )
        beside = shown.columns(q, own, sides)
        columns = np.concatenate([shown.gains[:, None] * own, beside], axis=2)
        found, self.rank_, self._root = self._solved(columns, torque, shown.whitening)
        count = own.shape[2]
        self.parameters_, self.beside_ = found[:count], shown.beside(found[count:])
        self._shown, self.levels_ = shown, shown.levels
        if self.group is not None:
            self._settle_by_copies(q, torque, weights)
        return self

    def near(self) -> NearRegressor:
        """A regressor with the same causes, to be fitted to other samples, friction taken off."""
        require_fitted(self)
        return NearRegressor(self)

    def gravity(self, X: Any) -> Array:
        """True torques (m, n) [N m] of gravity alone at configurations (m, n) [rad]."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        return np.asarray(self._regressors(q) @ self.parameters_)

    def _solved(
        self, columns: Array, torque: Array, whitening: Array
    ) -> tuple[Array, int, Array | None]:
        """Least squares; the rank of the parameters and a root of the covariance, if known."""
        features = (whitening @ columns).reshape(torque.size, -1)
        targets = np.einsum("kij,kj->ki", whitening, torque).ravel()
        count, every = 4 * torque.shape[1], columns.shape[2]
        rank = int(np.linalg.matrix_rank(features, rtol=1e-11)) - (every - count)
        if self.ridge:
            penalty = np.sqrt(self.ridge) * np.eye(count, every)
            features, targets = np.vstack([features, penalty]), np.append(targets, np.zeros(count))
            return np.asarray(lstsq(features, targets, cond=1e-11)[0]), rank, None
        gravity = max(float(np.linalg.norm(self._model.gravity.linear)), 1e-300)
        largest = float(np.abs(torque).max(initial=0.0)) / gravity
        found, root = shrunk_least_squares(features, targets, largest)
        return found, rank, root

    def _settle_by_copies(self, q: Array, torque: Array, weights: Array) -> None:
        """Parameters from samples of gravity and all their symmetric copies."""
        gravity = (torque - self.beside_.added(q)) / self.beside_.gains
        copies, torques = self._coordinates.copies(q, gravity)
        basis, n = self._coordinates.basis, q.shape[1]
        # moved in q no more than B q says
        moved = (q + (copies - q @ basis.T) @ np.linalg.pinv(basis).T).reshape(-1, n)
        whitening = whitening_of(np.ones(n), None, np.tile(weights, len(copies)))
        solved = self._solved(self._regressors(moved), torques.reshape(-1, n), whitening)
        self.parameters_, self.rank_, self._root = solved
        self._shown = None

    def standard_error(self, X: Any) -> Array | None:
        """Standard errors (m, n) [N m] of ``predict``, as far as the residuals tell.

        None for a loaded model, and where ``ridge`` was given.
        """
        require_fitted(self)
        root = self._root
        if root is None:
            return None
        q = checked_configurations(self, X, first=False)
        columns = self.beside_.gains[:, None] * self._regressors(q)
        if self._shown is not None:
            beside = self._shown.columns(q, self._regressors(q), None)
            columns = np.concatenate([columns, beside], axis=2)
        return np.asarray(np.linalg.norm(columns @ root, axis=2))

    def predict(self, X: Any) -> Array:
        """Measured torques (m, n) [N m] estimated for configurations (m, n) [rad]."""
        require_fitted(self)
        q = checked_configurations(self, X, first=False)
        result = self.beside_.gains * (self._regressors(q) @ self.parameters_)
        result += self.beside_.added(q)
        return result[:, 0] if self._flat else result

    def _regressors(self, q: Array) -> Array:
        """Derivatives of the torques by the parameters, (m, n, 4 n)."""
        data, rest = self._model.createData(), np.zeros(self._model.nv)
        columns = np.arange(10 * (self._model.njoints - 1)).reshape(-1, 10)[:, :4].ravel()
        result = np.empty((len(q), self._model.nv, len(columns)))
        for row, configuration in zip(result, q, strict=True):
            whole = pin.computeJointTorqueRegressor(self._model, data, configuration, rest, rest)
            row[:] = np.reshape(whole, (self._model.nv, -1))[:, columns]  # one joint: a vector
        return result

    def _stiffness_of(self, q: Array) -> Callable[[Array, NDArray[np.intp]], Array]:
        """Derivatives of torques by angles at some of the samples, for any parameters.

        Every angle enters as 1, cosine and sine: differences over half a turn are derivatives.
        """

        @cache
        def derivatives(rows: bytes) -> Array:
            at = q[np.frombuffer(rows, dtype=np.intp)]
            steps = np.pi / 2 * np.eye(q.shape[1])
            slopes = [self._regressors(at + s) - self._regressors(at - s) for s in steps]
            return np.stack(slopes, axis=-1) / 2.0

        def stiffness(parameters: Array, rows: NDArray[np.intp]) -> Array:
            return np.einsum("kipj,p->kij", derivatives(rows.tobytes()), parameters)

        return stiffness

    @property
    def offsets_(self) -> Array:
        """Constant torques (n,) beside gravity [N m]."""
        require_fitted(self)
        return self.beside_.coefficients[:, 0]

    @property
    def causes_(self) -> tuple[Cause, ...]:
        """What the samples show beside gravity, by name."""
        require_fitted(self)
        return self.beside_.causes

    def _arrays(self) -> dict[str, NDArray]:
        found = "a loaded one" if isinstance(self.robot, Robot) else None
        if getattr(self.robot, "spec", self.robot) == STANDARD_INPUT:
            found = "standard input"
        if found is not None:
            raise InputError("StaticRegressor", "robot", found, "a name or file, to be saved")
        return {"parameters": self.parameters_.copy(), **self.beside_.to_arrays()}

    def parameters(self) -> dict[str, Any]:
        """Settings and counters as plain data; the options of the robot as in a recording."""
        saved = super().parameters()
        robot = self.robot
        if isinstance(robot, RobotOptions):
            saved["settings"] |= {"robot": robot.spec}
            if robot.changed:
                saved["settings"] |= {"robot": [robot.spec, robot.as_json()]}
        return saved

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, NDArray], parameters: Mapping[str, Any]
    ) -> StaticRegressor:
        """The learner that was saved."""
        settings = dict(parameters["settings"])
        if isinstance(settings.get("robot"), list):
            spec, options = settings["robot"]
            settings["robot"] = RobotOptions.from_json(spec, options, "saved model")
        return super().from_arrays(arrays, {**parameters, "settings": settings})

    def _counters(self) -> dict[str, Any]:
        return {
            "rank": int(self.rank_),
            "kinematics": self._kinematics,
            "causes": [cause.as_json() for cause in self.causes_],
        }

    def _restore(self, arrays: dict[str, NDArray], state: Mapping[str, Any]) -> None:
        if state["kinematics"] != self._kinematics:
            name = getattr(self.robot, "name", str(self.robot))
            raise InputError(
                "saved model", "robot", f"{name}, of other kinematics", "the arm it was fitted to"
            )
        self.parameters_, self.rank_ = arrays["parameters"], int(state["rank"])
        self.beside_ = BesideGravity.from_saved(arrays, state, self.n_outputs_)

    def _check_parameters(self) -> None:
        require(self, "robot", self.robot is not None, "a robot, a built-in name or a file")
        require(self, "ridge", 0 <= self.ridge < np.inf, "a number >= 0")

    def _start(self, joints: int, outputs: int, flat: bool) -> None:
        """Empty state for ``joints`` inputs and ``outputs`` outputs."""
        robot = self.robot
        if not isinstance(robot, Robot):
            named = isinstance(robot, RobotOptions)
            robot = load_robot(robot if named else RobotOptions(str(robot), self.snap))
        for field, number in (("X", joints), ("y", outputs)):
            if number != robot.n:
                raise InputError(field, "number of columns", number, f"{robot.n}, as the robot")
        self._coordinates = SymmetryCoordinates.of(self.group, joints)
        self._root, self._shown = None, None
        self._model, self._kinematics = robot.model, _kinematics(robot)
        self._flat = flat
        self.n_outputs_ = outputs
        self.n_samples_seen_ = 0


class NearRegressor:
    """A regressor with the gains and causes of another, fitted to other samples.

    Parameters
    ----------
    learner : StaticRegressor
        Fitted.
    """

    def __init__(self, learner: StaticRegressor) -> None:
        self._learner, beside = learner, learner.beside_
        self._gains = beside.gains
        self._held = [Term(HELD[k], int(j)) for j, k in np.argwhere(beside.coefficients != 0.0)]
        self._found = np.zeros(0)

    def fit(self, q: Array, torque: Array) -> NearRegressor:
        """Fit to samples (m, n) [rad], [N m]."""
        levels = self._learner.levels_
        whitening = whitening_of(levels, None, np.ones(len(q)))
        self._found = self._learner._solved(self._columns(q), torque, whitening)[0]
        return self

    def predict(self, q: Array) -> Array:
        """Torques (m, n) [N m]."""
        return np.asarray(self._columns(q) @ self._found)

    def _columns(self, q: Array) -> Array:
        own = self._gains[:, None] * self._learner._regressors(q)
        return np.concatenate([own, cause_columns(self._held, q, q, None, None)], axis=2)


def _kinematics(robot: Robot) -> str:
    """Identity of all that the regressor depends on: everything but the inertias."""
    tree = robot.tree
    arrays = (tree.parents, tree.rotations, tree.translations, tree.axes, tree.gravity)
    packed = b"".join(np.ascontiguousarray(a, dtype="<f8").tobytes() for a in arrays)
    return hashlib.sha256(packed).hexdigest()
