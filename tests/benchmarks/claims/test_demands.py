"""Demands hold of outcomes that are as they should be, and fail of each that is not."""

from dataclasses import replace

import pytest
from scipy.stats import binom

from benchmarks.claims.claims import Claims
from benchmarks.claims.data_sets import CLEAN, settings
from benchmarks.claims.demands import at_least, at_most, demands, lower, upper
from benchmarks.claims.naming import WORDS, Naming
from benchmarks.claims.outcomes import Outcome

SPRING, OFFSET, CABLE = ("spring", 1), ("offset", 1), ("cable", 1)


def as_wanted(setting):
    """Right claims, and the right name from 3.5 standard errors on."""
    right = ((WORDS[setting.kind], 1),) if setting.kind in WORDS else ()
    named = (right,) if right and setting.deviations > 3.5 else ()
    naming = Naming(named, right, (), 0.0)
    return Outcome(setting, 1, 0.1, setting.deviations, Claims(8, 7, 0, 0, 0.4, 8, 8, 0.0), naming)


POOLS = ("clean", "clean-unknown", "spring", "outliers")
GOOD = [as_wanted(s) for s in settings(pools=POOLS)]


def failed(found):
    return {demand.what for demand in demands(found) if not demand.holds}


def spoiled(share, pick, change):
    """Outcomes of which a share of those that are picked is changed."""
    wrong = [o for o in GOOD if pick(o)]
    worse = set(map(id, wrong[: round(share * len(wrong))]))
    return [change(o) if id(o) in worse else o for o in GOOD]


def named(outcome, *causes):
    return replace(outcome, naming=replace(outcome.naming, named=causes))


def claims(outcome, **changes):
    return replace(outcome, claims=replace(outcome.claims, **changes))


def test_all_holds_of_what_is_wanted():
    assert failed(GOOD) == set()
    assert len(demands(GOOD)) > 15
    assert all(d.of for d in demands(GOOD))


def clean(o):
    return o.setting.pool in CLEAN


def spring(o):
    return o.setting.pool == "spring"


@pytest.mark.parametrize(
    ("share", "pick", "change", "what"),
    [
        (
            0.02,
            lambda o: spring(o) and o.setting.robot == "3r",
            lambda o: claims(o, wrong=1),
            "3r, spring: data sets with a wrong claim",
        ),
        (
            0.06,
            lambda o: clean(o) and o.setting.robot == "2r" and o.setting.poses >= 100,
            lambda o: claims(o, order=4),
            "2r, clean: claimed is the exact group, or a larger one",
        ),
        (
            0.02,
            lambda o: clean(o) and o.setting.robot == "2r",
            lambda o: claims(o, order=16),
            "2r, clean: claimed is a larger group than any within the errors",
        ),
        (
            0.12,
            lambda o: spring(o) and o.deviations >= 8 and o.setting.poses >= 40,
            lambda o: named(o, (OFFSET, SPRING)),
            "spring, from 8 standard errors on: the right cause is named first",
        ),
        (
            0.07,
            lambda o: spring(o) and o.deviations >= 4.5,
            lambda o: named(o, (OFFSET,)),
            "spring, from 4.5 standard errors on: it is among those that are named",
        ),
        (
            1.0,
            lambda o: spring(o) and o.deviations >= 4.5,
            lambda o: named(o, (SPRING, OFFSET, CABLE, ("gain", 0))),
            "spring, from 4.5 standard errors on: causes that are not told apart",
        ),
        (
            0.3,
            lambda o: spring(o) and o.deviations < 3.5,
            lambda o: named(o, (OFFSET,)),
            "spring, below 3.5 standard errors: nothing wrong is said",
        ),
        (
            0.3,
            lambda o: o.setting.pool == "outliers" and o.deviations < 3.5,
            lambda o: named(o, (OFFSET,)),
            "outliers, below 3.5 standard errors: nothing wrong is said",
        ),
        (
            0.1,
            lambda o: o.setting.pool == "clean-unknown" and o.setting.robot == "3r",
            lambda o: named(o, (OFFSET,)),
            "3r, clean-unknown: no cause is named",
        ),
    ],
)
def test_a_demand_fails_that_is_not_met(share, pick, change, what):
    assert what in failed(spoiled(share, pick, change))


def test_the_right_name_is_not_demanded_of_what_is_hardly_there():
    silent = [named(o) if o.deviations < 4.5 else o for o in GOOD]
    assert failed(silent) == set()


def test_a_few_data_sets_fail_only_what_is_as_good_as_certain():
    assert at_most("wrong", 1, 16, 0.015).holds
    assert not at_most("wrong", 3, 16, 0.015).holds
    assert at_least("named", 12, 16, 0.9).holds
    assert not at_least("named", 9, 16, 0.9).holds
    assert not at_most("wrong", 1, 16, 0.0).holds


@pytest.mark.parametrize(("count", "of"), [(0, 300), (3, 20), (19, 20)])
def test_limits_are_those_of_clopper_and_pearson(count, of):
    assert binom.cdf(count, of, upper(count, of)) == pytest.approx(0.05)
    if count:
        assert binom.sf(count - 1, of, lower(count, of)) == pytest.approx(0.05)
    assert upper(of, of) == 1.0
    assert lower(0, of) == 0.0
