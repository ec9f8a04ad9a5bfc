"""State, settings and batches: the same again, bit for bit."""

import json
from dataclasses import asdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.simulator.results import ArmState
from isotorque.learning.simulator.settings import SensorNoise, SettleRule
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from tests.learning.two_link_arm import GRAVITY, ROBOT, stable_targets


def commanded(arm, torques):
    return [arm.apply(torque) for torque in torques]


def identical(one, other):
    return all(
        a.kind is b.kind
        and np.array_equal(a.q, b.q)
        and np.array_equal(a.torque, b.torque)
        and a.seconds == b.seconds
        for a, b in zip(one, other, strict=True)
    )


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
@given(seed=st.integers(0, 2**32 - 1), cut=st.integers(0, 8))
@settings(max_examples=10)
def test_restored_from_json_it_goes_on_bit_for_bit(engine, seed, cut):
    noise = SensorNoise(angle=1e-3, torque=1e-2)

    def new_arm(seed):
        rng = np.random.default_rng(seed)
        return SimulatedArm(ROBOT, engine=engine, settle="raw", noise=noise, rng=rng)

    rng = np.random.default_rng(seed)
    torques = [GRAVITY(q) for q in rng.uniform(-3.0, 3.0, (8, 2))]
    arm = new_arm(seed)
    uninterrupted = commanded(arm, torques)
    arm = new_arm(seed)
    commanded(arm, torques[:cut])
    document = json.loads(json.dumps(asdict(arm.state())))
    resumed = new_arm(0)
    resumed.restore(ArmState.from_json(document))
    assert np.array_equal(resumed.q, arm.q)
    assert identical(commanded(resumed, torques[cut:]), uninterrupted[cut:])


def test_many_at_once_are_each_alone():
    starts = stable_targets(20, 9)
    torques = np.array([GRAVITY(q) for q in stable_targets(20, 10)])
    for engine in ("compiled", "pinocchio"):
        arm = SimulatedArm(ROBOT, engine=engine)
        together = arm.settle_each(starts, torques)
        for k, (start, torque) in enumerate(zip(starts, torques, strict=True)):
            alone = SimulatedArm(ROBOT, engine=engine, q0=start).apply(torque)
            assert alone.kind is together.kinds[k]
            assert np.array_equal(alone.q, together.q[k])
            assert alone.seconds == together.seconds[k]


def test_settings_say_it_all_in_json():
    arm = SimulatedArm(ROBOT, "geared", "pinocchio", limits="none", rule=SettleRule(dwell=0.1))
    document = json.loads(json.dumps(arm.settings.as_json(), allow_nan=False))
    assert document["physics"] == "geared"
    assert document["engine"] == "pinocchio"
    assert document["damping"] == arm.damping.tolist()
    assert document["limits"] == [[None, None], [None, None]]
    assert document["home"] == arm.home.tolist()
    assert document["rule"]["dwell"] == 0.1
    assert document["noise"]["angle"] == 0.0
    assert arm.settings == arm.settings
