import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.relations.reachable_relation import is_executable
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from tests.learning.static_data import known_potential


@given(st.sampled_from(["2r", "3r"]), st.integers(0, 2**32 - 1))
def test_a_configuration_that_can_follow_proves_it(name, seed):
    _, group = known_potential(name)
    rng = np.random.default_rng(seed)
    relation = group[int(rng.integers(group.order))]
    limits = np.sort(rng.uniform(-np.pi, np.pi, (group.n, 2)), axis=1)
    q = rng.uniform(limits[:, 0], limits[:, 1], (4000, group.n))
    image = wrap(relation.configuration(q))
    follows = ((image >= limits[:, 0]) & (image <= limits[:, 1])).all(axis=1)
    if follows.any():
        assert is_executable(relation, limits)


@given(st.sampled_from(["2r", "3r"]), st.integers(0, 2**32 - 1))
def test_what_is_executable_is_found_by_a_finer_search(name, seed):
    _, group = known_potential(name)
    rng = np.random.default_rng(seed)
    relation = group[int(rng.integers(group.order))]
    middle, half = rng.uniform(-2, 2, group.n), rng.uniform(0.2, 1.0, group.n)
    limits = np.stack([middle - half, middle + half], axis=1)
    if is_executable(relation, limits):
        q = rng.uniform(limits[:, 0], limits[:, 1], (20_000, group.n))
        away = np.abs(wrap(relation.configuration(q) - middle)) - half
        assert away.max(axis=1).min() < 0.2


def test_without_limits_everything_is_executable():
    for name in ("2r", "3r", "4r-planar"):
        _, group = known_potential(name)
        assert all(is_executable(r, [[-np.pi, np.pi]] * group.n) for r in group)


def test_limits_exclude_the_upper_half():
    _, group = known_potential("2r")
    hanging = [[-3.0, -0.1], [-0.5, 0.5]]
    found = [is_executable(r, hanging) for r in group]
    assert found[0]
    assert not all(found)
    up = next(r for r in group if np.allclose(r.A, np.eye(2)) and not r.is_identity)
    assert not is_executable(up, [[-2.0, -1.0], [-0.5, 0.5]])


def test_bad_limits_are_refused():
    relation = known_potential("2r")[1][0]
    with pytest.raises(InputError, match="shape of limits"):
        is_executable(relation, [[0.0, 1.0]])
    with pytest.raises(InputError, match="lower <= upper"):
        is_executable(relation, [[1.0, 0.0], [0.0, 1.0]])


@pytest.mark.parametrize("name", ["3r", "ur5"])
def test_a_missing_limit_is_a_full_turn(name):
    _, group = known_potential(name)
    rng = np.random.default_rng(0)
    middle = rng.uniform(-1, 1, group.n)
    limits = np.stack([middle - 0.6, middle + 0.6], axis=1)
    for open_end in ([-np.inf, np.inf], [-1.0, np.inf], [-np.inf, 2.0], [-9.0, 9.0]):
        missing, turn = limits.copy(), limits.copy()
        missing[1], turn[1] = open_end, [-np.pi, np.pi]
        assert [is_executable(r, missing) for r in group] == [is_executable(r, turn) for r in group]
