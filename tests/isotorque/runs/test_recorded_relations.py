"""What the report of a run says of relations beyond the limits, and of the static torques."""

import json
from importlib.resources import files

import pytest

from isotorque.cli.main import status


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """A 2R arm that can only hang, run through the whole scheme."""
    out = tmp_path_factory.mktemp("hanging")
    text = files("isotorque.symbolic").joinpath("robot_files/2r.urdf").read_text()
    full = 'lower="-3.141592653589793" upper="3.141592653589793"'
    assert text.count(full) == 2
    text = text.replace(full, 'lower="-3.0" upper="-0.1"', 1)
    (out / "hanging.urdf").write_text(text.replace(full, 'lower="-1.5" upper="1.5"'))
    arguments = ["run", str(out / "hanging.urdf"), "--out", str(out / "run"), "--samples", "30"]
    assert status([*arguments, "--quiet"]) in (0, 1)  # 30 samples need not make a good model
    return out / "run"


def test_relations_that_the_limits_forbid_are_marked(report):
    document = json.loads((report / "report.json").read_text())
    relations = document["symmetry"]["relations"]
    assert document["symmetry"]["found"] == 8
    executable = [entry["executable"] for entry in relations]
    assert executable[0] is True
    assert 0 < executable.count(False) < 8
    upside_down = next(
        entry
        for entry in relations
        if entry["relation"]["A"] == [[1, 0], [0, 1]] and entry["relation"]["Y"] == [-1, -1]
    )
    assert upside_down["executable"] is False
    page = (report / "report.html").read_text()
    assert page.count("not executable within the joint limits") == executable.count(False)


def test_secondary_pairs_are_reported(tmp_path):
    out = tmp_path / "run"
    # in the discovery of this seed the arm also settles in configurations of another primary set
    command = ["run", "2r", "--seed", "2", "--samples", "20", "--out", str(out), "--quiet"]
    assert status(command) in (0, 1)
    symmetry = json.loads((out / "report.json").read_text())["symmetry"]
    assert status(["relations", str(out), "--quiet"]) == 0
    pairs = json.loads((out / "relations.json").read_text())["secondary_pairs"]
    assert symmetry["secondary_pairs"] == sum(kind["pairs"] for kind in pairs) > 0
    assert symmetry["contradicted"] == 0
    page = (out / "report.html").read_text()
    assert f"{symmetry['secondary_pairs']} recorded pairs with equal" in page


def test_the_static_torques_are_judged(report):
    document = json.loads((report / "report.json").read_text())["static_torques"]
    for when in ("discovered", "judgement"):
        judged = document[when]
        assert judged["stable_only"] is True
        assert judged["samples"] == 1000
        assert 0 < judged["common_volume"] <= judged["true_volume"] < judged["box_volume"]
        assert judged["common_volume"] <= judged["learned_volume"]
        assert len(judged["outside"]) == len(judged["false_torques"])
    assert "the set learned (SST) admits" in (report / "report.html").read_text()
