"""``isotorque robots``: the built-in robots."""

from __future__ import annotations

from isotorque.cli.options import Json, Quiet
from isotorque.cli.output import emit_json


def robots(json: Json = False, quiet: Quiet = False) -> None:
    """List the built-in robots."""
    from isotorque.symbolic.robots.builtin_robots import builtin_robots

    known = builtin_robots()
    if json:
        emit_json(
            [{"name": r.name, "joints": r.joints, "description": r.description} for r in known]
        )
        return
    for robot in known:
        print(f"{robot.name:10s} {robot.joints} joints  {robot.description}")
