import dataclasses

import numpy as np
import pinocchio as pin
import pytest
import sympy
from flint import fmpq
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.c_source import gravity_c
from isotorque.symbolic.gravity.gravity_model import GravityMismatch, GravityModel
from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.gravity.recursion import GravityChain
from isotorque.symbolic.robots.builtin_robots import builtin_robots
from isotorque.symbolic.robots.kinematic_tree import human_arm, planar_arm
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.strategies import configurations, kinematic_trees, models, robots

BUILT_IN = [robot.name for robot in builtin_robots()]


def pinocchio_torque(robot, q):
    data = robot.source_model.createData()
    x = robot.source_configuration(q)
    return np.array(pin.computeGeneralizedGravity(robot.source_model, data, x))


def check_against_pinocchio(robot, q):
    """Both forms equal Pinocchio to 1e-10 of the largest torque, and what snapping may change."""
    gravity = GravityModel(robot)
    scale = max(gravity.potential.gradient_bound().max(initial=0.0), 1e-3)
    expected = pinocchio_torque(robot, q)
    allowed = 1e-10 * scale + robot.snap_bound
    gradient = gravity.potential.gradient(q)
    assert (np.abs(gravity.torque(q) - expected) <= allowed).all()
    assert (np.abs(gradient - expected) <= allowed).all()
    np.testing.assert_allclose(gravity.torque(q), gradient, rtol=0, atol=1e-12 * scale)


@given(robots(max_joints=5), st.data())
@settings(max_examples=50)
def test_random_arms_agree_with_pinocchio(robot, data):
    check_against_pinocchio(robot, data.draw(configurations(robot.n)))


@pytest.mark.slow
@given(robots(max_joints=7), st.data())
@settings(max_examples=600)
def test_many_random_arms_agree_with_pinocchio(robot, data):
    check_against_pinocchio(robot, data.draw(configurations(robot.n)))


@given(robots(max_joints=4, branched=False), st.data())
@settings(max_examples=30)
def test_stiffness_of_chains_agrees_with_pinocchio(robot, data):
    """Chains alone: Pinocchio 4.1 leaves out entries if a branch's joints are not in sequence."""
    q = data.draw(configurations(robot.n))
    gravity = GravityModel(robot)
    scale = max(gravity.potential.gradient_bound().max(initial=0.0), 1e-3)
    expected = pin.computeGeneralizedGravityDerivatives(robot.model, robot.model.createData(), q)
    np.testing.assert_allclose(gravity.stiffness(q), expected, rtol=0, atol=1e-10 * scale)


@given(robots(max_joints=5, massless=True), st.data())
@settings(max_examples=30)
def test_stiffness_is_the_derivative_of_the_torque(robot, data):
    q = data.draw(configurations(robot.n))
    gravity = GravityModel(robot)
    scale = max(gravity.potential.gradient_bound().max(initial=0.0), 1e-3)
    stiffness = gravity.stiffness(q)
    hessian = gravity.potential.hessian(q)
    np.testing.assert_allclose(stiffness, hessian, rtol=0, atol=1e-12 * scale)
    np.testing.assert_array_equal(stiffness, stiffness.T)
    step = 1e-5 * np.eye(robot.n)
    slope = (gravity.torque(q + step) - gravity.torque(q - step)) / 2e-5
    np.testing.assert_allclose(stiffness, slope.T, rtol=0, atol=1e-8 * scale)


@pytest.mark.parametrize("name", BUILT_IN)
def test_built_in_robots_agree_with_pinocchio(name):
    robot = load_robot(name)
    gravity = GravityModel(robot)
    for q in np.random.default_rng(1).uniform(-4, 4, (20, robot.n)):
        scale = np.abs(pinocchio_torque(robot, q)).max()
        difference = np.abs(gravity.torque(q) - pinocchio_torque(robot, q))
        assert np.all(difference <= robot.snap_bound + 1e-10 * scale)


