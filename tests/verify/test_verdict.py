"""Verdicts have the JSON form of the command line."""

from __future__ import annotations

import json

import numpy as np
import pytest

from isotorque.verify.verdict import Status, Verdict, all_passed


@pytest.mark.parametrize(
    ("status", "passed"),
    [
        ("proved", True),
        ("bounded", True),
        ("tested", True),
        ("not tested", False),
        ("refuted", False),
    ],
)
def test_json_form(status, passed):
    q = None if passed else np.array([0.5, -1.0])
    verdict = Verdict("g(q) = 0", Status(status), 0.25, q)
    assert json.loads(json.dumps(verdict.to_json())) == {
        "claim": "g(q) = 0",
        "status": status,
        "passed": passed,
        "worst_error": 0.25,
        "counterexample": None if passed else [0.5, -1.0],
    }
    assert str(verdict).startswith(f"{status}: g(q) = 0 (worst error 0.25")


def test_all_passed():
    good, bad = Verdict("a", Status.TESTED, 0.0), Verdict("b", Status.REFUTED, 1.0)
    assert all_passed([])
    assert all_passed([good, good])
    assert not all_passed([good, bad])


def test_the_reason_is_told_where_there_is_one():
    verdict = Verdict("a", Status.UNTESTED, 0.5, reason="one pose only")
    assert str(verdict) == "not tested: a (worst error 0.5); one pose only"
    assert verdict.to_json()["reason"] == "one pose only"
    assert "reason" not in Verdict("a", Status.TESTED, 0.5).to_json()
