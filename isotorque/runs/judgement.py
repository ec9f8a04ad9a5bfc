"""A run held against the truth: what `isotorque run` reports."""

from __future__ import annotations

import math
import shlex
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.files.software_versions import software_versions
from isotorque.learning.learners.registry import EQUIVARIANT_LEARNERS
from isotorque.learning.learners.rigid.chain_watch import AGREES
from isotorque.learning.relations.reachable_relation import is_executable
from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet
from isotorque.runs.chain_model import taken_free, told
from isotorque.runs.options.run_options import CHAIN
from isotorque.runs.run_outcome import RunOutcome
from isotorque.symbolic.level_sets.level_curves import level_curves
from isotorque.symbolic.level_sets.level_set import level_set
from isotorque.verify.models.largest_errors import default_tolerance
from isotorque.verify.models.paper_targets import paper_targets
from isotorque.verify.models.target_sets import TargetSet
from isotorque.verify.models.verify_model import ModelJudgement, TargetResult, verify_model
from isotorque.verify.relations.learned_symmetries import (
    judge_relations,
    judge_symmetries,
    soundness,
)
from isotorque.verify.report.figures.learning_curves import LearningCurve
from isotorque.verify.report.figures.planar_links import planar_links
from isotorque.verify.report.report_sections import ChainReport, StaticTorqueReport
from isotorque.verify.report.run_report import (
    LevelSetReport,
    RunReport,
    RunSetup,
    Stage,
    SymmetryReport,
)
from isotorque.verify.report.summaries import (
    summarise_discovery,
    summarise_domain,
    summarise_exploration,
    summarise_static_torques,
)
from isotorque.verify.static_torques.judge_static_torques import MOST_JOINTS, judge_static_torques
from isotorque.verify.verdict import Status, Verdict

Array = NDArray[np.float64]

PAPER_RMSE = 0.0053
"""The paper's 2R result [N m] (section 7.1.1), drawn as a line to compare with."""
CURVE_TOLERANCE = 4e-4
"""Accuracy of the curves in pictures, of the joint's largest torque: finer than a line is wide."""
STATIC_TORQUES = 1000
"""Random torques that the set of static torques is judged with."""
EQUIVARIANCE = 1e-10
"""Departure from equivariance that counts as none, of the arm's largest torque."""


def judge_run(run: RunOutcome) -> RunReport:
    """Judge relations and model of a run, and gather everything its report shows.

    Parameters
    ----------
    run
        From `isotorque.runs.experiment.run_experiment`.

    Returns
    -------
    RunReport
    """
    symmetry = _symmetry(run)
    learned = run.options.symmetries == "learned"
    discovery = summarise_discovery(
        run.motions,
        run.scheme.gates,
        run.options.n_min,
        learned_anyway=run.options.learn_anyway,
        needs_gate=learned and not run.lattice_suffices,
    )
    verdicts: tuple[Verdict, ...] = ()
    if symmetry is not None and learned:
        verdicts = (soundness(symmetry),)
    if run.stops_before_learning:
        claim = f"at least {run.options.n_min} relations are known and confirmed before learning"
        verdicts += (Verdict(claim, Status.REFUTED, math.nan),)
    return RunReport(
        setup=_setup(run),
        stages=_stages(run),
        symmetry=symmetry,
        discovery=discovery,
        static_torques=_static_torques(run),
        domain=None if run.scheme.domain is None else summarise_domain(run.scheme.domain),
        exploration=None
        if not run.steps
        else summarise_exploration(
            run.steps, run.scheme.group, run.scheme.settings.exploration.step_width
        ),
        curves=_curves(run),
        goal=PAPER_RMSE if run.robot.name == "2r" else None,
        chain=_chain(run),
        model=_model(run),
        level_sets=_level_sets(run),
        verdicts=verdicts,
        remarks=_guided(run) + taken_free(run) + run.remarks + run.robot.warnings,
    )


def _guided(run: RunOutcome) -> tuple[str, ...]:
    if not run.options.guided_by_need:
        return ()
    return (
        f"{run.robot.name} cannot hold itself within its limits: it was guided (placed and held)",
    )


