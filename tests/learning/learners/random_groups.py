"""Random finite symmetry groups, and a check that a learned map has their symmetries."""

import numpy as np
from hypothesis import strategies as st

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.groups.symmetry_group import close
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation


def groups(max_joints=3):
    """Groups of which no relation but the identity leaves every y where it is.

    Such a relation would make torques zero everywhere.
    """
    return _groups(max_joints).filter(_is_faithful)


def _is_faithful(group):
    still = np.all(np.abs(group.A_sat - np.eye(group.rank)) < 1e-9, axis=(1, 2))
    return np.sum(still & np.all(np.abs(wrap(group.d_sat)) < 1e-6, axis=1)) == 1


@st.composite
def _groups(draw, max_joints):
    """Groups conjugate, by a unimodular matrix, to sign changes and half turns.

    The gravity groups of planar arms have this form; free directions come in by a basis that
    leaves out the last coordinate.
    """
    n = draw(st.integers(1, max_joints))
    V = np.eye(n)
    for _ in range(draw(st.integers(0, 2)) if n > 1 else 0):
        i, j = draw(st.permutations(range(n)))[:2]
        V[i] += draw(st.sampled_from((-1.0, 1.0))) * V[j]
    rank = draw(st.integers(1, n))
    back = np.linalg.inv(V)
    signs = st.lists(st.sampled_from((1.0, -1.0)), min_size=n, max_size=n)
    generators = []
    for _ in range(draw(st.integers(1, 2))):
        linear = back @ np.diag(draw(signs)) @ V
        offset = back @ (np.pi * np.array(draw(signs)) / 2 + np.pi / 2)
        generators.append(SymmetryRelation(linear, offset, draw(signs), V[:rank]))
    return close(generators)


def worst_asymmetry(predict, group, q, least=1e-9):
    """Largest |f(A q + d) - Y f(q)|, relative to the size of f or ``least`` if that is more."""
    answer = predict(q)
    scale = max(np.abs(answer).max(), least)
    return max(
        np.abs(predict(relation.configuration(q)) - relation.Y * answer).max() / scale
        for relation in group
    )
