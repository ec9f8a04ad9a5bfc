"""The table: every printed number beside the measured one, and whether it holds."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from isotorque.paper.table.rules import Rule
from isotorque.symbolic.common.errors import InputError

Numbers = Mapping[str, Any]
"""Numbers of one experiment: of one seed, or medians over seeds."""
Value = Callable[[Numbers], Any]


@dataclass(frozen=True)
class Item:
    """One printed number and where ours comes from.

    Attributes
    ----------
    item : str
        What it is, in words.
    section : str
        Where it stands in the paper.
    experiment : str
        Name of the experiment that measures it, or several names joined by ``+``.
    value : callable
        Takes ours out of the numbers of that experiment.
    paper : number, nested sequence of numbers, or str
        As printed; words where the paper has words.
    unit : str
        Unit of both.
    rule : Rule
        When it holds.
    why : callable
        Why it does not hold, told from the (median) numbers; shown where it does not.
    beside : dict of str to callable
        More numbers to be printed beside ours, e.g. the error on the dense set.
    timed : bool
        Whether ours is a time: then it differs from run to run.
    """

    item: str
    section: str
    experiment: str
    value: Value
    paper: Any
    unit: str
    rule: Rule
    why: Callable[[Numbers], str]
    beside: Mapping[str, Value] = field(default_factory=dict)
    timed: bool = False


@dataclass(frozen=True)
class Row:
    """One row of the table; fields as in `Item`, numbers filled in.

    Attributes
    ----------
    ours : number, list or None
        Median over seeds; None where most seeds did not reach it.
    interval : (float, float) or None
        Lowest and highest of the seeds; an end is None where a seed did not reach it.
    seeds : int
        Number of seeds.
    holds : bool
        The rule applied to the median.
    why : str
        Empty where it holds.
    """

    item: str
    section: str
    experiment: str
    paper: Any
    ours: Any
    unit: str
    interval: tuple[float | None, float | None] | None
    seeds: int
    holds: bool
    rule: str
    why: str
    beside: dict[str, Any]
    timed: bool


def make_rows(items: Sequence[Item], measured: Mapping[str, Sequence[Numbers]]) -> list[Row]:
    """Return the rows of all items whose experiments were made.

    Parameters
    ----------
    items
        In the order of the table.
    measured
        Numbers by experiment, one entry per seed.

    Raises
    ------
    InputError
        If a row does not hold and says nothing of why.
    """
    rows = []
    for item in items:
        names = item.experiment.split("+")
        if all(measured.get(name) for name in names):
            rows.append(_row(item, _together(names, measured)))
    return rows


def _together(names: Sequence[str], measured: Mapping[str, Sequence[Numbers]]) -> list[Numbers]:
    """Return the numbers of each seed; of several experiments as ``experiment.number``."""
    if len(names) == 1:
        return list(measured[names[0]])
    return [
        {f"{name}.{key}": x for name, of in zip(names, seed, strict=True) for key, x in of.items()}
        for seed in zip(*(measured[name] for name in names), strict=True)
    ]


def _row(item: Item, seeds: Sequence[Numbers]) -> Row:
    values = [item.value(numbers) for numbers in seeds]
    ours, interval = _middle(values)
    holds = bool(item.rule.holds(item.paper, ours))
    medians = {key: _middle([n.get(key) for n in seeds])[0] for key in seeds[0]}
    why = "" if holds else item.why(medians)
    if not holds and not why.strip():
        raise InputError("paper", item.item, "does not hold", "a reason")
    return Row(
        item=item.item,
        section=item.section,
        experiment=item.experiment,
        paper=item.paper,
        ours=_plain(ours),
        unit=item.unit,
        interval=interval,
        seeds=len(seeds),
        holds=holds,
        rule=item.rule.words,
        why=why,
        beside={
            name: _plain(_middle([value(n) for n in seeds])[0])
            for name, value in item.beside.items()
        },
        timed=item.timed,
    )


def _middle(values: Sequence[Any]) -> tuple[Any, tuple[float | None, float | None] | None]:
    """Return the median and the extremes; of lists the first, which are the same on all seeds."""
    if any(isinstance(value, list | tuple | str | np.ndarray) for value in values):
        return np.asarray(values[0]).tolist(), None
    numbers = [math.inf if value is None else float(value) for value in values]
    middle = statistics.median_low(numbers) if math.inf in numbers else statistics.median(numbers)
    if len(numbers) == 1:
        return middle, None
    low, high = (None if math.isinf(x) else x for x in (min(numbers), max(numbers)))
    return middle, (low, high)


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        if math.isinf(value):
            return None
        return int(value) if value.is_integer() and abs(value) < 1e9 else value
    return value
