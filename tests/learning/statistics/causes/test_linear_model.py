"""Linear models with causes: each cause is found with its size, nothing where there is none."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.relations.potential.errors_in_variables import (
    stiffness_matrices,
    torque_features,
)
from isotorque.learning.relations.potential.potential_fit import all_frequencies
from isotorque.learning.statistics.causes.cause import causes_of
from isotorque.learning.statistics.causes.extended_fit import ExtendedFit
from isotorque.learning.statistics.causes.extension import Extension, Kind, Shape, Term
from isotorque.learning.statistics.causes.linear_model import LinearModel
from isotorque.learning.statistics.causes.selection import selected
from tests.learning.statistics.causes.simulated_causes import torque_beside

seeds = st.integers(0, 2**32 - 1)
POSES, JOINTS = 60, 2
FREQUENCIES = all_frequencies(JOINTS)
SIZES = {Shape.GAIN: 0.8, Shape.SCALE: 0.02, Shape.COMPLIANCE: 2e-3}


def waves(seed, change=lambda q, tau, directions, coefficients: (q, tau), noise=0.0, **options):
    """Samples of a random potential, one thing changed; the model of all its frequencies."""
    rng = np.random.default_rng(seed)
    coefficients = 5.0 * rng.normal(size=2 * len(FREQUENCIES))
    q = rng.uniform(-2.5, 2.5, (POSES, JOINTS))
    directions = rng.choice([-1.0, 1.0], q.shape)
    tau = torque_features(FREQUENCIES, q) @ coefficients
    read, measured = change(q, tau, directions, coefficients)
    measured = measured + noise * rng.normal(size=q.shape)
    own = torque_features(FREQUENCIES, read)
    unit = np.tile(np.eye(JOINTS), (POSES, 1, 1))
    model = LinearModel(
        read,
        measured,
        own,
        unit / max(noise, 1e-9),
        np.full(JOINTS, max(noise, 1e-9)),
        noise > 0.0,
        np.full(JOINTS, 1e-11),
        directions,
        stiffness_of=lambda x: stiffness_matrices(FREQUENCIES, x, read),
        **options,
    )
    return model, coefficients


def changed(term, size):
    """A change of samples, computed without the code under test."""

    def change(q, tau, directions, coefficients):
        read, measured, j = q.copy(), tau.copy(), term.place
        if term.shape is Shape.GAIN:
            measured[:, j] *= size
        elif term.shape is Shape.SCALE:
            read[:, j] /= 1.0 + size
        elif term.shape is Shape.COMPLIANCE:
            read[:, j] += size * tau[:, j]
        elif term.shape is Shape.LOAD:
            measured[j:] += size * torque_features(FREQUENCIES, q[j:]) @ coefficients[::-1]
        else:
            measured[:, j] += size * torque_beside(term.shape, q[:, j], directions[:, j])
        return read, measured

    return change


@given(seeds, st.sampled_from(Shape), st.integers(0, JOINTS - 1))
@settings(max_examples=60)
def test_every_cause_is_found_with_its_size(seed, shape, joint):
    term = Term(shape, POSES // 2 if shape is Shape.LOAD else joint)
    size = SIZES.get(shape, 0.3)
    model, coefficients = waves(seed, changed(term, size))
    found = model.refitted([term], model.alone(), thorough=True)
    if shape in (Shape.SCALE, Shape.COMPLIANCE):  # of first order
        assert np.abs(found.rest).max() < 0.2 * np.abs(model.alone().rest).max()
        assert found.values[term][0] == pytest.approx(size, rel=0.2)
        return
    assert np.abs(found.rest).max() < 1e-7 * np.abs(model.torque).max()
    if shape is Shape.LOAD:
        np.testing.assert_allclose(found.values[term], size * coefficients[::-1], atol=1e-6)
        np.testing.assert_allclose(found.unknowns, coefficients, atol=1e-6)
        return
    value, error = found.estimate(term)
    assert value[0] == pytest.approx(size, abs=max(1e-6, 50.0 * error[0]))


@given(seeds, st.sampled_from([s for s in Shape if s is not Shape.LOAD]), st.booleans())
@settings(max_examples=30)
def test_rest_basis_and_errors_are_those_of_least_squares(seed, shape, other):
    """Beside all rows at once, which the general fit decomposes: not eliminated step by step."""
    terms = [Term(shape, 0)] + ([Term(Shape.CONSTANT, 1)] if other else [])
    model, _ = waves(seed, changed(terms[0], SIZES.get(shape, 0.3)), noise=0.05)
    fit = model.refitted(terms, model.alone())
    whole = ExtendedFit.basis.func(fit)
    assert fit.basis.shape == whole.shape
    np.testing.assert_allclose(fit.basis @ (fit.basis.T @ whole), whole, atol=1e-8)
    slack = 1e-2 if shape in (Shape.SCALE, Shape.COMPLIANCE) else 1e-6
    np.testing.assert_allclose(fit.basis.T @ fit.residual, 0.0, atol=slack * np.sqrt(fit.cost))
    assert fit.cost == pytest.approx(float(fit.residual @ fit.residual), rel=slack)
    covariance = np.linalg.inv(fit.rows.T @ fit.rows)
    _, error = fit.estimate(terms[-1])
    assert error[0] == pytest.approx(np.sqrt(covariance[-1, -1]), rel=1e-6)


@given(seeds)
@settings(max_examples=20)
def test_weights_settle_at_the_noise_of_every_joint(seed):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.5, 2.5, (400, JOINTS))
    own = torque_features(FREQUENCIES, q)
    levels = np.array([0.02, 0.3])
    tau = own @ rng.normal(size=own.shape[2]) + levels * rng.normal(size=q.shape)
    np.testing.assert_allclose(LinearModel.of(q, tau, own).noise, levels, rtol=0.2)


def test_columns_that_samples_leave_open_do_no_harm():
    """As of a static regressor, most of whose parameters are open."""
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.5, 2.5, (40, JOINTS))
    own = torque_features(FREQUENCIES, q)
    tau = own @ rng.normal(size=own.shape[2]) + [0.0, 0.5] + 0.01 * rng.normal(size=q.shape)
    redundant = np.concatenate([own, own @ rng.normal(size=(own.shape[2], 5))], axis=2)
    for columns in (own, redundant):
        model = LinearModel.of(q, tau, columns)
        (cause,) = causes_of(selected(model, model.alone()))
        assert (cause.kind, cause.joint) == (Kind.OFFSET, 1)
        assert cause.size[0] == pytest.approx(0.5, abs=5.0 * cause.standard_error[0])
        assert cause.standard_error[0] < 0.01


@pytest.mark.parametrize("gain", [1.2, -1.0])
def test_a_gain_is_found_from_either_side(gain):
    term = Term(Shape.GAIN, 1)
    model, _ = waves(3, changed(term, gain), noise=0.02)
    choice, *rest = selected(model, model.alone()).choices
    assert not rest
    kind = Kind.SIGN if gain < 0.0 else Kind.GAIN
    assert any(rival.kind is kind for rival in choice.rivals)
    assert len(model.others(Extension.at(Kind.GAIN, 1), [term], 4)) == 1
    assert model.others(Extension.at(Kind.SPRING, 1), [term], 4) == []


def test_the_level_of_false_alarms_is_kept():
    named = 0
    for seed in range(150):
        for model in (waves(seed, noise=0.05)[0],):
            unknown = LinearModel.of(model.q, model.torque, model.own, directions=model.directions)
            for some in (model, unknown):
                named += bool(selected(some, some.alone()).choices)
    assert named <= 9  # of 300 at one in a hundred: more in one run of a thousand


def test_weights_of_samples_count():
    rng = np.random.default_rng(1)
    q = rng.uniform(-2.5, 2.5, (80, 1))
    own = np.stack([np.cos(q), np.sin(q)], axis=2)
    weight = np.where(np.arange(80) < 40, 1.0, 1e-4)
    tau = own @ [3.0, 1.0] + 0.01 * rng.normal(size=q.shape)
    tau[40:] += 0.3  # of no weight to speak of
    model = LinearModel.of(q, tau, own, weight=weight, kinds=(Kind.OFFSET,))
    assert selected(model, model.alone()).choices == ()
    plain = LinearModel.of(q, tau, own, kinds=(Kind.OFFSET,))
    assert selected(plain, plain.alone()).choices
