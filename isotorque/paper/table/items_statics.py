"""Rows of sections 3 to 5: symmetric configurations, BCTS, discovery, static torques."""

from __future__ import annotations

from collections.abc import Callable

from isotorque.paper import published as paper
from isotorque.paper.table.reading import entry, number, settings_differ
from isotorque.paper.table.rules import above, at_least, below, close_to, equal, within
from isotorque.paper.table.table import Item, Numbers, Value

MAP_TOLERANCE = 1e-9
RANGE_SHARE = 0.03
INADMISSIBLE = 0.01


SYMMETRIES = (
    Item(
        "configurations of one absolute torque, 2R",
        "3.2.1, Fig. 2A",
        "symmetries-2r",
        number("configurations"),
        paper.CONFIGURATIONS,
        "",
        equal(),
        lambda n: "the torque drawn lies where fewer configurations exist (8 or 16)",
        {"share of all torques that have so many": number("share_of_most")},
    ),
    Item(
        "primary sets they fall into",
        "3.2.1, Fig. 2A",
        "symmetries-2r",
        number("primary_sets"),
        paper.PRIMARY_SETS,
        "",
        equal(),
        settings_differ,
    ),
    Item(
        "configurations in each primary set",
        "3.2.1, Fig. 2A",
        "symmetries-2r",
        number("per_set"),
        [paper.PRIMARY_2R] * paper.PRIMARY_SETS,
        "",
        equal(),
        settings_differ,
    ),
    Item(
        "configurations of each signed torque",
        "3.2.1, Eq. 8",
        "symmetries-2r",
        number("per_torque"),
        [paper.CONFIGURATIONS_PER_TORQUE] * 4,
        "",
        equal(),
        settings_differ,
    ),
    Item(
        "primary symmetries of the 2R arm",
        "4.3.1",
        "ranges-2r",
        number("order"),
        paper.PRIMARY_2R,
        "",
        equal(),
        settings_differ,
    ),
    Item(
        "primary symmetries of the 3R arm",
        "4.3.1",
        "ranges-3r",
        number("order"),
        paper.PRIMARY_3R,
        "",
        equal(),
        settings_differ,
    ),
    *(
        Item(
            f"Eq. 11, map {place + 1}: largest torque error",
            "4.2, Eq. 11",
            "symmetries-2r",
            entry("map_errors", place),
            0.0,
            "N m",
            below(MAP_TOLERANCE, "N m"),
            lambda n: "the printed map is no symmetry of this arm",
            {"signs of the torques": entry("map_signs", place)},
        )
        for place in range(len(paper.PRINTED_MAPS))
    ),
)

BCTS = (
    Item(
        "BCTS: corners of the parallelogram (q1, q2)",
        "4.3.1, Fig. 6",
        "domain-2r",
        number("corners"),
        [list(corner) for corner in paper.BCTS_CORNERS],
        "rad",
        close_to(1e-9, "rad"),
        lambda n: f"the domain has {n['corner_count']:g} corners elsewhere",
    ),
    Item(
        "reduction factor of the BCTS, 2R",
        "4.3.1",
        "domain-2r",
        number("reduction"),
        paper.REDUCTION_2R,
        "",
        within(1e-9),
        settings_differ,
    ),
    Item(
        "reduction with secondary symmetries, up to, 2R",
        "4.3.1",
        "symmetries-2r",
        number("most_configurations"),
        paper.REDUCTION_WITH_SECONDARY,
        "",
        equal(),
        settings_differ,
    ),
    Item(
        "configurations in the BCTS of one absolute torque, at most",
        "4.3.1",
        "symmetries-2r",
        number("most_in_domain"),
        1,
        "",
        equal(),
        lambda n: (
            f"a primary set has one member in the BCTS, but {100 * n['share_of_most']:.0f} % of "
            f"all torques have {n['most_in_domain']:g} primary sets (secondary symmetry): the BCTS "
            "is bijective up to those"
        ),
    ),
)


def _range_items(arm: str, section: str, ranges: tuple[tuple[float, float], ...]) -> list[Item]:
    items = []
    for joint, (low, high) in enumerate(ranges):
        for key, printed, words in (("lowest", low, "smallest"), ("highest", high, "largest")):
            items.append(
                Item(
                    f"{words} static torque of joint {joint + 1}, {arm.upper()}",
                    section,
                    f"ranges-{arm}",
                    entry(key, joint),
                    printed,
                    "N m",
                    within(RANGE_SHARE),
                    _range_reason(joint, printed),
                )
            )
    return items


def _range_reason(joint: int, printed: float) -> Callable[[Numbers], str]:
    return lambda numbers: _range_why(numbers, joint, printed)


