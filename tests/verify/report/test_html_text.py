"""Numbers and relations are written so that they read back."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.verify.report.html_text import map_lines, matrix, number, vector


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.floats(-1e300, 1e300))
def test_numbers_read_back_to_three_digits(value):
    text = str(number(value))
    plain = text.replace("\N{NARROW NO-BREAK SPACE}", "").replace("−", "-")
    plain = plain.replace("·10<sup>", "e").replace("</sup>", "")
    assert float(plain) == pytest.approx(value, rel=6e-3, abs=1e-300)


def test_numbers_that_are_none():
    assert str(number(None)) == str(number(float("nan"))) == str(number(float("inf"))) == "–"
    assert str(number(1234567)) == "1\N{NARROW NO-BREAK SPACE}234\N{NARROW NO-BREAK SPACE}567"
    assert str(vector([1.0, -0.5])) == "(1, −0.5)"
    assert str(matrix(np.array([1.0, 2.0]))).count("<tr>") == 2


def test_maps_are_written_with_signs():
    relation = SymmetryRelation([[0, -1], [0.5, 2]], [-0.25, 1e-9], [1, 1])
    text = re.sub(r"<sub>(\d)</sub>", r"\1", str(map_lines(relation)))
    assert text == "q1′ = −q2 − 0.25<br>q2′ = 0.5 q1 + 2 q2<br>τ′ = τ"
    zero = SymmetryRelation([[0.0]], [0.0], [-1])
    assert "= 0<br>" in str(map_lines(zero))
