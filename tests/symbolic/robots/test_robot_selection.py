"""Parts of robots: Pinocchio's own reduction, added inertia and gravity are the oracle."""

from __future__ import annotations

import math
import re
import shlex
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.load_robot import Robot, load_robot
from isotorque.symbolic.robots.urdf.urdf_elements import Mimic, UrdfJoint, UrdfLink
from isotorque.symbolic.robots.urdf.urdf_file import Urdf, parse_urdf, urdf_text
from tests.symbolic.robots.urdf.urdf_strategies import (
    angles,
    lengths,
    rounded_right_angles,
    skew_axes,
    urdfs,
)

positions = st.one_of(angles, rounded_right_angles)
down = st.one_of(
    st.sampled_from([(0.0, 0.0, -9.81), (9.81, 0.0, 0.0), (0.0, 3e-6, -9.81)]),
    skew_axes.map(lambda v: tuple(9.81 * x for x in v)),
)


def saved(tmp_path_factory, urdf: Urdf) -> str:
    path = tmp_path_factory.mktemp("urdf") / "arm.urdf"
    path.write_text(urdf_text(urdf))
    return str(path)


def gravity(model: pin.Model, q: np.ndarray) -> np.ndarray:
    return pin.computeGeneralizedGravity(model, model.createData(), q)


def error_beyond_bound(robot: Robot, truth: pin.Model, rng: np.random.Generator) -> float:
    """How far torques are from those of another model of the same joints, less the bound."""
    assert list(truth.names)[1:] == list(robot.joint_names)
    worst = -np.inf
    for q in rng.uniform(-np.pi, np.pi, (10, robot.n)):
        theirs = gravity(truth, robot.source_configuration(q))
        error = np.abs(gravity(robot.model, q) - theirs) - robot.snap_bound
        worst = max(worst, float((error / (1 + np.abs(theirs).max())).max()))
    return worst


def reduced(model: pin.Model, still: dict[str, float]) -> pin.Model:
    """Pinocchio's own reduction, of joints with one angle or length."""
    q = pin.neutral(model)
    for name, position in still.items():
        joint = model.joints[model.getJointId(name)]
        turned = [math.cos(position), math.sin(position)] if joint.nq == 2 else [position]
        q[joint.idx_q : joint.idx_q + joint.nq] = turned
    return pin.buildReducedModel(model, [model.getJointId(name) for name in still], q)


def with_slides(urdf: Urdf, slides: set[str]) -> Urdf:
    """Some joints made prismatic."""
    return replace(
        urdf,
        joints=tuple(
            replace(j, kind="prismatic", lower=-0.3, upper=0.4) if j.name in slides else j
            for j in urdf.joints
        ),
    )


@given(urdfs(angle=positions), st.data(), down, st.booleans(), st.integers(0, 2**32))
def test_gravity_of_a_part_is_pinocchios(tmp_path_factory, urdf, data, direction, snap, seed):
    moving = [joint.name for joint in urdf.joints if joint.moves]
    assume(len(moving) > 1)
    order = data.draw(st.permutations(moving))
    still = order[: data.draw(st.integers(0, len(moving) - 1))]
    lock = {name: data.draw(positions) for name in still}
    slides = set(still[: data.draw(st.integers(0, len(still)))])
    urdf = with_slides(urdf, slides)
    carried = data.draw(st.lists(st.tuples(st.floats(0.0, 5.0), lengths, lengths, lengths)))[:2]
    last = next(j.child for j in urdf.joints if j.name == order[-1])
    robot = load_robot(
        saved(tmp_path_factory, urdf),
        lock=lock,
        gravity=direction,
        payload=[f"{m!r},{x!r},{y!r},{z!r}@{last}" for m, x, y, z in carried],
        snap=snap,
        allow_massless=True,
    )
    truth = pin.buildModelFromXML(urdf_text(urdf))
    frame = truth.frames[truth.getFrameId(last)]
    for mass, *centre in carried:
        point = pin.Inertia(mass, np.array(centre), np.zeros((3, 3)))
        truth.appendBodyToJoint(frame.parentJoint, point, frame.placement)
    truth = reduced(truth, lock)
    truth.gravity.linear = np.array(direction)
    assert error_beyond_bound(robot, truth, np.random.default_rng(seed)) < 1e-12
    assert snap or robot.snaps == ()


