"""The examples run as a user would run them, and say what they should."""

import runpy
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


def output_of(script, capsys, monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", [script, *map(str, arguments)])
    runpy.run_path(str(EXAMPLES / script), run_name="__main__")
    return capsys.readouterr().out


def test_derive_2r_finds_the_textbook_formula_and_eight_relations(capsys, monkeypatch):
    lines = output_of("derive_2r.py", capsys, monkeypatch).splitlines()
    assert lines[1] == "g_1 = g*(c1*m1 + l1*m2)*cos(q1) + c2*g*m2*cos(q1 + q2)"
    assert "difference to the textbook: [0, 0]" in lines
    assert "8 relations g(A q + d) = Y g(q):" in lines
    assert "  A [[-1.0, 0.0], [2.0, 1.0]] d [0.0, 0.0] Y [1.0, 1.0]" in lines


def test_derive_own_urdf_with_the_arm_it_brings(capsys, monkeypatch):
    lines = output_of("derive_own_urdf.py", capsys, monkeypatch).splitlines()
    assert "g_2 = 0.54936 cos(q2) - 0.06867 sin(q2)" in lines  # 0.7 kg 9.81 m/s^2 (0.08, 0.01) m
    assert "symmetry group of order 4, rank 1 of 2" in lines


def test_derive_own_urdf_with_a_file_of_the_user(capsys, monkeypatch, tmp_path):
    urdf = EXAMPLES.parent / "symbolic" / "robot_files" / "2r.urdf"
    source = tmp_path / "gravity.c"
    lines = output_of("derive_own_urdf.py", capsys, monkeypatch, urdf, source).splitlines()
    assert "symmetry group of order 8, rank 2 of 2" in lines
    assert "void isotorque_gravity(const double *q, double *tau)" in source.read_text()


def test_derive_own_urdf_names_a_missing_file(capsys, monkeypatch, tmp_path):
    with pytest.raises(ValueError, match="nowhere"):
        output_of("derive_own_urdf.py", capsys, monkeypatch, tmp_path / "nowhere.urdf")


def test_export_model_writes_c_that_says_what_it_is(capsys, monkeypatch, tmp_path):
    source = tmp_path / "gravity.c"
    lines = output_of("export_model.py", capsys, monkeypatch, source).splitlines()
    assert lines[0] == "learned: tanh units with 58 numbers"
    assert lines[2].endswith("equals predict: True")
    assert "Learned by FeedForwardNetwork on 2r" in source.read_text()
