"""Learning relations from recordings: how many samples and torques the whole group takes.

Usage: python -m benchmarks.relations [--seeds 100] [--json]

*Pairing* and *both methods* get recordings of level sets: all configurations of random |torque|,
each kept with a probability drawn from 30-60 %. *Identification* gets what an arm without a
controller can rest at (stable configurations, uniform over them). Angles have independent normal
errors; torques are exact; nobody tells the learner the noise level. A run is right if it finds the
whole group and nothing else, offsets within 1e-9 rad (exact angles) or 0.2 deg. Offsets are
rounded to right angles where the data agree (the default), except in the rows that say "measured":
there noise of half a degree leaves more than 0.2 deg in some seeds. *False* counts relations that
the arm does not have, over all runs; *observed* is the mean number of relations seen in pairs.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray

from learning.relations.identification import identify
from learning.relations.learned_symmetries import LearnedSymmetries
from learning.relations.pairing import pair_relations
from learning.relations.relation_learning import learn_relations
from symbolic.gravity import GravityModel
from symbolic.level_sets import level_set
from symbolic.relations import SymmetryGroup, SymmetryRelation, wrap
from symbolic.robots import load_robot
from symbolic.symmetries import primary_symmetries
from symbolic.trigonometric import TrigonometricPolynomial

Array = NDArray[np.float64]
Samples = tuple[Array, Array]

METHODS: dict[str, Callable[..., LearnedSymmetries]] = {
    "pairing": pair_relations,
    "identification": identify,
    "both methods": learn_relations,
}
HEAD = [
    "method",
    "robot",
    "given",
    "noise [deg]",
    "whole group",
    "precision",
    "false (torque error)",
    "worst d [deg]",
    "observed",
    "s",
    "demanded",
]
SAME_MAP = 0.05
"""Relations with the same A and Y whose offsets differ by less [rad] are one relation."""


@dataclass(frozen=True)
class Case:
    """One row of the table: `count` torques (pairing, both) or stable samples (identification)."""

    method: str
    robot: str
    count: int
    degrees: float
    demanded: str
    share_of_seeds: float = 1.0
    snap: bool = True


CASES = (
    Case("pairing", "2r", 6, 0.0, "8/8, precision 1"),
    Case("pairing", "3r", 4, 0.0, "16/16, precision 1"),
    Case("pairing", "2r", 12, 0.5, "95 % of seeds, precision 0.99"),
    Case("pairing", "3r", 8, 0.5, "95 % of seeds, precision 0.99", 0.3),
    Case("pairing", "4r-planar", 3, 0.0, "32/32", 0.1),
    Case("pairing", "ur5", 4, 0.0, "16 modulo free directions", 0.2),
    Case("both methods", "2r", 6, 0.0, "8/8, precision 1"),
    Case("both methods", "3r", 4, 0.0, "16/16, precision 1"),
    Case("both methods", "2r", 12, 0.5, "95 % of seeds, precision 0.99"),
    Case("both methods", "3r", 8, 0.5, "95 % of seeds, precision 0.99"),
    Case("both methods", "2r", 12, 0.5, "-", snap=False),
    Case("both methods", "3r", 8, 0.5, "-", snap=False),
    Case("identification", "2r", 5, 0.0, "8/8"),
    Case("identification", "3r", 10, 0.0, "16/16"),
    Case("identification", "2r", 20, 0.1, "8/8, none false"),
    Case("identification", "3r", 60, 0.1, "16/16, none false"),
    Case("identification", "ur5", 10, 0.0, "16 modulo free directions"),
)


@dataclass(frozen=True)
class Row:
    """What a case came to."""

    method: str
    robot: str
    given: str
    offsets: str
    noise_degrees: float
    seeds: int
    right: int
    precision: float
    false: int
    worst_false_torque_error: float
    worst_offset_degrees: float
    observed: float
    seconds: float
    demanded: str


def main(arguments: list[str] | None = None) -> int:
    """Print the table in Markdown, or as JSON."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args(arguments)
    rows = []
    for case in CASES:
        print(f"{case.method}, {case.robot}, {case.count}, {case.degrees} deg", file=sys.stderr)
        rows.append(run(case, max(1, round(case.share_of_seeds * options.seeds))))
    if options.json:
        print(json.dumps([asdict(row) for row in rows], indent=1))
    else:
        print(table(rows))
    return 0


