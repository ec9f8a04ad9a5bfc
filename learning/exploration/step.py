"""What one step of an exploration was, and running totals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from learning.arm import Outcome
from learning.exploration.targets import Phase

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ExplorationStep:
    """One commanded torque and what became of it.

    Attributes
    ----------
    number : int
        Counts commands from 0 on.
    phase : Phase
        Why the target was chosen.
    target : (n,) array or None
        q*_t [rad]; None in motor babbling.
    torque : (n,) array
        Commanded torque tau+_t [N m].
    projected : bool
        Whether the torque was moved to the nearest static torque.
    outcome : Outcome
        What the arm did.
    learned : bool
        Whether the sample went to the learner.
    weight : float
        w_dir of Eq. 16 (0 where nothing was learned).
    alpha : float
        Eq. 15 [rad^2]; NaN where no direction was followed.
    turned : bool
        Whether the arm left the intended direction: a new one follows from where it was before.
    explored : float or None
        Share of the domain explored so far, where that is watched.
    window_error : float or None
        e_val [N m] where this step ended an iteration.
    """

    number: int
    phase: Phase
    target: Vector | None
    torque: Vector
    projected: bool
    outcome: Outcome
    learned: bool
    weight: float
    alpha: float
    turned: bool
    explored: float | None
    window_error: float | None


@dataclass
class Counts:
    """Running totals of an exploration.

    Attributes
    ----------
    commands, settled, inadmissible, projected, turns : int
        Torques commanded; settled under them; ended at a limit or in a time out; moved to the
        nearest static torque before; directions given up.
    """

    commands: int = 0
    settled: int = 0
    inadmissible: int = 0
    projected: int = 0
    turns: int = 0
