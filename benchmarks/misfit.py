"""Claims from arms that are more than rigid gravity: offsets, springs; and from clean ones.

Usage: python -m benchmarks.misfit [--rows 500 2000] [--seeds 200 40] [--json] [--write]

Every data set is an arm of its own: the built-in robot with a constant torque, or a spring, on one
joint (even seeds) or on all of them with random signs (odd seeds). Rows lie anywhere, or where an
arm without a controller can rest (stable). Torques are exact or have independent normal errors of
0.05 N m; nobody tells the learner. A data set counts as wrong if any relation that
`learn_relations` claims misses the torque *as measured* (without noise, offset or spring included)
by more than its bound somewhere in 600 random configurations; the floor is 1e-9 of the largest
torque. Cells that are done are kept in --cache, so that an interrupted run goes on. With --write
the table goes into docs/relations.md.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.load_robot import load_robot

Array = NDArray[np.float64]
PAGE = Path(__file__).parents[1] / "docs" / "relations.md"
BEGIN, END = "<!-- begin: python -m benchmarks.misfit --write -->", "<!-- end of misfit -->"

ROBOTS = ("2r", "3r")
NOISES = (0.0, 0.05)
CAUSES = (
    ("clean", 0.0),
    ("offset", 0.05),
    ("offset", 0.2),
    ("offset", 0.5),
    ("spring", 0.005),
    ("spring", 0.01),
    ("spring", 0.03),
)
REGIONS = ("anywhere", "stable")
ROWS = (20, 50, 100, 500, 2000)
PROBES, FLOOR = 600, 1e-9
MOST_WRONG, SURE = 0.01, 100
"""Largest share of data sets with a wrong claim; number of rows from which there are none."""


@dataclass(frozen=True)
class Cell:
    """Kind of data sets: arm, misfit, its size, number of rows.

    Attributes
    ----------
    robot, region, cause : str
    size : float
        Of the cause: N m, or share of the joint's largest torque per radian.
    noise : float
        Of the torques [N m].
    rows : int
    """

    robot: str
    region: str
    cause: str
    size: float
    noise: float
    rows: int


@dataclass(frozen=True)
class Result:
    """Counts of right, wrong and missing claims of a cell.

    Attributes
    ----------
    seeds, claimed, told, wrong : int
        Data sets; those with a relation but the identity; those of which something besides gravity
        was said; those with a claim beyond its bound.
    relations, wrong_relations : int
        Relations claimed, the identity left out, and how many were wrong.
    worst : float
        Largest ratio of error and bound.
    """

    seeds: int
    claimed: int
    told: int
    wrong: int
    relations: int
    wrong_relations: int
    worst: float


@cache
def _arm(robot: str) -> tuple[TrigonometricPolynomial, Array]:
    potential = GravityModel(load_robot(robot)).potential.to_float()
    anywhere = np.random.default_rng(0).uniform(-np.pi, np.pi, (4000, potential.n))
    return potential, np.abs(potential.gradient(anywhere)).max(axis=0)


def data_set(cell: Cell, seed: int) -> tuple[Array, Array, Array, Array]:
    """Return q, measured tau, and the constants b and spring rates k of the arm of a seed."""
    potential, peak = _arm(cell.robot)
    rng = np.random.default_rng([seed, cell.rows])
    n = potential.n
    joints = np.zeros(n)
    joints[rng.integers(n)] = 1.0
    signs = rng.choice([-1.0, 1.0], n) * (joints if seed % 2 == 0 else 1.0)
    b = cell.size * signs * (cell.cause == "offset")
    k = cell.size * peak * signs * (cell.cause == "spring")
    q = rng.uniform(-np.pi, np.pi, (cell.rows, n))
    if cell.region == "stable":
        q = np.empty((0, n))
        while len(q) < cell.rows:
            more = rng.uniform(-np.pi, np.pi, (30 * cell.rows, n))
            q = np.concatenate([q, more[np.linalg.eigvalsh(potential.hessian(more))[:, 0] > 0.0]])
        q = q[: cell.rows]
    tau = potential.gradient(q) + b + k * q
    return q, tau + cell.noise * rng.normal(size=q.shape), b, k


def excess(relation: SymmetryRelation, robot: str, b: Array, k: Array, seed: int) -> float:
    """Largest error of a relation of the measured torque, in units of its bound."""
    potential, peak = _arm(robot)
    q = np.random.default_rng([seed, 1]).uniform(-np.pi, np.pi, (PROBES, potential.n))
    image = wrap(relation.configuration(q))
    measured, there = (potential.gradient(x) + b + k * x for x in (q, image))
    error = np.abs(there - relation.torque(measured)).max(axis=0)
    return float((error / (relation.bound + FLOOR * peak.max())).max())


def judged(cell: Cell, seeds: range) -> Result:
    """Learn from every data set of a cell and hold all claims against the arm it came from."""
    claimed = told = wrong = relations = wrong_relations = 0
    worst = 0.0
    for seed in seeds:
        q, tau, b, k = data_set(cell, seed)
        learned = learn_relations(q, tau)
        ratios = [
            excess(entry.relation, cell.robot, b, k, seed)
            for entry in learned.relations
            if not entry.relation.is_identity
        ]
        claimed += bool(ratios)
        told += bool(learned.lack is not None and learned.lack.said)
        wrong += any(ratio > 1.0 for ratio in ratios)
        relations += len(ratios)
        wrong_relations += sum(ratio > 1.0 for ratio in ratios)
        worst = max([worst, *ratios])
    return Result(len(seeds), claimed, told, wrong, relations, wrong_relations, worst)


def cells() -> list[Cell]:
    """All cells, those with few rows first."""
    return [
        Cell(robot, region, cause, size, noise, rows)
        for rows in ROWS
        for robot in ROBOTS
        for region in REGIONS
        for cause, size in CAUSES
        for noise in NOISES
    ]


def holds(cell: Cell, result: Result) -> bool:
    """Whether a cell has no more wrong data sets than demanded."""
    most = 0.0 if cell.rows >= SURE else MOST_WRONG
    return result.wrong <= most * result.seeds


def main(arguments: list[str] | None = None) -> int:
    """Print the table in Markdown, or as JSON; 1 if a cell does not hold what is demanded."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rows", type=int, nargs="*", default=list(ROWS))
    parser.add_argument(
        "--seeds",
        type=int,
        nargs="*",
        default=[200],
        help="data sets a cell, one for each of --rows",
    )
    parser.add_argument("--cache", type=Path, default=Path("out/misfit.jsonl"))
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE.name}")
    options = parser.parse_args(arguments)
    if len(options.seeds) not in (1, len(options.rows)):
        parser.error("--seeds: one number, or as many as --rows")
    seeds = dict(zip(options.rows, options.seeds * len(options.rows), strict=False))
    done = _read(options.cache)
    results: list[tuple[Cell, Result]] = []
    for cell in cells():
        if cell.rows not in options.rows:
            continue
        key = json.dumps([asdict(cell), seeds[cell.rows]], sort_keys=True)
        if key not in done:
            result = judged(cell, range(seeds[cell.rows]))
            options.cache.parent.mkdir(parents=True, exist_ok=True)
            with options.cache.open("a") as file:
                file.write(json.dumps([key, asdict(result)]) + "\n")
            done[key] = asdict(result)
            print(f"{cell}: {result}", file=sys.stderr, flush=True)
        results.append((cell, Result(**done[key])))
    if options.json:
        print(json.dumps([asdict(c) | asdict(r) for c, r in results], indent=1))
    else:
        print(table(results))
    if options.write:
        PAGE.write_text(with_table(PAGE.read_text(), table(results)))
    return int(not all(holds(cell, result) for cell, result in results))


