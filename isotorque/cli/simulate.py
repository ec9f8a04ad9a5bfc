"""``isotorque simulate``: apply a torque to a simulated arm and wait."""

from __future__ import annotations

from typing import Annotated

import typer

from isotorque.cli.options import (
    AngleNoise,
    EncoderStep,
    Engine,
    Json,
    Physics,
    Quiet,
    Seed,
    Settle,
    TorqueNoise,
    numbers,
)
from isotorque.cli.output import emit_json, row, say_if_first
from isotorque.cli.robot_options import RobotName, about, load, takes_robot


@takes_robot()
def simulate(
    robot: RobotName,
    torque: Annotated[
        str,
        typer.Option("--torque", metavar="T1,T2,..", help="Torque [N m].", show_default=False),
    ],
    start: Annotated[
        str | None,
        typer.Option(
            "--from", metavar="Q1,Q2,..", help="Start, at rest [rad].", show_default="home"
        ),
    ] = None,
    physics: Physics = "open_loop",
    engine: Engine = "compiled",
    settle: Settle = "finished",
    seed: Seed = 0,
    angle_noise: AngleNoise = 0.0,
    torque_noise: TorqueNoise = 0.0,
    encoder_step: EncoderStep = 0.0,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Apply a constant torque and wait until the arm settles, hits a limit or time is up."""
    import numpy as np

    from isotorque.learning.discovery.torque_limits import check_torque
    from isotorque.learning.simulator.settings import SensorNoise
    from isotorque.learning.simulator.simulated_arm import SimulatedArm

    loaded = load(robot, quiet)
    tau = numbers(torque, "--torque", loaded.n)
    check_torque(loaded.name, "--torque", tau, loaded.effort, loaded.joint_names)
    q0 = None if start is None else numbers(start, "--from", loaded.n)
    say_if_first(quiet)
    arm = SimulatedArm(
        loaded,
        physics=physics,
        engine=engine,
        settle=settle,
        noise=SensorNoise(angle_noise, torque_noise, encoder_step),
        rng=np.random.default_rng(seed),
        q0=q0,
    )
    outcome = arm.apply(tau)
    if json:
        emit_json(
            {
                **about(loaded),
                "physics": physics,
                "engine": engine,
                "outcome": str(outcome.kind),
                "q": outcome.q,
                "torque": outcome.torque,
                "seconds_simulated": outcome.seconds,
            }
        )
        return
    print(f"{outcome.kind} at q = {row(outcome.q)} after {outcome.seconds:.3g} s")
