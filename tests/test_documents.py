"""The Python blocks of the README and of docs/ run, in order, one namespace per page."""

import re
from pathlib import Path

import numpy as np
import pytest

from isotorque.cli.main import status
from learning.recordings.csv_data import StaticSamples, write_csv
from symbolic.gravity import GravityModel
from symbolic.robots import load_robot

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```python\n(.*?)^```", re.S | re.M)
PAGES = [
    path
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
    if BLOCK.search(path.read_text())
]
BEFORE = {
    # commands of the page that write what its Python reads
    "export.md": [["export", "2r", "--npz", "gravity.npz"]],
    "your-robot.md": [
        [
            "learn",
            "2r",
            "--data",
            "arm.csv",
            "--out",
            "out/b",
            "--quiet",
            "--learner",
            "parametric",
            "--symmetries",
            "none",
        ],
    ],
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_python_of_a_page_runs(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    robot = load_robot("2r")
    Path("my_arm.urdf").write_text((ROOT / "symbolic/robot_files/2r.urdf").read_text())
    q = np.array([[0.1 * i, 0.3 * i - 2.0] for i in range(20)])
    write_csv("arm.csv", StaticSamples(q, GravityModel(robot).torque(q)), robot.joint_names)
    for command in BEFORE.get(page.name, []):
        assert status(command) == 0, capsys.readouterr().err
    names: dict = {}
    for code in BLOCK.findall(page.read_text()):
        if not code.lstrip().startswith(">>>"):  # those are doctests
            exec(compile(code, str(page), "exec"), names)
