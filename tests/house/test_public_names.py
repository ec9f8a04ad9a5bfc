"""The public names exist, agree with what type checkers see, and cost nothing until used."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import isotorque


def test_every_public_name_is_importable_and_documented():
    for name in isotorque.__all__:
        assert getattr(isotorque, name).__doc__, name
    assert set(isotorque.__all__) <= set(dir(isotorque))


def test_type_checkers_see_the_same_names():
    tree = ast.parse(Path(isotorque.__file__).read_text())
    seen = {
        alias.name: (node.module or "").removeprefix("isotorque.")
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.asname
    }
    assert seen == isotorque._HOME
    for name, module in seen.items():
        assert hasattr(importlib.import_module(f"isotorque.{module}"), name)


def test_unknown_names_are_refused():
    with pytest.raises(AttributeError, match="no_such_thing"):
        _ = isotorque.no_such_thing


def test_importing_the_front_door_loads_no_heavy_library():
    code = "import sys, isotorque; print([m for m in ('numba', 'pinocchio') if m in sys.modules])"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"