def test_the_papers_2r_arm_has_its_torque_amplitudes():
    gravity = GravityModel(load_robot("2r"))
    assert gravity.potential.frequencies.tolist() == [[1, 0], [1, 1]]
    np.testing.assert_allclose(gravity.potential.to_float().sin, [18.39, 6.13], atol=5e-3)
    np.testing.assert_allclose(gravity.potential.gradient_bound(), [24.5, 6.2], atol=0.1)


# -- the check ---------------------------------------------------------------------------------


@given(models(max_joints=3), st.data())
@settings(max_examples=25)
def test_a_lost_tool_is_noticed(model, data):
    """Derive from a tree that lacks a mass that Pinocchio knows."""
    robot = load_robot(model)
    i = data.draw(st.integers(0, robot.n - 1))
    tool = np.zeros(robot.n)
    tool[i] = 0.5
    loaded = dataclasses.replace(robot.tree, masses=robot.tree.masses + tool)
    q = np.random.default_rng(5).uniform(-3, 3, (10, robot.n))
    effect = np.abs(GravityModel(loaded).torque(q) - GravityModel(robot).torque(q)).max()
    assume(effect > 1e-6)  # a mass on the axes changes nothing
    with pytest.raises(GravityMismatch, match="difference to Pinocchio's gravity torque of joint"):
        GravityModel(dataclasses.replace(robot, tree=loaded))


def test_mismatch_says_which_joint_by_how_much_and_what_is_allowed():
    robot = load_robot("2r")
    heavier = dataclasses.replace(robot.tree, masses=robot.tree.masses * [1.0, 1.001])
    with pytest.raises(GravityMismatch) as caught:
        GravityModel(dataclasses.replace(robot, tree=heavier))
    assert isinstance(caught.value, InputError)
    assert caught.value.joint == "shoulder"
    # 0.1 % of what the second link weighs in on joint 1: (12.26 + 6.13) / 1000
    assert 0.01 < caught.value.error < 0.0184
    assert caught.value.allowed < 1e-8
    assert str(caught.value).startswith(
        "2r: difference to Pinocchio's gravity torque of joint 'shoulder' is 0.01"
    )
    assert "\n" not in str(caught.value)


def test_a_torque_that_is_not_a_number_is_a_mismatch():
    robot = load_robot("2r")
    model = robot.source_model.copy()
    model.gravity.linear = np.array([0.0, 0.0, np.nan])
    with pytest.raises(GravityMismatch):
        GravityModel(dataclasses.replace(robot, source_model=model))


def test_a_recursion_that_is_wrong_gives_no_answer(monkeypatch):
    """It is checked before its first answer, whichever that is."""
    right = GravityChain.of
    heavier = classmethod(
        lambda cls, tree: right(dataclasses.replace(tree, masses=tree.masses * [1.0, 1.001]))
    )
    monkeypatch.setattr(GravityChain, "of", heavier)
    for answer in (
        lambda gravity: gravity.torque([0.0, 0.0]),
        lambda gravity: gravity.stiffness([0.0, 0.0]),
        lambda gravity: gravity.max_error_vs_pinocchio,
        lambda gravity: gravity.chain,
        gravity_c,
    ):
        gravity = GravityModel(load_robot("2r"))
        with pytest.raises(GravityMismatch, match=r"joint 'shoulder' is 0\.01"):
            answer(gravity)


