"""Options of a robot: a name or file with everything that changes it."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Self

from isotorque.symbolic.common.errors import InputError

Triple = tuple[float, float, float]
Lock = tuple[str, float | None]

LOCK_FORM = "JOINT or JOINT=VALUE, a finite number [rad or m]"
PAYLOAD_FORM = "MASS[,x,y,z][@LINK], a mass >= 0 [kg] and a finite centre [m]"
GRAVITY_FORM = "x,y,z, three finite numbers [m/s^2]"


@dataclass(frozen=True)
class Payload:
    """A point mass that a robot carries.

    Attributes
    ----------
    mass : float
        Mass [kg].
    center : tuple of 3 floats
        Centre of mass in the frame of the link [m].
    link : str or None
        The link that carries it; None: the last moving one.
    """

    mass: float
    center: Triple = (0.0, 0.0, 0.0)
    link: str | None = None

    def __post_init__(self) -> None:
        finite = all(math.isfinite(x) for x in (self.mass, *self.center))
        if not finite or self.mass < 0 or self.link == "":
            raise InputError("robot", "--payload", str(self), PAYLOAD_FORM)

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read a payload as it stands on a command line.

        Raises
        ------
        InputError
            For anything else.

        Examples
        --------
        >>> Payload.parse("1.5,0,0,0.1@tool0")
        Payload(mass=1.5, center=(0.0, 0.0, 0.1), link='tool0')
        >>> str(Payload.parse("2"))
        '2.0'
        """
        numbers, at, link = text.partition("@")
        values = _numbers(numbers)
        if len(values) not in (1, 4):
            raise InputError("robot", "--payload", repr(text), PAYLOAD_FORM)
        x, y, z = values[1:] or (0.0, 0.0, 0.0)
        return cls(values[0], (x, y, z), link if at else None)

    def __str__(self) -> str:
        numbers = (self.mass, *self.center) if any(self.center) else (self.mass,)
        return ",".join(map(repr, numbers)) + ("" if self.link is None else f"@{self.link}")


@dataclass(frozen=True)
class RobotOptions:
    """A robot and the part of it that is meant; equal options give the same robot.

    Attributes
    ----------
    spec : str
        A built-in name, the path of a file, or ``-`` for standard input.
    snap : bool
        Whether rounded angles are snapped.
    lock : tuple of (str, float or None)
        Joints that do not move, by name or glob, and where each stands [rad or m]; None: at 0, or
        at the nearest position within its limits. The last entry that names a joint counts.
    joints : tuple of str or None
        The joints that move, by name or glob; all others are locked. None: no such choice.
    tip : str or None
        Joints that are not between the root and this link are locked. None: no such choice.
    gravity : tuple of 3 floats or None
        Gravitational acceleration in the frame of the root link [m/s^2]; None: the model's own,
        (0, 0, -9.81) for a file.
    payload : tuple of Payload
        What the robot carries.
    allow_massless : bool
        Whether a robot in which no joint feels gravity, for want of masses, is accepted.

    Notes
    -----
    ``lock`` may be given as a list of ``"JOINT"``, ``"JOINT=VALUE"``, or as a mapping from names
    to positions; ``joints`` as a list or in one text, with commas; ``gravity`` as a sequence or a
    text; ``payload`` as a mass, a text as on the command line, a `Payload`, or a list of those.

    Examples
    --------
    >>> RobotOptions("arm.urdf", lock=["finger_*", "lift=0.1"]).lock
    (('finger_*', None), ('lift', 0.1))
    >>> RobotOptions("arm.urdf", lock={"lift": 0.1}, payload=2).arguments()
    ['--lock', 'lift=0.1', '--payload', '2.0']
    """

    spec: str
    snap: bool = True
    lock: tuple[Lock, ...] = ()
    joints: tuple[str, ...] | None = None
    tip: str | None = None
    gravity: Triple | None = None
    payload: tuple[Payload, ...] = field(default=())
    allow_massless: bool = False

    def __post_init__(self) -> None:
        for name, read in (
            ("spec", str),
            ("lock", _locks),
            ("joints", _names),
            ("gravity", _gravity),
            ("payload", _payloads),
        ):
            object.__setattr__(self, name, read(getattr(self, name)))

    @classmethod
    def of(cls, robot: str | Path | RobotOptions) -> RobotOptions:
        """Return options as they are, or those of a robot that is only named."""
        return robot if isinstance(robot, RobotOptions) else cls(str(robot))

    @property
    def changed(self) -> dict[str, Any]:
        """What is not by default, the robot's name apart."""
        given = {f.name: getattr(self, f.name) for f in fields(self) if f.default is not MISSING}
        return {
            f.name: given[f.name]
            for f in fields(self)
            if f.name in given and given[f.name] != f.default
        }

    def beside(self, recorded: RobotOptions) -> RobotOptions:
        """Return these options; what is not given is as recorded.

        Examples
        --------
        >>> recorded = RobotOptions("a.urdf", snap=False, tip="hand")
        >>> RobotOptions("/b/a.urdf", payload=1).beside(recorded).arguments()
        ['--no-snap', '--tip', 'hand', '--payload', '1.0']
        """
        return replace(recorded, spec=self.spec, **self.changed)

    def arguments(self) -> list[str]:
        """Return the options as on a command line, the robot's name apart."""
        out = [] if self.snap else ["--no-snap"]
        for pattern, position in self.lock:
            out += ["--lock", pattern if position is None else f"{pattern}={position!r}"]
        if self.joints is not None:
            out += ["--joints", ",".join(self.joints)]
        if self.tip is not None:
            out += ["--tip", self.tip]
        if self.gravity is not None:
            out += ["--gravity", ",".join(map(repr, self.gravity))]
        for payload in self.payload:
            out += ["--payload", str(payload)]
        return out + ["--allow-massless"] * self.allow_massless

    def __str__(self) -> str:
        return shlex.join([self.spec, *self.arguments()])

    def as_json(self) -> dict[str, Any]:
        """Return what is not by default as plain data, the robot's name apart.

        Examples
        --------
        >>> RobotOptions("arm.urdf", lock=["finger_*"], gravity=(0, 0, -1.62)).as_json()
        {'lock': ['finger_*'], 'gravity': [0.0, 0.0, -1.62]}
        """
        out: dict[str, Any] = dict(self.changed)
        if "lock" in out:
            out["lock"] = [name if at is None else f"{name}={at!r}" for name, at in self.lock]
        if "payload" in out:
            out["payload"] = list(map(str, self.payload))
        return {key: list(x) if isinstance(x, tuple) else x for key, x in out.items()}

    @classmethod
    def from_json(cls, spec: str, data: Any, where: str = "robot options") -> RobotOptions:
        """Read what `as_json` returned.

        Raises
        ------
        InputError
            For anything else, naming the field.
        """
        kinds = {f.name: f for f in fields(cls) if f.name != "spec"}
        if not isinstance(data, Mapping):
            raise InputError(where, "content", repr(data), "an object")
        for key, value in data.items():
            if key not in kinds:
                raise InputError(where, "field", repr(key), ", ".join(kinds))
            kind = {"snap": bool, "allow_massless": bool, "tip": str}.get(key, list)
            if not isinstance(value, kind):
                raise InputError(where, key, repr(value), f"a {kind.__name__}")
        return cls(spec, **data)


