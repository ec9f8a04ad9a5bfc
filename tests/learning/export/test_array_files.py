import json

import numpy as np
import pytest

from isotorque.learning.export.array_files import export_bytes, read_export
from isotorque.learning.export.forms.torque_form import evaluate
from isotorque.learning.export.from_learner import torque_form
from isotorque.symbolic.common.errors import InputError
from tests.learning.export.fitted_models import MAKERS, far_queries, fitted_learner


def written(folder, name="trigonometric", **kwargs):
    learner = fitted_learner(name, **kwargs)
    arrays, document = export_bytes(torque_form(learner), "2r", "0123", ["a", "b"])
    (folder / "model.npz").write_bytes(arrays)
    (folder / "model.json").write_text(document)
    return learner, folder / "model.npz"


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("name", MAKERS)
def test_what_is_read_back_equals_predict(name, symmetric, tmp_path):
    learner, path = written(tmp_path, name, symmetric=symmetric)
    export = read_export(path)
    assert (export.robot, export.digest, export.joint_names) == ("2r", "0123", ("a", "b"))
    q = far_queries(2)
    expected = learner.predict(q)
    assert np.abs(evaluate(export.form, q) - expected).max() < 1e-12 * np.abs(expected).max()


def test_the_document_says_schema_robot_and_units(tmp_path):
    _, path = written(tmp_path)
    document = json.loads(path.with_suffix(".json").read_text())
    assert document["schema"] == 1
    assert document["digest"] == "0123"
    assert document["units"] == {"q": "rad", "tau": "N m"}
    with np.load(path, allow_pickle=False) as archive:
        shapes = {name: list(archive[name].shape) for name in archive.files}
    assert document["arrays"] == shapes


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("format", "another thing", "format"),
        ("schema", 2, "schema"),
        ("kind", "magic", "kind"),
        ("arrays", {}, "arrays"),
        ("digest", ..., "content"),
    ],
)
def test_damage_is_named(field, value, message, tmp_path):
    _, path = written(tmp_path)
    document = json.loads(path.with_suffix(".json").read_text())
    document[field] = value
    if value is ...:
        del document[field]
    path.with_suffix(".json").write_text(json.dumps(document))
    with pytest.raises(InputError, match=message):
        read_export(path)


def test_missing_and_broken_files_are_named(tmp_path):
    _, path = written(tmp_path)
    path.write_bytes(path.read_bytes()[:50])
    with pytest.raises(InputError, match="damaged"):
        read_export(path)
    path.unlink()
    with pytest.raises(InputError, match=r"model\.npz"):
        read_export(path)
