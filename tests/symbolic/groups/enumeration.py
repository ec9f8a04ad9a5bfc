"""The complete group by plain enumeration over the whole support: an oracle for small arms."""

from __future__ import annotations

import numpy as np

from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.symmetries.exact_symmetries import RELATIVE, specialised
from isotorque.symbolic.symmetries.frequency_support import FrequencySupport, amplitude_classes
from isotorque.symbolic.symmetries.phase_proof import PhaseProof


def enumerated_symmetries(potential: TrigonometricPolynomial) -> SymmetryGroup:
    """Try every Y that keeps the amplitudes with every pattern of signs and every coset."""
    numeric = specialised(potential)
    amplitude = numeric.amplitudes()
    limit = RELATIVE * float(amplitude.max(initial=0.0))
    support = FrequencySupport.of(numeric, amplitude > limit)
    proof = None
    if potential.cos.dtype == object:
        complete = len(support.K) == int(np.any(potential.frequencies, axis=1).sum())
        proof = PhaseProof(potential, support, complete)
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
