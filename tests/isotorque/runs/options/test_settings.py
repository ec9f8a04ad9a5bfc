"""Settings chosen by name: read, checked before anything moves, recorded, and effective."""

import json
import shlex
from dataclasses import fields, is_dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.cli.main import status
from isotorque.learning.learners.registry import LEARNERS, LearningTask, learner_by_name
from isotorque.runs.options.run_options import ArmOptions, RunOptions
from isotorque.runs.options.settings import SYMBOLS, Settings, check_learner_settings
from isotorque.symbolic.common.errors import InputError

PLAIN = [
    (section, f.name)
    for section in ("discovery", "exploration")
    for f in fields(getattr(Settings(), section))
    if not is_dataclass(getattr(getattr(Settings(), section), f.name))
]


@given(st.sets(st.sampled_from(PLAIN)), st.randoms())
def test_what_is_chosen_arrives_and_nothing_else_changes(names, random):
    usual = Settings()
    words, chosen = [], {}
    for section, name in names:
        value = getattr(getattr(usual, section), name)
        if type(value) is int:
            value += random.randrange(1, 9)
        elif type(value) is float:
            value *= random.uniform(0.2, 0.9)
        elif type(value) is bool:
            value = not value
        else:
            value = None
        chosen[section, name] = value
        words.append(f"{section}.{name}={'none' if value is None else str(value)}")
    settings = Settings.of([word.replace("True", "yes").replace("False", "no") for word in words])
    for section, name in PLAIN:
        expected = chosen.get((section, name), getattr(getattr(usual, section), name))
        assert getattr(getattr(settings, section), name) == expected
    assert Settings.of(settings.words) == settings
    assert Settings().joined(json.loads(json.dumps(dict(settings.values)))) == settings


@pytest.mark.parametrize("symbol", SYMBOLS)
def test_every_symbol_of_the_paper_names_a_setting(symbol):
    value = "yes" if symbol == "from_trajectories" else "1"
    settings = Settings.of([f"{symbol}={value}"])
    check_learner_settings("local-linear-map", settings.learner, LearningTask())


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["epsilon"], "NAME=VALUE"),
        (["epsilon=much"], "accepted: a number"),
        (["exploration.window=2.5"], "accepted: a whole number"),
        (["exploration.to_boundary=1"], "accepted: yes or no"),
        (["exploration.step=1"], "exploration.step_width"),
        (["scheme.n_min=3"], "scheme.max_targets"),
        (["epsilon=1", "exploration.step_width=2"], "exploration.step_width once"),
        (["p_home=1.5"], "from 0.0 to 1.0"),
        (["discovery.babbling=0"], "at least 1"),
        (["scheme.max_targets=0"], "at least 1"),
    ],
)
def test_what_there_is_not_is_refused(words, named):
    with pytest.raises(InputError, match=named):
        Settings.of(words)


@pytest.mark.parametrize("name", sorted(LEARNERS))
def test_every_parameter_of_a_learner_can_be_given_its_own_value(name):
    task = LearningTask(robot="2r")
    usual = learner_by_name(name, None, task).get_params(deep=False)
    plain = {k: v for k, v in usual.items() if k not in ("group", "random_state", "robot")}
    check_learner_settings(name, plain, task)


@pytest.mark.parametrize(
    ("chosen", "named"),
    [
        ({"hidden": 5}, "learner.radius"),
        ({"group": 5}, "learner.radius"),
        ({"radius": -1.0}, "radius"),
        ({"radius": "wide"}, "a number"),
        ({"replay": 0.5}, "a whole number"),
    ],
)
def test_a_learner_refuses_what_it_has_not(chosen, named):
    with pytest.raises(InputError, match=named):
        check_learner_settings("local-linear-map", chosen, LearningTask())


def test_the_learner_that_is_named_gets_them():
    options = RunOptions("2r", learner="network", settings=Settings.of(["learner.hidden=7"]))
    assert learner_by_name("network", None, options.task(2)).hidden == 7
    with pytest.raises(InputError, match="rigid chain"):
        RunOptions("2r", learner="rigid-chain", settings=Settings.of(["learner.max_starts=7"]))


def test_a_run_is_made_with_them_and_resumes_with_them_alone(tmp_path, capsys):
    out = str(tmp_path / "out")
    command = ["discover", "pendulum", "--out", out, "--quiet"]
    assert status([*command, "--set", "discovery.babbling=20"]) == 0
    assert status([*command, "--set", "discovery.babbling=20"]) == 0  # the same goes on
    capsys.readouterr()
    assert status(command) == 2
    assert "babbling" in capsys.readouterr().err
    more = ["--samples", "40", "--set", "epsilon=0.5", "--set", "learner.radius=0.2"]
    assert status(["learn", "pendulum", "--out", out, *more, "--quiet", "--json"]) == 0
    model = json.loads((tmp_path / "out" / "model.json").read_text())
    assert model["parameters"]["settings"]["radius"] == 0.2
    capsys.readouterr()
    assert status(["learn", "pendulum", "--out", out, "--samples", "40", "--quiet"]) == 2


def test_fewer_torques_are_tried_where_fewer_are_asked_for(tmp_path, capsys):
    motions = []
    for babbling in (20, 60):
        out = tmp_path / str(babbling)
        words = ["--set", f"discovery.babbling={babbling}", "--quiet", "--json"]
        assert status(["discover", "pendulum", "--out", str(out), *words]) == 0
        found = json.loads(capsys.readouterr().out)
        motions.append(sum(found[key] for key in ("settled", "limit_hits", "timeouts")))
    assert motions[0] < motions[1]


@pytest.mark.parametrize(
    ("line", "named"),
    [
        ("discover 2r --out OUT --set epsilon=0.2", "discovery.NAME or scheme.NAME"),
        ("run 2r --out OUT --set learner.hidden=3", "learner.radius"),
        ("run 2r --out OUT --learner rigid-chain --set learner.max_starts=3", "rigid chain"),
        ("learn 2r --out OUT --data x.csv --set learner.hidden=3", "--learner"),
        ("learn 2r --out OUT --data x.csv --learner network --set epsilon=3", "learner.NAME"),
        ("learn --out OUT --data x.csv --set learner.hidden=3", "--set with no ROBOT"),
    ],
)
def test_settings_that_change_nothing_are_refused(line, named, tmp_path, capsys):
    words = [str(tmp_path / "out") if word == "OUT" else word for word in shlex.split(line)]
    assert status(words) == 2
    said = capsys.readouterr().err
    assert named in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_arm_has_no_part_in_them():
    assert RunOptions("2r", ArmOptions()) == RunOptions("2r", settings=Settings.of([]))
