"""``isotorque symmetries``: the complete group of primary symmetries of a robot."""

from __future__ import annotations

import time
from typing import Annotated

import typer

from isotorque.cli.options import Json, Quiet
from isotorque.cli.output import emit_json, row
from isotorque.cli.robot_options import RobotName, about, load, takes_robot

LISTED = 64
"""Groups of at most this order are listed without being asked."""


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
    all_: Annotated[
        bool,
        typer.Option(
            "--all",
            help="List every relation, of groups of up to 4096; else generators beyond 64.",
        ),
    ] = False,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Derive every map q -> A q + d under which gravity torques only change signs."""
    from isotorque.symbolic.gravity.gravity_model import GravityModel
    from isotorque.symbolic.groups.symmetry_group import factor_structure, group_structure
    from isotorque.symbolic.symmetries.approximate_symmetries import maximal_groups
    from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
    from isotorque.verify.relations.relation_files import relations_document

    loaded = load(robot, quiet)
    start = time.perf_counter()
    gravity = GravityModel(loaded)
    maximal = maximal_groups(gravity.potential, tolerance) if tolerance > 0 else []
    group = maximal[0] if maximal else primary_symmetries(gravity.potential, tolerance)
    generators = group.order > LISTED and not all_
    document = relations_document(group, gravity.joint_names, generators=generators)
    seconds = time.perf_counter() - start
    snapped = [
        {"joint": s.joint, "what": s.what, "before": s.before, "after": s.after, "effect": s.effect}
        for s in loaded.snaps
    ]
    document |= {
        **about(loaded),
        "tolerance": tolerance,
        **({"complete": True} if tolerance == 0 else {}),
        "snapped": snapped,
        "snap_bound": loaded.snap_bound,
        "free_joints": gravity.free_joints,
        "neglected_terms": len(gravity.neglected),
        "neglected_bound": gravity.neglected_bound.tolist(),
        "seconds": seconds,
    }
    if tolerance > 0:
        document["maximal_orders"] = [g.order for g in maximal]
    if json:
        emit_json(document)
        return
    print(
        f"{loaded.name}: {group.order} primary symmetries, rank {group.rank} of {loaded.n} joints"
    )
    for snap in loaded.snaps:
        print(f"  snapped: {snap.joint}: {snap.what} {snap.before} -> {snap.after}")
    if len(gravity.neglected):
        print(
            f"  complete for the potential without {len(gravity.neglected)} terms, which make at "
            f"most {gravity.neglected_bound.max():.3g} N m"
        )
    for direction in group.free_directions:
        print(f"  free direction: {row(direction)}")
    if group.order > LISTED:
        print(f"  structure: {group_structure(group)}")
        for factor in group.direct_factors:
            if factor.order > 1:
                names = ", ".join(gravity.joint_names[j] for j in factor.joints)
                print(f"    {factor_structure(factor)}: {names}")
    if generators:
        print(f"  {len(group.generators)} generators; q' = q and Y = +1 where nothing is said:")
    for relation in group.generators if generators else group:
        known = "proved" if relation.exact else f"error at most {relation.bound.max():.3g} N m"
        print(f"  {relation.in_short() if generators else relation}  [{known}]")
    if tolerance > 0 and len(document["maximal_orders"]) > 1:
        print(f"  orders of all maximal groups: {document['maximal_orders']}")
