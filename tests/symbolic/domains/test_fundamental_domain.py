"""The BCTS: one configuration per orbit, half-spaces, representatives, samples."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.gravity.small_potentials import planar, potentials, three_r, two_r

TURN = 2 * np.pi
seeds = st.integers(0, 2**32 - 1)
# frequencies generate a sublattice of index 3: relations are no maps of the torus of q
FRACTIONAL = TrigonometricPolynomial(
    [[0, 1, -1], [1, -1, -1], [1, 0, 1], [1, 1, 0]], [1.0, 1.0, 1.0, 1.0], [0.0] * 4
)


def configurations(seed, m, n):
    return np.random.default_rng(seed).uniform(-9, 9, (m, n))


@settings(max_examples=60)
@given(potentials(), seeds)
def test_exactly_one_member_of_each_orbit_lies_in_the_domain(potential, seed):
    group = primary_symmetries(potential)
    domain = FundamentalDomain(group)
    orbits = group.orbit(configurations(seed, 10, group.n))
    assert domain.contains(orbits).sum(axis=0).tolist() == [1] * 10


@settings(max_examples=60)
@given(potentials(), seeds)
def test_representatives_are_reached_by_the_relation_returned(potential, seed):
    group = primary_symmetries(potential)
    domain = FundamentalDomain(group)
    q = configurations(seed, 6, group.n)
    q0, relations = domain.canonicalise(q)
    torque = potential.gradient(q)
    for i, relation in enumerate(relations):
        away = (q0[i] - relation.configuration(q[i])) @ group.basis.T / TURN
        np.testing.assert_allclose(away, np.rint(away), atol=1e-8)
        np.testing.assert_allclose(
            potential.gradient(q0[i]), relation.torque(torque[i]), atol=1e-11
        )
    assert domain.contains(q0).all()
    assert domain.contains_y(q0 @ group.basis.T).all()
    kept = group.completion[group.rank :]  # q = V^-1 (y, free components)
    np.testing.assert_allclose(q0 @ kept.T, q @ kept.T, atol=1e-12)


@settings(max_examples=60)
@given(potentials(), seeds)
def test_representatives_are_the_same_for_the_whole_orbit(potential, seed):
    group = primary_symmetries(potential)
    domain = FundamentalDomain(group)
    q = configurations(seed, 4, group.n)
    y0 = domain.canonicalise(q)[0] @ group.basis.T
    again, relations = domain.canonicalise(domain.canonicalise(q)[0])
    np.testing.assert_array_equal(again @ group.basis.T, y0)
    assert all(relation.is_identity for relation in relations)
    images = domain.canonicalise(group.orbit(q) + TURN)[0] @ group.basis.T
    np.testing.assert_allclose(images, np.broadcast_to(y0, images.shape), atol=1e-7)


@given(potentials(max_joints=3))
def test_volume_is_the_torus_over_the_order(potential):
    group = primary_symmetries(potential)
    domain = FundamentalDomain(group)
    assert domain.volume == pytest.approx(TURN**group.rank / group.order)
    if group.rank == 1:
        assert np.ptp(domain.vertices) == pytest.approx(domain.volume)
    elif group.rank > 1:
        assert ConvexHull(domain.vertices).volume == pytest.approx(domain.volume)
    assert domain.contains_y(domain.vertices).all()


@given(potentials(max_joints=3), seeds)
def test_any_generic_centre_gives_a_domain_around_it(potential, seed):
    group = primary_symmetries(potential)
    center = configurations(seed, 1, group.n)[0]
    try:
        domain = FundamentalDomain(group, center)
    except InputError:
        assume(False)
    assert domain.contains_y(group.basis @ center)
    q = configurations(seed, 10, group.n)
    assert domain.contains(group.orbit(q)).sum(axis=0).tolist() == [1] * 10


@pytest.mark.parametrize(
    ("center", "low", "high"),
    [((np.pi / 4, np.pi / 4), 0.0, 1.0), ((-np.pi / 4, -np.pi / 4), -1.0, 0.0)],
)
def test_2r_domain_is_the_papers_parallelogram(center, low, high):
    """Fig. 6: q1 in [0, pi/2], q1 + q2 in [0, pi]; its mirror image where the arm can be held."""
    domain = FundamentalDomain(primary_symmetries(two_r()), center)
    expected = {
        (1.0, 0.0, high * np.pi / 2),
        (-1.0, 0.0, -low * np.pi / 2),
        (1.0, 1.0, high * np.pi),
        (-1.0, -1.0, -low * np.pi),
    }
    assert {tuple(row) for row in domain.halfspaces.round(12)} == {
        tuple(np.round(row, 12)) for row in expected
    }
    assert domain.volume == pytest.approx(np.pi**2 / 2)
    assert len(domain.vertices) == 4
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (2000, 2))
    inside = (q[:, 0] >= low * np.pi / 2) & (q[:, 0] <= high * np.pi / 2)
    inside &= (q.sum(axis=1) >= low * np.pi) & (q.sum(axis=1) <= high * np.pi)
    np.testing.assert_array_equal(domain.contains(q), inside)


def test_default_2r_domain_is_the_papers():
    domain = FundamentalDomain(primary_symmetries(two_r()))
    np.testing.assert_allclose(domain.center, [np.pi / 4, np.pi / 4])


@settings(max_examples=30)
@given(seeds)
def test_domain_near_home_contains_home(seed):
    home = configurations(seed, 1, 3)[0]
    domain = FundamentalDomain.near(primary_symmetries(three_r()), home)
    assert domain.contains_y(home)


def test_2r_domain_near_a_stable_home_is_stable():
    potential = two_r()
    domain = FundamentalDomain.near(primary_symmetries(potential), [-1.0, -0.5])
    np.testing.assert_allclose(domain.center, [-np.pi / 4, -np.pi / 4])
    q = domain.sample(np.random.default_rng(1), 500)
    assert np.linalg.eigvalsh(potential.hessian(q)).min() > -1e-9


@pytest.mark.parametrize("potential", [two_r(), three_r(), FRACTIONAL])
def test_samples_are_uniform(potential):
    group = primary_symmetries(potential)
    domain = FundamentalDomain(group)
    m = 20_000
    y = domain.sample(np.random.default_rng(3), m) @ group.basis.T
    assert domain.contains_y(y).all()
    # against rejection from the bounding box: means of waves agree within five standard errors
    low, high = domain.vertices.min(axis=0), domain.vertices.max(axis=0)
    box = np.random.default_rng(4).uniform(low, high, (8 * m, group.rank))
    box = box[domain.contains_y(box)][:m]
    for wave in np.random.default_rng(5).normal(size=(20, group.rank)):
        ours, plain = np.cos(y @ wave + 0.3), np.cos(box @ wave + 0.3)
        error = np.sqrt(ours.var() / len(ours) + plain.var() / len(plain))
        assert abs(ours.mean() - plain.mean()) < 5 * error


def test_relations_of_fractional_matrices():
    group = primary_symmetries(FRACTIONAL)
    assert not np.allclose(group.A_sat, np.round(group.A_sat))
    domain = FundamentalDomain(group)
    assert ConvexHull(domain.vertices).volume == pytest.approx(TURN**3 / group.order)
    q = configurations(7, 50, 3)
    assert domain.contains(group.orbit(q)).sum(axis=0).tolist() == [1] * 50
    q0, relations = domain.canonicalise(q)
    np.testing.assert_array_equal(domain.canonicalise(q0)[0], q0)
    images = domain.canonicalise(group.orbit(q))[0]
    np.testing.assert_allclose(images, np.broadcast_to(q0, images.shape), atol=1e-11)
    signs = np.array([relation.Y for relation in relations])
    np.testing.assert_allclose(FRACTIONAL.gradient(q0), signs * FRACTIONAL.gradient(q), atol=1e-12)


def test_free_directions_are_left_alone():
    """Gravity along the first axis: only q2 + q3 matters."""
    potential = TrigonometricPolynomial([[0, 1, 1]], [0.0], [3.0])
    domain = FundamentalDomain(primary_symmetries(potential))
    assert domain.order == 4
    assert domain.halfspaces.shape == (2, 2)
    q0, _ = domain.canonicalise([5.0, 2.0, 3.0])
    assert q0[0] == 5.0
    assert q0[2] == 3.0
    assert np.ptp(domain.sample(np.random.default_rng(0), 50)[:, 0]) == 0


def test_no_gravity_at_all():
    nothing = TrigonometricPolynomial(np.zeros((0, 2), dtype=int), [], [])
    domain = FundamentalDomain(primary_symmetries(nothing))
    assert (domain.volume, domain.order) == (1.0, 1)
    assert domain.halfspaces.shape == (0, 1)
    assert domain.vertices.shape == (1, 0)
    q0, relation = domain.canonicalise([3.0, -4.0])
    assert q0.tolist() == [3.0, -4.0]
    assert relation.is_identity
    assert domain.contains([3.0, -4.0])
    assert domain.sample(np.random.default_rng(0), 5).shape == (5, 2)


def test_shapes_of_batches():
    domain = FundamentalDomain(primary_symmetries(planar([3.0, 2.0, 1.0])))
    q = configurations(0, 24, 3).reshape(2, 3, 4, 3)
    q0, relations = domain.canonicalise(q)
    found = domain.representatives(q)
    assert q0.shape == q.shape
    assert relations.shape == found.relation.shape == (2, 3, 4)
    assert found.turns.shape == (2, 3, 4, 3)
    one, relation = domain.canonicalise(q[1, 2, 3])
    np.testing.assert_array_equal(one, q0[1, 2, 3])
    assert relation is relations[1, 2, 3]
    assert domain.contains(q).shape == (2, 3, 4)
    assert domain.canonicalise(np.zeros((0, 3)))[0].shape == (0, 3)


def test_neighbours_map_the_domain_beyond_its_facets():
    domain = FundamentalDomain(primary_symmetries(three_r()), [0.4, 0.6, 0.9])
    for row, neighbour in zip(domain.halfspaces, domain.neighbours, strict=True):
        image = neighbour.configuration(domain.center)
        near = image + TURN * np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
        nearest_side = (near @ row[:-1] - row[-1]) / np.linalg.norm(row[:-1])
        assert nearest_side.max() > 0


@pytest.mark.parametrize(
    ("center", "match"),
    [
        ([-np.pi / 2, 0.0], "generic centre"),
        ([0.0, 0.0, 1.0], "shape"),
        ([np.nan, 0.0], "finite"),
        (0.3, "shape"),
    ],
)
def test_unusable_centres_are_refused(center, match):
    with pytest.raises(InputError, match=match):
        FundamentalDomain(primary_symmetries(two_r()), center)


def test_unusable_configurations_are_refused():
    domain = FundamentalDomain(primary_symmetries(two_r()))
    for use in (domain.contains, domain.canonicalise, domain.representatives):
        with pytest.raises(InputError, match="shape"):
            use([1.0, 2.0, 3.0])
        with pytest.raises(InputError, match="finite"):
            use([1.0, np.inf])


def test_a_list_that_is_no_group_is_refused():
    shift = SymmetryRelation(np.eye(2), [2.0, 0.0], [-1, -1])
    identity = SymmetryRelation(np.eye(2), [0.0, 0.0], [1, 1])
    with pytest.raises(InputError, match="closed"):
        FundamentalDomain(SymmetryGroup([identity, shift]), [0.1, 0.2])
