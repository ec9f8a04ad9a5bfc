"""Plausibility of masses: missing or impossible ones are named, or refused."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.arm_body import ArmBody
from isotorque.symbolic.robots.urdf.urdf_file import Urdf

FAR = 3.0
"""Centres of mass further away than so many lengths of the arm are not meant."""
NEAR = 2.0
"""... but never those within [m]: the length of an arm of one joint is not known."""
HEAVIER = 1000.0
"""A link that weighs so many times all others together is not meant."""
DENSE, THIN = 5000.0, 0.005
"""Mass of an arm by the cube of its length [kg/m^3]: from 2 to 100 for arms that are built."""
_FELT = 1e-12
"""Share of the largest conceivable torque that no rounding makes."""
_CONFIGURATIONS = 4
_ROUNDED = 1e-9  # kg m^2: 1 g at 1 mm


@dataclass(frozen=True)
class MovingLink:
    """A link that some joint moves.

    Attributes
    ----------
    name : str
        As in the file.
    body : str
        The joint that moves it; links of one joint are one body.
    mass : float
        Mass [kg].
    centre : tuple of 3 floats
        Centre of mass in the link's frame [m].
    products : tuple of 6 floats
        ixx, ixy, ixz, iyy, iyz, izz about the centre [kg m^2].
    shaped : bool
        Whether it is a thing rather than a mere frame.
    """

    name: str
    body: str
    mass: float
    centre: tuple[float, ...]
    products: tuple[float, ...]
    shaped: bool = False


def moving_links(urdf: Urdf) -> list[MovingLink]:
    """Return the links of a description that move, in its order."""
    above = {joint.child: joint for joint in urdf.joints}
    out = []
    for link in urdf.links:
        place = link.name
        while place in above and not above[place].moves:
            place = above[place].parent
        if place in above:
            body = above[place].name
            out.append(MovingLink(link.name, body, link.mass, link.xyz, link.products, link.shaped))
    return out


def bodies(body: ArmBody) -> list[MovingLink]:
    """Return the bodies of an arm, named by their joints."""
    xx, xy, xz, yy, yz, zz = (0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)
    return [
        MovingLink(
            f"body of {name}",
            name,
            float(body.masses[i]),
            tuple(body.levers[i].tolist()),
            tuple(float(body.inertias[i][at]) for at in (xx, xy, xz, yy, yz, zz)),
        )
        for i, name in enumerate(body.joint_names)
    ]


def massless(links: Sequence[MovingLink]) -> list[str]:
    """Return the names of links that should weigh something and do not.

    Those are the first link of a body that weighs nothing, and links with a shape but no mass; a
    frame that is fixed to a link with mass is none.

    Examples
    --------
    >>> nothing = (0.0,) * 6
    >>> massless([MovingLink("arm", "j1", 1.0, (0, 0, 0), nothing),
    ...     MovingLink("tool0", "j1", 0.0, (0, 0, 0), nothing),
    ...     MovingLink("hand", "j2", 0.0, (0, 0, 0), nothing)])
    ['hand']
    """
    total: dict[str, float] = {}
    for link in links:
        total[link.body] = total.get(link.body, 0.0) + link.mass
    out, named = [], set()
    for link in links:
        if link.mass == 0 and (link.shaped or (total[link.body] == 0 and link.body not in named)):
            out.append(link.name)
            named.add(link.body)
    return out


def check_masses(
    links: Sequence[MovingLink], body: ArmBody, where: str, allow_massless: bool
) -> tuple[str, ...]:
    """Return what is to be said of the masses of an arm, one line each.

    Parameters
    ----------
    links
        All links that move.
    body
        The arm.
    where
        What to call it in an error.
    allow_massless
        Whether to say rather than refuse that no joint feels gravity for want of masses.

    Raises
    ------
    InputError
        If no joint feels gravity, and would if the links without mass had one.
    """
    missing = massless(links)
    names = ", ".join(f"'{name}'" for name in missing)
    said: list[str] = []
    if missing and not feels_gravity(body) and feels_gravity(_filled(body)):
        if not allow_massless:
            field = f"mass of moving link{'s' * (len(missing) > 1)} {names}"
            accepted = "a <mass> in their <inertial>, or --allow-massless"
            raise InputError(where, field, "0, and no joint feels gravity", accepted)
        said.append(f"{where}: no joint feels gravity: no mass in {names} (--allow-massless)")
    elif missing:
        said.append(f"{where}: no mass in {names}, which move")
    elif not feels_gravity(body):
        said.append(f"{where}: no joint feels gravity")
    return (*said, *(f"{where}: {words}" for words in _implausible(links, body)))


def feels_gravity(body: ArmBody) -> bool:
    """Say whether any joint feels gravity in any configuration.

    Notes
    -----
    The torques are analytic in the angles: if they vanish at random configurations they vanish
    everywhere, except with probability 0.
    """
    scale = float(np.linalg.norm(body.gravity)) * float(body.masses.sum()) * _reach(body)
    if not scale > 0:
        return False
    model = body.to_model("arm")
    data = model.createData()
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (_CONFIGURATIONS, body.n))
    torque = [np.abs(pin.computeGeneralizedGravity(model, data, x)).max() for x in q]
    return bool(max(torque) > _FELT * scale)


def _filled(body: ArmBody) -> ArmBody:
    """Return the arm with some mass, off the axis, in bodies that have none."""
    empty = body.masses == 0
    return replace(
        body,
        masses=np.where(empty, 1.0, body.masses),
        levers=np.where(empty[:, None], [0.1, 0.2, 0.3], body.levers),
    )


def _reach(body: ArmBody) -> float:
    """Return a length that no centre of mass is further away from the first joint."""
    offsets = np.linalg.norm(body.translations, axis=1).sum()
    return float(offsets + np.linalg.norm(body.levers, axis=1).max())


def _implausible(links: Sequence[MovingLink], body: ArmBody) -> list[str]:
    length = _length(body)
    heavy = [link for link in links if link.mass > 0]
    total = sum(link.mass for link in heavy)
    said = []
    for link in heavy:
        away = math.hypot(*link.centre)
        if away > max(FAR * length, NEAR):
            said.append(f"centre of mass (origin xyz) of link '{link.name}' is {away:.3g} m away")
        rest = total - link.mass
        if len(heavy) > 1 and link.mass > HEAVIER * rest:
            said.append(
                f"mass of link '{link.name}' is {link.mass:.3g} kg, of all others {rest:.3g} kg"
            )
    for link in links:
        smallest = _smallest_moment(link.products)
        if smallest < 0:
            said.append(
                f"inertia of link '{link.name}' is negative about an axis ({smallest:.3g} kg m^2)"
            )
    if heavy and length > 0:
        worst = max(heavy, key=lambda link: link.mass)
        words = f"mass of all moving links is {total:.3g} kg, of '{worst.name}' {worst.mass:.3g} kg"
        if total > DENSE * max(length, 0.1) ** 3:
            said.append(f"{words}, for an arm of {length:.3g} m (grams?)")
        elif total < THIN * length**3:
            said.append(f"{words}, for an arm of {length:.3g} m (tonnes?)")
    return said


def _length(body: ArmBody) -> float:
    """Return the length of the longest chain of joints, from the first joint on [m]."""
    reach: list[float] = []
    for i, parent in enumerate(body.parents):
        step = float(np.linalg.norm(body.translations[i]))
        reach.append(reach[parent] + step if parent >= 0 else 0.0)
    return max(reach)


def _smallest_moment(products: Sequence[float]) -> float:
    """Return the smallest principal moment of inertia; 0 where it is rounding."""
    xx, xy, xz, yy, yz, zz = products
    moments = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    smallest = float(moments[0])
    return smallest if smallest < -max(_ROUNDED, 1e-6 * float(moments[-1])) else 0.0
