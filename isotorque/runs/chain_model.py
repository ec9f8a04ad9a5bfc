"""Choice of a run's model: the rigid chain, if accepted, or what was learned beside it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from isotorque.learning.learners.registry import learner_by_name
from isotorque.runs.learning_curve import CurvePoint, DenseTest
from isotorque.runs.options.run_options import CHAIN, FEW_JOINTS, RunOptions, default_learner
from isotorque.runs.run_outcome import RunOutcome


def told_parents(run_parents: tuple[int, ...]) -> tuple[int, ...] | None:
    """What a chain is told of the joints: nothing where they are in series.

    Examples
    --------
    >>> told_parents((-1, 0, 1)), told_parents((-1, 0, 0))
    (None, (-1, 0, 0))
    """
    serial = tuple(range(-1, len(run_parents) - 1))
    return None if tuple(run_parents) == serial else tuple(int(p) for p in run_parents)


def is_wanted(options: RunOptions) -> bool:
    """Whether a rigid chain is to be the model, if one is accepted."""
    return options.chain or options.learner == CHAIN


def let_chain_lead(run: RunOutcome) -> None:
    """Let the chain lead the exploration, where joints are many and later samples confirm it.

    The paper's learners are for its arms: beyond, thousands of samples teach them less than a
    handful teaches the chain.
    """
    many = run.robot.n > FEW_JOINTS
    if run.options.chain and many and run.scheme.chain.confirmed is not None:
        run.options = replace(run.options, learner=CHAIN, samples=run.options.chain_samples)
        run.scheme.settings = replace(run.scheme.settings, samples=run.options.samples)


def choose_model(run: RunOutcome) -> None:
    """Take the chain for the model of a run that has learned, or say why not.

    Where a chain that led was contradicted in the end, the learner for that many joints is fitted
    to all that has settled; where a chain was asked for by name, there is no model then.
    """
    scheme = run.scheme
    run.model, run.model_name = scheme.learner, run.options.learner
    if not is_wanted(run.options):
        return
    run.knowledge = known = scheme.chain.knowledge()
    if known.learner is not None:
        run.model, run.model_name = known.learner, CHAIN
    elif run.options.leader == CHAIN:
        run.model_name = default_learner(run.options.strategy, run.robot.n)
        task = replace(run.options.task(run.robot.n), parameters={})
        q, torque = scheme.chain.samples
        run.model = learner_by_name(run.model_name, scheme.group, task).fit(q, torque)
    elif run.options.learner == CHAIN and not is_usable(scheme.learner):
        run.model = None


def is_usable(learner: Any) -> bool:
    """Whether a fitted learner answers: a rigid chain does not before it is accepted."""
    verdict = getattr(learner, "verdict_", None)
    return verdict is None or bool(verdict.accepted)


def chain_curve(run: RunOutcome) -> list[CurvePoint]:
    """Errors of every chain that was accepted, by the number of poses it was learned from."""
    test = DenseTest(run.robot, run.gravity)
    return [test.point(poses, learner) for poses, learner in run.scheme.chain.fits()]


def chain_remarks(run: RunOutcome) -> tuple[str, ...]:
    """Say what the chain knew after how many poses, or why there is none."""
    known = run.knowledge
    if known is None:
        return ()
    named = f"rigid chain, told {told(run.scheme.settings.parents)}"
    if known.learner is None:
        instead = "nothing learned" if run.model is None else f"the model is {run.model_name}"
        return (f"{named}: not accepted, {known.said}; {instead}",)
    return (
        *taken_free(run),
        f"{named}: knew the whole map after {known.known_after} poses, "
        f"{known.later} later samples agree with it",
    )


def taken_free(run: RunOutcome) -> tuple[str, ...]:
    """Name the joints that the chain takes to be free of gravity without having seen them move."""
    known = run.knowledge
    if known is None or known.learner is None or not known.taken_free:
        return ()
    names = ", ".join(run.robot.joint_names[joint] for joint in known.taken_free)
    return (f"joints that hold no torque and never moved are taken to be free of gravity: {names}",)


def told(parents: tuple[int, ...] | None) -> str:
    """What the learner is told of the arm, in words.

    Examples
    --------
    >>> told(None)
    'the number of joints alone'
    """
    if parents is None:
        return "the number of joints alone"
    return "the number of joints and which of them carries which"
