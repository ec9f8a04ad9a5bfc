"""Readers see samples as arrays, counted apart, also while a run is being written."""

import itertools
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from isotorque.learning.arm import OutcomeKind, Settled
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recorded_command import CommandKind
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_error import RecordingError
from isotorque.learning.recordings.recording_reader import RecordingReader
from tests.learning.recordings.recording_tools import INFO, ToyArm, explore

ROOT = Path(__file__).parents[3]


def test_samples_are_the_settled_outcomes_in_order(tmp_path):
    path = tmp_path / "run.sqlite"
    rng = np.random.default_rng(4)
    given, outcomes = [], []
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording, phase="discovery")
        for number in range(60):
            arm.phase = "discovery" if number < 20 else "learning"
            arm.label = number // 7 if number % 2 else None
            torques = rng.uniform(-2, 2, (1 + number % 3, 2))
            outcome = (
                arm.apply(torques[-1]) if len(torques) == 1 else arm.play(torques, 0.5).outcome
            )
            given.append((number, torques[-1], arm.phase, arm.label))
            outcomes.append(outcome)
    settled = [k for k, outcome in enumerate(outcomes) if outcome.kind is OutcomeKind.SETTLED]
    assert 20 < len(settled) < 60
    with RecordingReader(path) as reader:
        samples = reader.samples()
        np.testing.assert_array_equal(samples.q, [outcomes[k].q for k in settled])
        np.testing.assert_array_equal(samples.tau, [outcomes[k].torque for k in settled])
        np.testing.assert_array_equal(samples.commanded, [given[k][1] for k in settled])
        np.testing.assert_array_equal(samples.seconds, [outcomes[k].seconds for k in settled])
        assert samples.numbers.tolist() == [k + 1 for k in settled]
        assert samples.phases.tolist() == [given[k][2] for k in settled]
        assert samples.labels.tolist() == [
            -1 if given[k][3] is None else given[k][3] for k in settled
        ]
        discovery = reader.samples(phase="discovery")
        assert discovery.numbers.tolist() == [k + 1 for k in settled if k < 20]
        assert reader.samples(part="run").q.shape == samples.q.shape
        assert reader.samples(phase="test").q.shape == (0, 2)
        counts = reader.counts()
        assert sum(count.commands for count in counts) == 60
        for kind in OutcomeKind:
            found = [outcome for outcome in outcomes if outcome.kind is kind]
            told = [count for count in counts if count.outcome is kind]
            assert sum(count.commands for count in told) == len(found)
            assert sum(c.seconds for c in told) == pytest.approx(sum(o.seconds for o in found))
        assert {count.phase for count in counts} == {"discovery", "learning"}
        with pytest.raises(RecordingError, match=r"part is 'none'; accepted: one of \['run'\]"):
            reader.samples(part="none")


def test_commands_and_trajectories_come_back(tmp_path):
    path = tmp_path / "run.sqlite"
    profile = np.random.default_rng(0).normal(size=(5, 2))
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        played = arm.play(profile, 0.25)
        arm.go_home()
        home = arm.q
    with RecordingReader(path) as reader:
        assert (reader.robot, reader.digest, reader.joint_names) == (
            "toy",
            INFO.digest,
            INFO.joint_names,
        )
        start, play, go_home = reader.commands()
        assert start.kind is CommandKind.START
        assert start.outcome is None
        assert play.kind is CommandKind.PLAY
        np.testing.assert_array_equal(play.argument, profile[-1])
        np.testing.assert_array_equal(go_home.q_after, home)
        again = reader.playback(1)
        np.testing.assert_array_equal(again.times, played.times)
        np.testing.assert_array_equal(again.q, played.q)
        np.testing.assert_array_equal(again.torques, played.torques)
        assert again.outcome.kind is played.outcome.kind
        for number in (0, 2, 3):
            with pytest.raises(RecordingError, match="the number of a torque profile"):
                reader.playback(number)


