"""The stages of a run: their arms, random generators and parts of the recording."""

from __future__ import annotations

from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from isotorque.learning.discovery.home_torque import holds_itself
from isotorque.learning.exploration.guided_arm import LimitedGuidedArm
from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.learning.simulator.settings import PhysicsMode, SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.runs.options.run_options import ArmOptions
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.load_robot import Robot

DATABASE = "run.sqlite"
TRIAL = 2
"""Stage before the others, that nothing is kept of."""
SENSORS = 100
"""Generators of sensors are numbered from here on."""


def random_generator(options: ArmOptions, stage: int) -> np.random.Generator:
    """Return the generator of a stage: learning does not depend on how long discovery took."""
    return np.random.default_rng(np.random.SeedSequence(options.seed, spawn_key=(stage,)))


def simulated_arm(robot: Robot, options: ArmOptions, stage: int) -> SimulatedArm:
    """Return the arm of a stage; its sensors have a generator of their own."""
    # who holds a guided arm measures torques of the same standard deviation
    held = np.sqrt(3.0) * options.torque_noise * (options.physics == PhysicsMode.GUIDED)
    noise = SensorNoise(
        options.angle_noise, options.torque_noise, options.encoder_step, float(held)
    )
    return SimulatedArm(
        robot,
        physics=options.physics,
        engine=options.engine,
        settle=options.settle,
        noise=noise,
        rng=random_generator(options, SENSORS + stage) if noise.is_random else None,
    )


def cannot_hold_itself(robot: Robot, options: ArmOptions) -> bool:
    """Say whether an arm has to be guided: no torque keeps it where it is put."""
    guided = replace(options, physics=PhysicsMode.GUIDED.value)
    arm = LimitedGuidedArm(simulated_arm(robot, guided, TRIAL), robot.limits)
    return not holds_itself(arm, random_generator(options, TRIAL))


def run_info(
    robot: Robot, arm: SimulatedArm, options: ArmOptions, part: str, more: dict[str, Any]
) -> RunInfo:
    """Return what a part of a run is made with, for its recording."""
    return RunInfo(
        robot.name,
        robot.digest,
        robot.joint_names,
        options.physics,
        options.engine,
        options.seed,
        {**more, **robot_facts(robot.options, options), "arm": arm.settings.as_json()},
        part,
    )


def robot_facts(robot: RobotOptions, options: ArmOptions) -> dict[str, Any]:
    """Return what a recording says of robot and arm, the robot's name and digest apart."""
    part = robot.as_json()
    made_with = asdict(options) | {"snap": part.pop("snap", True)}
    # recordings of whole robots stay as they were before there were parts
    return {"made_with": made_with} | ({"robot": part} if part else {})


def recorded_discovery(out: Path) -> tuple[ArmOptions, int, int, dict[str, Any]] | None:
    """Return arm, n_min, confirm, settings of the discovery that ``out`` already holds, if any."""
    path = out / DATABASE
    if not path.is_file():
        return None
    with RecordingReader(path, check=False) as reader:
        for part in reader.parts:
            if part.info.part == "discover":
                recorded = part.info.options
                names = {f.name for f in fields(ArmOptions)}
                arm = ArmOptions(**{k: v for k, v in recorded["made_with"].items() if k in names})
                confirm = int(recorded.get("confirm", 0))
                return arm, int(recorded["n_min"]), confirm, recorded.get("settings", {})
    return None
