"""Arms that are more than rigid gravity in one way: what they measure, how sure that can be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.learners.rigid.fitting.chain_parameters import (
    ChainParameters,
    raw_directions,
)
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.kinematic_tree import KinematicTree
from isotorque.symbolic.robots.load_robot import Robot

Array = NDArray[np.float64]
TorqueMap = Callable[[Array], Array]

PAYLOAD_CENTRE = (0.03, 0.02, 0.06)
"""Where a payload is fixed to the last link, in its frame [m]."""
OUTLIERS = 0.05
"""Share of poses whose torques are wrong."""
CHAIN_POSES = 60
STEP = 1e-4
"""Half the difference of sizes from which derivatives are taken."""
ABSORBED = 1e-6
"""A chain takes up an effect of which it leaves no larger share, and numbers of a chain whose
effects are smaller than others' by this have none."""
ITERATIONS = 60


class Contaminant(StrEnum):
    """What is wrong with an arm; the unit of its size."""

    OFFSET = "offset"
    """A constant torque on one joint. [N m]"""
    GAIN = "gain"
    """Torques of one joint too large. [share]"""
    SIGN = "sign"
    """Torques of one joint with the other sign: a gain of -2."""
    SPRING = "spring"
    """A torsion spring on one joint. [N m/rad]"""
    CABLE = "cable"
    """A torque sin(2 q + phase) on one joint. [N m]"""
    FRICTION = "friction"
    """Friction of one joint, poses reached from both sides, directions recorded. [N m]"""
    ONE_SIDED = "one-sided friction"
    """Friction of one joint, all poses reached from one side, directions not recorded. [N m]"""
    HIDDEN = "hidden friction"
    """Friction of one joint, poses reached from both sides, directions not recorded. [N m]"""
    COMPLIANCE = "compliance"
    """Angles of one joint are measured before its gear, which its torque bends. [rad/(N m)]"""
    SCALE = "scale"
    """Angles of one joint are measured too small. [share]"""
    PAYLOAD = "payload"
    """From the middle of the poses on there is a payload. [kg]"""
    OUTLIERS = "outliers"
    """Torques of some poses have larger errors. [N m, standard deviation]"""
    AMPERES = "amperes"
    """Every joint has a gain of its own, log-normal. [standard deviation of its logarithm]"""


OF_ALL_JOINTS = (Contaminant.PAYLOAD, Contaminant.OUTLIERS, Contaminant.AMPERES)
OF_TORQUE = (Contaminant.GAIN, Contaminant.SIGN, Contaminant.COMPLIANCE)
"""Kinds that a joint without torque cannot have."""
FLIPPED = -2.0


@dataclass(frozen=True, eq=False)
class TrueArm:
    """An arm of rigid links.

    Attributes
    ----------
    gravity, loaded : GravityModel
        Of the arm, and of the arm with a payload of one kilogram.
    chain : ChainParameters
        The rigid chain with its torque.
    peak : (n,) array
        Largest torque of every joint [N m].
    """

    gravity: GravityModel
    loaded: GravityModel
    chain: ChainParameters
    peak: Array

    @classmethod
    def of(cls, source: Robot | KinematicTree) -> TrueArm:
        """Derive gravity and chain.

        Raises
        ------
        NotAccepted
            If no chain with the torque was found.
        """
        gravity = GravityModel(source)
        tree = gravity.tree
        masses, levers = np.array(tree.masses), np.array(tree.levers)
        masses[-1] += 1.0
        levers[-1] = (tree.masses[-1] * levers[-1] + PAYLOAD_CENTRE) / masses[-1]
        q = np.random.default_rng(0).uniform(-np.pi, np.pi, (4000, tree.n))
        torque = gravity.torque(q)
        learner = RigidChain(tree.parents).fit(q[:CHAIN_POSES], torque[:CHAIN_POSES])
        learner.simplified()  # a tilt that is zero but for rounding would seem to matter a little
        loaded = GravityModel(replace(tree, masses=masses, levers=levers))
        return cls(gravity, loaded, learner.chain_, np.abs(torque).max(axis=0))

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.gravity.n


@dataclass(frozen=True, eq=False)
class Measurements:
    """What was recorded of a contaminated arm, and the truth about it.

    Attributes
    ----------
    q : (N, n) array
        Measured angles [rad].
    tau : (N, n) array
        Measured torques [N m].
    directions : (N, n) array or None
        Sign of the last motion of every joint before a pose; None where not recorded.
    truth : tuple of callable
        What the arm measures without noise and friction at rest, as a function of the measured
        angles (m, n); two where it changed on the way.
    """

    q: Array
    tau: Array
    directions: Array | None
    truth: tuple[TorqueMap, ...]


