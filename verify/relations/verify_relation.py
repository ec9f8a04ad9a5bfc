"""Judge of symmetry relations: proof, bound, or a counterexample."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.single_thread import single_thread
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.verify.relations.ball_bounds import certified_error, learned_map_bound
from isotorque.verify.relations.exact_numbers import (
    angle,
    exact_matrix,
    exact_vector,
    maps,
    nearest,
)
from isotorque.verify.relations.exact_proof import exact_potential, prove_relation
from isotorque.verify.relations.residual import Residual
from isotorque.verify.relations.wave_search import WaveSearch
from isotorque.verify.testing.counterexamples import largest_value, simplest_configuration
from isotorque.verify.verdict import Status, Verdict

Array = NDArray[np.float64]

SURELY = 1.0 - 1e-9
"""Share of a sum in floats that is exceeded surely."""
IN_THE_BOX = ", for q within a turn around zero"
"""Added to the words of a claim that is judged there only: a real matrix has no period."""

MARGIN = 1e-12
"""More than the rounding of floats, relative: counterexamples are shrunk with this margin."""

RANDOM_CONFIGURATIONS = 32
"""Where torques of the recursion are held against what was proved or bounded."""

FEW_TURNS = 32.0
"""Images of small matrices and offsets are computed in floats, all others exactly."""

FAST_CANDIDATES = 64
"""Configurations in tenths tried one by one before waves too fast for gradients are climbed."""


def verify_relation(
    relation: SymmetryRelation,
    gravity: GravityModel,
    tolerance: ArrayLike = 1e-9,
    *,
    claim: str | None = None,
    simplify: bool = True,
) -> Verdict:
    """Judge the claim g(A q + d) = Y g(q), for every configuration q.

    Parameters
    ----------
    relation
        The claimed relation, judged as it was given (of gravity: a correction is not looked at):
        entries are the rationals that the floats are, and offsets keep their whole turns. Its
        matrix may be real (learned).
    gravity
        The true gravity torque.
    tolerance
        Torque error that the claim is allowed [N m], one number or one per joint (then inf where
        anything goes). At 0 only a relation that is exactly true, up to the rounding of its
        printed offset (`OFFSET_ROUNDING`), passes.
    claim
        Words for the verdict; by default the relation written out.
    simplify
        Whether the worst counterexample is sought and made simple to read, which takes most of
        the time of refuting; otherwise the first one found is given.

    Returns
    -------
    Verdict
        ``proved`` if an exact offset exists of which the printed one is the rounding (whatever
        the tolerance); ``bounded`` if the error of the relation as printed is within the tolerance
        for every q; ``refuted`` with a counterexample, whose error is above the tolerance in ball
        arithmetic, not by rounding; ``tested`` if neither a bound nor a counterexample was found
        (possible only where the bound is above the tolerance). Its ``worst_error`` is about the
        relation as printed: an upper bound where proved or bounded, otherwise a lower bound on
        the error at the worst configuration found.

    Raises
    ------
    InputError
        If relation and gravity differ in the number of joints, the tolerance is negative or not
        a number, the potential contains symbols, or torque and potential contradict each other.

    Notes
    -----
    A learned, real A that exceeds the tolerance somewhere is bounded on the box |q_j| <= pi, which
    the words of the claim say then; its counterexamples are sought there. Deterministic. Even what
    is proved or bounded is checked against torques of the recursion along the chain, which do not
    pass through the potential that the proof is about; the rounding allowed for that is in
    proportion to masses and lengths (`GravityModel.rounding`).

    References
    ----------
    MacIver et al., Hypothesis: a new approach to property-based testing, JOSS 2019.

    Examples
    --------
    >>> from isotorque.symbolic.robots.load_robot import load_robot
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
    relation = relation.of_measured(None)  # of gravity: what is beside it is not the robot's
    exact = exact_potential(potential)

    @cache
    def residual() -> Residual:
        return Residual.of(exact_matrix(A), exact_vector(d), [int(y) for y in Y], exact)

    allowed = _tolerances(tolerance, n)
    if not potential.is_exact:
        allowed = np.maximum(allowed, gravity.rounding)
    words = describe_relation(relation) if claim is None else claim
    A, d, Y = relation.A, relation.unwrapped_d, relation.Y
    proof = prove_relation(A, d, Y, exact)
    nowhere_else = not proof.holds and _fails_far_away(A, exact, allowed)
    bound = np.full(n, np.inf) if nowhere_else else residual().bound()
    stands = proof.holds or bool(np.all(bound <= allowed))
    if not stands and not np.array_equal(A, np.round(A)):
        words += IN_THE_BOX
        bound = np.minimum(bound, learned_map_bound(A, d, Y, exact))
        if nowhere_else and not np.all(bound <= allowed):
            bound = np.minimum(bound, residual().bound())
        stands = bool(np.all(bound <= allowed))
    if stands:
        _check_against_recursion(relation, gravity, bound)
        status = Status.PROVED if proof.holds else Status.BOUNDED
        return Verdict(words, status, float(bound.max(initial=0.0)))

    def errors(q: Array) -> Array:
        return certified_error(A, d, Y, exact, q)

    def fails(q: Array) -> bool:
        return bool(np.any(errors(q) > allowed))

    excess = _Excess(residual(), allowed)
    largest, q = 0.0, None
    with single_thread():  # small steps of L-BFGS: threads would only wait for each other
        for candidate in excess.candidates(first=not simplify):
            largest = max(largest, float(errors(candidate).max(initial=0.0)))
            if fails(candidate):
                q = candidate
                break
    if q is None:
        return Verdict(words, Status.TESTED, largest)
    margin = MARGIN * float(bound.max())
    if simplify and residual().is_slow:
        simple = simplest_configuration(lambda x: excess.at(x) > margin, q)
        q = simple if fails(simple) else q
    return Verdict(words, Status.REFUTED, largest, q)


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


