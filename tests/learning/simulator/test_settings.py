"""Settings of simulated arms."""

import pytest

from isotorque.learning.simulator.settings import (
    EngineName,
    PhysicsMode,
    SensorNoise,
    SettleMode,
    SettleRule,
    choice,
)
from isotorque.symbolic.common.errors import InputError


@pytest.mark.parametrize(
    "name",
    ["velocity", "acceleration", "dwell", "time_limit", "tolerance", "time_tolerance"],
)
@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf"), "slow"])
def test_settle_rules_are_finite_and_not_negative(name, value):
    with pytest.raises(InputError, match=f"SettleRule: {name} is .*>= 0"):
        SettleRule(**{name: value})


@pytest.mark.parametrize("name", ["tolerance", "time_tolerance"])
def test_tolerances_are_positive(name):
    with pytest.raises(InputError, match=f"SettleRule: {name} is 0.0; accepted: a number > 0"):
        SettleRule(**{name: 0.0})


@pytest.mark.parametrize("name", ["angle", "torque", "encoder_step", "holding_torque"])
@pytest.mark.parametrize("value", [-1e-9, float("nan")])
def test_noise_is_finite_and_not_negative(name, value):
    with pytest.raises(InputError, match=f"SensorNoise: {name} is"):
        SensorNoise(**{name: value})


def test_only_some_noise_is_random():
    assert not SensorNoise().is_random
    assert not SensorNoise(encoder_step=0.1).is_random
    assert SensorNoise(angle=0.1).is_random
    assert SensorNoise(torque=0.1).is_random
    assert SensorNoise(holding_torque=0.1).is_random


def test_words_become_members():
    assert SettleRule(mode="raw").mode is SettleMode.RAW
    assert choice(PhysicsMode, "here", "physics", PhysicsMode.GEARED) is PhysicsMode.GEARED
    with pytest.raises(InputError, match="here: engine is fast; accepted: compiled, pinocchio"):
        choice(EngineName, "here", "engine", "fast")
