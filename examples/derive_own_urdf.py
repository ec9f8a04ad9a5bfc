"""Derive the gravity torque and the symmetries of your own arm from its URDF file.

Usage: python examples/derive_own_urdf.py my_arm.urdf [my_arm_gravity.c]
Without arguments it takes a small wrist that is written below.
"""

import sys
import tempfile
from pathlib import Path

from isotorque.symbolic.gravity.c_source import gravity_c
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.readable import gravity_text
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

WRIST = """<?xml version="1.0"?>
<robot name="wrist">
  <link name="base"/>
  <joint name="pan" type="revolute">
    <parent link="base"/> <child link="fork"/> <axis xyz="0 0 1"/>
    <limit lower="-3.1" upper="3.1" effort="20" velocity="2"/>
  </joint>
  <link name="fork">
    <inertial>
      <origin xyz="0.02 0 0.1"/> <mass value="1.2"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <joint name="tilt" type="revolute">
    <parent link="fork"/> <child link="hand"/> <origin xyz="0 0 0.2" rpy="1.5707963 0 0"/>
    <axis xyz="0 0 1"/> <limit lower="-2" upper="2" effort="10" velocity="2"/>
  </joint>
  <link name="hand">
    <inertial>
      <origin xyz="0.08 0.01 0"/> <mass value="0.7"/>
      <inertia ixx="0.002" iyy="0.002" izz="0.002" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
</robot>
"""


def main(urdf: Path, c_file: Path | None) -> None:
    robot = load_robot(urdf)
    for snap in robot.snaps:
        print(f"{snap.what} of {snap.joint} was taken as {snap.after}, not {snap.before}")

    gravity = GravityModel(robot)  # checks itself against Pinocchio, or refuses
    print(gravity_text(gravity))
    print(f"largest difference to Pinocchio: {gravity.max_error_vs_pinocchio:.1e} N m")
    print("joints without gravity torque:", ", ".join(gravity.free_joints) or "none")

    group = primary_symmetries(gravity.potential)
    print(f"symmetry group of order {group.order}, rank {group.rank} of {robot.n}")

    if c_file:
        c_file.write_text(gravity_c(gravity))
        print(f"C source: {c_file}")


if len(sys.argv) > 1:
    main(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else None)
else:
    with tempfile.TemporaryDirectory() as folder:
        own = Path(folder) / "wrist.urdf"
        own.write_text(WRIST)
        main(own, Path(folder) / "wrist_gravity.c")