@pytest.fixture
def rounded(tmp_path):
    """A 2R arm, its second axis turned by a rounded right angle."""
    text = (
        '<robot name="rounded"><link name="base"/>'
        '<joint name="a" type="continuous"><parent link="base"/><child link="l1"/>'
        '<axis xyz="0 -1 0"/></joint>'
        '<link name="l1"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="b" type="continuous"><parent link="l1"/><child link="l2"/>'
        '<origin xyz="0.3 0 0" rpy="1.5708 0 0"/><axis xyz="0 0 1"/></joint>'
        '<link name="l2"><inertial><origin xyz="0.2 0.1 0.3"/><mass value="3"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    path = tmp_path / "rounded.urdf"
    path.write_text(text)
    return path


def test_the_check_allows_for_snapping_and_no_more(rounded):
    robot = load_robot(rounded)
    gravity = GravityModel(robot)
    assert 1e-7 < gravity.max_error_vs_pinocchio <= robot.snap_bound.max()
    with pytest.raises(GravityMismatch):
        GravityModel(dataclasses.replace(robot, snap_bound=np.zeros(2)))
    unsnapped = GravityModel(load_robot(rounded, snap=False))
    assert unsnapped.max_error_vs_pinocchio < 1e-13


def test_a_tree_has_nothing_to_be_checked_against():
    assert GravityModel(load_robot("3r").tree).max_error_vs_pinocchio is None


# -- shapes ------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(), (1,), (4,), (0,), (2, 3)])
def test_batches_of_any_shape(shape):
    gravity = GravityModel(load_robot("3r"))
    q = np.random.default_rng(2).normal(size=(*shape, 3))
    torque, stiffness = gravity.torque(q), gravity.stiffness(q)
    assert torque.shape == (*shape, 3)
    assert stiffness.shape == (*shape, 3, 3)
    for index in np.ndindex(shape):
        np.testing.assert_array_equal(torque[index], gravity.torque(q[index]))
        np.testing.assert_array_equal(stiffness[index], gravity.stiffness(q[index]))


def test_any_array_like_will_do_and_is_left_alone():
    gravity = GravityModel(load_robot("2r"))
    q = np.array([[0.1, 0.2], [0.3, 0.4]])
    expected = gravity.torque(q)
    frozen = q.copy()
    frozen.flags.writeable = False
    for same in (q.tolist(), np.asfortranarray(q), frozen, np.repeat(q, 2, axis=0)[::2]):
        np.testing.assert_array_equal(gravity.torque(same), expected)
    np.testing.assert_array_equal(gravity.torque([0, 1]), gravity.torque([0.0, 1.0]))
    np.testing.assert_array_equal(q, [[0.1, 0.2], [0.3, 0.4]])


@pytest.mark.parametrize("q", [0.0, [0.0], [0.0, 0.0, 0.0], np.zeros((2, 1))])
def test_wrong_shapes_are_refused(q):
    gravity = GravityModel(load_robot("2r"))
    for question in (gravity.torque, gravity.stiffness):
        with pytest.raises(InputError, match=r"configuration: shape is .* accepted: \(\.\.\., 2\)"):
            question(q)


# -- free joints -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "free"),
    [
        ("2r", ()),
        ("3r", ()),
        ("ur5", ("shoulder_pan_joint", "wrist_2_joint", "wrist_3_joint")),
        ("panda", ("panda_joint1",)),
    ],
)
def test_free_joints_of_built_in_robots(name, free):
    assert GravityModel(load_robot(name)).free_joints == free


@given(kinematic_trees(max_joints=4), st.data())
@settings(max_examples=40)
def test_free_joints_neither_feel_nor_matter(tree, data):
    gravity = GravityModel(tree)
    free = np.array([name in gravity.free_joints for name in tree.joint_names])
    q, p = (data.draw(configurations(tree.n)) for _ in range(2))
    scale = 1e-11 * (1 + gravity.potential.gradient_bound().max())
    np.testing.assert_allclose(gravity.torque(q)[free], 0, atol=scale)
    moved = np.where(free, p, q)
    np.testing.assert_allclose(gravity.torque(moved), gravity.torque(q), atol=scale)
    assert np.all(gravity.potential.gradient_bound()[~free] > 0)


# -- symbols and exact numbers -----------------------------------------------------------------


