"""Ctrl-C is one line and status 130, wherever it finds the command."""

import pytest

from isotorque.cli import main
from isotorque.cli.main import status


def in_compiled_code():
    """What Python makes of an interrupt that compiled code returns with."""
    raise SystemError("returned a result with an exception set") from KeyboardInterrupt()


def in_python():
    raise KeyboardInterrupt


@pytest.mark.parametrize("interrupt", [in_python, in_compiled_code])
def test_interrupts(monkeypatch, capsys, interrupt):
    monkeypatch.setattr(main, "app", lambda **_: interrupt())
    assert status(["robots"]) == 130
    assert capsys.readouterr().err == "interrupted: everything recorded so far is kept\n"


def test_other_system_errors_are_not_hidden(monkeypatch):
    def fail(**_):
        raise SystemError("something else")

    monkeypatch.setattr(main, "app", fail)
    with pytest.raises(SystemError, match="something else"):
        status(["robots"])
