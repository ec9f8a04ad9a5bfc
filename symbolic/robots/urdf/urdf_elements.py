"""Links and joints of a URDF file, read so that nothing in them is silently ignored."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.body_checks import LARGEST

Triple = tuple[float, float, float]

REVOLUTE = ("revolute", "continuous")
"""Joints that can move here; others can only be locked."""
KINDS = (*REVOLUTE, "prismatic", "planar", "floating", "fixed")
PRODUCTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_ZERO: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class UrdfLink:
    """A link with its inertia.

    Attributes
    ----------
    name : str
        Its name.
    mass : float
        Mass [kg], 0 where the file gives none.
    xyz, rpy : tuple of 3 floats
        Centre of mass [m] and orientation [rad] of the inertial frame in the link's frame.
    products : tuple of 6 floats
        ixx, ixy, ixz, iyy, iyz, izz in the inertial frame [kg m^2].
    shaped : bool
        Whether the file says what the link looks like: then it is a thing, not a mere frame.
    """

    name: str
    mass: float = 0.0
    xyz: Triple = _ZERO
    rpy: Triple = _ZERO
    products: tuple[float, ...] = (0.0,) * 6
    shaped: bool = False


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: ``multiplier`` times its position plus ``offset``."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class UrdfJoint:
    """A joint of any kind that URDF knows.

    Attributes
    ----------
    name, kind, parent, child : str
        Name, one of `KINDS`, and the links that it joins.
    xyz, rpy : tuple of 3 floats
        Placement in the parent's frame [m], [rad].
    axis : tuple of 3 floats
        As in the file, of any length but zero.
    lower, upper : float or None
        Limits [rad or m], None where the file has none.
    effort, velocity : float
        Limits of torque [N m] and speed [rad/s]; 0 or less: none.
    damping, friction : float
        Viscous damping [N m s/rad] and Coulomb friction [N m].
    mimic : Mimic or None
        The joint that it follows.
    locked : float or None
        Where it stands if it does not move [rad or m]; None: it moves, unless it is fixed.
    """

    name: str
    kind: str
    parent: str
    child: str
    xyz: Triple = _ZERO
    rpy: Triple = _ZERO
    axis: Triple = (1.0, 0.0, 0.0)
    lower: float | None = None
    upper: float | None = None
    effort: float = 0.0
    velocity: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    mimic: Mimic | None = None
    locked: float | None = None

    @property
    def moves(self) -> bool:
        """Whether it is neither fixed nor locked."""
        return self.kind != "fixed" and self.locked is None


class UrdfReader:
    """Reads elements; knows where they come from, for the errors."""

    def __init__(self, where: str) -> None:
        self.where = where

    def link(self, element: Any) -> UrdfLink:
        """Read a link."""
        name = self.text(element, "name", "a link")
        inertial = self.only(element, "inertial", f"link '{name}'")
        shaped = any(element.find(tag) is not None for tag in ("visual", "collision"))
        if inertial is None:
            return UrdfLink(name, shaped=shaped)
        of = f"of link '{name}'"
        mass_element = self.need(inertial, "mass", f"inertial {of}")
        mass = self.number(mass_element, "value", f"mass {of}")
        if mass < 0:
            raise InputError(self.where, f"mass {of}", mass, "a number >= 0 [kg]")
        inertia = self.only(inertial, "inertia", f"inertial {of}")
        products: tuple[float, ...] = (0.0,) * 6  # gravity does not see it
        if inertia is not None:
            products = tuple(self.number(inertia, key, f"{key} {of}") for key in PRODUCTS)
        xyz, rpy = self.origin(inertial, f"inertial {of}")
        return UrdfLink(name, mass, xyz, rpy, products, shaped)

    def joint(self, element: Any) -> UrdfJoint:
        """Read a joint."""
        name = self.text(element, "name", "a joint")
        of = f"of joint '{name}'"
        kind = self.text(element, "type", f"joint '{name}'")
        if kind not in KINDS:
            raise InputError(self.where, f"type {of}", kind, ", ".join(KINDS))
        ends = {
            tag: self.text(self.need(element, tag, f"joint '{name}'"), "link", f"{tag} {of}")
            for tag in ("parent", "child")
        }
        xyz, rpy = self.origin(element, f"joint '{name}'")
        joint = UrdfJoint(name, kind, ends["parent"], ends["child"], xyz, rpy)
        return joint if kind == "fixed" else self.moving(element, joint)

    def moving(self, element: Any, joint: UrdfJoint) -> UrdfJoint:
        """Add axis, limits and dynamics of a moving joint."""
        of = f"of joint '{joint.name}'"
        numbers: dict[str, Any] = {"mimic": self.mimic(element, of)}
        axis = self.only(element, "axis", f"joint '{joint.name}'")
        if axis is not None:
            numbers["axis"] = self.triple(axis, "xyz", f"axis {of}")
            if not any(numbers["axis"]):
                raise InputError(self.where, f"axis {of}", axis.get("xyz"), "a direction")
        dynamics = self.only(element, "dynamics", f"joint '{joint.name}'")
        if dynamics is not None:
            for key in ("damping", "friction"):
                numbers[key] = self.number(dynamics, key, f"{key} {of}", 0.0)
                if numbers[key] < 0:
                    raise InputError(self.where, f"{key} {of}", numbers[key], "a number >= 0")
        limit = self.only(element, "limit", f"joint '{joint.name}'")
        if limit is None and joint.kind == "revolute":
            raise InputError(
                self.where,
                f"limit {of}",
                "missing",
                "<limit lower upper effort velocity>, or type continuous",
            )
        if limit is not None:
            for key in ("effort", "velocity"):
                numbers[key] = self.number(limit, key, f"{key} {of}", 0.0, math.inf)
            lower, upper = (
                self.number(limit, key, f"{key} limit {of}", 0.0, math.inf)
                for key in ("lower", "upper")
            )
            if joint.kind in ("revolute", "prismatic") and (lower or upper):  # both zero: not set
                numbers |= {"lower": lower, "upper": upper}
        return UrdfJoint(
            joint.name, joint.kind, joint.parent, joint.child, joint.xyz, joint.rpy, **numbers
        )

    def mimic(self, element: Any, of: str) -> Mimic | None:
        """Read which joint a joint follows."""
        mimic = self.only(element, "mimic", of.removeprefix("of "))
        if mimic is None:
            return None
        return Mimic(
            self.text(mimic, "joint", f"mimic {of}"),
            self.number(mimic, "multiplier", f"multiplier of mimic {of}", 1.0),
            self.number(mimic, "offset", f"offset of mimic {of}", 0.0),
        )

    def origin(self, element: Any, of: str) -> tuple[Triple, Triple]:
        """Read xyz and rpy; an origin that is not there is the identity."""
        origin = self.only(element, "origin", of)
        if origin is None:
            return _ZERO, _ZERO
        for key in origin.attrib:
            if key not in ("xyz", "rpy"):
                raise InputError(self.where, f"origin of {of}", f"attribute {key}", "xyz and rpy")
        xyz = self.triple(origin, "xyz", f"origin xyz of {of}")
        return xyz, self.triple(origin, "rpy", f"origin rpy of {of}")

    def only(self, element: Any, tag: str, of: str) -> Any:
        """Return the child element, or None; more than one would be ambiguous."""
        found = element.findall(tag)
        if len(found) > 1:
            raise InputError(self.where, f"number of <{tag}> in {of}", len(found), "at most one")
        return found[0] if found else None

    def need(self, element: Any, tag: str, of: str) -> Any:
        """Return the child element, which must be there."""
        found = self.only(element, tag, of)
        if found is None:
            raise InputError(self.where, f"<{tag}> of {of}", "missing", "one such element")
        return found

    def text(self, element: Any, key: str, of: str) -> str:
        """Return an attribute, which must be there and not be empty."""
        value = element.get(key)
        if not value:
            raise InputError(self.where, f"{key} of {of}", repr(value), "a name")
        return str(value)

    def number(
        self,
        element: Any,
        key: str,
        of: str,
        missing: float | None = None,
        largest: float = LARGEST,
    ) -> float:
        """Return one finite number."""
        text = element.get(key)
        if text is None and missing is not None:
            return missing
        return self.numbers(text, of, 1, largest)[0]

    def triple(self, element: Any, key: str, of: str) -> Triple:
        """Return three finite numbers, zeros where the attribute is not there."""
        text = element.get(key)
        if text is None:
            return _ZERO
        x, y, z = self.numbers(text, of, 3)
        return x, y, z

    def numbers(
        self, text: str | None, of: str, count: int, largest: float = LARGEST
    ) -> list[float]:
        """Parse finite numbers; Python's own extras (1_000, other scripts' digits) are refused."""
        accepted = "a finite number" if count == 1 else f"{count} finite numbers"
        shown = "missing" if text is None else repr(text)
        if text is None or not text.isascii() or "_" in text:
            raise InputError(self.where, of, shown, accepted)
        try:
            values = [float(part) for part in text.split()]
        except ValueError:
            raise InputError(self.where, of, shown, accepted) from None
        if len(values) != count or not all(map(math.isfinite, values)):
            raise InputError(self.where, of, shown, accepted)
        if not all(abs(value) < largest for value in values):
            raise InputError(self.where, of, shown, f"{accepted}, of size below {largest:g}")
        return values
