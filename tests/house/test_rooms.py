"""Rooms: few files side by side, tests beside what they try, no line left out of the format."""

import re
from collections import Counter
from pathlib import Path

import pytest

from tests.house.repository import ROOT, files

MOST_FILES = 14
LARGE = {Path("isotorque/cli")}  # a file per command
README = (ROOT / "tests" / "README.md").read_text()
KINDS = {Path(folder) for folder in re.findall(r"^\| `(tests/[\w/]+)` \|", README, re.M)}
TESTS = [path for path in files(".py") if path.name.startswith("test_")]


def test_no_room_is_crowded():
    rooms = Counter(path.parent for path in files(".py") if path.name != "__init__.py")
    crowded = {str(room): count for room, count in rooms.items() if count > MOST_FILES}
    assert set(crowded) <= {str(room) for room in LARGE}, crowded


def has_place(test: Path) -> bool:
    """Whether a test mirrors a module or a package, or is in the folder of its kind."""
    module = Path(*test.parts[1:]).with_name(test.name.removeprefix("test_"))
    package = module.with_suffix("") / "__init__.py"
    beside = test.with_name(module.name)  # a program of the tests: its tests stand beside it
    mirrored = any((ROOT / place).is_file() for place in (module, package, beside))
    return mirrored or test.parent in KINDS


def test_every_test_has_its_place():
    """See tests/README.md."""
    assert [str(test) for test in TESTS if not has_place(test)] == []


@pytest.mark.parametrize(
    ("test", "found"),
    [
        ("tests/symbolic/groups/test_subgroups.py", True),
        ("tests/benchmarks/test_growth.py", True),
        ("tests/house/test_anything.py", True),
        ("tests/symbolic/test_subgroups.py", False),
        ("tests/symbolic/groups/test_groups.py", False),
        ("tests/test_anything.py", False),
    ],
)
def test_a_place_is_known(test, found):
    assert has_place(Path(test)) == found


def test_every_kind_has_tests():
    assert {test.parent for test in TESTS} >= KINDS


def test_every_line_is_formatted():
    words = re.compile(r"# fmt: ?" + "(skip|off)")
    assert [str(path) for path in files(".py") if words.search((ROOT / path).read_text())] == []
