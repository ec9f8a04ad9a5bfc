"""The complete group of primary symmetries, without tolerance, and with proofs."""

from __future__ import annotations

import numpy as np
import sympy

from symbolic.phase_proof import PhaseProof
from symbolic.relations import SymmetryGroup
from symbolic.support import Support, amplitude_classes
from symbolic.trigonometric import TrigonometricPolynomial

RELATIVE = 1e-12
"""Float coefficients closer than this, relative to the largest, count as equal."""


def exact_symmetries(potential: TrigonometricPolynomial) -> SymmetryGroup:
    """Return the complete group of a potential; see `symbolic.symmetries.primary_symmetries`.

    Examples
    --------
    >>> exact_symmetries(TrigonometricPolynomial([[1]], [0.0], [2.0])).order
    4
    """
    numeric = specialised(potential)
    amplitude = numeric.amplitudes()
    support = Support.of(numeric, amplitude > RELATIVE * amplitude.max(initial=0.0))
    limit = RELATIVE * float(amplitude.max(initial=0.0))
    proof = PhaseProof(potential, support) if potential.cos.dtype == object else None
    relations = []
    for Y, s in support.structures(amplitude_classes(support.amplitude, limit)):
        for d_sat in support.offsets(Y, s, 16 * limit):
            trivial = np.all(Y == 1) and np.all(s == 1) and not np.any(d_sat)
            exact = bool(trivial) or (proof is not None and proof.holds(Y, s, d_sat))
            relation = support.relation(numeric, Y, s, d_sat, exact)
            if exact and proof is not None:
                relation = proof.rounded(relation, Y, s)
            relations.append(relation)
    return SymmetryGroup(relations)


def specialised(potential: TrigonometricPolynomial) -> TrigonometricPolynomial:
    """Return the potential with float coefficients; free symbols get generic values.

    A symmetry for all values of the symbols is one for generic values, so no symmetry is lost;
    what holds for all values is checked again, symbolically, by the proof.
    """
    if not potential.is_symbolic:
        return potential.to_float()
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
