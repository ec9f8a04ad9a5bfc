"""Run the command line with ``python -m isotorque``."""

from isotorque.cli.main import run

run()
