"""The command ``symmetries`` on robots with more relations than anyone wants to read."""

import json

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.symbolic.symmetries import approximate_symmetries, primary_symmetries

LINK = '<link name="{name}"><inertial><origin xyz="0 0 -{half}"/><mass value="{mass}"/>'
LINK += '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
JOINT = '<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>'
JOINT += '<origin xyz="0 0 {z}"/><axis xyz="0 1 0"/></joint>'


def legged(legs: int) -> str:
    """Return a URDF of a fixed body with legs of two parallel joints, all different."""
    parts = ['<robot name="legged"><link name="body"/>']
    for leg in range(legs):
        upper, lower = f"upper{leg}", f"lower{leg}"
        parts.append(LINK.format(name=upper, half=0.1, mass=1.0 + leg))
        parts.append(LINK.format(name=lower, half=0.1, mass=0.5))
        parts.append(JOINT.format(name=f"hip{leg}", parent="body", child=upper, z=0))
        parts.append(JOINT.format(name=f"knee{leg}", parent=upper, child=lower, z=-0.2))
    return "".join([*parts, "</robot>"])


@pytest.fixture
def call(capsys):
    def run(*arguments):
        code = status([str(a) for a in arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


@pytest.fixture
def robot(tmp_path):
    def write(legs):
        path = tmp_path / f"legs{legs}.urdf"
        path.write_text(legged(legs))
        return path

    return write


def test_large_groups_are_printed_as_structure_and_generators(call, robot):
    code, out, _ = call("symmetries", robot(3))
    assert code == 0
    assert "512 primary symmetries" in out
    assert "512 = 8^3: 3 blocks of 8" in out
    assert "8 = 2^3: hip1, knee1" in out
    assert out.count("[proved]") == 9
    assert max(map(len, out.splitlines())) < 120


def test_small_groups_are_listed_with_their_structure_in_json(call, robot):
    code, out, _ = call("symmetries", robot(2), "--json")
    found = json.loads(out)
    assert code == 0
    assert len(found["relations"]) == found["order"] == 64
    assert "generators" not in found
    assert found["structure"]["text"] == "64 = 8^2: 2 blocks of 8"
    assert found["structure"]["factors"] == [
        {"joints": [f"hip{leg}", f"knee{leg}"], "order": 8, "factors": [2, 2, 2]}
        for leg in range(2)
    ]


def test_generators_in_json_are_verified_as_the_complete_group(call, robot, tmp_path):
    path, file = robot(3), tmp_path / "relations.json"
    code, out, _ = call("symmetries", path, "--json")
    found = json.loads(out)
    assert code == 0
    assert "relations" not in found
    assert (found["order"], len(found["generators"])) == (512, 9)
    file.write_text(out)
    code, text, _ = call("verify", file, "--robot", path)
    assert code == 0
    assert "proved: the 9 relations listed generate all that there are (512)" in text
    found["generators"].pop()
    file.write_text(json.dumps(found))
    code, text, _ = call("verify", file, "--robot", path)
    assert code == 1
    assert "refuted: the 8 relations listed generate all that there are (512)" in text


@pytest.mark.slow
def test_other_generators_of_the_group_are_as_good(call, robot, tmp_path):
    path, file = robot(3), tmp_path / "relations.json"
    found = json.loads(call("symmetries", path, "--json")[1])
    first, second = found["generators"][:2]
    A, B = np.array(first["A"]), np.array(second["A"])
    product = {
        "A": (A @ B).tolist(),
        "d": (A @ second["d"] + first["d"]).tolist(),
        "Y": (np.array(first["Y"]) * second["Y"]).tolist(),
    }
    found["generators"][0] = product
    file.write_text(json.dumps(found))
    code, text, _ = call("verify", file, "--robot", path)
    assert code == 0
    assert "proved: the 9 relations listed generate all that there are (512)" in text


def test_all_lists_every_relation_up_to_a_limit(call, robot):
    code, out, _ = call("symmetries", robot(3), "--all", "--json")
    found = json.loads(out)
    assert code == 0
    assert len(found["relations"]) == found["order"] == 512
    maps = {(str(r["A"]), str(np.round(r["d"], 6)), str(r["Y"])) for r in found["relations"]}
    assert len(maps) == 512
    code, out, error = call("symmetries", robot(5), "--all")
    assert code == 2
    assert out == ""
    assert error.startswith("error: ")
    assert error.count("\n") == 1
    assert "32768" in error
    assert "at most 4096" in error


def test_a_domain_needs_every_relation_and_is_refused_in_one_line(call, robot):
    code, _, error = call("domain", robot(5))
    assert code == 2
    assert error.count("\n") == 1
    assert "32768" in error


@pytest.mark.parametrize("tolerance", ["inf", "nan", "-1"])
def test_tolerances_that_are_no_numbers_are_refused(call, tolerance):
    code, _, error = call("symmetries", "2r", "--tolerance", tolerance)
    assert code == 2
    assert "tolerance" in error


@pytest.mark.parametrize("tolerance", [0.0, 1e-3, 0.1])
def test_one_call_searches_once(call, monkeypatch, tolerance):
    searches = []

    def counted(module, name):
        search = getattr(module, name)

        def run(*arguments, **options):
            searches.append(name)
            return search(*arguments, **options)

        monkeypatch.setattr(module, name, run)

    counted(approximate_symmetries, "maximal_groups")
    counted(primary_symmetries, "exact_symmetries")
    code = call("symmetries", "2r", "--tolerance", str(tolerance))[0]
    assert code == 0
    assert searches == ["maximal_groups" if tolerance else "exact_symmetries"]
