"""Relations from recordings on the command line: learned, tested, and never guessed."""

import json

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.recordings.recorded_data import record_samples
from isotorque.learning.recordings.recording import Recording
from isotorque.symbolic.level_sets.level_set import level_set
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.relations.relation_files import load_relations
from tests.learning.static_data import known_potential, recording, stable_samples, with_angle_noise


def record(out, label, q, tau, *, limits=None, phase="discovery"):
    """Recording of samples that says it was made on the robot `label`."""
    robot = load_robot(label)
    options = {} if limits is None else {"arm": {"limits": limits}}
    info = RunInfo(robot.name, robot.digest, robot.joint_names, seed=0, options=options)
    out.mkdir(exist_ok=True)
    with Recording.create(out / "run.sqlite", info) as file:
        record_samples(file, StaticSamples(np.asarray(q), np.asarray(tau)), phase)
        file.finish()
    return out


def relations(capsys, out, *more):
    """Exit status and document of `isotorque relations`."""
    code = status(["relations", str(out), "--json", "--quiet", *map(str, more)])
    return code, json.loads(capsys.readouterr().out)


@pytest.fixture
def two_link(tmp_path):
    potential, _ = known_potential("2r")
    return record(tmp_path / "run", "2r", *stable_samples(potential, np.random.default_rng(0), 12))


@pytest.mark.parametrize("source", ["exact", "2r"])
def test_the_relations_of_the_geometry_are_consistent(two_link, capsys, source):
    code, document = relations(capsys, two_link, "--candidates", source)
    assert code == 0
    assert document["candidates"]["source"] == source
    judged = document["candidates"]["judged"]
    assert [entry["judgement"] for entry in judged] == ["consistent"] * 8
    assert all(entry["p_value"] > 1e-4 and max(entry["bound"]) < 1e-5 for entry in judged)
    assert document["order"] == 8
    assert "candidates" not in json.loads((two_link / "relations.json").read_text())


def test_what_was_learned_can_be_tested_on_another_recording(two_link, tmp_path, capsys):
    assert status(["relations", str(two_link), "--quiet"]) == 0
    capsys.readouterr()
    potential, _ = known_potential("2r")
    other = record(
        tmp_path / "other", "2r", *stable_samples(potential, np.random.default_rng(1), 9)
    )
    code, document = relations(capsys, other, "--candidates", two_link / "relations.json")
    assert code == 0
    assert len(document["candidates"]["judged"]) == 8


def test_a_false_candidate_is_contradicted(two_link, tmp_path, capsys):
    claims = [
        {"A": [[-1, 0], [2, 1]], "d": [0, 0], "Y": [1, 1]},
        {"A": [[-1, 0], [2, -1]], "d": [0, 0], "Y": [1, 1]},
    ]
    path = tmp_path / "claims.json"
    path.write_text(json.dumps({"relations": claims}))
    code, document = relations(capsys, two_link, "--candidates", path)
    assert code == 1
    true, false = document["candidates"]["judged"]
    assert true["judgement"] == "consistent"
    assert false["judgement"] == "contradicted"
    assert false["p_value"] < 1e-4
    assert max(false["bound"]) > 1.0
    assert status(["relations", str(two_link), "--candidates", str(path), "--quiet"]) == 1
    text = capsys.readouterr().out
    assert "2 candidates" in text
    assert "1 consistent, 1 contradicted, 0 untestable" in text


