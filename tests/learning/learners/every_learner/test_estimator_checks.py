"""scikit-learn's own checks of estimators, where they apply to a learner of samples in order."""

import pickle

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.utils.estimator_checks import check_estimator

from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from isotorque.learning.learners.local_linear.recursive_least_squares import RecursiveLeastSquares
from tests.learning.learners import planar_arm

NOT_APPLICABLE = {
    "check_sample_weight_equivalence_on_dense_data": "order and repetition of samples matter",
    "check_supervised_y_2d": "several torques per sample are the rule; one column stays a column",
}


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("learner", [LocalLinearMap(), RecursiveLeastSquares()])
def test_estimator_checks(learner):
    results = check_estimator(learner, expected_failed_checks=NOT_APPLICABLE, on_fail=None)
    failed = [r["check_name"] for r in results if r["status"] == "failed"]
    assert not failed
    assert sum(r["status"] == "passed" for r in results) > 40


@pytest.mark.parametrize(
    "learner",
    [LocalLinearMap(0.3, replay=2, group=planar_arm.group()), RecursiveLeastSquares(ridge=1e-8)],
)
def test_pickled_copies_go_on_alike(learner):
    """Fitted or not, a copy through pickle or clone behaves the same."""
    rng = np.random.default_rng(0)
    q = rng.uniform(-1, 1, (60, 2))
    fresh = pickle.loads(pickle.dumps(learner))
    fitted = clone(learner).fit(q, planar_arm.torque(q))
    copied = pickle.loads(pickle.dumps(fitted))
    assert np.abs(fresh.fit(q, planar_arm.torque(q)).predict(q) - fitted.predict(q)).max() < 1e-9
    assert copied.group is None or len(copied.group.Y) == 8
    for twin in (fitted, copied):
        twin.partial_fit(-q, planar_arm.torque(-q))
    assert np.abs(copied.predict(q) - fitted.predict(q)).max() < 1e-7
