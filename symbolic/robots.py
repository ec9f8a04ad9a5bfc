"""Robots: load one from its built-in name, a URDF file or a Pinocchio model."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from symbolic.arm_body import ArmBody
from symbolic.errors import InputError
from symbolic.kinematic_tree import KinematicTree

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Snap:
    """An angle or axis that was snapped."""

    joint: str
    what: str
    before: tuple[float, ...]
    after: tuple[float, ...]
    effect: Array


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot arm with one angle per joint."""

    name: str
    model: pin.Model
    source_model: pin.Model
    joint_names: tuple[str, ...]
    limits: Array
    damping: Array
    snaps: tuple[Snap, ...]
    snap_bound: Array
    tree: KinematicTree
    digest: str

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    def source_configuration(self, q: ArrayLike) -> Array:
        """Return the configuration vector of ``source_model`` for joint angles q (..., n)."""
        q = np.asarray(q, dtype=float)
        out = np.empty((*q.shape[:-1], self.source_model.nq))
        for i, joint in enumerate(list(self.source_model.joints)[1:]):
            if joint.nq == 2:
                out[..., joint.idx_q] = np.cos(q[..., i])
                out[..., joint.idx_q + 1] = np.sin(q[..., i])
            else:
                out[..., joint.idx_q] = q[..., i]
        return out


_BUILTIN = ("2r", "3r", "pendulum", "4r-planar")


def load_robot(spec: str | Path | pin.Model, *, snap: bool = True) -> Robot:
    """Load a robot: built-in name, URDF file or Pinocchio model."""
    if isinstance(spec, pin.Model):
        source, name = spec, spec.name
    else:
        name = str(spec)
        if name in _BUILTIN:
            text = files("symbolic").joinpath("robot_files", f"{name}.urdf").read_text()
        elif Path(spec).is_file():
            text = Path(spec).read_text()
        else:
            raise InputError(name, "robot", "unknown", f"{', '.join(_BUILTIN)} or a URDF file")
        source = pin.buildModelFromXML(text)
    body = ArmBody.from_model(source, name)
    return Robot(
        name=name,
        model=body.to_model(name),
        source_model=source,
        joint_names=body.joint_names,
        limits=body.limits,
        damping=body.damping,
        snaps=(),
        snap_bound=np.zeros(body.n),
        tree=body.tree(),
        digest=body.digest(),
    )
