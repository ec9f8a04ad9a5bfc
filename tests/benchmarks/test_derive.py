"""The derivation benchmark runs and what it times is right."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_every_way_to_the_torque_agrees_with_pinocchio():
    command = [sys.executable, "-m", "benchmarks.derive", "3r", "--json", "--repeats", "1"]
    run = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    (row,) = json.loads(run.stdout)
    assert (row["robot"], row["joints"], row["frequencies"], row["order"]) == ("3r", 3, 4, 16)
    assert {"normal form", "isotorque", "SymPy", "CasADi"} <= set(row["seconds"])
    assert set(row["error_vs_pinocchio"]) == set(row["seconds"])  # adam too, where installed
    assert max(row["error_vs_pinocchio"].values()) < 1e-9
