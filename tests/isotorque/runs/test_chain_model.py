"""The model that a run ends with: a rigid chain where one is accepted, another where not."""

import json

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.learning.files.saved_models import load_model
from isotorque.learning.learners.rigid.chain_watch import ChainWatch
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot


def run(out, *words):
    """Exit status and report of a run."""
    code = status(["run", *words, "--out", str(out), "--quiet"])
    assert code in (0, 1)
    return code, json.loads((out / "report.json").read_text())


@pytest.mark.parametrize(
    "robot", ["2r", "ur5", "panda", pytest.param("3r", marks=pytest.mark.slow)]
)
def test_the_model_is_the_chain_and_right_everywhere(robot, tmp_path):
    code, report = run(tmp_path, robot, "--samples", "40")
    assert code == 0, report["summary"]
    assert report["chain"]["known_after"] <= 12
    assert report["chain"]["later"] >= 10
    assert any("knew the whole map after" in part for part in report["summary"])
    assert report["totals"]["relations_found"] == report["totals"]["relations_true"]
    saved = load_model(tmp_path)
    assert isinstance(saved.learner, RigidChain)
    assert saved.notes["learner"] == "rigid-chain"
    gravity = GravityModel(load_robot(robot))
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (500, gravity.n))
    truth = gravity.torque(q)
    assert np.abs(saved.learner.predict(q) - truth).max() < 1e-6 * np.abs(truth).max()
    # joints that stood still are named, not passed over
    stood = report["setup"]["robot"] == "ur5"
    assert any("taken to be free of gravity" in r for r in report["remarks"]) == stood


def test_another_learner_that_is_named_is_the_model(tmp_path):
    _, report = run(tmp_path, "2r", "--samples", "30", "--learner", "recursive-least-squares")
    assert report["chain"] is None
    assert report["setup"]["learner"] == "recursive-least-squares"
    assert not isinstance(load_model(tmp_path).learner, RigidChain)


def test_where_no_chain_explains_the_samples_another_model_is_saved_and_that_is_said(
    tmp_path, monkeypatch
):
    add = ChainWatch.add
    # what the chain is shown of the arm has springs in its joints
    monkeypatch.setattr(ChainWatch, "add", lambda self, q, tau: add(self, q, tau + 6.0 * q))
    _, report = run(tmp_path, "2r", "--samples", "40")
    assert report["chain"]["accepted"] is False
    assert report["setup"]["learner"] == "local-linear-map-it"
    assert any(
        "not accepted" in part and "the model is local-linear-map-it" in part
        for part in report["summary"]
    )
    assert not isinstance(load_model(tmp_path).learner, RigidChain)
