"""Groups as products: the same relations as enumeration gives, without enumerating."""

import itertools
import math

import numpy as np
import pytest
from flint import fmpq
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.groups.symmetry_group import LARGEST_LIST, SymmetryGroup, close
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.builtin_robots import builtin_robots
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries import frequency_support as support
from isotorque.symbolic.symmetries.approximate_symmetries import maximal_groups
from isotorque.symbolic.symmetries.exact_symmetries import frequency_blocks
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.exact_proof import prove_relation
from isotorque.verify.testing.strategies import kinematic_trees
from tests.symbolic.gravity.small_potentials import planar, potentials, three_r, two_r
from tests.symbolic.groups.enumeration import enumerated_symmetries

FIELDS = ("A", "d", "Y", "bound", "A_sat", "d_sat")


def assert_same_relations(group, expected, *, ordered=True):
    assert group.order == expected.order
    np.testing.assert_array_equal(group.basis, expected.basis)
    for number, relation in enumerate(expected):
        place = number if ordered else group.index(relation)
        for field in FIELDS:
            np.testing.assert_array_equal(
                getattr(group[place], field), getattr(relation, field), err_msg=field
            )
        assert group[place].exact == relation.exact


@pytest.mark.parametrize("name", [robot.name for robot in builtin_robots()])
def test_builtin_robots_have_the_relations_of_enumeration_bit_for_bit_and_in_its_order(name):
    potential = derive_potential(load_robot(name).tree)
    for given_ in (potential, potential.to_float()):
        assert_same_relations(primary_symmetries(given_), enumerated_symmetries(given_))


@given(kinematic_trees(max_joints=5))
@settings(max_examples=40, suppress_health_check=list(HealthCheck))
def test_random_trees_have_the_relations_of_enumeration(tree):
    potential = derive_potential(tree)
    group, expected = primary_symmetries(potential), enumerated_symmetries(potential)
    assert group.order == expected.order
    assert group.exact == expected.exact
    assert all(relation in group for relation in expected)
    assert all(relation in expected for relation in group)


@given(potentials(max_joints=4))
@settings(max_examples=60)
def test_random_potentials_have_the_relations_of_enumeration(potential):
    group = primary_symmetries(potential)
    assume(group.order <= 64)
    expected = enumerated_symmetries(potential)
    assert group.order == expected.order
    for number, relation in enumerate(group):
        assert relation in expected
        assert group.index(relation) == number


def side_by_side(parts, shuffle):
    """Put potentials on separate joints, shuffled: the potential of arms on one fixed base."""
    n = sum(part.n for part in parts)
    places = np.array([place for place in shuffle if place < n])
    rows, cos, sin, blocks, start = [], [], [], [], 0
    for part in parts:
        block = places[start : start + part.n]
        start += part.n
        wide = np.zeros((len(part), n), dtype=np.int64)
        wide[:, block] = part.frequencies
        rows.append(wide)
        cos += part.cos.tolist()
        sin += part.sin.tolist()
        blocks.append(block)
    return TrigonometricPolynomial(np.concatenate(rows), cos, sin), blocks


arms = potentials(max_joints=3) | st.sampled_from([two_r(), three_r(), planar([3.0, 2.0, 1.0])])


@given(
    st.lists(arms, min_size=2, max_size=3),
    st.permutations(range(9)),
    st.data(),
)
@settings(max_examples=25)
def test_the_group_of_separate_arms_is_the_product_of_their_groups(parts, shuffle, data):
    whole, blocks = side_by_side(parts, shuffle)
    group = primary_symmetries(whole)
    alone = [primary_symmetries(part) for part in parts]
    assert group.order == math.prod(g.order for g in alone)
    assert math.prod(f.order for f in group.direct_factors) == group.order
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (20, whole.n))
    for _ in range(3):
        # any choice of one relation per arm is one of the group, and acts as they do
        chosen = [g[data.draw(st.integers(0, g.order - 1))] for g in alone]
        moved, signs = q.copy(), np.ones(whole.n)
        for block, relation in zip(blocks, chosen, strict=True):
            moved[:, block] = relation.configuration(q[:, block])
            signs[block] = relation.Y
        error = np.abs(whole.gradient(moved) - signs * whole.gradient(q)).max()
        assert error < 1e-9
    number = data.draw(st.integers(0, group.order - 1))
    relation = group[number]
    assert group.index(relation) == number
    error = np.abs(whole.gradient(relation.configuration(q)) - relation.torque(whole.gradient(q)))
    assert error.max() < 1e-9
    if group.order <= 32 and group.generators:
        assert close(group.generators).order == group.order


def test_generators_of_a_list_generate_it():
    group = primary_symmetries(three_r())
    listed = SymmetryGroup(list(group)[::-1])
    assert len(listed.generators) <= 4
    assert close(listed.generators).order == listed.order == 16
    assert close(group.generators).order == 16
    assert SymmetryGroup([listed[0]]).generators == ()


def many_arms(count):
    return side_by_side([two_r(2.0 + i, 1.0) for i in range(count)], range(2 * count))[0]


