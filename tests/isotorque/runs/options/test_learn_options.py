"""``learn`` by every exploration and every learner, and beside a discovery made before."""

import json
import shutil
import sqlite3

import pytest

from isotorque.cli.main import status
from isotorque.learning.learners.registry import BATCH_LEARNERS, LEADER
from isotorque.learning.recordings.recording_reader import RecordingReader


@pytest.fixture(scope="module")
def discovered(tmp_path_factory):
    out = tmp_path_factory.mktemp("discovered")
    assert status(["discover", "2r", "--out", str(out), "--seed", "3", "--quiet"]) == 0
    return out


@pytest.fixture
def learn(capsys, discovered, tmp_path):
    def run(*options, expect=0, name="run"):
        out = tmp_path / name
        if not out.exists():
            shutil.copytree(discovered, out)
        arguments = ["learn", "2r", "--out", out, "--json", "--quiet", *options]
        capsys.readouterr()
        code = status([str(a) for a in arguments])
        captured = capsys.readouterr()
        assert code == expect, captured.err
        return json.loads(captured.out) if code == 0 else captured.err

    return run


def commands(out):
    with sqlite3.connect(out / "run.sqlite") as database:
        return list(database.execute("select * from command order by 1"))


@pytest.mark.parametrize("strategy", ["direction-sampling", "goal-babbling", "motor-babbling"])
def test_every_strategy_learns(learn, strategy, tmp_path):
    options = ("--strategy", strategy, "--learner", "recursive-least-squares", "--samples", 120)
    found = learn(*options)
    assert found["strategy"] == strategy
    assert found["samples"] == 120
    assert found["discovery_motions"] > 20
    assert found["rmse_torque"] < 0.0053  # the paper's, after 54,000 samples
    with RecordingReader(tmp_path / "run" / "run.sqlite") as reader:
        assert sum(c.commands for c in reader.counts() if c.part == "learn") >= 120
        ends = {c.outcome: c.commands for c in reader.counts() if c.part == "learn" and c.outcome}
    assert ends["settled"] > 110  # constrained to what the arm can hold
    assert learn(*options) == found  # again, from the recording


def test_a_guided_arm_is_led_along_the_directions(learn, tmp_path):
    options = ("--physics", "guided", "--learner", "recursive-least-squares", "--samples", 100)
    found = learn(*options)
    assert found["rmse_torque"] < 0.0053
    with RecordingReader(tmp_path / "run" / "run.sqlite") as reader:
        kinds = {c.kind: c.commands for c in reader.counts() if c.part == "learn"}
        samples = reader.samples(part="learn")
    assert kinds["hold"] == 100
    assert "apply" not in kinds
    assert len(samples.q) == 100


def test_goals_are_reached_without_symmetries_too(learn):
    options = ("--strategy", "goal-babbling", "--symmetries", "none", "--samples", 80)
    found = learn(*options, "--learner", "trigonometric")
    assert found["relations"] == 1
    assert found["rmse_torque"] < 1e-6


@pytest.mark.parametrize("learner", sorted(BATCH_LEARNERS))
def test_batch_learners_are_fitted_to_what_was_collected(learn, learner, shared_samples, tmp_path):
    shutil.copytree(shared_samples, tmp_path / "run")
    before = commands(tmp_path / "run")
    found = learn("--learner", learner, "--samples", 60)
    assert commands(tmp_path / "run") == before  # another fit of the same samples moves nothing
    assert [p["samples"] for p in found["curve"]] == [8, 16, 32, 60]
    assert found["rmse_torque"] < 0.02
    saved = json.loads((tmp_path / "run" / "model.json").read_text())
    assert saved["notes"]["learner"] == learner
    assert status(["verify", str(tmp_path / "run"), "--robot", "2r", "--tolerance", "0.05"]) == 0


@pytest.fixture(scope="module")
def shared_samples(discovered, tmp_path_factory):
    out = tmp_path_factory.mktemp("samples") / "run"
    shutil.copytree(discovered, out)
    arguments = ["learn", "2r", "--out", str(out), "--learner", LEADER, "--samples", "60"]
    assert status([*arguments, "--quiet"]) == 0
    return out


def test_what_is_not_given_is_as_in_the_discovery(learn, tmp_path):
    learn("--learner", "trigonometric", "--samples", 20)
    learn("--learner", "trigonometric", "--samples", 20, "--seed", 5, name="other")
    with RecordingReader(tmp_path / "run" / "run.sqlite") as reader:
        assert [p.info.seed for p in reader.parts] == [3, 3]
    with RecordingReader(tmp_path / "other" / "run.sqlite") as reader:
        assert [p.info.seed for p in reader.parts] == [3, 5]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--strategy", "parrot"), ["parrot", "goal-babbling", "lattice"]),
        (("--learner", "parrot"), ["parrot", "parametric"]),
        (("--n-min", 4), ["n_min"]),
        (("--no-snap",), ["snap"]),
    ],
)
def test_bad_or_contradicting_options_are_one_line(learn, options, words):
    message = learn("--samples", 5, *options, expect=2)
    assert message.count("\n") == 1
    for word in words:
        assert word in message


@pytest.mark.slow
def test_an_arm_that_hardly_holds_itself_is_guided_to_a_lattice(tmp_path, capsys):
    arguments = ["learn", "panda", "--out", str(tmp_path), "--samples", "255"]
    arguments += ["--json", "--quiet"]
    lattice = ["--strategy", "lattice", "--learner", "trigonometric"]
    assert status([*arguments, *lattice]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["relations"] == 2  # from the samples of the lattice
    assert found["rmse_torque"] < 1e-9


def test_one_run_has_one_way_of_learning(learn):
    learn("--learner", "trigonometric", "--samples", 20)
    assert "strategy" in learn(
        "--learner", "trigonometric", "--samples", 20, "--strategy", "motor-babbling", expect=2
    )


@pytest.mark.slow
def test_the_whole_scheme_runs_with_a_batch_learner(tmp_path, capsys):
    arguments = ["run", "2r", "--out", str(tmp_path), "--learner", "trigonometric"]
    assert status([*arguments, "--samples", "60", "--quiet", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["setup"]["learner"] == "trigonometric"
    assert document["model"]["targets"][0]["rmse"] < 1e-8