def run(case: Case, seeds: int) -> Row:
    """Learn from `seeds` recordings and hold the result against the truth."""
    exact = GravityModel(load_robot(case.robot)).potential
    group, potential = primary_symmetries(exact), exact.to_float()
    learn = METHODS[case.method]
    learn(*_samples(case, potential, group, np.random.default_rng(0)))  # compile
    right = claimed = false = observed = 0
    torque_error = offset_error = 0.0
    seconds = []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        q, tau = _samples(case, potential, group, rng)
        q = q + np.deg2rad(case.degrees) * rng.normal(size=q.shape)
        start = time.perf_counter()
        learned = learn(q, tau, snap=case.snap)
        seconds.append(time.perf_counter() - start)
        errors = [_offset_error(relation, group) for relation in learned.group]
        wrong = [r for r, e in zip(learned.group, errors, strict=True) if e > SAME_MAP]
        true = [e for e in errors if e <= SAME_MAP]
        allowed = np.deg2rad(0.2) if case.degrees else 1e-9
        right += not wrong and len(true) == group.order and max(true) <= allowed
        claimed += len(errors)
        false += len(wrong)
        observed += sum(str(r.known) == "observed" for r in learned.relations)
        offset_error = max(offset_error, *true)
        probes = rng.uniform(-np.pi, np.pi, (200, potential.n))
        for relation in wrong:
            image = potential.gradient(relation.configuration(probes))
            miss = image - relation.torque(potential.gradient(probes))
            torque_error = max(torque_error, float(np.abs(miss).max()))
    return Row(
        method=case.method,
        robot=case.robot,
        given=f"{case.count} {'samples' if case.method == 'identification' else 'torques'}",
        offsets="rounded" if case.snap else "measured",
        noise_degrees=case.degrees,
        seeds=seeds,
        right=int(right),
        precision=1.0 - false / claimed,
        false=false,
        worst_false_torque_error=torque_error,
        worst_offset_degrees=float(np.rad2deg(offset_error)),
        observed=observed / seeds,
        seconds=float(np.median(seconds)),
        demanded=case.demanded,
    )


def table(rows: list[Row]) -> str:
    """Rows as Markdown."""
    lines = [HEAD, ["---"] * len(HEAD)]
    for row in rows:
        wrong = f"{row.false} ({row.worst_false_torque_error:.2g} Nm)" if row.false else "0"
        cells = (
            row.method,
            row.robot,
            row.given,
            f"{row.noise_degrees:g}",
            f"{row.right} of {row.seeds}",
            f"{row.precision:.4g}",
            wrong,
            f"{row.worst_offset_degrees:.2g} ({row.offsets})",
            f"{row.observed:.1f}",
            f"{row.seconds:.2g}",
            row.demanded,
        )
        lines.append(list(cells))
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _samples(
    case: Case,
    potential: TrigonometricPolynomial,
    group: SymmetryGroup,
    rng: np.random.Generator,
) -> Samples:
    if case.method == "identification":
        return _stable(potential, rng, case.count)
    return _level_sets(potential, group, rng, case.count)


def _stable(potential: TrigonometricPolynomial, rng: np.random.Generator, count: int) -> Samples:
    acting = potential.frequencies.any(axis=0)
    found = np.empty((0, potential.n))
    while len(found) < count:
        q = rng.uniform(-np.pi, np.pi, (40 * count, potential.n))
        stiffness = potential.hessian(q)[:, acting][:, :, acting]
        found = np.concatenate([found, q[np.linalg.eigvalsh(stiffness).min(axis=1) > 0.0]])
    return found[:count], potential.gradient(found[:count])


def _level_sets(
    potential: TrigonometricPolynomial,
    group: SymmetryGroup,
    rng: np.random.Generator,
    torques: int,
) -> Samples:
    anywhere = rng.uniform(-np.pi, np.pi, (2000, potential.n))
    smallest = 0.05 * np.abs(potential.gradient(anywhere)).max(axis=0)
    kept = rng.uniform(0.3, 0.6)
    q: list[Array] = []
    tau: list[Array] = []
    while len(q) < torques:
        torque = potential.gradient(rng.uniform(-np.pi, np.pi, potential.n))
        if (np.abs(torque) < smallest).any():
            continue
        found = level_set(potential, torque, group=group, max_starts=400)
        chosen = rng.random(len(found)) < kept
        if chosen.any():
            free = rng.uniform(-np.pi, np.pi, (int(chosen.sum()), len(group.free_directions)))
            q.append(wrap(found.configurations[chosen] + free @ group.free_directions))
            tau.append(found.torques[chosen])
    return np.concatenate(q), np.concatenate(tau)


def _offset_error(relation: SymmetryRelation, group: SymmetryGroup) -> float:
    """Distance of the offset from that of the true relation with the same A and Y [rad]."""
    if not np.array_equal(relation.basis, group.basis):
        return 0.0 if relation.is_identity else np.inf
    match = (group.Y == relation.Y).all(axis=1)
    match &= (np.abs(group.A_sat - relation.A_sat) < 1e-6).all(axis=(1, 2))
    off = np.abs(wrap(group.d_sat[match] - relation.d_sat)).max(axis=1, initial=0.0)
    return float(off.min(initial=np.inf))


if __name__ == "__main__":
    sys.exit(main())
