"""Saved models: one npz with the arrays, one JSON with everything else, no pickle."""

from __future__ import annotations

import importlib
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

from learning.recordings.run_info import software_versions
from symbolic.errors import InputError

SCHEMA = 1
CLASSES = {
    "LocalLinearMap": "learning.learners.local_linear_map",
    "RecursiveLeastSquares": "learning.learners.recursive_least_squares",
}
"""Learners that can be saved, and where they live."""
_DAMAGE = (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error)
# what zipfile and NumPy's header parser raise on flipped bits
_NUMPY_DAMAGE = (NotImplementedError, RuntimeError, KeyError, SyntaxError, TypeError)


@dataclass(frozen=True, eq=False)
class SavedModel:
    """A learned inverse statics model and what it is about.

    Attributes
    ----------
    learner
        Something with ``predict(q)``: configurations (m, n) [rad] to torques (m, n) [N m]; goes on
        learning with ``partial_fit``.
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
    """
    kind = type(model.learner).__name__
    if kind not in CLASSES:
        raise InputError("model", "learner", kind, f"one of {', '.join(sorted(CLASSES))}")
    directory = Path(folder)
    document = {
        "schema": SCHEMA,
        "kind": kind,
        "robot": model.robot,
        "digest": model.digest,
        "joints": list(model.joint_names),
        "parameters": model.learner.parameters(),
        "notes": model.notes,
        "versions": software_versions(),
    }
    text = json.dumps(document, indent=1, allow_nan=False) + "\n"
    # the arrays first: a JSON without its arrays would be a broken promise
    _replace(directory / "model.npz", lambda file: np.savez(file, **model.learner.to_arrays()))
    _replace(directory / "model.json", lambda file: file.write(text.encode()))
    return directory / "model.json"


def load_model(path: str | Path) -> SavedModel:
    """Read a saved model: its ``model.json``, or the directory that holds it.

    Raises
    ------
    InputError
        If a file is missing, damaged, of a newer version, or does not fit the other.
    """
    file = Path(path)
    if file.is_dir():
        file = file / "model.json"
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(file, "file", error.strerror, "a saved model") from error
    except ValueError as error:
        raise InputError(file, "file", "not JSON", "a saved model") from error
    if not isinstance(document, dict) or not {"schema", "kind", "parameters"} <= set(document):
        raise InputError(file, "content", "no saved model", "the model.json of a run")
    if document["schema"] != SCHEMA:
        raise InputError(file, "schema", document["schema"], f"{SCHEMA} (newer versions read more)")
    if document["kind"] not in CLASSES:
        raise InputError(file, "kind", document["kind"], f"one of {', '.join(sorted(CLASSES))}")
    arrays = _arrays(file.with_suffix(".npz"))
    kind = getattr(importlib.import_module(CLASSES[document["kind"]]), document["kind"])
    try:
        learner = kind.from_arrays(arrays, document["parameters"])
        return SavedModel(
            learner,
            str(document["robot"]),
            str(document["digest"]),
            tuple(document["joints"]),
            dict(document["notes"]),
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise InputError(
            file, "content", f"damaged ({error})", "a model as it was saved"
        ) from error


def _arrays(path: Path) -> dict[str, np.ndarray]:
    try:
        # from memory: NumPy leaves a damaged file open
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (*_DAMAGE, *_NUMPY_DAMAGE) as error:
        raise InputError(path, "file", "missing or damaged", "the arrays of a model") from error


def _replace(path: Path, write: Callable[[Any], Any]) -> None:
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with temporary.open("wb") as file:
            write(file)
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise InputError(path, "file", error.strerror, "a path that can be written") from error
