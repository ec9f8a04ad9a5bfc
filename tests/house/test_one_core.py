"""One core decides what samples show beside gravity: nobody else tests whether a model fits."""

import ast
from pathlib import Path

import numpy as np
import pytest

from isotorque.learning.learners.rigid.causes import diagnose as of_chains
from isotorque.learning.relations import lack_of_fit as of_waves
from isotorque.learning.relations.learn_relations import learn_relations
from tests.learning.static_data import known_potential

ROOT = Path(__file__).parents[2]
DISTRIBUTIONS = ("scipy.stats", "isotorque.learning.statistics.tails")
OF_RELATIONS = {
    "examined_fit.py": "quantiles of bounds",
    "identification/group_fit.py": "whether a group of relations is contradicted",
    "identification/wave_identification.py": "which coefficients may be related",
    "pairing/a_contrario_test.py": "whether pairs are chance",
    "pairing/pair_evidence.py": "whether pairs contradict each other",
    "potential/potential_fit.py": "which frequencies are present",
    "testing/judge_candidates.py": "whether one relation is contradicted",
    "testing/nested_models.py": "whether a class of relations is contradicted",
    "testing/relation_errors.py": "quantiles of errors",
}
"""What relations ask distributions for: of relations, not of the model."""


def imported(path):
    """Modules that a file imports from or as a whole."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def asking(room):
    """Files below a room that import distributions."""
    return {
        str(path.relative_to(ROOT / room))
        for path in sorted((ROOT / room).rglob("*.py"))
        if any(name.startswith(DISTRIBUTIONS) for name in imported(path))
    }


@pytest.mark.parametrize(
    "room", ["isotorque/cli", "isotorque/runs", "verify", "learning/files", "learning/discovery"]
)
def test_front_door_and_judges_have_no_test_of_fit(room):
    assert asking(room) == set()
    assert len(list((ROOT / room).rglob("*.py"))) > 3


def test_relations_ask_distributions_of_relations_alone():
    assert asking("learning/relations") == set(OF_RELATIONS)


@pytest.mark.parametrize("module", [of_chains, of_waves])
def test_relations_of_samples_are_decided_by_the_core(module, monkeypatch):
    potential, _ = known_potential("2r")
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.0, 2.0, (30, 2))
    tau = potential.gradient(q) + [0.0, 0.5] + 0.02 * rng.normal(size=q.shape)

    class Asked(Exception):
        pass

    def ask(*_, **__):
        raise Asked

    assert learn_relations(q, tau).lack.offset_joints.tolist() == [1]
    monkeypatch.setattr(module, "selected", ask)
    if module is of_chains:  # waves see the constant, and have the last word
        assert learn_relations(q, tau).lack.offset_joints.tolist() == [1]
        tau = tau - [0.0, 0.5]
    with pytest.raises(Asked):
        learn_relations(q, tau)
