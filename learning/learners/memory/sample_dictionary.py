"""A dictionary of samples with a fixed budget, spread as widely as it can be."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.learners.symmetry_coordinates import GroupArrays, SymmetryCoordinates
from isotorque.symbolic.common.compiled import compiled
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


class SampleDictionary:
    """Keeps at most ``budget`` of all samples offered, far from each other.

    Parameters
    ----------
    budget : int
        Samples kept at most.
    group : SymmetryGroup or None
        Samples are as far apart as their orbits are.

    Notes
    -----
    While there is room every sample is kept. After that a new sample takes the place of the most
    crowded one: that with the least sum of the distances to its two nearest neighbours, the new
    sample among them. The dictionary thus follows where the arm goes without ever filling up with
    one place, at a cost per sample that depends on the budget alone.

    The paper's outlook (iv): update the learner with such a set instead of the current sample only.

    Examples
    --------
    >>> kept = SampleDictionary(3)
    >>> for angle in (0.0, 0.1, 1.0, 2.0):
    ...     kept.add(np.array([angle]), np.array([np.cos(angle)]))
    >>> kept.q.ravel().tolist()
    [0.0, 2.0, 1.0]
    """

    def __init__(self, budget: int, group: GroupArrays | None = None) -> None:
        if budget < 1:
            raise InputError("sample dictionary", "budget", budget, "at least 1")
        self.budget = int(budget)
        self._group = group
        self._coordinates: SymmetryCoordinates | None = None
        self._size = 0

    def __len__(self) -> int:
        """Number of samples kept."""
        return self._size

    @property
    def q(self) -> Array:
        """Configurations (m, n) [rad]; a view."""
        return self._q[: self._size]

    @property
    def torque(self) -> Array:
        """Torques (m, k) [N m]; a view."""
        return self._torque[: self._size]

    @property
    def weights(self) -> Array:
        """Weights (m,); a view."""
        return self._weights[: self._size]

    def add(self, q: Array, torque: Array, weight: float = 1.0) -> None:
        """Offer a sample: configuration (n,) [rad], torque (k,) [N m] and its weight."""
        if self._coordinates is None:
            self._start(len(q), len(torque))
        assert self._coordinates is not None
        y = self._coordinates.basis @ q
        images = self._coordinates.A_sat @ y + self._coordinates.d_sat
        slot = _slot_for(
            self._y,
            self._size,
            self.budget,
            images,
            self._coordinates.isometry,
            self._distance,
        )
        self._q[slot], self._torque[slot], self._weights[slot] = q, torque, weight
        self._size = _settle_in(
            self._y,
            self._size,
            slot,
            y,
            self._coordinates.A_sat,
            self._coordinates.d_sat,
            self._coordinates.isometry,
            self._nearest,
            self._distance,
        )

    def draw(self, rng: np.random.Generator, count: int) -> tuple[Array, Array, Array]:
        """Random samples with replacement: q (count, n), torques (count, k), weights (count,)."""
        chosen = (rng.random(count) * self._size).astype(np.int64)
        return self._q[chosen], self._torque[chosen], self._weights[chosen]

    def to_arrays(self) -> dict[str, Array]:
        """The samples as arrays."""
        return {
            "dictionary_q": self.q.copy(),
            "dictionary_torque": self.torque.copy(),
            "dictionary_weights": self.weights.copy(),
        }

    def restore(self, arrays: Mapping[str, Array]) -> None:
        """Take in the samples that ``to_arrays`` gave."""
        for sample in zip(
            arrays["dictionary_q"],
            arrays["dictionary_torque"],
            arrays["dictionary_weights"],
            strict=True,
        ):
            self.add(*sample)

    def _start(self, joints: int, outputs: int) -> None:
        self._coordinates = SymmetryCoordinates.of(self._group, joints)
        self._q = np.zeros((self.budget, joints))
        self._torque = np.zeros((self.budget, outputs))
        self._weights = np.zeros(self.budget)
        self._y = np.zeros((self.budget, self._coordinates.rank))
        self._nearest = np.full((self.budget, 2), -1, dtype=np.int64)
        self._distance = np.full((self.budget, 2), np.inf)


@compiled
def _orbit_distances(points, size, images, isometry, distances):
    """Least squared distance from every point (size, r) to the images (G, r) of another."""
    rank = points.shape[1]
    difference = np.empty(rank)
    for p in range(size):
        least = np.inf
        for g in range(images.shape[0]):
            for k in range(rank):
                turn = points[p, k] - images[g, k]
                difference[k] = turn - 2 * np.pi * np.floor(turn / (2 * np.pi) + 0.5)
            total = 0.0
            for i in range(rank):
                step = 0.0
                for j in range(i, rank):
                    step += isometry[i, j] * difference[j]
                total += step * step
            least = min(least, total)
        distances[p] = least


@compiled
def _slot_for(points, size, budget, images, isometry, distance):
    """Where a new sample, given by its images (G, r), belongs."""
    if size < budget:
        return size
    distances = np.empty(size)
    _orbit_distances(points, size, images, isometry, distances)
    slot = 0
    least = np.inf
    for p in range(size):
        first, second = distance[p, 0], distance[p, 1]
        if distances[p] < first:
            first, second = distances[p], first
        elif distances[p] < second:
            second = distances[p]
        crowd = np.sqrt(first) + np.sqrt(second)
        if crowd < least:
            slot, least = p, crowd
    return slot


@compiled
def _note(nearest, distance, p, other, squared):
    """Point ``other`` lies at this squared distance from p: keep it if among the two nearest."""
    if squared < distance[p, 0]:
        distance[p, 1], nearest[p, 1] = distance[p, 0], nearest[p, 0]
        distance[p, 0], nearest[p, 0] = squared, other
    elif squared < distance[p, 1]:
        distance[p, 1], nearest[p, 1] = squared, other


@compiled
def _settle_in(points, size, slot, y, A_sat, d_sat, isometry, nearest, distance):
    """Put y into the slot and keep every sample's two nearest neighbours right; the new size."""
    rank = y.size
    order = A_sat.shape[0]
    size = max(size, slot + 1)
    points[slot] = y
    distances = np.empty(size)
    images = np.empty((order, rank))
    for p in range(size):
        if p != slot and nearest[p, 0] != slot and nearest[p, 1] != slot:
            continue
        for g in range(order):
            for i in range(rank):
                images[g, i] = d_sat[g, i]
                for j in range(rank):
                    images[g, i] += A_sat[g, i, j] * points[p, j]
        _orbit_distances(points, size, images, isometry, distances)
        nearest[p] = -1
        distance[p] = np.inf
        for other in range(size):
            if other != p:
                _note(nearest, distance, p, other, distances[other])
        if p == slot:
            for other in range(size):
                if other != slot and nearest[other, 0] != slot and nearest[other, 1] != slot:
                    _note(nearest, distance, other, slot, distances[other])
    return size
