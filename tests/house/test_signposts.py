"""Signposts: what comments, docstrings and pages point to is there."""

import ast
import builtins
import re

import pytest

from tests.house.repository import FOLDERS, ROOT, files

TEXTS = {
    path: (ROOT / path).read_text()
    for path in files(".py", ".md", ".toml", "")
    if "house" not in path.parts  # which names what is not there
}
MADE = {"docs/page.md"}  # made by a test
FOREIGN = {  # names of other programs
    "computeStaticRegressor",
    "computeJointTorqueRegressor",
    "franka_description",
    "ur_description",
}

PATH = re.compile(rf"(?<![\w/.-])((?:{'|'.join(FOLDERS)})/[\w./-]+\.(?:py|md|urdf|csv|c|j2|svg))\b")
COMMAND = re.compile(r"python -m ((?:benchmarks|docs|tests)(?:\.\w+)*)")
HEADING = re.compile(r'([\w-]+\.md), "([^"]+)"')
NUMBERED = re.compile(r"(?<![\w-])(?:theory|learning|physics|groups|statistics)\.md,?\s+section")
NAME = re.compile(r"(?<!`)(`{1,2})([A-Za-z_][\w.]{3,})(?:\(\))?\1(?!`)")


def found(pattern):
    """Every match with the file it is in; paragraphs are joined, as lines are broken anywhere."""
    for path, text in TEXTS.items():
        for match in pattern.finditer(re.sub(r"\n[ #]*(?=\S)", " ", text)):
            yield path, match


def is_there(path: str) -> bool:
    return path in MADE or (ROOT / path).exists()


def is_command(module: str) -> bool:
    place = ROOT / module.replace(".", "/")
    return place.with_suffix(".py").is_file() or (place / "__main__.py").is_file()


def test_files_that_are_named_exist():
    assert [f"{path}: {m[1]}" for path, m in found(PATH) if not is_there(m[1])] == []


def test_commands_that_are_named_exist():
    assert [f"{path}: {m[1]}" for path, m in found(COMMAND) if not is_command(m[1])] == []


def test_headings_that_are_named_exist():
    lost = []
    for path, match in found(HEADING):
        page = ROOT / "docs" / match[1]
        headings = re.findall(r"^#+ (.+)$", page.read_text(), re.M) if page.is_file() else []
        lost += [] if match[2] in headings else [f"{path}: {match[0]}"]
    assert lost == []


def test_pages_have_no_numbered_sections_to_point_to():
    assert [f"{path}: {m[0]}" for path, m in found(NUMBERED)] == []


@pytest.fixture(scope="module")
def known():
    """Every identifier of the code, and every word of its strings but docstrings."""
    words = set(dir(builtins)) | FOREIGN
    words |= {part for path in files() for part in (*path.parts, path.stem)}
    for path, text in TEXTS.items():
        if path.suffix != ".py":
            continue
        for node in ast.walk(ast.parse(text)):
            for field in ("id", "attr", "name", "arg", "asname"):
                word = getattr(node, field, None)
                words |= set(word.split(".")) if isinstance(word, str) else set()
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                words |= set() if "`" in node.value else set(re.findall(r"\w+", node.value))
            elif isinstance(node, ast.ImportFrom) and node.module:
                words |= set(node.module.split("."))
    return words


def test_names_in_backticks_exist(known):
    """`TiedLeastSquares` stood in a docstring long after it had another name."""
    lost = []
    for path, match in found(NAME):
        name = match[2].rstrip(".").split(".")[-1]
        symbol = re.search(r"_\w$", name)  # of a formula: tau_2, moved_i
        if not (symbol or name in known):
            lost.append(f"{path}: {match[2]}")
    assert lost == []


def test_what_is_not_there_is_found(known):
    assert not is_there("docs/no-such-page.md")
    assert not is_command("benchmarks.no_such_command")
    assert "TiedLeastSquares" not in known
    text = 'see theory.md, section 2; docs/theory.md, "Identification"; `Robot`'
    assert NUMBERED.search(text)
    assert HEADING.search(text)[2] == "Identification"
    assert PATH.search(text)[1] == "docs/theory.md"
    assert NAME.search(text)[2] == "Robot"
