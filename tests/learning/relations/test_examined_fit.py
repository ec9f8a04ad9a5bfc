"""Nothing is claimed from samples too few to see every torque beside gravity, unless exact."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.learning.relations.examined_fit import examined_fit
from isotorque.learning.relations.identification.wave_identification import identify_by_waves
from isotorque.learning.relations.lack_of_fit import KINDS
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.potential.errors_in_variables import (
    MeasurementNoise,
    Undetermined,
)
from isotorque.symbolic.common.angles import wrap
from tests.learning.static_data import known_potential

FEWEST = {"pendulum": (3, 5), "2r": (5, 7), "3r": (9, 12)}
"""Exact samples from which relations are claimed, and samples with errors at the least."""


def beside(kind, size, q):
    """Torque beside gravity of every joint, (N, n)."""
    return size * (q if kind == "spring" else np.sin(2.0 * q + 0.4))


@pytest.mark.parametrize("kind", ["spring", "cable"])
@pytest.mark.parametrize(("name", "seeds"), [("pendulum", 40), ("2r", 5)])
def test_no_claim_from_few_rows_of_an_arm_with_a_spring_or_a_cable_is_wrong(name, seeds, kind):
    potential, _ = known_potential(name)
    claims = 0
    for rows in range(FEWEST[name][0], FEWEST[name][1] + 1):
        for seed in range(seeds):
            rng = np.random.default_rng([seed, rows])
            q, probe = (rng.uniform(-np.pi, np.pi, (count, potential.n)) for count in (rows, 200))
            signs = rng.choice([-1.0, 1.0], potential.n)
            size = np.abs(potential.gradient(probe)).max(axis=0) * signs * rng.uniform(0.005, 0.03)

            def torque(x, size=size):
                return potential.gradient(x) + beside(kind, size, x)

            for entry in learn_relations(q, torque(q)).relations:
                relation = entry.relation
                if relation.is_identity:
                    continue
                claims += 1
                there = torque(wrap(relation.configuration(probe)))
                error = np.abs(there - relation.torque(torque(probe))).max(axis=0)
                assert (error <= relation.bound).all()
    assert claims <= 0.01 * seeds


@given(st.integers(0, 2**32 - 1), st.sampled_from(sorted(FEWEST)))
@settings(max_examples=6)
def test_exact_samples_of_a_rigid_arm_are_as_few_as_before(seed, name):
    potential, group = known_potential(name)
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (FEWEST[name][0], potential.n))
    learned = learn_relations(q, potential.gradient(q))
    assert learned.order == group.order


@pytest.mark.parametrize("given", [None, MeasurementNoise(0.0, 0.01)])
@pytest.mark.parametrize("name", sorted(FEWEST))
def test_samples_with_errors_must_show_springs_and_cables(name, given):
    potential, _ = known_potential(name)
    rng = np.random.default_rng(5)
    q = rng.uniform(-np.pi, np.pi, (FEWEST[name][1], potential.n))
    tau = potential.gradient(q) + 0.01 * rng.normal(size=q.shape)
    assert len(examined_fit(q, tau, given).lack.alternatives) == KINDS
    with pytest.raises(Undetermined, match=rf"1 more samples: .*; {len(q)} show how large"):
        examined_fit(q[:-1], tau[:-1], given)


@pytest.mark.parametrize(("noise", "least", "most"), [(5e-6, 6, 10), (2e-3, 0, 0)])
@pytest.mark.parametrize("name", ["pendulum", "2r"])
def test_fewest_samples_with_errors_are_enough_where_sensors_are_nearly_exact(
    name, noise, least, most
):
    """More often than not: what they may hide has to be small. Noise is a share of the torque."""
    potential, group = known_potential(name)
    probe = np.random.default_rng(0).uniform(-np.pi, np.pi, (200, potential.n))
    level = noise * np.abs(potential.gradient(probe)).max()
    claimed = 0
    for seed in range(10):
        rng = np.random.default_rng([seed, 5])
        q = rng.uniform(-np.pi, np.pi, (FEWEST[name][1], potential.n))
        tau = potential.gradient(q) + level * rng.normal(size=q.shape)
        learned = identify_by_waves(q, tau)
        claimed += learned.order == group.order
        assert learned.order in (1, group.order)
    assert least <= claimed <= most


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(["offset", "spring", "cable"]),
    st.sampled_from([0.0, 1e-6, 1e-4, 1e-2, 0.05]),
    st.floats(-6.0, 0.0),
)
@settings(max_examples=60)
def test_bounds_hold_for_what_few_samples_hide(seed, kind, noise, logarithm):
    """Any size of anything beside gravity, any noise, the fewest samples."""
    potential, _ = known_potential("pendulum")
    rng = np.random.default_rng(seed)
    size = 10.0**logarithm

    def torque(x):
        more = np.full_like(x, size) if kind == "offset" else beside(kind, size, x)
        return potential.gradient(x) + more

    q, probe = (rng.uniform(-np.pi, np.pi, (count, 1)) for count in (rng.integers(4, 8), 200))
    measured = torque(q) + noise * rng.normal(size=q.shape)
    floor = 1e-9 * np.abs(torque(probe)).max()
    for entry in identify_by_waves(q, measured).relations:
        relation = entry.relation
        there = torque(wrap(relation.configuration(probe)))
        error = np.abs(there - relation.torque(torque(probe))).max(axis=0)
        assert (error <= relation.bound + floor).all()
