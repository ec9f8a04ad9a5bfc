"""Tests of the instantaneous topological map against its rules, applied slowly."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.learners.local_linear.topological_map import TopologicalMap
from isotorque.symbolic.common.errors import InputError
from tests.learning.learners import planar_arm


def difference(a, b):
    return (a - b + np.pi) % (2 * np.pi) - np.pi


class SlowMap:
    """The rules of Jockusch and Ritter with nodes as dictionary entries that keep their names."""

    def __init__(self, spacing, adaptation):
        self.spacing, self.adaptation = spacing, adaptation
        self.nodes, self.edges, self.names = {}, set(), itertools.count()

    def add(self, y):
        name = next(self.names)
        self.nodes[name] = np.array(y)
        return name

    def adapt(self, y):
        if len(self.nodes) < 2:
            away = [np.linalg.norm(difference(w, y)) for w in self.nodes.values()]
            if not away or away[0] > self.spacing:
                self.add(y)
                if away:
                    self.edges.add(frozenset(self.nodes))
            elif away:
                name = next(iter(self.nodes))
                self.nodes[name] = self.nodes[name] + self.adaptation * difference(
                    y, self.nodes[name]
                )
            return
        order = sorted(self.nodes, key=lambda i: np.linalg.norm(difference(self.nodes[i], y)))
        n, s = order[:2]
        self.nodes[n] = self.nodes[n] + self.adaptation * difference(y, self.nodes[n])
        self.edges.add(frozenset((n, s)))
        w = {i: difference(x, y) for i, x in self.nodes.items()}
        for m in list(self.nodes):
            inside = np.dot(w[n] - w[s], w[m] - w[s]) < 0
            if m != s and frozenset((n, m)) in self.edges and inside:
                self.edges.discard(frozenset((n, m)))
                if not any(m in e for e in self.edges):
                    del self.nodes[m]
        if np.dot(w[n], w[s]) > 0 and np.linalg.norm(w[n]) > self.spacing:
            self.edges.add(frozenset((n, self.add(y))))
        if np.linalg.norm(w[n] - w[s]) < self.spacing / 2:
            del self.nodes[s]
            self.edges = {e for e in self.edges if s not in e}

    def picture(self):
        return (
            sorted(tuple(np.round(difference(x, 0), 9)) for x in self.nodes.values()),
            sorted(
                sorted(tuple(np.round(difference(self.nodes[i], 0), 9)) for i in e)
                for e in self.edges
            ),
        )


def picture(mapped):
    nodes = [tuple(np.round(difference(x, 0), 9)) for x in mapped.nodes]
    return sorted(nodes), sorted(sorted((nodes[i], nodes[j])) for i, j in mapped.edges)


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    joints=st.sampled_from([1, 2, 3]),
    adaptation=st.sampled_from([0.0, 0.1]),
)
def test_follows_the_rules(seed, joints, adaptation):
    """After every stimulus of a random walk: same nodes, same edges as by the rules."""
    rng = np.random.default_rng(seed)
    fast, slow = TopologicalMap(0.4, adaptation=adaptation), SlowMap(0.4, adaptation)
    for y in np.cumsum(rng.normal(0, 0.3, (60, joints)), axis=0):
        fast.adapt(y)
        slow.adapt(difference(y, 0))
        assert picture(fast) == slow.picture()


def test_a_node_in_between_cuts_the_long_edge():
    """Three nodes on a line: the edge over the middle one goes."""
    line = TopologicalMap(0.5)
    for y in ([0.0], [1.2], [0.6]):
        line.adapt(y)
    assert line.edges.tolist() == [[0, 1]]
    line.adapt([1.9])
    line.adapt([2.5])
    edges = {tuple(sorted(line.nodes[list(e)].ravel().round(1))) for e in line.edges}
    assert (0.0, 2.5) not in edges
    assert all(b - a <= 1.3 for a, b in edges)


def test_covers_what_was_visited_with_nodes_apart():
    """Uniform stimuli on the torus: nodes at least the spacing apart, every point near one."""
    rng = np.random.default_rng(0)
    group = planar_arm.group()
    mapped = TopologicalMap(0.5, group=group)
    for q in rng.uniform(-np.pi, np.pi, (4000, 2)):
        mapped.adapt(q)
    metric = sum(A.T @ A for A in group.A_sat)
    isometry = np.linalg.cholesky(metric / np.sqrt(np.linalg.det(metric))).T

    def distances(y):
        return np.linalg.norm(difference(mapped.nodes, y) @ isometry.T, axis=1)

    for i, y in enumerate(mapped.nodes):
        assert np.delete(distances(y), i).min() > 0.5
        assert mapped.neighbours(i)
    worst = max(distances(y).min() for y in rng.uniform(-np.pi, np.pi, (500, 2)))
    assert worst < 1.0


def test_walks_and_neighbourhoods_agree_with_comparing_all():
    """On a well connected map a walk finds the nearest node nearly always, and all in a ball."""
    rng = np.random.default_rng(1)
    mapped = TopologicalMap(0.4)
    for q in rng.uniform(-np.pi, np.pi, (5000, 2)):
        mapped.adapt(q)
    hits = found = there = 0
    for q in rng.uniform(-np.pi, np.pi, (200, 2)):
        away = np.linalg.norm(difference(mapped.nodes, q), axis=1)
        assert mapped.nearest(q) == int(np.argmin(away))
        hits += mapped.nearest(q, start=int(rng.integers(len(mapped)))) == int(np.argmin(away))
        ball = set(mapped.near(q, 1.0))
        assert all(away[i] <= 1.0 for i in ball)
        found, there = found + len(ball), there + int((away <= 1.0).sum())
    assert hits > 180
    assert found > 0.99 * there
    assert mapped.near([0.0, 0.0], 1e-9) == ()


def test_refuses_what_cannot_be_used():
    for options in ({"spacing": 0.0}, {"spacing": 0.1, "adaptation": 2.0}):
        with pytest.raises(InputError):
            TopologicalMap(**options)
    mapped = TopologicalMap(0.3)
    with pytest.raises(InputError, match="nodes"):
        mapped.nearest([0.0, 0.0])
    mapped.adapt([0.0, 0.0])
    for wrong in ([0.0], [np.nan, 0.0]):
        with pytest.raises(InputError, match="stimulus"):
            mapped.adapt(wrong)