def _fails_far_away(A: Array, potential: TrigonometricPolynomial, allowed: Array) -> bool:
    """Whether a bound for every q exceeds what is allowed, told without computing it.

    Where A takes no frequency k to integers ``A^T k``, no wave of ``g(A q + d)`` cancels one of
    ``Y g(q)``, and the amplitudes of the latter alone are part of the bound.
    """
    k = potential.frequencies
    if np.array_equal(A, np.round(A)):
        return False
    with np.errstate(all="ignore"):
        images = k @ A
    if np.equal(images, np.round(images)).all(axis=1).any():
        return False
    amplitudes = np.hypot(potential.cos.astype(float), potential.sin.astype(float))
    return bool(np.any(SURELY * (amplitudes @ np.abs(k)) > allowed))


def describe_relation(relation: SymmetryRelation) -> str:
    """Write a relation in one line.

    Examples
    --------
    >>> describe_relation(SymmetryRelation([[-1, 0], [2, 1]], [np.pi, 0.25], [1, -1]))
    "q1' = -q1 + pi, q2' = 2 q1 + q2 + 0.25, tau2' = -tau2"
    """
    rows = enumerate(zip(relation.A, relation.unwrapped_d, strict=True), 1)
    parts = [f"q{i}' = {_row(a, d)}" for i, (a, d) in rows]
    flipped = [f"tau{i + 1}' = -tau{i + 1}" for i, y in enumerate(relation.Y) if y < 0]
    return ", ".join(parts + (flipped or ["tau' = tau"]))


def _row(coefficients: Array, offset: float) -> str:
    text = ""
    for j, x in enumerate(coefficients):
        if x:
            size = "" if abs(x) == 1 else f"{_entry(abs(x))} "
            text += (" - " if x < 0 else " + ") + f"{size}q{j + 1}"
    if offset:
        text += (" - " if offset < 0 else " + ") + _angle(abs(offset))
    text = text or " + 0"
    return text[3:] if text.startswith(" + ") else "-" + text[3:]


def _entry(value: float) -> str:
    """Write an entry of A, in full where it would look like an integer that it is not."""
    text = f"{value:.9g}"
    return f"{value:.17g}" if float(text).is_integer() and not value.is_integer() else text


def _angle(value: float) -> str:
    for fraction in (1, 2, 4) if value <= 2 * np.pi else ():
        turns = value * fraction / np.pi
        if round(turns) and turns == round(turns):
            whole = "pi" if round(turns) == 1 else f"{round(turns)} pi"
            return whole if fraction == 1 else f"{whole}/{fraction}"
    return f"{value:.9g}"


class _Excess:
    """By how much the torque error of a relation exceeds what is allowed, per configuration."""

    def __init__(self, residual: Residual, allowed: Array) -> None:
        self.residual, self.allowed = residual, allowed

    def candidates(self, *, first: bool) -> Iterator[Array]:
        """Yield configurations that may be counterexamples.

        The worst that can be found comes first, unless ``first`` asks for any that is near.
        """
        n = self.residual.n
        if self.residual.is_slow:
            if first:
                yield largest_value(self.value, n, samples=64, climb=False)[1]
            yield largest_value(self.value, n, gradient=self.gradient)[1]
            return
        tenths = np.random.default_rng(0).integers(-31, 32, (FAST_CANDIDATES, n)) / 10
        yield from tenths[np.argsort(-self.value(tenths), kind="stable")]
        search = WaveSearch(self.residual)
        for joint in np.flatnonzero(self.residual.bound() > self.allowed):
            yield search.highest(int(joint))

    def value(self, q: Array) -> Array:
        return np.asarray((np.abs(self.residual.values(q)) - self.allowed).max(axis=-1))

    def at(self, q: Array) -> float:
        return float(self.value(q[None, :])[0])

    def gradient(self, q: Array) -> Array:
        error = self.residual.values(q[None, :])[0]
        joint = int(np.argmax(np.abs(error) - self.allowed))
        return np.asarray(np.sign(error[joint]) * self.residual.gradient(q, joint))


def _check_against_recursion(
    relation: SymmetryRelation, gravity: GravityModel, bound: Array
) -> None:
    """Refuse a gravity model whose torque contradicts what was proved of its potential."""
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (RANDOM_CONFIGURATIONS, gravity.n))
    error = gravity.torque(_images(relation, q)) - relation.torque(gravity.torque(q))
    excess = float((np.abs(error) - bound).max())
    if excess > gravity.rounding:
        raise InputError(
            "gravity model",
            "difference of torque and potential",
            f"{excess:.3g} N m",
            f"at most {gravity.rounding:.3g} N m, which is rounding",
        )


def _images(relation: SymmetryRelation, q: Array) -> Array:
    """Return the images of configurations (m, n) modulo 2 pi, each rounded about once."""
    if np.all(np.abs(relation.A).sum(axis=1) + np.abs(relation.unwrapped_d) <= FEW_TURNS):
        return relation.configuration(q)
    A, d = exact_matrix(relation.A), exact_vector(relation.unwrapped_d)
    return np.array([[nearest(angle(x)) for x in maps(A, d, exact_vector(point))] for point in q])


def _tolerances(tolerance: ArrayLike, n: int) -> Array:
    values = np.asarray(tolerance, dtype=float)
    if values.shape not in ((), (n,)) or np.isnan(values).any() or np.any(values < 0):
        raise InputError(
            "verify_relation", "tolerance", tolerance, f"a number >= 0 [Nm], or {n} of them"
        )
    return np.array(np.broadcast_to(values, (n,)))
