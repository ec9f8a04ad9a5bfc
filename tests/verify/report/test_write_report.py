"""The report shows what was computed: self-contained, in full, and nothing else."""

from __future__ import annotations

import dataclasses
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.verify.models.verify_model import verify_model
from isotorque.verify.relations.learned_symmetries import judge_relations, soundness
from isotorque.verify.report.document import report_document
from isotorque.verify.report.figures.learning_curves import LearningCurve
from isotorque.verify.report.figures.level_sets import planar_chain
from isotorque.verify.report.figures.torques import ProfileTrace
from isotorque.verify.report.report_sections import (
    DiscoveryReport,
    ExplorationReport,
    Gate,
    LevelSetReport,
    StaticTorqueReport,
)
from isotorque.verify.report.run_figures import report_pictures
from isotorque.verify.report.run_report import RunReport, RunSetup, Stage
from isotorque.verify.report.summaries import summarise_domain
from isotorque.verify.report.write_report import render_report, verdicts_page, write_report
from isotorque.verify.verdict import Status, Verdict

SETUP = RunSetup(
    robot="2r",
    digest="c0ffee",
    joint_names=("shoulder", "elbow"),
    physics="open_loop",
    engine="compiled",
    strategy="direction sampling",
    learner="local-linear-map",
    symmetries="learned",
    seed=7,
    versions=(("numpy", "2.0"),),
    command="isotorque run 2r --seed 7",
)
VOID = {"meta", "br", "link", "img", "hr", "input"}


