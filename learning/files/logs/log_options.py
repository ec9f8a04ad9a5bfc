"""How a log is to be read: which columns, units, gears and signs."""

from __future__ import annotations

from dataclasses import dataclass

ANGLE_UNITS = ("rad", "deg")
TORQUE_UNITS = ("Nm", "mNm", "A")


@dataclass(frozen=True)
class LogOptions:
    """Options of reading a log, as they are typed.

    Attributes
    ----------
    columns : tuple of str
        ``q=GLOB``, ``tau=GLOB``, ``velocity=GLOB`` or ``time=NAME``: which columns hold what, where
        headers are not understood by themselves. What ``*`` stands for names the joint.
    angle_units, torque_units : tuple of str
        ``UNIT`` of all joints or ``JOINT=UNIT`` of one: rad or deg; Nm, mNm or A.
    gears : tuple of str
        A number or ``JOINT=NUMBER``: motor turns per turn of the joint, where the log holds angle
        and torque of motors.
    signs : tuple of str
        ``JOINT=-1`` or ``JOINT=q-`` or ``JOINT=tau-``: both, the angle or the torque of a joint
        count the other way.
    """

    columns: tuple[str, ...] = ()
    angle_units: tuple[str, ...] = ()
    torque_units: tuple[str, ...] = ()
    gears: tuple[str, ...] = ()
    signs: tuple[str, ...] = ()