def _range_why(numbers: Numbers, joint: int, printed: float) -> str:
    low, high = numbers["lowest"][joint], numbers["highest"][joint]
    if not numbers["negating"]:
        return f"this arm's torques range from {low:.4g} to {high:.4g} N m"
    return (
        f"{numbers['negating']:g} primary symmetries negate all torques (q1 -> q1 + pi is one), so "
        f"the range over all configurations is symmetric: {low:.4g} to {high:.4g} N m; "
        f"{printed:g} is not an end of it (perhaps of the configurations the authors visited)"
    )


RANGES_2R = tuple(_range_items("2r", "7.1.1", paper.TORQUES_2R))
RANGES_3R = tuple(_range_items("3r", "7.1.2", paper.TORQUES_3R))


def _discovered_why(numbers: Numbers) -> str:
    return (
        f"an arm without controller rests at stable equilibria alone, and an absolute torque has "
        f"{numbers['most_stable_members']:g} of them at most; sequences found "
        f"{numbers['discovered']:g} (median), {numbers['most_discovered']:g} at most, the first "
        "one included"
    )


def _seen_in_pairs(arm: str, experiment: str, printed: int) -> Item:
    return Item(
        f"of these seen in pairs of discovered configurations, {arm}",
        "4.2",
        experiment,
        number("observed_relations"),
        printed,
        "",
        equal(),
        lambda n: (
            "regression needs pairs, and an arm without controller shows only stable members of "
            f"a set: {n['observed_relations']:g} relations lead from one to another; the others "
            "are identified by fitting a rigid arm's potential to the same samples"
        ),
    )


DISCOVERY_2R = (
    Item(
        "configurations discovered, first sequence of Fig. 4; our most",
        "4.1, Fig. 4",
        "discovery-2r",
        number("most_discovered"),
        paper.DISCOVERED[0],
        "",
        equal(),
        _discovered_why,
        {"stable ones there are": number("most_stable_members")},
    ),
    Item(
        "configurations discovered, second sequence of Fig. 4; our most",
        "4.1, Fig. 4",
        "discovery-2r",
        number("most_discovered"),
        paper.DISCOVERED[1],
        "",
        at_least(),
        _discovered_why,
        {"median sequence": number("discovered"), "profiles played": number("profiles")},
    ),
    Item(
        "relations learned before learning begins (n_min), 2R",
        "5.4",
        "discovery-2r",
        number("relations"),
        paper.PRIMARY_2R,
        "",
        equal(),
        lambda n: f"only {n['relations']:g} were known after {n['motions']:g} motions",
        {"false ones": number("false_relations"), "settled samples": number("samples")},
    ),
    _seen_in_pairs("2R", "discovery-2r", paper.PRIMARY_2R),
)

DISCOVERY_3R = (
    Item(
        "relations learned before learning begins (n_min), 3R",
        "5.4",
        "discovery-3r",
        number("relations"),
        paper.PRIMARY_3R,
        "",
        equal(),
        lambda n: f"only {n['relations']:g} were known after {n['motions']:g} motions",
        {"false ones": number("false_relations"), "settled samples": number("samples")},
    ),
    _seen_in_pairs("3R", "discovery-3r", paper.PRIMARY_3R),
)


def _constrained_why(key: str) -> Value:
    return lambda n: (
        f"{100 * n[key]:.1f} % were inadmissible, of the first 1,000 after discovery: the "
        "estimate of the set is still growing at its fringe, where the arm is about to give way"
    )


STATIC_TORQUES = (
    Item(
        "inadmissible torques, constrained Goal Babbling",
        "5.1, Fig. 7B",
        "static-torques-2r",
        number("constrained_babbling_share"),
        "avoided",
        "",
        below(INADMISSIBLE, ""),
        _constrained_why("constrained_babbling_share"),
        {"RMSE of the model [N m]": number("constrained_babbling_rmse")},
    ),
    Item(
        "inadmissible torques, original Goal Babbling",
        "5.1, Fig. 7A",
        "static-torques-2r",
        number("babbling_share"),
        "occur",
        "",
        above(0.0, ""),
        lambda n: "none occurred: the goals lie where the arm holds itself",
        {"RMSE of the model [N m]": number("babbling_rmse")},
    ),
    Item(
        "inadmissible torques, Constrained Direction Sampling",
        "5.2",
        "static-torques-2r",
        number("constrained_sampling_share"),
        "avoided",
        "",
        below(INADMISSIBLE, ""),
        _constrained_why("constrained_sampling_share"),
        {"RMSE of the model [N m]": number("constrained_sampling_rmse")},
    ),
    Item(
        "inadmissible torques, original Direction Sampling",
        "5.2",
        "static-torques-2r",
        number("sampling_share"),
        "occur",
        "",
        above(0.0, ""),
        settings_differ,
        {"RMSE of the model [N m]": number("sampling_rmse")},
    ),
)
