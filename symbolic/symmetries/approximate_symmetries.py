"""Groups of approximate symmetries: exact groups of nearby symmetric potentials."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.single_thread import single_thread
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.exact_symmetries import (
    exact_symmetries,
    frequency_blocks,
    restricted,
    specialised,
)
from isotorque.symbolic.symmetries.frequency_support import FrequencySupport
from isotorque.symbolic.symmetries.product_group import ProductGroup
from isotorque.symbolic.symmetries.residual_bound import residual_bound
from isotorque.symbolic.symmetries.reynolds_average import joint_offsets, symmetric_part_error

Array = NDArray[np.float64]
IntMatrix = NDArray[np.int64]

NEAR = 0.15
"""Offsets within this [rad] are candidates for one and the same group element."""
MOST_THRESHOLDS = 64
MOST_GROUPS = 256
"""Products of the blocks' maximal groups that are reported, from the largest on."""
SAME_AS_EXACT = 1e-9
"""A fitted offset this near to an exact one is that one [rad]."""


def maximal_groups(potential: TrigonometricPolynomial, tolerance: float) -> list[SymmetryGroup]:
    """Return the maximal eps-symmetry groups of a potential, the largest first.

    Parameters
    ----------
    potential
        Gravity potential U [J].
    tolerance
        eps [N m], positive.

    Returns
    -------
    list of SymmetryGroup
        Each is the exact group of a symmetric potential so near to U that every relation errs by
        at most ``tolerance`` in any torque; ``relation.bound`` is proved for each joint. Sorted
        by order, then by the distance of the symmetric potential. None contains another.

    Raises
    ------
    InputError
        If the tolerance is not a positive number, or there is too much to try.

    Notes
    -----
    For a closed candidate group with offsets fitted jointly, the nearest symmetric potential is
    its Reynolds average; twice the bound on the change of the torque bounds every relation of
    the group. Blocks of joints that share no frequency are solved one by one (of the products of
    their groups, `MOST_GROUPS` are returned). Candidates come from the supports above every
    amplitude threshold. The groups found are correct and grow with the tolerance; that none is
    missed is a good heuristic, not a theorem.

    References
    ----------
    Sturmfels, Algorithms in Invariant Theory, Springer 2008, section 2.1 (Reynolds operator).

    Examples
    --------
    >>> U = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.01], [18.4, 6.1])
    >>> [g.order for g in maximal_groups(U, 0.05)]
    [8]
    >>> print(maximal_groups(U, 0.05)[0][1].bound.max() <= 0.05)
    True
    """
    if not (np.isfinite(tolerance) and tolerance > 0):
        raise InputError("symmetries", "tolerance", tolerance, "a number > 0 [N m]")
    with single_thread():
        return [scored.group for scored in _maximal(potential, tolerance)]


def _maximal(potential: TrigonometricPolynomial, tolerance: float) -> list[_Scored]:
    """Return the maximal groups with their errors, block by block.

    The average over a group, restricted to one block, is the average over what the group does to
    that block; so maximal groups are products of maximal groups of the blocks.
    """
    blocks = frequency_blocks(potential.frequencies)
    if len(blocks) < 2:
        return _maximal_of_block(potential, tolerance)
    found = []
    for joints in blocks:
        rows = np.flatnonzero(np.any(potential.frequencies[:, joints], axis=1))
        found.append(_maximal_of_block(restricted(potential, rows, joints), tolerance))
    products = [
        _Scored(
            ProductGroup(potential.n, blocks, [scored.group for scored in choice]),
            max(scored.error for scored in choice),
        )
        for choice in itertools.islice(itertools.product(*found), MOST_GROUPS)
    ]
    return sorted(products, key=lambda scored: (-scored.group.order, scored.error))