@given(urdfs(angle=positions), st.data(), down, st.integers(0, 2**32))
def test_gravity_of_a_part_of_a_model_is_pinocchios(urdf, data, direction, seed):
    moving = [joint.name for joint in urdf.joints if joint.moves]
    assume(len(moving) > 1)
    still = data.draw(st.lists(st.sampled_from(moving), unique=True, max_size=len(moving) - 1))
    lock = {name: data.draw(positions) for name in still}
    model = pin.buildModelFromXML(urdf_text(urdf))
    last = next(j.child for j in urdf.joints if j.name in moving and j.name not in still)
    before = model.copy()
    robot = load_robot(
        model, lock=lock, gravity=direction, payload=f"2.0,0.1,0,0@{last}", allow_massless=True
    )
    assert model == before
    truth = model.copy()
    frame = truth.frames[truth.getFrameId(last)]
    point = pin.Inertia(2.0, np.array([0.1, 0.0, 0.0]), np.zeros((3, 3)))
    truth.appendBodyToJoint(frame.parentJoint, point, frame.placement)
    truth = reduced(truth, lock)
    truth.gravity.linear = np.array(direction)
    assert error_beyond_bound(robot, truth, np.random.default_rng(seed)) < 1e-12


@given(urdfs(), st.data())
def test_joints_and_lock_say_the_same(tmp_path_factory, urdf, data):
    moving = [joint.name for joint in urdf.joints if joint.moves]
    kept = data.draw(st.lists(st.sampled_from(moving), unique=True, min_size=1))
    path = saved(tmp_path_factory, urdf)
    still = [name for name in moving if name not in kept]
    first = load_robot(path, joints=kept, allow_massless=True)
    assert first.digest == load_robot(path, lock=still, allow_massless=True).digest


@given(urdfs(), st.data())
def test_a_tip_keeps_the_chain_from_the_root(tmp_path_factory, urdf, data):
    """Against a climb of our own."""
    above = {joint.child: joint for joint in urdf.joints}
    tip = data.draw(st.sampled_from([link.name for link in urdf.links]))
    chain, link = set(), tip
    while link in above:
        chain |= {above[link].name} if above[link].moves else set()
        link = above[link].parent
    path = saved(tmp_path_factory, urdf)
    if not chain:
        with pytest.raises(InputError, match="number of moving joints is 0"):
            load_robot(path, tip=tip, allow_massless=True)
        return
    robot = load_robot(path, tip=tip, allow_massless=True)
    assert set(robot.joint_names) == chain
    # what is beyond the tip and aside stays as dead weight
    still = [j.name for j in urdf.joints if j.moves and j.name not in chain]
    assert robot.digest == load_robot(path, lock=still, allow_massless=True).digest


def arm(*more: UrdfJoint) -> Urdf:
    """Two revolute joints, and others beyond with a link of 0.1 kg each."""
    joints = [
        UrdfJoint("j1", "continuous", "base", "upper", axis=(0.0, 1.0, 0.0)),
        UrdfJoint(
            "j2",
            "revolute",
            "upper",
            "hand",
            (0.3, 0, 0),
            axis=(0.0, 1.0, 0.0),
            lower=-2.0,
            upper=-0.5,
        ),
        *more,
    ]
    links = [UrdfLink("base"), UrdfLink("upper", 2.0, (0.1, 0, 0))]
    links += [UrdfLink(joint.child, 0.1, (0.05, 0.0, 0.0)) for joint in joints[1:]]
    return Urdf("arm", "base", tuple(links), tuple(joints))


def text(urdf: Urdf) -> str:
    """As a file, with who follows whom."""
    out = urdf_text(urdf)
    for joint in urdf.joints:
        if joint.mimic is not None:
            m = joint.mimic
            more = f'<mimic joint="{m.joint}" multiplier="{m.multiplier}" offset="{m.offset}"/>'
            out = re.sub(rf'(<joint name="{joint.name}" .*?)(</joint>)', rf"\1{more}\2", out)
    assert parse_urdf(out.encode(), "again").joints[-1].mimic == urdf.joints[-1].mimic
    return out


