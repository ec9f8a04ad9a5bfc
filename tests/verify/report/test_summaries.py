"""Summaries count what happened, and keep pictures small."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.learning.arm import LimitHit, Playback, Settled, TimedOut
from isotorque.learning.exploration.exploration import ExplorationStep
from isotorque.learning.exploration.targets import Phase
from isotorque.learning.scheme import Discovery, GateDecision
from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.report.summaries import (
    MOST_POINTS,
    MOST_TIMES,
    summarise_discovery,
    summarise_domain,
    summarise_exploration,
    summarise_static_torques,
    thinned,
)


def motion(kind, target=None, new=False, steps=1000):
    outcome = kind(np.array([0.1, 0.2]), np.array([1.0, 2.0]), 3.0)
    playback = None
    if target is not None:
        times = np.linspace(5.0, 9.0, steps)
        playback = Playback(outcome, times, np.outer(times, [1, 2]), np.outer(times, [3, 4]))
    return Discovery(target, outcome, playback, new)


def test_discovery_is_counted():
    one, two = np.array([1.0, 2.0]), np.array([3.0, -1.0])
    motions = [
        motion(Settled, new=True),
        motion(LimitHit),
        motion(Settled, one, new=True),
        motion(TimedOut, one),
        motion(Settled, two, new=True),
        motion(Settled, two, new=True),
        motion(LimitHit, two),
    ]
    gates = [GateDecision(1, 1, False, "3 more torques"), GateDecision(2, 8, True, None)]
    report = summarise_discovery(motions, gates, n_min=4)
    assert (report.profiles, report.babbling) == (5, 2)
    assert (report.settled, report.limit_hits, report.timeouts) == (4, 2, 1)
    assert report.targets.tolist() == [[1.0, 2.0], [3.0, -1.0]]
    assert report.discovered.tolist() == [1, 2]
    assert [gate.missing for gate in report.gates] == ["3 more torques", ""]
    # the traces are those of the torque that discovered most
    assert [trace.outcome for trace in report.traces] == ["settled", "settled", "limit"]
    trace = report.traces[0]
    assert trace.times[0] == 0.0
    assert trace.times[-1] == 4.0
    assert len(trace.times) == MOST_TIMES
    assert trace.final.tolist() == [0.1, 0.2]


def test_a_discovery_without_profiles():
    report = summarise_discovery([motion(Settled)], [], n_min=2)
    assert report.traces == ()
    assert report.targets.shape == (0, 2)
    assert summarise_discovery([], [], n_min=2).settled == 0


def step(kind, q, learned=True, explored=None):
    outcome = kind(np.array(q), np.array([1.0, 2.0]), 1.0)
    return ExplorationStep(
        0,
        next(iter(Phase)),
        None,
        outcome.torque,
        True,
        outcome,
        learned,
        1.0,
        0.0,
        False,
        explored,
        None,
    )


def test_exploration_is_counted_and_multiplied(two_link):
    steps = [
        step(Settled, [-0.5, -0.4], explored=0.1),
        step(LimitHit, [3.0, 3.0], learned=False, explored=0.1),
        step(Settled, [-0.7, -0.4], explored=0.3),
    ]
    report = summarise_exploration(steps, two_link.group)
    assert (report.commands, report.settled, report.limit_hits) == (3, 2, 1)
    assert report.projected == 3
    assert report.explored_share == 0.3
    assert report.explored.tolist() == [[-0.5, -0.4], [-0.7, -0.4]]
    assert len(report.images) == 2 * 7
    torque = np.abs(two_link.gravity.torque(report.images))
    expected = np.abs(two_link.gravity.torque(report.explored))
    assert np.allclose(torque, np.tile(expected, (7, 1)))
    assert summarise_exploration(steps, None).images.shape == (0, 2)
    assert summarise_exploration([], None).commands == 0


def test_static_torques_are_those_of_the_set():
    estimate = StaticTorqueSet(2)
    estimate.add(np.random.default_rng(0).uniform(-1, 1, (300, 2)) * [20, 5])
    estimate.mark_inadmissible([30.0, 1.0])
    report = summarise_static_torques(estimate)
    assert np.array_equal(report.admissible, estimate.torques)
    assert report.inadmissible == pytest.approx(estimate.inadmissible)
    assert report.triangles.shape[1:] == (3, 2)
    area = np.abs(np.linalg.det(np.diff(report.triangles, axis=1))).sum() / 2
    assert 0.7 * 40 * 10 < area <= 40 * 10


@pytest.mark.parametrize("name", ["pendulum", "2r", "3r"])
def test_domains(arms, name):
    domain = FundamentalDomain(primary_symmetries(arms[name].gravity.potential))
    report = summarise_domain(domain)
    assert report.order == arms[name].group.order
    assert report.volume == pytest.approx((2 * np.pi) ** arms[name].gravity.n / report.order)
    if name == "2r":
        assert np.all(domain.contains_y(report.polygon, 1e-6))
        assert report.images.shape == (8, *report.polygon.shape)
    else:
        assert report.polygon is None


def test_thinning_keeps_first_and_last():
    values = np.arange(3.0 * MOST_POINTS)[:, None]
    kept = thinned(values)
    assert len(kept) == MOST_POINTS
    assert kept[0] == values[0]
    assert kept[-1] == values[-1]
    assert np.array_equal(thinned(values[:5]), values[:5])
