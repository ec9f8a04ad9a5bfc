"""The JSON form of a run's report."""

from __future__ import annotations

import dataclasses
import math
from enum import Enum
from typing import Any

import numpy as np

from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.verify.relations.learned_symmetries import SymmetryReport
from isotorque.verify.relations.relation_files import relations_document
from isotorque.verify.relations.verify_relation import describe_relation
from isotorque.verify.report.report_sections import ExplorationReport
from isotorque.verify.report.run_report import RunReport
from isotorque.verify.verdict import Verdict

FORMAT = 1
"""Number of the document's form; grows when entries change their meaning."""


def report_document(report: RunReport) -> dict[str, Any]:
    """Return a report as plain numbers, strings, lists and dictionaries.

    Parameters
    ----------
    report
        Of a run.

    Returns
    -------
    dict
        ``format``, ``passed``, ``summary`` (what holds and what does not), ``verdicts`` (as
        ``verify --json`` has them), ``totals``, and one entry per part, named and nested as the
        fields of `RunReport`. Numbers that are not finite are null. Configurations reached by
        symmetry alone are counted, not listed.

    Examples
    --------
    >>> from isotorque.verify.report.run_report import RunSetup
    >>> setup = RunSetup("2r", "", ("a", "b"), "open_loop", "compiled", "", "", "learned", 0)
    >>> report_document(RunReport(setup))["setup"]["robot"]
    '2r'
    """
    document = {
        "format": FORMAT,
        "passed": report.passed,
        "summary": list(report.summary),
        "verdicts": [verdict.to_json() for verdict in report.all_verdicts],
        "totals": totals(report),
    }
    for field in dataclasses.fields(report):
        if field.name != "verdicts":
            document[field.name] = plain(getattr(report, field.name))
    return document


def totals(report: RunReport) -> dict[str, Any]:
    """Return the numbers a reader asks for first; None where a run has no such number."""
    symmetry, discovery, model = report.symmetry, report.discovery, report.model
    return {
        "relations_found": None if symmetry is None else symmetry.found,
        "relations_false": None if symmetry is None else symmetry.false,
        "relations_true": None if symmetry is None else symmetry.truth.order,
        "discovery_motions": None if discovery is None else discovery.profiles + discovery.babbling,
        "chain_poses": None if report.chain is None else report.chain.known_after,
        "learning_samples": None if report.exploration is None else report.exploration.settled,
        "rmse_torque": None if model is None else plain(model.rmse),
        "rmse_by_joint": None if model is None else plain(model.rmse_by_joint),
        "largest_error": None if model is None else plain(float(model.largest_error.max())),
        "seconds": sum(stage.seconds for stage in report.stages),
        "simulated_seconds": sum(stage.simulated_seconds or 0.0 for stage in report.stages),
    }


def plain(value: Any) -> Any:
    """Return a value of a report as JSON has it."""
    special = _special(value)
    if special is not None:
        return special
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    if isinstance(value, Enum):
        return str(value)
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value


def _special(value: Any) -> Any:
    if isinstance(value, Verdict):
        return value.to_json()
    if isinstance(value, SymmetryRelation):
        form = relations_document([value], [])["relations"][0]
        return {"map": describe_relation(value), **form}
    if isinstance(value, SymmetryGroup):
        names = [f"q{i + 1}" for i in range(value.n)]
        document = relations_document(value, names)
        del document["joints"]
        return document
    if isinstance(value, SymmetryReport):
        entries = {f.name: plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
        return {
            "found": value.found,
            "false": value.false,
            "complete": value.complete,
            **entries,
        }
    if isinstance(value, ExplorationReport):
        names = [f.name for f in dataclasses.fields(value) if f.name != "images"]
        entries = {name: plain(getattr(value, name)) for name in names}
        return {**entries, "images_drawn": len(value.images)}
    return None
