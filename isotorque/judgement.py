"""A run held against the truth: what `isotorque run` reports."""

from __future__ import annotations

import shlex
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from isotorque.experiment import RunOutcome
from isotorque.paper_targets import paper_targets
from learning.run_info import software_versions
from verify.figures.learning_curves import LearningCurve
from verify.learned_symmetries import completeness, judge_relations, judge_symmetries
from verify.models import ModelJudgement, TargetResult, verify_model
from verify.run_report import RunReport, RunSetup, Stage, SymmetryReport
from verify.run_summary import (
    summarise_discovery,
    summarise_domain,
    summarise_exploration,
    summarise_static_torques,
)
from verify.targets import TargetSet, dense_targets

Array = NDArray[np.float64]

PAPER_RMSE = 0.0053
"""The paper's 2R result [N m] (section 7.1.1), drawn as a line to compare with."""
EQUIVARIANCE = 0.01
"""Departure from equivariance that a model with learned relations is allowed [N m]."""


def judge_run(run: RunOutcome) -> RunReport:
    """Judge relations and model of a run, and gather everything its report shows.

    Parameters
    ----------
    run
        From `isotorque.experiment.run_experiment`.

    Returns
    -------
    RunReport
    """
    symmetry = _symmetry(run)
    verdicts = ()
    if symmetry is not None and run.options.symmetries == "learned":
        verdicts = (completeness(symmetry),)
    return RunReport(
        setup=_setup(run),
        stages=_stages(run),
        symmetry=symmetry,
        discovery=summarise_discovery(run.motions, run.scheme.gates, run.options.n_min),
        static_torques=summarise_static_torques(run.scheme.static_torques),
        domain=None if run.scheme.domain is None else summarise_domain(run.scheme.domain),
        exploration=summarise_exploration(run.steps, run.scheme.group),
        curves=_curves(run),
        goal=PAPER_RMSE if run.robot.name == "2r" else None,
        model=_model(run),
        verdicts=verdicts,
    )


def _setup(run: RunOutcome) -> RunSetup:
    options = run.options
    command = ["isotorque", "run", options.robot, "--out", "DIR", "--seed", str(options.seed)]
    command += ["--samples", str(options.samples), "--learner", options.learner]
    command += ["--symmetries", options.symmetries, "--n-min", str(options.n_min)]
    command += ["--physics", options.physics, "--engine", options.engine]
    command += ["--settle", options.settle] + ([] if options.snap else ["--no-snap"])
    return RunSetup(
        robot=run.robot.name,
        digest=run.robot.digest,
        joint_names=run.robot.joint_names,
        physics=options.physics,
        engine=options.engine,
        strategy="constrained direction sampling",
        learner=options.learner,
        symmetries=options.symmetries,
        seed=options.seed,
        versions=tuple(sorted(software_versions().items())),
        command=shlex.join(command),
    )


def _stages(run: RunOutcome) -> tuple[Stage, ...]:
    motions, steps = run.motions, run.steps
    return (
        Stage("derive gravity and its symmetries", run.seconds["derivation"]),
        Stage(
            "discover symmetries",
            run.seconds["discovery"],
            len(motions),
            sum(m.outcome.seconds for m in motions),
        ),
        Stage(
            "learn the inverse statics model",
            run.seconds["learning"],
            len(steps),
            sum(s.outcome.seconds for s in steps),
        ),
    )


def _symmetry(run: RunOutcome) -> SymmetryReport | None:
    scheme = run.scheme
    if run.options.symmetries == "none":
        return None
    if run.options.symmetries == "learned" and scheme.learned is not None:
        return judge_symmetries(scheme.learned, run.gravity, truth=run.group)
    return judge_relations(run.group, run.gravity, method="exact", truth=run.group)


def _curves(run: RunOutcome) -> tuple[LearningCurve, ...]:
    if not run.curve:
        return ()
    samples = np.array([float(p.samples) for p in run.curve])
    rmse = np.array([p.rmse for p in run.curve])
    return (LearningCurve(f"{run.options.learner}, dense set", samples, rmse),)


def _model(run: RunOutcome) -> ModelJudgement | None:
    if run.scheme.learner is None:
        return None
    targets = paper_targets(run.robot)
    held = _reachable(run)
    judgement = verify_model(
        run.scheme.learner,
        run.gravity,
        limits=run.robot.limits,
        group=run.scheme.group,
        targets=(*held, *targets),
        equivariance_tolerance=EQUIVARIANCE,
    )
    learned = {t.name: t for t in targets}
    results = tuple(
        _maintained(run, result, learned[result.name]) if result.name in learned else result
        for result in judgement.targets
    )
    return replace(judgement, targets=results)


def _reachable(run: RunOutcome) -> tuple[TargetSet, ...]:
    """Return the part of the dense set whose torque the arm can experience by itself.

    Open loop, an arm only rests at stable equilibria; a configuration none of whose symmetric
    copies is stable is out of reach of any learner, and so is its torque.
    """
    dense = dense_targets(run.robot.limits).q
    images = run.group.orbit(dense)
    stable = np.array([_stable(run, image) for image in images]).any(axis=0)
    if stable.all() or not stable.any():
        return ()
    share = 100 * stable.mean()
    return (TargetSet(f"its part with a stable symmetric copy ({share:.0f} %)", dense[stable]),)


def _stable(run: RunOutcome, q: Array) -> NDArray[np.bool_]:
    """Say where the stiffness is positive definite on the coordinates that gravity depends on."""
    stiffness = run.gravity.stiffness(q)
    # K = B^T K_y B on y = B q: directions without gravity are left out
    inverse = np.linalg.pinv(run.group.basis.astype(float))
    reduced = inverse.T @ stiffness @ inverse
    if reduced.shape[-1] == 0:
        return np.ones(q.shape[:-1], dtype=bool)
    return np.asarray(np.linalg.eigvalsh(reduced)[..., 0] > 0)


def _maintained(run: RunOutcome, result: TargetResult, targets: TargetSet) -> TargetResult:
    """Count the targets the arm keeps when placed there and given the learned torque."""
    learner = run.scheme.learner
    assert learner is not None
    torques = np.asarray(learner.predict(targets.q))
    inside = np.all(
        (targets.q > run.robot.limits[:, 0]) & (targets.q < run.robot.limits[:, 1]), axis=1
    )
    held = sum(
        run.arm.place_and_hold(q, tau).held
        for q, tau in zip(targets.q[inside], torques[inside], strict=True)
    )
    return replace(result, held=int(held), stable=int(_stable(run, targets.q).sum()))
