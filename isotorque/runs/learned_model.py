"""A learned model and how it came about: saved, judged, told."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from isotorque.runs.experiment import RunOutcome, save_learner
from isotorque.runs.learning_curve import CurvePoint
from symbolic.gravity import GravityModel
from symbolic.robots import Robot
from verify.models import verify_model


@dataclass(frozen=True, eq=False)
class LearnedModel:
    """What ``isotorque learn`` ends with.

    Attributes
    ----------
    robot : Robot
        The arm.
    gravity : GravityModel
        The truth that the model is judged against.
    learner
        The model: ``predict(q)``.
    choices : dict
        Strategy, learner, symmetries: what was chosen, plain data.
    samples : int
        Samples taken for learning, those of the discovery not counted.
    discovery_motions : int
        Motions of the discovery.
    relations : int
        Symmetry relations that were exploited; 1 without symmetries.
    curve : tuple of CurvePoint
        Error while the samples came in.
    remarks : tuple of str
        What the user should know.
    details : dict
        More for the JSON document.
    """

    robot: Robot
    gravity: GravityModel
    learner: Any
    choices: dict[str, Any]
    samples: int
    discovery_motions: int
    relations: int
    curve: tuple[CurvePoint, ...]
    remarks: tuple[str, ...] = ()
    details: dict[str, Any] = field(default_factory=dict)

    def save(self, out: Path) -> Path:
        """Write the model to a directory; return the path of its JSON."""
        return save_learner(self.learner, self.robot, self.choices, out)

    def document(self, model: Path) -> dict[str, Any]:
        """Judge the model, saved at a path; return all there is to tell, for JSON."""
        judged = verify_model(self.learner, self.gravity, limits=self.robot.limits)
        return {
            "robot": self.robot.name,
            **self.choices,
            "samples": self.samples,
            "discovery_motions": self.discovery_motions,
            "relations": self.relations,
            "rmse_torque": judged.rmse,
            "rmse_by_joint": judged.rmse_by_joint,
            "test": judged.targets[0].name,
            "largest_torque": float(np.max(self.largest_torques())),
            "curve": [{"samples": p.samples, "rmse": p.rmse} for p in self.curve],
            "remarks": list(self.remarks),
            **self.details,
            "model": str(model),
        }

    def largest_torques(self) -> Any:
        """Bounds of the true torques, (n,) [N m]."""
        return self.gravity.potential.to_float().gradient_bound()


def model_of_run(run: RunOutcome) -> LearnedModel:
    """Return what an exploration ended with."""
    options, group = run.options, run.scheme.group
    return LearnedModel(
        run.robot,
        run.gravity,
        run.scheme.learner,
        {k: getattr(options, k) for k in ("strategy", "learner", "symmetries")},
        len(run.steps),
        len(run.motions),
        1 if group is None else group.order,
        tuple(run.curve),
        missing_symmetries(run),
    )


def missing_symmetries(run: RunOutcome) -> tuple[str, ...]:
    """Say what the discovery could not find out, if symmetries were to be learned."""
    learned = run.scheme.learned
    if run.options.symmetries != "learned":
        return ()
    if learned is None:
        motions = len(run.motions)
        return (f"symmetries: none known; in {motions} motions no torque was held that shows any",)
    if learned.missing is None:
        return ()
    return (f"symmetries: {learned.order} known; {learned.missing}",)
