"""Options that messages name exist on every command that can print the message.

All strings of functions that a command can reach are read: functions and classes are followed by
name through the imports of their modules, a class with all its methods.
"""

import ast
import re
from functools import cache
from pathlib import Path

import pytest
import typer

from isotorque.cli.main import app, status

ROOT = Path(__file__).parents[4]
PACKAGES = ("isotorque", "learning", "symbolic", "verify")
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*")
COMMANDS = typer.main.get_command(app).commands
PART_OF_A_ROBOT = {"--lock", "--joints", "--tip", "--gravity", "--payload", "--allow-massless"}
PART_OF_A_ROBOT.add("--no-snap")
NEVER_PRINTED = {
    "paper": PART_OF_A_ROBOT,  # built-in robots alone, which are never refused
    # fields of the table have these names; it always learns, and prints no remarks
    "sweep": PART_OF_A_ROBOT | {"--learn-anyway"},
}


@cache
def module_file(name):
    path = ROOT.joinpath(*name.split("."))
    for file in (path.with_suffix(".py"), path / "__init__.py"):
        if file.is_file():
            return file
    return None


@cache
def definitions(module):
    """Functions, classes and other names at the top of a module, and the names it imports."""
    tree = ast.parse(module_file(module).read_text(encoding="utf-8"))
    defined = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            defined[node.name] = node
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        for target in targets:
            if isinstance(target, ast.Name):
                defined[target.id] = node
    return defined, imports(tree.body)


def imports(nodes):
    """Where the names that statements import come from."""
    found = {}
    for node in nodes:
        if isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            for alias in node.names:
                found[alias.asname or alias.name] = (node.module, alias.name)
    return found


def followed(module, name):
    """Module and name where a name is defined, through imports; None outside the packages."""
    for _ in range(10):
        if module.split(".")[0] not in PACKAGES or module_file(module) is None:
            return None
        defined, imported = definitions(module)
        if name in defined:
            return module, name
        if name not in imported:
            return None
        module, name = imported[name]
    return None


@cache
def neighbours(here):
    """What the function or class (module, name) names itself."""
    node = definitions(here[0])[0][here[1]]
    local = imports(ast.walk(node))
    found = set()
    for part in ast.walk(node):
        if isinstance(part, ast.Name):
            found.add(followed(*local.get(part.id, (here[0], part.id))))
        elif isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name):
            source = local.get(part.value.id) or definitions(here[0])[1].get(part.value.id)
            if source is not None:  # a module: from package import module
                found.add(followed(".".join(source), part.attr))
    return found - {None}


def reached(module, name):
    """All (module, name) that a function or class can reach."""
    seen, waiting = set(), [followed(module, name)]
    while waiting:
        here = waiting.pop()
        if here not in seen:
            seen.add(here)
            waiting += neighbours(here)
    return seen


@cache
def strings(module, name):
    """Strings of a definition that may be advice.

    Neither documentation nor the field that an error is about: that is what the user gave.
    """
    node = definitions(module)[0][name]
    documentation = {
        id(part.body[0].value)
        for part in ast.walk(node)
        if isinstance(part, ast.FunctionDef | ast.ClassDef) and isinstance(part.body[0], ast.Expr)
    }
    fields = {
        id(constant)
        for part in ast.walk(node)
        if isinstance(part, ast.Call) and getattr(part.func, "id", "") == "InputError"
        for constant in ast.walk(part.args[1])
    }
    return [
        part.value
        for part in ast.walk(node)
        if isinstance(part, ast.Constant)
        and isinstance(part.value, str)
        and id(part) not in documentation | fields
    ]


def options_named(command):
    """Options that stand in the strings a command can reach, with where."""
    function = COMMANDS[command].callback
    for module, name in sorted(reached(function.__module__, function.__name__)):
        if module.startswith("isotorque.cli.") and name[0].isupper():
            continue  # declarations of options
        for text in strings(module, name):
            for option in OPTION.findall(text):
                yield option, f"{module}.{name}: {text!r}"


@pytest.mark.parametrize("command", sorted(COMMANDS))
def test_every_option_that_a_message_names_exists_on_the_command(command):
    known = {o for parameter in COMMANDS[command].params for o in parameter.opts} | {"--help"}
    known |= NEVER_PRINTED.get(command, set())
    unknown = {where for option, where in options_named(command) if option not in known}
    assert not unknown


def test_the_messages_are_found():
    assert "--npz" in {option for option, _ in options_named("export")}
    assert "--learn-anyway" in {option for option, _ in options_named("run")}
    names = reached("isotorque.cli.run", "run")
    assert ("isotorque.learning.simulator.assembly", "_home") in names
    assert ("isotorque.symbolic.robots.load_robot", "load_robot") in names


def test_an_option_that_does_not_exist_would_be_found(monkeypatch):
    without = [p for p in COMMANDS["export"].params if "--npz" not in p.opts]
    monkeypatch.setattr(COMMANDS["export"], "params", without)
    with pytest.raises(AssertionError, match="--npz"):
        test_every_option_that_a_message_names_exists_on_the_command("export")


def test_the_options_of_learn_that_run_must_have():
    named = {o for p in COMMANDS["run"].params for o in p.opts}
    assert {"--strategy", "--physics"} <= named
    assert status(["run", "2r", "--out", "x", "--strategy", "walking"]) == 2
