"""One seed, one result: also between a process that compiles and one that loads compiled code."""

import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[4]


@pytest.mark.slow
@pytest.mark.parametrize("learner", ["local-linear-map-it", "recursive-least-squares"])
def test_freshly_compiled_and_cached_code_agree_bit_for_bit(tmp_path, learner):
    for package in ("symbolic", "learning", "verify", "isotorque"):
        leave = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / package, tmp_path / package, ignore=leave)
    results = []
    for attempt in ("compiles", "loads"):
        command = [sys.executable, "-m", "isotorque", "run", "2r", "--quiet", "--samples", "60"]
        command += ["--learner", learner, "--out", attempt, "--tolerance", "30"]
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
        with sqlite3.connect(tmp_path / attempt / "run.sqlite") as database:
            results.append(list(database.execute("select * from command order by 1, 2")))
    assert len(results[0]) > 200
    assert results[0] == results[1]
