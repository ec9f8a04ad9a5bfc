"""Terms beside a linear model, against least squares with everything in it."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.statistics.added_terms import SPARE, added_terms


@given(st.integers(0, 2**32 - 1), st.integers(1, 4), st.integers(1, 2), st.integers(1, 6))
@settings(max_examples=40)
def test_estimates_are_those_of_least_squares_with_all_columns(seed, joints, width, parameters):
    rng = np.random.default_rng(seed)
    count = parameters + joints * width + 5
    design = rng.normal(size=(count * joints, parameters))
    values = rng.normal(size=(count, joints, width))
    whitening = np.array([np.tril(rng.uniform(0.5, 1.5, (joints, joints))) for _ in range(count)])
    target = rng.normal(size=count * joints)
    plain = np.linalg.lstsq(design, target, rcond=None)[0]
    added = added_terms(
        design, target - design @ plain, whitening, values, floor=1e-30, known_noise=True
    )
    columns = np.zeros((count, joints, joints, width))
    for j in range(joints):
        columns[:, :, j] = whitening[:, :, j, None] * values[:, None, j]
    whole = np.concatenate([design, columns.reshape(count * joints, -1)], axis=1)
    both = np.linalg.lstsq(whole, target, rcond=None)[0]
    np.testing.assert_allclose(added.terms.ravel(), both[parameters:], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(plain + added.change, both[:parameters], rtol=1e-6, atol=1e-9)
    assert (added.errors > 0.0).all()


def test_too_few_samples_say_nothing():
    values = np.ones((4, 1, 1))
    design = np.random.default_rng(0).normal(size=(4, 4 - SPARE))
    found = added_terms(
        design, np.ones(4), np.ones((4, 1, 1)), values, floor=1e-30, known_noise=False
    )
    assert found is None


@given(st.integers(0, 2**32 - 1), st.floats(-4.0, 4.0), st.integers(2, 6))
@settings(max_examples=60)
def test_terms_that_are_only_bounded_are_within_their_bound(seed, logarithm, joints):
    """Two less samples than a test takes; of terms alone, as noise may cancel them by chance."""
    rng = np.random.default_rng(seed)
    count, parameters = 4, 2 * joints
    design = rng.normal(size=(count * joints, parameters))
    values = rng.normal(size=(count, joints, 2))
    values[:, :, 1] += 1e-3
    whitening = np.tile(np.eye(joints), (count, 1, 1))
    terms = 10.0**logarithm * rng.normal(size=(joints, 2))
    target = np.einsum("Nkw,kw->Nk", values, terms).ravel()
    left = target - design @ np.linalg.lstsq(design, target, rcond=None)[0]
    given_ = {"floor": 1e-300, "known_noise": False}
    assert added_terms(design, left, whitening, values, **given_) is None
    found = added_terms(design, left, whitening, values, allowed=3.0, **given_)
    assert found.bounded
    assert (np.abs(terms) <= 3.0 * found.errors).all()
    changed = design @ np.linalg.lstsq(design, target, rcond=None)[0]
    sizes = 3.0 * np.sqrt(np.einsum("ij,jk,ik->i", design, found.more, design))
    assert (np.abs(changed) <= sizes).all()
    twice = added_terms(design, left, whitening, values, allowed=6.0, **given_)
    np.testing.assert_allclose(2.0 * twice.errors, found.errors)


def test_terms_that_the_model_has_already_are_not_counted():
    rng = np.random.default_rng(0)
    design = np.ones((20, 1))
    found = added_terms(
        design,
        rng.normal(size=20),
        np.ones((20, 1, 1)),
        np.ones((20, 1, 1)),
        floor=1e-30,
        known_noise=False,
    )
    assert found.terms[0, 0] == 0.0
    assert found.errors[0, 0] == 0.0
