"""README and docs/: their Python runs, their commands exist, their figures are what is printed."""

import importlib.util
import json
import re
import shlex
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import typer

from isotorque.cli.main import app, status
from isotorque.learning.files.csv_samples import write_csv
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

ROOT = Path(__file__).parents[2]
PAGES = {p.name: p.read_text() for p in (ROOT / "README.md", *sorted(ROOT.glob("docs/*.md")))}

# -- Python -------------------------------------------------------------------------------------

BLOCK = re.compile(r"^```python\n(.*?)^```", re.S | re.M)
WITH_PYTHON = [name for name, text in PAGES.items() if BLOCK.search(text)]
BEFORE = {  # commands of the page that write what its Python reads
    "export.md": ["export 2r --npz gravity.npz"],
    "your-robot.md": [
        "learn 2r --data arm.csv --out out/b --quiet --learner parametric --symmetries none"
    ],
}


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A directory with a robot's file and a recording, as the pages assume them."""
    monkeypatch.chdir(tmp_path)
    Path("examples").symlink_to(ROOT / "examples")
    Path("my_arm.urdf").write_text(
        files("isotorque.symbolic").joinpath("robot_files/2r.urdf").read_text()
    )
    robot = load_robot("2r")
    q = np.array([[0.1 * i, 0.3 * i - 2.0] for i in range(20)])
    write_csv("arm.csv", StaticSamples(q, GravityModel(robot).torque(q)), robot.joint_names)


@pytest.mark.parametrize("page", WITH_PYTHON)
def test_the_python_of_a_page_runs_and_prints_what_it_says(page, place, capsys):
    for command in BEFORE.get(page, []):
        assert status(shlex.split(command)) == 0, capsys.readouterr().err
    names: dict = {}
    for code in BLOCK.findall(PAGES[page]):
        if code.lstrip().startswith(">>>"):  # those are doctests
            continue
        capsys.readouterr()
        exec(compile(code, page, "exec"), names)
        said = re.findall(r"print\(.*\)  # (.*)|^ *# (.*)$", code, re.M)
        printed = capsys.readouterr().out.splitlines()
        wanted = [a or b for a, b in said] if printed else []
        assert len(printed) == len(wanted)
        for line, words in zip(printed, wanted, strict=True):
            assert line.startswith(words.removesuffix("...").rstrip())


# -- commands -----------------------------------------------------------------------------------

COMMANDS = typer.main.get_command(app).commands
LINE = re.compile(r"^(?: {4})?(?:\$ )?(isotorque .*)$", re.M)
INLINE = re.compile(r"`((?:isotorque|python -m|make) [^`]*)`")
PLACEHOLDERS = {"N": "1", "A,B": "1,2"}


def written(text):
    """All commands of a page, those of code lines and those within sentences."""
    for command in (*LINE.findall(text), *INLINE.findall(text)):
        yield " ".join(re.sub(r"\s#.*|\s\|\s.*", "", command).split())


WRITTEN = sorted({(page, command) for page, text in PAGES.items() for command in written(text)})


@pytest.mark.parametrize(("page", "command"), WRITTEN)
def test_every_command_that_is_written_exists_with_its_options(page, command):
    program, *arguments = shlex.split(command)
    if program == "make":
        targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.M)
        assert set(arguments) <= set(targets)
    elif program == "python":
        module, *rest = arguments[1:]
        spec = importlib.util.find_spec(module)
        assert spec is not None
        if spec.origin and module.split(".")[0] in ("benchmarks", "docs"):
            folder = Path(spec.origin)
            sources = folder.parent.glob("*.py") if folder.name == "__init__.py" else [folder]
            source = "".join(p.read_text() for p in sources)
            assert all(f'"{word}"' in source for word in rest if word.startswith("--"))
    else:
        name, *rest = arguments
        assert name in COMMANDS
        if rest and "..." not in rest and "--help" not in rest:
            rest = [PLACEHOLDERS.get(word, word) for word in rest]
            COMMANDS[name].make_context(name, rest)


