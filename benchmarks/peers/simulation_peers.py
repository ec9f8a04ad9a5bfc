"""Peers of the simulator: samples near equilibria, a plain loop, and MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.simulator.simulated_arm import SimulatedArm

try:
    import mujoco
except ImportError:
    mujoco = None

PLAIN_STEP = 1e-3
MUJOCO_STEP = 5e-3
DISTANCE = 0.1


@dataclass(frozen=True)
class Starts:
    """Start configurations of samples and the torques they settle under."""

    q: np.ndarray
    torques: np.ndarray


def near_starts(arm: SimulatedArm, count: int) -> Starts:
    """Draw stable equilibria and starts 0.1 rad away, all of which settle."""
    rng = np.random.default_rng(0)
    equations = arm.equations
    q, torques = np.empty((0, arm.n)), np.empty((0, arm.n))
    spread = 0.5
    while len(q) < count:
        targets = arm.home + rng.uniform(-spread, spread, (4 * count, arm.n))
        steps = rng.normal(size=targets.shape)
        starts = targets + DISTANCE * steps / np.linalg.norm(steps, axis=1, keepdims=True)
        inside = ((arm.limits[:, 0] < starts) & (starts < arm.limits[:, 1])).all(axis=1)
        held = np.array([equations.gravity_torque(x) for x in targets])
        ends = arm.settle_each(starts, held)
        settled = np.array([kind is OutcomeKind.SETTLED for kind in ends.kinds])
        # At the target itself, not at another equilibrium under the same torque.
        near = np.linalg.norm(ends.q - targets, axis=1) < 2.0 * DISTANCE
        keep = inside & settled & near
        q, torques = np.vstack([q, starts[keep]]), np.vstack([torques, held[keep]])
    return Starts(q[:count], torques[:count])


def plain_settle(
    arm: SimulatedArm, model: pin.Model, data: pin.Data, q: np.ndarray, torque: np.ndarray
) -> np.ndarray:
    """Settle with Euler steps: what one writes first."""
    rule, damping = arm.rule, arm.damping
    low, high = arm.limits.T
    q, v = q.copy(), np.zeros(arm.n)
    quiet = 0.0
    for _ in range(int(rule.time_limit / PLAIN_STEP)):
        a = pin.aba(model, data, q, v, torque - damping * v)
        v += PLAIN_STEP * a
        q += PLAIN_STEP * v
        if (q < low).any() or (q > high).any():
            break
        rests = abs(v).max() < rule.velocity and abs(a).max() < rule.acceleration
        quiet = quiet + PLAIN_STEP if rests else 0.0
        if quiet >= rule.dwell:
            break
    return q


def mujoco_settle(
    arm: SimulatedArm, model: Any, data: Any, q: np.ndarray, torque: np.ndarray
) -> np.ndarray:
    """Settle with MuJoCo's steps."""
    rule = arm.rule
    mujoco.mj_resetData(model, data)
    data.qpos[:] = q
    data.qfrc_applied[:] = torque
    quiet = 0.0
    for _ in range(int(rule.time_limit / MUJOCO_STEP)):
        mujoco.mj_step(model, data)
        rests = abs(data.qvel).max() < rule.velocity and abs(data.qacc).max() < rule.acceleration
        quiet = quiet + MUJOCO_STEP if rests else 0.0
        if quiet >= rule.dwell:
            break
    return data.qpos.copy()


def check(
    arm: SimulatedArm,
    model: pin.Model,
    data: pin.Data,
    starts: Starts,
    ends: np.ndarray,
    few: slice,
) -> None:
    """Make sure that the plain loop ends where the compiled engine does."""
    for q, torque, end in zip(starts.q[few], starts.torques[few], ends[few], strict=True):
        torque_there = pin.computeGeneralizedGravity(
            model, data, plain_settle(arm, model, data, q, torque)
        )
        there = pin.computeGeneralizedGravity(model, data, end)
        if abs(torque_there - there).max() > 0.05:
            raise AssertionError(f"plain loop and engine differ: {torque_there}, {there}")
