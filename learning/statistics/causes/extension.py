"""Extensions of a model of gravity: what else torques and angles of real arms contain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Kind(StrEnum):
    """Kinds of causes."""

    OFFSET = "offset"
    """Constant torque: zero of a sensor, or friction approached from one side [N m]."""
    GAIN = "gain"
    """Measured torque over true torque."""
    SIGN = "sign"
    """A gain of -1: the torque, or the angle, counts the other way round."""
    SPRING = "spring"
    """Torque proportional to the angle [N m/rad], and a constant."""
    FRICTION = "friction"
    """Torque against the direction of the last motion [N m]."""
    CABLE = "cable"
    """Torque of twice the angle [N m]: a cable over a pulley, a bent link."""
    SCALE = "scale"
    """Error of the angle in proportion to the angle."""
    COMPLIANCE = "compliance"
    """Error of the angle in proportion to the torque [rad/(N m)]."""
    PAYLOAD = "payload"
    """What the arm carries changes during the recording."""


class Shape(StrEnum):
    """Dependence of one term on what was measured."""

    CONSTANT = "constant"
    ANGLE = "angle"
    COSINE = "cosine of twice the angle"
    SINE = "sine of twice the angle"
    DIRECTION = "direction of approach"
    GAIN = "gain"
    SCALE = "angle scale"
    COMPLIANCE = "compliance"
    LOAD = "load"


SHAPES: dict[Kind, tuple[Shape, ...]] = {
    Kind.OFFSET: (Shape.CONSTANT,),
    Kind.GAIN: (Shape.GAIN,),
    Kind.SPRING: (Shape.CONSTANT, Shape.ANGLE),
    Kind.FRICTION: (Shape.DIRECTION,),
    Kind.CABLE: (Shape.COSINE, Shape.SINE),
    Kind.SCALE: (Shape.SCALE,),
    Kind.COMPLIANCE: (Shape.COMPLIANCE,),
}
"""Terms of a kind at one joint."""


@dataclass(frozen=True, order=True)
class Term:
    """One unknown that is added to a model; a load adds one per lever of the model.

    Attributes
    ----------
    shape : Shape
    place : int
        The joint, from 0; of a load the first sample with it.
    """

    shape: Shape
    place: int


@dataclass(frozen=True)
class Extension:
    """A cause that may be added to a model.

    Attributes
    ----------
    kind : Kind
    joint : int or None
        From 0; None for all joints, and for a payload.
    terms : tuple of Term
        What it adds.
    """

    kind: Kind
    joint: int | None
    terms: tuple[Term, ...]

    @classmethod
    def at(cls, kind: Kind, joint: int) -> Extension:
        """A cause at one joint.

        Examples
        --------
        >>> [str(term.shape) for term in Extension.at(Kind.SPRING, 1).terms]
        ['constant', 'angle']
        """
        return cls(kind, joint, tuple(Term(shape, joint) for shape in SHAPES[kind]))

    @classmethod
    def everywhere(cls, kind: Kind, joints: Sequence[int]) -> Extension:
        """A cause at all of these joints together."""
        return cls(kind, None, tuple(Term(shape, j) for j in joints for shape in SHAPES[kind]))

    @classmethod
    def payload(cls, first: int) -> Extension:
        """Another load from a sample on."""
        return cls(Kind.PAYLOAD, None, (Term(Shape.LOAD, first),))


def added_torque(term: Term, q: Array, directions: Array | None) -> Array:
    """Torque (m,) at the term's joint for one unit of a term that adds to the torque.

    Parameters
    ----------
    term : Term
        Constant, angle, cosine, sine or direction.
    q : (m, n) array
        Configurations [rad].
    directions : (m, n) array or None
        Signs of the last motion of every joint; 0 where not known.

    Examples
    --------
    >>> added_torque(Term(Shape.ANGLE, 1), np.array([[0.0, 0.5]]), None).tolist()
    [0.5]
    """
    angle = q[:, term.place]
    if term.shape is Shape.CONSTANT:
        return np.ones(len(q))
    if term.shape is Shape.ANGLE:
        return angle
    if term.shape is Shape.DIRECTION:
        return np.zeros(len(q)) if directions is None else directions[:, term.place]
    return np.cos(2.0 * angle) if term.shape is Shape.COSINE else np.sin(2.0 * angle)


ADDED = (Shape.CONSTANT, Shape.ANGLE, Shape.COSINE, Shape.SINE, Shape.DIRECTION)
"""Shapes that add to the torque of their joint, whatever the model."""
