"""The benchmark of growing costs: fits, curves, subgroups and pictures."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.growth import joints, orders, prototypes, samples
from benchmarks.growth.arms import planar_chain, random_arm
from benchmarks.growth.curves import Curve, Measured, Work, growth, measure
from benchmarks.growth.pictures import picture, to_svg, write_picture
from benchmarks.growth.table import table
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

ranges = st.lists(st.integers(1, 10**6), min_size=2, max_size=9, unique=True)


@given(ranges, st.floats(-3.0, 4.0), st.floats(1e-9, 1e3))
def test_exact_powers_are_found(x, exponent, scale):
    found = growth(x, scale * np.array(x, dtype=float) ** exponent)
    assert found.exponent == pytest.approx(exponent, abs=1e-6)
    assert found.exponent_error == (np.inf if len(x) == 2 else pytest.approx(0.0, abs=1e-6))
    fitted = found.seconds(np.array(x, dtype=float), exponential=False)
    assert fitted == pytest.approx(scale * np.array(x, dtype=float) ** exponent, rel=1e-4)


@given(st.integers(2, 12), st.floats(0.3, 4.0), st.floats(1e-9, 1e3))
def test_exact_exponentials_are_found(last, factor, base):
    x = np.arange(1.0, last + 1.0)
    found = growth(x, base * factor**x)
    assert found.factor == pytest.approx(factor, rel=1e-9)
    assert found.seconds(x, exponential=True) == pytest.approx(base * factor**x, rel=1e-6)


@given(st.floats(0.5, 3.0), st.floats(0.0, 1e4))
def test_what_happens_in_the_lower_half_does_not_matter(exponent, more):
    x = 10.0 ** np.arange(2.0, 7.0)
    seconds = 1e-6 * x**exponent
    seconds[:2] += more
    assert growth(x, seconds).exponent == pytest.approx(exponent, abs=1e-9)


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_the_standard_error_is_that_of_the_noise(seed):
    rng = np.random.default_rng(seed)
    x = np.geomspace(1.0, 1e6, 2000)
    found = growth(x, x**2 * np.exp(rng.normal(0.0, 0.3, len(x))))
    upper = np.log(x[x >= 1e3])
    assert found.exponent_error == pytest.approx(
        0.3 / np.sqrt(np.sum((upper - upper.mean()) ** 2)), rel=0.2
    )
    assert abs(found.exponent - 2.0) < 6.0 * found.exponent_error


@pytest.mark.parametrize(
    ("x", "seconds"), [([1.0], [1.0]), ([1, 2], [1]), ([0, 1], [1, 1]), ([1, 2], [1, np.nan])]
)
def test_no_curve_no_growth(x, seconds):
    with pytest.raises(InputError):
        growth(x, seconds)


def smallest():
    """Each family with its smallest points."""
    return {
        "joints": joints.curves((2, 3)),
        "samples": samples.curves(300),
        "prototypes": prototypes.curves((4, 6), (2, 3)),
        "orders": orders.curves((1, 2)),
    }


@pytest.mark.parametrize(
    "name",
    [
        "joints",
        "prototypes",
        pytest.param("samples", marks=pytest.mark.slow),
        pytest.param("orders", marks=pytest.mark.slow),
    ],
)
def test_every_curve_can_be_measured(name):
    curves = smallest()[name]
    found = measure(curves, turns=1)
    assert [m.curve for m in found] == curves
    for one in found:
        assert tuple(one.x) == one.curve.x
        assert not one.stopped
        assert one.seconds.shape == one.x.shape
        assert np.all(np.isfinite(one.seconds) & (one.seconds > 0.0))
    rows = table({name: found}).splitlines()
    assert len(rows) == 2 + len(curves)
    assert all(row.count("|") == rows[0].count("|") for row in rows)


def test_what_takes_long_ends_a_curve(monkeypatch):
    monkeypatch.setattr("benchmarks.growth.curves.LONGEST", 0.0)
    asked = []

    def prepare(x):
        asked.append(x)
        return Work(lambda: sum(range(1000)))

    (found,) = measure([Curve("a sum", (1, 2, 3), prepare)], turns=2)
    assert set(asked) == {1}
    assert found.stopped
    assert found.x.tolist() == [1.0]
    assert "ends where" in table({"sums": [found]})


@pytest.mark.parametrize(("robot", "largest"), [("2r", 8), ("3r", 16), ("4r-planar", 32)])
def test_subgroups_are_nested_groups_of_the_orders_asked_for(robot, largest):
    group = primary_symmetries(GravityModel(load_robot(robot)).potential)
    assert group.order == largest
    smaller = None
    for order in (x for x in orders.ORDERS if x <= largest):
        found = orders.subgroup(group, order)
        assert found.order == order
        assert found.is_closed
        assert all(relation in group for relation in found)
        assert smaller is None or all(relation in found for relation in smaller)
        smaller = found


@pytest.mark.parametrize("order", [0, 3, 64])
def test_other_orders_are_refused(order):
    group = primary_symmetries(GravityModel(load_robot("2r")).potential)
    with pytest.raises(InputError, match="order of a subgroup"):
        orders.subgroup(group, order)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_arms_grow_as_the_page_says(n):
    random, chain = (GravityModel(arm(n)).potential for arm in (random_arm, planar_chain))
    assert len(random) == (3**n - 1) // 2
    assert primary_symmetries(random).order == 1
    assert len(chain) == n
    assert primary_symmetries(chain).order == 2 ** (n + 1)


def test_samples_on_the_lattice_are_all_prototypes_and_in_range():
    for side in (4, 9):
        q, step = prototypes.spread(side**2)
        assert len(q) == side**2
        away = np.abs((q[:, None] - q + np.pi) % (2 * np.pi) - np.pi)
        distance = np.linalg.norm(away, axis=2) + 10.0 * np.eye(len(q))
        assert distance.min() > prototypes.RADIUS * step


def synthetic():
    x = np.array([1.0, 2.0, 4.0, 8.0])
    return [
        Measured(Curve("a square", (1, 2, 4, 8), Work, panel), x, 1e-6 * x**2)
        for panel in ("left", "right")
    ] + [Measured(Curve("a power of two", (1,), Work, "right", "joint"), x, 1e-6 * 2.0**x)]


def test_pictures_say_the_growth_and_are_the_same_every_time(tmp_path):
    figure = picture("x", synthetic())
    left, right = ([text.get_text() for text in ax.get_legend().texts] for ax in figure.axes)
    assert left == ["a square: exponent 2.00 ± 0.00"]
    assert right == [*left, "a power of two: factor 2.00 ± 0.00 per joint"]
    assert [ax.get_xscale() + ax.get_yscale() for ax in figure.axes] == ["loglog"] * 2
    path = write_picture(tmp_path, "x", "x", synthetic())
    assert path.name == "growth-x.svg"
    assert path.read_text() == to_svg(picture("x", synthetic()), "growth-x", "x") + "\n"
    assert path.read_text().startswith("<svg")


def test_a_curve_of_one_point_can_be_drawn():
    one = Measured(Curve("a point", (3,), Work), np.array([3.0]), np.array([1e-3]), stopped=True)
    assert to_svg(picture("x", [one]), "x", "x").startswith("<svg")
