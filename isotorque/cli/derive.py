"""``isotorque derive``: the gravity torque of a robot, exactly."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from isotorque.cli.options import Json, Quiet
from isotorque.cli.output import emit_json, say
from isotorque.cli.robot_options import RobotName, about, load, takes_robot


@takes_robot()
def derive(
    robot: RobotName,
    latex: Annotated[bool, typer.Option("--latex", help="Print LaTeX.")] = False,
    sympy: Annotated[bool, typer.Option("--sympy", help="Print a SymPy expression.")] = False,
    c: Annotated[
        Path | None, typer.Option("--c", metavar="FILE", help="Write C source.", show_default=False)
    ] = None,
    casadi: Annotated[
        Path | None,
        typer.Option(
            "--casadi", metavar="FILE", help="Save a CasADi function.", show_default=False
        ),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Derive the gravity torque, checked against Pinocchio every time."""
    from isotorque.symbolic.common.files import write_whole
    from isotorque.symbolic.gravity.c_source import gravity_c
    from isotorque.symbolic.gravity.gravity_model import GravityModel
    from isotorque.symbolic.gravity.readable import gravity_latex, gravity_sympy, gravity_text

    loaded = load(robot, quiet)
    start = time.perf_counter()
    gravity = GravityModel(loaded)
    seconds = time.perf_counter() - start
    if c is not None:
        write_whole(c, gravity_c(gravity))
        say(f"C source: {c}", quiet=quiet or json)
    if casadi is not None:
        from isotorque.symbolic.gravity.casadi_function import gravity_casadi

        write_whole(casadi, gravity_casadi(gravity).serialize())
        say(
            f"CasADi function (read it with casadi.Function.deserialize): {casadi}",
            quiet=quiet or json,
        )
    if json:
        potential = gravity.significant_potential.to_float()
        emit_json(
            {
                **about(loaded),
                "joints": gravity.joint_names,
                "free_joints": gravity.free_joints,
                "potential": [
                    {"k": k, "cos": a, "sin": b}
                    for k, a, b in zip(
                        potential.frequencies.tolist(), potential.cos, potential.sin, strict=True
                    )
                ],
                "snap_bound": loaded.snap_bound,
                "snapped": [
                    {"joint": snap.joint, "what": snap.what, "effect": snap.effect}
                    for snap in loaded.snaps
                ],
                "max_error_vs_pinocchio": gravity.max_error_vs_pinocchio,
                "seconds": seconds,
            }
        )
    elif latex:
        print(gravity_latex(gravity))
    elif sympy:
        for warning in gravity.warnings:
            print(f"# warning: {warning}")
        print(gravity_sympy(gravity))
    else:
        print(gravity_text(gravity))
        say(f"largest difference from Pinocchio: {gravity.max_error_vs_pinocchio:.3g} N m", quiet)
        # Pinocchio reads the file as it is written: what was snapped in it is the difference
        for snap in sorted(loaded.snaps, key=lambda snap: -snap.effect.max()):
            effect = f"changes torques by at most {snap.effect.max():.3g} N m"
            say(f"  snapped: {snap.joint}: {snap.what}, {effect}", quiet)
