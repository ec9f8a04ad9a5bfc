"""Entry point of ``python -m isotorque``: the command line."""

from isotorque.cli.main import run

run()
