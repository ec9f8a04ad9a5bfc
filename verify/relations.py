"""Judge of symmetry relations: proof, bound, or a counterexample."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from symbolic.errors import InputError
from symbolic.gravity import GravityModel
from symbolic.relations import SymmetryRelation
from symbolic.trigonometric import TrigonometricPolynomial
from verify.bounds import certified_error, learned_map_bound, relation_error_bound
from verify.counterexamples import largest_value, simplest_configuration
from verify.proof import exact_potential, prove_relation
from verify.verdict import Status, Verdict

Array = NDArray[np.float64]

FLOAT_NOISE = 1e-12
"""Relative size of what float evaluation of torques may be wrong by."""

VANISHING = 1e-15
"""Offsets below the rounding of a turn are not written [rad]."""


def verify_relation(
    relation: SymmetryRelation,
    gravity: GravityModel,
    tolerance: ArrayLike = 1e-9,
    *,
    claim: str | None = None,
) -> Verdict:
    """Judge the claim g(A q + d) = Y g(q), for every configuration q.

    Parameters
    ----------
    relation
        The claimed relation; its matrix may be real (learned).
    gravity
        The true gravity torque.
    tolerance
        Torque error that the claim is allowed [N m], one number or one per joint (then inf where
        anything goes). At 0 only a relation that is exactly true, up to the rounding of its
        printed offset, passes.
    claim
        Words for the verdict; by default the relation written out.

    Returns
    -------
    Verdict
        ``proved`` if the relation is exact (whatever the tolerance); ``bounded`` if its error is
        within the tolerance for every q; ``refuted`` with a counterexample, whose error is above
        the tolerance in ball arithmetic, not by rounding; ``tested`` if neither a bound nor a
        counterexample was found (possible only where the bound is above the tolerance).

    Raises
    ------
    InputError
        If relation and gravity differ in the number of joints, the tolerance is negative or not
        a number, the potential contains symbols, or torque and potential contradict each other.

    Notes
    -----
    A learned, real A is bounded on the box |q_j| <= pi; its counterexamples are sought there.
    Deterministic. Even what is proved or bounded is checked against torques of the recursion
    along the chain, which do not pass through the potential that the proof is about.

    References
    ----------
    MacIver et al., Hypothesis: a new approach to property-based testing, JOSS 2019.

    Examples
    --------
    >>> from symbolic.robots import load_robot
    >>> gravity = GravityModel(load_robot("2r"))
    >>> print(verify_relation(SymmetryRelation([[-1, 0], [2, 1]], [0, 0], [1, 1]), gravity).status)
    proved
    >>> verdict = verify_relation(SymmetryRelation([[-1, 0], [2, -1]], [0, 0], [1, 1]), gravity)
    >>> verdict.status, verdict.counterexample.tolist()
    (<Status.REFUTED: 'refuted'>, [0.1, 0.1])
    """
    n, potential = gravity.n, gravity.potential
    if relation.n != n:
        raise InputError("relation", "number of joints", relation.n, f"{n}, as the robot has")
    exact = exact_potential(potential)
    noise = FLOAT_NOISE * float(exact.to_float().gradient_bound().max(initial=0.0))
    allowed = _tolerances(tolerance, n)
    if not potential.is_exact:
        allowed = np.maximum(allowed, noise)
    words = describe_relation(relation) if claim is None else claim
    A, d, Y = relation.A, relation.d, relation.Y
    proof = prove_relation(A, d, Y, exact)
    integer = np.array_equal(A, np.round(A))
    bound = (relation_error_bound if integer else learned_map_bound)(A, d, Y, exact)
    worst = float(bound.max(initial=0.0))
    judge = _Excess(relation, gravity, allowed)
    if proof.holds or np.all(bound <= allowed):
        excess = judge.sampled(bound)
        if excess > 10 * noise:
            raise InputError(
                "gravity model", "difference of torque and potential", excess, "rounding errors"
            )
        return Verdict(words, Status.PROVED if proof.holds else Status.BOUNDED, worst)
    _, q = largest_value(judge.value, n, gradient=judge.gradient)
    largest = float(np.abs(judge.errors(q)).max(initial=0.0))
    if not _certified(relation, exact, q, allowed):
        return Verdict(words, Status.TESTED, largest)
    simple = simplest_configuration(lambda x: judge.at(x) > 10 * noise, q)
    if not _certified(relation, exact, simple, allowed):
        simple = q
    return Verdict(words, Status.REFUTED, largest, simple)


def verify_relations(
    relations: Iterable[SymmetryRelation], gravity: GravityModel, tolerance: ArrayLike = 1e-9
) -> tuple[Verdict, ...]:
    """Judge relations one by one, numbered from 1 in the verdicts' claims."""
    return tuple(
        verify_relation(
            relation, gravity, tolerance, claim=f"relation {i}: {describe_relation(relation)}"
        )
        for i, relation in enumerate(relations, 1)
    )


