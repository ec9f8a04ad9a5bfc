"""``isotorque symmetries``: the complete group of primary symmetries of a robot."""

from __future__ import annotations

import time
from typing import Annotated

import typer

from isotorque.cli.options import Json, Quiet
from isotorque.cli.output import emit_json, row
from isotorque.cli.robot_options import RobotName, about, takes_robot


@takes_robot()
def symmetries(
    robot: RobotName,
    tolerance: Annotated[
        float,
        typer.Option(
            "--tolerance",
            metavar="NM",
            help="Torque error [N m] that a relation may have; 0: exact symmetries only.",
        ),
    ] = 0.0,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Derive every map q -> A q + d under which gravity torques only change signs."""
    from symbolic.approximate_symmetries import maximal_groups
    from symbolic.gravity import GravityModel
    from symbolic.robots import load_robot
    from symbolic.symmetries import primary_symmetries
    from verify.relation_files import relations_document

    loaded = load_robot(robot)
    start = time.perf_counter()
    gravity = GravityModel(loaded)
    group = primary_symmetries(gravity.potential, tolerance)
    seconds = time.perf_counter() - start
    snapped = [
        {"joint": s.joint, "what": s.what, "before": s.before, "after": s.after, "effect": s.effect}
        for s in loaded.snaps
    ]
    document = relations_document(group, gravity.joint_names) | {
        **about(loaded),
        "tolerance": tolerance,
        **({"complete": True} if tolerance == 0 else {}),
        "snapped": snapped,
        "snap_bound": loaded.snap_bound,
        "free_joints": gravity.free_joints,
        "seconds": seconds,
    }
    if tolerance > 0:
        others = maximal_groups(gravity.potential, tolerance)
        document["maximal_orders"] = [g.order for g in others]
    if json:
        emit_json(document)
        return
    print(
        f"{loaded.name}: {group.order} primary symmetries, rank {group.rank} of {loaded.n} joints"
    )
    for snap in loaded.snaps:
        print(f"  snapped: {snap.joint}: {snap.what} {snap.before} -> {snap.after}")
    for direction in group.free_directions:
        print(f"  free direction: {row(direction)}")
    for relation in group:
        known = "proved" if relation.exact else f"error at most {relation.bound.max():.3g} N m"
        print(f"  {relation}  [{known}]")
    if tolerance > 0 and len(document["maximal_orders"]) > 1:
        print(f"  orders of all maximal groups: {document['maximal_orders']}")
