"""The simulated arm, recorded: stopped runs resume bit for bit, with noise and every command."""

import shutil

import numpy as np
import pytest

from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.recordings.recorded_command import CommandKind
from isotorque.learning.recordings.recorded_simulation import RecordedSimulation
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.learning.simulator.settings import SensorNoise
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.recordings.recording_tools import tables

NOISE = SensorNoise(angle=1e-3, torque=1e-2, encoder_step=1e-4, holding_torque=5e-3)


@pytest.fixture(scope="module")
def robot():
    return load_robot("2r")


def new_arm(robot, physics):
    return SimulatedArm(robot, physics, noise=NOISE, rng=np.random.default_rng(3))


def info_of(arm):
    return RunInfo(
        arm.robot.name,
        arm.robot.digest,
        arm.robot.joint_names,
        arm.physics,
        arm.engine,
        seed=1,
        options={"arm": arm.settings.as_json()},
    )


def work(arm, guided, rounds=6):
    """Give every command there is; torques depend on what was seen before."""
    rng = np.random.default_rng(1)
    for _ in range(rounds):
        torque = rng.uniform([-26, -8], [26, 8]) + arm.q
        outcome = arm.apply(torque)
        yield [*outcome.q, *outcome.torque, outcome.seconds]
        played = arm.play(np.linspace(torque, 0.2 * torque, 4), 0.1)
        yield [*played.times, *played.q.ravel(), *played.torques.ravel(), *played.outcome.q]
        held = arm.place_and_hold(np.clip(outcome.q, -3, 3), torque, 1.0)
        yield [held.held, held.distance, *held.q]
        release = arm.release_test(outcome.q, torque, rng.choice([None, 0.5]))
        yield [release.balanced, *release.acceleration]
        if guided:
            arm.place(rng.uniform(-3, 3, 2))
            yield [*arm.q]
            held = arm.hold()
            yield [*held.q, *held.torque, held.seconds]
        arm.go_home()
        yield [*arm.q]


def as_bytes(steps):
    return [np.array(step, dtype=float).tobytes() for step in steps]


@pytest.mark.parametrize("physics", ["open_loop", "guided"])
def test_a_simulation_killed_anywhere_resumes_bit_for_bit(tmp_path, robot, physics):
    guided = physics == "guided"
    bare = as_bytes(work(new_arm(robot, physics), guided))
    info = info_of(new_arm(robot, physics))
    whole = tmp_path / "whole.sqlite"
    copies = []
    with Recording.create(whole, info) as recording:
        seen = []
        for step in work(RecordedSimulation(new_arm(robot, physics), recording), guided):
            seen.append(np.array(step, dtype=float).tobytes())
            copies.append(tmp_path / f"killed{len(seen)}.sqlite")
            for suffix in ("", "-wal"):
                shutil.copy(f"{whole}{suffix}", f"{copies[-1]}{suffix}")
    assert seen == bare
    for path in copies[::3]:
        with Recording.open(path, info) as recording:
            arm = RecordedSimulation(new_arm(robot, physics), recording)
            assert as_bytes(work(arm, guided)) == bare
        assert tables(path) == tables(whole)


def test_what_was_held_is_a_sample_and_what_was_tested_is_not(tmp_path, robot):
    path = tmp_path / "run.sqlite"
    arm = new_arm(robot, "guided")
    with Recording.create(path, info_of(arm)) as recording:
        recorded = RecordedSimulation(arm, recording, phase="test")
        recorded.place([1.0, -2.0])
        held = recorded.hold()
        hold = recorded.place_and_hold([1.0, -2.0], held.torque)
        release = recorded.release_test([0.5, 0.5], [1.0, 2.0])
    with RecordingReader(path) as reader:
        samples = reader.samples()
        np.testing.assert_array_equal(samples.q, [held.q])
        np.testing.assert_array_equal(samples.tau, [held.torque])
        np.testing.assert_array_equal(samples.commanded, [held.torque])
        *_, first, second = reader.commands()
    assert first.kind is CommandKind.PLACE_AND_HOLD
    np.testing.assert_array_equal(first.argument, [1.0, -2.0, *held.torque, 5.0, 0.05])
    np.testing.assert_array_equal(first.result, [hold.held, hold.distance, *hold.q])
    np.testing.assert_array_equal(second.argument, [0.5, 0.5, 1.0, 2.0, np.nan])
    np.testing.assert_array_equal(second.result, [release.balanced, *release.acceleration])


def test_an_arm_that_cannot_be_placed_says_so(tmp_path, robot):
    arm = new_arm(robot, "open_loop")
    with Recording.create(tmp_path / "run.sqlite", info_of(arm)) as recording:
        with pytest.raises(InputError, match="guided"):
            RecordedSimulation(arm, recording).place([0.0, 0.0])
        assert recording.length == 1
