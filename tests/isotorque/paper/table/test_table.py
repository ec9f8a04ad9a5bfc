"""Rules and rows of the paper's table."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.paper.equal_errors import samples_needed
from isotorque.paper.experiments.experiments import EXPERIMENTS
from isotorque.paper.table.items import ITEMS
from isotorque.paper.table.rules import above, at_least, at_most, below, close_to, equal, within
from isotorque.paper.table.table import Item, make_rows
from isotorque.symbolic.common.errors import InputError

positive = st.floats(1e-6, 1e6)


def item(rule, paper=1.0, why=lambda numbers: "because", **more):
    return Item("x", "1", "e", lambda n: n["x"], paper, "", rule, why, **more)


@given(positive, positive, st.floats(0.0, 0.9))
def test_rules_say_what_they_say(paper, measured, slack):
    assert at_most(slack).holds(paper, measured) == (measured <= paper * (1 + slack))
    assert at_least(slack).holds(paper, measured) == (measured >= paper * (1 - slack))
    assert within(slack).holds(paper, measured) == (abs(measured - paper) <= slack * paper)
    assert below(paper, "").holds("words", measured) == (measured < paper)
    assert above(paper, "").holds("words", measured) == (measured > paper)
    assert equal().holds(paper, paper)


@pytest.mark.parametrize("missing", [None, math.inf, math.nan])
def test_what_was_not_reached_holds_no_rule(missing):
    for rule in (at_most(), at_least(), within(0.5), below(1e9, ""), above(-1.0, "")):
        assert not rule.holds(1.0, missing)


def test_lists_are_compared_entry_by_entry():
    assert close_to(0.1, "").holds([[0.0, 1.0]], [[0.05, 1.0]])
    assert not close_to(0.1, "").holds([[0.0, 1.0]], [[0.2, 1.0]])
    assert not close_to(0.1, "").holds([0.0, 1.0], [0.0])


@given(st.lists(st.floats(0.0, 10.0), min_size=1, max_size=9))
def test_a_row_shows_the_median_and_the_extremes(values):
    (row,) = make_rows([item(at_most(), 5.0)], {"e": [{"x": v} for v in values]})
    assert row.ours == pytest.approx(np.median(values))
    assert row.holds == (np.median(values) <= 5.0)
    assert (row.interval is None) == (len(values) == 1)
    if row.interval is not None:
        assert row.interval == (min(values), max(values))


def test_a_seed_that_did_not_reach_it_counts_as_worst():
    (row,) = make_rows([item(at_most(), 5.0)], {"e": [{"x": 1.0}, {"x": None}, {"x": 2.0}]})
    assert row.ours == 2.0
    assert row.interval == (1.0, None)
    (row,) = make_rows([item(at_most(), 5.0)], {"e": [{"x": None}, {"x": None}, {"x": 2.0}]})
    assert row.ours is None
    assert not row.holds


def test_a_row_that_does_not_hold_must_say_why():
    (row,) = make_rows([item(at_most(), why=lambda n: f"it is {n['x']:g}")], {"e": [{"x": 2.0}]})
    assert row.why == "it is 2"
    with pytest.raises(InputError, match="reason"):
        make_rows([item(at_most(), why=lambda n: " ")], {"e": [{"x": 2.0}]})
    (row,) = make_rows([item(at_most())], {"e": [{"x": 0.5}]})
    assert row.why == ""


def test_a_row_of_two_experiments_takes_numbers_seed_by_seed():
    both = Item("x", "1", "a+b", lambda n: n["a.x"] - n["b.x"], 0, "", equal(), lambda n: "differ")
    assert make_rows([both], {"a": [{"x": 1}]}) == []
    (row,) = make_rows([both], {"a": [{"x": 3}, {"x": 5}], "b": [{"x": 1}, {"x": 1}]})
    assert row.interval == (2.0, 4.0)


def test_every_row_belongs_to_an_experiment():
    names = {entry.name for entry in EXPERIMENTS}
    assert len(names) == len(EXPERIMENTS)
    assert {name for entry in ITEMS for name in entry.experiment.split("+")} == names


@given(st.dictionaries(st.integers(1, 10**6), positive, min_size=1), positive)
def test_samples_needed_lie_between_enough_and_too_few(curve, error):
    found = samples_needed(curve, error)
    counts = sorted(curve)
    if found is None:
        assert curve[counts[-1]] > error
    else:
        assert counts[0] <= found <= counts[-1] * (1 + 1e-12)
        assert all(curve[n] <= error for n in counts if n >= found * (1 + 1e-12))