def test_few_samples_leave_candidates_untestable(tmp_path, capsys):
    potential, _ = known_potential("2r")
    few = record(tmp_path / "few", "2r", *stable_samples(potential, np.random.default_rng(0), 3))
    code, document = relations(capsys, few, "--candidates", "exact")
    assert code == 0
    for entry in document["candidates"]["judged"]:
        assert entry["judgement"] == "untestable with this data"
        assert entry["p_value"] is None
        assert "3 more samples" in entry["reason"]
    assert status(["relations", str(few), "--candidates", "exact", "--quiet"]) == 0
    assert "8 untestable" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("{", "JSON"),
        ('{"relations": []}', "relations"),
        ('{"relations": [{"A": [[1]], "d": [0], "Y": [1]}]}', "relations[0].A"),
        ('{"relations": [{"A": [[1, 0], [0, 1]], "d": [0, 0], "Y": [1, 2]}]}', "Y"),
        (
            '{"joints": ["b", "a"], "relations": '
            '[{"A": [[1, 0], [0, 1]], "d": [0, 0], "Y": [1, 1]}]}',
            "joints",
        ),
    ],
)
def test_a_bad_file_of_candidates_is_refused(two_link, tmp_path, capsys, text, word):
    path = tmp_path / "bad.json"
    path.write_text(text)
    assert status(["relations", str(two_link), "--candidates", str(path)]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ")
    assert message.count("\n") == 1
    assert word in message


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--candidates", "absent.json"], "absent.json"),
        (["--candidates", "no-such-robot"], "no-such-robot"),
        (["--candidates", "pendulum"], "number of joints"),
        (["--angle-noise", "-1"], "--angle-noise"),
        (["--torque-noise", "inf"], "--torque-noise"),
        (["--angle-noise", "0"], "noise"),
    ],
)
def test_bad_options_are_refused(two_link, capsys, options, word):
    assert status(["relations", str(two_link), *options]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert word in message


def test_exact_needs_the_robot_that_was_recorded(tmp_path, capsys):
    potential, _ = known_potential("2r")
    samples = stable_samples(potential, np.random.default_rng(0), 8)
    info = RunInfo("2r", "another digest", load_robot("2r").joint_names, seed=0)
    with Recording.create(tmp_path / "run.sqlite", info) as file:
        record_samples(file, StaticSamples(*samples), "discovery")
    assert status(["relations", str(tmp_path), "--candidates", "exact"]) == 2
    assert "digest" in capsys.readouterr().err
    assert status(["relations", str(tmp_path), "--candidates", "2r"]) == 0


def test_known_noise_makes_a_small_recording_cautious(tmp_path, capsys):
    potential, _ = known_potential("2r")
    rng = np.random.default_rng(0)
    q, tau = stable_samples(potential, rng, 12)
    out = record(tmp_path / "run", "2r", with_angle_noise(q, 0.1, rng), tau)
    code, document = relations(capsys, out, "--angle-noise", np.deg2rad(0.1))
    assert (code, document["order"]) == (0, 8)
    code, document = relations(capsys, out, "--angle-noise", 0.5, "--candidates", "2r")
    assert (code, document["order"]) == (0, 1)
    kinds = [entry["judgement"] for entry in document["candidates"]["judged"]]
    assert kinds.count("untestable with this data") == 7


def test_relations_come_from_the_data_not_from_the_label(tmp_path, capsys):
    # three joints: recorded on the planar arm, labelled as a copy of it with another middle axis
    label = tmp_path / "impostor.urdf"
    from importlib.resources import files

    text = files("isotorque.symbolic").joinpath("robot_files/3r.urdf").read_text()
    axes = text.count("<axis")
    assert axes == 3
    first = text.index("<axis", text.index("<axis") + 1)
    end = text.index("/>", first) + 2
    label.write_text(text[:first] + '<axis xyz="1 0 0"/>' + text[end:])
    potential, group = known_potential("3r")
    samples = stable_samples(potential, np.random.default_rng(0), 15)
    out = record(tmp_path / "run", str(label), *samples)
    code, document = relations(capsys, out, "--candidates", "3r")
    assert (code, document["order"]) == (0, group.order)
    # the labelled robot has relations of its own, and the recording does not follow all of them
    code, document = relations(capsys, out, "--candidates", label)
    assert code == 1
    assert document["order"] == group.order


def test_relations_beyond_the_limits_are_labels_only(tmp_path, capsys):
    potential, _ = known_potential("2r")
    samples = stable_samples(potential, np.random.default_rng(0), 12)
    narrow = record(tmp_path / "a", "2r", *samples, limits=[[-3.0, -0.1], [-0.5, 0.5]])
    _, document = relations(capsys, narrow)
    executable = [entry["executable"] for entry in document["relations"]]
    assert document["order"] == 8
    assert executable[0] is True
    assert False in executable
    status(["relations", str(narrow), "--quiet"])
    printed = capsys.readouterr().out
    assert printed.count("not executable within the joint limits") == executable.count(False)
    free = record(tmp_path / "b", "2r", *samples, limits=[[None, None], [None, None]])
    assert all(entry["executable"] for entry in relations(capsys, free)[1]["relations"])
    unknown = record(tmp_path / "c", "2r", *samples)
    assert {entry["executable"] for entry in relations(capsys, unknown)[1]["relations"]} == {None}


def test_secondary_pairs_are_counted_not_learned(tmp_path, capsys):
    potential, group = known_potential("2r")
    rng = np.random.default_rng(4)
    q, tau = recording(potential, group, rng, 6, kept=(1.0, 1.0))
    out = record(tmp_path / "run", "2r", q, tau)
    _, document = relations(capsys, out)
    assert document["order"] == 8
    pairs = document["secondary_pairs"]
    # with every configuration recorded: sets of 16 are two primary sets, 8 x 8 pairs between them
    sixteen = sum(
        len(level_set(potential, torque, group=group)) == 16
        for torque in np.unique(np.abs(tau).round(9), axis=0)
    )
    assert sixteen > 0
    assert sum(kind["pairs"] for kind in pairs) == 64 * sixteen
    assert all(kind["torques"] <= sixteen for kind in pairs)
    assert {entry["known"] for entry in document["relations"][1:]} == {"observed"}
    assert all(entry["snapped"] for entry in document["relations"])
    found_alone = [r["log10_false_alarms"] for r in document["relations"][1:]]
    assert any(alarms is not None and alarms < -3 for alarms in found_alone)
    regression = document["relations"][1]["regression"]
    np.testing.assert_allclose(regression["M"], document["relations"][1]["M"], atol=1e-6)


def bad_samples(case):
    potential, group = known_potential("2r")
    rng = np.random.default_rng(0)
    q, tau = stable_samples(potential, rng, 30)
    if case == "nothing":
        return q[:0], tau[:0]
    if case == "too few":
        return q[:2], tau[:2]
    if case == "one torque":
        found = level_set(potential, tau[0], group=group)
        return found.configurations[found.stable], found.torques[found.stable]
    if case == "all equal":
        return np.tile(q[0], (30, 1)) + 2 * np.pi * rng.integers(-1, 2, (30, 2)), tau[[0] * 30]
    if case == "no torque at all":
        return rng.choice([-np.pi / 2, np.pi / 2], (4, 1)) * [[1, 0]], np.zeros((4, 2))
    first = rng.uniform(-np.pi, np.pi, 30)  # the forearm hangs: joint 2 never needs a torque
    q = np.stack([first, -np.pi / 2 - first], axis=1)
    return q, potential.gradient(q) * [1.0, 0.0]


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("nothing", ["6 samples with a torque", "none was given"]),
        ("too few", ["4 more samples", "1 more torques"]),
        ("one torque", ["more samples", "2 more torques"]),
        ("all equal", ["5 more samples", "2 more torques"]),
        ("no torque at all", ["6 samples with a torque", "all given torques are zero"]),
        ("a torque component is zero", ["torque on joint 2", "more samples"]),
    ],
)
def test_bad_recordings_get_an_answer_that_says_what_is_missing(tmp_path, capsys, case, words):
    out = record(tmp_path / "run", "2r", *bad_samples(case))
    code, document = relations(capsys, out)
    assert code == 0
    assert document["order"] == 1
    assert all(word in document["missing"] for word in words)
    assert status(["relations", str(out), "--quiet"]) == 0
    assert f"missing: {document['missing']}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("beside", "said"),
    [
        (lambda q: [0.0, 0.8] + 0.0 * q, "a constant torque of +0.8 N m on joint 2"),
        (lambda q: [0.0, 0.3] * q, "(a spring) of +0.3 N m/rad on joint 2"),
    ],
    ids=["constant", "spring"],
)
def test_relations_less_what_joints_carry_beside_gravity_are_listed(tmp_path, capsys, beside, said):
    potential, group = known_potential("2r")
    q = np.random.default_rng(0).uniform(-2.5, 2.5, (25, 2))
    out = record(tmp_path / "run", "2r", q, potential.gradient(q) + beside(q))
    code, document = relations(capsys, out)
    assert code == 0
    assert document["order"] + len(document["corrected"]) == group.order
    causes = document["misfit"]["causes"]
    assert [cause["joint"] for cause in causes] == [1]
    assert not document["misfit"]["failed"]
    assert status(["relations", str(out), "--quiet"]) == 0
    text = capsys.readouterr().out
    assert said in text
    assert text.count("less its correction c;") == len(document["corrected"])
    file = load_relations(out / "relations.json")
    here = np.random.default_rng(1).uniform(-3.0, 3.0, (50, 2))
    for relation in (*file, *file.corrected):
        there = relation.configuration(here)
        measured = potential.gradient(here) + beside(here)
        missed = potential.gradient(there) + beside(there) - relation.torque(measured, here)
        assert np.abs(missed).max() < 1e-6


def test_samples_of_any_phase_are_used_where_nothing_was_discovered(tmp_path, capsys):
    potential, _ = known_potential("2r")
    samples = stable_samples(potential, np.random.default_rng(0), 8)
    out = record(tmp_path / "run", "2r", *samples, phase="learning")
    _, document = relations(capsys, out)
    assert (document["order"], document["samples"], document["torques"]) == (8, 8, 8)
