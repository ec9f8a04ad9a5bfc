"""Sweeps: tables read or refused, runs done once, results in one table."""

import csv
import json
from dataclasses import fields

import pytest

from isotorque.cli.main import status
from isotorque.runs.options.run_options import ArmOptions, RunOptions
from isotorque.sweeps import sweep as sweep_module
from isotorque.sweeps.sweep import COLUMNS, sweep
from isotorque.sweeps.sweep_table import OPTIONS, read_sweep, told_options
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.load_robot import load_robot

LEARNER = "recursive-least-squares"
BOTH = f'robots = ["2r"]\nlearners = ["{LEARNER}"]\n'


def quiet(*_):
    pass


def table(path, text):
    path.write_text(text)
    return path


def test_a_toml_table_is_every_combination(tmp_path):
    text = f'robots = ["2r", "pendulum"]\nlearners = ["{LEARNER}"]\nseeds = [3, 7]\nsamples = 50\n'
    runs = read_sweep(table(tmp_path / "t.toml", text))
    assert [(r.robot, r.seed, r.options.samples) for r in runs] == [
        ("2r", 3, 50),
        ("2r", 7, 50),
        ("pendulum", 3, 50),
        ("pendulum", 7, 50),
    ]
    assert {r.options.symmetries for r in runs} == {"learned"}


def test_a_number_of_seeds_counts_from_zero(tmp_path):
    text = f'robots = ["2r"]\nlearners = ["{LEARNER}"]\nsymmetries = ["none", "exact"]\nseeds = 2\n'
    runs = read_sweep(table(tmp_path / "t.toml", text))
    assert [(r.options.symmetries, r.seed) for r in runs] == [
        ("none", 0),
        ("none", 1),
        ("exact", 0),
        ("exact", 1),
    ]


