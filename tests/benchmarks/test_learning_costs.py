"""The benchmark of learning costs: its peers learn what they should, its tables can be read."""

import json

import numpy as np
import pytest
from sklearn.linear_model import LinearRegression

from benchmarks.learning_costs.__main__ import Figure, Row, main, measure, table, take_turns
from benchmarks.learning_costs.contests import Bench, Contestant, per_item
from benchmarks.learning_costs.peers import (
    linear_regression,
    online_features,
    online_network,
    products,
)
from benchmarks.peers.literal_map import ArrayMap, LiteralMap
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap

KINDS = (LiteralMap, ArrayMap)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("robot", "grouped"), [("2r", False), ("2r", True), ("ur5", True)])
def test_the_literal_map_predicts_as_ours(kind, robot, grouped):
    """All responsibilities count (cutoff 6.5), so predictions differ by rounding alone."""
    bench = Bench(robot)
    ours = LocalLinearMap(
        0.3,
        learning_rate=0.4,
        inner_iterations=2,
        cutoff=6.5,
        group=bench.group if grouped else None,
    )
    q, torque = bench.random(15, 5)
    ours.fit(q[:1], torque[:1])
    literal = kind.like(ours)  # with one prototype
    ours.partial_fit(q[1:], torque[1:])
    literal.partial_fit(q[1:], torque[1:])
    assert len(literal.prototypes) == ours.n_prototypes_ > 10
    near = q + np.random.default_rng(6).normal(0.0, 0.2, q.shape)
    assert np.abs(literal.predict(near) - ours.predict(near)).max() < 1e-12
    handed_over = kind.like(ours)
    assert np.abs(handed_over.predict(near) - ours.predict(near)).max() < 1e-12


@pytest.mark.parametrize("kind", KINDS)
def test_the_literal_map_starts_from_nothing(kind):
    """Without a prototype and without a group: the first sample becomes one."""
    bench = Bench("2r")
    q, torque = bench.random(40, 7)
    literal = kind(0.3, 0.4, 1.5, distance=np.eye(2)).partial_fit(q, torque)
    ours = LocalLinearMap(0.3, learning_rate=0.4, kernel_width=1.5, cutoff=6.5).fit(q, torque)
    assert np.abs(literal.predict(q) - ours.predict(q)).max() < 1e-12


@pytest.mark.parametrize("options", [{"inner_iterations": None}, {"replay": 2}])
def test_the_literal_map_is_no_stand_in_for_what_the_paper_has_not(options):
    ours = LocalLinearMap(**options).fit([[0.0, 0.0]], [[1.0, 2.0]])
    with pytest.raises(ValueError, match="replay"):
        LiteralMap.like(ours)


def test_product_features_hold_the_torque_of_a_rigid_arm():
    bench = Bench("3r")
    assert products(bench.q).shape == (len(bench.q), 27)
    fitted = LinearRegression(fit_intercept=False).fit(products(bench.q), bench.torque)
    assert np.abs(fitted.predict(products(bench.q)) - bench.torque).max() < 1e-10
    assert bench.rmse(linear_regression(bench.group).fit(*bench.lattice(8))) < 1e-10


@pytest.mark.parametrize("make", [online_network, online_features])
def test_online_peers_learn(make):
    """A fifth of the torque is left at most, and the error falls with samples."""
    bench = Bench("2r")
    peer, errors = make(bench.group, bench.scale), []
    for seed in range(2):
        for q, torque in zip(*bench.random(200, seed), strict=True):
            peer.partial_fit(q[None], torque[None])
        errors.append(bench.rmse(peer))
    assert errors[1] < errors[0]
    assert errors[1] < 0.2 * np.sqrt(np.mean(bench.torque**2))


def test_turns_are_interleaved_and_ratios_taken_within_them():
    order = []
    seconds = {"ours": iter([1.0, 2.0, 4.0]), "peer": iter([3.0, 4.0, 20.0])}

    def run(name):
        order.append(name)
        return next(seconds[name])

    figures = take_turns(
        [
            Contestant("ours", lambda: run("ours")),
            Contestant("peer", lambda: run("peer"), ("ours",), lambda: 0.5),
        ],
        3,
    )
    assert order == ["ours", "peer"] * 3
    assert figures["ours"] == Figure(2.0, {}, None)
    assert figures["peer"] == Figure(4.0, {"ours": 3.0}, 0.5)  # ratios 3, 2, 5


def test_who_is_too_late_is_given_up_and_who_is_slow_skips_turns(monkeypatch):
    monkeypatch.setattr("benchmarks.learning_costs.__main__.LIMIT", 1.0)
    monkeypatch.setattr("benchmarks.learning_costs.__main__.PATIENCE", 0.02)
    runs = []

    def endless():
        runs.append("endless")
        while True:
            pass

    def slow():
        runs.append("slow")
        return per_item(lambda: None, 1)

    monkeypatch.setattr("benchmarks.learning_costs.contests.LEAST", 0.03)
    found = take_turns(
        [
            Contestant("fast", lambda: 0.02),
            Contestant("slow", slow, ("fast",)),
            Contestant("endless", endless, ("fast",)),
        ],
        3,
    )
    assert runs == ["slow", "endless"]
    assert found["slow"].seconds is not None
    assert found["endless"] == Figure(None, {"fast": 50.0}, None)
    row = Row("2r (8)", "endless", {"8 samples": found["endless"]})
    assert "| > 1 | > 50 (fast) |  |" in table([row], "s")


@pytest.fixture(scope="module")
def short():
    return dict(measure("2r", turns=1, known=30, fitted=[16]))


def test_a_short_run_measures_everything(short):
    counts = {}
    for title, rows in short.items():
        ours = {row.learner for row in rows}
        found = [figure for row in rows for figure in row.figures.values()]
        assert all(figure.seconds > 0 for figure in found)
        assert all(set(figure.ratios) <= ours for figure in found)
        ratios = [ratio for figure in found for ratio in figure.ratios.values()]
        assert np.isfinite(ratios).all()
        assert min(ratios) > 0
        counts[title] = len(ratios)
    assert counts == {"Updates": 8, "Predictions": 12, "Batch fits": 4}
    errors = {row.learner: row.figures["16 samples"].rmse for row in short["Batch fits"]}
    assert max(errors["trigonometric"], errors["parametric"], errors["LinearRegression"]) < 1e-10
    literal = {row.learner: row.figures["one by one"].rmse for row in short["Updates"]}
    assert literal["literal LLM, loops"] == literal["LLM"]


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_three_tables_are_printed(short, options, monkeypatch, capsys):
    monkeypatch.setattr(
        "benchmarks.learning_costs.__main__.measure", lambda *_: iter(short.items())
    )
    monkeypatch.setattr("sys.argv", ["learning_costs", "2r", *options])
    main()
    text = capsys.readouterr().out
    if options:
        assert list(json.loads(text)) == ["Updates", "Predictions", "Batch fits"]
        return
    lines = text.splitlines()
    assert [line for line in lines if line.startswith("#")] == [
        "### Updates",
        "### Predictions",
        "### Batch fits",
    ]
    rows = [line for line in lines if line.startswith("| 2r (8) | ")]
    assert len(rows) == 9 + 10 + 7
    widths = [line.count("|") for line in lines if line.startswith("|")]
    assert widths == [6] * 11 + [8] * 12 + [6] * 9