# -- output -------------------------------------------------------------------------------------

BLOCKS = re.compile(r"^```console\n(.*?)^```|((?:^    [^\n]+\n)+)", re.S | re.M)
STEP = re.compile(r"^\$ isotorque (.*)\n((?:(?!\$ ).+\n)*)", re.M)
LONG = ("run", "paper", "sweep", "learn")
ROUNDING = re.compile(r"\b\d(\.\d+)?e-1[1-9]\b")  # digits that another machine adds up otherwise
ELSEWHERE = "panda.urdf"  # a file that is not here


def sessions():
    """Commands with the output that is shown below them, those of one block together."""
    for page, text in PAGES.items():
        for block in BLOCKS.finditer(text):
            steps = STEP.findall(block[1] or re.sub("^    ", "", block[2], flags=re.M))
            if any(shown for _, shown in steps) and ELSEWHERE not in block[0]:
                long = any(c.split()[0] in LONG and "error: " not in out for c, out in steps)
                yield pytest.param(steps, marks=pytest.mark.slow if long else (), id=page)


@pytest.mark.parametrize("steps", list(sessions()))
def test_output_that_is_shown_is_what_the_commands_print(steps, place, capsys):
    for command, shown in steps:
        status(shlex.split(command.split(" | ")[0], comments=True))
        captured = capsys.readouterr()
        lines = ROUNDING.sub("0", shown).splitlines()
        printed = ROUNDING.sub("0", captured.out + captured.err).splitlines()
        assert lines == [line for line in printed if line in lines]


# -- figures ------------------------------------------------------------------------------------

FIGURES = {
    # command: the page and the figures in it that it prints, as they stand there
    "isotorque derive 2r": {
        "README.md": ["18.3938", "6.13125"],
        "physics.md": ["18.39", "6.13"],
        "online.md": ["18.39"],
    },
    "isotorque discover 2r --physics geared --out out/g": {"limits.md": ["4"]},
    "isotorque derive 3r": {"physics.md": ["6.131"]},
    "isotorque symmetries 2r": {"README.md": ["8"], "differences.md": ["8"]},
    "isotorque symmetries 3r": {"README.md": ["16"], "differences.md": ["16"]},
}
SLOW_FIGURES = {
    "isotorque run 2r --out out/2r": {"README.md": ["0.005", "3000", "8"]},
    "isotorque run 2r --out out/rls --learner recursive-least-squares --samples 200": {
        "README.md": ["0.00001", "200"]
    },
    "isotorque learn 2r --strategy lattice --samples 64 --out out/lattice": {
        "README.md": ["0.00002", "64", "186", "2048"]
    },
    "isotorque run 3r --out out/3r": {"README.md": ["16"]},
}
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e-?\d+)?(?![\w])")


def check_figures(command, pages, capsys):
    assert status(shlex.split(command)[1:]) in (0, 1)
    captured = capsys.readouterr()
    printed = [float(number) for number in NUMBER.findall(captured.out + captured.err)]
    for page, figures in pages.items():
        assert command in " ".join(PAGES[page].split())
        for figure in figures:
            assert re.search(rf"(?<![\d.]){re.escape(figure)}(?![\d])", PAGES[page])
            digits = len(figure.partition(".")[2])
            assert any(f"{number:.{digits}f}" == figure for number in printed), (figure, printed)


@pytest.mark.parametrize("command", FIGURES)
def test_figures_of_a_page_are_those_that_the_command_prints(command, place, capsys):
    check_figures(command, FIGURES[command], capsys)


@pytest.mark.slow
@pytest.mark.parametrize("command", SLOW_FIGURES)
def test_figures_of_longer_commands(command, place, capsys):
    check_figures(command, SLOW_FIGURES[command], capsys)


