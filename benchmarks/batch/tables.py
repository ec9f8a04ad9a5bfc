"""Tables of the benchmark of batch learning: equal samples, equal errors."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from typing import Any

import numpy as np

CONTAINS_TRUTH = ("trigonometric", "parametric")
ERRORS = {"2r": (0.1, 0.01, 0.001), "3r": (0.3, 0.03, 0.003), "ur5": (0.5, 0.05), "panda": (0.5,)}
SHARE = 0.01
"""Share of the largest torque that the worst joint's RMSE may have."""


@dataclass(frozen=True)
class Row:
    """One learner on one number of samples."""

    robot: str
    learner: str
    symmetries: str
    samples: int
    noise_degrees: float
    errors: list[float]
    on_paper_targets: dict[str, float]
    share_of_max: float
    seconds: float
    order: float
    demanded: float | None
    paper: float | None

    @property
    def median(self) -> float:
        """Median of the errors."""
        return statistics.median(self.errors)


def samples_needed(curve: dict[int, float], error: float) -> float | None:
    """Samples at which a curve falls below an error for good, interpolated logarithmically."""
    counts = sorted(curve)
    below = [n for i, n in enumerate(counts) if all(curve[m] <= error for m in counts[i:])]
    if not below or below[0] == counts[0]:
        return float(below[0]) if below else None
    after, before = below[0], counts[counts.index(below[0]) - 1]
    share = np.log(curve[before] / error) / np.log(curve[before] / curve[after])
    return float(before * (after / before) ** share)


def equal_errors(rows: list[Row]) -> list[dict[str, Any]]:
    """Samples needed with and without symmetries for the same error, and their ratio by seed."""
    result = []
    keys = dict.fromkeys((row.noise_degrees, row.robot, row.learner) for row in rows)
    for noise, robot, learner in keys:
        chosen = [
            row
            for row in rows
            if (row.noise_degrees, row.robot, row.learner) == (noise, robot, learner)
        ]
        for error in ERRORS[robot]:
            needed: dict[str, list[float | None]] = {}
            first: dict[str, int] = {}
            for kind in ("exact", "none"):
                of_kind = [row for row in chosen if row.symmetries == kind]
                if not of_kind:
                    break
                first[kind] = min(row.samples for row in of_kind)
                needed[kind] = [
                    samples_needed({row.samples: row.errors[i] for row in of_kind}, error)
                    for i in range(len(of_kind[0].errors))
                ]
            if len(needed) < 2 or any(n is None for n in needed["exact"]):
                continue
            pairs = list(zip(needed["exact"], needed["none"], strict=True))
            reached = [b for _, b in pairs if b is not None]
            ratios = [b / a for a, b in pairs if a is not None and b is not None]
            result.append(
                {
                    "robot": robot,
                    "learner": learner,
                    "noise_degrees": noise,
                    "error": error,
                    "order": next(row.order for row in chosen if row.symmetries == "exact"),
                    "exact": statistics.median(n for n in needed["exact"] if n is not None),
                    "none": statistics.median(reached) if reached else None,
                    "ratio": ratios if len(ratios) == len(pairs) else None,
                    "exact_at_most": all(n == first["exact"] for n in needed["exact"]),
                    "none_at_most": all(n == first["none"] for n in needed["none"]),
                }
            )
    return result


def resolved(item: dict[str, Any]) -> bool:
    """Whether an entry of `equal_errors` has a ratio that the curves resolve."""
    return bool(item["ratio"]) and not item["exact_at_most"] and not item["none_at_most"]


def sentence(rows: list[Row]) -> str:
    """What the factor really is, from the measured entries."""
    items = [item for item in equal_errors(rows) if item["learner"] not in CONTAINS_TRUTH]
    clean = [item for item in items if not item["noise_degrees"] and resolved(item)]
    parts = []
    for robot in dict.fromkeys(item["robot"] for item in clean):
        of_robot = [item for item in clean if item["robot"] == robot]
        ratios = [statistics.median(item["ratio"]) for item in of_robot]
        beyond = sum(
            not item["noise_degrees"] and item["robot"] == robot and item["ratio"] is None
            for item in items
        )
        more = f" (and {beyond} times no number tried sufficed without)" if beyond else ""
        parts.append(
            f"{min(ratios):.1f} to {max(ratios):.1f} times the samples on {robot}, "
            f"whose group has order {of_robot[0]['order']:g}{more}"
        )
    if not parts:
        return "No entry resolves the factor."
    return (
        "What the factor really is: without symmetries the same error takes "
        + "; ".join(parts)
        + ". It depends on the learner and on the error asked for; the order of the group is "
        "neither its value nor a bound."
    )


