"""Errors of ``verify``: claims near true ones, judged again with 50 digits.

``python -m benchmarks.verify_claims`` judges 100,000 of them, ``--claims N`` as many as asked for,
``--write`` puts the table into docs/theory.md.
"""

from __future__ import annotations

import argparse
import collections
import itertools
import multiprocessing
import time
from dataclasses import dataclass, replace
from datetime import date
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np

from benchmarks.shared.document import write_between
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.robots.kinematic_tree import KinematicTree
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.exact_proof import OFFSET_ROUNDING
from isotorque.verify.relations.verify_relation import verify_relation

DIGITS = 80
"""Of the oracle's arithmetic; offsets of 10^15 turns take 16 of them, and 50 are needed."""

EQUAL = mpmath.mpf(10) ** -50
"""Below this, relative, two numbers of the oracle are taken as equal."""

PAGE = Path(__file__).parents[1] / "docs" / "theory.md"

BATCH = 2500
"""Claims drawn with one seed."""

FAULTS = ("false proved", "exceeded bounded", "refuted truth", "refused truth", "missed lie")
KINDS = ("true", "turns", "offset", "entry", "real entry", "sign")


# -- the oracle: its own kinematics, its own expansion, its own theorem ---------------------------


class Oracle:
    """Truth about an arm, from its tree alone, in 50 digits.

    The potential is evaluated by forward kinematics on the 3^n angles 0 and +-2 pi/3, which
    determines all coefficients of frequencies -1, 0 and 1.
    """

    def __init__(self, tree: KinematicTree) -> None:
        with mpmath.workdps(DIGITS):
            self.n = tree.n
            angles = [0, 2 * mpmath.pi / 3, -2 * mpmath.pi / 3]
            grid = list(itertools.product(range(3), repeat=self.n))
            values = {z: _potential(tree, [angles[i] for i in z]) for z in grid}
            size = max(abs(x) for x in values.values()) or mpmath.mpf(1)
            roots = [mpmath.expjpi(-mpmath.mpf(2 * j) / 3) for j in range(3)]
            self.C: dict[tuple[int, ...], mpmath.mpc] = {}
            for k in itertools.product((-1, 0, 1), repeat=self.n):
                terms = (
                    values[z] * roots[sum(a * b for a, b in zip(k, z, strict=True)) % 3]
                    for z in grid
                )
                c = mpmath.fsum(terms) / len(grid)
                # exact coefficients are rationals: what is smaller than this is a zero
                if any(k) and abs(c) > size * mpmath.mpf(10) ** -60:
                    self.C[k] = c
            half = [k for k in self.C if next(x for x in k if x) > 0]
            self.K = half
            pinv = np.linalg.pinv(np.array(half, dtype=float).reshape(-1, self.n))
            self.pinv = [[mpmath.mpf(x) for x in row] for row in pinv.tolist()]

    def judge(self, claim: Claim) -> Truth:
        """Return what is true of a claim."""
        with mpmath.workdps(DIGITS):
            A = [[Fraction(x) for x in row] for row in claim.A]
            d = [mpmath.mpf(x) for x in claim.d]
            waves: dict[tuple[Fraction, ...], list[mpmath.mpc]] = {}
            lacking = []
            matched = True
            for k, c in self.C.items():
                image = tuple(
                    sum((x * row[j] for x, row in zip(k, A, strict=True)), Fraction(0))
                    for j in range(self.n)
                )
                phase = mpmath.fsum(x * y for x, y in zip(k, d, strict=True))
                moved = c * mpmath.expj(phase)
                _add(waves, image, [x * moved for x in k])
                key = tuple(Fraction(x) for x in k)
                _add(waves, key, [-y * x * c for x, y in zip(k, claim.Y, strict=True)])
                flipped = tuple(x * y for x, y in zip(k, claim.Y, strict=True))
                sign = 1 if image == flipped else -1 if image == tuple(-x for x in flipped) else 0
                other = self.C.get(tuple(sign * x for x in flipped)) if sign else None
                if other is None or abs(abs(other) - abs(c)) > EQUAL * abs(c):
                    matched = False
                elif k in self.K:
                    lacking.append(mpmath.arg(sign * other / moved))
            bound = [
                mpmath.fsum(abs(joints[i]) for joints in waves.values()) for i in range(self.n)
            ]
            return Truth(matched and self._rounded(lacking), bound, waves, claim)

    def _rounded(self, lacking: list[mpmath.mpf]) -> bool:
        """Whether offsets within rounding of the printed ones are exact."""
        step = [mpmath.mpf(0)] * self.n
        for _ in range(4):  # the pseudoinverse is one of floats: improve
            rest = [
                r - mpmath.fsum(x * s for x, s in zip(k, step, strict=True))
                for k, r in zip(self.K, lacking, strict=True)
            ]
            step = [
                s + mpmath.fsum(x * r for x, r in zip(row, rest, strict=True))
                for s, row in zip(step, self.pinv, strict=True)
            ]
        exact = all(
            abs(r - mpmath.fsum(x * s for x, s in zip(k, step, strict=True))) < EQUAL
            for k, r in zip(self.K, lacking, strict=True)
        )
        return exact and all(abs(s) <= OFFSET_ROUNDING for s in step)


