"""Tables of the benchmark of batch learning: equal samples, equal errors."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from typing import Any

import numpy as np

CONTAINS_TRUTH = ("trigonometric", "parametric")
ERRORS = {"2r": (0.1, 0.01, 0.001), "3r": (0.3, 0.03, 0.003), "ur5": (0.5, 0.05), "panda": (0.5,)}


@dataclass(frozen=True)
class Row:
    """One learner on one number of samples."""

    robot: str
    learner: str
    symmetries: str
    samples: int
    noise_degrees: float
    errors: list[float]
    share_of_max: float
    seconds: float
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
    keys = dict.fromkeys((row.robot, row.learner) for row in rows)
    for robot, learner in keys:
        chosen = [row for row in rows if (row.robot, row.learner) == (robot, learner)]
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
                    "error": error,
                    "exact": statistics.median(n for n in needed["exact"] if n is not None),
                    "none": statistics.median(reached) if reached else None,
                    "ratio": ratios if len(ratios) == len(pairs) else None,
                    "exact_at_most": all(n == first["exact"] for n in needed["exact"]),
                    "none_at_most": all(n == first["none"] for n in needed["none"]),
                }
            )
    return result


def tables(rows: list[Row]) -> str:
    """Both tables as Markdown."""
    lines = ["Equal samples: RMSE [N m] on the dense set, median (range over seeds).", ""]
    head = ["robot", "symmetries", "samples", "learner", "RMSE", "worst joint, % of max torque"]
    lines += ["| " + " | ".join([*head, "fit [s]", "demanded", "paper"]) + " |"]
    lines += ["|---" * 9 + "|"]
    for parametric in (False, True):
        for row in rows:
            if (row.learner in CONTAINS_TRUTH) is not parametric:
                continue
            spread = f"{row.median:.2g} ({min(row.errors):.2g} .. {max(row.errors):.2g})"
            cells = [row.robot, row.symmetries, str(row.samples), row.learner, spread]
            cells += [f"{100 * row.share_of_max:.2g}", f"{row.seconds:.2g}"]
            cells += ["" if x is None else f"{x:g}" for x in (row.demanded, row.paper)]
            lines.append("| " + " | ".join(cells) + " |")
    lines += [
        "",
        "Equal errors: samples needed, interpolated on the curves above, and their ratio,",
    ]
    lines += ["median (range over seeds).", ""]
    lines += ["| robot | learner | RMSE [N m] | exact | none | ratio |", "|---" * 6 + "|"]
    for item in equal_errors(rows):
        exact = ("<= " if item["exact_at_most"] else "") + f"{item['exact']:.0f}"
        if item["ratio"] is None:
            none, ratio = "more than tried", "larger"
        else:
            none = ("<= " if item["none_at_most"] else "") + f"{item['none']:.0f}"
            spread = item["ratio"]
            ratio = f"{statistics.median(spread):.1f} ({min(spread):.1f} .. {max(spread):.1f})"
            if item["exact_at_most"] or item["none_at_most"]:
                ratio = "not resolved"
        cells = [item["robot"], item["learner"], f"{item['error']:g}", exact, none, ratio]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)
