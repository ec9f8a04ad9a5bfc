"""What is declared in pyproject.toml is what is imported; the lists of versions agree with it."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

MODULES = {
    "adam-robotics": "adam",
    "example-robot-data": None,
    "import-linter": "importlinter",
    "jinja2": "jinja2",
    "pin": "pinocchio",
    "python-flint": "flint",
    "scikit-learn": "sklearn",
}
"""What a distribution is imported as, where that is another name; None: it holds data only."""

TOOLS = {
    "mypy": "Makefile",
    "pre-commit": "CONTRIBUTING.md",
    "pytest-timeout": "pyproject.toml",
    "pytest-xdist": "Makefile",
    "ruff": "Makefile",
}
"""Distributions that are run and not imported, and the file that does."""

USED_IN = {"pytest-timeout": "timeout = ", "pytest-xdist": "--dist"}

OURS = {"isotorque", "tests", "benchmarks", "docs", "examples", "contracts", "conftest"}
INSTALLED = ("isotorque",)
OTHERS = ("tests", "benchmarks", "docs", "examples", "contracts", "conftest.py", "setup.py")


def name_and_version(requirement: str) -> tuple[str, str]:
    """Name and lowest version of a requirement."""
    found = re.fullmatch(r"([a-z0-9-]+)(?:\[[a-z]+\])?>=([0-9.]+)", requirement)
    assert found, f"{requirement}: a name and a lowest version are expected"
    return found[1], found[2]


def declared(*extras: str) -> set[str]:
    """Names of the dependencies, or of those of some extras."""
    lists = (
        [PROJECT["optional-dependencies"][extra] for extra in extras]
        if extras
        else [PROJECT["dependencies"]]
    )
    return {name_and_version(requirement)[0] for entries in lists for requirement in entries}


@cache
def imported(*places: str) -> dict[str, str]:
    """Names of modules of others, and one file that imports each; those for type checkers too."""
    found = {}
    for place in places:
        for path in files(ROOT / place):
            for node in ast.walk(ast.parse(path.read_text())):
                for name in names(node):
                    if name not in sys.stdlib_module_names | OURS:
                        found[name] = str(path.relative_to(ROOT))
    return found


def files(place: Path) -> Iterator[Path]:
    """Python files of a folder, links followed."""
    if place.is_file():
        yield place
        return
    for entry in sorted(place.iterdir()):
        if entry.is_dir() or entry.suffix == ".py":
            yield from files(entry)


def names(node: ast.AST) -> list[str]:
    """Top-level names that a statement imports, through importorskip and the like too."""
    if isinstance(node, ast.Import):
        return [alias.name.partition(".")[0] for alias in node.names]
    if isinstance(node, ast.ImportFrom) and node.level == 0:
        return [str(node.module).partition(".")[0]]
    if isinstance(node, ast.Call) and ast.unparse(node.func).endswith(
        ("importorskip", "import_module")
    ):
        return [
            argument.value.partition(".")[0]
            for argument in node.args[:1]
            if isinstance(argument, ast.Constant)
        ]
    return []


def module(distribution: str) -> str | None:
    """Name that a distribution is imported by."""
    return MODULES.get(distribution, distribution.replace("-", "_"))


def test_files_behind_links_are_read():
    assert imported("isotorque").keys() >= {"pinocchio", "sklearn", "typer", "matplotlib"}


def test_what_the_package_imports_is_declared_and_nothing_else():
    optional = {module(name) for name in declared("cluster")}
    needed = {name: path for name, path in imported(*INSTALLED).items() if name not in optional}
    assert set(needed) == {module(name) for name in declared()}, needed


def test_what_tests_and_tools_import_is_declared():
    known = {module(name) for name in declared() | declared(*PROJECT["optional-dependencies"])}
    assert {k: v for k, v in imported(*OTHERS).items() if k not in known} == {}


@pytest.mark.parametrize("extra", PROJECT["optional-dependencies"])
def test_every_extra_is_imported_or_run(extra):
    used = imported(*INSTALLED) | imported(*OTHERS)
    for name in declared(extra):
        if name in TOOLS:
            assert USED_IN.get(name, name) in (ROOT / TOOLS[name]).read_text()
        elif module(name) is not None:
            assert module(name) in used, name


PUBLIC = {"numba": {"numba"}, "typer": {"typer", "typer.core"}}
"""Modules of dependencies with large private parts that their documentation names."""

EXCEPTIONS = {"numba.cpython.unsafe.tuple": "isotorque/symbolic/common/compiled.py"}
"""Private modules that are imported in one place, which says why."""


def private_imports(source: str, path: str) -> list[str]:
    """Modules and names that are imported from private parts of dependencies."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            modules, members = [alias.name for alias in node.names], []
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            modules, members = [str(node.module)], [alias.name for alias in node.names]
        else:
            continue
        for name in modules:
            top = name.partition(".")[0]
            if top in sys.stdlib_module_names | OURS or EXCEPTIONS.get(name) == path:
                continue
            parts = [*name.split("."), *members]
            hidden = any(part.startswith("_") for part in parts)
            if hidden or (top in PUBLIC and name not in PUBLIC[top]):
                found.append(name)
            found += [f"{name}.{x}" for x in members if top == "numba" and x == "core"]
    return found


def test_nothing_is_imported_from_private_parts_of_dependencies():
    found = {}
    for path in files(ROOT / "isotorque"):
        where = path.relative_to(ROOT).as_posix()
        if private := private_imports(path.read_text(), where):
            found[where] = private
    assert found == {}


@pytest.mark.parametrize(
    "line",
    [
        "import numba.core",
        "from numba import core",
        "from numba.core.dispatcher import Dispatcher",
        "from numba.cpython.unsafe.tuple import tuple_setitem",
        "from typer._click import exceptions",
        "from scipy.linalg import _decomp",
        "import sklearn._config",
    ],
)
def test_a_private_import_is_found(line):
    assert private_imports(line, "isotorque/x.py")


def versions(file: str) -> dict[str, str]:
    """Versions that a list of constraints sets, by normalised name."""
    lines = (ROOT / file).read_text().splitlines()
    pairs = (line.split("==") for line in lines if line)
    return {name.lower().replace("_", "-"): version for name, version in pairs}


def test_the_oldest_versions_are_those_declared():
    entries = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["test"]]
    assert versions("oldest-constraints.txt") == dict(map(name_and_version, entries))


def test_the_newest_versions_are_all_set_and_none_is_older_than_the_oldest():
    newest = versions("constraints.txt")
    for extra in PROJECT["optional-dependencies"]:
        assert declared(extra) <= newest.keys()
    for name, version in versions("oldest-constraints.txt").items():
        assert as_numbers(newest[name]) >= as_numbers(version), name


def test_the_tests_of_the_oldest_versions_exist():
    [chosen] = re.findall(
        r"^OLDEST_TESTS := ((?:.*\\\n)*.*)", (ROOT / "Makefile").read_text(), re.M
    )
    places = chosen.replace("\\\n", " ").split()
    assert len(places) > 10
    assert [place for place in places if not (ROOT / place).exists()] == []


def as_numbers(version: str) -> tuple[int, ...]:
    """Return a version as numbers, to compare."""
    return tuple(map(int, version.split(".")))