@dataclass
class Truth:
    """Oracle's judgement of a claim.

    Attributes
    ----------
    exact : bool
        Whether an exact offset rounds to the printed one.
    bound : list of mpf
        Sum of the amplitudes of the error per joint.
    waves : dict
        Complex amplitudes per frequency and joint.
    claim : Claim
    """

    exact: bool
    bound: list
    waves: dict
    claim: Claim

    def errors(self, q: list[float]) -> list:
        """Return |error| per joint at one configuration."""
        with mpmath.workdps(DIGITS + 40):
            point = [mpmath.mpf(x) for x in q]
            total = [mpmath.mpc(0)] * len(point)
            for f, joints in self.waves.items():
                phase = mpmath.fsum(
                    mpmath.mpf(x.numerator) / x.denominator * y
                    for x, y in zip(f, point, strict=True)
                )
                turn = mpmath.expj(phase)
                total = [t + a * turn for t, a in zip(total, joints, strict=True)]
            return [abs(t.imag) for t in total]  # g has coefficients i k C_k

    def worst(self, rng: np.random.Generator) -> list[tuple[list[float], int]]:
        """Return configurations where floats find each joint's error largest."""
        f = np.array([[float(x) for x in k] for k in self.waves])
        size = max(max(self.bound), mpmath.mpf("1e-4000"))
        a = np.array([[complex(x / size) for x in joints] for joints in self.waves.values()])
        q = rng.uniform(-np.pi, np.pi, (128, f.shape[1]))
        values = np.abs((np.exp(1j * (q @ f.T)) @ a).imag)
        return [(q[int(np.argmax(values[:, i]))].tolist(), i) for i in range(f.shape[1])]


def _add(waves: dict, frequency: tuple, amplitudes: list) -> None:
    have = waves.setdefault(frequency, [mpmath.mpc(0)] * len(amplitudes))
    waves[frequency] = [x + y for x, y in zip(have, amplitudes, strict=True)]


def _potential(tree: KinematicTree, q: list) -> mpmath.mpf:
    """Potential energy by forward kinematics: -sum of m g.c."""
    frames: list[tuple[mpmath.matrix, mpmath.matrix]] = []
    energy = mpmath.mpf(0)
    gravity = mpmath.matrix([mpmath.mpf(float(x)) for x in tree.gravity])
    for i, parent in enumerate(tree.parents):
        R, p = frames[parent] if parent >= 0 else (mpmath.eye(3), mpmath.matrix(3, 1))
        fixed = mpmath.matrix([[mpmath.mpf(float(x)) for x in row] for row in tree.rotations[i]])
        x, y, z = (mpmath.mpf(float(v)) for v in tree.axes[i])
        cross = mpmath.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        along = mpmath.matrix([x, y, z]) * mpmath.matrix([[x, y, z]])
        c, s = mpmath.cos(q[i]), mpmath.sin(q[i])
        turn = along + (mpmath.eye(3) - along) * c + cross * s
        there = p + R * mpmath.matrix([mpmath.mpf(float(v)) for v in tree.translations[i]])
        here = R * fixed * turn
        centre = there + here * mpmath.matrix([mpmath.mpf(float(v)) for v in tree.levers[i]])
        energy -= mpmath.mpf(float(tree.masses[i])) * (gravity.T * centre)[0]
        frames.append((here, there))
    return energy


