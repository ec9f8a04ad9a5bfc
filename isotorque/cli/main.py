"""The entry point: commands, exit status, one line per error."""

from __future__ import annotations

import sys
from typing import NoReturn

import typer

from isotorque.cli import (
    derive,
    discover,
    domain,
    export,
    learn,
    paper,
    plan,
    relations,
    robots,
    simulate,
    sweep,
    symmetries,
    verify,
)
from isotorque.cli import run as run_command
from isotorque.cli.help_text import LiteralHelp
from isotorque.cli.streams import patient_streams
from isotorque.symbolic.common.errors import InputError, visible

# typer may bring click along under a private name: take the class from typer's public one
_ClickException: type[Exception] = next(
    kind for kind in typer.BadParameter.__mro__ if kind.__name__ == "ClickException"
)

INTERRUPTED = 130
"""Exit status of a command that was interrupted."""

app = typer.Typer(
    name="isotorque",
    help="The statics of robot arms and their symmetries: derived, learned, verified.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for name, command in (
    ("robots", robots.robots),
    ("derive", derive.derive),
    ("symmetries", symmetries.symmetries),
    ("domain", domain.domain),
    ("simulate", simulate.simulate),
    ("discover", discover.discover),
    ("relations", relations.relations),
    ("learn", learn.learn),
    ("plan", plan.plan),
    ("verify", verify.verify),
    ("run", run_command.run),
    ("paper", paper.paper),
    ("sweep", sweep.sweep),
    ("export", export.export),
):
    app.command(name, cls=LiteralHelp)(command)


def run(arguments: list[str] | None = None) -> NoReturn:
    """Run one command and leave with its exit status.

    0 done and, where something was judged, passed; 1 judged and failed; 2 bad input or usage, said
    in one line; 130 interrupted, with everything recorded so far kept.
    """
    sys.exit(status(sys.argv[1:] if arguments is None else arguments))


def status(arguments: list[str]) -> int:
    """Run one command and return its exit status."""
    with patient_streams():
        return _status(arguments)


def _status(arguments: list[str]) -> int:
    try:
        code = app(args=arguments, prog_name="isotorque", standalone_mode=False)
        sys.stdout.flush()
    except _ClickException as error:
        message = error.format_message()  # type: ignore[attr-defined]
        if type(error).__name__ == "NoArgsIsHelpError":
            print(message)
            return 2
        return _refuse(" ".join(message.split()))
    except InputError as error:
        return _refuse(str(error))
    except typer.Exit as error:
        return error.exit_code
    except (KeyboardInterrupt, typer.Abort):
        return _interrupted()
    except SystemError as error:
        # Ctrl-C while compiled code is at work: Python finds the interrupt set when it returns
        if isinstance(error.__cause__, KeyboardInterrupt):
            return _interrupted()
        raise
    except OSError as error:
        return _refuse(f"{error.filename or 'operating system'}: {error.strerror or error}")
    if code == INTERRUPTED:  # what typer makes of Ctrl-C
        return _interrupted()
    return code if isinstance(code, int) else 0


def _interrupted() -> int:
    print("interrupted: everything recorded so far is kept", file=sys.stderr)
    return INTERRUPTED


def _refuse(message: str) -> int:
    print(f"error: {visible(message)}", file=sys.stderr)
    return 2
