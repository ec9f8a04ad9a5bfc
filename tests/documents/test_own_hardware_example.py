"""The example of a user's own hardware records, is stopped, resumes, and writes a CSV."""

import numpy as np
import pytest

from examples.own_hardware import BenchPendulum, TorqueDrivenArm, main
from isotorque.learning.arm import Arm, OutcomeKind
from isotorque.learning.files.csv_samples import read_csv
from isotorque.learning.recordings.recording_reader import RecordingReader


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    path = tmp_path_factory.mktemp("hardware") / "pendulum.sqlite"
    main(path)
    return path


def test_the_example_measures_the_pendulum(recorded):
    samples = read_csv(recorded.with_suffix(".csv"), ["hinge"])
    assert len(samples.q) >= 5
    np.testing.assert_allclose(2.4 * np.sin(samples.q), samples.tau, atol=2e-3)
    with RecordingReader(recorded) as reader:
        assert reader.parts[0].finished
        assert {count.outcome for count in reader.counts()} == {"settled", "limit"}


def test_a_second_run_moves_nothing(recorded, capsys, monkeypatch):
    monkeypatch.setattr(BenchPendulum, "command", None)
    main(recorded)
    assert capsys.readouterr().out.count("as recorded") == 10


def test_a_stopped_run_goes_on(recorded, tmp_path, monkeypatch):
    class Stopped(BenchPendulum):
        commands = 0

        def command(self, torque):
            Stopped.commands += 1
            if Stopped.commands == 4:
                raise KeyboardInterrupt
            super().command(torque)

    path = tmp_path / "pendulum.sqlite"
    with monkeypatch.context() as patch:
        patch.setattr("examples.own_hardware.BenchPendulum", Stopped)
        with pytest.raises(KeyboardInterrupt):
            main(path)
    with RecordingReader(path) as reader:
        assert 1 <= reader.parts[0].commands < 4
    main(path)
    with RecordingReader(path) as reader, RecordingReader(recorded) as other:
        np.testing.assert_allclose(reader.samples().q, other.samples().q, atol=1e-3)


def test_limits_and_patience():
    arm = TorqueDrivenArm(BenchPendulum(), np.array([[-0.5, 0.5]]), patience=5.0)
    assert isinstance(arm, Arm)
    assert arm.apply(np.array([2.0])).kind is OutcomeKind.LIMIT
    assert abs(arm.q[0]) < 1e-2
    assert arm.apply(np.array([0.6])).kind is OutcomeKind.SETTLED
    hasty = TorqueDrivenArm(BenchPendulum(), np.array([[-0.5, 0.5]]), patience=0.1)
    assert hasty.apply(np.array([0.6])).kind is OutcomeKind.TIMEOUT
