"""What is written in help texts is shown: rich does not take units for markup."""

import inspect
import re

import pytest
import typer

from isotorque.cli.main import app, status

COMMANDS = typer.main.get_command(app).commands


def written(command):
    yield inspect.cleandoc(command.help or "")
    for parameter in command.params:
        yield parameter.help or ""


def shown(capsys, monkeypatch, *arguments):
    monkeypatch.setenv("COLUMNS", "300")
    monkeypatch.setenv("TERMINAL_WIDTH", "300")
    assert status([*arguments, "--help"]) == 0
    return " ".join(re.sub(r"[│╭╮╰╯─]", " ", capsys.readouterr().out).split())


def test_units_are_written_somewhere():
    texts = [text for command in COMMANDS.values() for text in written(command)]
    assert sum("[rad]" in text for text in texts) >= 2


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_every_word_of_a_help_text_is_shown(name, capsys, monkeypatch):
    page = shown(capsys, monkeypatch, name)
    for text in written(COMMANDS[name]):
        assert " ".join(text.split()) in page


def test_the_list_of_commands_is_shown_in_full(capsys, monkeypatch):
    page = shown(capsys, monkeypatch)
    for command in COMMANDS.values():
        assert " ".join(command.help.split("\n\n")[0].split()) in page
