"""Relations compose, invert and close to groups; angles are written in (-pi, pi]."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup, close
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation, identity
from isotorque.verify.testing.strategies import configurations, known_arms


@given(st.floats(-1e3, 1e3))
def test_wrapped_angles_differ_by_whole_turns(angle):
    wrapped = float(wrap(angle))
    assert -np.pi < wrapped <= np.pi
    turns = (angle - wrapped) / (2 * np.pi)
    assert abs(turns - round(turns)) < 1e-9


def test_minus_pi_is_written_pi():
    assert wrap(-np.pi) == np.pi
    assert wrap(np.nextafter(-np.pi, 0)) == np.pi
    assert wrap(0.0) == 0.0


@given(known_arms(max_joints=3), st.data())
def test_composition_and_inverse_act_as_maps(arm, data):
    group = arm.group
    g = data.draw(st.sampled_from(list(group)))
    h = data.draw(st.sampled_from(list(group)))
    q = data.draw(configurations(group.n))
    product = g @ h
    np.testing.assert_allclose(
        wrap(product.configuration(q) - g.configuration(h.configuration(q))), 0, atol=1e-9
    )
    np.testing.assert_array_equal(product.torque(q), g.torque(h.torque(q)))
    assert product in group
    assert (g @ g.inverse()).is_identity
    back = wrap(g.inverse().configuration(g.configuration(q)) - q)
    np.testing.assert_allclose(back, 0, atol=1e-9)


@given(known_arms(max_joints=3), st.data())
def test_paper_form_is_the_same_relation(arm, data):
    relation = data.draw(st.sampled_from(list(arm.group)))
    q = data.draw(configurations(arm.group.n))
    left = relation.M @ q + relation.N @ relation.configuration(q)
    np.testing.assert_allclose(wrap(left - relation.rhs), 0, atol=1e-9)


@given(known_arms(max_joints=3))
def test_a_group_is_the_closure_of_itself_and_of_generators(arm):
    group = arm.group
    assert group.is_closed
    assert group[0].is_identity
    generators = list(group)[1:] or [group[0]]
    assert close(generators[:3], max_order=group.order).order <= group.order
    assert close(generators).order == group.order
    if group.order > 2:
        missing = SymmetryGroup([r for i, r in enumerate(group) if i != 1])
        assert not missing.is_closed


def test_level_set_symmetries_of_the_two_links():
    flip = SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1])
    turn = SymmetryRelation(np.eye(2), [np.pi, 0], [-1, -1])
    group = close([flip, turn])
    assert (group.order, group.level_set_symmetries().order) == (4, 2)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (([[1, 0]], [0], [1]), "shape of A"),
        ((np.eye(2), [0], [1, 1]), "shape of d"),
        ((np.eye(2), [0, 0], [1]), "shape of Y"),
        ((np.eye(2), [0, 0], [1, 0]), "signs"),
        ((np.eye(2), [0, np.nan], [1, 1]), "finite"),
        ((np.eye(2), [0, 0], [1, 1], [[1, 0, 0]]), "basis"),
    ],
)
def test_malformed_relations_are_refused(arguments, word):
    with pytest.raises(InputError, match=word):
        SymmetryRelation(*arguments)


def test_a_map_that_mixes_free_directions_into_torque_is_refused():
    relation = SymmetryRelation([[1, 1], [0, 1]], [0, 0], [1, 1], basis=[[1, 0]])
    with pytest.raises(InputError, match="B A = A_sat B"):
        _ = relation.A_sat


def test_offsets_that_never_come_back_do_not_close():
    with pytest.raises(InputError, match="above 50"):
        close([SymmetryRelation(np.eye(1), [1.0], [1])], max_order=50)
    with pytest.raises(InputError, match="at least"):
        SymmetryGroup([])
    assert identity(3).is_identity


@pytest.mark.parametrize("entry", [2.0**31, 1e45])
def test_huge_entries_are_compared_without_a_warning(entry):
    shear = SymmetryRelation([[1, entry], [0, 1]], [0, 0], [1, 1])
    group = SymmetryGroup([identity(2), shear])
    assert not group.is_closed
    assert shear in group
    assert group.index(identity(2)) == 0
    trivial = SymmetryGroup([identity(2, np.zeros((0, 2), dtype=int))])
    assert trivial.is_closed
    assert trivial.generators == ()