def _setup(run: RunOutcome) -> RunSetup:
    options = run.options
    command = [
        "isotorque",
        "run",
        options.robot.spec,
        "--out",
        "DIR",
        "--seed",
        str(options.arm.seed),
    ]
    command += ["--samples", str(options.samples)]
    command += [] if options.chain else ["--learner", options.learner]
    command += [
        "--strategy",
        options.strategy,
        "--symmetries",
        options.symmetries,
        "--n-min",
        str(options.n_min),
    ]
    command += ["--physics", options.arm.physics, "--engine", options.arm.engine]
    command += ["--settle", options.arm.settle, *options.robot.arguments()]
    for option, value in (
        ("--confirm", options.confirm),
        ("--angle-noise", options.arm.angle_noise),
        ("--torque-noise", options.arm.torque_noise),
        ("--encoder-step", options.arm.encoder_step),
    ):
        command += [option, str(value)] if value else []
    command += [word for each in options.settings.words for word in ("--set", each)]
    command += ["--learn-anyway"] if options.learn_anyway else []
    command += [] if options.tolerance is None else ["--tolerance", str(options.tolerance)]
    return RunSetup(
        robot=run.robot.name,
        digest=run.robot.digest,
        joint_names=run.robot.joint_names,
        physics=options.arm.physics,
        engine=options.arm.engine,
        strategy=options.strategy.replace("-", " ") + " (the arm guided)" * options.is_guided,
        learner=run.model_name or options.learner,
        symmetries=options.symmetries,
        seed=options.arm.seed,
        versions=tuple(sorted(software_versions().items())),
        command=shlex.join(command),
        unloaded=run.gravity.free_joints,
    )


def _stages(run: RunOutcome) -> tuple[Stage, ...]:
    motions, steps = run.motions, run.steps
    stages = (
        Stage("derive gravity and its symmetries", run.seconds["derivation"]),
        Stage(
            "discover symmetries",
            run.seconds["discovery"],
            len(motions),
            sum(m.outcome.seconds for m in motions),
        ),
    )
    if run.stops_before_learning:
        return stages
    learning = Stage(
        "learn the inverse statics model",
        run.seconds["learning"],
        len(steps),
        sum(s.outcome.seconds for s in steps),
    )
    return (*stages, learning)


def _symmetry(run: RunOutcome) -> SymmetryReport | None:
    scheme = run.scheme
    if run.options.symmetries == "none":
        return None
    if run.options.symmetries == "learned" and scheme.learned is not None:
        report = replace(
            judge_symmetries(scheme.learned, run.gravity, truth=run.group),
            secondary_pairs=sum(len(pairs) for pairs in scheme.learned.rejected),
            contradicted=len(scheme.learned.contradicted),
        )
    else:
        report = judge_relations(run.group, run.gravity, method="exact", truth=run.group)
    limits = run.arm.limits
    entries = [
        replace(entry, executable=is_executable(entry.relation, limits))
        for entry in report.relations
    ]
    return replace(report, relations=tuple(entries))


def _static_torques(run: RunOutcome) -> StaticTorqueReport:
    """Hold the estimated static torques against the true ones, where these can be drawn from."""
    estimate = run.scheme.static_torques
    report = summarise_static_torques(estimate)
    felt = run.robot.n - len(run.gravity.free_joints)
    if not 1 <= felt <= MOST_JOINTS:
        return report
    discovered = StaticTorqueSet(run.robot.n)
    for outcome in (motion.outcome for motion in run.motions):
        settled = outcome.kind is OutcomeKind.SETTLED
        (discovered.add if settled else discovered.mark_inadmissible)(outcome.torque)
    first, last = (
        judge_static_torques(
            torques,
            run.gravity,
            run.arm.limits,
            stable_only=run.options.arm.physics == "open_loop",  # nothing else holds it elsewhere
            samples=STATIC_TORQUES,
        )
        for torques in (discovered, estimate)
    )
    return replace(report, discovered=first, judgement=last)


