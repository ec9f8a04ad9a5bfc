"""Data sets of the protocol: all of them, a share, and what is in one."""

from collections import Counter

import numpy as np
import pytest

from benchmarks.claims.data_sets import CLEAN, DATA_SETS, POOLS, ROBOTS, Setting, draw, settings
from isotorque.verify.testing.contaminated_arms import Contaminant

WHOLE = list(settings())


def setting(pool, *, robot="2r", poses=20, noise=0.05, index=3, seed=0):
    return Setting(robot, pool, poses, noise, index, seed)


def test_every_pool_has_300_different_data_sets():
    assert len(set(WHOLE)) == len(WHOLE)
    pools = Counter((s.robot, s.pool) for s in WHOLE)
    assert set(pools) == {(robot, pool) for robot in ROBOTS for pool in POOLS}
    assert set(pools.values()) == {sum(DATA_SETS.values())} == {300}


@pytest.mark.parametrize("pool", ["spring", "payload"])
def test_sizes_and_what_is_told_take_turns(pool):
    for poses in (20, 100):
        some = [s for s in WHOLE if (s.robot, s.pool, s.poses) == ("3r", pool, poses)]
        sizes = Counter((s.noise, s.deviations) for s in some)
        assert len(sizes) == 8
        assert max(sizes.values()) - min(sizes.values()) <= 1
        for told in ("noise_stated", "directions_recorded"):
            assert 0.3 < np.mean([getattr(s, told) for s in some]) < 0.7


def test_a_share_is_a_part_of_the_whole_that_the_seed_draws():
    share = list(settings(share=0.05, seed=4))
    assert share == list(settings(share=0.05, seed=4))
    whole = set(settings(seed=4))
    assert set(share) <= whole
    assert len(share) == pytest.approx(0.05 * len(whole), rel=0.1)
    other = {(s.robot, s.pool, s.poses, s.noise, s.index) for s in settings(share=0.05, seed=5)}
    assert other != {(s.robot, s.pool, s.poses, s.noise, s.index) for s in share}
    assert set(share) & set(settings(["2r"], share=0.05, seed=4)) == {
        s
        for s in share
        if s.robot == "2r"  # a choice of robots changes nothing
    }


@pytest.mark.parametrize("pool", POOLS)
def test_one_seed_gives_one_data_set(pool):
    one, again, other = (draw(setting(pool, seed=seed)) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.recorded.tau, again.recorded.tau)
    assert not np.array_equal(one.recorded.q, other.recorded.q)
    assert one.contamination.kind is (None if pool in CLEAN else Contaminant(pool))


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", Contaminant)
def test_a_size_is_so_many_least_standard_errors_and_plausible(robot, kind):
    for index in range(4):
        asked = setting(str(kind), robot=robot, index=index)
        data = draw(asked)
        found = data.contamination
        error = found.standard_error(data.noise)
        assert abs(data.size) == pytest.approx(data.deviations * error)
        assert abs(data.size) <= found.largest
        if kind is not Contaminant.SIGN:
            assert data.deviations == asked.deviations


def test_noise_is_what_the_pool_says():
    equal, unequal = draw(setting("clean")), draw(setting("clean-unequal"))
    assert set(equal.noise) == {0.05}
    assert equal.stated == 0.05
    assert len(set(unequal.noise)) == 2
    assert unequal.stated is None
    assert draw(setting("clean-unknown")).stated is None
    assert draw(setting("clean-angles")).stated == 0.05
    assert draw(setting("clean-angles", noise=0.01)).stated is None
    angles = draw(setting("clean-angles"))
    errors = angles.recorded.q - angles.contamination.q
    assert np.rad2deg(errors.std()) == pytest.approx(0.05, rel=0.4)
    assert not np.any(equal.recorded.q - equal.contamination.q)
