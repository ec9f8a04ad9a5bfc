"""Arms of the page of robots, a seeded share of them: each run ends with a report."""

import random

import pytest

from benchmarks.run_arms import run_arm, subjects

SEED, SHARE = 11, 2


@pytest.mark.slow
def test_a_seeded_share_of_the_arms_ends_with_reports(tmp_path):
    every = list(subjects(tmp_path))
    assert len(every) > 4 * SHARE
    for name, robot in random.Random(SEED).sample(every, SHARE):
        row = run_arm(name, robot, tmp_path)
        assert row.status in (0, 1), row.error
        assert row.report is not None, name
        assert row.report["summary"]
