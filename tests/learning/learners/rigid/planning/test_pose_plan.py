"""Planned poses: better than random ones, and as good as they say."""

import numpy as np
import pytest

from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.planning.information import Information, parameter_mask
from isotorque.learning.learners.rigid.planning.pose_plan import plan_poses
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


@pytest.mark.parametrize("name", ["3r", "panda"])
def test_planned_poses_are_worth_more_than_random_ones(name):
    """A third fewer poses, or two thirds of the error."""
    chain = chain_of_tree(load_robot(name).tree)
    n, rng = chain.n, np.random.default_rng(0)
    region, candidates = random_poses(rng, 60, n), random_poses(rng, 150, n)
    found = plan_poses(chain, parameter_mask(n), no_samples(n), candidates, region, 10)
    planned = largest_error(chain, found.poses, region)
    assert found.expected[-1] == pytest.approx(planned, rel=0.05)

    def at_random(count):
        errors = [largest_error(chain, random_poses(rng, count, n), region) for _ in range(15)]
        return np.median(errors)

    assert planned <= 0.7 * at_random(10)
    assert planned <= 1.1 * at_random(15)


def test_it_goes_on_from_samples_and_stops_when_enough_is_known():
    chain = chain_of_tree(load_robot("2r").tree)
    rng = np.random.default_rng(1)
    q = random_poses(rng, 6, 2)
    seen = ChainSamples(q, chain.torque(q), np.full(2, NOISE), np.zeros(2), np.ones(6))
    region, candidates = random_poses(rng, 60, 2), random_poses(rng, 80, 2)
    found = plan_poses(chain, parameter_mask(2), seen, candidates, region, 30, within=0.1)
    assert 0 < len(found.poses) < 30
    assert 3 * found.expected[-1] <= 0.1 < 3 * found.before
    enough = plan_poses(chain, parameter_mask(2), seen, candidates, region, 30, within=100.0)
    assert not len(enough.poses)


def test_nothing_to_choose_from_is_refused():
    chain = chain_of_tree(load_robot("2r").tree)
    with pytest.raises(InputError, match="choose"):
        plan_poses(chain, parameter_mask(2), no_samples(2), np.zeros((0, 2)), np.zeros((1, 2)), 1)
