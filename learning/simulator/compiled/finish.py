"""The equilibrium a settled motion converges to, compiled."""

from __future__ import annotations

from isotorque.learning.simulator.compiled.kernel import kernel
from isotorque.learning.simulator.compiled.linear import factorise, multiply, solve
from isotorque.learning.simulator.compiled.step import (
    ACCELERATION,
    BIAS,
    MOMENTUM,
    PIVOTS,
    Q_TRIAL,
    V_NEXT,
    evaluate_here,
)
from isotorque.learning.simulator.dynamics.step_control import CONTRACTION, NEWTON_STEPS


@kernel
def _newton_factors(plant, scratch):
    """Factor the stiffness, made regular along directions that gravity does not feel."""
    factor = scratch.factor
    n = factor.shape[0]
    for i in range(n):
        for j in range(i + 1):
            factor[i, j] = scratch.stiffness[i, j] + plant.anchor[i, j] * plant.damping[j]
    return factorise(factor, scratch.vectors[PIVOTS])


@kernel
def finish(plant, q, v, torque, moves, scratch):
    """Look for the equilibrium that the nearly finished motion converges to.

    Parameters
    ----------
    plant, scratch
        `Plant` and `Scratch`; the equations have been evaluated at (q, v).
    q, v : (n,) arrays
        State at the end of the motion.
    torque : (n,) array
        The torque that is applied [N m].
    moves : bool
        Whether to replace q and v by the equilibrium and zero, if there is one.

    Returns
    -------
    bool
        Whether there is such an equilibrium.

    Notes
    -----
    The linearised damped motion still has to go ``K^-1 (torque - g(q))``, the first step of
    Newton's method. The equilibrium is accepted only if the stiffness K is positive definite at
    both ends, every further step is at most a quarter of the one before (the discrete form of the
    Newton-Kantorovich condition, so there is one equilibrium near and it is this one), it lies
    within the joint limits, and the torque is balanced to the plant's ``residual``.

    Along directions V that gravity does not feel, ``M a + D v = torque - g`` integrates to
    ``V' D dq = V' M v``: there the arm runs out under its damping. The anchor of the plant adds
    these rows to K.
    """
    n = q.shape[0]
    vectors = scratch.vectors
    step = vectors[ACCELERATION]
    trial = vectors[Q_TRIAL]
    at_rest = vectors[V_NEXT]
    momentum = vectors[MOMENTUM]
    multiply(scratch.mass, v, momentum)
    for i in range(n):
        trial[i] = q[i]
        at_rest[i] = 0.0
    allowed = 1e300
    for k in range(NEWTON_STEPS):
        if not _newton_factors(plant, scratch):
            return False
        worst = 0.0
        for i in range(n):
            rest = torque[i] - vectors[BIAS, i]
            worst = max(worst, abs(rest))
            step[i] = rest
            if k == 0:
                for j in range(n):
                    step[i] += plant.anchor[i, j] * momentum[j]
        if k > 0 and worst <= plant.residual:
            return _accept(plant, q, v, trial, moves)
        solve(scratch.factor, vectors[PIVOTS], step)
        length = 0.0
        for i in range(n):
            length = max(length, abs(step[i]))
        if not length <= allowed:
            return False
        allowed = CONTRACTION * length
        for i in range(n):
            trial[i] += step[i]
        evaluate_here(plant, trial, at_rest, scratch)
    return False


@kernel
def _accept(plant, q, v, trial, moves):
    """Take the equilibrium over, unless a joint limit lies before it."""
    for i in range(q.shape[0]):
        if not plant.limits[i, 0] <= trial[i] <= plant.limits[i, 1]:
            return False
    if moves:
        for i in range(q.shape[0]):
            q[i] = trial[i]
            v[i] = 0.0
    return True
