"""Torques as sums of sines and cosines, with springs at the joints."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.export.forms.array_operations import Space
from isotorque.learning.export.forms.c_tables import Tables

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Waves:
    """``tau_i = sum over k of c_ki cos(k.q) + s_ki sin(k.q)``, and r_i q_i where there are springs.

    Attributes
    ----------
    frequencies : (m, n) int array
        Rows k.
    cos, sin : (m, n) arrays
        c and s [N m].
    springs : (n,) array or None
        r [N m/rad].
    """

    frequencies: NDArray[np.int64]
    cos: Array
    sin: Array
    springs: Array | None = None

    KIND: ClassVar[str] = "waves"
    FORMULA: ClassVar[str] = (
        "tau = cos^T cos(frequencies q) + sin^T sin(frequencies q) + springs q (where given)"
    )

    @property
    def joints(self) -> int:
        """Number of joints n."""
        return self.frequencies.shape[1]

    @property
    def outputs(self) -> int:
        """Number of torques."""
        return self.cos.shape[1]

    def torque(self, space: Space, q: Any) -> Any:
        """Torques (n, 1) [N m] at a configuration (n, 1) [rad]."""
        spring = 0.0 if self.springs is None else space.constant(np.diag(self.springs)) @ q
        if not len(self.frequencies):
            return space.constant(np.zeros(self.outputs)) + spring
        phase = space.constant(self.frequencies) @ q
        even, odd = space.constant(self.cos.T), space.constant(self.sin.T)
        return even @ space.cos(phase) + odd @ space.sin(phase) + spring

    def c_source(self) -> str:
        """See `TorqueForm`."""
        tables = Tables()
        tables.number("JOINTS", self.outputs)
        function = self.c_function(tables)
        if self.springs is None:
            return tables.source() + "\n" + function + C_SOURCE % ""
        tables.add("SPRING", self.springs)
        return tables.source() + "\n" + function + C_SOURCE % " + SPRING[i] * q[i]"

    def c_function(self, tables: Tables) -> str:
        """C99 of ``add_waves(q, torque)``, its constants put into tables, where JOINTS is."""
        if not len(self.frequencies):
            return C_NO_WAVES
        tables.number("INPUTS", self.joints)
        tables.number("WAVES", len(self.frequencies))
        tables.add("FREQUENCY", self.frequencies)
        tables.add("COS", self.cos)
        tables.add("SIN", self.sin)
        return C_WAVES

    def to_arrays(self) -> dict[str, NDArray]:
        """The tables by name."""
        tables = {"frequencies": self.frequencies, "cos": self.cos, "sin": self.sin}
        return tables if self.springs is None else {**tables, "springs": self.springs}

    @classmethod
    def from_arrays(cls, arrays: dict[str, NDArray]) -> Waves:
        """The form with these tables."""
        return cls(arrays["frequencies"], arrays["cos"], arrays["sin"], arrays.get("springs"))

    @classmethod
    def of_potential(cls, frequencies: NDArray, cos: Array, sin: Array) -> Waves:
        """The derivatives of ``U = sum a cos(k.q) + b sin(k.q)``; k (m, n), a and b (m,) [J]."""
        k = np.rint(frequencies).astype(np.int64)
        a, b = (np.asarray(x, dtype=float)[:, None] for x in (cos, sin))
        return cls(k, b * k, -a * k).without_rounding()

    def with_constants(self, torque: Array) -> Waves:
        """The same and a constant torque (n,) of every joint [N m], unless all are zero."""
        return self._with(np.zeros_like(self.frequencies[:1]), torque, np.zeros_like(torque))

    def with_own_angles(self, twice: Array, springs: Array) -> Waves:
        """The same and torques of each joint's own angle.

        Parameters
        ----------
        twice : (n, 2) array
            Of cosine and sine of twice the angle [N m].
        springs : (n,) array
            [N m/rad].
        """
        result = self
        for j in np.flatnonzero(twice.any(axis=1)):
            own = np.eye(self.joints)[j]
            frequency = np.rint(2 * own[None]).astype(np.int64)
            result = result._with(frequency, own * twice[j, 0], own * twice[j, 1])
        return replace(result, springs=springs if springs.any() else None)

    def _with(self, frequency: NDArray[np.int64], cos: Array, sin: Array) -> Waves:
        """The same and one more wave, unless it is zero; (1, n), (n,), (n,)."""
        if not (cos.any() or sin.any()):
            return self
        return replace(
            self,
            frequencies=np.vstack([self.frequencies, frequency]),
            cos=np.vstack([self.cos, cos]),
            sin=np.vstack([self.sin, sin]),
        )

    def without_rounding(self) -> Waves:
        """The same without terms that are rounding beside the largest."""
        size = np.maximum(np.abs(self.cos), np.abs(self.sin)).max(axis=1, initial=0.0)
        keep = size > NEGLIGIBLE * size.max(initial=0.0)
        return Waves(self.frequencies[keep], self.cos[keep], self.sin[keep], self.springs)

    @classmethod
    def of_samples_on_grid(cls, torques: Array) -> Waves:
        """The torques of a multi-affine map, given at all q_j in {0, 2 pi / 3, 4 pi / 3}.

        Parameters
        ----------
        torques : (3, .., 3, n) array
            One axis per joint, then the torques [N m].

        Notes
        -----
        Where every joint enters as ``1, cos q_j, sin q_j`` three angles determine it: the discrete
        Fourier transform gives all coefficients of k in {-1, 0, 1}^n at once, to rounding.
        """
        n = torques.ndim - 1
        spectrum = np.fft.fftn(torques, axes=tuple(range(n))).reshape(3**n, -1) / 3**n
        k = np.array(np.unravel_index(np.arange(3**n), (3,) * n)).T
        k = np.where(k == 2, -1, k).astype(np.int64)
        # one of each pair +-k: the first nonzero entry positive; 0 alone
        first = np.take_along_axis(k, (k != 0).argmax(axis=1)[:, None], axis=1)[:, 0]
        one = first >= 0
        twice = np.where(k[one].any(axis=1), 2.0, 1.0)[:, None]
        found = cls(k[one], twice * spectrum[one].real, -twice * spectrum[one].imag)
        return found.without_rounding()


NEGLIGIBLE = 1e-16
"""Coefficients below it, relative to the largest, are rounding."""

C_NO_WAVES = """
static void add_waves(const double *q, double *torque)
{
    (void)q;
    (void)torque;
}
"""

C_WAVES = """
static void add_waves(const double *q, double *torque)
{
    double phase, c, s;
    int i, k;
    for (k = 0; k < WAVES; k++) {
        phase = 0.0;
        for (i = 0; i < INPUTS; i++)
            phase += FREQUENCY[k][i] * q[i];
        c = cos(phase);
        s = sin(phase);
        for (i = 0; i < JOINTS; i++)
            torque[i] += COS[k][i] * c + SIN[k][i] * s;
    }
}
"""

C_SOURCE = """
void isotorque_gravity(const double *q, double *tau)
{
    double torque[JOINTS] = {0.0};
    int i;
    add_waves(q, torque);
    for (i = 0; i < JOINTS; i++)
        tau[i] = torque[i]%s;
}
"""
