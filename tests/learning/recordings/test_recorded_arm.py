"""Recorded arms: a stopped run ends as if never stopped, whatever stands behind the arm."""

import itertools
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.arm import Arm, OutcomeKind, ProfileArm, Settled
from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_error import RecordingError
from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.symbolic.common.errors import InputError
from tests.learning.recordings.recording_tools import INFO, ToyArm, explore, files, tables

COMMANDS = st.lists(st.sampled_from(["apply", "apply", "apply", "play", "home"]), max_size=25)


def through(path, commands, seed):
    with Recording.open_or_create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        seen = list(explore(arm, commands, seed))
        arm.finish()
    return seen


class Interrupting(ToyArm):
    """Is stopped by ctrl-C at a given motion, before or after the arm moved."""

    def __init__(self, at, late):
        super().__init__()
        self.at, self.late = at, late

    def apply(self, torque):
        if self.motions + 1 < self.at:
            return super().apply(torque)
        if self.late:
            super().apply(torque)
        raise KeyboardInterrupt


@settings(max_examples=40)
@given(COMMANDS, st.integers(0, 9))
def test_recording_changes_nothing_an_algorithm_sees(tmp_path_factory, commands, seed):
    path = tmp_path_factory.mktemp("run") / "run.sqlite"
    assert through(path, commands, seed) == list(explore(ToyArm(), commands, seed))


@settings(max_examples=40)
@given(
    COMMANDS,
    st.integers(0, 9),
    st.lists(st.tuples(st.integers(1, 30), st.booleans()), min_size=1, max_size=4),
)
def test_interrupted_runs_end_as_uninterrupted_ones(tmp_path_factory, commands, seed, stops):
    directory = tmp_path_factory.mktemp("run")
    whole, pieces = directory / "whole.sqlite", directory / "pieces.sqlite"
    expected = through(whole, commands, seed)
    for at, late in stops:
        with Recording.open_or_create(pieces, INFO) as recording:
            arm = RecordedArm(Interrupting(at, late), recording)
            seen = []
            try:
                seen.extend(explore(arm, commands, seed))
            except KeyboardInterrupt:
                with pytest.raises(RecordingError, match="interrupted"):
                    arm.go_home()
            assert seen == expected[: len(seen)]
    assert through(pieces, commands, seed) == expected
    assert tables(pieces) == tables(whole)


@settings(max_examples=25)
@given(COMMANDS, st.integers(0, 9), st.data())
def test_what_a_kill_leaves_behind_resumes(tmp_path_factory, commands, seed, data):
    # A copy of the files in the middle of a run is what SIGKILL leaves at that moment.
    directory = tmp_path_factory.mktemp("run")
    path, killed = directory / "run.sqlite", directory / "killed.sqlite"
    stop = data.draw(st.integers(0, len(commands)))
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        list(itertools.islice(explore(arm, commands, seed), stop))
        for suffix in ("", "-wal"):
            shutil.copy(f"{path}{suffix}", f"{killed}{suffix}")
    with Recording.open(killed, INFO) as recording:
        assert recording.length == stop + 1
    assert through(killed, commands, seed) == through(directory / "whole.sqlite", commands, seed)


def test_replay_moves_nothing_and_changes_no_bit_of_the_file(tmp_path):
    path = tmp_path / "run.sqlite"
    commands = ["apply", "play", "home"] * 10
    expected = through(path, commands, 3)
    with Recording.open(path, INFO) as recording:
        recording.save_checkpoint("net", {"w": [2.0]})
    before = files(path)
    toy = ToyArm()
    with Recording.open(path, INFO) as recording:
        assert recording.is_finished
        arm = RecordedArm(toy, recording)
        assert arm.is_replaying
        arm.save_checkpoint("net", {"w": [1.0]})
        assert list(explore(arm, commands, 3)) == expected
        arm.save_checkpoint("net", {"w": [2.0]})
        assert not arm.is_replaying
        arm.finish()
    assert toy.motions == 0
    assert files(path) == before


def test_a_replay_needs_no_arm(tmp_path):
    path = tmp_path / "run.sqlite"
    expected = through(path, ["apply"] * 5, 3)
    with Recording.open(path, INFO) as recording:
        arm = RecordedArm(None, recording)
        assert list(explore(arm, ["apply"] * 5, 3)) == expected
        with pytest.raises(RecordingError, match="command 6 is apply, which the recording does"):
            arm.apply([0.0, 0.0])


