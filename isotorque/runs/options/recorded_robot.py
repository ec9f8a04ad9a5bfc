"""Which part of a robot a run, a model or relations are about, as recorded."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.runs.stages import DATABASE
from isotorque.symbolic.common.robot_options import RobotOptions


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