@settings(max_examples=25)
@given(arrays(np.float64, (12, 2), elements=st.sampled_from([-1.5, 1.5, -0.25, 0.25, 0.0, -0.0])))
def test_groups_share_their_absolute_torque(tmp_path_factory, torques):
    path = tmp_path_factory.mktemp("run") / "run.sqlite"

    class Obedient(ToyArm):
        def apply(self, torque):
            return Settled(np.zeros(2), torque, 1.0)

    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(Obedient(), recording)
        for torque in torques:
            arm.apply(torque)
    with RecordingReader(path) as reader:
        groups = reader.samples().torque_groups()
    absolute = [tuple(row) for row in np.abs(torques)]
    order = list(dict.fromkeys(absolute))
    assert groups.tolist() == [order.index(row) for row in absolute]


def test_reading_while_writing_sees_every_committed_command(tmp_path):
    path = tmp_path / "run.sqlite"
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        with RecordingReader(path) as reader:
            for number, _ in enumerate(explore(arm, ["apply", "play", "home"] * 8, 1), 1):
                assert reader.parts[0].commands == number
                assert len(list(reader.commands())) == number + 1
            half_read = reader.commands()
            list(itertools.islice(half_read, 5))
            arm.apply([0.0, 0.0])  # a slow reader does not hold the writer up
            assert len(list(half_read)) == 20  # and goes on seeing what it began with
        with recording.reader() as other:
            assert other.parts[0].commands == 25
    assert [p.name for p in tmp_path.iterdir()] == ["run.sqlite"]


def test_another_process_reads_while_this_one_writes(tmp_path):
    path = tmp_path / "run.sqlite"
    script = (
        "import sys; from isotorque.learning.recordings.recording_reader import RecordingReader\n"
        "with RecordingReader(sys.argv[1]) as reader:\n"
        "    for line in sys.stdin:\n"
        "        print(reader.parts[0].commands, flush=True)\n"
    )
    with Recording.create(path, INFO) as recording:
        arm = RecordedArm(ToyArm(), recording)
        with subprocess.Popen(
            [sys.executable, "-c", script, path],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        ) as child:
            for number, _ in enumerate(explore(arm, ["apply"] * 20, 1), 1):
                child.stdin.write("?\n")
                child.stdin.flush()
                assert int(child.stdout.readline()) == number
            child.stdin.close()
    assert child.returncode == 0
    assert [p.name for p in tmp_path.iterdir()] == ["run.sqlite"]


def test_a_reader_left_open_keeps_nothing_from_being_complete(tmp_path):
    path = tmp_path / "run.sqlite"
    recording = Recording.create(path, INFO)
    reader = RecordingReader(path)
    list(explore(RecordedArm(ToyArm(), recording), ["apply"] * 9, 1))
    recording.close()
    assert reader.parts[0].commands == 9
    with Recording.open(path, INFO) as again:  # the lock is free although a reader is there
        assert again.length == 10
    reader.close()
    assert [p.name for p in tmp_path.iterdir()] == ["run.sqlite"]


def test_checkpoints_are_read_by_name_and_part(tmp_path):
    path = tmp_path / "run.sqlite"
    with Recording.create(path, INFO) as recording:
        recording.save_checkpoint("net", {"w": [1, 2], "b": np.eye(2)})
    with RecordingReader(path) as reader:
        checkpoint = reader.checkpoint("net")
        np.testing.assert_array_equal(checkpoint.arrays["b"], np.eye(2))
        assert checkpoint.number == 0
        assert reader.checkpoint("net", part="run").arrays["w"].tolist() == [1, 2]
        assert reader.checkpoint("other") is None


def test_a_reader_may_be_closed_in_the_middle_of_reading(tmp_path):
    path = tmp_path / "run.sqlite"
    with Recording.create(path, INFO) as recording:
        list(explore(RecordedArm(ToyArm(), recording), ["apply"] * 5, 1))
    with RecordingReader(path) as reader:
        commands = reader.commands()
        next(commands)
    commands.close()  # quietly, like any generator


def test_paths_with_special_characters(tmp_path):
    path = tmp_path / "50% a?b#c é.sqlite"
    with Recording.create(str(path), INFO) as recording:
        RecordedArm(ToyArm(), recording).apply([0.1, 0.2])
    with RecordingReader(str(path)) as reader:
        assert reader.parts[0].commands == 1
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
