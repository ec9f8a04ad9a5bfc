"""Report of a run."""

from __future__ import annotations

from dataclasses import dataclass, field

from isotorque.verify.models.verify_model import Array, ModelJudgement, TargetResult
from isotorque.verify.relations.learned_symmetries import SymmetryReport
from isotorque.verify.report.figures.learning_curves import LearningCurve
from isotorque.verify.report.report_sections import (
    ChainReport,
    DiscoveryReport,
    DomainReport,
    ExplorationReport,
    LevelSetReport,
    StaticTorqueReport,
)
from isotorque.verify.verdict import Verdict, all_passed, sizes


@dataclass(frozen=True)
class RunSetup:
    """Robot, arm and options of a run.

    Attributes
    ----------
    robot, digest : str
        Name of the robot, and its identity.
    joint_names : tuple of str
        Joints in the order of all arrays.
    physics, engine : str
        Physics mode and engine of the arm.
    strategy, learner, symmetries : str
        Exploration strategy, learner, and which symmetries it used ("learned", "exact", "none").
    seed : int or None
        Seed of the run.
    versions : tuple of (str, str)
        Software and its version.
    command : str
        The command line that makes this run again; may be empty.
    created : str
        Date and time of the run; may be empty.
    unloaded : tuple of str
        Joints that gravity does not load; pictures leave them out.
    """

    robot: str
    digest: str
    joint_names: tuple[str, ...]
    physics: str
    engine: str
    strategy: str
    learner: str
    symmetries: str
    seed: int | None
    versions: tuple[tuple[str, str], ...] = ()
    command: str = ""
    created: str = ""
    unloaded: tuple[str, ...] = ()


@dataclass(frozen=True)
class Stage:
    """One stage of the scheme and what it cost.

    Attributes
    ----------
    name : str
        What was done.
    seconds : float
        Wall clock time [s].
    motions : int or None
        Torques or profiles the arm was given; None where it did not move.
    simulated_seconds : float or None
        Time that passed on the arm [s].
    """

    name: str
    seconds: float
    motions: int | None = None
    simulated_seconds: float | None = None


@dataclass(frozen=True, eq=False)
class RunReport:
    """Everything a run's report shows; a part that a run did not have is None.

    Attributes
    ----------
    setup : RunSetup
    stages : tuple of Stage
    symmetry : SymmetryReport or None
    discovery : DiscoveryReport or None
    static_torques : StaticTorqueReport or None
    domain : DomainReport or None
    exploration : ExplorationReport or None
    curves : tuple of LearningCurve
    goal : float or None
        Torque RMSE to compare the curves with [N m].
    chain : ChainReport or None
        Where a rigid chain was looked for.
    model : ModelJudgement or None
    level_sets : LevelSetReport or None
    verdicts : tuple of Verdict
        Verdicts besides those of relations and model.
    remarks : tuple of str
        What else the reader should know of how the run was made.
    """

    setup: RunSetup
    stages: tuple[Stage, ...] = ()
    symmetry: SymmetryReport | None = None
    discovery: DiscoveryReport | None = None
    static_torques: StaticTorqueReport | None = None
    domain: DomainReport | None = None
    exploration: ExplorationReport | None = None
    curves: tuple[LearningCurve, ...] = ()
    goal: float | None = None
    chain: ChainReport | None = None
    model: ModelJudgement | None = None
    level_sets: LevelSetReport | None = None
    verdicts: tuple[Verdict, ...] = field(default=())
    remarks: tuple[str, ...] = ()

    @property
    def all_verdicts(self) -> tuple[Verdict, ...]:
        """Every verdict of the run."""
        relations = () if self.symmetry is None else self.symmetry.relations
        model = () if self.model is None else self.model.verdicts
        return (*(entry.verdict for entry in relations), *model, *self.verdicts)

    @property
    def summary(self) -> tuple[str, ...]:
        """What holds and what does not, part by part."""
        return what_holds(self)

    @property
    def passed(self) -> bool:
        """Whether every claim stands."""
        return all_passed(self.all_verdicts)


def what_holds(report: RunReport) -> tuple[str, ...]:
    """Say of relations, gate, static torques, chain and model what holds and what does not.

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
        _chain(report.chain),
        _model(report.model),
        _beside(report.chain),
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


def _chain(chain: ChainReport | None) -> str:
    if chain is None:
        return ""
    told = f"rigid chain, told {chain.told}"
    if not chain.accepted:
        instead = f"the model is {chain.instead}" if chain.instead else "nothing learned"
        return f"{told}: not accepted, {chain.said}; {instead}"
    return f"{told}: knew the whole map after {chain.known_after} poses, {chain.tried}"


def _beside(chain: ChainReport | None) -> str:
    if chain is None or not chain.beside:
        return ""
    return (
        f"beside it {chain.beside}: RMSE {chain.beside_rmse:.3g} N m after "
        f"{chain.beside_samples} samples"
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
