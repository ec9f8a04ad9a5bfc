"""What holds of a run and what does not, part by part, in one line each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from isotorque.verify.models.verify_model import Array, ModelJudgement, TargetResult
from isotorque.verify.relations.learned_symmetries import SymmetryReport
from isotorque.verify.report.report_sections import DiscoveryReport, StaticTorqueReport
from isotorque.verify.verdict import sizes

if TYPE_CHECKING:
    from isotorque.verify.report.run_report import RunReport


def what_holds(report: RunReport) -> tuple[str, ...]:
    """Say of relations, gate, static torques and model what holds and what does not.

    Parameters
    ----------
    report
        Of a run; parts that it does not have are said to be missing.

    Returns
    -------
    tuple of str
        One sentence part each, to be read as one line.
    """
    parts = [
        _relations(report.symmetry),
        _gate(report.discovery),
        _static_torques(report.static_torques),
        _model(report.model),
    ]
    return tuple(part for part in parts if part)


def _relations(symmetry: SymmetryReport | None) -> str:
    if symmetry is None:
        return "relations: none used"
    wrong = sum(not entry.verdict.passed for entry in symmetry.relations)
    false = f"{symmetry.false} false" if symmetry.false else "none false"
    if wrong > symmetry.false:
        false += f", {wrong} do not hold within the tolerance"
    missing = "" if symmetry.complete else "; not all that there are"
    return f"relations: {symmetry.found} of {symmetry.truth.order} known, {false}{missing}"


def _gate(discovery: DiscoveryReport | None) -> str:
    if discovery is None or discovery.gate_passed:
        return ""
    came = "learned anyway" if discovery.learned_anyway else "nothing learned"
    return f"gate of {discovery.n_min} relations before learning: not passed, {came}"


def _static_torques(torques: StaticTorqueReport | None) -> str:
    judged = None if torques is None else torques.discovered
    if judged is None:
        return "static torques: not judged"
    held = "can be held" if judged.stable_only else "are needed within the joint limits"
    return (
        f"static torques: {judged.coverage:.0%} of those that {held} are admitted after discovery, "
        f"{judged.false_share:.0%} of the admitted are none of them"
    )


def _model(model: ModelJudgement | None) -> str:
    if model is None:
        return "model: none"
    regions = [(model.targets[0], "on the whole space")]
    regions += [
        (t, "where an orbit has a stable member") for t in model.targets if t.is_stable_part
    ]
    words = [_region(result, where, model.tolerance) for result, where in regions]
    allowed = "" if model.tolerance is None else f" (allowed: {sizes(model.tolerance)} N m)"
    return f"model: {'; '.join(words)}{allowed}"


def _region(result: TargetResult, where: str, allowed: Array | None) -> str:
    errors = f"RMSE {result.rmse:.3g}, largest error {result.largest:.3g} N m"
    if allowed is None:
        return f"{errors} {where}"
    return f"{'holds' if result.holds(allowed) else 'does not hold'} {where}, {errors}"
