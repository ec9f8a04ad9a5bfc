"""The articulated-body algorithm as C code made for one robot: the cheapest forward dynamics."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import casadi
import numpy as np
import pinocchio as pin

_LOOP = """
double isotorque_repeat(long repeats, double *q, const double *v, const double *torque, double *a) {
    const double *in[3] = {q, v, torque};
    double *out[1] = {a};
    double sum = 0;
    for (long i = 0; i < repeats; i++) {
        aba(in, out, 0, 0, 0);
        q[0] += 1e-9;
        sum += a[0];
    }
    return sum;
}
"""


def aba_function(model: pin.Model) -> casadi.Function:
    """Return CasADi's function (q, v, torque) -> acceleration of a model of revolute joints.

    Notes
    -----
    Featherstone, Rigid Body Dynamics Algorithms (2008), table 7.1, in link coordinates; motions
    are (angular, linear). The numbers of the robot are constants: zeros cost nothing.
    """
    n = model.nv
    q, v, torque = (casadi.SX.sym(name, n) for name in ("q", "v", "torque"))
    lift = -casadi.DM(np.concatenate([np.zeros(3), model.gravity.linear]))
    axes, transforms, motions, biases, inertias, forces = [], [], [], [], [], []
    for i in range(n):
        joint = model.joints[i + 1]
        data = joint.createData()
        joint.calc(data, np.zeros(n))
        axis = np.asarray(data.S).reshape(6)[3:]
        placement = model.jointPlacements[i + 1]
        rotation = casadi.mtimes(casadi.SX(casadi.DM(placement.rotation)), _turn(axis, q[i]))
        transform = _motion_transform(casadi.sparsify(rotation), placement.translation)
        parent = model.parents[i + 1] - 1
        axis6 = casadi.sparsify(casadi.DM(np.concatenate([axis, np.zeros(3)])))
        before = motions[parent] if parent >= 0 else casadi.SX(6, 1)
        motion = casadi.mtimes(transform, before) + axis6 * v[i]
        body = model.inertias[i + 1]
        inertia = casadi.SX(casadi.sparsify(casadi.DM(_spatial_inertia(body))))
        axes.append(axis6)
        transforms.append(transform)
        motions.append(motion)
        biases.append(casadi.mtimes(_cross(motion), axis6 * v[i]))
        inertias.append(inertia)
        forces.append(-casadi.mtimes(_cross(motion).T, casadi.mtimes(inertia, motion)))
    columns, pivots, rests = [None] * n, [None] * n, [None] * n
    for i in reversed(range(n)):
        columns[i] = casadi.mtimes(inertias[i], axes[i])
        pivots[i] = casadi.dot(axes[i], columns[i]) + model.armature[i]
        rests[i] = torque[i] - casadi.dot(axes[i], forces[i])
        parent = model.parents[i + 1] - 1
        if parent >= 0:
            apart = inertias[i] - casadi.mtimes(columns[i], columns[i].T) / pivots[i]
            push = forces[i] + casadi.mtimes(apart, biases[i]) + columns[i] * rests[i] / pivots[i]
            back = transforms[i].T
            inertias[parent] += casadi.mtimes([back, apart, transforms[i]])
            forces[parent] += casadi.mtimes(back, push)
    accelerations, result = [], []
    for i in range(n):
        parent = model.parents[i + 1] - 1
        before = accelerations[parent] if parent >= 0 else lift
        moved = casadi.mtimes(transforms[i], before) + biases[i]
        own = (rests[i] - casadi.dot(columns[i], moved)) / pivots[i]
        accelerations.append(moved + axes[i] * own)
        result.append(own)
    return casadi.Function("aba", [q, v, torque], [casadi.cse(casadi.vertcat(*result))])


def time_compiled_aba(model: pin.Model) -> Callable[[int], float] | None:
    """Compile the function with the C compiler and return what times it.

    Returns
    -------
    callable or None
        Given a number of repeats, the seconds for one evaluation; None without a C compiler.
    """
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        return None
    function = aba_function(model)
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder) / "aba.c", Path(folder) / "aba.so"
        generator = casadi.CodeGenerator("generated.c")
        generator.add(function)
        source.write_text(generator.dump() + _LOOP)
        flags = ["-O3", "-march=native", "-ffast-math", "-fPIC", "-shared"]
        subprocess.run([compiler, *flags, str(source), "-o", str(library), "-lm"], check=True)
        repeat = ctypes.CDLL(str(library)).isotorque_repeat
    pointer = np.ctypeslib.ndpointer(float)
    repeat.argtypes = [ctypes.c_long, pointer, pointer, pointer, pointer]
    repeat.restype = ctypes.c_double
    rng = np.random.default_rng(0)
    q, v, torque = rng.normal(size=(3, model.nv))
    a = np.empty(model.nv)
    repeat(1, q.copy(), v, torque, a)
    truth = pin.aba(model, model.createData(), q, v, torque)
    if not np.allclose(a, truth, rtol=1e-8, atol=1e-8):
        raise AssertionError(f"compiled ABA is off by {abs(a - truth).max()}")

    def timed(repeats: int) -> float:
        start = time.process_time()
        repeat(repeats, q, v, torque, a)
        return (time.process_time() - start) / repeats

    return timed


def _turn(axis: np.ndarray, angle: casadi.SX) -> casadi.SX:
    """Return the rotation about an axis."""
    along = casadi.DM(np.outer(axis, axis))
    across = casadi.DM(np.cross(np.eye(3), axis))
    turn = along + casadi.cos(angle) * (casadi.DM.eye(3) - along) + casadi.sin(angle) * across
    return casadi.sparsify(casadi.SX(turn))


def _skew(x: casadi.SX | casadi.DM) -> casadi.SX:
    return casadi.sparsify(casadi.skew(casadi.densify(x)))


def _motion_transform(rotation: casadi.SX, translation: np.ndarray) -> casadi.SX:
    """Return the matrix that takes motions of the parent to the link's coordinates."""
    turn = rotation.T
    shift = -casadi.mtimes(turn, casadi.SX(_skew(casadi.DM(translation))))
    return casadi.vertcat(
        casadi.horzcat(turn, casadi.SX(3, 3)), casadi.horzcat(casadi.sparsify(shift), turn)
    )


def _spatial_inertia(body: pin.Inertia) -> np.ndarray:
    """Return a link's inertia about its frame's origin, angular part first."""
    lever = pin.skew(body.lever)
    first = body.mass * lever
    return np.block([[body.inertia - first @ lever, first], [first.T, body.mass * np.eye(3)]])


def _cross(motion: casadi.SX) -> casadi.SX:
    """Return the matrix of the cross product with a motion."""
    turn, slide = _skew(motion[:3]), _skew(motion[3:])
    return casadi.vertcat(casadi.horzcat(turn, casadi.SX(3, 3)), casadi.horzcat(slide, turn))
