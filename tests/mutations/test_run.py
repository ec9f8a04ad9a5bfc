"""Mutants are planted in copies, never here; a share of the catalogue is killed each week."""

import datetime
import os

import pytest

from tests.mutations.catalogue import MUTATIONS
from tests.mutations.mutation import Mutation
from tests.mutations.planting import ROOT, Outcome, Result, reaches_compiled
from tests.mutations.run import Results, report, run, share_of

LIMITS = "symbolic/common/joint_limits.py"
TESTS = ("tests/symbolic/common/test_joint_limits.py",)
KILLED = Mutation(LIMITS, "TURN = 2.0 * np.pi", "TURN = 2.1 * np.pi", TESTS, "a turn")
SURVIVOR = Mutation(LIMITS, "NO_LIMIT = 1e6", "NO_LIMIT = 1.1e6", TESTS, "nothing")
BROKEN = Mutation(LIMITS, "import math\n", "import maths\n", TESTS, "nothing")


def results(*outcomes):
    pairs = [(m, Result(outcome, "", 1.0)) for m, outcome in outcomes]
    return Results(tuple(pairs), 60.0)


def test_a_survivor_fails_the_run_unless_it_is_listed_as_equivalent():
    equivalent = Mutation(LIMITS, "1e6", "2e6", TESTS, "nothing", equivalent="no limit is near")
    good = results((KILLED, Outcome.KILLED), (equivalent, Outcome.SURVIVED))
    assert good.status == 0
    assert "2 mutations, 1 killed, 0 survived, 1 listed as equivalent" in report(good, 2)
    bad = results((KILLED, Outcome.KILLED), (SURVIVOR, Outcome.SURVIVED))
    assert bad.status == 1
    assert "Survivors" in report(bad, 2)
    assert results((BROKEN, Outcome.BROKEN), (SURVIVOR, Outcome.SURVIVED)).status == 2


def test_what_compiled_functions_see_is_compiled_anew():
    assert reaches_compiled("symbolic/gravity/recursion_kernels.py")
    assert reaches_compiled("learning/simulator/compiled/finish.py")  # by a decorator of its own
    assert reaches_compiled("learning/simulator/dynamics/step_control.py")  # constants of these
    assert reaches_compiled("symbolic/common/angles.py")  # imported by compiled modules
    assert not reaches_compiled("verify/verdict.py")


@pytest.mark.slow
def test_mutants_are_killed_survive_or_do_not_start():
    before = (ROOT / LIMITS).read_bytes()
    found, status = run([KILLED, SURVIVOR, BROKEN], 2, lambda line: None)
    assert [result.outcome for _, result in found.pairs] == ["killed", "survived", "broken"]
    assert status == 2
    assert "test_joint_limits.py::test_" in found.pairs[0][1].by
    assert (ROOT / LIMITS).read_bytes() == before


@pytest.mark.slow
def test_a_share_of_the_catalogue_is_killed():
    """Eight mutants, others each week; ISOTORQUE_MUTATION_SEED chooses."""
    year, week, _ = datetime.date.today().isocalendar()
    seed = int(os.environ.get("ISOTORQUE_MUTATION_SEED", 100 * year + week))
    chosen = share_of(MUTATIONS, 8 / len(MUTATIONS), seed)
    found, status = run(chosen, 2, print)
    assert status == 0, f"seed {seed}\n{report(found, 2)}"