def describe_relation(relation: SymmetryRelation) -> str:
    """Write a relation in one line.

    Examples
    --------
    >>> describe_relation(SymmetryRelation([[-1, 0], [2, 1]], [np.pi, 0.25], [1, -1]))
    "q1' = -q1 + pi, q2' = 2 q1 + q2 + 0.25, tau2' = -tau2"
    """
    rows = enumerate(zip(relation.A, relation.d, strict=True), 1)
    parts = [f"q{i}' = {_row(a, d)}" for i, (a, d) in rows]
    flipped = [f"tau{i + 1}' = -tau{i + 1}" for i, y in enumerate(relation.Y) if y < 0]
    return ", ".join(parts + (flipped or ["tau' = tau"]))


def _row(coefficients: Array, offset: float) -> str:
    text = ""
    for j, x in enumerate(coefficients):
        if x:
            size = "" if abs(x) == 1 else f"{abs(x):.9g} "
            text += (" - " if x < 0 else " + ") + f"{size}q{j + 1}"
    if abs(offset) > VANISHING:
        text += (" - " if offset < 0 else " + ") + _angle(abs(offset))
    text = text or " + 0"
    return text[3:] if text.startswith(" + ") else "-" + text[3:]


def _angle(value: float) -> str:
    for fraction in (1, 2, 4):
        turns = value * fraction / np.pi
        if round(turns) and turns == round(turns):
            whole = "pi" if round(turns) == 1 else f"{round(turns)} pi"
            return whole if fraction == 1 else f"{whole}/{fraction}"
    return f"{value:.9g}"


class _Excess:
    """By how much the torque error of a relation exceeds what is allowed, per configuration."""

    def __init__(self, relation: SymmetryRelation, gravity: GravityModel, allowed: Array) -> None:
        self.relation, self.gravity, self.allowed = relation, gravity, allowed

    def errors(self, q: Array) -> Array:
        image = self.gravity.torque(self.relation.configuration(q))
        return np.asarray(image - self.relation.torque(self.gravity.torque(q)))

    def value(self, q: Array) -> Array:
        return np.asarray((np.abs(self.errors(q)) - self.allowed).max(axis=-1))

    def at(self, q: Array) -> float:
        return float(self.value(q[None, :])[0])

    def sampled(self, limits: Array) -> float:
        q = np.random.default_rng(0).uniform(-np.pi, np.pi, (32, self.gravity.n))
        return float((np.abs(self.errors(q)) - limits).max())

    def gradient(self, q: Array) -> Array:
        relation, gravity = self.relation, self.gravity
        error = self.errors(q)
        joint = int(np.argmax(np.abs(error) - self.allowed))
        slope = gravity.stiffness(relation.configuration(q))[joint] @ relation.A
        slope = slope - relation.Y[joint] * gravity.stiffness(q)[joint]
        return np.asarray(np.sign(error[joint]) * slope)


def _tolerances(tolerance: ArrayLike, n: int) -> Array:
    values = np.asarray(tolerance, dtype=float)
    if values.shape not in ((), (n,)) or np.isnan(values).any() or np.any(values < 0):
        raise InputError(
            "verify_relation", "tolerance", tolerance, f"a number >= 0 [Nm], or {n} of them"
        )
    return np.array(np.broadcast_to(values, (n,)))


def _certified(
    relation: SymmetryRelation, potential: TrigonometricPolynomial, q: Array, allowed: Array
) -> bool:
    errors = certified_error(relation.A, relation.d, relation.Y, potential, q)
    return bool(np.any(errors > allowed))
