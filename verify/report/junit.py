"""Verdicts as a JUnit file, which test runners of continuous integration read."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as ET

from isotorque.verify.verdict import Verdict


def junit_document(name: str, verdicts: Sequence[Verdict]) -> str:
    """Write verdicts as one test suite; what was refuted or not tested is a failure.

    Parameters
    ----------
    name
        What was judged.
    verdicts
        The judgement, a test case each.

    Examples
    --------
    >>> from isotorque.verify.verdict import Status
    >>> print(junit_document("model.json", [Verdict("q1' = -q1", Status.REFUTED, 2.0)]))
    <?xml version="1.0" encoding="utf-8"?>
    <testsuites>
      <testsuite name="model.json" tests="1" failures="1" errors="0" skipped="0">
        <testcase classname="model.json" name="q1' = -q1">
          <failure type="refuted" message="refuted: q1' = -q1 (worst error 2)" />
        </testcase>
      </testsuite>
    </testsuites>
    <BLANKLINE>
    """
    failed = sum(not verdict.passed for verdict in verdicts)
    counts = {"tests": len(verdicts), "failures": failed, "errors": 0, "skipped": 0}
    root = ET.Element("testsuites")
    shown = {key: str(value) for key, value in counts.items()}
    suite = ET.SubElement(root, "testsuite", {"name": name, **shown})
    for verdict in verdicts:
        case = ET.SubElement(suite, "testcase", {"classname": name, "name": verdict.claim})
        if verdict.passed:
            out = ET.SubElement(case, "system-out")
            out.text = str(verdict)
        else:
            told = {"type": str(verdict.status), "message": str(verdict)}
            ET.SubElement(case, "failure", told)
    ET.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"
