import casadi
import numpy as np
import pytest

from isotorque.learning.export.casadi_export import casadi_function
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.local_linear.local_linear_map import LocalLinearMap
from tests.learning.export.fitted_models import MAKERS, far_queries, fitted_learner, samples


def evaluated(function, q):
    return np.array(function.map(len(q))(q.T)).T


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("name", MAKERS)
def test_equals_predict(name, symmetric):
    learner = fitted_learner(name, "2r", symmetric)
    q = far_queries(2)
    expected = learner.predict(q)
    found = evaluated(casadi_function(torque_form(learner)), q)
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("name", ["averaged", "trigonometric", "local-linear-map-it"])
def test_derivative_is_the_learners_stiffness(name):
    learner = fitted_learner(name)
    q = far_queries(2, 5)
    symbol = casadi.MX.sym("q", 2)
    torque = casadi_function(torque_form(learner))(symbol)
    slope = casadi.Function("slope", [symbol], [casadi.jacobian(torque, symbol)])
    for point, expected in zip(q, learner.jacobian(q), strict=True):
        np.testing.assert_allclose(
            np.array(slope(point)), expected, rtol=0, atol=1e-9 * max(1.0, np.abs(expected).max())
        )


def test_thousands_of_prototypes_stay_a_small_graph():
    q, torque = samples("2r", 5000)
    learner = LocalLinearMap(0.07).fit(q, torque)
    assert learner.n_prototypes_ > 2000
    function = casadi_function(torque_form(learner))
    assert function.n_nodes() < 200
    q = far_queries(2)
    expected = learner.predict(q)
    assert np.abs(evaluated(function, q) - expected).max() < 1e-12 * np.abs(expected).max()


def test_can_be_saved():
    function = casadi_function(torque_form(fitted_learner("recursive-least-squares")))
    again = casadi.Function.deserialize(function.serialize())
    q = far_queries(2)
    np.testing.assert_array_equal(evaluated(again, q), evaluated(function, q))
