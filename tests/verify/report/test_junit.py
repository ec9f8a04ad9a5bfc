"""A JUnit file holds the same verdicts, and what was not tested fails."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.verify.report.junit import junit_document
from isotorque.verify.verdict import Status, Verdict

VERDICTS = st.builds(
    Verdict,
    st.text(st.characters(blacklist_categories=["Cc", "Cs"]), min_size=1).filter(str.isprintable),
    st.sampled_from(Status),
    st.floats(0.0, 1e3),
)


@given(st.lists(VERDICTS, min_size=1, max_size=5))
def test_a_case_for_each_verdict_and_a_failure_for_each_that_does_not_pass(verdicts):
    suite = ET.fromstring(junit_document("model.json", verdicts))[0]
    assert [case.get("name") for case in suite] == [verdict.claim for verdict in verdicts]
    failures = [case.find("failure") is not None for case in suite]
    assert failures == [not verdict.passed for verdict in verdicts]
    assert suite.get("tests") == str(len(verdicts))
    assert suite.get("failures") == str(sum(failures))
    assert suite.get("skipped") == "0"


@pytest.mark.parametrize("status", [Status.REFUTED, Status.UNTESTED])
def test_a_failure_says_why(status):
    verdict = Verdict("a < b & c", status, 2.0, np.array([1.0]), reason="by two poses")
    case = ET.fromstring(junit_document("arm", [verdict]))[0][0]
    failure = case.find("failure")
    assert failure is not None
    assert failure.get("type") == str(status)
    assert failure.get("message") == str(verdict)