def finger(name: str, follows: Mimic | None = None, kind: str = "prismatic") -> UrdfJoint:
    return UrdfJoint(
        name,
        kind,
        "hand",
        f"{name}_link",
        axis=(0.0, 1.0, 0.0),
        lower=0.01,
        upper=0.04,
        mimic=follows,
    )


GRIPPERS = {
    "one": [finger("grip")],
    "two": [finger("finger_left"), finger("finger_right")],
    "mimic": [finger("finger_1"), finger("finger_2", Mimic("finger_1"))],
    "mimic of a knuckle": [
        finger("knuckle", kind="revolute"),
        *[finger(f"pad_{i}", Mimic("knuckle"), "revolute") for i in range(9)],
    ],
    "mimic of the arm": [finger("cover", Mimic("j2", -1.0, 0.3), "revolute")],
    "mimic of nobody": [finger("cover", Mimic("j9"), "revolute")],
    "planar": [finger("puck", kind="planar"), finger("ball", kind="floating")],
    "names with spaces": [finger("left finger"), finger("right 'finger'")],
}


@pytest.mark.parametrize("case", GRIPPERS)
def test_the_refusal_names_all_and_its_advice_works(tmp_path, case):
    path = tmp_path / "arm.urdf"
    path.write_text(text(arm(*GRIPPERS[case])))
    with pytest.raises(InputError) as caught:
        load_robot(path)
    message = str(caught.value)
    assert "\n" not in message
    refused = [j for j in GRIPPERS[case] if j.kind != "revolute" or j.mimic is not None]
    assert all(f"'{joint.name}' (" in message for joint in refused)
    advised = shlex.split(message.split("are locked: ")[1])
    assert advised[::2] == ["--lock"] * (len(advised) // 2)
    robot = load_robot(path, lock=advised[1::2])
    assert robot.joint_names == ("j1", "j2")
    assert sum(robot.tree.masses) == pytest.approx(2.1 + 0.1 * len(GRIPPERS[case]))


def test_a_hand_that_one_joint_leads_is_locked_by_that_joint(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(text(arm(*GRIPPERS["mimic of a knuckle"])))
    with pytest.raises(InputError, match=r"are locked: --lock knuckle$"):
        load_robot(path)


@pytest.mark.parametrize(
    ("lock", "lengths"),
    [
        (["finger_1"], (0.01, 0.02 + 0.001)),
        (["finger_1=0.03"], (0.03, 0.06 + 0.001)),
        (["finger_*=0.03"], (0.03, 0.03)),
        ({"finger_1": 0.02, "finger_2": 0.04}, (0.02, 0.04)),
        (["finger_*", "finger_1=0.02"], (0.02, 0.041)),
    ],
)
def test_where_a_locked_joint_stands(tmp_path, lock, lengths):
    """At 0 or the nearest place, where it is told, or where the one that it follows puts it."""
    path = tmp_path / "arm.urdf"
    follower = finger("finger_2", Mimic("finger_1", 2.0, 0.001))
    path.write_text(text(arm(finger("finger_1"), follower)))
    robot = load_robot(path, lock=lock)
    assert robot.tree.levers[1, 1] == pytest.approx(0.1 * sum(lengths) / 0.3, abs=1e-15)


def test_a_revolute_joint_stands_at_the_nearest_place_within_its_limits(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(text(arm()))
    near, told = load_robot(path, lock=["j2"]), load_robot(path, lock=["j2=-0.5"])
    assert near.digest == told.digest != load_robot(path, lock=["j2=0"]).digest


WRONG = {
    "no such joint": ({"lock": ["elbow"]}, "--lock is 'elbow'"),
    "glob without joint": ({"lock": ["x*=1"]}, "--lock is 'x*'"),
    "no number": ({"lock": ["j1=up"]}, "--lock is 'j1=up'"),
    "nan": ({"lock": {"j1": math.nan}}, "--lock"),
    "no such joint to keep": ({"joints": "j1,elbow"}, "--joints is 'elbow'"),
    "nothing to keep": ({"joints": ","}, "--joints"),
    "kept and locked": ({"joints": "j1", "lock": ["j*"]}, "--joints is 'j1'"),
    "kept and off the chain": ({"joints": "j2", "tip": "upper"}, "--joints is 'j2'"),
    "no such link": ({"tip": "foot"}, "--tip is 'foot'"),
    "all locked": ({"lock": ["*"]}, "moving joints is 0"),
    "tip that is the root": ({"tip": "base"}, "moving joints is 0"),
    "two numbers": ({"gravity": "1,2"}, "--gravity is '1,2'"),
    "infinite gravity": ({"gravity": (0, 0, math.inf)}, "--gravity"),
    "payload at no link": ({"payload": "1@foot"}, "link of --payload is 'foot'"),
    "payload at the base": ({"payload": "1@base"}, "link of --payload is 'base'"),
    "negative payload": ({"payload": -1}, "--payload"),
    "payload of words": ({"payload": "heavy"}, "--payload is 'heavy'"),
    "payload of two numbers": ({"payload": "1,2"}, "--payload is '1,2'"),
    "payload without link": ({"payload": "1@"}, "--payload"),
}


@pytest.mark.parametrize("case", WRONG)
def test_options_that_do_not_fit_are_refused(tmp_path, case):
    path = tmp_path / "arm.urdf"
    path.write_text(text(arm()))
    options, expected = WRONG[case]
    with pytest.raises(InputError) as caught:
        load_robot(path, **options)
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_position_of_a_joint_with_several_is_refused(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(text(arm(finger("puck", kind="planar"))))
    assert load_robot(path, lock=["puck"]).n == load_robot(path, lock=["puck=0"]).n == 2
    with pytest.raises(InputError, match=r"position of planar joint 'puck' is 1\.0"):
        load_robot(path, lock=["puck=1"])


def test_a_payload_hangs_on_the_last_link_that_moves(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(text(arm(finger("grip"))))
    carried = load_robot(path, lock=["grip"], payload="1.5,0.1,0,0.2")
    told = load_robot(path, lock=["grip"], payload="1.5,0.1,0,0.2@hand")
    assert carried.digest == told.digest
    assert carried.tree.masses[1] == pytest.approx(1.7)
    two = arm(UrdfJoint("j3", "continuous", "upper", "other hand"))
    path.write_text(text(two))
    with pytest.raises(InputError, match=r"2 chains end \(hand, other hand\)"):
        load_robot(path, payload=1)
    with pytest.raises(InputError, match=r"2 chains end \(j2, j3\)"):
        load_robot(pin.buildModelFromXML(urdf_text(two)), payload=1)
    assert load_robot(path, payload="1@other hand").tree.masses[2] == pytest.approx(1.1)


def test_what_is_snapped_in_a_part_is_listed(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(text(arm()))
    robot = load_robot(path, lock=["j2=1.5708"], gravity=(1e-5, 0, 9.81))
    assert [(s.joint, s.what) for s in robot.snaps] == [
        ("j2", "locked angle"),
        ("gravity", "direction"),
    ]
    assert robot.tree.gravity[0] == robot.tree.levers[0, 1] == 0.0
    assert np.all(robot.snap_bound > 0)


def test_options_are_the_same_in_every_spelling():
    spelled = RobotOptions(
        "a.urdf",
        lock=["f*", "lift=0.1"],
        joints="a, b",
        tip="hand",
        gravity="0,0,-1.62",
        payload="1.5,0,0,0.1@hand",
    )
    same = RobotOptions(
        "a.urdf",
        lock={"f*": None, "lift": 0.1},
        joints=["a", "b"],
        tip="hand",
        gravity=np.array([0.0, 0.0, -1.62]),
        payload=spelled.payload[0],
    )
    assert spelled == same
    assert hash(spelled) == hash(same)
    assert RobotOptions.from_json("a.urdf", spelled.as_json()) == spelled
    assert RobotOptions("a.urdf").arguments() == []
    assert RobotOptions("a.urdf").as_json() == {}
    assert RobotOptions("b", snap=False).beside(spelled) == replace(spelled, spec="b", snap=False)


@pytest.mark.parametrize(
    "data", [[], {"lock": "f*"}, {"speed": 1}, {"snap": "no"}, {"gravity": [1]}, {"payload": ["x"]}]
)
def test_damaged_options_are_refused(data):
    with pytest.raises(InputError):
        RobotOptions.from_json("a.urdf", data)
