"""Description of a run: all that must be equal for it to be continued."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from isotorque.symbolic.common.errors import InputError

_ENCODER = json.JSONEncoder(sort_keys=True, separators=(",", ":"), allow_nan=False)


def canonical_json(value: Any) -> str:
    """Write plain data in one way only: sorted keys, no spaces, floats that read back exactly."""
    return _ENCODER.encode(value)


def _plain(value: Any) -> Any:
    """Spell what JSON has no word for: arrays as lists, infinity as text (absent limits)."""
    if isinstance(value, Mapping):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, float) and math.isinf(value):
        return str(value)
    return value


def generator_state(rng: np.random.Generator) -> dict[str, Any]:
    """State of a random generator as plain data, any of NumPy's bit generators.

    Examples
    --------
    >>> state = generator_state(np.random.default_rng(1))
    >>> rng = np.random.default_rng()
    >>> rng.bit_generator.state = state
    >>> bool(rng.random() == np.random.default_rng(1).random())
    True
    """
    state: dict[str, Any] = _plain(rng.bit_generator.state)
    return state


@dataclass(frozen=True)
class RunInfo:
    """One part of a run: robot, simulation, seed and options.

    Attributes
    ----------
    robot : str
        Name of the robot, for people.
    digest : str
        Digest of its kinematics, inertias, limits and damping: the robot's identity.
    joint_names : tuple of str
        Joints in the order of all arrays of the recording; their number is n.
    physics, engine : str
        Physics mode and engine of the arm, or what stands for them on real hardware.
    seed : int or None
        Seed of the run.
    options : mapping
        All other options that change the result, those of the arm included: plain data (strings,
        numbers, booleans, None, lists, arrays, mappings with string keys).
    part : str
        Name of this part of the run. One file holds several parts of one robot, made one after
        the other (``discover``, then ``learn``), each with options and commands of its own.
    generator : mapping or None
        State of the run's random generator at its start, see ``generator_state``.

    Raises
    ------
    InputError
        If a value is not plain data or there is no joint.

    Examples
    --------
    >>> info = RunInfo("2r", "1f0c", ("shoulder", "elbow"), seed=1, options={"torques": 8})
    >>> other = RunInfo("2r", "1f0c", ("shoulder", "elbow"), seed=1, options={"torques": 9})
    >>> list(info.differences(other))
    [("option 'torques'", 8, 9)]
    """

    robot: str
    digest: str
    joint_names: tuple[str, ...]
    physics: str = "open_loop"
    engine: str = "compiled"
    seed: int | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    part: str = "run"
    generator: Mapping[str, Any] | None = None

    def __post_init__(self) -> None:
        # Plain text: members of enumerations would compare and print in another way.
        for name in ("robot", "digest", "physics", "engine", "part"):
            object.__setattr__(self, name, str(getattr(self, name)))
        object.__setattr__(self, "joint_names", tuple(self.joint_names))
        if not self.joint_names:
            raise InputError("run", "joint_names", self.joint_names, "at least one joint")
        if not self.part:
            raise InputError("run", "part", repr(self.part), "a name")
        for name in ("seed", "options", "generator"):
            value = getattr(self, name)
            try:
                # Through JSON and back, so that what is compared is what a file can hold.
                object.__setattr__(self, name, json.loads(canonical_json(_plain(value))))
            except (TypeError, ValueError) as error:
                accepted = "plain data: strings, numbers, booleans, None, lists, mappings"
                raise InputError("run", name, f"{value!r} ({error})", accepted) from error

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    def differences(self, other: RunInfo) -> Iterator[tuple[str, Any, Any]]:
        """Yield (what, here, there) for all that differs and matters to the result.

        The robot's name does not: its digest does.
        """
        if self.digest != other.digest:
            mine, theirs = (f"{x.robot} (digest {x.digest[:12]})" for x in (self, other))
            yield "robot", mine, theirs
        for name in ("joint_names", "part", "physics", "engine", "seed"):
            if getattr(self, name) != getattr(other, name):
                yield name, getattr(self, name), getattr(other, name)
        for key in sorted({*self.options, *other.options}):
            mine, theirs = (x.options.get(key, "not given") for x in (self, other))
            if canonical_json(mine) != canonical_json(theirs):
                yield f"option {key!r}", mine, theirs
        if self.generator != other.generator:
            yield "generator", self.generator, other.generator
