"""Searches of chains with causes: the best minimum is found, thinned or not."""

import numpy as np
import pytest

from isotorque.learning.learners.rigid.causes.extensible_chain import SEARCHED, ExtensibleChain
from isotorque.learning.learners.rigid.fitting.chain_parameters import serial
from isotorque.learning.learners.rigid.fitting.chain_samples import ChainSamples
from isotorque.learning.learners.rigid.fitting.chain_search import ChainModel
from isotorque.learning.statistics.causes.extension import Extension, Kind
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

NOISE = 0.05


def model_of(poses, seed, known=True):
    gravity = GravityModel(load_robot("panda"))
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.0, 2.0, (poses, 7))
    tau = gravity.torque(q) + NOISE * rng.normal(size=q.shape)
    noise = np.full(7, NOISE if known else 0.0)
    samples = ChainSamples(q, tau, noise, np.zeros(7), np.ones(poses))
    family = ChainModel(serial(7), np.ones(7), np.zeros(7, dtype=bool), ())
    return ExtensibleChain(samples, family, None, known, True, np.random.default_rng(seed)), gravity


@pytest.mark.parametrize("poses", [40, 3 * SEARCHED])
def test_the_chain_alone_explains_clean_samples(poses):
    model, gravity = model_of(poses, 0)
    fit = model.alone()
    assert fit.cost < fit.spare + 5.0 * np.sqrt(2.0 * fit.spare)
    assert len(fit.samples.q) == poses  # found with few, fitted to all
    q = np.random.default_rng(9).uniform(-2.0, 2.0, (100, 7))
    assert np.abs(fit.chain.torque(q) - gravity.torque(q)).max() < 0.5


def test_a_sign_is_found_from_elsewhere():
    model, _ = model_of(40, 1)
    model.samples.torque[:, 1] *= -1.0
    extension = Extension.at(Kind.GAIN, 1)
    (found,) = model.others(extension, extension.terms, 8)
    assert found.chain.gains[1] == pytest.approx(-1.0, abs=0.02)


def test_loads_are_not_looked_for_from_elsewhere():
    model, _ = model_of(40, 2)
    extension = Extension.payload(20)
    assert model.others(extension, extension.terms, 4) == []


def test_noise_is_kept_where_it_is_known_and_estimated_else():
    known, _ = model_of(60, 3)
    assert known.reweighted(known.alone()) is known
    unknown, _ = model_of(60, 3, known=False)
    levels = unknown.reweighted(unknown.alone()).samples.torque_noise
    np.testing.assert_allclose(levels, NOISE, rtol=0.35)