def _locks(given: Any) -> tuple[Lock, ...]:
    if given is None:
        return ()
    if isinstance(given, str):
        given = [given]
    pairs = given.items() if isinstance(given, Mapping) else _list(given, "--lock", LOCK_FORM)
    out = []
    for pair in pairs:
        name, position = pair if isinstance(pair, tuple | list) and len(pair) == 2 else (pair, None)
        if not isinstance(name, str) or not name:
            raise InputError("robot", "--lock", repr(pair), LOCK_FORM)
        if isinstance(pair, str) and "=" in pair:
            name, _, text = pair.rpartition("=")
            values = _numbers(text)
            if not name or len(values) != 1:
                raise InputError("robot", "--lock", repr(pair), LOCK_FORM)
            position = values[0]
        if position is not None:
            position = _finite(position, "--lock", pair, LOCK_FORM)
        out.append((name, position))
    return tuple(out)


def _names(given: Any) -> tuple[str, ...] | None:
    if given is None:
        return None
    accepted = "names of joints, with commas"
    names = given.split(",") if isinstance(given, str) else _list(given, "--joints", accepted)
    if not names or not all(isinstance(name, str) and name.strip() for name in names):
        raise InputError("robot", "--joints", repr(given), accepted)
    return tuple(name.strip() for name in names)


def _gravity(given: Any) -> Triple | None:
    if given is None:
        return None
    values = _numbers(given) if isinstance(given, str) else list(given)
    if len(values) != 3:
        raise InputError("robot", "--gravity", repr(given), GRAVITY_FORM)
    x, y, z = (_finite(value, "--gravity", given, GRAVITY_FORM) for value in values)
    return x, y, z


def _payloads(given: Any) -> tuple[Payload, ...]:
    if given is None:
        return ()
    if isinstance(given, str | Payload) or not isinstance(given, Iterable):
        given = [given]
    out = []
    for one in given:
        if isinstance(one, str):
            one = Payload.parse(one)
        elif not isinstance(one, Payload):
            one = Payload(_finite(one, "--payload", one, PAYLOAD_FORM))
        out.append(one)
    return tuple(out)


def _list(given: Any, option: str, accepted: str) -> Sequence[Any]:
    if not isinstance(given, Iterable):
        raise InputError("robot", option, repr(given), accepted)
    return list(given)


def _finite(value: Any, option: str, given: Any, accepted: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise InputError("robot", option, repr(given), accepted)
    return number + 0.0


def _numbers(text: str) -> list[float]:
    """Return comma-separated finite numbers, nothing where there is anything else."""
    try:
        values = [float(part) + 0.0 for part in text.split(",")]
    except ValueError:
        return []
    return values if all(map(math.isfinite, values)) else []