# -- arms and claims ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Subject:
    """An arm with its exact relations, and the oracle on it."""

    name: str
    gravity: GravityModel
    relations: tuple[SymmetryRelation, ...]
    oracle: Oracle


@dataclass(frozen=True)
class Claim:
    """A claimed relation, as it would be written into a file."""

    kind: str
    A: list[list[float]]
    d: list[float]
    Y: list[int]
    tolerance: float


def subjects() -> list[Subject]:
    """Arms from 1 to 4 joints: built-in, heavy, light, balanced, and with oblique offsets."""
    built_in = {name: load_robot(name).tree for name in ("pendulum", "2r", "3r", "4r-planar")}
    two, three = built_in["2r"], built_in["3r"]
    trees = dict(built_in)
    trees["2r of 1e-9 of the masses"] = replace(two, masses=two.masses * 1e-9)
    trees["3r of 1e6 times the masses"] = replace(three, masses=three.masses * 1e6)
    bent = np.array([[0.0625, 0.0, 0.09375], [0.125, 0.0, -0.0625]])
    trees["2r with bent links"] = replace(two, levers=bent)
    trees["3r with bent links"] = replace(three, levers=np.vstack([[[0.0, 0.0, 0.25]], bent]))
    balanced = bent.copy()
    balanced[0] -= balanced[0] + 1e-9
    trees["2r nearly balanced"] = replace(
        two, levers=balanced, translations=two.translations * 1e-8
    )
    c, s = 0.6, 0.8  # a joint axis that nearly points down
    steep = np.array([[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]])
    pendulum = built_in["pendulum"]
    axis = np.array([[1.1e-5, 0.0, 1.0]])
    off_axis = np.array([[0.125, 0.03125, 0.0]])
    trees["pendulum on an axis nearly along gravity"] = replace(
        pendulum, rotations=steep, axes=axis / np.linalg.norm(axis), levers=off_axis
    )
    made = []
    for name, tree in trees.items():
        gravity = GravityModel(tree)
        relations = tuple(primary_symmetries(gravity.potential))
        made.append(Subject(name, gravity, relations, Oracle(tree)))
    return made


def draw(subject: Subject, rng: np.random.Generator) -> Claim:
    """Draw a claim near a true one."""
    relation = subject.relations[int(rng.integers(len(subject.relations)))]
    A, d, Y = relation.A.copy(), relation.d.copy(), relation.Y.astype(int)
    n = len(d)
    i, j = int(rng.integers(n)), int(rng.integers(n))
    sign = float(rng.choice([-1.0, 1.0]))
    kind = str(rng.choice(KINDS))
    if kind == "turns":
        turns = float(np.round(10.0 ** rng.uniform(0, 15)))
        d[i] += sign * 2 * np.pi * turns
    elif kind == "offset":
        d[i] += sign * 10.0 ** rng.uniform(-15, -6)
    elif kind == "entry":
        A[i, j] += sign * float(rng.choice([1.0, 2.0, 2.0**32, 2.0**63, 1e45]))
    elif kind == "real entry":
        A[i, j] += sign * 10.0 ** rng.uniform(-15, -6)
    elif kind == "sign":
        Y[i] = -Y[i]
    scale = subject.gravity.rounding / 1e-13
    tolerance = 0.0 if rng.random() < 0.25 else scale * 10.0 ** rng.uniform(-16, 1)
    return Claim(kind, A.tolist(), d.tolist(), Y.tolist(), tolerance)


