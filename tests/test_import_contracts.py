"""The import contracts bite: a planted forbidden import breaks them."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("importlinter")
ROOT = Path(__file__).parents[1]


def contracts_hold(tmp_path, planted=None):
    for package in ("symbolic", "learning", "verify", "isotorque"):
        shutil.copytree(
            ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__")
        )
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    if planted is not None:
        module, line = planted
        file = tmp_path / module
        file.write_text(file.read_text() + f"\n{line}\n")
    code = (
        "import sys; sys.path.insert(0, '.');"
        "from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True))"
    )
    return subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=False).returncode == 0


def test_contracts_hold(tmp_path):
    assert contracts_hold(tmp_path)


@pytest.mark.parametrize(
    "planted",
    [
        ("learning/discovery.py", "import symbolic.gravity"),
        ("learning/relations/identification.py", "from symbolic.robots import load_robot"),
        ("learning/learners/local_linear_map.py", "import pinocchio"),
        ("learning/scheme.py", "from learning.simulation.simulated_arm import SimulatedArm"),
        ("symbolic/relations.py", "import learning.arm"),
        ("verify/verdict.py", "import isotorque.runs.experiment"),
    ],
)
def test_a_planted_import_breaks_them(tmp_path, planted):
    assert not contracts_hold(tmp_path, planted)
