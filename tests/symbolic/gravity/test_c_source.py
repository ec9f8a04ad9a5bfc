import ctypes
import dataclasses
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.c_source import gravity_c
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.straight_line_program import expanded_program, recursion_program
from isotorque.symbolic.robots.kinematic_tree import planar_arm
from isotorque.symbolic.robots.load_robot import load_robot

CALLER = Path(__file__).parents[3] / "examples" / "call_gravity.c"
CC = shutil.which("cc")
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"]

needs_cc = pytest.mark.skipif(CC is None, reason="no C compiler `cc` on this machine")
needs_nm = pytest.mark.skipif(shutil.which("nm") is None, reason="no `nm` on this machine")


def compiled(source, folder, *flags):
    (folder / "gravity.c").write_text(source)
    library = folder / "gravity.so"
    command = [CC, *STRICT, *flags, "-shared", "-fPIC", "gravity.c", "-o", library.name, "-lm"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return library


def called(library, q):
    function = ctypes.CDLL(str(library)).isotorque_gravity
    function.restype = None
    doubles = ctypes.POINTER(ctypes.c_double)
    q, tau = np.array(q, dtype=float), np.full(len(q), np.nan)
    function(q.ctypes.data_as(doubles), tau.ctypes.data_as(doubles))
    return tau


@needs_cc
@pytest.mark.parametrize("form", ["cheaper", "expanded", "recursion"])
@pytest.mark.parametrize("name", ["2r", "3r", "ur5", "panda"])
def test_compiled_c_equals_the_model(name, form, tmp_path):
    gravity = GravityModel(load_robot(name))
    program = {
        "cheaper": None,
        "expanded": expanded_program(gravity.significant_potential),
        "recursion": recursion_program(gravity.chain),
    }[form]
    library = compiled(gravity_c(gravity, program), tmp_path)
    scale = gravity.potential.gradient_bound().max()
    for q in np.random.default_rng(0).uniform(-7, 7, (20, gravity.n)):
        torque = called(library, q)
        np.testing.assert_allclose(torque, gravity.torque(q), rtol=0, atol=1e-12 * scale)


@needs_cc
@needs_nm
@pytest.mark.parametrize("name", ["2r", "panda"])
def test_no_other_symbol_is_visible(name, tmp_path):
    (tmp_path / "gravity.c").write_text(gravity_c(GravityModel(load_robot(name))))
    subprocess.run([CC, *STRICT, "-c", "gravity.c"], cwd=tmp_path, check=True)
    listing = subprocess.run(
        ["nm", "-g", "gravity.o"], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    symbols = [line.split()[-2:] for line in listing.stdout.splitlines()]
    defined = [symbol for kind, symbol in symbols if kind != "U"]
    undefined = {symbol for kind, symbol in symbols if kind == "U"}
    assert defined == ["isotorque_gravity"]
    assert undefined <= {"cos", "sin", "sincos"}


@needs_cc
def test_the_calling_example_prints_the_torques(tmp_path):
    gravity = GravityModel(load_robot("3r"))
    (tmp_path / "gravity.c").write_text(gravity_c(gravity))
    command = [CC, *STRICT, str(CALLER), "gravity.c", "-lm", "-o", "call_gravity"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    q = [0.1, -0.5, 2.25]
    run = subprocess.run(
        ["./call_gravity", *map(str, q)], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    np.testing.assert_allclose(
        [float(x) for x in run.stdout.split()], gravity.torque(q), atol=1e-13
    )
    for bad in (["0.1", "elbow", "0"], []):
        run = subprocess.run(["./call_gravity", *bad], cwd=tmp_path, capture_output=True, text=True)
        assert run.returncode == 2
        assert run.stderr.startswith("error: 'elbow'" if bad else "usage:")


@needs_cc
def test_angles_and_torques_may_share_one_array(tmp_path):
    gravity = GravityModel(load_robot("2r"))
    library = compiled(gravity_c(gravity), tmp_path)
    function = ctypes.CDLL(str(library)).isotorque_gravity
    both = np.array([0.3, 0.4])
    pointer = both.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
    function(pointer, pointer)
    np.testing.assert_allclose(both, gravity.torque([0.3, 0.4]), atol=1e-13)


@needs_cc
def test_an_arm_without_weight_compiles_without_warnings(tmp_path):
    tree = dataclasses.replace(load_robot("2r").tree, gravity=np.zeros(3))
    library = compiled(gravity_c(GravityModel(tree)), tmp_path)
    assert called(library, [1.0, 2.0]).tolist() == [0.0, 0.0]


@needs_cc
def test_names_cannot_end_the_comment(tmp_path):
    tree = dataclasses.replace(load_robot("2r").tree, joint_names=("*/ int x; /*", "a\nint y;??/"))
    library = compiled(gravity_c(GravityModel(tree)), tmp_path)
    np.testing.assert_allclose(called(library, [0.0, 0.0]), [24.525, 6.13125])


def test_numbers_read_back_bit_for_bit():
    gravity = GravityModel(load_robot("panda"))
    source = gravity_c(gravity, expanded_program(gravity.significant_potential))
    body = source.partition("{")[2]
    numbers = {float(x) for x in re.findall(r"\d+\.\d*(?:e-?\d+)?|\d+e-?\d+", body)}
    f = gravity.significant_potential.to_float()
    assert {abs(x) for x in (*f.cos, *f.sin)} - {0.0} <= numbers
    assert max(map(len, source.splitlines())) <= 100


def test_symbols_are_refused():
    with pytest.raises(InputError, match="substitute the symbols"):
        gravity_c(GravityModel(planar_arm(2)))