def _chain(run: RunOutcome) -> ChainReport | None:
    known = run.knowledge
    if known is None:
        return None
    accepted = known.learner is not None
    beside = accepted and run.options.learner != CHAIN and bool(run.curve)
    _, torques = run.scheme.chain.samples
    return ChainReport(
        accepted,
        known.said,
        known.poses,
        known.known_after,
        known.later,
        known.largest_error,
        known.largest_error <= AGREES * float(np.abs(torques).max(initial=0.0)),
        told(run.scheme.settings.parents),
        instead="" if accepted or run.model is None else run.model_name,
        beside=run.options.learner if beside else "",
        beside_samples=run.curve[-1].samples if beside else 0,
        beside_rmse=run.curve[-1].rmse if beside else math.nan,
    )


def _curves(run: RunOutcome) -> tuple[LearningCurve, ...]:
    led = run.options.leader == CHAIN  # one point, if that, is no curve
    if len(run.curve) < (2 if led else 1):
        return ()
    samples = np.array([float(p.samples) for p in run.curve])
    rmse = np.array([p.rmse for p in run.curve])
    return (LearningCurve(f"{run.options.learner}, dense set", samples, rmse),)


def _model(run: RunOutcome) -> ModelJudgement | None:
    if run.model is None:
        return None
    targets = [*paper_targets(run.robot)]
    domain = run.scheme.domain
    if domain is not None:
        # most targets are unstable; their symmetric copies where the arm explored need not be
        targets += [
            TargetSet(f"{t.name}, copies in the BCTS explored", domain.representatives(t.q).q)
            for t in targets
        ]
    # most learners only come near equivariance: that is measured, but nobody claims it
    allowed = run.options.tolerance
    tolerance = default_tolerance(run.gravity, run.robot.limits) if allowed is None else allowed
    largest = float(run.gravity.potential.gradient_bound().max(initial=0.0))
    claimed = run.model_name in EQUIVARIANT_LEARNERS and run.scheme.group is not None
    judgement = verify_model(
        run.model,
        run.gravity,
        limits=run.robot.limits,
        group=run.scheme.group,
        orbits=run.group,
        targets=targets,
        tolerance=tolerance,
        largest_tolerance=tolerance,
        equivariance_tolerance=EQUIVARIANCE * largest if claimed else None,
    )
    named = {t.name: t for t in targets}
    results = tuple(
        _maintained(run, result, named[result.name]) if result.name in named else result
        for result in judgement.targets
    )
    return replace(judgement, targets=results)


def _maintained(run: RunOutcome, result: TargetResult, targets: TargetSet) -> TargetResult:
    """Count the targets the arm keeps when placed there and given the learned torque."""
    torques = np.asarray(run.model.predict(targets.q))
    low, high = run.robot.limits.T
    inside = np.all((targets.q > low) & (targets.q < high), axis=1)
    held = sum(
        run.arm.place_and_hold(q, tau).held
        for q, tau in zip(targets.q[inside], torques[inside], strict=True)
    )
    return replace(result, held=int(held))


def _level_sets(run: RunOutcome) -> LevelSetReport | None:
    """Show all configurations of the first target torque, for arms small enough to look at."""
    if not run.scheme.targets or run.robot.n > 3:
        return None
    # of all torques held, the one nearest to 40 % of each range: far from folds, easy to read
    _, held = run.scheme.samples
    span = np.where(run.scheme.torque_range > 0, run.scheme.torque_range, 1.0)
    target = held[int(np.argmin(np.abs(np.abs(held) / span - 0.4).max(axis=1)))]
    potential = run.gravity.potential.to_float()
    found = level_set(potential, target, group=run.group)
    curves: list[tuple[int, int, Array]] = []
    if run.robot.n == 2 and run.group.rank == 2:
        for joint, bound in enumerate(potential.gradient_bound().tolist()):
            accuracy = CURVE_TOLERANCE * bound
            lines = level_curves(potential, joint, float(target[joint]), tolerance=accuracy)
            signs = np.sign(lines.torques).astype(int)
            curves += [(joint, int(s), c) for s, c in zip(signs, lines.curves, strict=True)]
    return LevelSetReport(
        torque=np.abs(target),
        q=found.configurations,
        sets=found.primary_sets,
        stable=found.stable,
        curves=tuple(curves),
        links=planar_links(run.robot.model, found.configurations),
        complete=found.complete,
    )