def test_a_csv_table_is_one_run_per_line_each_once(tmp_path):
    once = f"2r,{LEARNER},1,40\n"
    text = f"robot,learner,seed,samples\n{once}\npendulum, network ,2,\n{once}"
    runs = read_sweep(table(tmp_path / "t.csv", text))
    assert [(r.robot, r.learner, r.seed, r.options.samples) for r in runs] == [
        ("2r", LEARNER, 1, 40),
        ("pendulum", "network", 2, 1000),
    ]
    assert len({r.name for r in runs}) == 2


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("t.csv", "", ("row 1", "robot is missing")),
        ("t.csv", "robot,learner,seed\n", ("rows",)),
        ("t.csv", "robot,learner,seed,colour\n", ("row 1", "colour")),
        ("t.csv", "robot,learner,seed,seed\n", ("row 1", "seed")),
        ("t.csv", f"robot,learner,seed\n2r,{LEARNER}\n", ("row 2", "number of fields")),
        ("t.csv", f"robot,learner,seed\n2r,{LEARNER},1\n2r,{LEARNER},x\n", ("row 3", "seed", "x")),
        ("t.csv", f"robot,learner,seed\n2r,{LEARNER},-1\n", ("row 2", "seed")),
        ("t.csv", f"robot,learner,seed,samples\n2r,{LEARNER},1,0\n", ("row 2", "samples")),
        ("t.csv", "robot,learner,seed\n2r,nobody,1\n", ("row 2", "nobody", "gaussian-process")),
        ("t.csv", f"robot,learner,seed\nnowhere.urdf,{LEARNER},1\n", ("row 2", "nowhere.urdf")),
        ("t.csv", f"robot,learner,seed,symmetries\n2r,{LEARNER},1,all\n", ("row 2", "all")),
        ("t.toml", "robots = [", ("no TOML",)),
        ("t.toml", 'robots = ["2r"]\n', ("learners", "missing")),
        ("t.toml", 'robots = "2r"\nlearners = ["x"]\n', ("robots",)),
        ("t.toml", f'robots = ["2r"]\nlearners = ["{LEARNER}"]\nseeds = 1.5\n', ("seeds", "1.5")),
        ("t.toml", f'robots = ["2r"]\nlearners = ["{LEARNER}"]\nseed = 1\n', ("key", "seed")),
        ("t.toml", 'robots = ["2r"]\nlearners = ["nobody"]\n', ("entry 1", "nobody")),
        ("t.txt", "x", ("ending", ".csv or .toml")),
        ("t.toml", BOTH + "seeds = 10000000000\n", ("seeds", "10000000000", "100000")),
        ("t.toml", BOTH + f"seeds = [{10**30}]\n", ("entry 1", "seed", "9223372036854775807")),
        ("t.toml", BOTH + f"seeds = {'9' * 5000}\n", ("no TOML",)),
        ("t.toml", BOTH + "seeds = []\n", ("seeds", "empty list")),
        ("t.toml", BOTH + "seeds = 0\n", ("seeds", "0")),
        ("t.toml", BOTH + "seeds = [[1]]\n", ("seeds", "[1]", "whole number")),
        ("t.toml", BOTH + f"samples = {10**30}\n", ("samples", "1 to 10000000")),
        ("t.toml", BOTH + "angle_noise = [0.0, inf]\n", ("angle_noise", "inf")),
        ("t.toml", BOTH + 'snap = "perhaps"\n', ("snap", "true or false")),
        ("t.toml", BOTH + 'strategies = ["flying"]\n', ("flying", "goal-babbling")),
        ("t.toml", BOTH + 'strategy = "lattice"\n', ("key", "strategy", "strategies")),
        ("t.toml", BOTH + "seeds = 50000\nsamples = [1, 2, 3]\n", ("combinations", "150000")),
        ("t.csv", f"robot,learner,seed,strategy\n2r,{LEARNER},1,flying\n", ("row 2", "flying")),
        ("t.csv", f"robot,learner,seed\n2r,{LEARNER},{10**30}\n", ("row 2", "seed")),
    ],
)
def test_a_bad_table_is_refused_in_one_line(tmp_path, capsys, name, text, said):
    path = table(tmp_path / name, text)
    assert status(["sweep", str(path), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith(f"error: {path}")
    for word in said:
        assert word in error
    assert not (tmp_path / "out").exists()


def test_a_missing_table_is_refused(tmp_path):
    with pytest.raises(InputError, match="file"):
        read_sweep(tmp_path / "none.csv")


def test_runs_become_one_table_and_a_plot_and_are_done_once(tmp_path, capsys, monkeypatch):
    path = table(
        tmp_path / "t.toml",
        f'robots = ["pendulum"]\nlearners = ["{LEARNER}"]\nseeds = 2\nsamples = 20\n',
    )
    out = tmp_path / "out"
    arguments = ["sweep", str(path), "--out", str(out), "--jobs", "1", "--json"]
    assert status(arguments) == 0
    first = json.loads(capsys.readouterr().out)
    with (out / "sweep.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == COLUMNS
    assert [row["rmse"] for row in rows] == [str(row["rmse"]) for row in first["rows"]]
    assert {row["seed"] for row in rows} == {"0", "1"}
    assert float(rows[-1]["rmse"]) < float(rows[0]["rmse"])
    assert b"<svg" in (out / "sweep.svg").read_bytes()
    monkeypatch.setattr(sweep_module, "perform_run", lambda run: pytest.fail("done before"))
    assert status(arguments) == 0
    assert json.loads(capsys.readouterr().out) == first


def test_a_longer_table_adds_its_runs(tmp_path, monkeypatch):
    runs = read_sweep(
        table(tmp_path / "t.csv", f"robot,learner,seed\n2r,{LEARNER},0\n2r,{LEARNER},1\n")
    )
    asked = []

    def fake(run):
        asked.append(run.seed)
        point = {"samples": 1, "rmse": 1.0 + run.seed, "largest": 9.0, "explored": None}
        return {"curve": [point], "motions": 5, "inadmissible": 0.0, "gate": True}

    monkeypatch.setattr(sweep_module, "perform_run", fake)
    sweep(runs[:1], tmp_path, quiet, jobs=1)
    found = sweep(runs, tmp_path, quiet, jobs=1)
    assert asked == [0, 1]
    assert [row["rmse"] for row in found.rows] == [1.0, 2.0]


def test_strategies_and_other_options_are_columns(tmp_path):
    text = BOTH + 'strategies = ["direction-sampling", "lattice"]\nangle_noise = [0.0, 0.001]\n'
    runs = read_sweep(table(tmp_path / "t.toml", text + "samples = 30\n"))
    told = [(r.options.strategy, r.options.arm.physics, r.options.arm.angle_noise) for r in runs]
    assert told == [
        ("direction-sampling", "open_loop", 0.0),
        ("direction-sampling", "open_loop", 0.001),
        ("lattice", "guided", 0.0),
        ("lattice", "guided", 0.001),
    ]
    assert len({r.name for r in runs}) == 4
    line = f"robot,learner,seed,strategy,samples,angle_noise\n2r,{LEARNER},0,lattice,30,0.001\n"
    assert read_sweep(table(tmp_path / "t.csv", line)) == runs[3:]


def test_all_options_of_a_run_are_columns():
    known = {f.name for kind in (RunOptions, ArmOptions) for f in fields(kind)}
    assert known - set(OPTIONS) == {
        "settings",  # the column is called set, as the option
        "robot",
        "learner",
        "seed",
        "arm",
        "discovery_arm",
        "learn_anyway",
        "tolerance",  # a sweep always learns, and judges nothing
    }


def test_settings_are_a_column(tmp_path):
    text = f'robots = ["pendulum"]\nlearners = ["{LEARNER}"]\nset = ["", "epsilon=0.2 sigma=0"]\n'
    plain, chosen = read_sweep(table(tmp_path / "t.toml", text))
    assert plain.options.settings.values == ()
    assert chosen.options.settings.exploration.step_width == 0.2
    assert chosen.option("set") == "exploration.noise=0 exploration.step_width=0.2"
    assert plain.name != chosen.name
    refused = {
        "epsilon=much": "accepted: a number",
        "epsilon": "NAME=VALUE",
        "'epsilon=0.2": "quoted as in a shell",
    }
    for value, accepted in refused.items():
        with pytest.raises(InputError, match=accepted):
            read_sweep(table(tmp_path / "t.toml", text.replace("epsilon=0.2 sigma=0", value)))


def test_a_lattice_is_learned_from(tmp_path, capsys):
    text = f'robots = ["pendulum"]\nlearners = ["{LEARNER}"]\nsamples = [16, 8]\n'
    text += 'strategies = ["direction-sampling", "lattice"]\nsymmetries = "none"\n'
    path = table(tmp_path / "t.toml", text)
    assert status(["sweep", str(path), "--out", str(tmp_path), "--jobs", "1", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    last = {(row["strategy"], row["samples"]): row["rmse"] for row in rows}
    assert last["lattice", 16] < 1e-3
    assert {row["strategy"] for row in rows} == {"direction-sampling", "lattice"}


UNFIT = """<robot name="rods"><link name="base"/><link name="rod"><inertial><mass value="1"/>
<origin xyz="0.1 0 0"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"><inertial><mass value="1e-30"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0"
iyz="0"/></inertial></link>
<joint name="a" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
</joint><joint name="b" type="continuous"><parent link="rod"/><child link="tip"/>
<axis xyz="0 1 0"/></joint>
</robot>"""


def test_a_refused_robot_names_itself_and_the_others_go_on(tmp_path, capsys):
    (tmp_path / "unfit.urdf").write_text(UNFIT)
    text = f'robots = ["{tmp_path}/unfit.urdf", "pendulum"]\nlearners = ["{LEARNER}"]\n'
    path = table(tmp_path / "t.toml", text + "samples = 10\n")
    assert status(["sweep", str(path), "--out", str(tmp_path / "out"), "--quiet"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    for word in ("unfit.urdf", LEARNER, "rods", "sweep.csv"):
        assert word in error
    with (tmp_path / "out" / "sweep.csv").open() as file:
        assert {row["robot"] for row in csv.DictReader(file)} == {"pendulum"}
    assert (tmp_path / "out" / "sweep.svg").exists()


def test_a_robot_of_a_table_has_the_options_of_a_command(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(
        "robot,learner,seed,lock,payload,snap\n"
        "3r,trigonometric,0,elbow=0.5 *roll,1.5,false\n"
        "3r,trigonometric,0,,,\n"
    )
    part, whole = read_sweep(path)
    wanted = RobotOptions("3r", snap=False, lock=["elbow=0.5", "*roll"], payload=1.5)
    assert part.options.robot == wanted
    assert whole.options.robot == RobotOptions("3r")
    assert part.name != whole.name
    assert part.digest == load_robot(wanted).digest != whole.digest
    assert told_options([part, whole]) == ["snap", "lock", "payload"]
    assert part.option("lock") == "elbow=0.5 '*roll'"
    path.write_text("robot,learner,seed,lock\n3r,trigonometric,0,q9\n")
    with pytest.raises(InputError, match="row 2: --lock"):
        read_sweep(path)
    path.write_text("robot,learner,seed\n-,trigonometric,0\n")
    with pytest.raises(InputError, match="row 2: robot is standard input"):
        read_sweep(path)
