"""Folders at the root are imported as parts of isotorque only: bare imports are caught."""

import importlib
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ("symbolic", "learning", "verify")
PLANTED = [
    *(f"import {name}" for name in FOLDERS),
    "import symbolic.common.errors as errors",
    "from symbolic.common.errors import InputError",
    "from learning import arm",
    "def f():\n    from verify.verdict import Verdict\n    return Verdict",
]


@pytest.mark.parametrize("line", PLANTED)
@pytest.mark.parametrize("place", ["tests/test_x.py", "verify/x.py", "isotorque/x.py", "docs/x.py"])
def test_the_linter_refuses_a_bare_import(line, place):
    ruff = shutil.which("ruff") or str(Path(sys.executable).with_name("ruff"))
    if not Path(ruff).exists():
        pytest.skip("needs ruff")
    command = [ruff, "check", "--no-cache", "--output-format", "concise", "--stdin-filename", place]
    found = subprocess.run([*command, "-"], input=line, text=True, capture_output=True, cwd=ROOT)
    assert found.returncode == 1
    assert "TID251" in found.stdout
    assert "import isotorque." in found.stdout


@pytest.mark.parametrize("name", [*FOLDERS, "symbolic.common.errors"])
def test_a_bare_import_fails_in_every_test(name):
    top = name.partition(".")[0]
    with pytest.raises(ImportError, match=rf"import isotorque\.{top}, not {top}"):
        importlib.import_module(name)


@pytest.mark.parametrize("name", FOLDERS)
def test_a_bare_import_before_the_tests_ends_them_with_one_line(name):
    """A plugin imports one before conftest.py is read."""
    found = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", name, "conftest.py"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert found.returncode == 4, found.stdout
    assert f"import isotorque.{name}, not {name}" in found.stderr
    assert "Traceback" not in found.stderr
    assert found.stdout == ""


def test_other_names_are_left_alone():
    assert (
        importlib.import_module("isotorque.verify.verdict").__name__ == "isotorque.verify.verdict"
    )
