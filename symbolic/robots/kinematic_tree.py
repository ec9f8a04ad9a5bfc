"""Kinematic tree: joints, axes, masses and centres of mass, all that gravity needs to know."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from isotorque.symbolic.common.errors import InputError

Entries = NDArray[Any]


@dataclass(frozen=True, eq=False)
class KinematicTree:
    """Joints of a serial or branched arm with revolute joints.

    Link ``i`` is the body moved by joint ``i``. Its frame is reached from the frame of link
    ``parents[i]`` (the base where that is -1) by the fixed placement ``rotations[i]``,
    ``translations[i]`` followed by the rotation by ``q[i]`` about ``axes[i]``.

    Attributes
    ----------
    joint_names : tuple of str
        One name per joint.
    parents : tuple of int
        Parent joint of each joint, -1 for the base; always smaller than the joint's own index.
    rotations : (n, 3, 3) array
        Fixed rotations from the parent's frame.
    translations : (n, 3) array
        Fixed translations in the parent's frame [m].
    axes : (n, 3) array
        Unit joint axes in the link's frame.
    masses : (n,) array
        Link masses [kg].
    levers : (n, 3) array
        Centres of mass in the link's frame [m].
    gravity : (3,) array
        Gravitational acceleration in the base frame [m/s^2], usually (0, 0, -9.81).

    Notes
    -----
    Entries are floats, exact rationals (``flint.fmpq``) or SymPy expressions: everything that is
    derived from a tree keeps the kind of its entries.

    Examples
    --------
    >>> tree = planar_arm(2)
    >>> tree.n, tree.joint_names
    (2, ('q1', 'q2'))
    """

    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    rotations: Entries
    translations: Entries
    axes: Entries
    masses: Entries
    levers: Entries
    gravity: Entries

    def __post_init__(self) -> None:
        n = len(self.joint_names)
        shapes = {
            "parents": (n,),
            "rotations": (n, 3, 3),
            "translations": (n, 3),
            "axes": (n, 3),
            "masses": (n,),
            "levers": (n, 3),
            "gravity": (3,),
        }
        for field, shape in shapes.items():
            found = np.shape(getattr(self, field))
            if found != shape:
                raise InputError("kinematic tree", f"shape of {field}", found, f"{shape}")
        for i, parent in enumerate(self.parents):
            if not -1 <= parent < i:
                raise InputError(
                    "kinematic tree",
                    f"parent of joint '{self.joint_names[i]}'",
                    parent,
                    f"an index from -1 (the base) to {i - 1}",
                )

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    def map(self, convert: Callable[[Any], Any]) -> KinematicTree:
        """Return the same tree with every entry converted."""

        def each(values: Entries) -> Entries:
            out = np.empty(np.shape(values), dtype=object)
            for index in np.ndindex(out.shape):
                out[index] = convert(values[index])
            return out

        return KinematicTree(
            self.joint_names,
            self.parents,
            each(self.rotations),
            each(self.translations),
            each(self.axes),
            each(self.masses),
            each(self.levers),
            each(self.gravity),
        )

    def substitute(self, values: Mapping[str, float]) -> KinematicTree:
        """Return a SymPy tree with numbers in place of symbols, given by name.

        Raises
        ------
        InputError
            For a name that occurs nowhere in the tree.

        Examples
        --------
        >>> planar_arm(2).substitute({"m1": 5, "m2": 4}).masses
        array([5, 4], dtype=object)
        """
        entries = [self.rotations, self.translations, self.axes, self.masses, self.levers]
        symbols = {
            symbol.name: symbol
            for x in np.concatenate([np.ravel(e) for e in (*entries, self.gravity)])
            for symbol in getattr(x, "free_symbols", ())
        }
        for name in values:
            if name not in symbols:
                raise InputError("kinematic tree", "symbol", name, ", ".join(sorted(symbols)))
        numbers = {symbols[name]: value for name, value in values.items()}
        return self.map(lambda x: x.subs(numbers))

    def exact(self) -> KinematicTree:
        """Return the tree with every float replaced by the rational number that it is.

        SymPy trees and trees that are exact already are returned as they are.
        """
        if np.asarray(self.masses).dtype == object:
            return self
        return self.map(rational)


def rational(value: Any) -> fmpq:
    """Return a float as the exact rational number that it stands for.

    Examples
    --------
    >>> rational(0.375)
    3/8
    """
    if isinstance(value, fmpq):
        return value
    numerator, denominator = float(value).as_integer_ratio()
    return fmpq(numerator, denominator)


def planar_arm(n: int) -> KinematicTree:
    """Return the parametric planar arm with ``n`` links, gravity in the plane, in SymPy symbols.

    Parameters
    ----------
    n
        Number of links.

    Returns
    -------
    KinematicTree
        With positive symbols ``m1..`` (masses), ``l1..`` (lengths), ``c1..`` (distance of the
        centre of mass from the joint) and ``g``; q = 0 is stretched out to the right, positive
        angles turn it upwards.

    References
    ----------
    Siciliano et al., Robotics, Springer 2009, section 7.3.2 (two-link planar arm).

    Examples
    --------
    >>> planar_arm(2).masses
    array([m1, m2], dtype=object)
    """
    import sympy

    mass = sympy.symbols(f"m1:{n + 1}", positive=True)
    length = sympy.symbols(f"l1:{n + 1}", positive=True)
    centre = sympy.symbols(f"c1:{n + 1}", positive=True)
    g = sympy.Symbol("g", positive=True)
    zero, one = sympy.Integer(0), sympy.Integer(1)
    eye = np.array([[one if i == j else zero for j in range(3)] for i in range(3)], dtype=object)
    return KinematicTree(
        joint_names=tuple(f"q{i + 1}" for i in range(n)),
        parents=tuple(range(-1, n - 1)),
        rotations=np.array([eye] * n, dtype=object),
        translations=np.array(
            [[zero if i == 0 else length[i - 1], zero, zero] for i in range(n)], dtype=object
        ),
        axes=np.array([[zero, -one, zero]] * n, dtype=object),
        masses=np.array(mass, dtype=object),
        levers=np.array([[c, zero, zero] for c in centre], dtype=object),
        gravity=np.array([zero, zero, -g], dtype=object),
    )


def human_arm() -> KinematicTree:
    """Return the paper's 3R arm, a simplified human one, in SymPy symbols.

    Returns
    -------
    KinematicTree
        Joint 1 rolls about the horizontal x axis, joint 2 is perpendicular to it, joint 3 parallel
        to joint 2. Positive symbols: ``m1``, ``c1``, ``l1`` mass, centre of mass and length of the
        upper arm, ``m2``, ``c2`` mass and centre of mass of forearm and hand, and ``g``.

    Notes
    -----
    ``U = g cos q1 ((m1 c1 + m2 l1) sin q2 + m2 c2 sin(q2 + q3))``. The built-in ``3r`` has an upper
    arm that is balanced on the shoulder (c1 = 0), 5 kg in the hand and l1 = c2 = 0.25 m.

    References
    ----------
    The project's paper, Fig. 9; the masses are inferred from its torque ranges.

    Examples
    --------
    >>> human_arm().axes[0]
    array([1, 0, 0], dtype=object)
    """
    import sympy

    arm = planar_arm(2)
    zero, one = sympy.Integer(0), sympy.Integer(1)
    eye = np.array([[one if i == j else zero for j in range(3)] for i in range(3)], dtype=object)
    roll = np.array([one, zero, zero], dtype=object)
    nothing = np.array([zero, zero, zero], dtype=object)
    return KinematicTree(
        joint_names=("q1", "q2", "q3"),
        parents=(-1, 0, 1),
        rotations=np.array([eye, *arm.rotations], dtype=object),
        translations=np.array([nothing, *arm.translations], dtype=object),
        axes=np.array([roll, *arm.axes], dtype=object),
        masses=np.array([zero, *arm.masses], dtype=object),
        levers=np.array([nothing, *arm.levers], dtype=object),
        gravity=arm.gravity,
    )
