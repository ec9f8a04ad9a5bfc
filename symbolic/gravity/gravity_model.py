"""The gravity model of an arm: exact potential, torque and stiffness, checked when it is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.gravity.recursion import GravityChain
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.kinematic_tree import KinematicTree
from isotorque.symbolic.robots.load_robot import Robot

Floats = NDArray[np.float64]

RELATIVE_TOLERANCE = 1e-10
"""Disagreement with Pinocchio that rounding may cause, as a fraction of the largest torque."""

_ROUNDING = 1e-13  # the same, as a fraction of what masses and lengths could make: see _check

_CHECKED_CONFIGURATIONS = 32


class GravityMismatch(InputError):
    """The derived torque is not the one that Pinocchio computes: no answer is given.

    Attributes
    ----------
    joint : str
        The joint with the worst excess.
    error, allowed : float
        The disagreement found and the one that is allowed [N m].
    """

    def __init__(self, where: str, joint: str, error: float, allowed: float) -> None:
        self.joint, self.error, self.allowed = joint, error, allowed
        super().__init__(
            where,
            f"difference to Pinocchio's gravity torque of joint '{joint}'",
            f"{error:.3g} N m",
            f"at most {allowed:.3g} N m",
        )


class GravityModel:
    """Gravity potential U(q), torque g(q) = dU/dq and stiffness dg/dq of an arm.

    Parameters
    ----------
    source
        A robot, or a kinematic tree of numbers (floats, exact rationals) or SymPy expressions.

    Attributes
    ----------
    potential : TrigonometricPolynomial
        U(q) without its constant [J], with exact rational or SymPy coefficients.
    tree : KinematicTree
        What it was derived from.
    joint_names : tuple of str
        One name per joint, in the order of q.
    max_error_vs_pinocchio : float or None
        Largest difference found between the torque derived here, in both forms, and Pinocchio's of
        the robot as it was read, before angles were snapped [N m]; None where there is no robot
        to ask.
    warnings : tuple of str
        What is doubtful about the robot's masses: written into everything that is made of it.

    Raises
    ------
    GravityMismatch
        If on 32 seeded random configurations the torque differs from Pinocchio's by more than the
        proved effect of snapping plus 1e-10 of the largest torque.

    Notes
    -----
    The sign is Pinocchio's (`computeGeneralizedGravity`): the torque that holds the arm at rest.
    The normal form ``potential`` is for reading and algebra; numbers are computed by the compiled
    recursion along the chain, which is faster for one configuration on every arm, and for many at
    once on all but those with no more frequencies than joints, where it is on a par
    (benchmarks/gravity_forms.py). Both forms are checked against Pinocchio, the
    normal form when the model is made, the recursion before its first answer.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, chapter 5.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> gravity = GravityModel(load_robot("2r"))
    >>> print(gravity.potential)
    18.3938 sin(shoulder) + 6.13125 sin(shoulder + elbow)
    >>> print(gravity.torque([0.0, 0.0]))
    [24.525   6.13125]
    >>> gravity.max_error_vs_pinocchio < 1e-13
    True
    """

    def __init__(self, source: Robot | KinematicTree) -> None:
        self.tree: KinematicTree = source.tree if isinstance(source, Robot) else source
        self.name: str = source.name if isinstance(source, Robot) else "kinematic tree"
        self.warnings: tuple[str, ...] = source.warnings if isinstance(source, Robot) else ()
        self.potential: TrigonometricPolynomial = derive_potential(self.tree)
        self._reference = _PinocchioTorques.of(source) if isinstance(source, Robot) else None
        self._potential_error = self._check(self.potential.gradient)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """One name per joint, in the order of q."""
        return self.tree.joint_names

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.tree.n

    @property
    def is_symbolic(self) -> bool:
        """Whether the torque contains symbols besides the joint angles."""
        return self.potential.is_symbolic

    @cached_property
    def significant_potential(self) -> TrigonometricPolynomial:
        """The potential without terms below 1e-12 of the largest, which only stand for rounding."""
        return self.potential.significant()

    @cached_property
    def neglected(self) -> TrigonometricPolynomial:
        """The terms that `significant_potential` lacks: what is said without them names them."""
        return self.potential - self.significant_potential

    @cached_property
    def neglected_bound(self) -> Floats:
        """What the neglected terms make of each torque at most, for every q [N m]; (n,)."""
        size = self.neglected.gradient_bound()
        return np.where(size > 0.0, np.nextafter(size * (1 + 1e-9), np.inf), 0.0)

    @cached_property
    def components(self) -> tuple[TrigonometricPolynomial, ...]:
        """The torque of each joint as a trigonometric polynomial [N m], significant terms only."""
        return tuple(self.significant_potential.derivative(i) for i in range(self.n))

    @cached_property
    def free_joints(self) -> tuple[str, ...]:
        """Names of the joints that feel no gravity torque and influence none."""
        touched = np.any(self.significant_potential.frequencies != 0, axis=0).tolist()
        return tuple(name for name, used in zip(self.joint_names, touched, strict=True) if not used)

    def torque(self, q: ArrayLike) -> Floats:
        """Return the gravity torque.

        Parameters
        ----------
        q
            Configurations [rad], shape (..., n).

        Returns
        -------
        (..., n) array
            Torque that holds the arm at rest [N m].

        Raises
        ------
        InputError
            For a wrong shape, or if the model contains symbols.
        """
        return self.chain.torque(q)

    def stiffness(self, q: ArrayLike) -> Floats:
        """Return dg/dq [N m/rad], symmetric, of shape (..., n, n), at ``q`` (..., n) [rad].

        Raises
        ------
        InputError
            For a wrong shape, or if the model contains symbols.
        """
        return self.chain.stiffness(q)

    @cached_property
    def rounding(self) -> float:
        """What the rounding of floats may do to `torque` at most [N m].

        In proportion to what masses and lengths could make, not to the torque: a balanced arm
        feels almost nothing, and all that cancels is rounded all the same.
        """
        return _ROUNDING * _torque_scale(self.tree) + float(np.finfo(float).tiny)

    @cached_property
    def chain(self) -> GravityChain:
        """The tree reduced to what the torque depends on; raises InputError if it has symbols."""
        chain = GravityChain.of(self.tree)
        self._check(chain.torque)
        return chain

    @cached_property
    def max_error_vs_pinocchio(self) -> float | None:
        """Largest difference of both forms from Pinocchio [N m]; None without a robot."""
        if self._potential_error is None:
            return None
        recursion_error = self._check(self.chain.torque)
        assert recursion_error is not None
        return max(self._potential_error, recursion_error)

    def _check(self, torque: Callable[[Floats], Floats]) -> float | None:
        """Compare one form with Pinocchio; return the largest difference [N m]."""
        if self._reference is None:
            return None
        truth = self._reference.torques
        error = np.abs(torque(self._reference.q) - truth).max(axis=0)
        # A balanced arm feels almost nothing, but Pinocchio still rounds all that cancels.
        rounding = RELATIVE_TOLERANCE * np.abs(truth).max() + self.rounding
        allowed = self._reference.snap_bound + rounding
        worst = int(np.argmax(error - allowed))
        if not error[worst] <= allowed[worst]:
            raise GravityMismatch(
                self.name, self.joint_names[worst], float(error[worst]), float(allowed[worst])
            )
        return float(error.max())


@dataclass(frozen=True)
class _PinocchioTorques:
    """Pinocchio's torques (m, n) [N m] of a robot as it was read, at m angles ``q`` [rad]."""

    q: Floats
    torques: Floats
    snap_bound: Floats

    @classmethod
    def of(cls, robot: Robot) -> _PinocchioTorques:
        rng = np.random.default_rng(0)
        q = rng.uniform(-np.pi, np.pi, (_CHECKED_CONFIGURATIONS, robot.n))
        model, data = robot.source_model, robot.source_model.createData()
        torques = [
            pin.computeGeneralizedGravity(model, data, x) for x in robot.source_configuration(q)
        ]
        return cls(q, np.array(torques), robot.snap_bound)


def _torque_scale(tree: KinematicTree) -> float:
    """Return a torque [N m] that no joint can feel: all masses at the end of stretched links."""
    reach: list[float] = []
    total = 0.0
    for i, parent in enumerate(tree.parents):
        base = reach[parent] if parent >= 0 else 0.0
        reach.append(base + float(np.linalg.norm(tree.translations[i])))
        total += float(tree.masses[i]) * (reach[i] + float(np.linalg.norm(tree.levers[i])))
    return total * float(np.linalg.norm(tree.gravity))
