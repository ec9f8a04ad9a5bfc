"""The paper's table: rows that follow the robot, files that are gone on with."""

import json

import pinocchio as pin
import pytest
from threadpoolctl import threadpool_limits

from isotorque.cli.main import status
from isotorque.paper import run as paper_run
from isotorque.paper.experiments.batch import measure_batch_2r
from isotorque.paper.experiments.discovery import measure_discovery
from isotorque.paper.experiments.experiments import EXPERIMENTS, experiments_of
from isotorque.paper.experiments.measured import Effort
from isotorque.paper.experiments.statics import measure_domain, measure_ranges, measure_symmetries
from isotorque.paper.finished_work import Parts
from isotorque.paper.page import paper_pictures, render_page, write_pages
from isotorque.paper.run import Comparison, PaperOptions, compare
from isotorque.paper.table.items import ITEMS
from isotorque.paper.table.rules import equal
from isotorque.paper.table.table import make_rows
from isotorque.paper.table.text import markdown
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from tests.isotorque.paper.table.test_table import item

CHEAP = {"symmetries-2r", "domain-2r", "ranges-2r", "ranges-3r"}


def quiet(*_):
    pass


def heavier(name, factor=2.0):
    model = pin.Model(load_robot(name).model)
    for joint in range(1, model.njoints):
        body = model.inertias[joint]
        model.inertias[joint] = pin.Inertia(factor * body.mass, body.lever, factor * body.inertia)
    model.name = name
    return load_robot(model)


def ours(rows):
    return {row.item: row.ours for row in rows}


# -- what is measured --------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["2r", "3r"])
def test_doubled_masses_double_the_torques_of_the_table(name):
    entries = [entry for entry in ITEMS if entry.experiment == f"ranges-{name}"]
    tables = [
        make_rows(entries, {f"ranges-{name}": [measure_ranges(robot, 0, Effort()).numbers]})
        for robot in (load_robot(name), heavier(name))
    ]
    first, second = map(ours, tables)
    torques = [key for key in first if "torque" in key]
    assert len(torques) == 2 * load_robot(name).n
    for key in torques:
        assert second[key] == pytest.approx(2 * first[key], rel=1e-6)
    assert not any(row.holds for row in tables[1] if "torque" in row.item)
    assert all(row.why for row in tables[1] if not row.holds)


def test_other_masses_change_what_is_learned():
    with threadpool_limits(1):
        errors = [
            measure_batch_2r(robot, 0, Effort(0.01)).numbers["rmse_dense"]
            for robot in (load_robot("2r"), heavier("2r"))
        ]
    assert errors[0] != pytest.approx(errors[1], rel=0.05)


def test_other_masses_change_the_secondary_symmetries():
    shifted = pin.Model(load_robot("2r").model)
    body = shifted.inertias[2]
    shifted.inertias[2] = pin.Inertia(3.0 * body.mass, body.lever, 3.0 * body.inertia)
    light, heavy = (
        measure_symmetries(robot, 0, Effort(0.2)).numbers
        for robot in (load_robot("2r"), load_robot(shifted))
    )
    assert light["order"] == heavy["order"] == 8
    assert light["share_of_most"] != heavy["share_of_most"]


def test_eight_printed_maps_hold_and_a_wrong_one_does_not(monkeypatch):
    found = measure_symmetries(load_robot("2r"), 0, Effort(0.05)).numbers
    assert max(found["map_errors"]) < 1e-12
    wrong = (((1, 0, 0), (0, -1, 0)),)
    monkeypatch.setattr("isotorque.paper.experiments.statics.PRINTED_MAPS", wrong)
    found = measure_symmetries(load_robot("2r"), 0, Effort(0.05)).numbers
    assert min(found["map_errors"]) > 0.1


def test_the_domain_is_the_printed_parallelogram():
    found = measure_domain(load_robot("2r"), 0, Effort()).numbers
    assert found["corner_count"] == 4
    assert found["corner_error"] < 1e-12


def test_discovery_counts_what_the_arm_found():
    found = measure_discovery(load_robot("2r"), 3, Effort(0.2)).numbers
    assert found["relations"] == 8
    assert found["false_relations"] == 0
    assert 1 <= found["discovered"] <= found["most_discovered"] <= found["most_stable_members"] == 4


# -- files and the command ---------------------------------------------------------------------


@pytest.fixture
def cheap(monkeypatch):
    """Only experiments of a second."""
    chosen = tuple(entry for entry in EXPERIMENTS if entry.name in CHEAP)
    monkeypatch.setattr(paper_run, "experiments_of", lambda part: chosen)


