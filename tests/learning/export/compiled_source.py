"""Compile exported C strictly and call it."""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

CC = shutil.which("cc")
STRICT = ["-O2", "-Wall", "-Wextra", "-Werror", "-pedantic", "-std=c99"]
needs_cc = pytest.mark.skipif(CC is None, reason="no C compiler `cc` on this machine")
needs_nm = pytest.mark.skipif(shutil.which("nm") is None, reason="no `nm` on this machine")


def build(source, folder):
    """Compile a source to an object and a library; their paths."""
    (folder / "gravity.c").write_text(source)
    for command in (
        [CC, *STRICT, "-fPIC", "-c", "gravity.c", "-o", "gravity.o"],
        [CC, "-shared", "gravity.o", "-o", "gravity.so", "-lm"],
    ):
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    return folder / "gravity.o", folder / "gravity.so"


def call(library, q, in_place=False):
    """Torques of a compiled library at configurations (m, n)."""
    function = ctypes.CDLL(str(library)).isotorque_gravity
    function.restype = None
    doubles = ctypes.POINTER(ctypes.c_double)
    torques = np.array(q) if in_place else np.full(q.shape, np.nan)
    for point, torque in zip(np.ascontiguousarray(q), torques, strict=True):
        source = torque if in_place else point
        function(source.ctypes.data_as(doubles), torque.ctypes.data_as(doubles))
    return torques


def symbols(thing):
    """Visible symbols: defined and undefined."""
    listing = subprocess.run(["nm", "-g", str(thing)], check=True, capture_output=True, text=True)
    found = [line.split()[-2:] for line in listing.stdout.splitlines()]
    defined = {name for kind, name in found if kind != "U"}
    return defined, {name for kind, name in found if kind == "U"} - {"_GLOBAL_OFFSET_TABLE_"}
