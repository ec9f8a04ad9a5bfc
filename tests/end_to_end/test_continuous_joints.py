"""Continuous joints: they turn on through half a turn, in both engines."""

import numpy as np
import pytest

from isotorque.cli.main import status
from isotorque.learning.arm import LimitHit, Settled
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.joint_limits import TURN
from isotorque.symbolic.robots.load_robot import load_robot

POLE = """<robot name="pole"><link name="base"/><link name="pole"><inertial>
<origin xyz="0 0 0.1"/><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="hinge" type="{kind}"><parent link="base"/><child link="pole"/><axis xyz="0 1 0"/>
{limit}</joint></robot>"""  # hangs at half a turn
UNLIMITED = {
    "continuous": "",
    "revolute": '<limit lower="0" upper="0" effort="10" velocity="5"/>',
}
TORQUE = 0.1547
REST = np.pi + np.arcsin(TORQUE / 0.981)


def pole(path, kind="continuous", limit=""):
    path.write_text(POLE.format(kind=kind, limit=limit))
    return path


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
@pytest.mark.parametrize("kind", UNLIMITED)
def test_it_settles_beyond_half_a_turn(tmp_path, kind, engine):
    robot = load_robot(pole(tmp_path / "pole.urdf", kind, UNLIMITED[kind]))
    arm = SimulatedArm(robot, engine=engine, q0=[3.0])
    outcome = arm.apply([TORQUE])
    assert isinstance(outcome, Settled)
    assert outcome.q == pytest.approx([REST], abs=1e-6)
    assert abs(wrap(arm.home - np.pi)) < 0.01
    arm = SimulatedArm(robot, engine=engine, q0=[3.0 - 3 * TURN])
    assert arm.apply([TORQUE]).q == pytest.approx([REST - 3 * TURN], abs=1e-6)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_revolute_joint_with_limits_stops_there(tmp_path, engine):
    limit = f'<limit lower="{-np.pi}" upper="{np.pi}" effort="10" velocity="5"/>'
    robot = load_robot(pole(tmp_path / "pole.urdf", "revolute", limit))
    outcome = SimulatedArm(robot, engine=engine, q0=[3.0], home=[3.0]).apply([TORQUE])
    assert isinstance(outcome, LimitHit)
    assert outcome.q == pytest.approx([np.pi])


def test_the_command_line_goes_beyond_half_a_turn(tmp_path, capsys):
    path = str(pole(tmp_path / "pole.urdf"))
    assert status(["simulate", path, "--from", "3.0", "--torque", str(TORQUE)]) == 0
    assert capsys.readouterr().out.startswith("settled at q = ")


@pytest.mark.parametrize("strategy", ["direction-sampling", "lattice"])
def test_a_model_of_it_is_learned_and_judged(tmp_path, strategy):
    path = str(pole(tmp_path / "pole.urdf"))
    options = ["--strategy", strategy, "--samples", "40", "--quiet"]
    options += ["--learner", "recursive-least-squares"] if strategy != "lattice" else []
    assert status(["learn", path, "--out", str(tmp_path / "out"), *options, "--json"]) == 0
