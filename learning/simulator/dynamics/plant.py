"""Plant of the compiled integrator: the arm it moves, the rules of rest, the workspace."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.simulator.compiled.links import new_rows
from isotorque.learning.simulator.dynamics.chain import Chain
from isotorque.learning.simulator.dynamics.engine import Body

RESTED = 0
LIMIT = 1
ELAPSED = 2

WHERE_IT_IS = 0
CONVERGING = 1
AT_EQUILIBRIUM = 2


class Plant(NamedTuple):
    """An arm with its friction and limits.

    Attributes
    ----------
    parents, kinds, links, gravity
        The arrays of a `Chain`.
    damping : (n,) array
        Viscous damping [N m s/rad].
    coulomb : (n,) array
        Coulomb friction [N m].
    limits : (n, 2) array
        Joint limits [rad].
    anchor : (n, n) array
        ``s D V V'`` for an orthonormal basis V (n, k) of the directions gravity does not feel,
        damping D and a scale s; zero where there are none. See `free_directions`.
    nudge : (n,) array
        Tiny disturbing torque [N m]: see `nudge`.
    residual : float
        Imbalance allowed at a finished equilibrium [N m].
    dry : bool
        Whether there is any Coulomb friction.
    """

    parents: NDArray[np.int64]
    kinds: NDArray[np.int64]
    links: NDArray[np.float64]
    gravity: NDArray[np.float64]
    damping: NDArray[np.float64]
    coulomb: NDArray[np.float64]
    limits: NDArray[np.float64]
    anchor: NDArray[np.float64]
    nudge: NDArray[np.float64]
    residual: float
    dry: bool


class Rest(NamedTuple):
    """Rule of rest, and the accuracy with which motion is followed.

    Attributes
    ----------
    velocity, acceleration : float
        Largest joint velocity [rad/s] and acceleration [rad/s^2]; a negative velocity: never.
    dwell : float
        How long both must hold [s].
    ending : int
        ``WHERE_IT_IS``: the settle rule is enough. ``CONVERGING``: a stable equilibrium must also
        be near. ``AT_EQUILIBRIUM``: likewise, and the arm is moved there.
    tolerance : float
        Local error allowed per step [rad].
    time_tolerance : float
        The same as time [s]: what the arm moves meanwhile at its speed is allowed, if that is less.
    """

    velocity: float
    acceleration: float
    dwell: float
    ending: int
    tolerance: float
    time_tolerance: float


class Scratch(NamedTuple):
    """Arrays the integrator writes to; their contents mean nothing between calls.

    Attributes
    ----------
    rows : (n + 1, LINK_ROW) array
        Workspace of the equations of motion.
    mass, stiffness : (n, n) arrays
        At the beginning of a step.
    mass_half, stiffness_half : (n, n) arrays
        In the middle of a step.
    system, factor : (n, n) arrays
        Matrix of a linear system, and its factors.
    vectors : (VECTORS, n) array
        Further vectors, one per row.
    """

    rows: NDArray[np.float64]
    mass: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    mass_half: NDArray[np.float64]
    stiffness_half: NDArray[np.float64]
    system: NDArray[np.float64]
    factor: NDArray[np.float64]
    vectors: NDArray[np.float64]


VECTORS = 20


def new_plant(chain: Chain, body: Body) -> Plant:
    """Put a plant together; the arrays are copied."""
    return Plant(
        *chain.arrays,
        np.array(body.damping, dtype=float),
        np.array(body.coulomb, dtype=float),
        np.array(body.limits, dtype=float, order="C"),
        np.array(body.anchor, dtype=float, order="C"),
        np.array(body.nudge, dtype=float),
        float(body.residual),
        bool(np.any(body.coulomb)),
    )


def new_scratch(chain: Chain) -> Scratch:
    """Create the workspace for a chain."""
    n = chain.n
    return Scratch(
        rows=new_rows(chain),
        mass=np.zeros((n, n)),
        stiffness=np.zeros((n, n)),
        mass_half=np.zeros((n, n)),
        stiffness_half=np.zeros((n, n)),
        system=np.zeros((n, n)),
        factor=np.zeros((n, n)),
        vectors=np.zeros((VECTORS, n)),
    )
