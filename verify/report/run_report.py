"""What the report of a run shows."""

from __future__ import annotations

from dataclasses import dataclass, field

from isotorque.verify.models.verify_model import ModelJudgement
from isotorque.verify.relations.learned_symmetries import SymmetryReport
from isotorque.verify.report.figures.learning_curves import LearningCurve
from isotorque.verify.report.report_sections import (
    DiscoveryReport,
    DomainReport,
    ExplorationReport,
    LevelSetReport,
    StaticTorqueReport,
)
from isotorque.verify.report.what_holds import what_holds
from isotorque.verify.verdict import Verdict, all_passed


@dataclass(frozen=True)
class RunSetup:
    """What was run, with what.

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
