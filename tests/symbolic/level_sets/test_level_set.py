"""Level sets, against plain root finding from many starts and multiple precision."""

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import fsolve

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.level_sets.equations import level_set_equations
from isotorque.symbolic.level_sets.level_set import level_set
from isotorque.symbolic.level_sets.newton_search import search
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.symbolic.gravity.small_potentials import A, B, planar, potentials, three_r, two_r

angles = st.floats(-3.1, 3.1)
# frequencies generate a sublattice of index 2: more solutions than angles
DIAMOND = TrigonometricPolynomial([[1, 1], [1, -1]], [0.5, 2.0], [3.0, 1.0])


def apart(q, others):
    """Return how far q is from each of others, modulo 2 pi."""
    return np.abs(wrap(others - q)).max(axis=-1, initial=0.0)


def found_by_root_finding(potential, torque, starts, rng):
    """Return what SciPy's fsolve finds for |gradient| = |torque| from random starts."""
    found = np.zeros((0, potential.n))
    signs = np.array(list(np.ndindex(*[2] * potential.n))) * 2 - 1
    for target in np.unique(signs * torque, axis=0):
        for start in rng.uniform(-np.pi, np.pi, (starts, potential.n)):
            q, _, status, _ = fsolve(
                lambda x, target=target: potential.gradient(x) - target,
                start,
                fprime=potential.hessian,
                xtol=1e-12,
                full_output=True,
            )
            solved = status == 1 and np.abs(potential.gradient(q) - target).max() < 1e-9
            if solved and (not len(found) or apart(q, found).min() > 1e-5):
                found = np.concatenate([found, wrap(q)[None]])
    return found


def is_well_conditioned(potential, configurations):
    stiffness = np.linalg.eigvalsh(potential.hessian(configurations))
    return np.abs(stiffness).min(initial=1.0) > 0.05 * potential.gradient_bound().max()


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1))
def test_2r_solutions_are_those_of_root_finding(seed):
    a, b, *q = np.random.default_rng(seed).uniform([1, 1, -np.pi, -np.pi], [20, 20, np.pi, np.pi])
    potential = two_r(a, b)
    torque = potential.gradient(q)
    found = level_set(potential, torque)
    assume(is_well_conditioned(potential, found.configurations))
    assert found.complete
    plain = found_by_root_finding(potential, torque, 40, np.random.default_rng(0))
    assert len(found) in (8, 16)
    assert len(plain) == len(found)
    for q in plain:
        assert apart(q, found.configurations).min() < 1e-6


@pytest.mark.parametrize("potential", [DIAMOND, three_r(), three_r(12.26, 7.0), planar([3, 2, 1])])
def test_solutions_of_other_arms_are_those_of_root_finding(potential):
    rng = np.random.default_rng(2)
    torque = potential.gradient(rng.uniform(-3, 3, potential.n))
    found = level_set(potential, torque)
    plain = found_by_root_finding(potential, torque, 250, rng)
    assert len(plain) == len(found)
    for q in plain:
        assert apart(q, found.configurations).min() < 1e-6


