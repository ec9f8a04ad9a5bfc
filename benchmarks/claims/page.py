"""Tables of outcomes, in Markdown."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import mean

from benchmarks.claims.data_sets import CLEAN, DATA_SETS, POOLS, ROBOTS, SIZES
from benchmarks.claims.demands import MANY, Demand, demands, number, part, set_size
from benchmarks.claims.naming import WORDS
from benchmarks.claims.outcomes import Outcome


def report(outcomes: Sequence[Outcome], command: str) -> str:
    """Everything, demands that do not hold first, and the command that measured it."""
    held = demands(outcomes)
    open_ones = [demand for demand in held if not demand.holds]
    parts = [
        f"`{command}`: {len(outcomes)} data sets; {len(held) - len(open_ones)} of {len(held)} "
        "demands hold." + (" These do not:" if open_ones else "")
    ]
    if open_ones:
        parts.append(_of_demands(open_ones))
    parts += [
        "### Claims\n\nData sets with a wrong claim / with any / all:",
        _by_robot(POOLS, outcomes, _claims, ("worst error / bound", _worst)),
        "### Names\n\nThe right cause is named first, by its size in standard errors, "
        f"below / from {MANY} poses; causes that are not told apart; something wrong said / all:",
        _powers(outcomes),
        "### Causes named in clean data\n\nData sets in which any was named / all:",
        _by_robot(CLEAN, outcomes, lambda some: _ratio(some, lambda o: bool(o.naming.named))),
        "### Processor time\n\nSeconds for claims + names, mean over all pools:",
        _times(outcomes),
    ]
    return "\n\n".join(parts)


def _of_demands(some: Sequence[Demand]) -> str:
    rows = [[demand.what, demand.measured, demand.demanded] for demand in some]
    return _table([["", "measured", "demanded"], *rows])


def _by_robot(
    pools: Sequence[str],
    outcomes: Sequence[Outcome],
    entry: Callable[[list[Outcome]], str],
    *more: tuple[str, Callable[[list[Outcome]], str]],
) -> str:
    rows = [["", *ROBOTS, *(name for name, _ in more)]]
    for pool in pools:
        whole = part(outcomes, None, pool)
        if whole:
            by_robot = [part(outcomes, robot, pool) for robot in ROBOTS]
            cells = [entry(some) if some else "" for some in by_robot]
            rows.append([pool, *cells, *(of_all(whole) for _, of_all in more)])
    return _table(rows)


def _powers(outcomes: Sequence[Outcome]) -> str:
    rows = [["", *(f"{size:g}" for size in SIZES), "not told apart", "wrong"]]
    for pool in map(str, WORDS):
        every = part(outcomes, None, pool)
        if not every:
            continue
        cells = []
        for low, high in zip(SIZES, (*SIZES[1:], float("inf")), strict=True):
            some = [o for o in every if low <= o.deviations < high]
            few = [o for o in some if o.setting.poses < MANY]
            many = [o for o in some if o.setting.poses >= MANY]
            cells.append(f"{_share(few)} / {_share(many)}" if some else "")
        wrong = _ratio(every, lambda o: o.naming.wrong)
        rows.append([pool, *cells, f"{set_size(every):.1f}", wrong])
    for pool in POOLS:
        if pool not in CLEAN and pool not in map(str, WORDS) and part(outcomes, None, pool):
            wrong = _ratio(part(outcomes, None, pool), lambda o: o.naming.wrong)
            rows.append([pool, *[""] * len(SIZES), "", wrong])
    return _table(rows)


def _share(some: Sequence[Outcome]) -> str:
    count, of = number(some, lambda o: o.naming.first)
    return f"{100 * count / of:.0f} %" if of else "-"


def _claims(some: Sequence[Outcome]) -> str:
    claiming = number(some, lambda o: o.claims.relations > 0)[0]
    return f"{number(some, lambda o: o.claims.wrong > 0)[0]} / {claiming} / {len(some)}"


def _worst(some: Sequence[Outcome]) -> str:
    return f"{max(o.claims.worst for o in some):.2g}"


def _ratio(some: Sequence[Outcome], so: Callable[[Outcome], bool]) -> str:
    count, of = number(some, so)
    return f"{count} / {of}"


def _times(outcomes: Sequence[Outcome]) -> str:
    rows = [["poses", *ROBOTS]]
    for poses in DATA_SETS:
        cells = []
        for robot in ROBOTS:
            some = [o for o in part(outcomes, robot, None) if o.setting.poses == poses]
            cells.append(
                f"{mean(o.claims.seconds for o in some):.2g} + "
                f"{mean(o.naming.seconds for o in some):.2g}"
                if some
                else ""
            )
        rows.append([str(poses), *cells])
    return _table(rows)


def _table(rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])
