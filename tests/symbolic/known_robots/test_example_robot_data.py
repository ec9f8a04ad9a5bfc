"""Arms of others: the files of the ``robots`` extra (example-robot-data)."""

from __future__ import annotations

import shlex
from importlib import metadata
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


def _catalogue() -> Path:
    try:
        found = metadata.distribution("example-robot-data")
    except metadata.PackageNotFoundError:
        return Path("absent")
    return Path(str(found.locate_file("cmeel.prefix/share/example-robot-data/robots")))


ROBOTS = _catalogue()
pytestmark = pytest.mark.skipif(not ROBOTS.exists(), reason="needs the extra 'robots'")

UR5 = "ur_description/urdf/ur5_robot.urdf"
XARM7 = "xarm_description/urdf/xarm7.urdf"

# file, joints, order and rank of the symmetry group, number of frequencies
ARMS = [
    (UR5, 6, 16, 3, 3),
    ("ur_description/urdf/ur3_robot.urdf", 6, 16, 3, 3),
    ("ur_description/urdf/ur10_robot.urdf", 6, 16, 3, 3),
    (XARM7, 7, 2, 6, 189),
    ("kinova_description/robots/kinova.urdf", 6, 16, 5, 26),
    ("talos_data/robots/talos_left_arm.urdf", 7, 2, 7, 517),
    ("z1_description/urdf/z1.urdf", 7, 8, 6, 27),
    ("finger_edu_description/robots/finger_edu.urdf", 3, 8, 3, 5),
]


def error_beyond_bound(robot, samples=50):
    """How far the torques are from those of Pinocchio's own reading, less the bound."""
    worst = -np.inf
    model, source = robot.model, robot.source_model
    data, source_data = model.createData(), source.createData()
    for q in np.random.default_rng(0).uniform(-np.pi, np.pi, (samples, robot.n)):
        theirs = pin.computeGeneralizedGravity(source, source_data, robot.source_configuration(q))
        error = np.abs(pin.computeGeneralizedGravity(model, data, q) - theirs) - robot.snap_bound
        worst = max(worst, float(error.max()) / (1 + np.abs(theirs).max()))
    return worst


@pytest.mark.slow
@pytest.mark.parametrize(("file", "joints", "order", "rank", "terms"), ARMS)
def test_arms_of_others(file, joints, order, rank, terms):
    robot = load_robot(ROBOTS / file)
    assert robot.n == joints
    assert error_beyond_bound(robot) < 1e-13
    potential = derive_potential(robot.tree)
    group = primary_symmetries(potential)
    assert (group.order, group.rank, len(potential.frequencies)) == (order, rank, terms)


@pytest.mark.slow
@pytest.mark.parametrize("file", [file for file, *_ in ARMS])
def test_what_pinocchio_reads_from_the_file_itself(file):
    theirs = pin.buildModelFromUrdf(str(ROBOTS / file))
    source = load_robot(ROBOTS / file).source_model
    assert list(source.names) == list(theirs.names)
    assert list(source.jointPlacements) == list(theirs.jointPlacements)
    for mine, other in zip(source.inertias[1:], theirs.inertias[1:], strict=True):
        np.testing.assert_allclose(mine.toDynamicParameters(), other.toDynamicParameters())


@pytest.mark.slow
def test_every_file_loads_or_says_why_not():
    """All URDF files of the package: robots of up to 60 joints, many of them refused."""
    loaded, refused = 0, []
    for path in sorted(ROBOTS.rglob("*.urdf")):
        try:
            robot = load_robot(path)
        except InputError as error:
            refused.append((path, str(error)))
        else:
            loaded += 1
            assert error_beyond_bound(robot, samples=3) < 1e-13, path
    assert loaded > 30
    assert all(message.startswith(f"{path}: ") for path, message in refused)
    assert not any("\n" in message for _, message in refused)


def test_our_ur5_is_that_of_ros():
    theirs = load_robot(ROBOTS / UR5)
    ours = load_robot("ur5")
    assert theirs.joint_names == ours.joint_names
    assert max(snap.effect.max() for snap in theirs.snaps) < 1e-9  # angles with 12 digits
    difference = derive_potential(theirs.tree) - derive_potential(ours.tree)
    assert difference.to_float().sup_bound() < 1e-12
    np.testing.assert_allclose(theirs.limits, ours.limits, atol=1e-11)
    for mine, other in zip(ours.model.inertias[1:], theirs.model.inertias[1:], strict=True):
        np.testing.assert_allclose(
            mine.toDynamicParameters(), other.toDynamicParameters(), atol=1e-12
        )


def test_our_panda_is_that_of_franka_description(tmp_path):
    """The arm in front of the flange; hand and fingers (prismatic) taken off."""
    text = (ROBOTS / "panda_description/urdf/panda.urdf").read_text()
    path = tmp_path / "panda.urdf"
    path.write_text(text[: text.index('<joint name="panda_hand_joint"')] + "</robot>")
    theirs = load_robot(path)
    ours = load_robot("panda")
    assert theirs.joint_names == ours.joint_names
    assert theirs.snaps == ()
    np.testing.assert_array_equal(theirs.limits, ours.limits)
    for mine, other in zip(ours.model.inertias[1:], theirs.model.inertias[1:], strict=True):
        assert mine == other
    assert list(ours.model.jointPlacements) == list(theirs.model.jointPlacements)


def test_the_fingers_of_the_panda_are_refused_by_name():
    with pytest.raises(InputError, match=r"are locked: --lock panda_finger_joint1$"):
        load_robot(ROBOTS / "panda_description/urdf/panda.urdf")


def test_the_xarm7_is_symmetric_only_when_snapped():
    """Its file has right angles rounded to five digits."""
    snapped, raw = load_robot(ROBOTS / XARM7), load_robot(ROBOTS / XARM7, snap=False)
    assert [snap.joint for snap in snapped.snaps] == [f"joint{i}" for i in range(2, 8)]
    assert 1e-4 < snapped.snap_bound.max() < 1.5e-4
    assert primary_symmetries(derive_potential(snapped.tree)).order == 2
    assert len(derive_potential(snapped.tree).frequencies) == 189
    assert len(derive_potential(raw.tree).frequencies) > 300
    difference = derive_potential(snapped.tree) - derive_potential(raw.tree)
    exact = difference.to_float().gradient_bound()
    assert np.all(snapped.snap_bound <= exact + 1e-12)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (2000, 7))
    assert np.all(np.abs(difference.to_float().gradient(q)).max(axis=0) <= snapped.snap_bound)


@pytest.mark.slow
def test_robots_of_others_load_with_the_option_that_their_refusal_advises():
    """Three files of the catalogue hold no moving joint; all others are robots."""
    files = sorted(ROBOTS.glob("**/*.urdf"))
    refused = []
    for file in files:
        try:
            load_robot(file)
        except InputError as error:
            _, _, advice = str(error).partition("are locked: ")
            if not advice:
                refused.append(file.name)
                continue
            locked = [name for name in shlex.split(advice) if name != "--lock"]
            assert load_robot(file, lock=locked).n >= 2
    assert refused == ["quadrotor_base.urdf", "iris_simple.urdf", "ur3.urdf"]
    assert len(files) - len(refused) >= 60