@given(potentials(max_joints=3), st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_members_meet_the_equations_once_each_and_sets_are_orbits(potential, seed):
    group = primary_symmetries(potential)
    q = np.random.default_rng(seed).uniform(-3, 3, potential.n)
    torque = potential.gradient(q)
    assume(is_well_conditioned(potential, q) if group.rank == potential.n else True)
    found = level_set(potential, torque, group=group, max_starts=2000)
    scale = potential.gradient_bound().max(initial=1.0)
    np.testing.assert_allclose(np.abs(found.torques) - np.abs(torque), 0, atol=1e-9 * scale)
    np.testing.assert_allclose(
        potential.gradient(found.configurations), found.torques, atol=1e-9 * scale
    )
    y = found.configurations @ group.basis.T
    if len(found) and found.regular.all():  # the configuration asked about is among them
        assert apart(q @ group.basis.T, y).min() < 1e-6
    for number in range(found.primary_set_count):
        own = found.primary_set(number).configurations
        orbit = group.orbit(own[0]) @ group.basis.T
        for member in own @ group.basis.T:
            assert apart(member, orbit).min() < 1e-6
        others = y[found.primary_sets != number]
        for image in orbit if found.regular.all() else []:
            assert apart(image, others).min(initial=1.0) > 1e-6


def papers_maps(q1, q2):
    """Return Eq. 11 of the paper, map by map."""
    star = q1 + q2
    return np.array(
        [
            [q1, q2],
            [q1, -star - q1],
            [-q1, star + q1],
            [-q1, -star + q1],
            [q1 + np.pi, star - q1],
            [q1 + np.pi, -star - q1],
            [-q1 - np.pi, star + q1],
            [-q1 - np.pi, -star + q1],
        ]
    )


def test_sixteen_configurations_in_two_primary_sets_of_eight():
    """Fig. 2A, and Eq. 8: each of the four level sets comprises four configurations."""
    potential = two_r()
    torque = potential.gradient([1.1, 0.3])
    found = level_set(potential, torque)
    assert (len(found), found.primary_set_count, found.complete) == (16, 2, True)
    assert [len(found.primary_set(i)) for i in (0, 1)] == [8, 8]
    for signs in ([1, 1], [1, -1], [-1, 1], [-1, -1]):
        assert len(found.with_torque(signs * torque)) == 4
    assert found.regular.all()
    assert found.stable.sum() == 4
    assert [len(found.primary_set(i).stable_members) for i in (0, 1)] == [2, 2]


@settings(max_examples=40)
@given(angles, angles)
def test_equation_11_map_by_map(q1, q2):
    potential = two_r()
    group = primary_symmetries(potential)
    torque = potential.gradient([q1, q2])
    maps = papers_maps(q1, q2)
    for i, image in enumerate(maps):
        sign = 1 if i < 4 else -1
        np.testing.assert_allclose(potential.gradient(image), sign * torque, atol=1e-11)
        alike = [
            relation
            for relation, q in zip(group, group.orbit([q1, q2]), strict=True)
            if np.abs(wrap(q - image)).max() < 1e-9 and (sign == relation.Y).all()
        ]
        assert alike
    found = level_set(potential, torque)
    if is_well_conditioned(potential, found.configurations):
        own = found.primary_sets[apart(np.array([q1, q2]), found.configurations).argmin()]
        orbit = found.primary_set(own).configurations
        assert len(orbit) == 8
        for image in maps:
            assert apart(image, orbit).min() < 1e-7


def test_secondary_relation_of_the_2r_arm():
    """Flipping tau_2 alone is no affine map: cos q1' = cos q1 + 2 (B / A) cos(q1 + q2)."""
    q1, q2 = 1.1, 0.3
    torque = two_r().gradient([q1, q2])
    found = level_set(two_r(), torque).with_torque(torque * [1, -1])
    assert len(found) == 4
    for p1, p2 in found.configurations:
        assert np.cos(p1) == pytest.approx(np.cos(q1) + 2 * B / A * np.cos(q1 + q2))
        assert np.cos(p1 + p2) == pytest.approx(-np.cos(q1 + q2))


def test_eight_configurations_where_the_shoulder_cannot_compensate():
    found = level_set(two_r(), two_r().gradient([0.1, 0.2]))
    assert (len(found), found.primary_set_count) == (8, 1)


@pytest.mark.parametrize(("a", "b"), [(12.26, 12.26), (12.26, 5.0), (7.0, 12.26)])
def test_numbers_of_configurations_of_the_3r_arm(a, b):
    potential = three_r(a, b)
    group = primary_symmetries(potential)
    rng = np.random.default_rng(0)
    for q in rng.uniform(-3, 3, (6, 3)):
        found = level_set(potential, potential.gradient(q), group=group)
        assert not found.complete
        assert found.fewest_hits >= 6
        assert len(found) == 16 * found.primary_set_count
        assert len(found) in ((32, 64) if a == b else range(16, 129, 16))


def test_solutions_hold_to_thirty_digits():
    """Newton in multiple precision stays where the solutions are, and they stay apart."""
    with mpmath.workdps(30):
        a, b = mpmath.mpf(A), mpmath.mpf(B)
        torque = (
            a * mpmath.cos(mpmath.mpf("1.1")) + b * mpmath.cos(mpmath.mpf("1.4")),
            b * mpmath.cos(mpmath.mpf("1.4")),
        )
        found = level_set(two_r(), [float(x) for x in torque])
        sharp = []
        for q, tau in zip(found.configurations, found.torques, strict=True):
            sign = [int(np.sign(t * float(x))) for t, x in zip(tau, torque, strict=True)]
            root = mpmath.findroot(
                lambda x, y, sign=sign: [
                    a * mpmath.cos(x) + b * mpmath.cos(x + y) - sign[0] * torque[0],
                    b * mpmath.cos(x + y) - sign[1] * torque[1],
                ],
                tuple(q),
            )
            assert max(abs(root[i] - q[i]) for i in range(2)) < 1e-12
            sharp.append([float(root[0]), float(root[1])])
    assert len({tuple(np.round(x, 9)) for x in sharp}) == 16


@pytest.mark.parametrize("potential", [two_r(), DIAMOND, planar([5.0, 3.0, 2.0])])
def test_search_finds_what_the_closed_form_says(potential):
    group = primary_symmetries(potential)
    rng = np.random.default_rng(1)
    for q in rng.uniform(-3, 3, (4, potential.n)):
        torque = potential.gradient(q)
        found = level_set(potential, torque, group=group)
        assert found.complete
        searched = search(level_set_equations(potential, torque, group), group, rng, 20_000)
        assert len(searched.y) == found.primary_set_count
        assert searched.hits.min() >= 6


def test_stable_members_are_strict_minima_of_potential_minus_work():
    potential = three_r()
    found = level_set(potential, potential.gradient([0.4, -0.8, -0.3]))
    rng = np.random.default_rng(0)
    for q, tau, stable in zip(found.configurations, found.torques, found.stable, strict=True):
        step = 1e-3 * rng.normal(size=(400, 3))
        energy = potential.evaluate(q + step) - step @ tau - potential.evaluate(q)
        assert stable == bool((energy > 0).all())
    assert len(found.stable_members) == found.stable.sum() > 0
    assert found.stable_members.stable.all()


def test_a_torque_no_configuration_needs_gives_an_empty_set():
    for potential in (two_r(), three_r()):
        found = level_set(potential, potential.gradient_bound() * 1.01)
        assert (len(found), found.complete) == (0, True)
        assert found.configurations.shape == (0, potential.n)
        assert found.primary_set_count == 0
    within_joint_limits = [A + 0.9 * B, 0.0]  # each torque possible, not both
    assert len(level_set(two_r(), within_joint_limits)) == 0
    searched = level_set(three_r(), [24.0, 20.0, 0.1], max_starts=500)
    assert (len(searched), searched.complete) == (0, False)


def test_torque_of_a_joint_that_feels_nothing():
    potential = TrigonometricPolynomial([[0, 1]], [0.0], [3.0])
    assert len(level_set(potential, [1.0, 2.0])) == 0
    found = level_set(potential, [0.0, 2.0])
    assert (len(found), found.complete, found.stable.sum()) == (4, True, 2)


def test_no_gravity_at_all():
    nothing = TrigonometricPolynomial(np.zeros((0, 2), dtype=int), [], [])
    assert len(level_set(nothing, [1.0, 0.0])) == 0
    assert len(level_set(nothing, [0.0, 0.0])) == 1


def test_joints_that_only_matter_together():
    """g1 = g2 = 3 cos(q1 + q2): other torques than equal ones are needed nowhere."""
    potential = TrigonometricPolynomial([[1, 1]], [0.0], [3.0])
    assert len(level_set(potential, [1.0, 2.0])) == 0
    assert len(level_set(potential, [1.0, -1.0])) == 4


def test_largest_torque_has_double_solutions():
    found = level_set(two_r(), [A + B, B])
    assert len(found) == 2
    assert not found.regular.any()
    assert not found.stable.any()


def test_equilibria_without_torque():
    found = level_set(two_r(), [0.0, 0.0])
    assert (len(found), found.stable.sum()) == (4, 1)
    np.testing.assert_allclose(found.stable_members.configurations, [[-np.pi / 2, 0]], atol=1e-12)


def test_a_continuum_is_not_mistaken_for_points():
    """3R with cos q1 = 0: the elbow torques vanish, the shoulder's is constant along a curve."""
    found = level_set(three_r(), [5.0, 0.0, 0.0])
    assert not found.complete
    assert not found.regular.all()


@pytest.mark.parametrize("torque", [[1.0], [1.0, np.nan], [[1.0, 2.0]]])
def test_unusable_torques_are_refused(torque):
    with pytest.raises(InputError, match="torque"):
        level_set(two_r(), torque)


def test_the_group_of_another_arm_is_refused():
    with pytest.raises(InputError, match="number of joints"):
        level_set(two_r(), [1.0, 1.0], group=primary_symmetries(three_r()))


@given(st.floats(1e-4, 1e-2), st.booleans())
@settings(max_examples=20)
def test_configurations_close_to_a_fold_are_two(away, searched):
    """Just below the largest torque two configurations of each sign lie next to each other."""
    pendulum = TrigonometricPolynomial([[1]], [0.0], [5.0])
    torque = pendulum.gradient([away])
    if searched:  # a second wave that is hardly there: no closed form
        pendulum = pendulum + TrigonometricPolynomial([[3]], [0.0], [1e-6])
        torque = pendulum.gradient([away])
    found = level_set(pendulum, torque)
    assert len(found) == 4
    assert found.complete != searched
    assert found.regular.all()
    for q in (away, -away, np.pi - away, away - np.pi):
        assert apart(np.array([q]), found.configurations).min() < 1e-6


@pytest.mark.parametrize("seed", range(4))
def test_no_search_ends_before_every_set_was_reached_several_times(monkeypatch, seed):
    """Few starts are prescribed here, so that it is the number of hits that ends the search."""
    monkeypatch.setattr("isotorque.symbolic.level_sets.newton_search.LEAST_STARTS", 1)
    rng = np.random.default_rng(seed)
    waves = [[1, 0], [1, 1], [0, 1], [1, -1]]
    potential = TrigonometricPolynomial(waves, rng.normal(size=4), rng.normal(size=4))
    torque = potential.gradient(rng.uniform(-3, 3, 2))
    found = level_set(potential, torque)
    assert len(found) > 0
    assert not found.complete
    assert found.fewest_hits >= 6


@given(st.floats(-12, 12), st.sampled_from([(-0.9, 0.4), (1.2, 0.1), (2.0, -0.8), (2.6, 1.5)]))
@settings(max_examples=15)
def test_members_with_a_torque_are_those_of_its_signs_in_any_unit(power, q):
    potential = 10.0**power * two_r()
    torque = potential.gradient(q)
    found = level_set(potential, torque)
    exactly = found.with_torque(torque)
    assert 0 < len(exactly) < len(found)
    assert (np.sign(exactly.torques) == np.sign(torque)).all()
    assert apart(np.array(q), exactly.configurations).min() < 1e-6
