"""Outcomes are kept line by line, and made anew where the code has changed."""

import json
from dataclasses import asdict, replace

from benchmarks.claims import outcomes as module
from benchmarks.claims.claims import Claims
from benchmarks.claims.data_sets import Setting
from benchmarks.claims.naming import Naming
from benchmarks.claims.outcomes import Outcome, outcomes

SETTINGS = [Setting("2r", "clean", 20, 0.05, index, 0) for index in range(3)]


def made(setting):
    naming = Naming(((("offset", 1), ("friction", None)),), (("offset", 1),), (), 0.1)
    return Outcome(setting, 1, 0.5, 8.0, Claims(8, 7, 0, 0, 0.5, 8, 8, 0.2), naming)


def test_plain_numbers_say_everything():
    outcome = made(SETTINGS[0])
    assert Outcome.of(json.loads(json.dumps(asdict(outcome)))) == outcome


def test_what_is_kept_is_not_made_again(tmp_path, monkeypatch):
    cache, asked = tmp_path / "new" / "claims.jsonl", []
    monkeypatch.setattr(module, "judged", lambda s: asked.append(s) or made(s))
    first = list(outcomes(SETTINGS[:2], cache, 1))
    with cache.open("a") as file:
        file.write('{"code": "cut o')  # killed while it wrote
    again = list(outcomes(SETTINGS, cache, 1))
    assert again[:2] == first
    assert asked == SETTINGS
    assert [outcome.setting for outcome in again] == SETTINGS


def test_what_other_code_made_is_made_again(tmp_path, monkeypatch):
    cache, asked = tmp_path / "claims.jsonl", []
    monkeypatch.setattr(module, "judged", lambda s: asked.append(s) or made(s))
    list(outcomes(SETTINGS, cache, 1))
    monkeypatch.setattr(module, "code_mark", lambda: "another")
    list(outcomes(SETTINGS, cache, 1))
    assert len(asked) == 2 * len(SETTINGS)


def test_nothing_is_kept_without_a_file(monkeypatch):
    monkeypatch.setattr(module, "judged", made)
    assert list(outcomes(SETTINGS, None, 1)) == [made(s) for s in SETTINGS]


def test_the_mark_is_that_of_the_code(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "ROOT", tmp_path)
    marks = [module.code_mark()]
    for text in ("a = 1", "a = 2"):
        (tmp_path / "learning" / "deep").mkdir(parents=True, exist_ok=True)
        (tmp_path / "learning" / "deep" / "file.py").write_text(text)
        marks.append(module.code_mark())
    assert len(set(marks)) == 3


def test_an_outcome_says_what_was_drawn():
    outcome = module.judged(replace(SETTINGS[0], pool="sign"))
    assert outcome.size == -2.0
    assert outcome.joint in (0, 1)
    assert outcome.deviations > 100.0
