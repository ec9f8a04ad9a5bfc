import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.relations.potential.potential_fit import all_frequencies, fit_potential
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.learning.static_torques.visited_torques import visited_torques
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.static_torques.judge_static_torques import judge_static_torques
from tests.learning.static_data import known_potential, stable_samples


@given(st.integers(0, 2**32 - 1), st.floats(0.02, 0.5))
def test_each_torque_holds_the_arm_somewhere_on_its_way(seed, spacing):
    potential, _ = known_potential("2r")
    rng = np.random.default_rng(seed)
    q, tau = stable_samples(potential, rng, 8)
    fit = fit_potential(q, tau, all_frequencies(2))
    way = np.cumsum(rng.normal(scale=0.03, size=(300, 2)), axis=0) + rng.uniform(-3, 3, 2)
    found = visited_torques(fit, way, spacing=spacing)
    stable = way[np.linalg.eigvalsh(potential.hessian(way)).min(axis=1) > 0]
    there = potential.gradient(stable).reshape(1, -1, 2)
    assert (np.abs(found[:, None] - there).max(axis=2).min(axis=1, initial=np.inf) < 1e-6).all()
    # without spacing every stable configuration on the way counts
    taken = visited_torques(fit, way, spacing=1e-12)
    assert len(found) <= len(taken) == len(stable)


@pytest.mark.parametrize("robot", ["2r", "3r", "ur5"])
def test_a_chain_tells_the_same_torques(robot):
    gravity = GravityModel(load_robot(robot))
    n = gravity.n
    rng = np.random.default_rng(0)
    q = rng.uniform(-3, 3, (12, n))
    chain = RigidChain().fit(q, gravity.torque(q)).snapped().chain
    way = np.cumsum(rng.normal(scale=0.05, size=(3000, n)), axis=0)
    found = visited_torques(chain, way, spacing=1e-12)
    acting = gravity.potential.frequencies.any(axis=0)
    stiffness = gravity.stiffness(way)[:, acting][:, :, acting]
    stable = np.linalg.eigvalsh(stiffness)[:, 0] > 0
    assert 0 < stable.sum() < len(way)
    assert np.allclose(found, gravity.torque(way[stable]), atol=1e-9)


def test_nothing_visited_and_wrong_joints():
    potential, _ = known_potential("2r")
    q, tau = stable_samples(potential, np.random.default_rng(0), 8)
    fit = fit_potential(q, tau, all_frequencies(2))
    assert visited_torques(fit, np.empty((0, 2))).shape == (0, 2)
    with pytest.raises(InputError, match="shape of q"):
        visited_torques(fit, np.zeros((4, 3)))


def test_trajectories_make_the_set_larger_and_hardly_false():
    robot = load_robot("2r")
    gravity = GravityModel(robot)
    judged = {}
    for given_trajectories in (False, True):
        settings = SchemeSettings(from_trajectories=given_trajectories)
        rng = np.random.default_rng(0)
        scheme = Scheme(SimulatedArm(robot), rng, lambda group, span: None, settings)
        motions = list(scheme.discover())
        judged[given_trajectories] = judge_static_torques(
            scheme.static_torques, gravity, robot.limits, samples=1000
        )
    assert judged[True].coverage > judged[False].coverage + 0.03
    assert judged[True].false_share < 0.02
    assert judged[True].worst_outside < 0.5
    assert len(motions) > 100