@pytest.mark.parametrize(("robot", "observed", "order"), [("2r", 0, 8), ("3r", 0, 16)])
def test_pairs_show_as_many_relations_as_the_pages_say(robot, observed, order, place, capsys):
    for page in ("README.md", "differences.md", "limits.md"):
        said = re.findall(r"(\d+|none) of (\d+) on\s+the\s+3?2?R", PAGES[page])
        assert (str(observed or "none"), str(order)) in said
    assert status(["discover", robot, "--out", "out/d", "--quiet"]) == 0
    capsys.readouterr()
    assert status(["relations", "out/d", "--json", "--quiet"]) == 0
    known = [entry["known"] for entry in json.loads(capsys.readouterr().out)["relations"]]
    assert len(known) == order
    assert sum(word != "identified" for word in known) == observed


# -- figures that name no command ---------------------------------------------------------------

WITHOUT = {
    # what the numbers of a section are, where they are no measurements
    ("claims.md", "What is demanded"): "settings",
    ("export.md", "Arrays"): "the version of a format",
    ("export.md", "What becomes of a learner"): "formulas; the tests are named under CasADi",
    ("paper.md", "How to read it"): "the paper's targets; settings",
    ("physics.md", "When has an arm settled?"): "the rule of settling",
    ("recordings.md", "What is refused"): "an exit status",
    ("recordings.md", "The tables"): "a format",
    ("relations.md", "Relations from elsewhere"): "an exit status",
    ("rigid-chain.md", "Why so few: levers"): "counts of numbers and equations",
    ("rigid-chain.md", "How it is found"): "settings; two shares that no command prints",
    ("rigid-chain.md", "Gains, offsets, signs"): "settings",
    ("rigid-chain.md", "Snapping and symmetries"): "settings",
    ("rigid-chain.md", "Limits"): "settings",
    ("theory.md", "Identification"): "counts of numbers",
    ("theory.md", "The words proved, bounded, tested"): "the rule of snapping",
    ("theory.md", "Level sets and secondary symmetries"): "a proof; `isotorque run` draws them",
    ("your-robot.md", "Your own recordings"): "the format of a recording",
}
NAMES_ONE = re.compile(
    r"`(?:isotorque |python |make)|^(?: {4}|\$ | {4}\$ )(?:isotorque|make|python -m) ", re.M
)
NO_PROSE = re.compile(r"<!--.*?-->|!\[.*?\]|^```.*?^```|^    .*?$|`[^`]*`|\]\([^)]*\)", re.S | re.M)


def has_figure(body):
    """Whether prose or tables have a number; code, links and comments do not count."""
    return re.search(r"(?<![\w.])\d", NO_PROSE.sub("", body)) is not None


def sections(text):
    """Headings below the page's own, and what stands there; deeper ones begin with the rest."""
    parts = re.split(r"^(#{2,4}) (.*)$", "## \n" + text, flags=re.M)
    above = ""
    for level, heading, body in zip(parts[1::3], parts[2::3], parts[3::3], strict=True):
        above = body if level == "##" else above
        yield heading, body, above


@pytest.mark.parametrize("page", PAGES)
def test_a_section_with_figures_names_a_command(page):
    bare = {
        (page, heading)
        for heading, body, above in sections(PAGES[page])
        if has_figure(body) and not NAMES_ONE.search(above + body)
    }
    assert bare - set(WITHOUT) == set()


def test_what_needs_no_command_is_there():
    there = {(page, heading) for page in PAGES for heading, *_ in sections(PAGES[page])}
    assert set(WITHOUT) <= there


def test_a_paragraph_with_figures_in_the_readme_names_a_command_nearby():
    for _, body, _ in sections(PAGES["README.md"]):
        whole = re.sub(
            r"^```.*?^```", lambda m: m[0].replace("\n\n", "\n"), body, flags=re.S | re.M
        )
        blocks = re.split(r"\n\n+", whole)
        for place, block in enumerate(blocks):
            near = "\n\n".join(blocks[max(0, place - 1) : place + 2])
            assert not has_figure(block) or NAMES_ONE.search(near), block
