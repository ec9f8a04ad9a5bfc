"""What is demanded of claims and names, and whether outcomes hold it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from statistics import mean

from scipy.stats import beta

from benchmarks.claims.data_sets import CLEAN, POOLS, ROBOTS
from benchmarks.claims.naming import WORDS
from benchmarks.claims.outcomes import Outcome

SURE = 0.95
"""Of the limits that are shown."""
DOUBT = 0.99
"""A demand on fewer data sets than `ENOUGH` fails if it is as good as certain that all would."""
ENOUGH = 200
WRONG, ALARMS = 0.015, 0.015
"""Largest share of data sets with a wrong claim in a pool, and of clean ones with a cause."""
ORDER = 0.95
NAMED, AMONG, QUIET = 0.90, 0.95, 0.95
SET = 3.0
"""Largest mean number of causes that are not told apart."""
CLEAR, VISIBLE, UNCLEAR = 8.0, 4.5, 3.5
"""Sizes in standard errors: named from the first on; in the set from the second on; nothing wrong
may be said below the third."""
MANY, ORDERED = 40, 100
"""Poses from which causes are named; from which all relations are claimed."""


@dataclass(frozen=True)
class Demand:
    """One thing that is demanded.

    Attributes
    ----------
    what, measured, demanded : str
    of : int
        Data sets that it speaks of.
    holds : bool
    """

    what: str
    measured: str
    demanded: str
    of: int
    holds: bool


def at_most(what: str, count: int, of: int, share: float) -> Demand:
    """No more than a share: none, or the limit shows it; of few data sets, it could be so.

    Examples
    --------
    >>> [at_most("wrong", k, 300, 0.015).holds for k in (0, 1, 2)]
    [True, False, False]
    >>> [at_most("wrong", k, 15, 0.015).holds for k in (2, 3)]
    [True, False]
    """
    limit = upper(count, of)
    holds = count == 0 or limit <= share
    if of < ENOUGH:
        holds = lower(count, of, DOUBT) <= share
    return Demand(
        what, f"{count} of {of} (at most {limit:.1%})", f"none, or {share:.1%}", of, holds
    )


def at_least(what: str, count: int, of: int, share: float) -> Demand:
    """At least a share; of few data sets, it could be so.

    Examples
    --------
    >>> [at_least("named", k, 200, 0.9).holds for k in (180, 179)]
    [True, False]
    >>> [at_least("named", k, 10, 0.9).holds for k in (7, 5)]
    [True, False]
    """
    holds = count >= share * of if of >= ENOUGH else upper(count, of, DOUBT) >= share
    return Demand(what, f"{count} of {of}", f"{share:.0%}", of, holds)


def upper(count: int, of: int, sure: float = SURE) -> float:
    """Largest probability with which so few of so many are likely (Clopper-Pearson).

    Examples
    --------
    >>> print(round(upper(0, 300), 5))
    0.00994
    """
    return 1.0 if count >= of else float(beta.ppf(sure, count + 1, of - count))


def lower(count: int, of: int, sure: float = SURE) -> float:
    """Smallest probability with which so many of so many are likely."""
    return 1.0 - upper(of - count, of, sure)


def demands(outcomes: Sequence[Outcome]) -> list[Demand]:
    """Everything that is demanded of these data sets; nothing of what there are none of."""
    every = [*_of_claims(outcomes), *_of_orders(outcomes), *_of_names(outcomes), *_alarms(outcomes)]
    return [demand for demand in every if demand.of]


def part(outcomes: Sequence[Outcome], robot: str | None, pool: str | None) -> list[Outcome]:
    """Outcomes of a robot and a pool, or of all of them."""
    return [
        o for o in outcomes if robot in (None, o.setting.robot) and pool in (None, o.setting.pool)
    ]


def number(some: Sequence[Outcome], so: Callable[[Outcome], bool]) -> tuple[int, int]:
    """How many outcomes are so, and how many there are."""
    return sum(map(so, some)), len(some)


def _of_claims(outcomes: Sequence[Outcome]) -> Iterator[Demand]:
    for pool in POOLS:
        for robot in ROBOTS:
            some = part(outcomes, robot, pool)
            what = f"{robot}, {pool}: data sets with a wrong claim"
            yield at_most(what, *number(some, lambda o: o.claims.wrong > 0), WRONG)


def _of_orders(outcomes: Sequence[Outcome]) -> Iterator[Demand]:
    for robot in ROBOTS:
        clean = [o for pool in CLEAN for o in part(outcomes, robot, pool)]
        many = [o for o in clean if o.setting.poses >= ORDERED]
        what = f"{robot}, clean: claimed is the exact group, or a larger one"
        yield at_least(what, *number(many, lambda o: o.claims.order >= o.claims.exact), ORDER)
        what = f"{robot}, clean: claimed is a larger group than any within the errors"
        yield at_most(what, *number(clean, lambda o: o.claims.order > o.claims.most), 0.0)


def _of_names(outcomes: Sequence[Outcome]) -> Iterator[Demand]:
    for pool in map(str, WORDS):
        every = part(outcomes, None, pool)
        clear = [o for o in every if o.deviations >= CLEAR and o.setting.poses >= MANY]
        what = f"{pool}, from {CLEAR:g} standard errors on: the right cause is named first"
        yield at_least(what, *number(clear, lambda o: o.naming.first), NAMED)
        seen = [o for o in every if o.deviations >= VISIBLE and o.naming.named]
        what = f"{pool}, from {VISIBLE:g} standard errors on: it is among those that are named"
        yield at_least(what, *number(seen, lambda o: o.naming.among), AMONG)
        size = set_size(seen)
        what = f"{pool}, from {VISIBLE:g} standard errors on: causes that are not told apart"
        yield Demand(what, f"{size:.1f}", f"at most {SET:g} (mean)", len(seen), size <= SET)
    for pool in POOLS:
        small = [o for o in part(outcomes, None, pool) if o.deviations < UNCLEAR]
        if pool not in CLEAN and small:
            what = f"{pool}, below {UNCLEAR:g} standard errors: nothing wrong is said"
            yield at_least(what, *number(small, lambda o: not o.naming.wrong), QUIET)


def _alarms(outcomes: Sequence[Outcome]) -> Iterator[Demand]:
    for pool in CLEAN:
        for robot in ROBOTS:
            some = part(outcomes, robot, pool)
            what = f"{robot}, {pool}: no cause is named"
            yield at_least(what, *number(some, lambda o: not o.naming.named), 1.0 - ALARMS)


def set_size(outcomes: Sequence[Outcome]) -> float:
    """Mean number of causes that the first one named cannot be told apart from, itself included."""
    sizes = [len(set(o.naming.named[0])) for o in outcomes if o.naming.named]
    return mean(sizes) if sizes else 0.0
