"""Direct products: found where they are, and nowhere else; cells and centres of products."""

import numpy as np
import pytest
from hypothesis import given
from scipy.spatial import ConvexHull

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.dirichlet_cell import dirichlet_cell
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.domains.generic_center import generic_center
from isotorque.symbolic.groups.direct_factors import direct_factors
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.gravity.small_potentials import potentials, three_r, two_r


def side_by_side(*arms):
    """Return the potential of arms that share a fixed base only."""
    n = sum(arm.n for arm in arms)
    total = TrigonometricPolynomial(np.zeros((0, n), dtype=int), [], [])
    start = 0
    for arm in arms:
        wide = np.zeros((len(arm), n), dtype=int)
        wide[:, start : start + arm.n] = arm.frequencies
        total = total + TrigonometricPolynomial(wide, arm.cos, arm.sin)
        start += arm.n
    return total


@given(potentials(max_joints=2), potentials(max_joints=2))
def test_two_arms_on_one_base_fold_like_each_alone(first, second):
    group = primary_symmetries(side_by_side(first, second))
    domain = FundamentalDomain(group)
    q = np.random.default_rng(0).uniform(-9, 9, (6, group.n))
    assert domain.contains(group.orbit(q)).sum(axis=0).tolist() == [1] * 6
    volumes = [FundamentalDomain(primary_symmetries(arm)).volume for arm in (first, second)]
    assert domain.volume == pytest.approx(np.prod(volumes))


def test_product_of_2r_and_3r():
    group = primary_symmetries(side_by_side(two_r(), three_r()))
    assert group.order == 8 * 16
    blocks = direct_factors(group.A_sat, group.d_sat)
    assert sorted(len(block.A) for block in blocks) == [4, 4, 8]
    domain = FundamentalDomain(group)
    assert ConvexHull(domain.vertices).volume == pytest.approx(domain.volume)
    rows = domain.halfspaces
    slack = rows[:, -1] - domain.vertices @ rows[:, :-1].T
    assert slack.min() > -1e-9
    assert (slack < 1e-9).any(axis=0).all()


def test_a_group_that_couples_its_coordinates_is_one_block():
    group = primary_symmetries(two_r())
    blocks = direct_factors(group.A_sat, group.d_sat)
    assert len(blocks) == 1
    np.testing.assert_array_equal(blocks[0].A, group.A_sat)
    turned = [np.eye(2), -np.eye(2)]  # acts on separate coordinates, but on both at once
    assert len(direct_factors(np.array(turned), np.zeros((2, 2)))) == 1


def test_many_joints_side_by_side_are_no_trouble():
    group = primary_symmetries(side_by_side(*[two_r(1.0 + i, 0.7) for i in range(3)]))
    domain = FundamentalDomain(group)
    assert (group.order, len(domain.halfspaces), len(domain.vertices)) == (512, 12, 64)
    q0, _ = domain.canonicalise(np.random.default_rng(0).uniform(-9, 9, (100, 6)))
    assert domain.contains_y(q0).all()


def test_too_many_coupled_dimensions_are_refused():
    A = np.array([np.eye(12), np.roll(np.eye(12), 1, axis=0)])
    with pytest.raises(InputError, match="at most 10"):
        dirichlet_cell(A, np.zeros((2, 12)), np.arange(12) / 12)


def test_centre_of_a_product_is_the_centres_of_its_factors():
    arms = two_r(), three_r()
    group = primary_symmetries(side_by_side(*arms))
    alone = [primary_symmetries(arm) for arm in arms]
    expected = np.concatenate([generic_center(g.A_sat, g.d_sat) for g in alone])
    np.testing.assert_allclose(generic_center(group.A_sat, group.d_sat), expected)
