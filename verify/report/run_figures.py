"""The pictures of a run's report."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from isotorque.verify.report.figures.configurations import domain_map, explored_map
from isotorque.verify.report.figures.learning_curves import learning_curves
from isotorque.verify.report.figures.level_sets import level_set_map, stick_figure
from isotorque.verify.report.figures.torques import (
    joint_trajectories,
    static_torque_map,
    torque_profiles,
)
from isotorque.verify.report.report_sections import LevelSetReport
from isotorque.verify.report.run_report import RunReport

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure with its place in the report and its words.

    Attributes
    ----------
    name : str
        Short name, unique in a report; also the name of its file.
    section : str
        Section of the report it stands in.
    caption : str
        What it shows, in full sentences.
    figure : Figure
    wide : bool
        Whether it takes the whole width.
    """

    name: str
    section: str
    caption: str
    figure: Figure
    wide: bool = False


def report_pictures(report: RunReport) -> list[Picture]:
    """Draw every picture that the parts of a report allow.

    Parameters
    ----------
    report
        Of a run; parts that are None have no pictures.

    Returns
    -------
    list of Picture
        In the order of the report.
    """
    return [*_symmetry(report), *_discovery(report), *_learning(report)]


def _symmetry(report: RunReport) -> Iterator[Picture]:
    found = report.level_sets
    if found is None or not len(found.q):
        return
    torque = ", ".join(f"{x:.4g}" for x in found.torque)
    many = f"{'All' if found.complete else 'At least these'} {len(found.q)} configurations"
    labels = _numbers(found)
    if found.links is not None:
        caption = (
            f"{many} with |g(q)| = |({torque})| Nm, in primary sets (Fig. 2A). "
            "Solid: the arm can hold itself there; dashed: it cannot."
        )
        figure = stick_figure(found.links, found.sets, labels=labels, stable=found.stable)
        yield Picture("fig2a-configurations", "level_sets", caption, figure, wide=True)
    if found.q.shape[1] == 2:
        caption = (
            "Component-wise level sets (Eq. 6 and 7); their intersections are the symmetric "
            "configurations (Fig. 2B). Filled: stable; hollow: unstable."
        )
        figure = level_set_map(
            found.curves, found.q, found.sets, labels=labels, stable=found.stable
        )
        yield Picture("fig2b-level-sets", "level_sets", caption, figure)


def _numbers(found: LevelSetReport) -> list[str]:
    counts: dict[int, int] = {}
    labels = []
    for index in found.sets.tolist():
        counts[index] = counts.get(index, 0) + 1
        labels.append(str(counts[index]))
    return labels


def _loaded(report: RunReport) -> tuple[list[int], str]:
    """Numbers of the joints that pictures show, and the words on those left out."""
    setup = report.setup
    joints = [i for i, name in enumerate(setup.joint_names) if name not in setup.unloaded]
    names = ", ".join(setup.unloaded)
    return joints, f" Left out, as gravity does not load it: {names}." if names else ""


def _discovery(report: RunReport) -> Iterator[Picture]:
    joints, left_out = _loaded(report)
    if report.discovery is not None and report.discovery.traces:
        traces = report.discovery.traces
        words = f"{len(traces)} torque profiles that start and end at the same torque up to signs"
        figure = torque_profiles(traces, joints=joints)
        yield Picture("fig3-torque-profiles", "discovery", f"{words} (Fig. 3).{left_out}", figure)
        caption = (
            "The motion they led to (Fig. 4). Dots: where the arm settled under the last torque; "
            "red crosses: a joint limit was met or it did not settle, and went home."
        )
        figure = joint_trajectories(traces, joints=joints)
        yield Picture("fig4-joint-trajectories", "discovery", caption + left_out, figure)
    torques = report.static_torques
    if torques is not None and len(torques.admissible) and len(joints) > 1:
        shaded = torques.triangles is not None
        caption = "Set of static torques as the arm found it (SST, Fig. 7)." + (
            " Shaded: the region that exploration is kept in." if shaded else ""
        )
        figure = static_torque_map(
            torques.admissible, torques.inadmissible, triangles=torques.triangles, joints=joints
        )
        wide = len(joints) > 2
        yield Picture("fig7-static-torques", "discovery", caption + left_out, figure, wide=wide)
    domain = report.domain
    if domain is not None and domain.polygon is not None:
        caption = (
            f"The domain that was explored (BCTS, Fig. 6): 1/{domain.order} of all configurations."
        )
        figure = domain_map(domain.polygon, images=domain.images, center=domain.center)
        yield Picture("fig6-bcts", "learning", caption, figure)


def _learning(report: RunReport) -> Iterator[Picture]:
    explored = report.exploration
    joints, left_out = _loaded(report)
    if explored is not None and len(explored.explored) and len(joints) > 1:
        polygon = None if report.domain is None else report.domain.polygon
        caption = "Explored configurations, and those learned from them by symmetry (Fig. 10)."
        figure = explored_map(explored.explored, explored.images, domain=polygon, joints=joints)
        wide = len(joints) > 2
        yield Picture("fig10-explored", "learning", caption + left_out, figure, wide=wide)
    if report.curves:
        caption = "Torque error against the number of samples learned from (Fig. 13)."
        known = None
        if report.chain is not None and report.chain.beside:
            known = report.chain.known_after
            caption += " Dotted: so many poses told a rigid chain everything."
        figure = learning_curves(report.curves, goal=report.goal, known=known)
        yield Picture("fig13-learning-curve", "learning", caption, figure)
