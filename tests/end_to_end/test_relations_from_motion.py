"""An arm that only moves yields its own relations, whatever the recording calls it."""

from importlib.resources import files

import numpy as np
import pytest

from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.recordings.recorded_simulation import RecordedSimulation
from isotorque.learning.recordings.recording import Recording
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.scheme import Scheme
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from tests.learning.static_data import same_group


def tilted_two_link(path, *, tilt, twist, masses):
    """The 2R arm with a tilted base, a twisted elbow axis and centres of mass off the rods."""
    text = files("isotorque.symbolic").joinpath("robot_files/2r.urdf").read_text()
    upper, forearm = '<child link="upper_arm"/>', '<origin xyz="0.25 0 0"/>'
    assert text.count(upper) == text.count(forearm) == 1
    text = text.replace(upper, f'{upper}<origin rpy="{tilt}"/>')
    text = text.replace(forearm, f'<origin xyz="0.25 0 0" rpy="{twist} 0 0"/>')
    head, middle, tail = text.split('<origin xyz="0.125 0 0"/>')
    first, second = (f'<origin xyz="{mass}"/>' for mass in masses)
    path.write_text(head + first + middle + second + tail)
    return load_robot(str(path))


def true_group(robot):
    return primary_symmetries(GravityModel(robot).potential)


def discovered(arm):
    scheme = Scheme(arm, np.random.default_rng(0), lambda group, span: None)
    for _ in scheme.discover():
        pass
    return scheme.learned


ARMS = [
    # in plane: all relations survive, with offsets that are no right angles
    ("0.3 0.4 0", 0.0, ("0.125 0.01 0.03", "0.11 0 -0.02"), 8),
    # a twisted elbow: q2 alone acts, half of them break
    ("0 0.4 0", 0.5, ("0.125 0 0", "0.125 0 0"), 4),
    # masses beside the rods: only the half turn of the shoulder is left
    ("0 0.4 0", 0.5, ("0.125 0.02 0.03", "0.125 0 0.03"), 2),
    # and nothing once gravity has a share along the shoulder's axis
    ("0.3 0.4 0", 0.5, ("0.125 0.01 0.03", "0.11 0.02 -0.02"), 1),
]


@pytest.mark.parametrize(("tilt", "twist", "masses", "order"), ARMS)
def test_a_tilted_arm_yields_its_own_group(tmp_path, tilt, twist, masses, order):
    robot = tilted_two_link(tmp_path / "arm.urdf", tilt=tilt, twist=twist, masses=masses)
    truth = true_group(robot)
    assert truth.order == order
    learned = discovered(SimulatedArm(robot))
    assert learned.missing is None
    assert same_group(learned.group, truth, 1e-6)


def test_a_recording_under_a_false_name_yields_the_relations_of_the_arm_that_moved(tmp_path):
    tilt, twist, masses, order = ARMS[1]
    robot = tilted_two_link(tmp_path / "arm.urdf", tilt=tilt, twist=twist, masses=masses)
    label = load_robot("2r")
    info = RunInfo(label.name, label.digest, label.joint_names, seed=0)
    with Recording.create(tmp_path / "run.sqlite", info) as recording:
        arm = RecordedSimulation(SimulatedArm(robot), recording, phase="discovery")
        during = discovered(arm)
        samples = recording.reader().samples()
    after = learn_relations(samples.q, samples.tau)
    assert true_group(label).order == 8
    assert during.order == after.order == order
    assert same_group(after.group, true_group(robot), 1e-6)
