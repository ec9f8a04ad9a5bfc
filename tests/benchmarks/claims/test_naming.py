"""What is the right name of a contamination, and how names are scored."""

import pytest

from benchmarks.claims.data_sets import Setting, draw
from benchmarks.claims.naming import Naming, judged_naming, right_names

OFFSET, SPRING = ("offset", 1), ("spring", 1)


def data_set(pool, robot="2r", index=3, poses=100):
    return draw(Setting(robot, pool, poses, 0.05, index, 0))


@pytest.mark.parametrize("pool", ["spring", "cable", "friction", "compliance", "scale"])
def test_most_kinds_have_one_name(pool):
    data = data_set(pool)
    assert right_names(data) == ((pool, data.contamination.joint),)


@pytest.mark.parametrize("pool", ["clean", "outliers", "hidden friction"])
def test_some_have_none(pool):
    assert right_names(data_set(pool)) == ()


def test_an_offset_is_friction_from_one_side_unless_directions_say_otherwise():
    told, untold = data_set("offset", index=0), data_set("offset", index=8)
    assert right_names(told) == (("offset", told.contamination.joint),)
    for data in (untold, data_set("one-sided friction")):
        joint = data.contamination.joint
        assert set(right_names(data)) == {("offset", joint), ("friction", joint)}


@pytest.mark.parametrize("pool", ["gain", "sign"])
def test_of_two_coupled_joints_nobody_can_say_which(pool):
    assert set(right_names(data_set(pool))) == {(pool, 0), (pool, 1)}
    three = data_set(pool, "3r")
    assert right_names(three) == ((pool, three.contamination.joint),)


def test_amperes_of_two_joints_are_one_gain():
    assert set(right_names(data_set("amperes"))) == {("gain", None), ("gain", 0), ("gain", 1)}
    names = [right_names(data_set("amperes", "3r", index)) for index in range(3, 40, 4)]
    assert all(found[0] == ("gain", None) for found in names)
    assert (("gain", None),) in names  # unless two of three gains happen to be equal


@pytest.mark.parametrize(
    ("named", "first", "among", "wrong"),
    [
        ((), False, False, False),
        (((OFFSET,),), True, True, False),
        (((OFFSET, SPRING),), True, True, False),
        (((SPRING, OFFSET),), False, True, False),
        (((SPRING,),), False, False, True),
        (((OFFSET,), (SPRING,)), True, True, True),
        (((("offset", 0),),), False, False, True),
        (((SPRING,), (OFFSET,)), False, False, True),
    ],
)
def test_scores(named, first, among, wrong):
    scored = Naming(named, (OFFSET,), (), 0.0)
    assert (scored.first, scored.among, scored.wrong) == (first, among, wrong)


def test_whatever_is_named_where_nothing_is_is_wrong():
    assert Naming(((OFFSET,),), (), (), 0.0).wrong
    assert not Naming((), (), (), 0.0).wrong


def test_gains_of_single_joints_are_no_lie_of_amperes():
    data = data_set("amperes", "3r")
    scored = judged_naming(data)
    one = Naming(((("gain", 1),),), scored.right, scored.parts, 0.0)
    assert not one.first
    assert not one.wrong


def test_a_clear_cause_is_named():
    scored = judged_naming(data_set("friction", "3r"))
    assert scored.first
    assert scored.among
    assert not scored.wrong
    assert scored.seconds > 0.0


def test_nothing_is_named_of_a_clean_arm():
    assert judged_naming(data_set("clean")).named == ()
