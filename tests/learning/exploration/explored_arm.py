"""An ideal planar arm to explore, and arms, sets and learners that only answer or take notes."""

import numpy as np

from isotorque.learning.arm import LimitHit, Settled
from isotorque.learning.exploration.strategies import ConstrainedDirectionSampling
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from tests.learning.learners import planar_arm

RANGE = [24.5, 6.2]
HOME = planar_arm.torque([-np.pi / 4, -np.pi / 4])[0]


class ToyDomain:
    """The fundamental domain in which the arm can hold itself."""

    def contains(self, q):
        return bool(-np.pi / 2 <= q[0] <= 0 and -np.pi <= q[0] + q[1] <= 0)

    def sample(self, rng, count):
        sums = np.stack([rng.uniform(-np.pi / 2, 0, count), rng.uniform(-np.pi, 0, count)], axis=1)
        return np.stack([sums[:, 0], sums[:, 1] - sums[:, 0]], axis=1)


class TrueStaticTorques:
    """The torques the ideal arm can hold below the horizontal, known exactly."""

    def __init__(self, margin=0.999):
        self.margin = margin
        self.added, self.marked = [], []

    def _ratios(self, torque):
        return np.array([(torque[0] - torque[1]) / planar_arm.UPPER, torque[1] / planar_arm.LOWER])

    def contains(self, torque):
        return bool(np.abs(self._ratios(torque)).max() <= self.margin)

    def nearest(self, torque):
        first, second = np.clip(self._ratios(torque), -self.margin, self.margin)
        lower = planar_arm.LOWER * second
        return np.array([planar_arm.UPPER * first + lower, lower])

    def add(self, torque):
        self.added.append(torque)

    def mark_inadmissible(self, torque):
        self.marked.append(torque)


class ScriptedArm:
    """Answers with the given configurations, whatever is applied; None means a limit."""

    def __init__(self, answers):
        self.answers = iter(answers)
        self.q = np.zeros(2)
        self.torques = []

    def go_home(self):
        self.q = np.zeros(2)

    def apply(self, torque):
        self.torques.append(torque)
        answer = next(self.answers)
        if answer is None:
            hit = LimitHit(self.q, torque, 1.0)
            self.go_home()
            return hit
        self.q = np.array(answer, dtype=float)
        return Settled(self.q, torque, 1.0)


class Recorder:
    """A learner that only takes notes and predicts zero."""

    def __init__(self):
        self.samples = []

    def partial_fit(self, X, y, sample_weight=None):
        assert X.shape == y.shape == (1, 2)
        self.samples.append((X[0], y[0], float(sample_weight[0])))

    def predict(self, X):
        return np.zeros((len(X), 2))


def constrained(seed=0, learner=None, arm=None, **options):
    """A constrained direction sampling of the ideal arm."""
    rng = np.random.default_rng(seed)
    options = {"home_torque": HOME, "torque_range": RANGE, "domain": ToyDomain()} | options
    options.setdefault("static_torques", TrueStaticTorques())
    if learner is None:
        learner = LocalLinearMap(0.25, group=planar_arm.group(), inner_iterations=None, replay=2)
    return (
        ConstrainedDirectionSampling(
            arm if arm is not None else planar_arm.IdealArm(), learner, rng, **options
        ),
        learner,
    )


def rmse(learner, seed=99):
    """Error on the whole torus [N m]."""
    dense = np.random.default_rng(seed).uniform(-np.pi, np.pi, (1500, 2))
    return float(np.sqrt(np.mean((learner.predict(dense) - planar_arm.torque(dense)) ** 2)))
