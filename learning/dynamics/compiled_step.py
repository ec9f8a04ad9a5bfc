"""One adaptive step of the linearly implicit method, compiled."""

from __future__ import annotations

import math

from learning.dynamics.compiled_equations import evaluate
from learning.dynamics.compiled_friction import solve_with_friction
from learning.dynamics.compiled_linear import factorise, multiply, solve
from learning.dynamics.kernel import kernel
from learning.dynamics.step_control import VELOCITY_WEIGHT

# Rows of ``Scratch.vectors``.
BIAS = 0
BIAS_HALF = 1
PIVOTS = 2
MOMENTUM = 3
Q_HALF = 4
V_FULL = 5
V_HALF = 6
V_END = 7
Q_NEXT = 8
V_NEXT = 9
ACCELERATION = 10
Q_TRIAL = 11
RIGHT_SIDE = 12
FRICTION = 13
GUESS = 14
TORQUE = 15


@kernel
def evaluate_here(plant, q, v, scratch):
    """Evaluate the equations of motion at the beginning of a step."""
    evaluate(
        plant.parents,
        plant.kinds,
        plant.links,
        plant.gravity,
        q,
        v,
        scratch.sweep,
        scratch.mass,
        scratch.vectors[BIAS],
        scratch.stiffness,
    )


@kernel
def next_velocity(plant, mass, bias, stiffness, torque, momentum, h, elastic, scratch, out):
    """Solve ``(M + h D + h^2 K) v' + h F Sign(v') = M v + h (torque - bias)`` for v'.

    ``out`` holds a guess of v' before. Returns False where the matrix is not positive definite.
    K is multiplied by ``elastic``, 1 or 0.
    """
    n = torque.shape[0]
    factor = scratch.factor
    pivots = scratch.vectors[PIVOTS]
    hh = elastic * h * h
    for i in range(n):
        for j in range(i + 1):
            factor[i, j] = mass[i, j] + hh * stiffness[i, j]
        factor[i, i] += h * plant.damping[i]
    if plant.dry:
        system = scratch.system
        right = scratch.vectors[RIGHT_SIDE]
        friction = scratch.vectors[FRICTION]
        for i in range(n):
            for j in range(i + 1):
                system[i, j] = factor[i, j]
            right[i] = momentum[i] + h * (torque[i] - bias[i])
            friction[i] = h * plant.coulomb[i]
        if not factorise(factor, pivots):
            return False
        guess = scratch.vectors[GUESS]
        solve_with_friction(system, right, friction, factor, pivots, guess, out)
        return True
    if not factorise(factor, pivots):
        return False
    for i in range(n):
        out[i] = momentum[i] + h * (torque[i] - bias[i])
    solve(factor, pivots, out)
    return True


@kernel
def try_step(plant, q, v, torque, h, scratch):
    """Step once with h and twice with h / 2, and extrapolate.

    Parameters
    ----------
    plant, scratch
        `Plant` and `Scratch`; the equations have been evaluated at (q, v) by `evaluate_here`.
    q, v, torque : (n,) arrays
        State at the beginning of the step and the torque during it.
    h : float
        Length of the step [s].

    Returns
    -------
    float
        Estimated local error [rad] of the step before extrapolation. The state after the step
        stands in ``scratch.vectors[Q_NEXT]`` and ``scratch.vectors[V_NEXT]``.

    Notes
    -----
    Linearly implicit Euler with extrapolation: Hairer and Wanner, Solving Ordinary Differential
    Equations II (1996), section IV.9. The exact Jacobian of the gravity torque, K, and of the
    damping keeps it stable for any step; the Jacobian of the Coriolis torque is left out, which
    costs no order as long as both step lengths use the same matrices.
    """
    n = q.shape[0]
    vectors = scratch.vectors
    bias = vectors[BIAS]
    momentum = vectors[MOMENTUM]
    v_full = vectors[V_FULL]
    v_half = vectors[V_HALF]
    v_end = vectors[V_END]
    q_half = vectors[Q_HALF]
    multiply(scratch.mass, v, momentum)
    for i in range(n):
        v_full[i] = v[i]
        v_half[i] = v[i]
        v_end[i] = v[i]
    mass = scratch.mass
    stiffness = scratch.stiffness
    elastic = 1.0
    if not next_velocity(
        plant, mass, bias, stiffness, torque, momentum, h, elastic, scratch, v_full
    ):
        elastic = 0.0
        next_velocity(plant, mass, bias, stiffness, torque, momentum, h, elastic, scratch, v_full)
    half = 0.5 * h
    next_velocity(plant, mass, bias, stiffness, torque, momentum, half, elastic, scratch, v_half)
    for i in range(n):
        q_half[i] = q[i] + half * v_half[i]
    evaluate(
        plant.parents,
        plant.kinds,
        plant.links,
        plant.gravity,
        q_half,
        v_half,
        scratch.sweep,
        scratch.mass_half,
        vectors[BIAS_HALF],
        scratch.stiffness_half,
    )
    multiply(scratch.mass_half, v_half, momentum)
    mass = scratch.mass_half
    stiffness = scratch.stiffness_half
    bias = vectors[BIAS_HALF]
    if not next_velocity(
        plant, mass, bias, stiffness, torque, momentum, half, elastic, scratch, v_end
    ):
        next_velocity(plant, mass, bias, stiffness, torque, momentum, half, 0.0, scratch, v_end)
    error = 0.0
    for i in range(n):
        q_full = q[i] + h * v_full[i]
        q_end = q_half[i] + half * v_end[i]
        error = max(error, abs(q_end - q_full), VELOCITY_WEIGHT * abs(v_end[i] - v_full[i]))
        # A joint that stuck or turned round during the step is not smooth: nothing to extrapolate.
        smooth = not plant.dry or (v_full[i] * v_end[i] > 0.0 and v_full[i] * v[i] > 0.0)
        vectors[Q_NEXT, i] = 2.0 * q_end - q_full if smooth else q_end
        vectors[V_NEXT, i] = 2.0 * v_end[i] - v_full[i] if smooth else v_end[i]
        if plant.dry and vectors[V_NEXT, i] * v_end[i] <= 0.0:
            vectors[V_NEXT, i] = v_end[i]
    return error


@kernel
def acceleration_here(plant, v, torque, scratch):
    """Solve ``M a = torque - bias - D v - F Sign(v)`` at the beginning of a step.

    The result stands in row ACCELERATION. Where a joint does not move, its friction resists the
    acceleration: it sticks as long as that is enough.
    """
    n = v.shape[0]
    factor = scratch.factor
    vectors = scratch.vectors
    pivots = vectors[PIVOTS]
    a = vectors[ACCELERATION]
    for i in range(n):
        for j in range(i + 1):
            factor[i, j] = scratch.mass[i, j]
        a[i] = torque[i] - vectors[BIAS, i] - plant.damping[i] * v[i]
    if plant.dry:
        right = vectors[RIGHT_SIDE]
        friction = vectors[FRICTION]
        for i in range(n):
            moving = v[i] != 0.0
            right[i] = a[i] - math.copysign(plant.coulomb[i], v[i]) if moving else a[i]
            friction[i] = 0.0 if moving else plant.coulomb[i]
            a[i] = 0.0
        solve_with_friction(scratch.mass, right, friction, factor, pivots, vectors[GUESS], a)
        return
    factorise(factor, pivots)
    solve(factor, pivots, a)
