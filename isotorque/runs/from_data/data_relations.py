"""Symmetry relations that a recording supports, and its rows that do not fit the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.learners.cross_validation import CrossValidation, cross_validate
from isotorque.learning.learners.registry import LearningTask, learner_by_name
from isotorque.learning.learners.rigid.fitting.fit_status import NotAccepted
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.testing.supported_group import SupportedGroup, supported_group
from isotorque.learning.statistics.poses import group_poses
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup, check_listable
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

Flags = NDArray[np.bool_]

EQUATIONS = 2
"""Equations per coefficient from which the form of rigid gravity is fitted without symmetries."""


@dataclass(frozen=True, eq=False)
class DataRelations:
    """Relations that a model of a recording may enforce.

    Attributes
    ----------
    group : SymmetryGroup or None
        The relations; None: none.
    tried : CrossValidation or None
        Errors of a learner with this group on held out poses, and outliers; None for one pose.
    test : SupportedGroup or None
        What the rows say of the relations first meant; None where there were none.
    remarks : tuple of str
        How it came about.
    """

    group: SymmetryGroup | None
    tried: CrossValidation | None
    test: SupportedGroup | None
    remarks: tuple[str, ...]


class RelationsOfData:
    """Finds the relations of a recording.

    Parameters
    ----------
    samples
        The recording.
    learner, task
        The learner that is to enforce them, see `learner_by_name`.
    """

    def __init__(self, samples: StaticSamples, learner: str, task: LearningTask) -> None:
        self._samples, self._learner, self._task = samples, learner, task
        self._poses = group_poses(samples.q, task.turning)

    def find(
        self, which: str, gravity: GravityModel, report: Callable[[str], Any]
    ) -> DataRelations:
        """Find the relations, outliers left out, and test them before they are enforced.

        Parameters
        ----------
        which
            ``learned``: from the recording; ``exact``: those of the robot; ``none``.
        gravity
            The robot.
        report
            Called with what is being done.
        """
        group, left_out = None, self._nobody()
        remarks: tuple[str, ...] = ()
        report("relations")
        if which == "exact":
            group = primary_symmetries(gravity.potential)
            check_listable(group, gravity.name, gravity.joint_names)
        elif which == "learned":
            group, remarks = self._learned(left_out)
            if group is None:
                # one wrong row hides every symmetry: look for such rows, then again for symmetries
                left_out = self._screened()
                if left_out.any():
                    group, remarks = self._learned(left_out)
        report("errors on held out rows")
        tried, unfit = self._tried(group)
        if which == "learned" and not np.array_equal(unfit, left_out):
            group, remarks = self._learned(unfit)
            tried, unfit = self._tried(group)
        if group is None or not self._samples.tau.any():
            return DataRelations(group, tried, None, remarks)
        test = supported_group(group, self._samples.q[~unfit], self._samples.tau[~unfit])
        if not test.whole:
            group = _worth_having(test.group)
            tried, _ = self._tried(group)
        return DataRelations(group, tried, test, (*remarks, str(test)))

    def _learned(self, left_out: Flags) -> tuple[SymmetryGroup | None, tuple[str, ...]]:
        q, tau = self._samples.q[~left_out], self._samples.tau[~left_out]
        found = learn_relations(q, tau)
        said = f"{found.order} symmetry relations learned from the data"
        if found.chain is not None:
            said += ", by a rigid chain"
        if found.note:
            said += f"; {found.note}"
        if found.missing:
            said += f"; missing: {found.missing}"
        if left_out.any():
            said += f"; {int(left_out.sum())} outliers left out for that"
        return _worth_having(found.group), (said,)

    def _tried(
        self, group: SymmetryGroup | None, learner: str | None = None
    ) -> tuple[CrossValidation | None, Flags]:
        if self._poses.count < 2:
            return None, self._nobody()
        name = self._learner if learner is None else learner
        try:
            found = cross_validate(
                lambda: learner_by_name(name, group, self._task),
                self._samples.q,
                self._samples.tau,
                np.random.default_rng(self._task.seed),
                poses=self._poses,
            )
        except NotAccepted:  # from fewer rows than there are; what all of them say is seen later
            return None, self._nobody()
        return found, found.outliers

    def _screened(self) -> Flags:
        """Outliers by the form of rigid gravity where the poses suffice, else by the learner."""
        joints = self._samples.q.shape[1]
        plenty = self._poses.count * joints >= EQUATIONS * 3**joints
        return self._tried(None, "trigonometric" if plenty else None)[1]

    def _nobody(self) -> Flags:
        return np.zeros(len(self._samples.q), dtype=bool)


def _worth_having(group: SymmetryGroup) -> SymmetryGroup | None:
    """Return the group, or None if it says nothing."""
    return group if group.order > 1 or group.rank < group.n else None
