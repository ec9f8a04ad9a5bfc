"""``isotorque export``: files, JSON, refusals."""

import json

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.learning.export.array_files import read_export
from isotorque.learning.export.forms.torque_form import evaluate
from isotorque.learning.files.saved_models import SavedModel, save_model
from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
    SymmetricGaussianProcess,
)
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.learning.learners.registry import SAVED_LEARNERS
from isotorque.learning.learners.rigid.equivariant_trigonometric import EquivariantTrigonometric
from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.static_regressor import StaticRegressor
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.export.compiled_source import build, call, needs_cc
from tests.learning.export.fitted_models import QUICK, far_queries, samples

#: One of every kind that can be saved, and the kind of its export.
LEARNERS = [
    (LocalLinearMap(0.4), "local functions"),
    (RecursiveLeastSquares(), "local functions"),
    (FeedForwardNetwork(5, **QUICK), "tanh units"),
    (EquivariantTrigonometric(), "waves"),
    (StaticRegressor("2r"), "waves"),
    (RigidChain(), "rigid chain"),
    (RigidChainProcess(), "rigid chain and kernels"),
    (SymmetricGaussianProcess(0.1, length_scale=1.5), "kernels"),
]


@pytest.fixture
def export(capsys):
    def run(*arguments, expect=0):
        code = status(["export", *map(str, arguments), "--json"])
        captured = capsys.readouterr()
        assert code == expect, captured.err
        return json.loads(captured.out) if expect == 0 else captured.err

    return run


@pytest.fixture
def saved(tmp_path):
    def save(learner):
        robot = load_robot("2r")
        q, torque = samples("2r", 80)
        model = SavedModel(learner.fit(q, torque), "2r", robot.digest, robot.joint_names, {})
        folder = tmp_path / "run"
        folder.mkdir()
        save_model(model, folder)
        return folder, model

    return save


@needs_cc
@pytest.mark.parametrize(("learner", "kind"), LEARNERS)
def test_a_saved_model_in_all_three_forms(learner, kind, export, saved, tmp_path):
    import casadi

    folder, model = saved(learner)
    c, function, npz = (tmp_path / name for name in ("g.c", "g.casadi", "g.npz"))
    found = export(folder, "--c", c, "--casadi", function, "--npz", npz)
    assert found["kind"] == kind
    assert [found[k] for k in ("c", "casadi", "npz", "json")] == [
        str(c),
        str(function),
        str(npz),
        str(tmp_path / "g.json"),
    ]
    q = far_queries(2)
    expected = learner.predict(q)
    size = np.abs(expected).max()
    assert found["max_error"] < 1e-12 * size
    assert model.digest in c.read_text()
    _, library = build(c.read_text(), tmp_path)
    assert np.abs(call(library, q) - expected).max() < 1e-12 * size
    gravity = casadi.Function.deserialize(function.read_text())
    assert np.abs(np.array(gravity.map(len(q))(q.T)).T - expected).max() < 1e-12 * size
    arrays = read_export(npz)
    assert arrays.digest == model.digest
    assert np.abs(evaluate(arrays.form, q) - expected).max() < 1e-12 * size


def test_every_kind_that_can_be_saved_is_tried():
    assert {type(learner).__name__ for learner, _ in LEARNERS} == set(SAVED_LEARNERS)


@needs_cc
@pytest.mark.parametrize("robot", ["3r", "ur5"])
def test_a_robots_analytic_gravity(robot, export, tmp_path):
    c, npz = tmp_path / "g.c", tmp_path / "g.npz"
    found = export(robot, "--c", c, "--npz", npz)
    gravity = GravityModel(load_robot(robot))
    q = far_queries(gravity.n)
    expected = gravity.torque(q)
    _, library = build(c.read_text(), tmp_path)
    assert np.abs(call(library, q) - expected).max() < 1e-12 * np.abs(expected).max()
    arrays = read_export(npz)
    assert np.abs(evaluate(arrays.form, q) - expected).max() < 1e-12 * np.abs(expected).max()
    assert found["joints"] == list(gravity.joint_names)


def test_messages_name_the_files(saved, tmp_path, capsys):
    folder, _ = saved(RecursiveLeastSquares())
    assert status(["export", str(folder / "model.json"), "--c", str(tmp_path / "g.c")]) == 0
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "g.c" in captured.err
    assert "largest difference from the model" in captured.err


def test_something_must_be_written(export):
    assert "--c, --casadi or --npz" in export("2r", expect=2)


def test_the_model_itself_is_not_overwritten(export, saved):
    folder, _ = saved(RecursiveLeastSquares())
    before = (folder / "model.json").read_text()
    assert "another name" in export(folder, "--npz", folder / "model.npz", expect=2)
    assert (folder / "model.json").read_text() == before


def test_an_export_can_be_written_again(export, tmp_path):
    for _ in range(2):
        export("2r", "--npz", tmp_path / "g.npz")


@pytest.mark.parametrize(
    ("model", "options", "message"),
    [
        ("no_such_robot", ["--c", "g.c"], "no_such_robot"),
        ("missing/model.json", ["--c", "g.c"], "missing"),
        ("2r", ["--c", "no/such/directory/g.c"], "directory"),
        ("2r", ["--npz", "g.zip"], r".npz"),
    ],
)
def test_refusals(model, options, message, export, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    error = export(model, *options, expect=2)
    assert message in error
    assert len(error.splitlines()) == 1


MASSLESS = """<robot name="m"><link name="base"/><link name="arm"/>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


def test_everything_made_of_a_robot_without_masses_says_so(tmp_path, capsys):
    arm, said = tmp_path / "m.urdf", "no joint feels gravity: no mass in 'arm' (--allow-massless)"
    arm.write_text(MASSLESS)
    c, npz = tmp_path / "m.c", tmp_path / "m.npz"
    for words in (
        ["derive"],
        ["derive", "--latex"],
        ["derive", "--sympy"],
        ["derive", "--json"],
        ["symmetries", "--json"],
        ["export", "--c", c, "--npz", npz, "--json"],
    ):
        command = [words[0], arm, "--allow-massless", "--quiet", *words[1:]]
        assert status([str(word) for word in command]) == 0
        assert said in capsys.readouterr().out, words
    assert said in c.read_text()
    assert said in npz.with_suffix(".json").read_text()
    assert status(["derive", str(arm), "--allow-massless", "--quiet", "--c", str(c)]) == 0
    assert said in c.read_text()
