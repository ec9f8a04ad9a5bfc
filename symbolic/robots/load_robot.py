"""Robots: load one from its built-in name, a URDF file or a Pinocchio model."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import IO, Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.arm_body import ArmBody
from isotorque.symbolic.robots.body_checks import check_body
from isotorque.symbolic.robots.builtin_robots import BUILT_IN, builtin_file
from isotorque.symbolic.robots.kinematic_tree import KinematicTree
from isotorque.symbolic.robots.mass_plausibility import bodies, check_masses, moving_links
from isotorque.symbolic.robots.robot_selection import (
    chosen_part,
    chosen_part_of_model,
    part_as_pinocchio_reads,
)
from isotorque.symbolic.robots.snap_effect import torque_difference_bound
from isotorque.symbolic.robots.snapped_bodies import snap_body, snap_urdf
from isotorque.symbolic.robots.snapping import Snap
from isotorque.symbolic.robots.urdf.urdf_file import Urdf, parse_urdf, urdf_text

Array = NDArray[np.float64]

STANDARD_INPUT = "-"
"""The robot that is read from standard input."""


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot arm with one angle per joint.

    Attributes
    ----------
    name : str
        The built-in name, the name in the file, or that of the file or model.
    model : pin.Model
        The arm that the toolkit works with: snapped, nq = nv = n, joints in Pinocchio's order.
    source_model : pin.Model
        As Pinocchio reads the file and locks its joints, or the user's model itself: not snapped;
        a continuous joint has two entries (cos, sin) in its configuration vector.
    joint_names : tuple of str
        One name per joint.
    limits : (n, 2) array
        Lower and upper joint limits [rad], infinite where a joint has none: continuous joints,
        and revolute ones without limits or with both zero. `joint_limits` says which
        angles to draw from then. As in the file, even where they leave no room:
        what needs room looks at them with `check_limits`.
    damping : (n,) array
        Viscous damping of the joints [N m s/rad], 0 where the file has none.
    effort : (n,) array
        Largest torques of the joints [N m]; infinite where the file has none (or 0, or -1).
    snaps : tuple of Snap
        What was snapped, in the order of the file.
    snap_bound : (n,) array
        Bound on ``|g_i(model) - g_i(source_model)|`` over all configurations [N m]; 0 where
        nothing was snapped (rounding of relative size 1e-12 apart).
    tree : KinematicTree
        What gravity sees of ``model``, in floats.
    digest : str
        Fingerprint of ``model`` (sha256, hex): the same in each run and on each machine.
    options : RobotOptions
        What it was loaded with.
    warnings : tuple of str
        What is doubtful about its masses, one line each (`check_masses`); nothing for built-in
        robots.
    """

    name: str
    model: pin.Model
    source_model: pin.Model
    joint_names: tuple[str, ...]
    limits: Array
    damping: Array
    effort: Array
    snaps: tuple[Snap, ...]
    snap_bound: Array
    tree: KinematicTree
    digest: str
    options: RobotOptions
    warnings: tuple[str, ...] = ()

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    def source_configuration(self, q: ArrayLike) -> Array:
        """Return the configuration vector of ``source_model`` for given joint angles.

        Parameters
        ----------
        q : (..., n) array
            Joint angles [rad].

        Returns
        -------
        (..., nq) array
            The angles themselves, cosine and sine for each continuous joint.
        """
        q = np.asarray(q, dtype=float)
        if q.ndim == 0 or q.shape[-1] != self.n:
            raise InputError(self.name, "shape of joint angles", q.shape, f"(..., {self.n})")
        out = np.empty((*q.shape[:-1], self.source_model.nq))
        for angle, joint in zip(np.moveaxis(q, -1, 0), self.source_model.joints[1:], strict=True):
            if joint.nq == 2:
                out[..., joint.idx_q] = np.cos(angle)
                out[..., joint.idx_q + 1] = np.sin(angle)
            else:
                out[..., joint.idx_q] = angle
        return out


