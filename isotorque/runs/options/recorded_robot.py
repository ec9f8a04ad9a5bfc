"""Recorded robot: its file and its options, as a run, a model or relations tell them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.runs.stages import DATABASE
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.files import write_whole
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.builtin_robots import builtin_robots
from isotorque.symbolic.robots.load_robot import Robot, load_robot, robot_file

ROBOT_FILE = "robot.urdf"
"""Copy of the robot's file in the directory of a run, for the commands that ask for it later."""


def keep_robot_file(robot: RobotOptions, out: Path) -> None:
    """Copy the file that a robot was loaded from; a built-in robot needs none.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    if robot.spec not in {builtin.name for builtin in builtin_robots()}:
        write_whole(out / ROBOT_FILE, robot_file(robot.spec))


def recorded_robot(run: Path, reader: RecordingReader) -> Robot:
    """Load the robot that a run was made with: its copy there, or a built-in one.

    Raises
    ------
    InputError
        If the run names a robot that is neither, or the file is another robot's.
    """
    kept = run / ROBOT_FILE
    accepted = f"the file of the robot recorded (digest {reader.digest[:12]})"
    if not kept.is_file() and reader.robot not in {robot.name for robot in builtin_robots()}:
        raise InputError(kept, "file", "missing", f"{accepted}; or --candidates with that file")
    spec = str(kept) if kept.is_file() else reader.robot
    robot = load_robot(as_recorded(RobotOptions(spec), run))
    if robot.digest == reader.digest:
        return robot
    found = f"{robot.name} (digest {robot.digest[:12]})"
    raise InputError(kept if kept.is_file() else run, "robot", found, accepted)


def as_recorded(robot: RobotOptions, path: Path) -> RobotOptions:
    """Return options of a robot; what is not given is as recorded in a run or a file.

    Parameters
    ----------
    robot
        As given.
    path
        The directory of a run, a ``model.json`` or a relations file. Where nothing is recorded,
        or cannot be read, the options are as given.
    """
    return robot.beside(RobotOptions.from_json(robot.spec, recorded_options(path), str(path)))


def recorded_options(path: Path) -> dict[str, Any]:
    """Return what `RobotOptions.as_json` said when a run or file was made."""
    if (path / DATABASE).is_file():
        with RecordingReader(path / DATABASE, check=False) as reader:
            for part in reader.parts:
                options = part.info.options
                snap = {} if options.get("made_with", {}).get("snap", True) else {"snap": False}
                return snap | dict(options.get("robot", {}))
    for file in (path / "model.json", path / "relations.json") if path.is_dir() else (path,):
        document = _document(file)
        found = document.get("robot_options", document.get("notes", {}).get("robot_options"))
        if found is not None:
            return found
    return {}


def _document(file: Path) -> dict[str, Any]:
    """Return an object as it was written; nothing where there is none, which others will tell."""
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    if not isinstance(document, dict) or not isinstance(document.get("notes", {}), dict):
        return {}
    return document
