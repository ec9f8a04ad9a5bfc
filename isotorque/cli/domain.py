"""``isotorque domain``: the part of the configuration space that needs to be explored (BCTS)."""

from __future__ import annotations

from typing import Annotated

import typer

from isotorque.cli.options import Json, Quiet, numbers
from isotorque.cli.output import emit_json, row
from isotorque.cli.robot_options import RobotName, about, load, takes_robot


@takes_robot()
def domain(
    robot: RobotName,
    center: Annotated[
        str | None,
        typer.Option(
            "--center",
            metavar="Q1,Q2,..",
            help="Configuration [rad] that the domain lies around.",
            show_default="chosen",
        ),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Describe a fundamental domain: exactly one configuration of each symmetric set."""
    from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
    from isotorque.symbolic.gravity.gravity_model import GravityModel
    from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

    loaded = load(robot, quiet)
    at = None if center is None else numbers(center, "--center", loaded.n)
    group = primary_symmetries(GravityModel(loaded).potential)
    bcts = FundamentalDomain(group, at)
    if json:
        emit_json(
            {
                **about(loaded),
                "basis": group.basis,
                "center": bcts.center,
                "halfspaces": bcts.halfspaces,
                "vertices": bcts.vertices,
                "volume": bcts.volume,
                "order": group.order,
            }
        )
        return
    print(
        f"{loaded.name}: one of {group.order} equal parts, "
        f"volume {bcts.volume:.6g} rad^{group.rank}"
    )
    print(f"  y = B q with B = {group.basis.tolist()}")
    for *a, b in bcts.halfspaces:
        print(f"  {row(a)} . y <= {b:.6g}")
    for vertex in bcts.vertices:
        print(f"  vertex y = {row(vertex)}")
