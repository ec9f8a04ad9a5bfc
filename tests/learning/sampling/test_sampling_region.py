"""Tests of the regions that lattices fill."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from isotorque.learning.sampling.sampling_region import SamplingRegion
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


@pytest.mark.parametrize("robot", ["2r", "3r", "ur5"])
def test_a_domain_keeps_its_shape(robot):
    """Points of the region are those of the domain, and volume and corners agree."""
    domain = FundamentalDomain(primary_symmetries(GravityModel(load_robot(robot)).potential))
    region = SamplingRegion.of_domain(domain)
    assert ConvexHull(region.vertices).volume == pytest.approx(region.volume)
    assert region.gauge(region.vertices) == pytest.approx(1.0)
    w = np.random.default_rng(0).uniform(-4, 4, (500, region.dimension))
    inside = domain.contains_y(region.configurations(w) @ domain.basis.T)
    assert np.array_equal(region.contains(w), inside)
    assert 0 < inside.sum() < 500


@pytest.mark.parametrize(
    "limits", [[[1.0, 0.0]], [[0.0, np.inf]], [[0.0, 1.0, 2.0]], [], [[0.0, np.nan]]]
)
def test_refuses_what_is_no_box(limits):
    with pytest.raises(InputError, match="box"):
        SamplingRegion.of_box(limits)
