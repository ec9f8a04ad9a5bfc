"""A learned model and how it came about: saved, judged, told."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from isotorque.runs.chain_model import chain_remarks
from isotorque.runs.experiment import save_learner
from isotorque.runs.learning_curve import CurvePoint
from isotorque.runs.options.run_options import RunOptions
from isotorque.runs.run_outcome import RunOutcome
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.verify.models.verify_model import verify_model


@dataclass(frozen=True, eq=False)
class LearnedModel:
    """Result of ``isotorque learn``.

    Attributes
    ----------
    robot : Robot
        The arm.
    gravity : GravityModel
        The truth that the model is judged against.
    learner
        The model: ``predict(q)``; None where nothing was learned.
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

    def save(self, out: Path) -> Path | None:
        """Write the model, if there is one, to a directory; return the path of its JSON."""
        if self.learner is None:
            return None
        return save_learner(self.learner, self.robot, self.choices, out)

    def document(self, model: Path | None) -> dict[str, Any]:
        """Judge the model, saved at a path; return all there is to tell, for JSON."""
        return {
            "robot": self.robot.name,
            "robot_options": self.robot.options.as_json(),
            "warnings": list(self.robot.warnings),
            **self.choices,
            "samples": self.samples,
            "discovery_motions": self.discovery_motions,
            "relations": self.relations,
            **self._errors(),
            "largest_torque": float(np.max(self.largest_torques())),
            "curve": [
                {"samples": p.samples, "rmse": p.rmse, "largest": p.largest} for p in self.curve
            ],
            "remarks": list(self.remarks),
            **self.details,
            "model": None if model is None else str(model),
        }

    def _errors(self) -> dict[str, Any]:
        """Torque errors of all joints; null where nothing was learned."""
        names = ("rmse_torque", "rmse_by_joint", "largest_error", "largest_error_by_joint", "test")
        if self.learner is None:
            return dict.fromkeys(names)
        judged = verify_model(self.learner, self.gravity, limits=self.robot.limits)
        largest, found = float(judged.largest_error.max()), judged.largest_error
        values = (judged.rmse, judged.rmse_by_joint, largest, found, judged.targets[0].name)
        return dict(zip(names, values, strict=True))

    def largest_torques(self) -> Any:
        """Bounds of the true torques, (n,) [N m]."""
        return self.gravity.potential.to_float().gradient_bound()


def model_of_run(run: RunOutcome) -> LearnedModel:
    """Return what an exploration ended with."""
    group = run.scheme.group
    return LearnedModel(
        run.robot,
        run.gravity,
        run.model,
        choices(run.options, run.gate_passed),
        len(run.steps),
        len(run.motions),
        1 if group is None else group.order,
        tuple(run.curve),
        (*run.remarks, *chain_remarks(run), *missing_symmetries(run), *gate_remarks(run)),
        run.details,
    )


def choices(options: RunOptions, gate_passed: bool) -> dict[str, Any]:
    """Return what was chosen, as it is kept with the model."""
    chosen = {k: getattr(options, k) for k in ("strategy", "learner", "symmetries")}
    if options.learn_anyway and not gate_passed:
        chosen["learn_anyway"] = True
    return chosen


def gate_remarks(run: RunOutcome) -> tuple[str, ...]:
    """Say that too little was known of the symmetries to begin learning, and what came of it."""
    if run.gate_passed:
        return ()
    gates, needed = run.scheme.gates, run.options.n_min
    if not gates:
        known = "no torque was held that shows any"
    elif gates[-1].order < needed:
        known = f"{gates[-1].order} known after {gates[-1].targets} target torques"
    else:
        known = f"{gates[-1].order} known after {gates[-1].targets} target torques, not confirmed"
    ending = (
        "learned anyway (--learn-anyway)"
        if run.options.learn_anyway
        else "nothing learned; --learn-anyway learns all the same"
    )
    return (f"gate before learning not passed: {needed} relations needed, {known}: {ending}",)


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
