"""The canonical form: the same torque, and the same numbers for equal torques."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from isotorque.learning.learners.rigid.structure.canonical_form import CanonicalForm, exact_cos
from tests.learning.learners.rigid.random_chains import KINDS, random_chain, random_poses


@given(
    n=st.integers(1, 7),
    kind=st.sampled_from(KINDS),
    forks=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=60)
def test_the_torque_stays_the_same(n, kind, forks, seed):
    rng = np.random.default_rng(seed)
    parents = [int(rng.integers(-1, j)) for j in range(n)] if forks else None
    chain = random_chain(rng, n, kind, parents)
    form = CanonicalForm.of(chain)
    q = random_poses(rng, 5, n)
    assert np.abs(form.parameters().torque(q) - chain.torque(q)).max() < 1e-11
    assert np.all((form.twists >= 0) & (form.twists <= np.pi))
    assert np.all(form.offsets[chain.parents < 0] == 0)


@given(n=st.integers(1, 6), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_zeros_of_angles_and_a_turned_base_do_not_matter(n, seed):
    """Two chains that differ by what no torque tells have one canonical form."""
    rng = np.random.default_rng(seed)
    chain = random_chain(rng, n)
    turns = rng.uniform(-np.pi, np.pi, n + 1)
    about = [Rotation.from_rotvec([0, 0, a]).as_matrix() for a in turns]
    # frame j turned about its own axis by turns[j]; the base by the last
    rotations = [
        (about[-1] if j == 0 else about[j - 1].T) @ chain.rotations[j] @ about[j] for j in range(n)
    ]
    levers = [(about[j].T[:2, :2]) @ chain.levers[j] for j in range(n)]
    other = replace(chain, rotations=np.array(rotations), levers=np.array(levers))
    one, two = CanonicalForm.of(chain), CanonicalForm.of(other)
    np.testing.assert_allclose(two.twists, one.twists, atol=1e-7)
    np.testing.assert_allclose(np.exp(1j * two.offsets), np.exp(1j * one.offsets), atol=1e-7)
    np.testing.assert_allclose(two.levers, one.levers, atol=1e-6)


def test_right_angles_are_exact():
    assert [exact_cos(k * np.pi / 2) for k in range(-4, 5)] == [1, 0, -1, 0, 1, 0, -1, 0, 1]
    assert exact_cos(0.3) == np.cos(0.3)
