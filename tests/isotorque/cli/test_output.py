"""What commands say beside their results."""

import sys

import pytest

from isotorque.cli.output import say_if_first
from isotorque.symbolic.common import compiled


@pytest.mark.parametrize("quiet", [False, True])
def test_who_waits_for_the_first_use_is_told_why(quiet, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(compiled, "cache_folder", lambda beside: tmp_path)
    say_if_first(quiet)
    assert capsys.readouterr().err == ""  # no terminal: nobody waits
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    say_if_first(quiet)
    assert ("first use" in capsys.readouterr().err) is not quiet
    (tmp_path / "function.nbi").touch()
    say_if_first(quiet)
    assert capsys.readouterr().err == ""
