"""A robot as a MuJoCo model: the same bodies, joints and friction, nothing else."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pinocchio as pin

_SPECK = 1e-12  # [kg], [kg m^2]: MuJoCo refuses links without mass


def mujoco_arm(
    model: pin.Model,
    damping: np.ndarray,
    *,
    coulomb: np.ndarray | None = None,
    timestep: float = 5e-3,
    integrator: str = "implicitfast",
) -> Any:
    """Build the MuJoCo model of a Pinocchio model with revolute joints.

    Parameters
    ----------
    model
        Pinocchio model, one angle per joint, joints in depth-first order (as MuJoCo's are).
    damping, coulomb : (n,) arrays
        Viscous damping [N m s/rad] and Coulomb friction [N m].
    timestep
        Length of a step [s].
    integrator
        MuJoCo's name of an integrator.

    Returns
    -------
    mujoco.MjModel
        Without contacts, limits and actuators: torques go to ``qfrc_applied``.
    """
    spec = mujoco.MjSpec()
    spec.option.timestep = timestep
    spec.option.gravity = model.gravity.linear
    spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    spec.compiler.boundmass = 0.0
    spec.compiler.boundinertia = 0.0
    bodies = [spec.worldbody]
    for j in range(1, model.njoints):
        placement = model.jointPlacements[j]
        inertia = model.inertias[j]
        rotational = inertia.inertia + _SPECK * np.eye(3)
        body = bodies[model.parents[j]].add_body(
            name=f"body{j}",
            pos=placement.translation,
            quat=_quaternion(placement.rotation),
            mass=inertia.mass + _SPECK,
            ipos=inertia.lever,
            fullinertia=[*np.diag(rotational), *rotational[np.triu_indices(3, 1)]],
            explicitinertial=True,
        )
        joint = model.joints[j]
        data = joint.createData()
        joint.calc(data, np.zeros(model.nq))
        hinge = body.add_joint(
            name=f"joint{j}",
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=np.asarray(data.S).reshape(6)[3:],
            armature=model.armature[j - 1],
        )
        # From version 4 on a polynomial: its first coefficient is the viscous damping.
        linear = np.zeros(np.shape(hinge.damping))
        linear.flat[0] = damping[j - 1]
        hinge.damping = linear if linear.ndim else float(linear)
        hinge.frictionloss = 0.0 if coulomb is None else coulomb[j - 1]
        bodies.append(body)
    return spec.compile()


def _quaternion(rotation: np.ndarray) -> np.ndarray:
    """Return a rotation as MuJoCo's quaternion w, x, y, z."""
    return np.roll(pin.Quaternion(rotation).coeffs(), 1)