@settings(max_examples=30)
@given(st.integers(1, 64), st.booleans())
def test_one_other_bit_in_a_torque_is_noticed(tmp_path_factory, bit, first):
    path = tmp_path_factory.mktemp("run") / "run.sqlite"
    torque = np.array([1.25, -0.5])
    with Recording.create(path, INFO) as recording:
        RecordedArm(ToyArm(), recording).apply(torque)
    other = torque.copy()
    other.view(np.uint64)[0 if first else 1] ^= np.uint64(1) << np.uint64(bit - 1)
    with Recording.open(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        if np.isfinite(other).all():
            with pytest.raises(RecordingError, match="made with other options"):
                arm.apply(other)
            with pytest.raises(RecordingError, match="interrupted"):
                arm.apply(torque)  # after a contradiction nothing goes on by chance


@pytest.mark.parametrize("change", ["kind", "phase", "label", "profile", "step", "early end"])
def test_a_run_that_asks_for_something_else_is_refused(tmp_path, change):
    path = tmp_path / "run.sqlite"
    profile = np.array([[0.1, 0.2], [0.3, 0.4]])
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording, phase="discovery")
        arm.play(profile, 0.5)
    before = files(path)
    with Recording.open(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording, phase="test" if change == "phase" else "discovery")
        arm.label = 3 if change == "label" else None
        ask = {
            "kind": lambda: arm.apply(profile[-1]),
            "early end": arm.finish,
            "profile": lambda: arm.play(profile[[1, 1]], 0.5),
            "step": lambda: arm.play(profile, 0.25),
        }.get(change, lambda: arm.play(profile, 0.5))
        with pytest.raises(RecordingError, match="made with other options"):
            ask()
    assert files(path) == before


def test_without_trajectories_live_and_replayed_playbacks_are_both_empty(tmp_path):
    path = tmp_path / "run.sqlite"
    for _ in range(2):
        with Recording.open_or_create(path, INFO) as recording:
            arm = RecordedArm(ToyArm(), recording, trajectories=False)
            played = arm.play(np.ones((6, 2)), 0.5)
        assert played.times.shape == (0,)
        assert played.q.shape == played.torques.shape == (0, 2)
        assert played.outcome.q.shape == (2,)


def test_an_algorithm_can_go_on_from_a_checkpoint(tmp_path):
    path = tmp_path / "run.sqlite"
    rng = np.random.default_rng(0)
    torques = rng.uniform(-1, 1, (20, 2))
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        for torque in torques[:9]:
            arm.apply(torque)
        arm.save_checkpoint("sum", {"total": torques[:9].sum(axis=0)})
        seen = [arm.apply(torque).q for torque in torques[9:]]
    with Recording.open(path, INFO) as recording:
        checkpoint = recording.load_checkpoint("sum")
        assert checkpoint.number == 9
        arm = RecordedArm(None, recording, start=checkpoint.number)
        np.testing.assert_array_equal([arm.apply(torque).q for torque in torques[9:]], seen)
        with pytest.raises(RecordingError, match="number to start from is 21"):
            RecordedArm(None, recording, start=21)
        with pytest.raises(RecordingError, match="number to start from is -1"):
            RecordedArm(None, recording, start=-1)


def test_a_checkpoint_of_a_replay_does_not_replace_a_later_one(tmp_path):
    with Recording.create(tmp_path / "run.sqlite", INFO) as recording:
        for number, value in ((5, 1.0), (3, 2.0)):
            recording.save_checkpoint("net", {"w": [value]}, number)
        assert recording.load_checkpoint("net").arrays["w"] == [1.0]
        recording.save_checkpoint("net", {"w": [3.0]}, 5)
        assert recording.load_checkpoint("net").arrays["w"] == [3.0]
        assert recording.load_checkpoint("other") is None


def test_a_mutated_answer_does_not_reach_arm_or_recording(tmp_path):
    path = tmp_path / "run.sqlite"
    for _ in range(2):
        with Recording.open_or_create(path, INFO) as recording:
            arm = RecordedArm(ToyArm(), recording)
            outcome = arm.apply([0.1, 0.2])
            outcome.q[:] = 99.0
            arm.q[:] = 99.0
            assert abs(arm.q).max() < 2.0


def test_every_kind_of_outcome_comes_back(tmp_path):
    path = tmp_path / "run.sqlite"
    through(path, ["apply"] * 60, 0)
    with RecordingReader(path) as reader:
        kinds = {command.outcome.kind for command in reader.commands() if command.outcome}
    assert kinds == set(OutcomeKind)


def test_parts_of_one_run_have_commands_and_options_of_their_own(tmp_path):
    path = Path(tmp_path / "run.sqlite")
    learn = RunInfo("toy", INFO.digest, INFO.joint_names, seed=2, part="learn")
    expected = {}
    for info, stop in ((INFO, 4), (learn, 6), (INFO, 8), (learn, 8)):
        with Recording.open_or_create(path, info) as recording:
            arm = RecordedArm(ToyArm(), recording)
            expected[info.part] = list(explore(arm, ["apply"] * stop, info.seed))
    for info in (INFO, learn):
        assert expected[info.part] == list(explore(ToyArm(), ["apply"] * 8, info.seed))
    with RecordingReader(path) as reader:
        assert [(p.info, p.commands, p.finished) for p in reader.parts] == [
            (INFO, 8, False),
            (learn, 8, False),
        ]


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
