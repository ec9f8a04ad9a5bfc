"""The import contracts bite: a planted forbidden import breaks them, and the one meant."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("importlinter")
ROOT = Path(__file__).parents[2]
LAYERS, ROOMS = "One direction: front door", "One direction among the rooms"
TRUTH, PROTOCOL = "never touches the truth", "only through its protocol"
KINEMATICS, HIDDEN = "is told the kinematics", "imports nothing dynamically"


LEARNER, OTHER = "isotorque/learning/learners/", "isotorque/learning/"
BODY = "isotorque.learning.simulator.simulated_body"
STATIC = "isotorque.learning.learners.rigid.static_regressor"


PLANTED = [
    (OTHER, "import isotorque.symbolic.gravity.gravity_model", TRUTH),
    (
        "isotorque/learning/relations/",
        "from isotorque.symbolic.robots.load_robot import load_robot",
        TRUTH,
    ),
    (LEARNER, "import pinocchio", TRUTH),
    (LEARNER, "from isotorque.symbolic.gravity import gravity_model as gravity", TRUTH),
    (LEARNER, "from isotorque.learning.simulator.simulated_arm import X", PROTOCOL),
    ("isotorque/symbolic/", "import isotorque.learning.arm", LAYERS),
    ("isotorque/verify/", "import isotorque.runs.experiment", LAYERS),
    (LEARNER, "from isotorque.verify.relations.verify_relation import GravityModel", LAYERS),
    (LEARNER, "from isotorque import load_robot", LAYERS),
    ("isotorque/symbolic/common/", "from isotorque.symbolic.groups import subgroups", ROOMS),
    ("isotorque/symbolic/groups/", "import isotorque.symbolic.symmetries.phase_proof", ROOMS),
    # the learner that is told the kinematics, and what it imports
    (LEARNER, f"from {STATIC} import pin, load_robot", KINEMATICS),
    (LEARNER, f"from {STATIC} import pin, load_robot", HIDDEN),
    (OTHER, f"def f():\n    import {STATIC} as s", KINEMATICS),
    (OTHER, f"from {STATIC} import StaticRegressor", KINEMATICS),
    ("isotorque/verify/", f"from {STATIC} import load_robot", KINEMATICS),
    ("isotorque/runs/", f"from {STATIC} import load_robot", KINEMATICS),
    ("isotorque/learning/learners/registry.py", f"from {STATIC} import load_robot", HIDDEN),
    (LEARNER, "from isotorque.learning.export.from_learner import StaticRegressor", HIDDEN),
    # names that the simulator has imported
    (OTHER, "from isotorque.learning.simulator.simulated_body import Robot", HIDDEN),
    (OTHER, "from isotorque.learning.simulator import simulated_body as body\nbody.Robot", HIDDEN),
    (OTHER, "import isotorque.learning.simulator.simulated_body as b\nb.Robot", HIDDEN),
    (OTHER, "import isotorque.learning.simulator.engines as e\ne.pin", HIDDEN),
    (
        OTHER,
        f"import {BODY}\n{BODY}.Robot",
        HIDDEN,
    ),
    (OTHER, "from isotorque.learning.simulator.simulated_body import *", HIDDEN),
    (
        OTHER,
        "from isotorque.learning.simulator import simulated_body as body\ngetattr(body, 'Robot')",
        HIDDEN,
    ),
    (OTHER, "from isotorque.learning.simulator import simulated_body as body\nvars(body)", HIDDEN),
    (
        OTHER,
        "from isotorque.learning.simulator import simulated_body as body\nbody.__dict__",
        HIDDEN,
    ),
    (OTHER, "from isotorque.learning.simulator.simulated_body import x\nx.__globals__", HIDDEN),
    (OTHER, "from .simulator.simulated_body import Robot", HIDDEN),
    # imports that have no edge in the graph
    (
        LEARNER,
        "import importlib\nimportlib.import_module('isotorque.symbolic.gravity.gravity_model')",
        HIDDEN,
    ),
    (LEARNER, "def f():\n    from importlib import import_module as i", HIDDEN),
    (LEARNER, "import importlib.metadata", HIDDEN),
    (LEARNER, "__import__('isotorque.symbolic.gravity.gravity_model')", HIDDEN),
    (LEARNER, "i = __builtins__", HIDDEN),
    (LEARNER, "import builtins", HIDDEN),
    (LEARNER, "import sys\nsys.modules['isotorque.symbolic.gravity.gravity_model']", HIDDEN),
    (
        LEARNER,
        "import sys as s\ng = s.modules.get('isotorque.symbolic.gravity.gravity_model')",
        HIDDEN,
    ),
    (LEARNER, "from sys import modules", HIDDEN),
    (LEARNER, "import sys\ngetattr(sys, 'modules')", HIDDEN),
    (LEARNER, "exec('import isotorque.symbolic.gravity.gravity_model')", HIDDEN),
    (LEARNER, "eval('1')", HIDDEN),
    (LEARNER, "import pkgutil", HIDDEN),
    (LEARNER, "import runpy", HIDDEN),
    (LEARNER, "np.__spec__.loader", HIDDEN),
]


HARMLESS = [
    (OTHER, "from importlib import metadata, resources"),
    (OTHER, "from importlib.metadata import version"),
    (OTHER, "import sys\nsys.argv\nsys.stderr.flush"),
    (OTHER, "import re\nre.compile('x')\ngetattr(re.compile('x'), 'y')"),
    ("isotorque/", "import importlib"),
]


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """What is said of a copy in which each plant is a module of its own, per contract."""
    folder = tmp_path_factory.mktemp("copy")
    for package in ("isotorque", "contracts"):
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / package, folder / package, ignore=ignored)
    shutil.copy(ROOT / "pyproject.toml", folder)
    for kind, plants in (("planted", PLANTED), ("harmless", HARMLESS)):
        for number, (module, lines, *_) in enumerate(plants):
            if module.endswith("/"):
                (folder / module / f"{kind}_{number}.py").write_text(lines + "\n")
            else:
                with (folder / module).open("a") as file:
                    file.write(f"\n{lines}\n")
    return lint(folder)


def lint(folder):
    """Return what is said of each contract that is broken, by its name."""
    code = (
        "import sys; sys.path.insert(0, '.');"
        "from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True))"
    )
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env={**os.environ, "COLUMNS": "300"},
        capture_output=True,
        text=True,
        check=False,
    )
    _, _, details = run.stdout.partition("Broken contracts\n")
    assert bool(details) == (run.returncode == 1), run.stdout + run.stderr
    parts = re.split(r"\n(.+)\n-+\n", details)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def test_contracts_hold():
    assert lint(ROOT) == {}


@pytest.mark.parametrize("number", range(len(PLANTED)), ids=lambda i: PLANTED[i][1])
def test_a_planted_import_breaks_them(report, number):
    module, _, contract = PLANTED[number]
    place = module.replace("/", ".")
    planted = f"{place}planted_{number} " if place.endswith(".") else place.removesuffix(".py")
    said = next((text for name, text in report.items() if contract in name), "")
    assert planted in said


def test_what_is_harmless_does_not(report):
    assert not any("harmless" in text for text in report.values())
