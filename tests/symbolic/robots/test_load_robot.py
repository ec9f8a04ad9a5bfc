"""Loading robots: built-in ones, files, models; what is refused."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.builtin_robots import builtin_robots
from isotorque.symbolic.robots.load_robot import Robot, load_robot
from isotorque.symbolic.robots.urdf.urdf_file import urdf_text
from tests.symbolic.robots.urdf.urdf_strategies import angles, rounded_right_angles, urdfs

FILES = Path(__file__).parents[3] / "symbolic" / "robot_files"
NAMES = [robot.name for robot in builtin_robots()]


def gravity(model: pin.Model, q: np.ndarray) -> np.ndarray:
    return pin.computeGeneralizedGravity(model, model.createData(), q)


def error_beyond_bound(robot: Robot, rng: np.random.Generator, samples: int = 20) -> float:
    """How far the torques of ``model`` are from those of ``source_model``, less the bound."""
    worst = -np.inf
    for q in rng.uniform(-np.pi, np.pi, (samples, robot.n)):
        theirs = gravity(robot.source_model, robot.source_configuration(q))
        size = 1 + np.abs(theirs).max()
        error = np.abs(gravity(robot.model, q) - theirs) - robot.snap_bound
        worst = max(worst, float((error / size).max()))
    return worst


@given(urdfs(angle=st.one_of(rounded_right_angles, angles)), st.integers(0, 2**32))
def test_gravity_is_the_files_up_to_the_snap_bound(tmp_path_factory, urdf, seed):
    path = tmp_path_factory.mktemp("urdf") / "some arm.urdf"
    path.write_text(urdf_text(urdf))
    robot = load_robot(path, allow_massless=True)
    assert error_beyond_bound(robot, np.random.default_rng(seed)) < 1e-12
    assert list(robot.joint_names) == list(robot.source_model.names)[1:]
    assert robot.model.nq == robot.model.nv == robot.n
    if not robot.snaps:
        assert not np.any(robot.snap_bound)


@given(urdfs(angle=st.one_of(rounded_right_angles, angles)))
def test_a_file_loaded_twice_is_the_same_bit_for_bit(tmp_path_factory, urdf):
    path = tmp_path_factory.mktemp("urdf") / "arm.urdf"
    path.write_text(urdf_text(urdf))
    first, second = (
        load_robot(path, allow_massless=True),
        load_robot(str(path), allow_massless=True),
    )
    assert first.digest == second.digest
    assert first.model == second.model
    np.testing.assert_array_equal(first.snap_bound, second.snap_bound)
    for field in ("rotations", "translations", "axes", "masses", "levers"):
        np.testing.assert_array_equal(getattr(first.tree, field), getattr(second.tree, field))


@given(urdfs(angle=st.one_of(rounded_right_angles, angles)))
def test_the_model_of_a_robot_is_a_robot_with_nothing_left_to_snap(tmp_path_factory, urdf):
    path = tmp_path_factory.mktemp("urdf") / "arm.urdf"
    path.write_text(urdf_text(urdf))
    robot = load_robot(path, allow_massless=True)
    again = load_robot(robot.model, allow_massless=True)
    assert again.snaps == ()
    assert again.digest == robot.digest
    assert again.model == robot.model


@given(urdfs(angle=st.one_of(rounded_right_angles, angles)), st.integers(0, 2**32))
def test_a_model_is_loaded_like_its_file(urdf, seed):
    robot = load_robot(pin.buildModelFromXML(urdf_text(urdf)), allow_massless=True)
    assert error_beyond_bound(robot, np.random.default_rng(seed)) < 1e-12


@given(urdfs(angle=st.one_of(rounded_right_angles, angles)), st.integers(0, 2**32))
def test_not_snapped_is_untouched(tmp_path_factory, urdf, seed):
    path = tmp_path_factory.mktemp("urdf") / "arm.urdf"
    path.write_text(urdf_text(urdf))
    robot = load_robot(path, snap=False, allow_massless=True)
    assert robot.snaps == ()
    assert error_beyond_bound(robot, np.random.default_rng(seed)) < 1e-14
    for i in range(robot.n):
        np.testing.assert_array_equal(
            robot.model.jointPlacements[i + 1].homogeneous,
            robot.source_model.jointPlacements[i + 1].homogeneous,
        )
        assert robot.model.inertias[i + 1] == robot.source_model.inertias[i + 1]


@given(urdfs(), st.integers(0, 2**32))
def test_source_configurations_in_batches(urdf, seed):
    robot = load_robot(pin.buildModelFromXML(urdf_text(urdf)), allow_massless=True)
    q = np.random.default_rng(seed).uniform(-7, 7, (2, 3, robot.n))
    batch = robot.source_configuration(q)
    assert batch.shape == (2, 3, robot.source_model.nq)
    neutral = pin.neutral(robot.source_model)
    for index in np.ndindex(2, 3):
        expected = pin.integrate(robot.source_model, neutral, q[index])
        np.testing.assert_allclose(batch[index], expected, atol=1e-12)


@pytest.mark.parametrize("shape", [(), (1,), (3,), (2, 3)])
def test_configurations_of_the_wrong_length_are_refused(shape):
    with pytest.raises(InputError, match=r"2r: shape of joint angles is .* \(\.\.\., 2\)"):
        load_robot("2r").source_configuration(np.zeros(shape))


def test_tools_beyond_the_last_joint_count():
    """5 kg in the hand of the 3R, which is fixed to the forearm."""
    assert load_robot("3r").tree.masses[2] == 5.0


def test_gravity_is_the_models():
    model = load_robot("2r").model.copy()
    model.gravity.linear = np.array([0.0, 0.0, -1.62])
    moon = load_robot(model)
    np.testing.assert_array_equal(moon.tree.gravity, [0.0, 0.0, -1.62])
    q = np.array([0.3, 0.4])
    np.testing.assert_allclose(
        gravity(moon.model, q), gravity(load_robot("2r").model, q) * 1.62 / 9.81, rtol=1e-13
    )


def test_a_robot_travels_between_processes():
    robot = load_robot("3r")
    again = pickle.loads(pickle.dumps(robot))
    assert again.digest == robot.digest
    assert again.model == robot.model


def test_the_digest_is_the_same_in_another_process():
    code = "import isotorque as iso; print(iso.load_robot('panda').digest)"
    environment = os.environ | {"PYTHONHASHSEED": "7"}
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env=environment,
        cwd=FILES.parents[1],
    )
    assert done.stdout.strip() == load_robot("panda").digest


def test_damping_and_limits_come_from_the_file(tmp_path):
    text = (FILES / "2r.urdf").read_text()
    text = text.replace('type="revolute"', 'type="continuous"', 1)
    text = text.replace('lower="-3.141592653589793" upper="3.141592653589793"', "", 1)
    text = text.replace("</joint>", '<dynamics damping="0.25"/></joint>', 1)
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    robot = load_robot(path)
    assert robot.damping.tolist() == [0.25, 0.0]
    assert robot.source_model.nq == 3
    np.testing.assert_array_equal(robot.limits, [[-np.inf, np.inf], [-np.pi, np.pi]])
    np.testing.assert_array_equal(robot.model.lowerPositionLimit, robot.limits[:, 0])
    np.testing.assert_array_equal(robot.model.damping, robot.damping)
    assert robot.digest != load_robot("2r").digest


def test_the_name_is_that_of_the_file_where_the_robot_has_none(tmp_path):
    path = tmp_path / "my arm.urdf"
    path.write_text((FILES / "2r.urdf").read_text().replace('name="2r"', ""))
    assert load_robot(path).name == "my arm"


@pytest.mark.parametrize("limits", ['lower="-1e16" upper="1e16"', 'lower="0" upper="0"', ""])
def test_limits_that_mean_none_are_infinite(tmp_path, limits):
    path = tmp_path / "arm.urdf"
    text = (FILES / "2r.urdf").read_text()
    path.write_text(text.replace('lower="-3.141592653589793" upper="3.141592653589793"', limits, 1))
    for snap in (True, False):
        robot = load_robot(path, snap=snap)
        np.testing.assert_array_equal(robot.limits, [[-np.inf, np.inf], [-np.pi, np.pi]])
        np.testing.assert_array_equal(robot.model.lowerPositionLimit, [-np.inf, -np.pi])


@pytest.mark.parametrize("spec", ["nothing.urdf", "4r", "", "UR5", "no\0thing", "x" * 5000])
def test_unknown_names_and_missing_files_list_what_there_is(spec):
    with pytest.raises(InputError) as caught:
        load_robot(spec)
    message = str(caught.value)
    assert "a URDF file or one of 2r, 3r, pendulum, 4r-planar, ur5, panda" in message
    assert "\n" not in message


def test_a_folder_is_no_robot(tmp_path):
    with pytest.raises(InputError, match="file is a folder or a device"):
        load_robot(tmp_path)


def test_a_device_is_no_robot():
    if not Path("/dev/zero").exists():
        pytest.skip("no /dev/zero on this system")
    with pytest.raises(InputError, match="file is a folder or a device"):
        load_robot("/dev/zero")


def test_a_binary_file_is_no_robot(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_bytes(bytes(range(256)) * 10)
    with pytest.raises(InputError, match=r"arm\.urdf: content is not XML"):
        load_robot(path)


def test_a_file_that_may_not_be_read(tmp_path, monkeypatch):
    path = tmp_path / "arm.urdf"
    path.write_text("<robot/>")

    def refuse(self):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_bytes", refuse)
    with pytest.raises(InputError, match=r"file is not readable \(Permission denied\)"):
        load_robot(path)


@pytest.mark.parametrize("spec", [None, 3, ["2r"], b"2r"])
def test_other_types_are_refused(spec):
    with pytest.raises(InputError, match="robot: type is"):
        load_robot(spec)


def test_a_free_base_is_refused_by_name():
    model = pin.buildModelFromUrdf(str(FILES / "2r.urdf"), pin.JointModelFreeFlyer())
    with pytest.raises(InputError, match=r"kind of joint 'root_joint' \(floating\)"):
        load_robot(model)


def test_what_pinocchio_refuses_is_bad_input(monkeypatch):
    def refuse(text):
        raise ValueError("first line\nsecond line")

    monkeypatch.setattr(pin, "buildModelFromXML", refuse)
    with pytest.raises(InputError, match="refused by Pinocchio") as caught:
        load_robot("2r")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("number", ["1e60", "1e308", "-1e308"])
@pytest.mark.parametrize("field", ['value="5"', 'xyz="0.25 0 0"', 'ixx="0.0005"'])
def test_numbers_too_large_to_multiply_are_refused(tmp_path, capfd, field, number):
    path = tmp_path / "arm.urdf"
    key, old = field.split("=")
    new = old.replace('"5"', f'"{number}"').replace("0.25", number).replace("0.0005", number)
    path.write_text((FILES / "2r.urdf").read_text().replace(field, f"{key}={new}"))
    with pytest.raises(InputError, match=r"accepted: .*(finite number|number >= 0)"):
        load_robot(path)
    assert capfd.readouterr() == ("", "")
