"""What every online learner must do and survive, on an arm that offers the bare protocol."""

from __future__ import annotations

import json

import numpy as np
import pytest

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.exploration.strategies import ConstrainedDirectionSampling
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from isotorque.learning.learners.memory.dictionary_learner import DictionaryLearner
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.robots.load_robot import load_robot
from tests.learning.learners import planar_arm

GROUP = planar_arm.group()
ONLINE = {
    "literal": lambda: LocalLinearMap(0.3, group=GROUP),
    "replay": lambda: LocalLinearMap(
        0.3, kernel_width=2.0, inner_iterations=None, replay=5, memory=200, group=GROUP
    ),
    "least squares": lambda: RecursiveLeastSquares(memory=100, ridge=1e-8, group=GROUP),
    "dictionary": lambda: DictionaryLearner(
        LocalLinearMap(0.3, inner_iterations=None, group=GROUP), budget=50, replay=3, group=GROUP
    ),
}
SAVED = ("literal", "replay", "least squares")  # the dictionary wraps any learner, and is pickled
every_learner = pytest.mark.parametrize("make", ONLINE.values(), ids=ONLINE.keys())


class Bare:
    """An arm that offers ``apply``, ``go_home`` and ``q``, and nothing else."""

    __slots__ = ("__arm",)

    def __init__(self, arm):
        self.__arm = arm

    @property
    def q(self):
        return np.array(self.__arm.q)

    def apply(self, torque):
        return self.__arm.apply(torque)

    def go_home(self):
        self.__arm.go_home()


class BelowTheHorizontal:
    """The cell in which the 2R arm holds itself."""

    def contains(self, q):
        return bool(-np.pi / 2 <= q[0] <= 0 and -np.pi <= q[0] + q[1] <= 0)


def samples(rng, count):
    """Configurations in which the arm can hold itself, and their torques."""
    sums = np.stack([rng.uniform(-np.pi / 2, 0, count), rng.uniform(-np.pi, 0, count)], axis=1)
    q = np.stack([sums[:, 0], sums[:, 1] - sums[:, 0]], axis=1)
    return q, planar_arm.torque(q)


@every_learner
def test_learns_on_an_arm_that_offers_nothing_but_the_protocol(make):
    rng = np.random.default_rng(0)
    static_torques = StaticTorqueSet(2)
    static_torques.add(samples(rng, 300)[1])
    learner = make()
    exploration = ConstrainedDirectionSampling(
        Bare(SimulatedArm(load_robot("2r"))),
        learner,
        rng,
        static_torques=static_torques,
        domain=BelowTheHorizontal(),
        torque_range=[24.5, 6.1],
        home_torque=planar_arm.torque([-np.pi / 4, -np.pi / 4])[0],
        settings=ExplorationSettings(noise=0.01),
    )
    steps = list(exploration.steps(250))
    settled = [s.outcome for s in steps if s.outcome.kind is OutcomeKind.SETTLED]
    assert len(settled) > 240
    visited = np.array([outcome.q for outcome in settled])
    held = np.array([outcome.torque for outcome in settled])
    assert np.sqrt(np.mean((learner.predict(visited) - held) ** 2)) < 0.3


@every_learner
def test_survives_constant_targets_repeats_and_angles_a_million_radians_apart(make):
    rng = np.random.default_rng(1)
    q, torque = samples(rng, 40)
    learner = make()
    learner.partial_fit(np.repeat(q[:1], 300, axis=0), np.repeat(torque[:1], 300, axis=0))
    assert np.abs(learner.predict(q[:1]) - torque[:1]).max() < 1e-3
    far = q + 2 * np.pi * rng.integers(-160_000, 160_000, q.shape)
    for _ in range(20):
        learner.partial_fit(far, torque)
    assert np.isfinite(learner.predict(q)).all()
    assert np.abs(learner.predict(far) - learner.predict(q)).max() < 1e-6
    constant = make()
    constant.partial_fit(q, np.zeros_like(torque))  # the constant that the group allows
    assert np.abs(constant.predict(q)).max() < 1e-9


@every_learner
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_refuses_what_is_no_number_and_predicts_as_before(make, bad):
    q, torque = samples(np.random.default_rng(2), 20)
    learner = make()
    learner.partial_fit(q, torque)
    before = learner.predict(q)
    for x, y in ((q[:1] * bad, torque[:1]), (q[:1], torque[:1] * bad)):
        with pytest.raises(InputError):
            learner.partial_fit(x, y)
    assert np.array_equal(learner.predict(q), before)


@pytest.mark.parametrize("name", SAVED)
def test_stopped_and_resumed_in_the_middle_it_goes_on_bit_for_bit(name):
    make = ONLINE[name]
    q, torque = samples(np.random.default_rng(3), 80)
    whole, stopped = make(), make()
    for learner in (whole, stopped):
        learner.partial_fit(q[:50], torque[:50])
    saved = json.loads(json.dumps(stopped.parameters()))
    resumed = type(stopped).from_arrays(stopped.to_arrays(), saved)
    for learner in (whole, resumed):
        learner.predict(q[:1])
        learner.partial_fit(q[50:], torque[50:])
    assert np.array_equal(resumed.predict(q), whole.predict(q))


def sizes(learner):
    """Numbers stored in a learner that can be saved."""
    return sum(np.size(array) for array in learner.to_arrays().values())


@pytest.mark.slow
@pytest.mark.parametrize("name", SAVED)
def test_a_hundred_thousand_samples_do_not_grow_what_is_stored(name):
    """The work of an update depends on what is stored alone."""
    rng = np.random.default_rng(4)
    learner = ONLINE[name]()
    stored = []
    for _ in range(5):
        learner.partial_fit(*samples(rng, 20_000))
        stored.append(sizes(learner))
    assert learner.n_samples_seen_ == 100_000
    assert stored[-1] <= 1.1 * stored[0]
    q, torque = samples(rng, 500)
    assert np.sqrt(np.mean((learner.predict(q) - torque) ** 2)) < 0.1
