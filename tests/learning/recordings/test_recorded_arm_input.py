"""What a recorded arm takes and gives, whatever stands behind it."""

import numpy as np
import pytest

from isotorque.learning.arm import Arm, ProfileArm, Settled
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_error import RecordingError
from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.symbolic.common.errors import InputError
from tests.learning.recordings.recording_tools import INFO, ToyArm


class Hardware:
    """Has neither ``state`` nor ``restore``, and answers with whatever numbers it likes."""

    def __init__(self):
        self.q = [0.0, 0.0]
        self.homes = 0

    def apply(self, torque):
        self.q = [int(10 * x) for x in torque]
        return Settled(np.array(self.q, dtype=np.float32), torque.astype(np.float32), 1)

    def go_home(self):
        self.homes += 1
        self.q = [7, 8]


def test_hardware_that_cannot_be_put_back_goes_home_on_resuming(tmp_path):
    path = tmp_path / "run.sqlite"
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(Hardware(), recording)
        assert isinstance(arm, Arm)
        assert isinstance(arm, ProfileArm)
        first = arm.apply([1.0, 2.0])
        assert first.q.dtype == np.float64
    hardware = Hardware()
    with Recording.open(path, INFO) as recording:
        arm = RecordedArm(hardware, recording)
        again = arm.apply([1.0, 2.0])
        np.testing.assert_array_equal(arm.q, [10.0, 20.0])
        assert hardware.homes == 0
        arm.apply([3.0, 3.0])
        assert hardware.homes == 1
    np.testing.assert_array_equal(again.q, first.q)
    with RecordingReader(path) as reader:
        assert len(reader.samples().q) == 2


def test_bad_torques_are_refused_and_leave_the_run_going(tmp_path):
    with Recording.create(tmp_path / "run.sqlite", INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        for torque in ([1.0], [np.nan, 0.0], [[1.0, 2.0]]):
            with pytest.raises(InputError, match="torque is"):
                arm.apply(torque)
        with pytest.raises(InputError, match="shape of torques"):
            arm.play([1.0, 2.0], 0.1)
        with pytest.raises(InputError, match="torques is not finite"):
            arm.play([[np.inf, 2.0]], 0.1)
        arm.apply([0.0, 0.0])
        assert recording.length == 2


def test_an_arm_that_answers_nonsense_is_stopped(tmp_path):
    class Broken(ToyArm):
        def apply(self, torque):
            return Settled(np.array([0.0, np.nan]), torque, 1.0)

    with Recording.create(tmp_path / "run.sqlite", INFO) as recording:
        arm = RecordedArm(Broken(), recording)
        with pytest.raises(InputError, match="observed q"):
            arm.apply([0.0, 0.0])
        assert recording.length == 1
        with pytest.raises(RecordingError, match="interrupted"):
            arm.apply([0.0, 0.0])