def test_huge_groups_are_known_without_a_list():
    group = primary_symmetries(many_arms(40))  # 8^40, more than a C integer holds
    assert group.order == 8**40
    assert [factor.order for factor in group.direct_factors] == [8] * 40
    assert len(group.generators) == 3 * 40
    relation = group[8**40 - 1]
    assert group.find(relation) == 8**40 - 1
    assert relation in group
    assert relation @ group[8**39 + 5] in group
    spoiled = SymmetryRelation(relation.A, relation.d + 0.1, relation.Y, relation.basis)
    assert spoiled not in group
    assert next(iter(group)).is_identity
    assert [r.is_identity for r in group[:2]] == [True, False]
    assert group.is_closed


@pytest.mark.parametrize(
    "use",
    [
        lambda group: group.A,
        lambda group: group.d_sat,
        lambda group: group.orbit(np.zeros(group.n)),
        lambda group: group.multiplication_table,
        lambda group: group.listed(),
        lambda group: group.level_set_symmetries(),
    ],
)
def test_what_needs_every_relation_refuses_huge_groups_in_one_line(use):
    group = primary_symmetries(many_arms(5))
    assert group.order == 8**5 > LARGEST_LIST
    with pytest.raises(InputError, match=rf"^symmetry group: order is 32768.*{LARGEST_LIST}"):
        use(group)


def test_planar_chains_are_products_over_their_components():
    group = primary_symmetries(planar([float(i) for i in range(30, 0, -1)]))
    assert group.order == 2**31
    (factor,) = group.direct_factors
    assert factor.order == 2**31
    assert factor.factors == (2,) * 31
    relation = group[2**31 - 1]
    assert group.find(relation) == 2**31 - 1
    product = relation @ group[12345]
    assert product in group
    assert np.all(wrap(product.d_sat - group[group.index(product)].d_sat) == 0)


@given(st.lists(st.lists(st.integers(-1, 1), min_size=5, max_size=5), max_size=6))
def test_blocks_are_the_classes_of_joints_that_share_frequencies(rows):
    K = np.array(rows, dtype=np.int64).reshape(-1, 5)
    blocks = frequency_blocks(K)
    inside = np.concatenate([np.zeros(0, dtype=int), *blocks])
    assert sorted(inside) == np.flatnonzero(K.any(axis=0)).tolist()
    label = {int(j): i for i, block in enumerate(blocks) for j in block}
    assert all(len({label[int(j)] for j in np.flatnonzero(k)}) <= 1 for k in K)
    for block in blocks:  # connected: no cut of a block is free of frequencies
        reached = {int(block[0])}
        for _ in block:
            hit = [k for k in K if set(np.flatnonzero(k).tolist()) & reached]
            reached |= {int(j) for k in hit for j in np.flatnonzero(k)}
        assert reached == set(block.tolist())


@given(
    st.lists(
        st.sampled_from([two_r(), two_r(3.0, 2.98), three_r(2.0, 2.01)]), min_size=2, max_size=3
    ),
    st.permutations(range(9)),
    st.floats(0.01, 0.1),
)
@settings(max_examples=8)
def test_approximate_groups_of_separate_arms_are_products_too(parts, shuffle, tolerance):
    whole, _ = side_by_side(parts, shuffle)
    alone = [maximal_groups(part, tolerance) for part in parts]
    groups = maximal_groups(whole, tolerance)
    assert groups[0].order == math.prod(found[0].order for found in alone)
    assert len(groups) == math.prod(len(found) for found in alone)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (50, whole.n))
    torque = whole.gradient(q)
    for relation in [*groups[0].generators, groups[0][groups[0].order - 1]]:
        error = np.abs(whole.gradient(relation.configuration(q)) - relation.torque(torque))
        assert np.all(error <= relation.bound + 1e-12)
        assert np.all(relation.bound <= tolerance + 1e-12)


def test_a_tolerance_with_too_much_to_try_is_refused(monkeypatch):
    monkeypatch.setattr(support, "MOST_WORK", 40)
    every = itertools.product([0, 1, -1], repeat=3)
    K = np.array([k for k in every if next(filter(None, k), 0) == 1])
    rng = np.random.default_rng(0)
    U = TrigonometricPolynomial(K, rng.normal(size=len(K)), rng.normal(size=len(K)))
    with pytest.raises(InputError, match="torque signs to try is more than 3"):
        maximal_groups(U, 0.1)
    assert primary_symmetries(U).order == 1


def test_a_relation_is_exact_only_if_it_is_on_every_block():
    """One arm exactly symmetric, one to rounding alone: the verifier decides what is proved."""
    zero, one = fmpq(0), fmpq(1)
    potential = TrigonometricPolynomial(
        [[1, 0, 0], [0, 1, 1], [0, 1, -1]],
        np.array([2 * one, one, one + fmpq(1, 10**15)], dtype=object),
        np.array([zero] * 3, dtype=object),
    )
    group = primary_symmetries(potential)
    for relation in group:
        proof = prove_relation(relation.A, relation.unwrapped_d, relation.Y, potential)
        assert relation.exact == proof.holds
    assert 0 < sum(relation.exact for relation in group) < group.order
    assert not group.exact