def test_interrupted_and_resumed_the_table_is_the_same(cheap, tmp_path, monkeypatch):
    options = PaperOptions(seeds=2, share=0.05, jobs=1)
    whole = compare(options, tmp_path / "whole", quiet)
    done, real = [], paper_run.perform

    def interrupted(piece):
        if len(done) == 3:
            raise KeyboardInterrupt
        done.append(piece)
        return real(piece)

    monkeypatch.setattr(paper_run, "perform", interrupted)
    with pytest.raises(KeyboardInterrupt):
        compare(options, tmp_path / "cut", quiet)
    assert len(list((tmp_path / "cut" / "parts").iterdir())) == 3
    again = []
    monkeypatch.setattr(paper_run, "perform", lambda piece: again.append(piece) or real(piece))
    resumed = compare(options, tmp_path / "cut", quiet)
    assert not set(again) & set(done)
    assert resumed.rows == whole.rows
    assert resumed.document() == whole.document()


def test_more_seeds_use_what_is_there(cheap, tmp_path):
    compare(PaperOptions(seeds=1, share=0.05, jobs=1), tmp_path, quiet)
    kept = {p.name: p.stat().st_mtime_ns for p in (tmp_path / "parts").iterdir()}
    more = compare(PaperOptions(seeds=2, share=0.05, jobs=1), tmp_path, quiet)
    assert {row.seeds for row in more.rows} == {2}
    now = {p.name: p.stat().st_mtime_ns for p in (tmp_path / "parts").iterdir()}
    assert len(now) == 2 * len(kept)
    assert {name: now[name] for name in kept} == kept


def test_pieces_of_another_make_are_refused(cheap, tmp_path):
    compare(PaperOptions(share=0.05, jobs=1), tmp_path, quiet)
    with pytest.raises(InputError, match=r"parts/\S+json: share is 0\.05; accepted: 0\.1"):
        compare(PaperOptions(share=0.1, jobs=1), tmp_path, quiet)


def test_a_worker_of_another_version_is_refused(tmp_path):
    parts = Parts(tmp_path, {})
    with pytest.raises(InputError, match="versions of the worker"):
        parts.save("a-0", {"versions": {"numpy": "0.1"}})
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("text", ["", "{", "[]", '{"made_with": {}}', '{"result": {}}', "\x00"])
def test_a_damaged_piece_is_named(tmp_path, text):
    (tmp_path / "a-0.json").write_text(text)
    with pytest.raises(InputError, match=r"a-0\.json: content"):
        Parts(tmp_path, {}).load(["a-0"])


def test_the_page_holds_every_row_and_escapes_it(cheap, tmp_path):
    comparison = compare(PaperOptions(share=0.05, jobs=1), tmp_path, quiet)
    page = write_pages(comparison, tmp_path, quiet).read_text()
    assert page.count("<tr><td>") == len(comparison.rows)
    assert "<script" not in page
    for name in ("fig1", "fig2a", "fig2b", "fig5", "fig6", "fig9"):
        assert f'id="{name}"' in page
        assert (tmp_path / "figures" / f"{name}.svg").stat().st_size > 1000
        assert (tmp_path / "figures" / f"{name}.pdf").read_bytes().startswith(b"%PDF")
    document = json.loads((tmp_path / "paper.json").read_text())
    assert [row["item"] for row in document["rows"]] == [row.item for row in comparison.rows]
    assert (tmp_path / "paper.md").read_text().count("\n") == len(comparison.rows) + 2
    (evil,) = make_rows([item(equal(), 1, lambda n: "<b>&")], {"e": [{"x": 2}]})
    shown = render_page(Comparison(PaperOptions(), [evil], {}, {}), [])
    assert "&lt;b&gt;&amp;" in shown
    assert "<b>&" not in shown
    assert "<b>&" in markdown([evil])


def test_figures_need_no_experiment_that_was_not_made(cheap, tmp_path):
    comparison = compare(PaperOptions(share=0.05, jobs=1), tmp_path, quiet)
    kept = {"domain-2r": comparison.pictures["domain-2r"]}
    found = list(paper_pictures(Comparison(PaperOptions(), [], kept, {})))
    assert [picture.name for picture in found] == ["fig6"]


def test_the_command_prints_rows(cheap, tmp_path, capsys):
    code = status(["paper", "2r", "--out", str(tmp_path), "--quick", "--jobs", "1", "--json"])
    captured = capsys.readouterr()
    assert code == 0, captured.err
    rows = json.loads(captured.out)["rows"]
    assert all({"item", "paper", "ours", "holds", "rule", "why"} <= set(row) for row in rows)
    assert all(row["holds"] or row["why"] for row in rows)


@pytest.mark.parametrize(
    "arguments", [["4r"], ["2r", "--seeds", "0"], ["2r", "--jobs", "0"], ["2r", "--seed", "-1"]]
)
def test_the_command_refuses_in_one_line(arguments, tmp_path, capsys):
    assert status(["paper", *arguments, "--out", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert error.count("\n") == 1


def test_parts_of_the_paper():
    assert {e.part for e in experiments_of("3r")} == {"3r"}
    assert experiments_of("all") == experiments_of("figures") == EXPERIMENTS
