"""Probes of learned models find what was put in."""

from __future__ import annotations

import numpy as np
import pytest

from isotorque.verify.models.probes import equivariance_error, moved_to_limits, periodicity_error
from isotorque.verify.models.target_sets import dense_targets


def test_departures_from_symmetry_and_period_are_the_largest_ones(two_link):
    q = dense_targets([[-np.pi, np.pi]] * 2, samples=200).q
    assert equivariance_error(two_link.gravity.torque, two_link.group, q)[0] < 1e-12
    assert periodicity_error(two_link.gravity.torque, q)[0] < 1e-12

    def drifting(x):
        return two_link.gravity.torque(x) + 0.01 * x

    size, at = periodicity_error(drifting, q)
    assert size == pytest.approx(0.02 * np.pi)
    assert at in q
    size, at = equivariance_error(drifting, two_link.group, q)
    here = max(
        np.abs(drifting(r.configuration(at[None])) - r.torque(drifting(at[None]))).max()
        for r in two_link.group
    )
    assert size == pytest.approx(here)


def test_one_joint_of_each_configuration_is_moved_to_a_limit():
    box = np.array([[-1.0, 0.5], [-np.pi, np.pi], [0.0, 2.0]])
    dense = dense_targets(box)
    moved = moved_to_limits(dense, box).q
    changed = moved != dense.q
    assert (changed.sum(axis=1) <= 1).all()
    assert not changed[:, 1].any()
    on = (moved[:, [0, 2], None] == box[[0, 2]][None]).reshape(len(moved), 4)
    assert on.any(axis=1).all()
    assert (on.mean(axis=0) > 0.2).all()  # every limit gets its share
    assert moved_to_limits(dense, np.array([[-np.pi, np.pi]] * 3)) is None
