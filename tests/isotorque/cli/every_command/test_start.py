"""What commands import: the heavy libraries only where they are needed.

Start-up times follow from this; they are not tested, since they depend on the machine.
"""

import json
import subprocess
import sys

import pytest

HEAVY = (
    "sympy",
    "casadi",
    "sklearn",
    "numba",
    "matplotlib",
    "scipy",
    "pinocchio",
    "jinja2",
    "hypothesis",
)
WATCH = """
import json, sys
{action}
print()
print(json.dumps([name for name in {heavy} if name in sys.modules]))
"""


def imported(action):
    """Heavy libraries that a new process has imported when it has done something."""
    program = WATCH.format(action=action, heavy=HEAVY)
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    return set(json.loads(found.stdout.splitlines()[-1]))


@pytest.mark.parametrize(
    ("arguments", "needed"),
    [
        (["--help"], set()),
        (["robots"], set()),
        (["symmetries", "2r"], {"pinocchio"}),
        (["symmetries", "panda", "--tolerance", "0.1"], {"pinocchio", "scipy"}),
        (["derive", "2r", "--latex"], {"pinocchio"}),
        (["derive", "2r"], {"pinocchio", "numba", "scipy"}),
        (["domain", "2r"], {"pinocchio", "scipy"}),
        (["simulate", "2r", "--torque", "0,0"], {"pinocchio", "numba", "scipy"}),
    ],
)
def test_a_command_imports_what_it_needs(arguments, needed):
    call = f"from isotorque.cli.main import status; assert status({arguments}) == 0"
    assert imported(call) <= needed


def test_the_package_imports_nothing_but_python():
    assert imported("import isotorque; assert 'numpy' not in sys.modules") == set()


def test_what_is_watched_is_seen():
    assert imported("import sympy; import isotorque.symbolic.common.compiled") >= {"sympy", "numba"}