@dataclass(frozen=True, eq=False)
class Contamination:
    """Something wrong with an arm that was recorded at given poses; its size is left open.

    Attributes
    ----------
    arm : TrueArm
    kind : Contaminant or None
        None: nothing is.
    joint : int or None
        Which joint, from 0; None where it is all of them.
    q : (N, n) array
        Measured angles [rad].
    directions : (N, n) array
        Sign of the last motion of every joint.
    recorded_directions : bool
        Whether the directions were.
    shape : (n,) array
        Random numbers that belong to the kind: phase of the cable and rest angle of the spring
        [rad], logarithms of gains.
    pattern : (N, n) array
        Torque by which measurements at single poses differ from the arm at rest, for size 1.

    Examples
    --------
    An offset of the elbow, five of its least standard errors large:

    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> rng = np.random.default_rng(0)
    >>> arm, q = TrueArm.of(load_robot("2r")), rng.uniform(-3, 3, (50, 2))
    >>> offset = Contamination.drawn(arm, Contaminant.OFFSET, q, rng, joint=1)
    >>> size = 5 * offset.standard_error(0.05)
    >>> print(round(size, 3))
    0.036
    >>> recorded = offset.measured(size, 0.05, rng)
    >>> (recorded.truth[0](q) - arm.gravity.torque(q))[:2].round(3).tolist()
    [[0.0, 0.036], [0.0, 0.036]]
    """

    arm: TrueArm
    kind: Contaminant | None
    joint: int | None
    q: Array
    directions: Array
    recorded_directions: bool
    shape: Array
    pattern: Array

    @classmethod
    def drawn(
        cls,
        arm: TrueArm,
        kind: Contaminant | None,
        q: ArrayLike,
        rng: np.random.Generator,
        *,
        joint: int | None = None,
        recorded_directions: bool = False,
    ) -> Contamination:
        """Draw all but the size.

        Parameters
        ----------
        arm, kind, q
            See the class.
        rng
            Draws directions, shapes, patterns.
        joint
            Which joint; a kind of all joints has none.
        recorded_directions
            Whether the directions are recorded, where the kind does not say so itself.

        Raises
        ------
        InputError
            If a kind of one joint has none.
        """
        points = np.array(q, dtype=float)
        directions = rng.choice([-1.0, 1.0], points.shape)
        pattern = np.zeros(points.shape)
        if kind is None or kind in OF_ALL_JOINTS:
            joint = None
        elif joint is None:
            raise InputError("contamination", "joint", joint, f"a joint for kind {kind}")
        if kind in (Contaminant.FRICTION, Contaminant.HIDDEN):
            pattern[:, joint] = directions[:, joint]
        if kind is Contaminant.ONE_SIDED:
            directions[:] = 1.0
        if kind is Contaminant.OUTLIERS:
            wrong = rng.random(len(points)) < OUTLIERS
            wrong[rng.integers(len(points))] = True
            pattern[wrong] = rng.normal(size=(int(wrong.sum()), arm.n))
        if kind in (
            Contaminant.FRICTION,
            Contaminant.HIDDEN,
            Contaminant.ONE_SIDED,
        ):
            recorded_directions = kind is Contaminant.FRICTION
        shape = rng.normal(size=arm.n)
        return cls(arm, kind, joint, points, directions, recorded_directions, shape, pattern)

    @property
    def largest(self) -> float:
        """Largest size that is plausible; 0 where the joint's torque is too small for any."""
        peak = float(self.arm.peak[self._joint])
        match self.kind:
            case Contaminant.GAIN | Contaminant.AMPERES:
                return 0.5
            case Contaminant.SIGN:
                return -FLIPPED
            case Contaminant.SCALE:
                return 0.2
            case Contaminant.COMPLIANCE:
                return 0.1 / peak if peak > ABSORBED * self.arm.peak.max() else 0.0
            case Contaminant.PAYLOAD:
                return 5.0
        return float(self.arm.peak.max())

    def truth(self, size: float, *, late: bool = True) -> TorqueMap:
        """Torque at rest as a function of measured angles, friction in the middle of both sides.

        Parameters
        ----------
        size
            Of the contamination, see `Contaminant`.
        late
            Whether a payload has come by then.
        """
        gravity, joint = self.arm.gravity.torque, self._joint

        def torque(q: Array) -> Array:
            points = np.array(q, dtype=float)
            angle = points[:, joint].copy()
            match self.kind:
                case Contaminant.SCALE:
                    points[:, joint] *= 1.0 + size
                case Contaminant.COMPLIANCE:
                    self._bend(points, angle, size)
            result = np.array(gravity(points))
            match self.kind:
                case Contaminant.OFFSET | Contaminant.ONE_SIDED:
                    result[:, joint] += size
                case Contaminant.GAIN | Contaminant.SIGN:
                    result[:, joint] *= 1.0 + size
                case Contaminant.SPRING:
                    result[:, joint] += size * (angle - self.shape[joint])
                case Contaminant.CABLE:
                    result[:, joint] += size * np.sin(2.0 * angle + self.shape[joint])
                case Contaminant.AMPERES:
                    result *= np.exp(size * self.shape)
                case Contaminant.PAYLOAD if late:
                    result += size * (self.arm.loaded.torque(points) - result)
            return result

        return torque

    def torque(self, size: float) -> Array:
        """Torques (N, n) at the poses, without noise [N m]."""
        result = self.truth(size)(self.q) + size * self.pattern
        if self.kind is Contaminant.PAYLOAD:
            middle = len(self.q) // 2
            result[:middle] = self.truth(size, late=False)(self.q[:middle])
        return result

    def measured(
        self,
        size: float,
        noise: float | Array,
        rng: np.random.Generator,
        *,
        angle_noise: float = 0.0,
    ) -> Measurements:
        """Torques with independent normal errors.

        Parameters
        ----------
        size
            Of the contamination, see `Contaminant`; without meaning where there is none.
        noise
            Standard deviation of torques [N m], one for all joints or one each.
        rng
            Draws the errors.
        angle_noise
            Standard deviation of the measured angles [rad].
        """
        tau = self.torque(size) + np.asarray(noise) * rng.normal(size=self.q.shape)
        times = (False, True) if self.kind is Contaminant.PAYLOAD else (True,)
        return Measurements(
            self.q + angle_noise * rng.normal(size=self.q.shape),
            tau,
            self.directions if self.recorded_directions else None,
            tuple(self.truth(size, late=late) for late in times),
        )

    def effect(self, noise: float | Array) -> Array:
        """What no rigid chain explains of the torques' derivative by the size, (N n,).

        Parameters
        ----------
        noise
            Standard deviation of torques [N m], the unit of the result, one or one per joint.

        Notes
        -----
        The chain's rotations and levers are unknown, hence what their derivatives span is taken
        away; the contamination's own shape and pattern are taken as known. The length of what
        remains, times a size, is the size in standard errors. Parameters that the chain's
        torque does not depend on to first order (tilts of a planar arm) take nothing away.
        """
        slope = (self.torque(STEP) - self.torque(-STEP)) / (2.0 * STEP)
        sigma = np.broadcast_to(np.asarray(noise, dtype=float), slope.shape)
        basis = (self._chain_basis / sigma[:, :, None]).reshape(slope.size, -1)
        size = np.linalg.norm(basis, axis=0)
        felt = size > ABSORBED * size.max()
        left, values, _ = np.linalg.svd(basis[:, felt] / size[felt], full_matrices=False)
        known = left[:, values > ABSORBED * values[0]]
        whole = (slope / sigma).ravel()
        rest = whole - known @ (known.T @ whole)
        absorbed = np.linalg.norm(rest) <= ABSORBED * np.linalg.norm(whole)
        return np.zeros(slope.size) if absorbed else np.asarray(rest)

    def standard_error(self, noise: float | Array) -> float:
        """Least standard error (Cramer-Rao) of the size beside a chain; inf where it absorbs it.

        Parameters
        ----------
        noise
            Standard deviation of torques [N m], one for all joints or one each.
        """
        information = float(np.linalg.norm(self.effect(noise)))
        return 1.0 / information if information > 0.0 else float("inf")

    @cached_property
    def _chain_basis(self) -> Array:
        slopes = self.arm.chain.derivatives(self.q, raw_directions(self.arm.n))
        return np.concatenate([slopes.turned, slopes.leant], axis=2)

    @property
    def _joint(self) -> int:
        return 0 if self.joint is None else self.joint

    def _bend(self, points: Array, angle: Array, size: float) -> None:
        """Turn the joint to where its link is: angle = link + size * torque of the link."""
        for _ in range(ITERATIONS):
            before = points[:, self._joint].copy()
            points[:, self._joint] = angle - size * self.arm.gravity.torque(points)[:, self._joint]
            if np.array_equal(before, points[:, self._joint]):
                return
