"""No false proof, no broken bound, no truth refused: a share of the claims of the benchmark."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from benchmarks.verify_claims import (
    FAULTS,
    KINDS,
    Claim,
    judged,
    run,
    subjects,
    table,
)


def faults(counts):
    return {pair: number for pair, number in counts.items() if pair[1] in FAULTS}


def test_four_hundred_claims_are_judged_rightly():
    counts = run(11, 400)
    assert faults(counts) == {}
    said = {status: sum(counts[kind, status] for kind in KINDS) for status in ("proved", "bounded")}
    assert said["proved"] > 50
    assert said["bounded"] > 50
    assert sum(counts[kind, "refuted"] for kind in KINDS) > 100
    assert all(counts["true", status] == 0 for status in ("bounded", "tested", "refuted"))


@pytest.mark.slow
def test_eight_thousand_claims_are_judged_rightly():
    assert faults(run(12, 8000)) == {}


@pytest.fixture(scope="module")
def two_link():
    return subjects()[1]


def test_the_oracle_has_the_potential_of_the_arm(two_link):
    with mpmath.workdps(50):
        size = 2 * abs(two_link.oracle.C[1, 0])
        assert abs(size - mpmath.mpf(18.39375)) < mpmath.mpf("1e-14")
    assert set(two_link.oracle.K) == {(1, 0), (1, 1)}


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"status": "proved", "worst_error": 1.0}, "false proved"),
        ({"status": "bounded", "worst_error": 1e-12}, "exceeded bounded"),
    ],
)
def test_the_oracle_notices_a_judge_that_errs(two_link, monkeypatch, change, fault):
    lie = Claim("offset", np.eye(2).tolist(), [1e-6, 0.0], [1, 1], 1e-3)
    fields = {"counterexample": None, **change}
    judge = type("Judge", (), fields)()
    monkeypatch.setattr("benchmarks.verify_claims.verify_relation", lambda *a, **k: judge)
    assert fault in judged(two_link, lie, np.random.default_rng(0), False)[1]


def test_the_oracle_notices_truths_that_are_refuted(two_link, monkeypatch):
    true = Claim("true", [[-1.0, 0.0], [2.0, 1.0]], [0.0, 0.0], [1, 1], 0.0)
    fields = {"status": "refuted", "worst_error": 1.0, "counterexample": np.zeros(2)}
    judge = type("Judge", (), fields)()
    monkeypatch.setattr("benchmarks.verify_claims.verify_relation", lambda *a, **k: judge)
    assert judged(two_link, true, np.random.default_rng(0), False)[1] == ["refuted truth"]


def test_the_table_counts_everything(two_link):
    rows = table(run(3, 30)).splitlines()
    assert len(rows) == 2 + len(KINDS) + 1
    assert rows[-1].startswith("| all | 30 |")
