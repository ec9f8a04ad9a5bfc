"""Adaptive step of the linearly implicit method, compiled."""

from __future__ import annotations

import math

from isotorque.learning.simulator.compiled.equations import evaluate
from isotorque.learning.simulator.compiled.friction import solve_with_friction
from isotorque.learning.simulator.compiled.kernel import kernel, kernel_part
from isotorque.learning.simulator.compiled.linear import factorise, multiply, solve, solve_step
from isotorque.learning.simulator.dynamics.step_control import VELOCITY_WEIGHT

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


@kernel_part
def evaluate_here(plant, q, v, scratch):
    """Evaluate the equations of motion at the beginning of a step."""
    evaluate(
        plant.parents,
        plant.kinds,
        plant.links,
        plant.gravity,
        q,
        v,
        scratch.rows,
        scratch.mass,
        scratch.vectors[BIAS],
        scratch.stiffness,
    )


@kernel_part
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
        Estimated local error [rad] of the step before extrapolation, infinite where numbers
        overflow. The state after the step stands in rows Q_NEXT and V_NEXT of the vectors.

    Notes
    -----
    Linearly implicit Euler, ``(M + h D + h^2 K) v' + h F Sign(v') = M v + h (torque - bias)``,
    with extrapolation: Hairer and Wanner, Solving Ordinary Differential Equations II (1996),
    section IV.9. The exact Jacobian of the gravity torque, K, and of the damping keeps it stable
    for any step; the Jacobian of the Coriolis torque is left out, which costs no order as long as
    both step lengths use the same matrices. Where the matrix is not positive definite, K is left
    out as well.
    """
    n = q.shape[0]
    vectors = scratch.vectors
    momentum = vectors[MOMENTUM]
    q_half = vectors[Q_HALF]
    mass = scratch.mass
    stiffness = scratch.stiffness
    bias = vectors[BIAS]
    velocity = v
    elastic = 1.0
    for stage in range(3):
        if stage == 2:
            mass = scratch.mass_half
            stiffness = scratch.stiffness_half
            bias = vectors[BIAS_HALF]
            velocity = vectors[V_HALF]
            for i in range(n):
                q_half[i] = q[i] + 0.5 * h * velocity[i]
            evaluate(
                plant.parents,
                plant.kinds,
                plant.links,
                plant.gravity,
                q_half,
                velocity,
                scratch.rows,
                mass,
                bias,
                stiffness,
            )
        if stage != 1:
            multiply(mass, velocity, momentum)
        length = h if stage == 0 else 0.5 * h
        out = vectors[V_FULL + stage]
        while True:
            for i in range(n):
                out[i] = momentum[i] + length * (torque[i] - bias[i])
            solved = solve_step(
                mass,
                stiffness,
                plant.damping,
                length,
                elastic * length * length,
                scratch.factor,
                vectors[PIVOTS],
                out,
            )
            if solved or elastic == 0.0:
                break
            elastic = 0.0
        if plant.dry:
            _rub(plant, mass, stiffness, bias, torque, v, length, elastic, stage, scratch)
    v_full = vectors[V_FULL]
    v_half = vectors[V_HALF]
    v_end = vectors[V_END]
    error = 0.0
    total = 0.0
    for i in range(n):
        q_full = q[i] + h * v_full[i]
        q_end = q[i] + 0.5 * h * (v_half[i] + v_end[i])
        error = max(error, abs(q_end - q_full), VELOCITY_WEIGHT * abs(v_end[i] - v_full[i]))
        # A joint that stuck or turned round during the step is not smooth: nothing to extrapolate.
        smooth = not plant.dry or (v_full[i] * v_end[i] > 0.0 and v_full[i] * v[i] > 0.0)
        vectors[Q_NEXT, i] = 2.0 * q_end - q_full if smooth else q_end
        vectors[V_NEXT, i] = 2.0 * v_end[i] - v_full[i] if smooth else v_end[i]
        if plant.dry and vectors[V_NEXT, i] * v_end[i] <= 0.0:
            vectors[V_NEXT, i] = v_end[i]
        total += vectors[Q_NEXT, i] + vectors[V_NEXT, i]
    return error if math.isfinite(total) else math.inf


@kernel
def _rub(plant, mass, stiffness, bias, torque, guess, h, elastic, stage, scratch):
    """Solve a stage again, with Coulomb friction."""
    n = torque.shape[0]
    vectors = scratch.vectors
    system = scratch.system
    right = vectors[RIGHT_SIDE]
    friction = vectors[FRICTION]
    out = vectors[V_FULL + stage]
    for i in range(n):
        for j in range(i + 1):
            system[i, j] = mass[i, j] + elastic * h * h * stiffness[i, j]
        system[i, i] += h * plant.damping[i]
        right[i] = vectors[MOMENTUM, i] + h * (torque[i] - bias[i])
        friction[i] = h * plant.coulomb[i]
        out[i] = guess[i]
    solve_with_friction(
        system, right, friction, scratch.factor, vectors[PIVOTS], vectors[GUESS], out
    )


@kernel_part
def acceleration_here(plant, v, torque, scratch):
    """Solve ``M a = torque - bias - D v - F Sign(v)`` at the beginning of a step.

    The result stands in row ACCELERATION. Where a joint does not move, its friction resists the
    acceleration: it sticks as long as that is enough.
    """
    vectors = scratch.vectors
    _accelerate(
        scratch.mass,
        vectors[BIAS],
        plant.damping,
        plant.coulomb if plant.dry else plant.damping[:0],
        v,
        torque,
        scratch.factor,
        vectors,
    )


@kernel
def _accelerate(mass, bias, damping, coulomb, v, torque, factor, vectors):
    """Solve for the acceleration; without Coulomb friction if that array is empty."""
    n = v.shape[0]
    pivots = vectors[PIVOTS]
    a = vectors[ACCELERATION]
    for i in range(n):
        for j in range(i + 1):
            factor[i, j] = mass[i, j]
        a[i] = torque[i] - bias[i] - damping[i] * v[i]
    if coulomb.shape[0] == 0:
        factorise(factor, pivots)
        solve(factor, pivots, a)
        return
    right = vectors[RIGHT_SIDE]
    friction = vectors[FRICTION]
    for i in range(n):
        moving = v[i] != 0.0
        right[i] = a[i] - math.copysign(coulomb[i], v[i]) if moving else a[i]
        friction[i] = 0.0 if moving else coulomb[i]
        a[i] = 0.0
    solve_with_friction(mass, right, friction, factor, pivots, vectors[GUESS], a)
