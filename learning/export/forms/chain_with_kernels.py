"""The torque of rigid chains and of Gaussian processes beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.array_operations import Space
from isotorque.learning.export.forms.c_tables import Tables
from isotorque.learning.export.forms.chain_recursion import C_TURN, ChainRecursion

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ChainWithKernels:
    """The mean of M models: a chain, a spring and a wave at each joint, and sums of covariances.

    Attributes
    ----------
    chains : tuple of ChainRecursion
        One per model.
    springs, sines, cosines : (n,) arrays
        What multiplies q_j, sin q_j and cos q_j in ``tau_j``, averaged over the models [N m].
    centres : (m, n) array
        Configurations of the samples [rad].
    own_rates : (M, n) array
        Of the covariance by the joint's own angle, ``exp(rate (cos(q_j - c_j) - 1))``.
    rates : (M, n, n) array
        Of the covariance by all angles of each joint, ``exp(sum_i rate_i (cos(q_i - c_i) - 1))``.
    own_weights, weights : (M, m, n) arrays
        What multiplies the covariances, divided by M already [N m].
    """

    chains: tuple[ChainRecursion, ...]
    springs: Array
    sines: Array
    cosines: Array
    centres: Array
    own_rates: Array
    rates: Array
    own_weights: Array
    weights: Array

    KIND: ClassVar[str] = "rigid chain and kernels"
    FORMULA: ClassVar[str] = (
        "tau_j = mean of the torques of the chains + springs_j q_j + sines_j sin q_j + cosines_j "
        "cos q_j + sum over models k and samples c of own_weights_kcj exp(own_rates_kj "
        "(cos(q_j - centres_cj) - 1)) + weights_kcj exp(sum_i rates_kji (cos(q_i - centres_ci) - "
        "1)); arrays of chain k are named NAME_k (see kind 'rigid chain')"
    )
    BESIDE: ClassVar[Sequence[str]] = (
        "springs",
        "sines",
        "cosines",
        "centres",
        "own_rates",
        "rates",
        "own_weights",
        "weights",
    )

    @property
    def joints(self) -> int:
        """Number of joints n."""
        return len(self.springs)

    @property
    def outputs(self) -> int:
        """Number of torques."""
        return len(self.springs)

    def torque(self, space: Space, q: Any) -> Any:
        """Torques (n, 1) [N m] at a configuration (n, 1) [rad]."""
        n, samples = self.joints, len(self.centres)
        share = space.constant([[1.0 / len(self.chains)]])
        total = space.constant(np.zeros(n))
        for chain in self.chains:
            total = total + chain.torque(space, q) @ share
        total = total + space.constant(self.springs) * q
        total = total + space.constant(self.sines) * space.sin(q)
        total = total + space.constant(self.cosines) * space.cos(q)
        if not samples:
            return total
        cos, sin = space.cos(q), space.sin(q)
        ones = space.constant(np.ones(samples))
        chords = []  # cos(q_i - c_i) - 1 of all samples, one column (m, 1) per joint
        for i in range(n):
            pick = space.constant(np.eye(n)[i : i + 1])
            near = space.constant(np.cos(self.centres[:, i])) @ (pick @ cos)
            near = near + space.constant(np.sin(self.centres[:, i])) @ (pick @ sin)
            chords.append(near - ones)
        for k in range(len(self.own_rates)):
            parts = []
            for j in range(n):
                own = space.exp(chords[j] * float(self.own_rates[k, j]))
                exponent = chords[0] * float(self.rates[k, j, 0])
                for i in range(1, n):
                    exponent = exponent + chords[i] * float(self.rates[k, j, i])
                part = space.constant(self.own_weights[k, :, j][None]) @ own
                parts.append(
                    part + space.constant(self.weights[k, :, j][None]) @ space.exp(exponent)
                )
            total = total + space.above(parts)
        return total

    def c_source(self) -> str:
        """See `TorqueForm`."""
        tables = Tables()
        tables.number("JOINTS", self.joints)
        tables.number("CHAINS", len(self.chains))
        functions = [
            chain.c_function(tables, f"chain_{k}", f"SHIFT_{k}")
            for k, chain in enumerate(self.chains)
        ]
        for name in ("springs", "sines", "cosines"):
            tables.add(name.upper(), getattr(self, name))
        listed = ", ".join(f"chain_{k}" for k in range(len(self.chains)))
        turn = C_TURN if any("turn(" in function for function in functions) else ""
        chains = f"static void (*const CHAIN[CHAINS])(const double *, double *) = {{{listed}}};\n"
        beside = C_NO_KERNELS
        if len(self.centres):
            beside = C_KERNELS
            tables.number("CENTRES", len(self.centres))
            tables.number("MODELS", len(self.own_rates))
            tables.add("CENTRE_COS", np.cos(self.centres))
            tables.add("CENTRE_SIN", np.sin(self.centres))
            for name in ("own_rates", "rates", "own_weights", "weights"):
                tables.add(name.upper(), getattr(self, name))
        code = "\n".join(functions)
        return f"{tables.source()}\n{turn}\n{code}\n{chains}{beside}{C_SOURCE}"

    def to_arrays(self) -> dict[str, NDArray]:
        """The tables by name."""
        arrays = {name: getattr(self, name) for name in self.BESIDE}
        for k, chain in enumerate(self.chains):
            arrays |= {f"{name}_{k}": a for name, a in chain.to_arrays().items()}
        return arrays

    @classmethod
    def from_arrays(cls, arrays: dict[str, NDArray]) -> ChainWithKernels:
        """The form with these tables."""
        chains: list[ChainRecursion] = []
        while f"parents_{len(chains)}" in arrays:
            end = f"_{len(chains)}"
            mine = {k.removesuffix(end): a for k, a in arrays.items() if k.endswith(end)}
            chains.append(ChainRecursion.from_arrays(mine))
        return cls(tuple(chains), **{name: arrays[name] for name in cls.BESIDE})


C_NO_KERNELS = """
static void add_kernels(const double *q, double *torque)
{
    (void)q;
    (void)torque;
}
"""

C_KERNELS = """
static void add_kernels(const double *q, double *torque)
{
    double c[JOINTS], s[JOINTS], chord[JOINTS], exponent;
    int a, i, j, k;
    for (i = 0; i < JOINTS; i++) {
        c[i] = cos(q[i]);
        s[i] = sin(q[i]);
    }
    for (a = 0; a < CENTRES; a++) {
        for (i = 0; i < JOINTS; i++)
            chord[i] = CENTRE_COS[a][i] * c[i] + CENTRE_SIN[a][i] * s[i] - 1.0;
        for (k = 0; k < MODELS; k++)
            for (j = 0; j < JOINTS; j++) {
                exponent = 0.0;
                for (i = 0; i < JOINTS; i++)
                    exponent += RATES[k][j][i] * chord[i];
                torque[j] += OWN_WEIGHTS[k][a][j] * exp(OWN_RATES[k][j] * chord[j])
                    + WEIGHTS[k][a][j] * exp(exponent);
            }
    }
}
"""

C_SOURCE = """
void isotorque_gravity(const double *q, double *tau)
{
    double torque[JOINTS] = {0.0}, part[JOINTS];
    int j, k;
    for (k = 0; k < CHAINS; k++) {
        CHAIN[k](q, part);
        for (j = 0; j < JOINTS; j++)
            torque[j] += part[j] / CHAINS;
    }
    for (j = 0; j < JOINTS; j++)
        torque[j] += SPRINGS[j] * q[j] + SINES[j] * sin(q[j]) + COSINES[j] * cos(q[j]);
    add_kernels(q, torque);
    for (j = 0; j < JOINTS; j++)
        tau[j] = torque[j];
}
"""