def tables(rows: list[Row]) -> str:
    """All tables as Markdown, and the sentence that says what the factor is."""
    parts = [sentence(rows), "### Demanded", _demanded_table(rows)]
    for noise in dict.fromkeys(row.noise_degrees for row in rows):
        chosen = [row for row in rows if row.noise_degrees == noise]
        said = f"angles off by {noise:g} degrees" if noise else "no noise"
        parts += [f"### Equal errors, {said}", _equal_error_table(chosen)]
        parts += [f"### Equal samples, {said}", _equal_sample_table(chosen)]
        if not noise:
            parts += [
                "### Samples for 1 % of the largest torque",
                "RMSE of the worst joint (median over the seeds), smallest number tried.",
                _share_table(chosen),
            ]
    return "\n\n".join(parts)


def _demanded_table(rows: list[Row]) -> str:
    head = ["robot", "samples in the BCTS", "learner", "paper", "demanded", "RMSE, dense [N m]"]
    head += ["on the paper's targets", "fit [s]"]
    lines = [_line(head), "|---" * len(head) + "|"]
    for row in rows:
        if row.demanded is None:
            continue
        paper = "" if row.paper is None else f"{row.paper:g}"
        found = f"{row.median:.2g} ({min(row.errors):.2g} .. {max(row.errors):.2g})"
        on_targets = ", ".join(f"{k}: {v:.2g}" for k, v in row.on_paper_targets.items())
        cells = [row.robot, str(row.samples), row.learner, paper, f"{row.demanded:g}", found]
        lines.append(_line([*cells, on_targets, f"{row.seconds:.2g}"]))
    return "\n".join(lines)


def _line(cells: list[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _equal_sample_table(rows: list[Row]) -> str:
    head = ["robot", "symmetries", "samples", "learner", "RMSE, dense [N m]"]
    head += ["on the paper's targets", "worst joint, % of max torque", "fit [s]"]
    lines = [_line(head), "|---" * len(head) + "|"]
    for parametric in (False, True):
        for row in rows:
            if (row.learner in CONTAINS_TRUTH) is not parametric:
                continue
            spread = f"{row.median:.2g} ({min(row.errors):.2g} .. {max(row.errors):.2g})"
            paper = ", ".join(f"{k}: {v:.2g}" for k, v in row.on_paper_targets.items())
            found = f" ({row.order:g})" if row.symmetries in ("exact", "learned") else ""
            cells = [row.robot, row.symmetries + found, str(row.samples), row.learner, spread]
            cells += [paper, f"{100 * row.share_of_max:.2g}", f"{row.seconds:.2g}"]
            lines.append(_line(cells))
    return "\n".join(lines)


def _equal_error_table(rows: list[Row]) -> str:
    head = ["robot", "learner", "RMSE [N m]", "exact", "none", "ratio"]
    lines = [_line(head), "|---" * len(head) + "|"]
    for item in equal_errors(rows):
        exact = ("<= " if item["exact_at_most"] else "") + f"{item['exact']:.0f}"
        if item["ratio"] is None:
            none, ratio = "more than tried", "larger"
        else:
            none = ("<= " if item["none_at_most"] else "") + f"{item['none']:.0f}"
            spread = item["ratio"]
            ratio = f"{statistics.median(spread):.1f} ({min(spread):.1f} .. {max(spread):.1f})"
            if not resolved(item):
                ratio = "not resolved"
        cells = [item["robot"], item["learner"], f"{item['error']:g}", exact, none, ratio]
        lines.append(_line(cells))
    return "\n".join(lines)


def _share_table(rows: list[Row]) -> str:
    kinds = ("exact", "learned", "free", "none")
    lines = [_line(["robot", "learner", *kinds]), "|---" * (2 + len(kinds)) + "|"]
    for robot, learner in dict.fromkeys((row.robot, row.learner) for row in rows):
        cells = []
        for kind in kinds:
            of_kind = {
                row.samples: row.share_of_max
                for row in rows
                if (row.robot, row.learner, row.symmetries) == (robot, learner, kind)
            }
            good = [n for n in of_kind if all(s <= SHARE for m, s in of_kind.items() if m >= n)]
            cells.append(str(min(good)) if good else ("more" if of_kind else ""))
        lines.append(_line([robot, learner, *cells]))
    return "\n".join(lines)
