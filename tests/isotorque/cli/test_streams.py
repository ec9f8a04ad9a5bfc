"""Streams that are closed, or whose reader leaves: the exit status is that of the work."""

import subprocess
import sys

import pytest

COMMAND = f"{sys.executable} -m isotorque"
# a command that says much, works on, and ends with a status of its own
PROGRAM = """
import sys
from pathlib import Path
from isotorque.cli import main
from isotorque.symbolic.common.errors import InputError

def command(**_):
    for _ in range(3):
        print("said " * 20_000)
        print("said", file=sys.stderr)
    Path("done").touch()
    if sys.argv[1] == "2":
        raise InputError("arm.urdf", "mass", -1, "a number >= 0")
    return int(sys.argv[1])

main.app = command
main.run([])
"""


def shell(line, folder):
    """Exit status of the first command of a line, and what came on standard error."""
    done = subprocess.run(
        ["bash", "-c", f"{line}; exit ${{PIPESTATUS[0]}}"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize("code", [0, 1, 2])
@pytest.mark.parametrize(
    "reader", ["| true", "| head -c 1", ">&-", ">/dev/null 2>&-", "2>&1 >/dev/null | true"]
)
def test_the_reader_does_not_change_the_status(reader, code, tmp_path):
    (tmp_path / "command.py").write_text(PROGRAM)
    found, error = shell(f"{sys.executable} command.py {code} {reader}", tmp_path)
    assert found == code
    expected = "said\n" * 3 + "error: arm.urdf: mass is -1; accepted: a number >= 0\n" * (code == 2)
    assert error == ("" if "2>" in reader else expected)
    assert (tmp_path / "done").exists()


def test_a_full_disk_is_one_line(tmp_path):
    code, error = shell(f"{COMMAND} robots >/dev/full", tmp_path)
    assert code == 2
    assert error.startswith("error: ")
    assert error.count("\n") == 1


def test_help_that_nobody_reads(tmp_path):
    assert shell(f"{COMMAND} learn --help | true", tmp_path) == (0, "")
