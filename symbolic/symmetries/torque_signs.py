"""All torque signs Y that some symmetry of a block of joints has, as a few generators."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.lattices.integer_lattice import coordinates_in, independent_rows
from isotorque.symbolic.symmetries.frequency_support import FrequencySupport
from isotorque.symbolic.symmetries.sign_components import SignComponent

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Hashes = NDArray[np.uint64]

_ROUNDING = 1e-9  # of phases [rad], far above that of floats and far below any true difference


class TorqueSigns:
    """Search for the sign vectors Y that belong to a symmetry.

    Parameters
    ----------
    support
        Frequencies whose joints are all touched.
    classes : (m,) int array
        Labels of frequencies that may be mapped to each other (equal |C_k|).
    components : list of SignComponent
        See `sign_components`.
    tolerance
        Largest |C_{s_k Y k} - s_k C_k exp(i k.d)| that is taken for zero.

    Notes
    -----
    The admitted Y form a vector space over the field of two elements, hence a few generators
    describe all. They are found along a chain of stabilisers: with the first joints held at +,
    one completion with the next joint at - is searched, depth first. Joints are taken in an order
    that completes frequencies early, and a partial Y is given up as soon as a completed frequency
    has no image of equal amplitude, or no sign of its component fits the phases; that makes the
    number of partial Y small also where amplitudes alone would admit 2^n of them.

    References
    ----------
    Seress, Permutation Group Algorithms, Cambridge 2003, chapter 4 (stabiliser chains).
    """

    def __init__(
        self,
        support: FrequencySupport,
        classes: Integers,
        components: list[SignComponent],
        tolerance: float,
    ) -> None:
        self._support, self._classes = support, classes
        self._components, self._tolerance = components, tolerance
        self._both = np.concatenate([support.K, -support.K]).astype(np.uint64)
        labels = np.concatenate([classes, classes]).astype(np.uint64)
        self._start = _mixed(labels + np.uint64(1))
        self._order = _joint_order(support.K)
        self._levels = self._make_levels()

    def admitted(self, Y: Integers) -> NDArray[np.bool_]:
        """Say, for a given Y, which of the signs (+1, -1) each component admits, shape (2, c)."""
        return self.misfits(Y) <= self._tolerance

    def misfits(self, Y: Integers) -> Array:
        """Return the misfit of each component for the signs (+1, -1), shape (2, c).

        Infinite where Y does not map the support to itself within the classes.
        """
        m = len(self._support.K)
        out = np.full((2, len(self._components)), np.inf)
        row = self._support.locate(self._support.K * Y)
        if np.all(row >= 0) and np.array_equal(self._classes[row % m], self._classes):
            value = self._support.C[row % m]
            value = np.where(row >= m, np.conj(value), value)
            for c, component in enumerate(self._components):
                out[0, c] = component.misfit(self._support, value, 1)
                out[1, c] = component.misfit(self._support, np.conj(value), -1)
        return out

    def generators(self) -> list[Integers]:
        """Return a basis of all admitted Y, in reduced echelon form.

        Each is -1 on its first negative joint, where all others are +1; sorted by that joint.
        """
        found: list[Integers] = []
        for depth in range(len(self._order) - 1, -1, -1):
            Y = self._completed(depth)
            if Y is not None:
                found.append(Y)
        return _echelon(found, self._support.K.shape[1])

    # -- the search -----------------------------------------------------------------------------

    def _completed(self, depth: int) -> Integers | None:
        """Return an admitted Y that is + on the first ``depth`` joints and - on the next."""
        Y = np.ones(len(self._order), dtype=np.int64)
        phases = np.zeros((2, self._flags))
        prescribed = [1] * depth + [-1]

        def extend(t: int, hashes: Hashes, feasible: NDArray[np.bool_]) -> bool:
            if t == len(self._order):
                return bool(self.admitted(Y).any(axis=0).all())
            level = self._levels[t]
            for sign in prescribed[t : t + 1] or (1, -1):
                Y[level.joint] = sign
                left = self._feasible(level, Y, phases, feasible)
                if left is None:
                    continue
                column = self._both[:, level.joint] * np.uint64(sign % 2**64)
                longer = hashes + column * level.multiplier
                if int(_mixed(longer).sum(dtype=np.uint64)) == level.fingerprint and extend(
                    t + 1, longer, left
                ):
                    return True
            Y[level.joint] = 1
            return False

        every = np.ones((2, len(self._components)), dtype=bool)
        return Y if extend(0, self._start, every) else None

    def _feasible(
        self, level: _Level, Y: Integers, phases: Array, feasible: NDArray[np.bool_]
    ) -> NDArray[np.bool_] | None:
        """Return the component signs that the frequencies completed here leave; None if none."""
        fresh = level.fresh
        if not len(fresh):
            return feasible
        C, m = self._support.C, len(self._support.K)
        row = self._support.locate(self._support.K[fresh] * Y)
        if np.any(row < 0) or np.any(self._classes[row % m] != self._classes[fresh]):
            return None
        value = np.where(row < m, C[row % m], np.conj(C[row % m]))
        angle = np.angle(np.array([value, -np.conj(value)]) / C[fresh])
        phases[:, level.flags] = angle[:, level.flag_places]
        misfit = level.denominators * angle - phases @ level.numerators.T
        wrong = np.abs(misfit - 2 * np.pi * np.round(misfit / (2 * np.pi))) > level.slack
        left = feasible.copy()
        for component, places in level.components:
            left[:, component] &= ~wrong[:, places].any(axis=1)
            if not left[:, component].any():
                return None
        return left

    def _make_levels(self) -> list[_Level]:
        K, C = self._support.K, self._support.C
        place = np.argsort(self._order)
        depth = np.where(K != 0, place, -1).max(axis=1, initial=-1)
        early = np.lexsort((-np.abs(C), depth))
        chosen = independent_rows(K[early])
        numerators, denominators = coordinates_in(K[early], chosen)
        numerators, denominators = numerators[np.argsort(early)], denominators[np.argsort(early)]
        flags = early[chosen]
        self._flags = len(flags)
        doubt = self._tolerance / np.abs(C)
        doubt = np.where(doubt < 0.5, 2 * doubt, np.inf)  # an angle whose sine is that doubtful
        with np.errstate(invalid="ignore"):
            inherited = np.where(numerators != 0, np.abs(numerators) * doubt[flags], 0).sum(axis=1)
        slack = denominators * doubt + inherited + _ROUNDING
        draw = np.random.default_rng(1).integers(1, 2**63, len(self._order), dtype=np.int64)
        multipliers = draw.astype(np.uint64) * np.uint64(2) + np.uint64(1)
        levels, hashes = [], self._start
        for t, joint in enumerate(self._order.tolist()):
            hashes = hashes + self._both[:, joint] * multipliers[t]
            fresh = np.flatnonzero(depth == t)
            here = np.flatnonzero(np.isin(flags, fresh))
            label = self._support.components[fresh]
            levels.append(
                _Level(
                    joint=joint,
                    fresh=fresh,
                    components=[(int(c), np.flatnonzero(label == c)) for c in np.unique(label)],
                    flags=here,
                    flag_places=np.searchsorted(fresh, flags[here]),
                    numerators=numerators[fresh].astype(float),
                    denominators=denominators[fresh].astype(float),
                    slack=slack[fresh],
                    multiplier=multipliers[t],
                    fingerprint=int(_mixed(hashes).sum(dtype=np.uint64)),
                )
            )
        return levels


@dataclass(frozen=True, eq=False)
class _Level:
    """Constraints that become decidable when one more joint gets its sign."""

    joint: int
    fresh: Integers  # the frequencies completed here
    components: list[tuple[int, Integers]]  # their components, and where among ``fresh``
    flags: Integers  # frequencies of a basis that are completed here, and where
    flag_places: Integers
    numerators: Array  # the fresh frequencies in that basis
    denominators: Array
    slack: Array
    multiplier: np.uint64
    fingerprint: int  # of all (label, frequency on the joints so far)


def _joint_order(K: Integers) -> Integers:
    """Order joints so that each completes many frequencies, or is entangled with those before."""
    touched = K != 0
    together = touched.T.astype(np.int64) @ touched
    missing = touched.sum(axis=1)
    order: list[int] = []
    left = list(range(K.shape[1]))
    while left:
        completed = {j: int(((missing == 1) & touched[:, j]).sum()) for j in left}
        entangled = {j: int(together[j, order].sum()) for j in left}
        best = max(
            left,
            key=lambda j: (completed[j] > 0, entangled[j] > 0, completed[j], entangled[j]),
        )
        order.append(best)
        left.remove(best)
        missing = missing - touched[:, best]
    return np.array(order, dtype=np.int64)


def _mixed(values: Hashes) -> Hashes:
    """Scatter 64-bit numbers (splitmix64), so that sums of them tell multisets apart."""
    x = values ^ (values >> np.uint64(30))
    x = x * np.uint64(0xBF58476D1CE4E5B9)
    x = x ^ (x >> np.uint64(27))
    x = x * np.uint64(0x94D049BB133111EB)
    return np.asarray(x ^ (x >> np.uint64(31)))


def _echelon(signs: list[Integers], n: int) -> list[Integers]:
    """Return the reduced echelon basis of sign vectors, products being sums of bits."""
    rows = [np.asarray(Y < 0) for Y in signs]
    basis: list[NDArray[np.bool_]] = []
    for joint in range(n):
        pivot = next((row for row in rows if row[joint]), None)
        if pivot is None:
            continue
        rows = [row ^ pivot if row[joint] else row for row in rows if row is not pivot]
        basis = [row ^ pivot if row[joint] else row for row in basis] + [pivot]
    return [np.where(row, -1, 1) for row in basis]
