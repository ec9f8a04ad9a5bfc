"""Tests of moving a torque into the set of static torques."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.exploration.static_projection import nearest_admissible


class Disc:
    """Torques of length up to 2; only the origin and (1, 0) were ever held."""

    held = np.array([[0.0, 0.0], [1.0, 0.0]])

    def contains(self, torque):
        return bool(np.linalg.norm(torque) <= 2.0)

    def nearest(self, torque):
        return self.held[np.argmin(np.linalg.norm(self.held - torque, axis=1))]


coordinates = st.floats(-10, 10)


@given(coordinates, coordinates)
def test_admissible_torques_are_left_alone_and_others_moved_inside(x, y):
    torque = np.array([x, y])
    moved = nearest_admissible(Disc(), torque, True)
    held = nearest_admissible(Disc(), torque, False)
    if Disc().contains(torque):
        assert moved is torque
        assert held is torque
    else:
        assert Disc().contains(moved)
        assert held.tolist() == Disc().nearest(torque).tolist()
        assert np.linalg.norm(moved - torque) <= np.linalg.norm(held - torque) + 1e-12


def test_goes_most_of_the_way_to_the_boundary():
    moved = nearest_admissible(Disc(), np.array([3.0, 0.0]), True)
    assert 1.5 < moved[0] < 2.0
    assert moved[1] == 0.0


def test_without_a_set_everything_is_admissible():
    torque = np.array([100.0])
    assert nearest_admissible(None, torque, True) is torque
