"""The robot's file, kept in the directory of a run for the commands that ask for it later."""

from __future__ import annotations

from pathlib import Path

from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.runs.options.recorded_robot import as_recorded
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.files import write_whole
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.builtin_robots import builtin_robots
from isotorque.symbolic.robots.load_robot import Robot, load_robot, robot_file

ROBOT_FILE = "robot.urdf"


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
