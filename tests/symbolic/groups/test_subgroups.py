import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.groups.subgroups import generated, largest_subgroups

PERMUTATIONS = list(itertools.permutations(range(4)))
TABLE = np.array(
    [[PERMUTATIONS.index(tuple(a[i] for i in b)) for b in PERMUTATIONS] for a in PERMUTATIONS]
)
"""The symmetric group of order 24."""


def closed(members):
    return all(TABLE[i, j] in members for i in members for j in members)


@given(st.frozensets(st.integers(0, 23), min_size=1))
def test_generated_subgroups_are_closed_and_smallest(members):
    found = generated(TABLE, members)
    assert members <= found
    assert closed(found)
    assert 24 % len(found) == 0
    assert all(generated(TABLE, frozenset({i})) <= found for i in members)


@given(st.frozensets(st.integers(1, 23)))
def test_the_largest_subgroup_of_allowed_elements(forbidden):
    allowed = np.array([i not in forbidden for i in range(24)])
    found = largest_subgroups(TABLE, allowed, lambda members: 1.0)
    assert closed(found)
    assert not forbidden & set(found)
    pairs = itertools.combinations([i for i in range(24) if allowed[i]], 2)
    larger = max(
        (len(g) for g in (generated(TABLE, frozenset(p)) for p in pairs) if not g & forbidden),
        default=1,
    )
    assert len(found) >= larger  # subgroups of S4 need two generators at most


def test_a_refused_subgroup_is_not_taken():
    found = largest_subgroups(TABLE, np.ones(24, dtype=bool), lambda m: float(len(m) <= 8))
    assert len(found) == 8


def test_the_identity_is_left_at_last():
    assert largest_subgroups(TABLE, np.ones(24, dtype=bool), lambda m: 0.0) == [0]