def load_robot(
    spec: str | Path | pin.Model | RobotOptions,
    *,
    snap: bool = True,
    lock: Any = (),
    joints: Any = None,
    tip: str | None = None,
    gravity: Any = None,
    payload: Any = (),
    allow_massless: bool = False,
) -> Robot:
    """Load a robot arm, or the part of a robot that is one.

    Parameters
    ----------
    spec
        A built-in name (`builtin_robots`), the path of a URDF file, ``-`` for one from standard
        input, a Pinocchio model, or `RobotOptions`, which hold all that follows.
    snap
        Set angles within 1e-5 rad of a multiple of pi/2 (and axes and gravity within that of a
        coordinate axis) to exactly that; each such change is listed in ``snaps`` and bounded in
        ``snap_bound``. With False the arm is taken as Pinocchio reads it.
    lock
        Joints that stand still: a list of names or globs, each with ``=VALUE`` if wanted, or a
        mapping from names or globs to positions [rad or m]. Without a position a joint stands at
        0, or at the nearest place within its limits; one that follows a locked joint (mimic)
        stands still too, where that one puts it.
    joints
        The joints that move; all others are locked.
    tip
        Name of a link. Joints that are not between the root and it are locked; what they carry
        stays, as dead weight.
    gravity
        Gravitational acceleration in the frame of the root link, 3 numbers [m/s^2].
    payload
        What the robot carries: a mass [kg], ``"MASS[,x,y,z][@LINK]"`` with the centre in the frame
        of the link [m], or a list of those; without a link on the last one that moves.
    allow_massless
        Whether to accept a robot in which no joint feels gravity because links have no mass.

    Returns
    -------
    Robot

    Raises
    ------
    InputError
        For a file that is missing or not a URDF, joints that are not revolute and not locked, no
        moving joint, negative masses, numbers that are not finite, links that do not form a
        tree, and options that do not fit the robot. The message names file, joint or link, and
        what is accepted.

    Notes
    -----
    Links fixed to each other count as one body, so tools beyond the last joint are kept. A link
    without mass is legal. Joints are ordered as in Pinocchio. Joint angles are radians.

    Examples
    --------
    >>> robot = load_robot("2r")
    >>> robot.n, robot.joint_names, robot.snaps
    (2, ('shoulder', 'elbow'), ())
    >>> robot.tree.masses
    array([5., 5.])
    >>> load_robot("2r", lock={"elbow": 1.5}, payload=2).tree.masses
    array([12.])
    """
    if isinstance(spec, RobotOptions):
        options = spec
    elif not isinstance(spec, str | Path | pin.Model):
        accepted = "a built-in name, the path of a URDF file or a pinocchio.Model"
        raise InputError("robot", "type", type(spec).__name__, accepted)
    else:
        name = spec.name or "model" if isinstance(spec, pin.Model) else str(spec)
        options = RobotOptions(name, snap, lock, joints, tip, gravity, payload, allow_massless)
    snaps: tuple[Snap, ...] = ()
    if isinstance(spec, pin.Model):
        name = where = options.spec
        source = chosen_part_of_model(spec, options, where)
        body = as_read = _checked_body(source, where)
        links = bodies(as_read)
        if options.snap:
            body, snaps = snap_body(as_read)
    else:
        name, where, data = _read(options.spec)
        urdf = chosen_part(parse_urdf(data, where), options, where)
        name = name or urdf.name or Path(where).stem
        source = part_as_pinocchio_reads(_pinocchio_model(urdf, where), urdf, where)
        body = as_read = _checked_body(source, where)
        links = moving_links(urdf)
        if options.snap:
            body, snaps = snap_urdf(urdf, as_read.joint_names)
    known = not isinstance(spec, pin.Model) and options.spec in BUILT_IN
    warnings = () if known else check_masses(links, body, where, options.allow_massless)
    bound = torque_difference_bound(as_read.tree(), body.tree()) if snaps else np.zeros(body.n)
    return Robot(
        name=name,
        model=body.to_model(name),
        source_model=source,
        joint_names=body.joint_names,
        limits=body.limits,
        damping=body.damping,
        effort=body.efforts,
        snaps=snaps,
        snap_bound=bound,
        tree=body.tree(),
        digest=body.digest(),
        options=options,
        warnings=warnings,
    )


def robot_file(spec: str) -> bytes:
    """Return the contents of the file of a robot: of a built-in one, on disk, or standard input.

    Raises
    ------
    InputError
        If there is none that can be read.

    Examples
    --------
    >>> robot_file("2r")[:5]
    b'<?xml'
    """
    return _read(spec)[2]


def _checked_body(model: pin.Model, where: str) -> ArmBody:
    body = ArmBody.from_model(model, where)
    check_body(body, where)
    return body


def _read(where: str) -> tuple[str, str, bytes]:
    """Return built-in name (or nothing), what to call the file in errors, and its contents."""
    if where in BUILT_IN:
        return where, where, builtin_file(where)
    if where == STANDARD_INPUT:
        return "", "standard input", _standard_input(sys.stdin)
    path = Path(where)
    accepted = f"a URDF file or one of {', '.join(BUILT_IN)}"
    try:
        if not path.exists():
            raise InputError(where or "robot", "file", repr(where) + " (not found)", accepted)
        if not (path.is_file() or path.is_fifo()):
            raise InputError(where or "robot", "file", "a folder or a device", accepted)
        return "", where, path.read_bytes()
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(where, "file", f"not readable ({reason})", accepted) from None


@lru_cache(maxsize=1)
def _standard_input(stream: IO[str]) -> bytes:
    """Return all that comes from a stream, which can be read but once."""
    return stream.buffer.read()  # type: ignore[attr-defined]


def _pinocchio_model(urdf: Urdf, where: str) -> pin.Model:
    """Let Pinocchio read the description; what it refuses is bad input."""
    try:
        return pin.buildModelFromXML(urdf_text(urdf))
    except Exception as error:  # Boost.Python maps C++ exceptions to several types
        accepted = "a URDF that Pinocchio reads"
        raise InputError(where, "content", f"refused by Pinocchio ({error})", accepted) from None
