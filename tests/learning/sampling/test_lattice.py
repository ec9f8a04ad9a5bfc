"""Tests of lattices in domains and boxes: counts, regions, generators, admissibility."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from isotorque.learning.sampling.lattice import Spread, lattice_samples
from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

ROBOTS = ("2r", "3r", "ur5")
EXACT = [kind for kind in Spread if kind is not Spread.GRID]


@pytest.fixture(scope="module")
def domains():
    return {
        name: FundamentalDomain(primary_symmetries(GravityModel(load_robot(name)).potential))
        for name in ROBOTS
    }


@settings(max_examples=40)
@given(
    robot=st.sampled_from(ROBOTS),
    count=st.integers(1, 200),
    kind=st.sampled_from(EXACT),
    seed=st.integers(0, 2**32 - 1),
)
def test_exactly_the_points_asked_for_and_all_inside(domains, robot, count, kind, seed):
    domain = domains[robot]
    region = SamplingRegion.of_domain(domain)
    q = lattice_samples(region, count, np.random.default_rng(seed), kind).q
    assert q.shape == (count, domain.group.n)
    assert domain.contains(q).all()
    assert np.all(domain.contains_y(q @ domain.basis.T))


@given(
    limits=st.lists(
        st.tuples(st.floats(-6, 6), st.floats(0.1, 6)).map(lambda x: (x[0], x[0] + x[1])),
        min_size=1,
        max_size=4,
    ),
    count=st.integers(1, 150),
    kind=st.sampled_from(EXACT),
    seed=st.integers(0, 2**32 - 1),
)
def test_boxes_too(limits, count, kind, seed):
    limits = np.array(limits)
    region = SamplingRegion.of_box(limits)
    q = lattice_samples(region, count, np.random.default_rng(seed), kind).q
    assert q.shape == (count, len(limits))
    assert np.all(q >= limits[:, 0] - 1e-12)
    assert np.all(q <= limits[:, 1] + 1e-12)


@settings(max_examples=30)
@given(
    robot=st.sampled_from(ROBOTS),
    count=st.integers(2, 100),
    kind=st.sampled_from([Spread.KOROBOV, Spread.GRID]),
    seed=st.integers(0, 2**32 - 1),
)
def test_points_are_integer_combinations_of_the_generators(domains, robot, count, kind, seed):
    """Eq. 23, read off the points; no two coincide."""
    region = SamplingRegion.of_domain(domains[robot])
    found = lattice_samples(region, count, np.random.default_rng(seed), kind, exact=False)
    multiples = np.linalg.lstsq(found.generators.T, (found.q - found.q[0]).T)[0]
    assert np.abs(multiples - np.rint(multiples)).max() < 1e-6
    assert np.abs((found.q - found.q[0]).T - found.generators.T @ multiples).max() < 1e-9
    assert len(np.unique(np.rint(multiples), axis=1).T) == len(found.q)


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_lattice_leaves_no_two_points_close(domains, robot):
    """Separation near the ideal spacing, which random points miss by far."""
    region = SamplingRegion.of_domain(domains[robot])
    ideal = (region.volume / 100) ** (1 / region.dimension)
    back = np.linalg.pinv(region.to_configuration).T
    separation = {
        kind: pdist(lattice_samples(region, 100, np.random.default_rng(0), kind).q @ back).min()
        for kind in (Spread.KOROBOV, Spread.RANDOM)
    }
    assert separation[Spread.KOROBOV] > 0.85 * ideal > 2 * separation[Spread.RANDOM]


@settings(max_examples=30)
@given(count=st.integers(1, 80), kind=st.sampled_from(EXACT), seed=st.integers(0, 2**32 - 1))
def test_denser_where_some_cannot_be_visited(count, kind, seed):
    """Counts stay exact with a hole in the region, and nothing is in the hole."""
    region = SamplingRegion.of_box([[-1.0, 1.0], [-1.0, 1.0]])

    def admit(q):
        return np.linalg.norm(q - 0.2, axis=1) > 0.6

    rng = np.random.default_rng(seed)
    q = lattice_samples(region, count, rng, kind, admit=admit).q
    assert len(q) == count
    assert admit(q).all()


def test_left_out_where_so_wanted():
    region = SamplingRegion.of_box([[-1.0, 1.0], [-1.0, 1.0]])
    rng = np.random.default_rng(0)
    found = lattice_samples(region, 200, rng, admit=lambda q: q[:, 0] > 0, refill=False)
    assert 90 <= len(found.q) <= 110
    assert (found.q[:, 0] > 0).all()


def test_moved_to_symmetric_configurations_that_can_be_visited(domains):
    """All of the 2R domain can be had with the first link pointing down: same information."""
    domain = domains["2r"]
    region = SamplingRegion.of_domain(domain)

    def admit(q):
        return np.sin(q[:, 0]) < 0

    rng = np.random.default_rng(1)
    plain = lattice_samples(region, 50, np.random.default_rng(1)).q
    moved = lattice_samples(region, 50, rng, admit=admit, images=domain.group, refill=False).q
    assert admit(moved).all()
    assert len(moved) == 50
    back = domain.canonicalise(moved)[0]
    assert np.abs(back - domain.canonicalise(plain)[0]).max() < 1e-9


def test_a_grid_says_which_counts_it_can_give():
    square = SamplingRegion.of_box([[0.0, 1.0], [0.0, 1.0]])
    with pytest.raises(InputError, match=r"number of points is 7; .* e\.g\. "):
        lattice_samples(square, 7, np.random.default_rng(0), "grid")
    assert len(lattice_samples(square, 49, np.random.default_rng(0), "grid").q) == 49


def test_the_same_seed_gives_the_same_points(domains):
    region = SamplingRegion.of_domain(domains["3r"])
    for kind in EXACT:
        first, second = (
            lattice_samples(region, 40, np.random.default_rng(5), kind).q for _ in range(2)
        )
        assert np.array_equal(first, second)


def test_refuses_what_cannot_be_done():
    square = SamplingRegion.of_box([[0.0, 1.0], [0.0, 1.0]])
    rng = np.random.default_rng(0)
    with pytest.raises(InputError, match="number of points"):
        lattice_samples(square, 0, rng)
    with pytest.raises(InputError, match="spread is hexagons; accepted: korobov, grid"):
        lattice_samples(square, 5, rng, "hexagons")
    for kind in (Spread.KOROBOV, Spread.SOBOL):
        with pytest.raises(InputError, match="admissible configurations"):
            lattice_samples(square, 5, rng, kind, admit=lambda q: np.zeros(len(q), dtype=bool))
