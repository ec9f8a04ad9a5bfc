"""Saved models: one npz with the arrays, one JSON with everything else, no pickle."""

from __future__ import annotations

import hashlib
import io
import json
import os
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from isotorque.learning.files.software_versions import software_versions
from isotorque.learning.learners.registry import SAVED_LEARNERS, learner_class
from isotorque.symbolic.common.errors import InputError

SCHEMA = 1
PARTS = ("settings", "state")
"""What parameters consist of."""
_DAMAGE = (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error)
# what zipfile and NumPy's header parser raise on flipped bits
_NUMPY_DAMAGE = (NotImplementedError, RuntimeError, KeyError, SyntaxError, TypeError)
# what settings and arrays of wrong types, shapes and sizes make of a learner
_WRONG = (KeyError, TypeError, ValueError, IndexError, AttributeError, ArithmeticError, MemoryError)


@dataclass(frozen=True, eq=False)
class SavedModel:
    """A learned inverse statics model and what it is about.

    Attributes
    ----------
    learner
        Something with ``predict(q)``: configurations (m, n) [rad] to torques (m, n) [N m]; the
        online learners go on learning with ``partial_fit``.
    robot, digest : str
        Name and identity of the robot it was learned on.
    joint_names : tuple of str
        Joints in the order of q.
    notes : dict
        What the saver added: plain data.
    """

    learner: Any
    robot: str
    digest: str
    joint_names: tuple[str, ...]
    notes: dict[str, Any]


def save_model(model: SavedModel, folder: str | Path) -> Path:
    """Write ``model.npz`` and ``model.json`` into a directory, each whole or not at all.

    Returns
    -------
    Path
        Of ``model.json``.

    Raises
    ------
    InputError
        If the learner is of a kind that cannot be saved, or a file cannot be written.

    Notes
    -----
    Equal models give equal files, bit for bit, under equal versions of the software: there is no
    date in them. The JSON holds the digest of its arrays, so that files of two models are not
    taken for one.
    """
    kind = type(model.learner).__name__
    if kind not in SAVED_LEARNERS:
        raise InputError("model", "learner", kind, f"one of {', '.join(SAVED_LEARNERS)}")
    directory = Path(folder)
    archive = io.BytesIO()
    np.savez(archive, **model.learner.to_arrays())
    arrays = archive.getvalue()
    document = {
        "schema": SCHEMA,
        "kind": kind,
        "robot": model.robot,
        "digest": model.digest,
        "joints": list(model.joint_names),
        "parameters": model.learner.parameters(),
        "arrays": hashlib.sha256(arrays).hexdigest(),
        "notes": model.notes,
        "versions": software_versions(),
    }
    text = json.dumps(document, indent=1, allow_nan=False) + "\n"
    # the arrays first: a JSON without its arrays would be a broken promise
    _replace(directory / "model.npz", arrays)
    _replace(directory / "model.json", text.encode())
    return directory / "model.json"


def load_model(path: str | Path, robot: Any = None) -> SavedModel:
    """Read a saved model: its ``model.json``, or the directory that holds it.

    Parameters
    ----------
    path
        The file or directory.
    robot : Robot, optional
        The arm, for a ``parametric`` model, which keeps but its name or file; by default it is
        loaded again from there.

    Returns
    -------
    SavedModel
        Its learner predicts bit for bit what the saved one did.

    Raises
    ------
    InputError
        If a file is missing, damaged, of a newer version, or does not fit the other.
    """
    file = Path(path)
    if file.is_dir():
        file = file / "model.json"
    document = _document(file)
    arrays = _arrays(file.with_suffix(".npz"), document.get("arrays"))
    kind = learner_class(document["kind"])
    try:
        parameters = document["parameters"]
        if robot is not None and "robot" in parameters["settings"]:
            settings = {**parameters["settings"], "robot": robot}
            parameters = {**parameters, "settings": settings}
        model = SavedModel(
            kind.from_arrays(arrays, parameters),
            str(document["robot"]),
            str(document["digest"]),
            tuple(document["joints"]),
            dict(document["notes"]),
        )
        _try(model)
    except _WRONG as error:
        raise InputError(
            file, "content", f"damaged ({error})", "a model as it was saved"
        ) from error
    return model


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


_FIELDS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "robot": (_is_text, "a name"),
    "digest": (_is_text, "the fingerprint of the robot"),
    "joints": (
        lambda v: isinstance(v, list) and len(v) > 0 and all(map(_is_text, v)),
        "a list of names",
    ),
    "parameters": (
        lambda v: (
            isinstance(v, dict) and all(isinstance(v.get(k), dict) for k in ("settings", "state"))
        ),
        "an object with the objects settings and state",
    ),
    "arrays": (lambda v: v is None or _is_text(v), "the digest of the arrays"),
    "notes": (lambda v: isinstance(v, dict), "an object"),
}
"""What must stand in a saved model of any kind, beside schema and kind."""


def _document(file: Path) -> dict[str, Any]:
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(file, "file", error.strerror, "a saved model") from error
    except (ValueError, RecursionError) as error:
        raise InputError(file, "file", "not JSON", "a saved model") from error
    if not isinstance(document, dict) or not {"schema", "kind", "parameters"} <= set(document):
        raise InputError(file, "content", "no saved model", "the model.json of a run")
    if document["schema"] != SCHEMA or isinstance(document["schema"], bool):
        raise InputError(file, "schema", document["schema"], f"{SCHEMA} (newer versions read more)")
    if not isinstance(document["kind"], str) or document["kind"] not in SAVED_LEARNERS:
        raise InputError(file, "kind", document["kind"], f"one of {', '.join(SAVED_LEARNERS)}")
    for field, (fits, accepted) in _FIELDS.items():
        if not fits(document.get(field)):
            raise InputError(file, field, document.get(field, "missing"), accepted)
    return document


def _try(model: SavedModel) -> None:
    """Ask for one torque: arrays that do not fit together say so now, not on the robot."""
    joints = len(model.joint_names)
    torque = np.asarray(model.learner.predict(np.zeros((1, joints))))
    if torque.size != joints or not np.isfinite(torque).all():
        raise ValueError("its torques are not one finite number per joint")


def _arrays(path: Path, digest: object) -> dict[str, np.ndarray]:
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(path, "file", error.strerror, "the arrays of a model") from error
    if digest is not None and hashlib.sha256(content).hexdigest() != digest:
        found = "damaged, or of another model"
        raise InputError(path, "content", found, "the arrays that were saved with the JSON")
    try:
        # from memory: NumPy leaves a damaged file open
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except (*_DAMAGE, *_NUMPY_DAMAGE, AttributeError) as error:
        raise InputError(path, "file", "damaged", "the arrays of a model") from error
    for name, array in arrays.items():
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            raise InputError(path, f"array {name!r}", "damaged (not finite)", "finite numbers")
    return arrays


def _replace(path: Path, content: bytes) -> None:
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.write_bytes(content)
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise InputError(path, "file", error.strerror, "a path that can be written") from error