class Checked(HTMLParser):
    """Fails on tags that are not closed in order; collects ids, links and text."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.tags, self.links, self.text = [], [], set(), [], []

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        values = dict(attributes)
        self.ids += [values["id"]] if "id" in values else []
        self.links += [v for k, v in attributes if k in {"href", "src", "xlink:href"}]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def parsed(page):
    reader = Checked()
    reader.feed(page)
    assert reader.open == []
    return reader


@pytest.fixture(scope="module")
def full(two_link):
    """A report with every part."""
    group, gravity = two_link.group, two_link.gravity
    rng = np.random.default_rng(0)
    q = np.concatenate([group.orbit([-0.9, 0.4]), group.orbit([-1.3, 0.5])])
    times = np.linspace(0, 2, 30)
    trace = ProfileTrace(times, rng.normal(size=(30, 2)), rng.normal(size=(30, 2)), "settled")
    relations = [SymmetryRelation(r.A, r.d + 1.234e-4, r.Y) for r in group]
    symmetry = judge_relations(relations, gravity, method="identification")
    samples = np.array([100.0, 200.0, 400.0])
    return RunReport(
        setup=SETUP,
        stages=(Stage("derive", 0.5), Stage("learn", 61.5, 400, 1234.5)),
        symmetry=symmetry,
        discovery=DiscoveryReport(
            targets=np.array([[9.1, 3.2]]),
            discovered=np.array([4]),
            profiles=12,
            babbling=40,
            settled=41,
            limit_hits=10,
            timeouts=1,
            n_min=8,
            gates=(Gate(1, 8, True),),
            traces=(trace, dataclasses.replace(trace, outcome="limit")),
        ),
        static_torques=StaticTorqueReport(
            rng.normal(size=(50, 2)), rng.normal(size=(9, 2)), rng.normal(size=(4, 3, 2))
        ),
        domain=summarise_domain(FundamentalDomain(group)),
        exploration=ExplorationReport(
            explored=rng.uniform(-1, 0, (40, 2)),
            images=rng.uniform(-3, 3, (280, 2)),
            commands=401,
            settled=390,
            limit_hits=11,
            timeouts=0,
            projected=5,
            explored_share=0.875,
            explored_radius=0.3,
        ),
        curves=(LearningCurve("dense set", samples, 1 / samples),),
        goal=0.0053,
        model=verify_model(
            lambda q: gravity.torque(q) + 0.0123, gravity, group=group, tolerance=0.02
        ),
        level_sets=LevelSetReport(
            torque=np.abs(gravity.torque(q[0])),
            q=q,
            sets=np.repeat([0, 1], 8),
            stable=np.arange(16) % 4 == 0,
            curves=((0, 1, rng.uniform(-3, 3, (20, 2))),),
            links=planar_chain(q, [0.25, 0.25]),
        ),
        verdicts=(soundness(symmetry),),
    )


@pytest.fixture(scope="module")
def full_page(full):
    """Its page."""
    return render_report(full)


@pytest.fixture
def without_pictures(monkeypatch):
    """Leave out the pictures, which take longest."""
    monkeypatch.setattr("isotorque.verify.report.write_report.report_pictures", lambda report: [])


def test_the_page_is_well_formed_and_self_contained(full_page):
    page = full_page
    reader = parsed(page)
    assert "script" not in reader.tags
    assert all(link.startswith(("#", "data:image/png;base64,")) for link in reader.links)
    assert not re.search(r"url\((?!#)", page)
    assert "@import" not in page
    assert len(reader.ids) == len(set(reader.ids))
    assert "prefers-color-scheme: dark" in page


def test_every_part_has_its_pictures(full, full_page):
    names = [picture.name for picture in report_pictures(full)]
    assert names == [
        "fig2a-configurations",
        "fig2b-level-sets",
        "fig3-torque-profiles",
        "fig4-joint-trajectories",
        "fig7-static-torques",
        "fig6-bcts",
        "fig10-explored",
        "fig13-learning-curve",
    ]
    page = full_page
    assert all(f'<figure id="{name}"' in page for name in names)
    assert page.count("<svg ") == len(names)


def test_the_numbers_of_the_run_stand_in_the_page(full_page):
    text = re.sub(r"\s+", " ", "".join(parsed(full_page).text))
    for shown in (
        "8 of 8",
        "52",  # motions to discover: 12 profiles and 40 torques
        "0.0123 Nm",  # RMSE
        "62 s",  # of computing
        "(9.1, 3.2)",
        "87.5 % of the domain lies within 0.3 rad",
        "401 torques commanded: 390 settled, 11 met a joint limit",
        "q1′ = −q1 + 0.000123",
        "8 of 8 relations learned, 0 false",
        "c0ffee",
        "numpy 2.0",
    ):
        assert shown in text, shown


def test_json_holds_every_number_and_is_what_was_written(full, tmp_path, without_pictures):
    page, document = write_report(full, tmp_path / "new" / "run")
    written = json.loads((page.parent / "report.json").read_text())
    assert written == json.loads(json.dumps(document))
    assert page.read_text().startswith("<!DOCTYPE html>")
    assert sorted(path.name for path in page.parent.iterdir()) == ["report.html", "report.json"]
    assert written["passed"] is full.passed
    assert written["totals"]["rmse_torque"] == full.model.rmse
    assert written["totals"]["relations_found"] == 8
    assert written["symmetry"]["truth"]["order"] == 8
    assert written["symmetry"]["relations"][1]["bound"] == full.symmetry.relations[1].bound.tolist()
    assert written["discovery"]["targets"] == [[9.1, 3.2]]
    assert written["exploration"]["explored"] == full.exploration.explored.tolist()
    assert written["exploration"]["images_drawn"] == 280
    assert written["curves"][0]["rmse"] == [0.01, 0.005, 0.0025]
    assert len(written["verdicts"]) == len(full.all_verdicts)
    assert set(written["verdicts"][0]) == {
        "claim",
        "status",
        "passed",
        "worst_error",
        "counterexample",
    }


def test_no_number_of_the_page_is_fixed(full, without_pictures):
    """Change a number of the run: the page changes."""
    page = render_report(full)
    changed = [
        dataclasses.replace(full, exploration=dataclasses.replace(full.exploration, settled=391)),
        dataclasses.replace(full, stages=(Stage("derive", 0.6), full.stages[1])),
        dataclasses.replace(full, discovery=dataclasses.replace(full.discovery, profiles=13)),
        dataclasses.replace(full, setup=dataclasses.replace(full.setup, seed=8)),
    ]
    pages = {render_report(report) for report in changed}
    assert len(pages) == len(changed)
    assert page not in pages


def test_a_run_with_nothing_but_a_setup_has_a_page():
    report = RunReport(SETUP)
    reader = parsed(render_report(report))
    assert "figure" not in reader.tags
    assert report_document(report)["model"] is None
    assert report.passed


@pytest.mark.parametrize("part", [f.name for f in dataclasses.fields(RunReport)][1:])
def test_a_run_may_lack_any_part(full, part, without_pictures):
    empty = () if isinstance(getattr(full, part), tuple) else None
    report = dataclasses.replace(full, **{part: empty})
    parsed(render_report(report))
    assert len(report_pictures(report)) in {6, 7, 8}


def test_one_and_three_joints(arms):
    for name in ("pendulum", "3r"):
        arm = arms[name]
        n, rng = arm.gravity.n, np.random.default_rng(0)
        report = RunReport(
            setup=dataclasses.replace(SETUP, joint_names=arm.gravity.joint_names),
            symmetry=judge_relations(list(arm.group), arm.gravity, method="exact"),
            static_torques=StaticTorqueReport(rng.normal(size=(9, n)), np.zeros((0, n))),
            domain=summarise_domain(FundamentalDomain(arm.group)),
            exploration=ExplorationReport(
                rng.normal(size=(9, n)), rng.normal(size=(9, n)), 9, 9, 0, 0
            ),
            model=verify_model(arm.gravity.torque, arm.gravity, orbits=arm.group),
        )
        parsed(render_report(report))


def test_a_failed_claim_fails_the_run(full, without_pictures):
    bad = Verdict("the sum of 1 < 2", Status.REFUTED, 1.0, np.array([0.25, -1.5]))
    report = dataclasses.replace(full, verdicts=(bad,))
    page = render_report(report)
    assert not report.passed
    assert '<span class="badge refuted">failed</span>' in page
    assert "the sum of 1 &lt; 2" in page
    assert "q = (0.25, −1.5)" in page


def test_no_column_is_clipped_on_paper(full_page):
    style = full_page[: full_page.index("</style>")]
    screen, printed = style.split("@media print {")
    assert "size: A4" in printed
    # what hides or forbids to wrap on a screen does not on paper
    for rule in re.findall(
        r"([^{}]+)\{[^}]*(?:overflow(?:-x)?: (?:hidden|auto)|nowrap)[^}]*\}", screen
    ):
        names = [name.strip() for name in rule.split(",")]
        assert any(name in printed for name in names), rule
    assert "hidden" not in printed
    assert "nowrap" not in printed


def test_the_first_line_says_what_holds_and_what_does_not(full, two_link, without_pictures):
    gravity = two_link.gravity

    def first_line(report):
        found = re.search(r'<p class="holds">(.*?)</p>', render_report(report), re.S)
        assert report_document(report)["summary"] == list(report.summary)
        return found[1]

    line = first_line(full)
    assert line.startswith(
        "Passed. Relations: 8 of 8 known, none false. Static torques: not judged."
    )
    assert "Model: holds on the whole space, RMSE 0.0123, largest error 0.0123 N m" in line
    wrong = verify_model(
        lambda q: gravity.torque(q) + np.array([0.0, 0.03]),
        gravity,
        tolerance=0.02,
        largest_tolerance=0.02,
    )
    line = first_line(dataclasses.replace(full, model=wrong))
    assert line.startswith("Failed.")
    assert "Model: does not hold on the whole space, RMSE 0.0212, largest error 0.03 N m" in line
    few = judge_relations(list(two_link.group)[:5], gravity, method="identification")
    line = first_line(dataclasses.replace(full, symmetry=few, verdicts=(soundness(few),)))
    assert line.startswith("Passed. Relations: 5 of 8 known, none false; not all that there are.")
    assert "Model: none" in first_line(dataclasses.replace(full, model=None))
    gate = dataclasses.replace(full.discovery, gates=(Gate(1, 2, False),))
    assert "Gate of 8 relations before learning: not passed, nothing learned" in first_line(
        dataclasses.replace(full, discovery=gate)
    )


def test_joints_that_gravity_does_not_load_are_left_out_of_pictures(full, two_link):
    names = ("pan", "shoulder", "elbow")
    rng = np.random.default_rng(0)
    times = np.linspace(0, 2, 30)
    trace = ProfileTrace(times, rng.normal(size=(30, 3)), rng.normal(size=(30, 3)), "settled")
    report = dataclasses.replace(
        full,
        setup=dataclasses.replace(SETUP, joint_names=names, unloaded=("pan",)),
        domain=None,
        level_sets=None,
        discovery=dataclasses.replace(full.discovery, traces=(trace,)),
        static_torques=StaticTorqueReport(rng.normal(size=(9, 3)), np.zeros((0, 3))),
        exploration=ExplorationReport(rng.normal(size=(9, 3)), rng.normal(size=(9, 3)), 9, 9, 0, 0),
    )
    pictures = {picture.name: picture for picture in report_pictures(report)}
    for name in (
        "fig3-torque-profiles",
        "fig4-joint-trajectories",
        "fig7-static-torques",
        "fig10-explored",
    ):
        assert pictures[name].caption.endswith("as gravity does not load it: pan."), name
    for name in ("fig7-static-torques", "fig10-explored"):
        (axes,) = pictures[name].figure.axes
        assert "_2" in axes.get_xlabel() or "2" in axes.get_xlabel()
        assert "3" in axes.get_ylabel()
    lines = pictures["fig3-torque-profiles"].figure.axes[0].get_legend().get_texts()
    assert len(lines) == 2
    alone = dataclasses.replace(report.setup, unloaded=("pan", "shoulder"))
    assert "fig7-static-torques" not in {
        picture.name for picture in report_pictures(dataclasses.replace(report, setup=alone))
    }


def test_names_cannot_smuggle_in_markup():
    setup = dataclasses.replace(SETUP, robot="<script>alert(1)</script>", command='"><b>')
    page = render_report(RunReport(setup))
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_verdicts_alone_have_a_page():
    verdicts = [Verdict("a", Status.PROVED, 0.0), Verdict("b", Status.REFUTED, 2.5e-7)]
    page = verdicts_page("r.json against 2r", verdicts, "tolerance 1e-9 Nm")
    text = "".join(parsed(page).text)
    assert "failed" in text
    assert "tolerance 1e-9 Nm" in text
    assert "2.5·10−7" in text
    assert "passed" in "".join(parsed(verdicts_page("x", verdicts[:1])).text)


def test_directories_that_cannot_be_written_are_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="directory is"):
        write_report(RunReport(SETUP), tmp_path / "file")
    (tmp_path / "report.json").mkdir()
    with pytest.raises(InputError, match=r"report.json: file is Is a directory"):
        write_report(RunReport(SETUP), tmp_path)
    assert not list(tmp_path.glob("*.partial"))
