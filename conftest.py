"""Settings of all tests: a derandomised Hypothesis profile, slow tests on request, import names."""

import os
import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

import pytest
from hypothesis import HealthCheck, Phase, settings

# before NumPy is loaded: tests run in as many processes as there are processors, and threads of
# linear algebra that wait for each other cost several times what they do
for library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

settings.register_profile(
    "isotorque",
    derandomize=True,
    deadline=None,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.register_profile(
    "first-failure",  # whether a test fails, and not by what smallest example: tests.mutations
    settings.get_profile("isotorque"),
    phases=[Phase.explicit, Phase.generate],
)
settings.load_profile("isotorque")


FOLDERS = ("symbolic", "learning", "verify")
"""Folders at the root that are isotorque's: by these names they would be second copies of it."""


class BareNames(MetaPathFinder):
    """Refuses to import folders of the root by their bare names, which tests run there could."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        """Raise for a bare name; leave every other module to others."""
        if fullname.partition(".")[0] in FOLDERS:
            raise ImportError(f"import isotorque.{fullname}, not {fullname}", name=fullname)
        return None


def refuse_bare_names() -> None:
    """Refuse bare names from now on, and say so if one has been imported already."""
    if found := [name for name in FOLDERS if name in sys.modules]:
        raise pytest.UsageError(f"import isotorque.{found[0]}, not {found[0]}")
    sys.meta_path.insert(0, BareNames())


refuse_bare_names()


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
