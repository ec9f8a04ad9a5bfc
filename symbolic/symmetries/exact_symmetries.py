"""The complete group of primary symmetries, without tolerance, and with proofs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.connected_components import connected_components
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.block_group import BlockGroup
from isotorque.symbolic.symmetries.frequency_support import FrequencySupport, amplitude_classes
from isotorque.symbolic.symmetries.phase_proof import PhaseProof
from isotorque.symbolic.symmetries.product_group import ProductGroup

RELATIVE = 1e-12
"""Float coefficients closer than this, relative to the largest, count as equal."""
SMALLEST, LARGEST = 1e-150, 1e150
"""Sizes of potentials [J] whose squares and quotients floating point can hold."""


def exact_symmetries(
    potential: TrigonometricPolynomial, neglected: float = RELATIVE
) -> SymmetryGroup:
    """Return the complete group of a potential; see `primary_symmetries`.

    Parameters
    ----------
    potential
        U [J].
    neglected
        Terms up to this fraction of the largest amplitude are left out. At 0 none is, and the
        relations that are ``exact`` are those of U as it is, to the last digit.

    Examples
    --------
    >>> exact_symmetries(TrigonometricPolynomial([[1]], [0.0], [2.0])).order
    4
    """
    numeric = specialised(potential)
    amplitude = numeric.amplitudes()
    limit = RELATIVE * float(amplitude.max(initial=0.0))
    least = neglected * float(amplitude.max(initial=0.0))
    kept = (amplitude > least) & np.any(numeric.frequencies, axis=1)
    complete = int(kept.sum()) == int(np.any(numeric.frequencies, axis=1).sum())
    classes = amplitude_classes(np.abs(numeric.complex()[kept]), limit)
    blocks = frequency_blocks(numeric.frequencies[kept])
    groups = []
    for joints in blocks:
        rows = np.flatnonzero(kept)
        own = np.any(numeric.frequencies[rows][:, joints], axis=1)
        rows = rows[own]
        part = restricted(numeric, rows, joints)
        support = FrequencySupport.of(part, np.ones(len(rows), dtype=bool))
        proof = None
        if potential.cos.dtype == object:
            proof = PhaseProof(restricted(potential, rows, joints), support, complete)
        groups.append(BlockGroup(support, classes[own], 16 * limit, proof, part))
    return ProductGroup(numeric.n, blocks, groups, numeric)


def frequency_blocks(K: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Split joints into blocks that share no frequency; joints of no frequency are in none.

    Examples
    --------
    >>> frequency_blocks(np.array([[1, 0, 1, 0], [0, 1, 0, 0]]))
    [array([0, 2]), array([1])]
    """
    touched = np.unique(K != 0, axis=0).astype(np.int64)
    label = connected_components(touched.T @ touched > 0)
    active = np.flatnonzero(touched.any(axis=0))
    blocks = [active[label[active] == part] for part in np.unique(label[active])]
    return sorted(blocks, key=lambda joints: int(joints[0]))


def restricted(
    potential: TrigonometricPolynomial, rows: NDArray[np.int64], joints: NDArray[np.int64]
) -> TrigonometricPolynomial:
    """Return some terms of a potential as one of the joints that they have."""
    if len(rows) == len(potential) and len(joints) == potential.n:
        return potential
    names = tuple(potential.names[j] for j in joints)
    frequencies = potential.frequencies[np.ix_(rows, joints)]
    return TrigonometricPolynomial(frequencies, potential.cos[rows], potential.sin[rows], names)


def specialised(potential: TrigonometricPolynomial) -> TrigonometricPolynomial:
    """Return the potential with float coefficients; free symbols get generic values.

    A symmetry for all values of the symbols is one for generic values, so no symmetry is lost;
    what holds for all values is checked again, symbolically, by the proof.

    Raises
    ------
    InputError
        For a potential too small or too large for floating point.
    """
    if not potential.is_symbolic:
        try:
            numeric = potential.to_float()
            largest = float(numeric.amplitudes().max(initial=0.0))
        except OverflowError:
            largest = np.inf
        if largest and not SMALLEST <= largest <= LARGEST:
            accepted = f"0, or {SMALLEST:g} to {LARGEST:g} [J]"
            raise InputError("symmetries", "largest amplitude of the potential", largest, accepted)
        return numeric
    import sympy

    symbols = sorted(
        {x for c in (*potential.cos, *potential.sin) for x in sympy.sympify(c).free_symbols},
        key=str,
    )
    generic = np.random.default_rng(20180601).uniform(0.5, 1.5, len(symbols))
    values = dict(zip(symbols, (sympy.Float(x) for x in generic), strict=True))
    return TrigonometricPolynomial(
        potential.frequencies,
        np.array([float(sympy.sympify(x).subs(values)) for x in potential.cos]),
        np.array([float(sympy.sympify(x).subs(values)) for x in potential.sin]),
        potential.names,
    )
