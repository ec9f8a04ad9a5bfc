"""CONTRIBUTING.md names files, commands and rules that exist."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "CONTRIBUTING.md").read_text()
CODE = re.findall(r"`([^`\n]+)`", TEXT) + re.findall(r"^    (.+)$", TEXT, re.MULTILINE)
WORDS = [word for code in CODE for word in code.partition("#")[0].split()]
MADE = (".venv", "dist")
"""What commands make, and a checkout lacks."""


def places():
    """Paths in this repository that are named as code."""
    return sorted(
        {
            w
            for w in WORDS
            if ("/" in w or w.endswith((".md", ".toml", ".txt"))) and not w.startswith(MADE)
        }
    )


@pytest.mark.parametrize("place", places())
def test_a_place_exists(place):
    assert (ROOT / place).exists()


def test_a_target_exists():
    makefile = (ROOT / "Makefile").read_text()
    named = {
        t for code in CODE if code.startswith("make ") for t in code.partition("#")[0].split()[1:]
    }
    assert named >= {"lint", "test", "test-oldest", "dist"}
    assert [t for t in named if not re.search(rf"^{t}: ", makefile, re.MULTILINE)] == []


def test_ci_runs_every_check_cheap_ones_first():
    steps = re.findall(r"^make (\S+)$", (ROOT / ".ci" / "run").read_text(), re.MULTILINE)
    assert steps == ["lint", "test", "test-oldest", "test-slow"]


def test_hooks_fetch_nothing_and_look_at_changed_files():
    text = (ROOT / ".pre-commit-config.yaml").read_text()
    assert re.findall(r"repo: (\S+)", text) == ["local"]
    assert set(re.findall(r"language: (\S+)", text)) == {"system"}
    for hook in text.split("- id: ")[1:]:
        assert "files: " in hook or "types_or: " in hook