def _maximal_of_block(potential: TrigonometricPolynomial, tolerance: float) -> list[_Scored]:
    numeric = specialised(potential)
    order = np.argsort(-numeric.amplitudes(), kind="stable")
    numeric = TrigonometricPolynomial(
        numeric.frequencies[order], numeric.cos[order], numeric.sin[order], numeric.names
    )
    exact = exact_symmetries(potential)
    found: list[_Scored] = [_Scored(exact, 0.0)]
    seen: set[tuple[bytes, ...]] = set()
    for threshold in _thresholds(numeric.amplitudes(), tolerance):
        support = FrequencySupport.of(numeric, numeric.amplitudes() > threshold)
        if not len(support.K):
            continue
        candidates = _candidates(numeric, support, tolerance)
        if not candidates or not _is_identity(candidates[0]):
            continue  # not even the identity: rounding is more than the tolerance
        signature = (support.B.tobytes(), *sorted(_key(c) for c in candidates))
        if signature in seen:
            continue
        seen.add(signature)
        for members in _closed_subsets(candidates, numeric, tolerance):
            group, error = _group(numeric, [candidates[i] for i in members])
            found.append(_Scored(_with_exact_members(group, exact), error))
    found.sort(key=lambda s: (-s.group.order, s.error))
    maximal: list[_Scored] = []
    for scored in found:
        if not any(_contained(scored.group, other.group) for other in maximal):
            maximal = [m for m in maximal if not _contained(m.group, scored.group)]
            maximal.append(scored)
    return maximal