def table(results: list[tuple[Cell, Result]]) -> str:
    """Sums over robots, regions and noise: a row per cause, a column per number of rows."""
    counts = sorted({cell.rows for cell, _ in results})
    lines = [["arm", *[f"{rows} rows" for rows in counts], "worst error / bound"]]
    lines.append(["---"] * len(lines[0]))
    for cause, size in CAUSES:
        found = [(c, r) for c, r in results if (c.cause, c.size) == (cause, size)]
        cells_of = [[r for c, r in found if c.rows == rows] for rows in counts]
        worst = max((r.worst for _, r in found), default=0.0)
        lines.append([_name(cause, size), *map(_summed, cells_of), f"{worst:.2g}"])
    text = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    kept = sum(holds(cell, result) for cell, result in results)
    runs, wrong = sum(r.seeds for _, r in results), sum(r.wrong for _, r in results)
    clean = [r for c, r in results if c.cause == "clean"]
    alarms, quiet = sum(r.told for r in clean), sum(r.seeds for r in clean)
    return (
        f"{text}\n\nEvery entry: data sets with a wrong claim / with claims / all. Wrong in all: "
        f"{wrong} of {runs}; cells as demanded: {kept} of {len(results)}. Of {quiet} clean data "
        f"sets {alarms} were said to have an offset or a misfit."
    )


def _name(cause: str, size: float) -> str:
    if cause == "offset":
        return f"offset {size:g} N m"
    return "clean" if cause == "clean" else f"spring {100 * size:g} %/rad"


def _summed(results: list[Result]) -> str:
    wrong, claimed, seeds = (
        sum(getattr(r, name) for r in results) for name in ("wrong", "claimed", "seeds")
    )
    return f"{wrong} / {claimed} / {seeds}"


def with_table(page: str, rows: str) -> str:
    """Return a page with another table between its marks."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{rows}\n{END}{after}"


def _read(path: Path) -> dict[str, Any]:
    if not path.exists():
        return {}
    return dict(json.loads(line) for line in path.read_text().splitlines())


if __name__ == "__main__":
    sys.exit(main())
