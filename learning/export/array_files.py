"""Exported models as plain arrays (npz) with a JSON that says what they are; no pickle."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from isotorque.learning.export.forms.chain_recursion import ChainRecursion
from isotorque.learning.export.forms.chain_with_kernels import ChainWithKernels
from isotorque.learning.export.forms.kernels import Kernels
from isotorque.learning.export.forms.local_functions import LocalFunctions
from isotorque.learning.export.forms.tanh_units import TanhUnits
from isotorque.learning.export.forms.torque_form import TorqueForm
from isotorque.learning.export.forms.waves import Waves
from isotorque.symbolic.common.errors import InputError

SCHEMA = 1
FORMAT = "isotorque export"
FORMS: dict[str, Any] = {
    f.KIND: f for f in (Waves, TanhUnits, Kernels, LocalFunctions, ChainRecursion, ChainWithKernels)
}


@dataclass(frozen=True, eq=False)
class ExportedArrays:
    """An export as read back.

    Attributes
    ----------
    form : TorqueForm
        What computes the torques: `evaluate`.
    robot, digest : str
        Name and hash (kinematics, inertias, limits, damping) of the robot it is about.
    joint_names : tuple of str
        Joints in the order of q.
    """

    form: TorqueForm
    robot: str
    digest: str
    joint_names: tuple[str, ...]


def export_bytes(
    form: TorqueForm,
    robot: str,
    digest: str,
    joint_names: Sequence[str],
    warnings: Sequence[str] = (),
) -> tuple[bytes, str]:
    """An export as the contents of its two files.

    Returns
    -------
    npz : bytes
        The tables.
    document : str
        JSON: schema version, robot and its hash, joints, units, kind, formula, shapes, and what
        is doubtful about the robot (``warnings``), if anything is.
    """
    arrays: dict[str, Any] = form.to_arrays()
    file = io.BytesIO()
    np.savez(file, **arrays)
    document = {
        "format": FORMAT,
        "schema": SCHEMA,
        "robot": robot,
        "digest": digest,
        "joints": list(joint_names),
        "units": {"q": "rad", "tau": "N m"},
        "kind": form.KIND,
        "formula": form.FORMULA,
        "arrays": {name: list(array.shape) for name, array in arrays.items()},
    } | ({"warnings": list(warnings)} if warnings else {})
    return file.getvalue(), json.dumps(document, indent=1) + "\n"


def read_export(path: str | Path) -> ExportedArrays:
    """Read an export: its npz, with the JSON beside it.

    Raises
    ------
    InputError
        If a file is missing, damaged, of a newer schema, or they do not fit each other.
    """
    file = Path(path)
    beside = file.with_suffix(".json")
    try:
        document = json.loads(beside.read_text(encoding="utf-8"))
        with np.load(io.BytesIO(file.read_bytes()), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except OSError as error:
        raise InputError(error.filename, "file", error.strerror, "an export") from error
    except (ValueError, EOFError, KeyError, zipfile.BadZipFile) as error:
        raise InputError(file, "file", f"damaged ({error})", "an export") from error
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InputError(beside, "format", "another", FORMAT)
    if document.get("schema") != SCHEMA:
        raise InputError(beside, "schema", document.get("schema"), f"{SCHEMA}")
    if document.get("kind") not in FORMS:
        raise InputError(beside, "kind", document.get("kind"), ", ".join(FORMS))
    if {name: list(array.shape) for name, array in arrays.items()} != document.get("arrays"):
        raise InputError(file, "arrays", "others", f"those that {beside.name} lists")
    try:
        form = FORMS[document["kind"]].from_arrays(arrays)
        about = (str(document["robot"]), str(document["digest"]), tuple(document["joints"]))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(beside, "content", f"damaged ({error})", "an export") from error
    return ExportedArrays(form, *about)
