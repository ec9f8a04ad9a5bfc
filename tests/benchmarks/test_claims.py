"""The protocol of claims and names, as a command, and a twentieth of it."""

import sys

import pytest

from benchmarks.claims import __main__ as claims
from benchmarks.claims.demands import demands
from tests.benchmarks.claims.test_demands import GOOD
from tests.benchmarks.claims.test_demands import claims as with_claims


def run(monkeypatch, *options):
    monkeypatch.setattr(sys, "argv", ["claims", *map(str, options)])
    return claims.main()


@pytest.fixture
def given(monkeypatch):
    """Outcomes that the command is given instead of its own."""

    def set_to(found):
        monkeypatch.setattr(claims, "measured", lambda *_, **__: found)

    return set_to


def test_the_command_measures_prints_and_writes(tmp_path, monkeypatch, capsys):
    page, cache = tmp_path / "claims.md", tmp_path / "claims.jsonl"
    page.write_text(f"before\n<!-- {claims.NAME} -->\n<!-- end of {claims.NAME} -->\nafter\n")
    options = ("--robots", "2r", "--kinds", "clean", "offset", "--share", 0.01, "--jobs", 1)
    status = run(monkeypatch, *options, "--cache", cache, "--write", page)
    printed = capsys.readouterr().out
    assert status in (0, 1)
    assert printed.strip() in page.read_text()
    assert "| clean | 0 / 4 / 4 |" in printed
    assert (
        "`python -m benchmarks.claims --robots 2r --kinds clean offset --share 0.01 --seed 0`"
        in (printed)
    )
    assert page.read_text().startswith("before")
    assert page.read_text().endswith("after\n")
    assert run(monkeypatch, *options, "--cache", cache) == status
    assert capsys.readouterr().out == printed  # times and all: nothing was made anew


def test_the_status_says_whether_all_demands_hold(tmp_path, monkeypatch, capsys, given):
    given(GOOD)
    assert run(monkeypatch) == 0
    assert "do not" not in capsys.readouterr().out
    given([with_claims(o, wrong=1) for o in GOOD])
    assert run(monkeypatch) == 1
    assert "These do not" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--robots", "no-such-arm"), "no-such-arm"),
        (("--kinds", "spring", "no-such-kind"), "no-such-kind"),
        (("--share", "0"), "share is 0"),
        (("--share", "1.5"), "share is 1.5"),
        (("--jobs", "0", "--share", "0.01", "--cache", "/nowhere/claims.jsonl"), "jobs is 0"),
        (("--write", "no-such-page.md"), "no-such-page.md"),
    ],
)
def test_bad_input_is_refused_in_one_line(options, said, monkeypatch, capsys):
    assert run(monkeypatch, *options) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert error.count("\n") == 1
    assert said in error


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["2r", "3r"])
def test_a_twentieth_holds_what_is_demanded(robot):
    found = claims.measured([robot], share=0.05, seed=1, jobs=1)
    assert [demand for demand in demands(found) if not demand.holds] == []
