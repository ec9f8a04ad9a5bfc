"""Relations files: what is written is read back; every malformed case names itself."""

from __future__ import annotations

import copy
import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.verify.relations.relation_files import (
    load_relations,
    relations_document,
    write_relations,
)
from isotorque.verify.testing import strategies

JOINTS = ("shoulder", "elbow")


@pytest.fixture
def document(two_link):
    return relations_document(two_link.group, JOINTS)


def load(tmp_path, document, **options):
    path = tmp_path / "relations.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    return load_relations(path, **options)


@settings(max_examples=20, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(arm=strategies.known_arms(1, 3, planted=None))
def test_what_is_written_is_read_back(tmp_path_factory, arm):
    path = tmp_path_factory.mktemp("files") / "relations.json"
    names = arm.gravity.joint_names
    write_relations(path, relations_document(arm.group, names))
    found = load_relations(path, joint_names=names)
    assert found.joint_names == tuple(names)
    assert found.order == len(found) == arm.group.order
    for read, written in zip(found, arm.group, strict=True):
        for field in ("A", "d", "Y", "basis", "bound"):
            assert np.array_equal(getattr(read, field), getattr(written, field), equal_nan=True)
        assert read.exact == written.exact


def test_corrections_are_read_with_their_relations(tmp_path):
    entry = {"A": [[-1, 0], [2, 1]], "d": [0, 0], "Y": [1, 1]}
    for stated, constant, rate in (
        ({"constant": [0, 0.5]}, [0, 0.5], [0, 0]),
        ({"constant": [0, 0.5], "rate": [1, 0]}, [0, 0.5], [1, 0]),
        ({"rate": [1, 0]}, [0, 0], [1, 0]),
    ):
        found = load(tmp_path, {"relations": [entry | {"correction": stated}]})
        correction = found.relations[0].correction
        assert (correction.constant.tolist(), correction.rate.tolist()) == (constant, rate)
        written = relations_document(found.relations, ["a", "b"], corrected=found.relations)
        again = load(tmp_path, written)
        for read in (*again.relations, *again.corrected):
            assert read.correction.same_as(correction)
    plain = load(tmp_path, {"relations": [entry | {"correction": None}]}).relations[0]
    assert plain.correction is None
    wrong = ([0.5], {"constant": [0.5]}, {"constant": ["a", 0]}, {}, 1)
    for stated in wrong:
        with pytest.raises(InputError, match="correction"):
            load(tmp_path, {"relations": [entry | {"correction": stated}]})
    with pytest.raises(InputError, match='a relation with a "correction"'):
        load(tmp_path, {"relations": [entry], "corrected": [entry]})


def test_A_d_and_Y_suffice(tmp_path):
    entry = {"A": [[-1, 0], [2, 1]], "d": [0, 0], "Y": [1, 1]}
    for document in ({"relations": [entry]}, [entry]):
        found = load(tmp_path, document)
        assert found.order is None
        assert found.joint_names is None
        assert not found.relations[0].exact
        assert np.isnan(found.relations[0].bound).all()


@pytest.mark.parametrize("number", [2**53 + 1, -(2**63) - 1, 10**30])
@pytest.mark.parametrize("field", ["A", "d"])
def test_integers_that_no_float_holds_are_refused_not_rounded(tmp_path, number, field):
    entry = {"A": [[1]], "d": [0], "Y": [1]} | {field: [[number]] if field == "A" else [number]}
    with pytest.raises(InputError, match=f"{number}; accepted: an integer that a float holds"):
        load(tmp_path, [entry])
    assert load(tmp_path, [{"A": [[2**63]], "d": [2**60], "Y": [1]}]).relations[0].A[0, 0] == 2**63


def test_offsets_keep_their_turns(tmp_path):
    far = load(tmp_path, [{"A": [[1]], "d": [2e15 * np.pi], "Y": [1]}]).relations[0]
    assert far.unwrapped_d[0] == 2e15 * np.pi
    assert far.d[0] == pytest.approx(-0.4769, abs=1e-4)  # that float is no whole number of turns


def test_a_basis_of_no_frequencies_is_refused(tmp_path):
    entry = {"A": [[1]], "d": [0], "Y": [1]}
    for number in (1e308, 2e6, 0.5):
        with pytest.raises(InputError, match=r"basis .* accepted: linearly independent rows"):
            load(tmp_path, {"basis": [[number]], "relations": [entry]})


def test_learned_relations_with_real_matrices_and_unknown_bounds(tmp_path):
    learned = SymmetryRelation([[-1.001, 0.0], [2.0, 0.99]], [0.1, 0.2], [1, -1])
    document = relations_document([learned], JOINTS, extra=[{"support": 7}])
    assert document["relations"][0]["bound"] == [None, None]
    assert document["relations"][0]["support"] == 7
    assert "order" not in document
    found = load(tmp_path, document).relations[0]
    assert np.array_equal(found.A, learned.A)


def test_zero_rows_of_the_square_paper_form_are_allowed(tmp_path):
    entry = {"A": [[1, 0], [0, -1]], "d": [0.0, 0.5], "Y": [1, -1]}
    entry |= {"M": [[0, 1], [0, 0]], "N": [[0, 1], [0, 0]], "rhs": [0.5, 0.0]}
    found = load(tmp_path, {"basis": [[0, 1]], "relations": [entry]})
    assert found.relations[0].basis.tolist() == [[0, 1]]


def test_the_whole_turn_in_rhs_does_not_matter(tmp_path, document):
    document["relations"][3]["rhs"][0] += 2 * np.pi
    assert len(load(tmp_path, document)) == 8


def at(path, value):
    """A change of the document: put ``value`` at ``path``, or remove it."""

    def change(document):
        *parents, last = path
        place = document
        for key in parents:
            place = place[key]
        if value is REMOVED:
            del place[last]
        else:
            place[last] = value

    return change


REMOVED = object()
R = "relations"
MALFORMED = [
    (at([R], REMOVED), "relations is missing; accepted: an object with the entry 'relations'"),
    (at([R], {}), "relations is {}; accepted: a list"),
    (at([R], []), r"relations is \[\]; accepted: a list of at least 1 entries"),
    (at([R, 1], 5), r"relations\[1\] is 5; accepted: an object"),
    (at([R, 1, "A"], REMOVED), r"relations\[1\].A is missing"),
    (at([R, 0, "A"], REMOVED), r"relations\[0\].A is missing"),
    (at([R, 1, "d"], REMOVED), r"relations\[1\].d is missing"),
    (at([R, 1, "Y"], REMOVED), r"relations\[1\].Y is missing"),
    (at([R, 1, "A"], [[1, 0]]), r"relations\[1\].A is .*; accepted: a list of 2 entries"),
    (at([R, 1, "A", 1], [1]), r"relations\[1\].A\[1\] is \[1\]; accepted: a list of 2 entries"),
    (at([R, 1, "A", 1, 0], "2"), r'relations\[1\].A\[1\]\[0\] is "2"; accepted: a finite number'),
    (at([R, 1, "A", 1, 0], True), r"relations\[1\].A\[1\]\[0\] is true; accepted: a finite"),
    (at([R, 1, "A", 1, 0], None), r"relations\[1\].A\[1\]\[0\] is null"),
    (at([R, 1, "A", 1, 0], 10**400), r"relations\[1\].A\[1\]\[0\] is 1000.*; accepted: a finite"),
    (at([R, 1, "d"], [0.0]), r"relations\[1\].d is \[0.0\]; accepted: a list of 2 entries"),
    (at([R, 1, "d"], 0.0), r"relations\[1\].d is 0.0; accepted: a list of 2 entries"),
    (at([R, 1, "d", 0], float("nan")), r"relations\[1\].d\[0\] is NaN; accepted: a finite"),
    (at([R, 1, "d", 0], float("-inf")), r"relations\[1\].d\[0\] is -Infinity; accepted: a finite"),
    (at([R, 1, "Y"], [1, 0]), r"relations\[1\].Y is \[1, 0\]; accepted: signs, each 1 or -1"),
    (at([R, 1, "Y"], [1, 1, 1]), r"relations\[1\].Y is \[1, 1, 1\]; accepted: a list of 2"),
    (at([R, 1, "M", 0, 0], 7), r"relations\[1\].M is .*; accepted: -A_sat B = "),
    (at([R, 1, "N", 0, 0], 7), r"relations\[1\].N is .*; accepted: the basis B of y = B q"),
    (at([R, 1, "rhs", 0], 0.123), r"relations\[1\].rhs is .*; accepted: B d modulo 2 pi"),
    (at([R, 1, "rhs"], [0.0]), r"relations\[1\].rhs is \[0.0\]; accepted: a list of 2"),
    (at([R, 1, "exact"], 1), r"relations\[1\].exact is 1; accepted: true or false"),
    (at([R, 1, "bound"], [0.1]), r"relations\[1\].bound is \[0.1\]; accepted: a list of 2"),
    (at([R, 1, "bound"], [0.1, -1]), r"relations\[1\].bound is .*; accepted: numbers >= 0"),
    (at(["joints"], ["elbow", "shoulder"]), "joints is .*; accepted: the robot's joints in its"),
    (at(["joints"], ["elbow", "elbow"]), "joints is .*; accepted: distinct joint names"),
    (at(["joints"], ["shoulder"]), "joints is .*; accepted: the robot's joints"),
    (at(["joints"], ["shoulder", 3]), r"joints\[1\] is 3; accepted: a string"),
    (at(["order"], 7), "order is 7; accepted: the number of relations listed, 8"),
    (at(["order"], 8.5), "order is 8.5; accepted: an integer"),
    (at(["rank"], 1), "rank is 1; accepted: the number of rows of the basis, 2"),
    (at(["basis"], [[1, 0], [2, 0]]), "basis is .*; accepted: linearly independent rows"),
    (at(["basis"], [[1, 0], [0.5, 1]]), "basis is .*; accepted: .* rows of integers"),
    (at(["basis"], [[1, 0, 0]]), r"basis\[0\] is \[1, 0, 0\]; accepted: a list of 2 entries"),
    (at(["free_directions"], [[1, 0]]), "free_directions is .*; accepted: 0 independent"),
]


@pytest.mark.parametrize(("change", "message"), MALFORMED)
def test_malformed_documents_are_refused_by_name(tmp_path, document, change, message):
    broken = copy.deepcopy(document)
    change(broken)
    with pytest.raises(InputError, match=message) as caught:
        load(tmp_path, broken, joint_names=JOINTS)
    assert str(caught.value).startswith(str(tmp_path / "relations.json"))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "JSON at line 1, column 1 is Expecting value"),
        ("{", "JSON at line 1, column 2"),
        ('{"relations": []} x', "JSON at line 1, column 19 is Extra data"),
        ('{"a": 1, "a": 2}', "entry 'a' is repeated"),
        ("[" * 100_000, "nesting is too deep"),
        ("7", "relations is 7; accepted: a list"),
        ('{"relations": [{"A": [[1e999]]}]}', r"relations\[0\].A\[0\]\[0\] is Infinity"),
        ('{"relations": [{"A": [[1' + "0" * 5000 + "]]}]}", "a number is Exceeds the limit"),
        (
            '{"basis": [[0, 1]], "relations": [{"A": [[1, 0], [1, 1]], "d": [0, 0], "Y": [1, 1]}]}',
            "A is .*; accepted: a matrix that maps y = B q to y",
        ),
    ],
)
def test_malformed_texts_are_refused(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        load(tmp_path, text)


def test_unreadable_files_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"none.json: file is No such file or directory"):
        load_relations(tmp_path / "none.json")
    with pytest.raises(InputError, match="file is Is a directory"):
        load_relations(tmp_path)
    (tmp_path / "latin.json").write_bytes(b'{"joints": ["\xe9"]}')
    with pytest.raises(InputError, match=r"encoding is .*; accepted: JSON in UTF-8"):
        load_relations(tmp_path / "latin.json")
    with pytest.raises(InputError, match="file is No such file or directory; accepted: a path"):
        write_relations(tmp_path / "no" / "r.json", {})


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_whatever_stands_in_the_file_is_read_or_refused(tmp_path, two_link, data):
    """Replace one random place by a random value: an InputError or a file, nothing else."""
    document = json.loads(json.dumps(relations_document(two_link.group, JOINTS)))
    place, keys = document, None
    while isinstance(place, dict | list) and place and (keys is None or data.draw(st.booleans())):
        keys = (
            place,
            data.draw(
                st.sampled_from(list(place) if isinstance(place, dict) else list(range(len(place))))
            ),
        )
        place = place[keys[1]]
    keys[0][keys[1]] = data.draw(
        st.none()
        | st.booleans()
        | st.integers()
        | st.floats()
        | st.text(max_size=3)
        | st.lists(st.integers(-2, 2), max_size=3)
        | st.just({})
    )
    message = ""
    try:
        assert len(load(tmp_path, document)) == 8
    except InputError as error:
        message = str(error)
    assert "\n" not in message
