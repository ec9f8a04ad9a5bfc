"""Outcome of a run: everything it produced, for the judges."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.exploration.exploration import ExplorationStep
from isotorque.learning.learners.rigid.chain_watch import ChainKnowledge
from isotorque.learning.scheme import Discovery, Scheme
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.runs.learning_curve import CurvePoint
from isotorque.runs.options.run_options import RunOptions
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.robots.load_robot import Robot


@dataclass(eq=False)
class RunOutcome:
    """Everything a run produced, for the judges.

    Attributes
    ----------
    options : RunOptions
    robot : Robot
    gravity : GravityModel
        The truth.
    group : SymmetryGroup
        The true group.
    arm : SimulatedArm
        The simulated arm (to test on what was learned).
    scheme : Scheme
        The learner's side: relations, SST, BCTS, model.
    motions : list of Discovery
        The discovery phase.
    steps : list of ExplorationStep
        The learning phase.
    curve : list of CurvePoint
        RMSE on the dense set while learning.
    model, model_name
        The model that the run ends with and the name of its learner; None where there is none.
    knowledge : ChainKnowledge or None
        What is known of the rigid chain, where it was wanted.
    seconds : dict of str to float
        Wall-clock time of the stages [s].
    remarks : tuple of str
        What else the user should know.
    details : dict
        More for the JSON document of the model, plain data.
    lattice_suffices : bool
        Whether a lattice showed the relations that are needed.
    """

    options: RunOptions
    robot: Robot
    gravity: GravityModel
    group: SymmetryGroup
    arm: SimulatedArm
    scheme: Scheme
    motions: list[Discovery] = field(default_factory=list)
    steps: list[ExplorationStep] = field(default_factory=list)
    curve: list[CurvePoint] = field(default_factory=list)
    model: Any = None
    model_name: str = ""
    knowledge: ChainKnowledge | None = None
    seconds: dict[str, float] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    details: dict[str, Any] = field(default_factory=dict)
    lattice_suffices: bool = False

    @property
    def gate_passed(self) -> bool:
        """Whether discovery or lattice told enough to begin learning (n_sym >= n_min)."""
        return self.scheme.gate_passed or self.lattice_suffices

    @property
    def stops_before_learning(self) -> bool:
        """Whether nothing is learned, because too little is known of the symmetries."""
        return not (self.gate_passed or self.options.learn_anyway)

    def ends(self) -> dict[OutcomeKind, int]:
        """How the motions of the discovery ended."""
        kinds = [motion.outcome.kind for motion in self.motions]
        return {kind: kinds.count(kind) for kind in OutcomeKind}
