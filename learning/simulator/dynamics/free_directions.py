"""Directions of motion that gravity does not feel."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.simulator.dynamics.equations import Equations

Array = NDArray[np.float64]

_SAMPLES = 64
_RELATIVE_ZERO = 1e-9
_UNFELT = 1e-12  # [1/s^2]: stiffness over inertia; a pendulum would take weeks for one swing
_NUDGE = 1e-11  # of the torque scale


@dataclass(frozen=True, eq=False)
class FreeDirections:
    """The split of joint space into what gravity feels and what it does not.

    Attributes
    ----------
    basis : (k, n) array
        Orthonormal directions of motion that never change the gravity torque, such as a vertical
        first axis. There an arm has no stiffness anywhere and no torque to hold.
    active : (n - k, n) array
        Orthonormal basis of the rest, the active subspace.
    projector : (n, n) array
        Projects torques and noise on the active subspace.
    stiffness_scale : (n,) array
        Largest stiffness of each joint that was met [N m/rad].
    torque_scale : float
        About the arm's largest gravity torque [N m]; where it feels none, what accelerates its
        largest inertia by 1 rad/s^2.
    """

    basis: Array
    active: Array
    projector: Array
    stiffness_scale: Array
    torque_scale: float

    @property
    def any(self) -> bool:
        """Whether there is a free direction."""
        return len(self.basis) > 0

    def anchor(self, damping: Array) -> Array:
        """Return ``s D V V'`` (n, n) for free directions V and damping D (n,).

        ``K + s D V V' D`` is regular where the stiffness K is on the active subspace; the scale s
        makes both parts about equally large.
        """
        largest = float(damping.max())
        if not self.any or largest == 0.0:
            return np.zeros((len(damping), len(damping)))
        scale = self.torque_scale / largest**2
        return scale * damping[:, None] * (self.basis.T @ self.basis)

    def nudge(self) -> Array:
        """Return a minute disturbing torque (n,) [N m], nothing along free directions.

        An arm balanced exactly on an unstable equilibrium stands on a knife's edge: rounding would
        decide when and where it falls. This disturbance decides instead, on every engine and
        machine alike; a settled arm is finished without it.
        """
        return _NUDGE * self.torque_scale * self.projector @ np.cos(np.arange(len(self.projector)))

    def active_stiffness(self, stiffness: Array) -> Array:
        """Return the smallest eigenvalue of K on the active subspace, joints scaled to 1.

        It is positive exactly where the arm can be held by a constant torque; without any active
        direction it is 1, as nothing has to be held.

        Parameters
        ----------
        stiffness : (..., n, n) array
            One or more [N m/rad].
        """
        if len(self.active) == 0:
            return np.ones(stiffness.shape[:-2])
        products, basis = self._scaled
        scaled = stiffness * products
        return np.asarray(np.linalg.eigvalsh(basis.T @ scaled @ basis)[..., 0])

    @cached_property
    def _scaled(self) -> tuple[Array, Array]:
        """Scales of the entries of a stiffness, and the active subspace of scaled joints."""
        scale = np.where(self.stiffness_scale > 0.0, self.stiffness_scale, 1.0) ** -0.5
        basis = np.linalg.qr((self.active * scale).T)[0] if self.any else np.eye(len(scale))
        return np.outer(scale, scale), basis


def find_free_directions(equations: Equations) -> FreeDirections:
    """Find the directions along which the gravity torque never changes.

    Parameters
    ----------
    equations
        Equations of motion of the arm.

    Notes
    -----
    Gravity depends on q through ``y = B q`` alone, so the stiffness is ``B' H(y) B`` and the free
    directions, the kernel of B, are the common kernel of the stiffness matrices at a few dozen
    generic configurations. Drawn with a fixed seed.
    """
    n = equations.n
    rng = np.random.default_rng(0)
    sampled = [equations.stiffness(q) for q in rng.uniform(-np.pi, np.pi, (_SAMPLES, n))]
    stacked = np.concatenate(sampled)
    scale = np.max([abs(np.diag(k)) for k in sampled], axis=0)
    inertia = float(np.diag(equations.mass_matrix(np.zeros(n))).max())
    _, values, rows = np.linalg.svd(stacked)
    rank = int((values > max(_RELATIVE_ZERO * values[0], _UNFELT * inertia)).sum())
    active, basis = _split(_cleaned(rows[:rank].T @ rows[:rank]))
    return FreeDirections(
        basis=basis,
        active=active,
        projector=_cleaned(active.T @ active),
        stiffness_scale=np.where((rank > 0) & (scale > _RELATIVE_ZERO * scale.max()), scale, 0.0),
        torque_scale=float(scale.max()) if rank else inertia,
    )


def _split(projector: Array) -> tuple[Array, Array]:
    """Return orthonormal bases of the range and the kernel of an orthogonal projector.

    Single joints that belong to one or the other are vectors of these bases.
    """
    diagonal = np.diag(projector)
    mixed = np.flatnonzero((diagonal != 0.0) & (diagonal != 1.0))
    values, vectors = np.linalg.eigh(projector[np.ix_(mixed, mixed)])
    spread = np.zeros((len(mixed), len(projector)))
    spread[:, mixed] = vectors.T
    joints = np.eye(len(projector))
    active = np.vstack([joints[diagonal == 1.0], spread[values > 0.5]])
    return active, np.vstack([joints[diagonal == 0.0], spread[values <= 0.5]])


def _cleaned(matrix: Array) -> Array:
    """Return a matrix with entries that are 0, 1 or -1 but for rounding made exactly so."""
    nearest = np.round(matrix)
    return np.where(abs(matrix - nearest) < 1e-12, nearest, matrix) + 0.0
