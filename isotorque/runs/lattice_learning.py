"""Learning from a lattice of configurations that a guided arm is placed at."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import Settled
from isotorque.learning.exploration.exploration import ExplorationStep
from isotorque.learning.exploration.targets import Phase
from isotorque.learning.learners.registry import ONLINE_LEARNERS, LearningTask, learner_by_name
from isotorque.learning.recordings.recorded_simulation import RecordedSimulation
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.sampling.reachable_lattice import ReachableLattice, reachable_lattice, visit
from isotorque.runs.chain_model import chain_curve, choose_model, is_usable, let_chain_lead
from isotorque.runs.experiment import LEARNING, Progress, discover_symmetries, prepare_run, timed
from isotorque.runs.learned_model import LearnedModel, model_of_run
from isotorque.runs.learning_curve import CurvePoint, DenseTest, curve_counts
from isotorque.runs.options.recorded_robot import keep_robot_file
from isotorque.runs.options.run_options import CHAIN, RunOptions
from isotorque.runs.run_outcome import RunOutcome
from isotorque.runs.stages import DATABASE, random_generator, run_info, simulated_arm
from isotorque.symbolic.common.single_thread import single_thread
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.robots.load_robot import Robot

Array = NDArray[np.float64]


def learn_from_lattice(options: RunOptions, out: Path, progress: Progress) -> LearnedModel:
    """Place the arm at a lattice of configurations, measure torques, learn from all of them.

    Parameters, errors and what is recorded as of `run_lattice`.

    Returns
    -------
    LearnedModel
    """
    return model_of_run(run_lattice(options, out, progress))


@single_thread()
def run_lattice(options: RunOptions, out: Path, progress: Progress) -> RunOutcome:
    """Visit a lattice of configurations with a guided arm, and learn from all of them at once.

    Parameters
    ----------
    options
        What to run; symmetries that are to be learned are discovered first, unless the arm has to
        be guided: then the lattice alone shows them.
    out
        Directory; every sample is committed to ``run.sqlite`` before the next motion begins. What
        is recorded there is not measured again.
    progress
        Called as ``progress(stage, done, total, note)``.

    Returns
    -------
    RunOutcome
        Without a learner where discovery and lattice told too little of the symmetries.

    Raises
    ------
    InputError
        For a robot or options that cannot be used, and for a directory that holds another run.
    """
    discovers = options.symmetries == "learned" and not options.guided_by_need
    run = discover_symmetries(options, out, progress) if discovers else prepare_run(options)
    run.seconds.setdefault("discovery", 0.0)
    with timed(run.seconds, "learning"):
        _learn(run, out, progress)
    return run


def _learn(run: RunOutcome, out: Path, progress: Progress) -> None:
    options, scheme = run.options, run.scheme
    lattice, q, torque = _sampled(options, run.robot, scheme.group, out, progress)
    if lattice.reachable < 1.0:
        share = 100 * (1 - lattice.reachable)
        run.remarks += (
            f"{share:.3g} % of the orbits lie outside the joint limits and were skipped",
        )
    if len(lattice.q) != options.samples:
        run.remarks += (
            f"{options.samples} samples asked for, a lattice of {len(lattice.q)} taken",
        )
    scheme.chain.partial_fit(q, torque)
    let_chain_lead(run)
    if options.symmetries == "learned":
        run.remarks += _with_more_samples(run, q, torque)
    if run.stops_before_learning:
        return
    run.details = {"reachable_share": lattice.reachable}
    run.steps = [_step(k, *sample) for k, sample in enumerate(zip(q, torque, strict=True))]
    group = scheme.group
    if group is not None and group.rank:
        scheme.domain = FundamentalDomain.near(group, run.arm.home)
    if run.options.leader == CHAIN:  # it has learned already, while the samples came in
        choose_model(run)
        run.curve = chain_curve(run)
        return
    scheme.learner, curve = fitted_with_curve(
        options.learner,
        options.task(run.robot.n),
        group,
        q,
        torque,
        DenseTest(run.robot, run.gravity),
    )
    run.curve = list(curve)
    choose_model(run)


def _step(number: int, q: Array, torque: Array) -> ExplorationStep:
    """One place of the lattice, told like a step of an exploration."""
    return ExplorationStep(
        number=number,
        phase=Phase.GOAL,
        target=q,
        torque=torque,
        projected=False,
        outcome=Settled(q, torque, 0.0),
        learned=True,
        weight=1.0,
        alpha=np.nan,
        turned=False,
        explored=None,
        window_error=None,
    )


def _with_more_samples(run: RunOutcome, q: Array, torque: Array) -> tuple[str, ...]:
    """Take over the relations that the lattice shows beside what the discovery showed; say so.

    A lattice was guided to places that the arm cannot hold by itself, so it may know better.
    """
    group = run.scheme.group
    known = 1 if group is None else group.order
    scheme = run.scheme
    held, torques = scheme.samples
    learned = scheme.relations(np.concatenate([held, q]), np.concatenate([torques, torque]))
    run.lattice_suffices = learned.decided and learned.order >= run.options.n_min
    free = learned.group.rank < learned.group.n
    if learned.order > known or (learned.order == known and (known > 1 or free)):
        run.scheme.learned = learned
        words = f"symmetries: {learned.order} known with the samples of the lattice"
        return (words,) if learned.order > known else ()
    if run.scheme.learned is None:
        run.scheme.learned = learned
    return ()


def _sampled(
    options: RunOptions, robot: Robot, group: SymmetryGroup | None, out: Path, progress: Progress
) -> tuple[ReachableLattice, Array, Array]:
    arm = simulated_arm(robot, options.arm, 1)
    rng = random_generator(options.arm, 1)
    lattice = reachable_lattice(group, robot.limits, options.samples, arm.q, rng)
    # the learner is left out: another one may use the same samples
    chosen = {k: getattr(options, k) for k in ("samples", "symmetries", "strategy")}
    info = run_info(robot, arm, options.arm, "learn", chosen)
    with Recording.open_or_create(out / DATABASE, info) as recording:
        keep_robot_file(options.robot, out)
        recorded = RecordedSimulation(arm, recording, phase="learning")
        held = []
        for outcome in visit(recorded, lattice.q):
            held.append(outcome)
            progress(LEARNING, len(held), len(lattice.q), "")
        recorded.finish()
    return lattice, np.array([h.q for h in held]), np.array([h.torque for h in held])


def fitted_with_curve(
    name: str,
    task: LearningTask,
    group: SymmetryGroup | None,
    q: Array,
    torque: Array,
    test: DenseTest,
) -> tuple[Any, tuple[CurvePoint, ...]]:
    """Fit a learner to samples, and to the first few of them for its learning curve.

    Parameters
    ----------
    name, task
        Of the learner, see `learner_by_name`.
    group
        Relations to exploit.
    q, torque : (m, n) arrays
        Samples [rad], [N m], in random order.
    test
        Where the error is measured.
    """
    learner: Any = None
    done, curve = 0, []
    for count in sorted(curve_counts(name, len(q))):
        if name in ONLINE_LEARNERS:
            learner = learner_by_name(name, group, task) if learner is None else learner
            learner.partial_fit(q[done:count], torque[done:count])
        else:
            learner = learner_by_name(name, group, task).fit(q[:count], torque[:count])
        done = count
        if is_usable(learner):
            curve.append(test.point(count, learner))
    return learner, tuple(curve)
