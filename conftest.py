"""Test settings shared by all tests: one derandomised Hypothesis profile, slow tests on request."""

import os

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "isotorque",
    derandomize=True,
    deadline=None,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.load_profile("isotorque")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--slow``."""
    parser.addoption("--slow", action="store_true", help="run the slow tests too")


def pytest_configure(config: pytest.Config) -> None:
    """Let test modules know of ``--slow`` when they are imported, in every process."""
    if config.getoption("--slow"):
        os.environ["ISOTORQUE_SLOW"] = "1"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out slow tests unless ``--slow`` or ``ISOTORQUE_SLOW=1`` is given."""
    if os.environ.get("ISOTORQUE_SLOW") == "1":
        return
    skip = pytest.mark.skip(reason="slow: run with --slow")
    for item in items:
        if "slow" in item.keywords:
            item.add_marker(skip)
