"""Arms that the tests of this package judge things against; derived once."""

from __future__ import annotations

import pytest

from symbolic.robots import load_robot
from verify.strategies import KnownArm

NAMES = ("pendulum", "2r", "3r", "4r-planar")


@pytest.fixture(scope="session")
def arms():
    """Built-in arms by name."""
    return {name: KnownArm.of(load_robot(name)) for name in NAMES}


@pytest.fixture(scope="session")
def two_link(arms):
    """The paper's 2R arm."""
    return arms["2r"]
