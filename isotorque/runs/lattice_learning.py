"""Learning from a lattice of configurations that a guided arm is placed at."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.runs.experiment import (
    LEARNING,
    Progress,
    RunOutcome,
    discover_symmetries,
)
from isotorque.runs.learned_model import (
    LearnedModel,
    choices,
    gate_remarks,
    missing_symmetries,
    model_of_run,
)
from isotorque.runs.learning_curve import CurvePoint, DenseTest, curve_counts
from isotorque.runs.robot_copy import keep_robot_file
from isotorque.runs.run_options import RunOptions
from isotorque.runs.stages import DATABASE, random_generator, run_info, simulated_arm
from isotorque.single_thread import single_thread
from learning.learners.by_name import ONLINE_LEARNERS, LearningTask, learner_by_name
from learning.recordings.recorded_simulation import RecordedSimulation
from learning.recordings.recording import Recording
from learning.relations.relation_learning import learn_relations
from learning.sampling.reachable_lattice import ReachableLattice, reachable_lattice, visit
from symbolic.gravity import GravityModel
from symbolic.relations import SymmetryGroup
from symbolic.robots import Robot, load_robot
from symbolic.symmetries import primary_symmetries

Array = NDArray[np.float64]


@single_thread()
def learn_from_lattice(options: RunOptions, out: Path, progress: Progress) -> LearnedModel:
    """Place the arm at a lattice of configurations, measure torques, learn from all of them.

    Parameters
    ----------
    options
        What to run; symmetries that are to be learned are discovered first.
    out
        Directory; every sample is committed to ``run.sqlite`` before the next motion begins. What
        is recorded there is not measured again.
    progress
        Called as ``progress(stage, done, total, note)``.

    Returns
    -------
    LearnedModel
        Without a learner where discovery and lattice told too little of the symmetries.

    Raises
    ------
    InputError
        For a robot or options that cannot be used, and for a directory that holds another run.
    """
    remarks: tuple[str, ...] = ()
    enough = True
    found: RunOutcome | None = None
    if options.symmetries == "learned":
        found = discover_symmetries(options, out, progress)
        robot, gravity, group = found.robot, found.gravity, found.scheme.group
        remarks = missing_symmetries(found)
    else:
        robot = load_robot(options.robot)
        gravity = GravityModel(robot)
        exact = options.symmetries == "exact"
        group = primary_symmetries(gravity.potential) if exact else None
    lattice, q, torque = _sampled(options, robot, group, out, progress)
    if lattice.reachable < 1.0:
        share = 100 * (1 - lattice.reachable)
        remarks += (f"{share:.3g} % of the orbits lie outside the joint limits and were skipped",)
    if len(lattice.q) != options.samples:
        remarks += (f"{options.samples} samples asked for, a lattice of {len(lattice.q)} taken",)
    if found is not None:
        group, more, enough = _with_more_samples(found, q, torque)
        remarks += more
        if not enough:
            remarks += gate_remarks(found)
            if not options.learn_anyway:
                return replace(model_of_run(found), remarks=remarks)
    learner, curve = fitted_with_curve(
        options.learner, options.task(robot.n), group, q, torque, DenseTest(robot, gravity)
    )
    return LearnedModel(
        robot,
        gravity,
        learner,
        choices(options, enough),
        len(q),
        0 if found is None else len(found.motions),
        1 if group is None else group.order,
        curve,
        remarks,
        {"reachable_share": lattice.reachable},
    )


def _with_more_samples(
    found: RunOutcome, q: Array, torque: Array
) -> tuple[SymmetryGroup | None, tuple[str, ...], bool]:
    """Relations that the lattice shows beside what the discovery showed, and a word on them.

    A lattice was led to places that the arm cannot hold by itself, so it may know better; the last
    value says whether enough relations are known to learn, by either.
    """
    group = found.scheme.group
    known = 1 if group is None else group.order
    held, torques = found.scheme.samples
    learned = learn_relations(np.concatenate([held, q]), np.concatenate([torques, torque]))
    enough = learned.missing is None and learned.order >= found.options.n_min
    enough = enough or found.gate_passed
    free = learned.group.rank < learned.group.n
    if learned.order > known or (learned.order == known and (known > 1 or free)):
        words = f"symmetries: {learned.order} known with the samples of the lattice"
        return learned.group, (words,) if learned.order > known else (), enough
    return group, (), enough


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
        curve.append(test.point(count, learner))
    return learner, tuple(curve)