def judged(
    subject: Subject, claim: Claim, rng: np.random.Generator, simplify: bool
) -> tuple[str, list[str]]:
    """Return what ``verify`` says of a claim, and what is wrong with that."""
    truth = subject.oracle.judge(claim)
    periodic = all(float(x).is_integer() for row in claim.A for x in row)
    sure = truth.exact or (periodic and max(truth.bound) <= claim.tolerance)
    try:
        verdict = verify_relation(
            SymmetryRelation(claim.A, claim.d, claim.Y),
            subject.gravity,
            claim.tolerance,
            simplify=simplify,
        )
    except InputError:
        return "refused", ["refused truth"] if sure else []
    said, worst, faults = str(verdict.status), mpmath.mpf(verdict.worst_error), []
    if said == "proved" and not truth.exact:
        faults.append("false proved")
    if said in ("proved", "bounded"):
        found = [truth.errors(q)[i] for q, i in truth.worst(rng)]
        beyond = max(found) > worst or (periodic and max(truth.bound) > worst)
        if beyond or (said == "bounded" and worst > claim.tolerance):
            faults.append("exceeded bounded")
    elif said == "refuted":
        real = max(truth.errors(verdict.counterexample.tolist())) > claim.tolerance
        if sure or not real or worst > max(truth.bound):
            faults.append("refuted truth")
    elif sure:
        faults.append("refused truth")
    elif max(truth.errors(q)[i] for q, i in truth.worst(rng)) > claim.tolerance:
        faults.append("missed lie")
    return said, faults


# -- the whole ------------------------------------------------------------------------------------


def run(seed: int, claims: int) -> collections.Counter[tuple[str, str]]:
    """Judge claims drawn with a seed; count (kind, what was said) and (kind, fault)."""
    rng = np.random.default_rng(seed)
    arms = subjects()
    counts: collections.Counter[tuple[str, str]] = collections.Counter()
    for number in range(claims):
        subject = arms[number % len(arms)]
        claim = draw(subject, rng)
        # the long way to a simple counterexample is gone with one claim in 64
        said, faults = judged(subject, claim, rng, simplify=number % 64 == 0)
        counts[claim.kind, said] += 1
        for fault in faults:
            counts[claim.kind, fault] += 1
            print(f"{fault}: {subject.name}: {claim} was {said}", flush=True)
    return counts


def batch_of(seed: int) -> collections.Counter[tuple[str, str]]:
    """Judge a batch of claims, drawn with one seed."""
    return run(seed, BATCH)


def table(counts: collections.Counter[tuple[str, str]]) -> str:
    """Return the counts as a table."""
    columns = ("proved", "bounded", "tested", "refuted", "refused", *FAULTS)
    lines = [f"| claims | all | {' | '.join(columns)} |", "|---|" + "---|" * (len(columns) + 1)]
    for kind in (*KINDS, "all"):
        kinds = KINDS if kind == "all" else (kind,)
        row = [sum(counts[k, column] for k in kinds) for column in columns]
        lines.append(f"| {kind} | {sum(row[:5])} | {' | '.join(map(str, row))} |")
    return "\n".join(lines)


def main() -> None:
    """Judge, print the table, and write it where asked to."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--claims", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    jobs = -(-options.claims // BATCH)
    seeds = range(options.seed, options.seed + jobs)
    start, counts = time.perf_counter(), collections.Counter()
    with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
        for done, batch in enumerate(pool.imap_unordered(batch_of, seeds), 1):
            counts += batch
            print(f"{done * BATCH} claims, {time.perf_counter() - start:.0f} s", flush=True)
            print(table(counts), flush=True)
    if options.write:
        text = f"{date.today():%d %B %Y}, seeds {seeds[0]} to {seeds[-1]}.\n\n{table(counts)}"
        write_between(PAGE, "verify_claims", text)


if __name__ == "__main__":
    main()
