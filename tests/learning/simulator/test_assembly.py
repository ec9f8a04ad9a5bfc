"""What an arm is given before it moves: free directions, damping, friction, limits, home."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.simulator.assembly import assemble
from isotorque.learning.simulator.compiled.chain import CompiledEquations
from isotorque.learning.simulator.default_damping import default_damping
from isotorque.learning.simulator.dynamics.free_directions import find_free_directions
from isotorque.learning.simulator.dynamics.home import STABLE, find_home
from isotorque.learning.simulator.dynamics.mass_matrix_check import check_mass_matrix
from isotorque.learning.simulator.settings import PhysicsMode
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.random_arms import arm_models, build_arm


def prepared(name, physics=PhysicsMode.OPEN_LOOP, **options):
    robot = load_robot(name)
    given_options = {"damping": None, "coulomb": None, "limits": None, "home": None} | options
    return assemble(robot, CompiledEquations(robot.model), physics, *given_options.values())


def parallel_vertical_axes(n):
    """Return an arm whose first n joints turn about vertical axes, and a pendulum after them."""
    model = pin.Model()
    link = pin.Inertia(1.0, np.array([0.1, 0.0, 0.0]), 0.01 * np.eye(3))
    for i in range(n + 1):
        kind = pin.JointModelRZ() if i < n else pin.JointModelRY()
        placement = pin.SE3(np.eye(3), np.array([0.2, 0.0, 0.0]))
        joint = model.addJoint(i, kind, placement, f"joint{i}")
        model.appendBodyToJoint(joint, link, pin.SE3.Identity())
    return model


@pytest.mark.parametrize("n", [1, 2, 3])
def test_vertical_axes_are_free(n):
    free = find_free_directions(CompiledEquations(parallel_vertical_axes(n)))
    assert np.array_equal(free.basis, np.eye(n + 1)[:n])
    assert np.array_equal(free.projector, np.diag([0.0] * n + [1.0]))


def test_a_combination_of_joints_can_be_free():
    """Two coaxial horizontal joints: gravity feels the sum of the angles alone."""
    model = pin.Model()
    for i, inertia in enumerate(
        [
            pin.Inertia(1.0, np.zeros(3), np.eye(3)),
            pin.Inertia(1.0, np.array([0.3, 0, 0]), 0.01 * np.eye(3)),
        ]
    ):
        joint = model.addJoint(i, pin.JointModelRY(), pin.SE3.Identity(), f"joint{i}")
        model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    free = find_free_directions(CompiledEquations(model))
    assert free.basis.shape == (1, 2)
    assert np.allclose(np.abs(free.basis), np.sqrt(0.5))
    assert np.isclose(free.basis.sum(), 0.0)
    assert np.allclose(free.projector, 0.5)


@given(arm_models(1, 5), st.integers(0, 2**32 - 1))
def test_gravity_never_changes_along_free_directions_alone(model, seed):
    rng = np.random.default_rng(seed)
    equations = CompiledEquations(model)
    free = find_free_directions(equations)
    both = np.vstack([free.basis, free.active])
    assert np.allclose(both @ both.T, np.eye(model.nv), atol=1e-9)
    q = rng.uniform(-3, 3, model.nv)
    torque = equations.gravity_torque(q)
    scale = max(1.0, np.abs(torque).max())
    moved = q + rng.normal(size=len(free.basis)) @ free.basis
    assert np.allclose(equations.gravity_torque(moved), torque, atol=1e-8 * scale)
    assert np.allclose(free.projector @ torque, torque, atol=1e-8 * scale)
    stiffness = sum(
        np.abs(equations.stiffness(x) @ free.active.T) for x in rng.uniform(-3, 3, (20, model.nv))
    )
    assert len(free.active) == 0 or (stiffness.max(axis=0) > 1e-9).all()


@pytest.mark.parametrize("name", ["2r", "ur5"])
def test_anchored_stiffness_is_regular_where_the_active_part_is(name):
    robot = load_robot(name)
    equations = CompiledEquations(robot.model)
    free = find_free_directions(equations)
    damping = default_damping(equations, free.stiffness_scale)
    rng = np.random.default_rng(0)
    found = set()
    for q in rng.uniform(-3, 3, (200, robot.n)):
        stiffness = equations.stiffness(q)
        anchored = stiffness + free.anchor(damping) * damping
        assert np.allclose(anchored, anchored.T)
        stable = bool(np.linalg.eigvalsh(free.active @ stiffness @ free.active.T)[0] > 0)
        assert (np.linalg.eigvalsh(anchored)[0] > 0) == stable
        assert (free.active_stiffness(stiffness) > 0) == stable
        found.add(stable)
    assert found == {True, False}


def test_default_damping_of_the_papers_arm():
    damping = prepared("2r").body.damping
    assert 6.0 <= damping[0] <= 9.0
    assert 1.2 <= damping[1] <= 1.8


@given(arm_models(1, 4))
@settings(max_examples=30)
def test_default_damping_is_near_critical(model):
    equations = CompiledEquations(model)
    free = find_free_directions(equations)
    damping = default_damping(equations, free.stiffness_scale)
    assert (damping > 0).all()
    mass = np.max(
        [
            np.diag(equations.mass_matrix(q))
            for q in np.random.default_rng(9).uniform(-3, 3, (100, model.nv))
        ],
        axis=0,
    )
    felt = free.stiffness_scale > 0
    ratio = damping[felt] / np.sqrt(mass * free.stiffness_scale)[felt]
    assert ((ratio > 1.0) & (ratio < 3.0)).all()


def test_damping_of_the_file_comes_first():
    robot = load_robot("panda")
    damping = prepared("panda").body.damping
    named = robot.damping > 0
    assert np.array_equal(damping[named], robot.damping[named])
    assert (damping > 0).all()


@pytest.mark.parametrize("name", ["2r", "3r", "pendulum", "4r-planar", "ur5", "panda"])
def test_home_is_found_inside_limits_and_stable(name):
    assembly = prepared(name)
    equations = CompiledEquations(load_robot(name).model)
    low, high = assembly.body.limits.T
    assert ((low < assembly.home) & (assembly.home < high)).all()
    active = assembly.free.active
    stiffness = active @ equations.stiffness(assembly.home) @ active.T
    assert np.linalg.eigvalsh(stiffness)[0] > 0
    assert np.array_equal(assembly.home, prepared(name).home)


def test_the_papers_arm_hangs_at_home():
    assert np.allclose(prepared("2r").home, [-np.pi / 2, 0.0], atol=2e-3)


def test_home_keeps_to_narrow_limits():
    limits = np.array([[-0.9, -0.2], [-1.0, -0.3]])
    home = prepared("2r", limits=limits).home
    assert ((limits[:, 0] < home) & (home < limits[:, 1])).all()
    assert (
        find_home(CompiledEquations(load_robot("2r").model), prepared("2r").free, limits)[1]
        > STABLE
    )


def test_limits_without_a_stable_configuration_are_refused():
    with pytest.raises(InputError, match=r"2r: limits .* a constant torque can hold"):
        prepared("2r", limits=[[0.5, 1.5], [-0.1, 0.1]])
    # A guided arm is held from outside: anywhere will do.
    home = prepared("2r", PhysicsMode.GUIDED, limits=[[0.5, 1.5], [-0.1, 0.1]]).home
    assert 0.5 < home[0] < 1.5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"home": [0.1, 4.0]}, "home of joint .* is 4.0; accepted: an angle strictly between"),
        ({"home": [1.0, 0.0]}, "home is .* accepted: a configuration that a constant torque"),
        ({"home": [0.0]}, "home is of length 1; accepted: 2 finite numbers"),
        ({"home": [-1.5, np.nan]}, "home is .*nan"),
        ({"limits": [[-1.0, 1.0]]}, r"limits is of shape \(1, 2\)"),
        ({"limits": [[-1.0, 1.0], [1.0, 1.0]]}, "limits of joint .* is .*1.0, 1.0"),
        ({"limits": [[-1.0, 1.0], [np.nan, 1.0]]}, "limits of joint"),
        ({"limits": "soft"}, "limits is soft; accepted: 'file', 'none'"),
        ({"damping": [-1.0, 1.0]}, "damping is .* accepted: 2 numbers >= 0"),
        ({"damping": -1.0}, "damping is .* accepted: 2 numbers >= 0"),
        ({"damping": [1.0, np.inf]}, "damping is .*inf"),
        ({"coulomb": 1.0}, "coulomb is 1.0; accepted: no Coulomb friction but in 'geared'"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(options, message):
    with pytest.raises(InputError, match=message) as caught:
        prepared("2r", **options)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith("2r: ")


def test_coulomb_friction_of_geared_arms():
    robot = load_robot("2r")
    assert (prepared("2r", PhysicsMode.GEARED).body.coulomb > 0).all()
    chosen = prepared("2r", PhysicsMode.GEARED, coulomb=[0.1, 0.0]).body.coulomb
    assert np.array_equal(chosen, [0.1, 0.0])
    assert not prepared("2r").body.coulomb.any()
    robot.model.upperDryFrictionLimit = np.array([0.4, 0.0])
    equations = CompiledEquations(robot.model)
    named = assemble(robot, equations, PhysicsMode.GEARED, None, None, None, None).body.coulomb
    assert named[0] == 0.4
    assert named[1] > 0.0


def test_limits_come_from_the_file_or_the_option():
    robot = load_robot("ur5")
    assert np.array_equal(prepared("ur5").body.limits, robot.limits)
    assert np.array_equal(prepared("ur5", limits="file").body.limits, robot.limits)
    assert np.isinf(prepared("ur5", limits="none").body.limits).all()


def massless(where):
    """Return three links of which one is massless and, for the tip, without any inertia."""
    model = build_arm([0, 1, 2], ["revolute"] * 3, np.random.default_rng(4), armature=False)
    model.inertias[where] = pin.Inertia(0.0, np.zeros(3), np.zeros((3, 3)))
    return model


def test_a_tip_without_inertia_is_refused_and_named():
    with pytest.raises(InputError, match=r"robot: inertia moved by joint 'c' .* singular"):
        check_mass_matrix(CompiledEquations(massless(3)), "robot", ("a", "b", "c"))


def test_massless_links_between_heavy_ones_are_legal():
    check_mass_matrix(CompiledEquations(massless(2)), "robot", ("a", "b", "c"))
    check_mass_matrix(CompiledEquations(massless(1)), "robot", ("a", "b", "c"))


def test_two_coaxial_joints_with_nothing_between_are_refused():
    model = pin.Model()
    model.gravity.linear = np.array([0, 0, -9.81])
    load = pin.Inertia(1.0, np.array([0.3, 0, 0]), 0.01 * np.eye(3))
    for i in range(2):
        model.addJoint(i, pin.JointModelRY(), pin.SE3.Identity(), f"joint{i}")
    model.appendBodyToJoint(2, load, pin.SE3.Identity())
    with pytest.raises(InputError, match="mass matrix is singular"):
        check_mass_matrix(CompiledEquations(model), "robot", ("a", "b"))


@given(arm_models(1, 6))
@settings(max_examples=30)
def test_arms_with_inertia_everywhere_are_accepted(model):
    names = tuple(model.names)[1:]
    check_mass_matrix(CompiledEquations(model), "robot", names)