@dataclass(frozen=True, eq=False)
class _Scored:
    group: SymmetryGroup
    error: float


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A relation of the terms above a threshold, its offset fitted on its own."""

    support: FrequencySupport
    Y: IntMatrix
    A_sat: Array
    d_sat: Array
    information: Array


def _thresholds(amplitude: Array, tolerance: float) -> list[float]:
    """Amplitudes below which terms may be given up: a lost term costs twice its amplitude."""
    values = np.unique(amplitude[amplitude <= tolerance / 2])
    if len(values) > MOST_THRESHOLDS:
        values = values[np.linspace(0, len(values) - 1, MOST_THRESHOLDS).round().astype(int)]
    return [0.0, *values.tolist()]


def _candidates(
    potential: TrigonometricPolynomial, support: FrequencySupport, tolerance: float
) -> list[_Candidate]:
    """Fit the offset of every structure that the support admits; keep those that may do."""
    out: list[_Candidate] = []
    for Y, s in support.structures(np.zeros(len(support.K), dtype=np.int64)):
        _, image = support.image(Y, s)
        if np.any(np.abs(np.abs(image) - support.amplitude) > tolerance):
            continue
        A_sat = support.linear_part(Y, s)
        if not np.array_equal(A_sat, np.round(A_sat)):
            continue
        weight = np.abs(image) * support.amplitude
        information = support.coordinates.T @ (weight[:, None] * support.coordinates)
        for start in support.offsets(Y, s, np.inf):
            d_sat = _fitted(support, s, image, weight, start)
            A, d = support.lift(A_sat, d_sat)
            if np.all(residual_bound(potential, A, d, Y) <= 2 * tolerance) and not any(
                np.array_equal(c.Y, Y)
                and np.array_equal(c.A_sat, A_sat)
                and np.all(np.abs(wrap(c.d_sat - d_sat)) < NEAR)
                for c in out
            ):
                out.append(_Candidate(support, Y, A_sat, d_sat, information))
    out.sort(key=lambda c: not _is_identity(c))
    return out


def _fitted(
    support: FrequencySupport, s: IntMatrix, image: NDArray, weight: Array, start: Array
) -> Array:
    """Improve d_sat by weighted least squares over all phases."""
    phase = np.angle(image * s / support.C)
    root = np.sqrt(weight)
    d_sat = start
    for _ in range(3):
        misfit = wrap(phase - support.coordinates @ d_sat)
        step = np.linalg.lstsq(support.coordinates * root[:, None], misfit * root, rcond=None)[0]
        d_sat = d_sat + step
    return wrap(d_sat)


def _is_identity(c: _Candidate) -> bool:
    return bool(
        np.all(c.Y == 1)
        and np.array_equal(c.A_sat, np.eye(len(c.A_sat)))
        and np.all(np.abs(wrap(c.d_sat)) < NEAR)
    )


def _key(c: _Candidate) -> bytes:
    return c.Y.tobytes() + c.A_sat.tobytes() + np.round(c.d_sat, 3).tobytes()


def _closed_subsets(
    candidates: list[_Candidate], potential: TrigonometricPolynomial, tolerance: float
) -> list[list[int]]:
    """Return maximal closed sets of candidates whose symmetric potential is near enough.

    Each candidate in turn is a seed; all others that keep the group admissible join it.
    """
    table = _products(candidates)
    verdicts: dict[frozenset[int], bool] = {}

    def admissible(members: frozenset[int]) -> bool:
        if members not in verdicts:
            _, error = _group(potential, [candidates[i] for i in sorted(members)], fast=True)
            verdicts[members] = error <= tolerance
        return verdicts[members]

    def enlarged(members: frozenset[int], newcomer: int) -> frozenset[int] | None:
        closed, queue = set(members) | {newcomer}, [newcomer]
        while queue:
            x = queue.pop()
            for y in tuple(closed):
                for product in (int(table[x, y]), int(table[y, x])):
                    if product < 0:
                        return None
                    if product not in closed:
                        closed.add(product)
                        queue.append(product)
        return frozenset(closed)

    everything = frozenset(range(len(candidates)))
    if np.all(table >= 0) and admissible(everything):
        return [sorted(everything)]
    results: set[frozenset[int]] = set()
    for seed in range(len(candidates)):
        group = enlarged(frozenset({0}), seed)
        if group is None or not admissible(group) or any(group <= r for r in results):
            continue
        for newcomer in range(len(candidates)):
            if newcomer not in group:
                larger = enlarged(group, newcomer)
                if larger is not None and admissible(larger):
                    group = larger
        results = {r for r in results if not r <= group} | {group}
    return [sorted(r) for r in results]


def _products(candidates: list[_Candidate]) -> IntMatrix:
    """Return the index of candidate i after candidate j, -1 where it is not a candidate."""
    table = np.full((len(candidates), len(candidates)), -1, dtype=np.int64)
    A = np.array([c.A_sat for c in candidates])
    d = np.array([c.d_sat for c in candidates])
    Y = np.array([c.Y for c in candidates])
    for i, c in enumerate(candidates):
        linear, offset, signs = c.A_sat @ A, d @ c.A_sat.T + c.d_sat, Y * c.Y
        for k in range(len(candidates)):
            match = np.all(signs == Y[k], axis=1) & np.all(linear == A[k], axis=(1, 2))
            match &= np.all(np.abs(wrap(offset - d[k])) < NEAR, axis=1)
            table[i, match] = k
    return table


def _group(
    potential: TrigonometricPolynomial, members: list[_Candidate], fast: bool = False
) -> tuple[SymmetryGroup, float]:
    """Return the group with jointly fitted offsets, and the bound 2 max e_i of its relations."""
    support = members[0].support
    A_sat, Y = np.array([c.A_sat for c in members]), np.array([c.Y for c in members])
    d_sat = joint_offsets(
        A_sat,
        np.array([c.d_sat for c in members]),
        np.array([c.information for c in members]),
        _products(members),
    )
    error = 2 * symmetric_part_error(potential, support.B, A_sat, d_sat, Y)
    relations = []
    for i in range(1 if fast else len(members)):
        A, d = support.lift(A_sat[i], d_sat[i])
        identity = _is_identity(members[i])
        bound = np.minimum(residual_bound(potential, A, d, Y[i]), error)
        relations.append(SymmetryRelation(A, d, Y[i], support.B, identity, bound))
    return SymmetryGroup(relations), float(error.max(initial=0.0))


def _with_exact_members(group: SymmetryGroup, exact: SymmetryGroup) -> SymmetryGroup:
    """Replace relations that are in truth exact by their exact selves."""
    if not np.array_equal(group.basis, exact.basis):
        return group
    return SymmetryGroup(
        next((e for e in exact if e.exact and e.same_as(r, SAME_AS_EXACT)), r) for r in group
    )


def _contained(inner: SymmetryGroup, outer: SymmetryGroup) -> bool:
    """Say whether every relation of ``inner`` is one of ``outer`` (modulo outer's free ones)."""
    B = outer.basis.astype(float)
    right = np.linalg.pinv(B) if len(B) else np.zeros((outer.n, 0))
    for relation in inner:
        sat = B @ relation.A @ right
        if not np.allclose(sat @ B, B @ relation.A, atol=1e-9):
            return False
        match = np.all(np.abs(outer.A_sat - sat) < 1e-9, axis=(1, 2))
        match &= np.all(outer.Y == relation.Y, axis=1)
        match &= np.all(np.abs(wrap(outer.d_sat - B @ relation.d)) < NEAR, axis=1)
        if not match.any():
            return False
    return True
