"""Samples from elsewhere enter a recording like those of an arm."""

import dataclasses

import numpy as np
import pytest

from isotorque.learning.files.csv_samples import read_csv, write_csv
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recorded_data import record_samples
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.recordings.recording_error import RecordingError
from isotorque.learning.recordings.recording_reader import RecordingReader
from isotorque.symbolic.common.errors import InputError
from tests.learning.recordings.recording_tools import INFO, ToyArm, files

DATA = dataclasses.replace(INFO, part="data", physics="measured", engine="none", seed=None)


@pytest.fixture
def samples():
    rng = np.random.default_rng(0)
    return StaticSamples(rng.normal(size=(7, 2)), rng.normal(size=(7, 2)))


def test_samples_of_a_csv_stand_beside_those_of_an_arm(tmp_path, samples):
    write_csv(tmp_path / "arm.csv", samples, INFO.joint_names)
    path = tmp_path / "run.sqlite"
    with Recording.create(path, INFO) as recording:
        RecordedArm(ToyArm(), recording).apply([0.1, 0.2])
    with Recording.open(path, DATA) as recording:
        record_samples(recording, read_csv(tmp_path / "arm.csv", INFO.joint_names), "measured")
        recording.finish()
    with RecordingReader(path) as reader:
        assert len(reader.samples().q) == 8
        found = reader.samples(part="data")
        np.testing.assert_array_equal(found.q, samples.q)
        np.testing.assert_array_equal(found.tau, samples.tau)
        np.testing.assert_array_equal(found.commanded, samples.tau)
        assert np.isnan(found.seconds).all()
        assert set(found.phases) == {"measured"}
        assert reader.parts[1].finished
        assert {count.outcome for count in reader.counts()} == {"settled"}


def test_the_same_samples_again_change_nothing_and_others_are_refused(tmp_path, samples):
    path = tmp_path / "run.sqlite"
    with Recording.create(path, DATA) as recording:
        record_samples(recording, samples)
    before = files(path)
    other = StaticSamples(samples.q, samples.tau + 1e-12)
    with Recording.open(path, DATA) as recording:
        record_samples(recording, samples)
        for wrong in (other, StaticSamples(samples.q[:3], samples.tau[:3])):
            with pytest.raises(RecordingError, match="7 other commands or samples"):
                record_samples(recording, wrong)
    assert files(path) == before


def test_samples_of_another_number_of_joints(tmp_path):
    with Recording.create(tmp_path / "run.sqlite", DATA) as recording:
        with pytest.raises(InputError, match="shapes of q and tau"):
            record_samples(recording, StaticSamples(np.zeros((3, 3)), np.zeros((3, 3))))
        assert recording.length == 0
