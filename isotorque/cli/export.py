"""``isotorque export``: a learned or analytic model for a controller."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from isotorque.cli.options import Json, Quiet
from isotorque.cli.output import emit_json, say
from isotorque.cli.robot_options import about, load, named, takes_robot
from isotorque.symbolic.common.robot_options import RobotOptions

if TYPE_CHECKING:
    from isotorque.learning.export.forms.torque_form import TorqueForm


@takes_robot("model")
def export(
    model: Annotated[
        RobotOptions,
        typer.Argument(
            parser=named,
            metavar="MODEL",
            help="A model.json, the directory of a run, or a robot (its analytic gravity).",
            show_default=False,
        ),
    ],
    c: Annotated[
        Path | None, typer.Option("--c", metavar="FILE", help="Write C source.", show_default=False)
    ] = None,
    casadi: Annotated[
        Path | None,
        typer.Option(
            "--casadi", metavar="FILE", help="Save a CasADi function.", show_default=False
        ),
    ] = None,
    npz: Annotated[
        Path | None,
        typer.Option(
            "--npz",
            metavar="FILE.npz",
            help="Write plain arrays, and FILE.json beside them that says what they are.",
            show_default=False,
        ),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write a torque map as C source, as a CasADi function, as arrays; checked each time."""
    from isotorque.symbolic.common.errors import InputError
    from isotorque.symbolic.common.files import write_whole

    if c is casadi is npz is None:
        raise InputError("command line", "output", "none", "--c, --casadi or --npz with a file")
    described = None
    if npz is not None:
        if npz.suffix != ".npz":
            raise InputError("command line", "--npz", npz, "a file that ends in .npz")
        described = npz.with_suffix(".json")
        _keep_others(described)
    saved = Path(model.spec)
    if saved.is_dir() or saved.suffix == ".json":
        if model.changed:
            found = " ".join(model.arguments())
            accepted = "none of these: a learned model keeps its robot"
            raise InputError("command line", f"options beside {saved}", found, accepted)
        exported = _learned(saved)
    else:
        exported = _analytic(model, quiet)
    written: dict[str, Path] = {}
    if c is not None:
        write_whole(c, exported.c_source())
        written["c"] = c
    if casadi is not None:
        write_whole(casadi, exported.casadi_function().serialize())
        written["casadi"] = casadi
    if npz is not None and described is not None:
        from isotorque.learning.export.array_files import export_bytes

        arrays, document = export_bytes(
            exported.form,
            exported.robot,
            exported.digest,
            exported.joints,
            exported.about.get("warnings", ()),
        )
        write_whole(npz, arrays)
        write_whole(described, document)
        written |= {"npz": npz, "json": described}
    if json:
        emit_json(
            {
                "model": model.spec,
                **exported.about,
                "joints": exported.joints,
                "kind": exported.form.KIND,
                **{kind: str(path) for kind, path in written.items()},
                "max_error": exported.error,
            }
        )
        return
    for path in written.values():
        say(f"written: {path}", quiet)
    say(f"largest difference from the model: {exported.error:.3g} N m", quiet)


@dataclass(frozen=True, eq=False)
class _Export:
    """Exported text, and its largest difference from the model on random configurations [N m]."""

    form: TorqueForm
    robot: str
    digest: str
    joints: tuple[str, ...]
    error: float
    about: dict[str, Any]
    gravity: Any = None
    comment: tuple[str, ...] = ()

    def c_source(self) -> str:
        if self.gravity is not None:
            from isotorque.symbolic.gravity.c_source import gravity_c

            return gravity_c(self.gravity)
        from isotorque.learning.export.c_export import c_source

        return c_source(self.form, self.comment, self.joints)

    def casadi_function(self) -> Any:
        if self.gravity is not None:
            from isotorque.symbolic.gravity.casadi_function import gravity_casadi

            return gravity_casadi(self.gravity)
        from isotorque.learning.export.casadi_export import casadi_function

        return casadi_function(self.form)


def _learned(path: Path) -> _Export:
    from isotorque.learning.export.forms.torque_form import largest_difference
    from isotorque.learning.export.from_learner import torque_form
    from isotorque.learning.files.saved_models import load_model

    saved = load_model(path)
    form = torque_form(saved.learner)
    comment = (
        f"Inverse statics of {saved.robot}, learned and written by Isotorque.",
        f"Learner {type(saved.learner).__name__}; robot {saved.digest}.",
    )
    return _Export(
        form,
        saved.robot,
        saved.digest,
        saved.joint_names,
        largest_difference(form, saved.learner.predict),
        {"robot": saved.robot, "robot_options": saved.notes.get("robot_options", {})},
        comment=comment,
    )


def _analytic(options: RobotOptions, quiet: bool) -> _Export:
    from isotorque.learning.export.forms.torque_form import largest_difference
    from isotorque.learning.export.forms.waves import Waves
    from isotorque.symbolic.gravity.gravity_model import GravityModel

    robot = load(options, quiet)
    gravity = GravityModel(robot)
    potential = gravity.significant_potential.to_float()
    form = Waves.of_potential(potential.frequencies, potential.cos, potential.sin)
    error = largest_difference(form, gravity.torque)
    return _Export(form, robot.name, robot.digest, robot.joint_names, error, about(robot), gravity)


def _keep_others(path: Path) -> None:
    """Refuse to replace a JSON file that is no export, such as the model itself."""
    from isotorque.learning.export.array_files import FORMAT
    from isotorque.symbolic.common.errors import InputError

    if path.exists() and FORMAT not in path.read_text(encoding="utf-8", errors="replace")[:200]:
        raise InputError(path, "file", "there already, and no export", "another name for --npz")