def test_parametric_2r_has_the_textbook_torque_and_components():
    """Siciliano et al., Robotics 2009, section 7.3.2, without motors."""
    q1, q2 = q = sympy.symbols("q1 q2", real=True)
    m1, m2, l1, c1, c2, g = sympy.symbols("m1 m2 l1 c1 c2 g", positive=True)
    textbook = [
        (m1 * c1 + m2 * l1) * g * sympy.cos(q1) + m2 * c2 * g * sympy.cos(q1 + q2),
        m2 * c2 * g * sympy.cos(q1 + q2),
    ]
    gravity = GravityModel(planar_arm(2))
    assert gravity.is_symbolic
    for mine, expected in zip(gravity.components, textbook, strict=True):
        assert sympy.expand(mine.to_sympy(q) - expected) == 0


@pytest.mark.parametrize("tree", [planar_arm(3), human_arm()])
def test_numbers_put_in_before_or_after_derivation_are_the_same(tree):
    names = ("m1", "m2", "m3", "l1", "l2", "c1", "c2", "c3", "g")
    rng = np.random.default_rng(0)
    symbols = {
        s.name: s
        for x in (*tree.masses, *tree.levers[:, 0], *tree.translations[:, 0], tree.gravity[2])
        for s in sympy.sympify(x).free_symbols
    }
    values = {name: float(rng.uniform(0.2, 2)) for name in names if name in symbols}
    numbers = {symbols[name]: value for name, value in values.items()}
    q = rng.normal(size=3)
    angles = dict(zip(sympy.symbols("q1:4", real=True), q, strict=True))
    before = GravityModel(tree.substitute(values)).torque(q)
    after = [
        float(f.to_sympy(tuple(angles)).subs({**numbers, **angles}))
        for f in GravityModel(tree).components
    ]
    np.testing.assert_allclose(before, after, rtol=1e-12, atol=1e-12)


def test_a_model_with_symbols_has_no_numbers():
    gravity = GravityModel(planar_arm(2))
    for question in (gravity.torque, gravity.stiffness):
        with pytest.raises(InputError, match="substitute the symbols"):
            question([0.0, 0.0])


def test_floats_and_the_rationals_they_are_give_one_model():
    tree = load_robot("3r").tree
    q = np.array([0.3, -0.4, 1.2])
    floats, rationals = GravityModel(tree), GravityModel(tree.exact())
    assert len(floats.potential - rationals.potential) == 0
    np.testing.assert_array_equal(floats.torque(q), rationals.torque(q))


def test_components_leave_out_what_stands_for_rounding():
    """A generic twist: its cosine and sine, as rationals, miss cos^2 + sin^2 = 1 by an ulp."""
    tree = load_robot("3r").tree
    twist = pin.utils.rotate("y", 0.3) @ pin.utils.rotate("y", -0.3)
    tree = dataclasses.replace(tree, rotations=np.array([twist, *tree.rotations[1:]]))
    gravity = GravityModel(tree)
    assert len(gravity.significant_potential) <= len(gravity.potential)
    q = np.array([0.3, -0.4, 1.2])
    components = [f.evaluate(q) for f in gravity.components]
    np.testing.assert_allclose(components, gravity.torque(q), atol=1e-11)


@pytest.mark.parametrize("form", ["potential", "torque"])
@pytest.mark.parametrize("share", [1e-9, 1e-3, 1.0])
def test_each_of_both_forms_is_checked_by_itself(monkeypatch, form, share):
    """The potential is what proofs are about, the recursion is what numbers come from."""
    module = "isotorque.symbolic.gravity.gravity_model"
    if form == "potential":
        monkeypatch.setattr(
            f"{module}.derive_potential",
            lambda tree: derive_potential(tree) * (1 + fmpq(int(share * 10**9), 10**9)),
        )
        with pytest.raises(GravityMismatch):
            GravityModel(load_robot("2r"))
        return
    torque = GravityChain.torque
    monkeypatch.setattr(GravityChain, "torque", lambda self, q: (1 + share) * torque(self, q))
    gravity = GravityModel(load_robot("2r"))
    with pytest.raises(GravityMismatch):
        gravity.torque([0.1, 0.2])
    with pytest.raises(GravityMismatch):
        gravity.stiffness([0.1, 0.2])
