"""Torques that tell an arm most of itself, before it has seen much."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.rigid.chain_watch import ChainWatch
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.planning.telling_pose import telling_pose
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.identification.chain_identification import relations_of_chain
from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet

Array = NDArray[np.float64]

WIDTH = 3.0
"""Torques at random go so many times the scale of each joint from home."""


class TellingTorques:
    """Chooses torques until the relations are known through a chain.

    Parameters
    ----------
    chain : ChainWatch
        The rigid chain behind what has settled, if there is one.
    static_torques : StaticTorqueSet
        Torques that were refused.
    home : (n,) array
        Where the arm begins [rad].
    rng : numpy.random.Generator
        Source of randomness.

    Notes
    -----
    Torques are random about home as long as no chain stands, then those of the poses that tell most
    about it (`telling_pose`).
    """

    def __init__(
        self,
        chain: ChainWatch,
        static_torques: StaticTorqueSet,
        home: Array,
        rng: np.random.Generator,
    ) -> None:
        self.chain, self.static_torques, self.home, self.rng = chain, static_torques, home, rng
        self._asked: RigidChain | None = None
        self._known = False

    def __call__(self, centre: Array, scale: Array) -> Array | None:
        """Torque (n,) to try next; None where the relations are known.

        Parameters
        ----------
        centre : (n,) array
            Torque that holds the arm at home [N m].
        scale : (n,) array
            Torque that visibly moves each joint [N m].
        """
        learner = self.chain.learner
        if learner is None:
            return self.at_random(centre, scale)
        if self._relations_known(learner):
            return None
        fit = learner.fit_
        refused = self.static_torques.inadmissible
        pose = telling_pose(fit, *self.chain.learned, self.home, self.rng, refused=refused)
        if pose is None:
            return self.at_random(centre, scale)
        return np.asarray(fit.chain.torque(pose[None])[0])

    def at_random(self, centre: Array, scale: Array) -> Array:
        """Torque (n,) about home that moves all joints at once."""
        return centre + scale * self.rng.uniform(-WIDTH, WIDTH, len(scale))

    def _relations_known(self, learner: RigidChain) -> bool:
        """Whether a chain tells the relations; each one is asked once.

        That there are none but the identity counts only where the samples are exact: no bound says
        how well a chain without relations is known.
        """
        if learner is not self._asked:
            found = relations_of_chain(learner)
            exact = learner.verdict_ is FitStatus.ROUNDING
            self._asked = learner
            self._known = found.decided and (found.order > 1 or exact)
        return self._known
