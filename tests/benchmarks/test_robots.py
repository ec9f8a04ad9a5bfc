"""The page of robots: its writer, and groups of example-robot-data in a blink."""

import math
import time

import numpy as np
import pytest

from benchmarks import robots
from benchmarks.shared.document import write_between
from benchmarks.shared.urdf_arms import example_robots
from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.robots.kinematic_tree import KinematicTree
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

installed = pytest.mark.skipif(example_robots() is None, reason="needs example-robot-data")

BLINK = 0.2  # seconds of processor time
KNOWN = {
    "solo_description/robots/solo12.urdf": (4096, [8] * 4),
    "a1_description/urdf/a1.urdf": (256, [4] * 4),
    "allegro_hand_description/urdf/allegro_left_hand.urdf": (4096, [4, 8, 8, 16]),
    "b1_description/urdf/b1-z1.urdf": (2048, [4, 4, 4, 4, 8]),
    "anymal_b_simple_description/robots/anymal-kinova.urdf": (4096, [4, 4, 4, 4, 16]),
    "centauro_description/urdf/centauro.urdf": (262144, None),
}


@installed
@pytest.mark.parametrize("file", KNOWN)
def test_groups_of_legged_robots_take_a_blink(file):
    robot, locked = robots.load_with_grippers_locked(example_robots() / file)
    potential = derive_potential(robot.tree)
    seconds = []
    for _ in range(3):
        start = time.process_time()
        group = primary_symmetries(potential)
        proved = group.exact
        seconds.append(time.process_time() - start)
    order, factors = KNOWN[file]
    assert (group.order, proved, locked) == (order, True, [])
    found = sorted(factor.order for factor in group.direct_factors)
    assert math.prod(found) == order
    assert factors is None or found == factors
    assert min(seconds) < BLINK
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (20, robot.n))
    torque = potential.gradient(q)
    for relation in [*group.generators, group[order - 1], group[order // 3]]:
        error = potential.gradient(relation.configuration(q)) - relation.torque(torque)
        assert np.abs(error).max() < 1e-9


def two_arms(joints: int) -> KinematicTree:
    """Two arms of generic shape on one base."""
    rng = np.random.default_rng(5)
    count = 2 * joints
    return KinematicTree(
        parents=tuple(-1 if i % joints == 0 else i - 1 for i in range(count)),
        rotations=np.linalg.qr(rng.normal(size=(count, 3, 3)))[0],
        translations=rng.uniform(-0.3, 0.3, (count, 3)),
        axes=np.tile([0.0, 0.0, 1.0], (count, 1)),
        masses=rng.uniform(0.5, 3, count),
        levers=rng.uniform(-0.2, 0.2, (count, 3)),
        gravity=np.array([0.0, 0.0, -9.81]),
        joint_names=tuple(f"joint{i}" for i in range(count)),
    )


def test_two_generic_arms_take_a_blink_like_one():
    potential = derive_potential(two_arms(7)).to_float()
    start = time.process_time()
    group = primary_symmetries(potential)
    seconds = time.process_time() - start
    assert [len(factor.joints) for factor in group.direct_factors] == [7, 7]
    assert group.order == 1
    assert seconds < 10 * BLINK  # it was 74 s; thousands of frequencies


def test_the_writer_replaces_its_own_section_only(tmp_path, monkeypatch):
    page = tmp_path / "robots.md"
    name = robots.SECTION
    page.write_text(f"before\n<!-- {name} -->\nold\n<!-- end of {name} -->\nafter <!-- runs -->\n")
    rows = [{"robot": "a", "within": False, "refused": "no joint"}]
    rows.append({"robot": "b", "within": True, "joints": 2, "structure": "8: 1 block", "order": 8})
    write_between(page, name, robots.table(rows, 25.0))
    text = page.read_text()
    assert text.startswith("before\n")
    assert text.endswith("after <!-- runs -->\n")
    assert "old" not in text
    assert "1 of 2 robots within 25 s" in text
    assert "refused: no joint" in text


@installed
def test_a_robot_that_is_not_there_is_refused_in_one_line(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["robots", "no-such-robot"])
    assert robots.main() == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert error.count("\n") == 1


@installed
@pytest.mark.slow
def test_sixty_robots_are_derived_within_the_limit():
    rows = [robots.measure(path, 25.0) for path in robots.files([])]
    assert len(rows) == 69
    assert sum(row["within"] for row in rows) >= robots.DEMANDED
