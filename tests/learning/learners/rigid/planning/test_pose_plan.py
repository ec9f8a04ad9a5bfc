"""Planned poses: better than random ones, and as good as they say."""

import numpy as np
import pytest

from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.planning.information import Information, parameter_mask
from isotorque.learning.learners.rigid.planning.pose_design import PoseDesign
from isotorque.learning.learners.rigid.planning.pose_plan import plan_poses, plan_poses_within
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners.rigid.random_chains import chain_of_tree, random_poses

NOISE = 0.05


def no_samples(n):
    nothing = np.zeros((0, n))
    return ChainSamples(nothing, nothing, np.full(n, NOISE), np.zeros(n), np.zeros(0))


def largest_error(chain, q, region):
    whitening = np.tile(np.eye(chain.n) / NOISE, (len(q), 1, 1))
    information = Information.of(chain, q, whitening, parameter_mask(chain.n))
    return information.standard_error(chain, region).max()


def errors_at_random(chain, count, region, rng):
    drawn = [random_poses(rng, count, chain.n) for _ in range(15)]
    return np.median([largest_error(chain, q, region) for q in drawn])


@pytest.mark.parametrize("name", ["3r", "panda"])
def test_eight_planned_poses_are_worth_more_than_fourteen_random_ones(name):
    """Sixteen in the median of many plans: docs/rigid-chain.md."""
    chain = chain_of_tree(load_robot(name).tree)
    n, rng = chain.n, np.random.default_rng(0)
    high = np.full(n, np.pi)
    region, elsewhere = random_poses(rng, 200, n), random_poses(rng, 400, n)
    known = chain, parameter_mask(n), no_samples(n)
    found = plan_poses_within(*known, -high, high, region, 8)
    assert np.all(np.abs(found.poses) <= np.pi)
    planned = largest_error(chain, found.poses, region)
    assert found.expected[-1] == pytest.approx(planned, rel=0.1)
    assert largest_error(chain, found.poses, elsewhere) <= errors_at_random(
        chain, 14, elsewhere, rng
    )


def test_a_choice_from_a_list_is_better_than_chance():
    """A third fewer poses, or two thirds of the error."""
    chain = chain_of_tree(load_robot("panda").tree)
    n, rng = chain.n, np.random.default_rng(0)
    region, candidates = random_poses(rng, 60, n), random_poses(rng, 150, n)
    found = plan_poses(chain, parameter_mask(n), no_samples(n), candidates, region, 10)
    assert {tuple(q) for q in found.poses} <= {tuple(q) for q in candidates}
    planned = largest_error(chain, found.poses, region)
    assert planned <= 0.7 * errors_at_random(chain, 10, region, rng)
    assert planned <= 1.1 * errors_at_random(chain, 15, region, rng)


@pytest.mark.parametrize("power", [1.0, 4.0, 16.0])
def test_the_slope_of_the_criterion(power):
    """By differences of the criterion, noise on angles included."""
    chain = chain_of_tree(load_robot("ur5").tree)
    n, rng = chain.n, np.random.default_rng(2)
    q = random_poses(rng, 4, n)
    few = ChainSamples(q, chain.torque(q), np.full(n, NOISE), np.full(n, 0.002), np.ones(4))
    design = PoseDesign.of(chain, parameter_mask(n), few, random_poses(rng, 40, n))
    poses, direction = random_poses(rng, 5, n), rng.normal(size=(5, n))
    value, slope = design.value_and_slope(poses, power)
    ends = [design.value_and_slope(poses + s * direction, power)[0] for s in (-1e-4, 1e-4)]
    assert np.sum(slope * direction) == pytest.approx((ends[1] - ends[0]) / 2e-4, rel=1e-3)
    offered = [rows[None, -1] for rows in design.rows(poses)]
    before = design.covariances(design.rows(poses[:-1]))
    assert design.after_each(before, offered, power)[0] == pytest.approx(value, rel=1e-9)


def test_poses_stay_within_effort_limits():
    """Half of what the arm needs where it is stretched out."""
    chain = chain_of_tree(load_robot("3r").tree)
    n, rng = chain.n, np.random.default_rng(3)
    region, high = random_poses(rng, 60, n), np.full(n, np.pi)
    most = 0.5 * np.abs(chain.torque(region)).max(axis=0) + 0.1
    known = chain, parameter_mask(n), no_samples(n)
    found = plan_poses_within(*known, -high, high, region, 4, effort=most)
    assert np.all(np.abs(chain.torque(found.poses)) <= most)
    with pytest.raises(InputError, match="effort"):
        plan_poses_within(*known, 0 * high + 0.4, 0 * high + 0.5, region, 4, effort=0.01 * most)


def test_it_goes_on_from_samples_and_stops_when_enough_is_known():
    chain = chain_of_tree(load_robot("2r").tree)
    rng = np.random.default_rng(1)
    q = random_poses(rng, 6, 2)
    seen = ChainSamples(q, chain.torque(q), np.full(2, NOISE), np.zeros(2), np.ones(6))
    region, candidates = random_poses(rng, 60, 2), random_poses(rng, 80, 2)
    found = plan_poses(chain, parameter_mask(2), seen, candidates, region, 30, within=0.1)
    assert 0 < len(found.poses) < 30
    assert 3 * found.expected[-1] <= 0.1 < 3 * found.before
    high = np.full(2, np.pi)
    known = chain, parameter_mask(2), seen, -high, high, region
    anywhere = plan_poses_within(*known, 30, within=0.1)
    assert 0 < len(anywhere.poses) <= len(found.poses)
    assert 3 * anywhere.expected[-1] <= 0.1 < 3 * anywhere.before
    fewer = plan_poses_within(*known, len(anywhere.poses) - 1)
    assert 3 * fewer.expected[-1] > 0.1
    enough = plan_poses(chain, parameter_mask(2), seen, candidates, region, 30, within=100.0)
    assert not len(enough.poses)


def test_nothing_to_choose_from_is_refused():
    chain = chain_of_tree(load_robot("2r").tree)
    with pytest.raises(InputError, match="choose"):
        plan_poses(chain, parameter_mask(2), no_samples(2), np.zeros((0, 2)), np.zeros((1, 2)), 1)
