"""What is no robot is refused in one line that says what would be."""

from __future__ import annotations

from pathlib import Path

import pinocchio as pin
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from tests.symbolic.robots.test_load_robot import FILES


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
