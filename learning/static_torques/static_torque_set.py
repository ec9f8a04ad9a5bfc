"""Set of static torques (SST): which torques the arm can hold, learned from what it held."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import KDTree

from learning.static_torques.alpha_shape import MAX_DIMENSION, AlphaShape
from learning.static_torques.growing_points import GrowingPoints
from symbolic.errors import InputError

Array = NDArray[np.float64]
Cell = tuple[int, ...]
NEVER_VARIED = 1e-9  # of the largest range: the joint was always given the same torque
CELLS_PER_RANGE = {1: 512, 2: 128, 3: 40}
CELLS_PER_RANGE_BEYOND = 16


class StaticTorqueSet:
    """Estimate of the set of statically admissible torques (paper, Eq. 12 and section 5.1).

    Parameters
    ----------
    n : int
        Number of joints.
    resolution : float, optional
        Cell size in units of the torque range; one torque is stored per cell. Default 1/512,
        1/128, 1/40 for 1, 2, 3 joints and 1/16 beyond.
    edge_factor : float
        See `AlphaShape`; beyond three joints half of it times the spacing of the torques is the
        radius of a ball.

    Notes
    -----
    A torque is admitted if it lies in the region covered by the torques the arm has held *and* is
    nearer to one of them than to any torque marked inadmissible. The region is the Delaunay mesh
    of the held torques without its long simplices (`AlphaShape`) for up to three joints whose
    torque varies, otherwise a union of balls around them. Torques are compared in units of their
    range per joint, rounded up to a power of two; a joint that always had the same torque (a free
    joint) must have it again. The last observation of a torque wins over an earlier one of the
    very same torque.

    An update costs some microseconds: torques in occupied cells are not stored again, trees and
    mesh are rebuilt only when the stored torques have grown by a fraction (an eighth, a quarter),
    so the cost of rebuilding is constant per update on average. Torques newer than the mesh count
    by their distance.

    The set knows nothing of why a torque failed: one that cannot be reached on this branch of
    configurations is marked like one that no configuration holds.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> held = StaticTorqueSet(2)
    >>> held.add(rng.uniform(-1.0, 1.0, (400, 2)) * [20.0, 5.0])
    >>> held.contains([3.0, 1.0]), held.contains([30.0, 1.0])
    (True, False)
    >>> bool(abs(held.nearest([30.0, 1.0])[0] - 20.0) < 2.0)
    True
    >>> held.mark_inadmissible([3.0, 1.0])
    >>> held.contains([3.0, 1.0])
    False
    """

    def __init__(
        self, n: int, *, resolution: float | None = None, edge_factor: float = 3.0
    ) -> None:
        if n < 1:
            raise InputError("static torque set", "number of joints", n, "at least 1")
        if resolution is not None and not 0.0 < resolution < 1.0:
            raise InputError("static torque set", "resolution", resolution, "0 < resolution < 1")
        if not edge_factor > 0.0:
            raise InputError("static torque set", "edge_factor", edge_factor, "a number > 0")
        self.n = n
        self._edge_factor = edge_factor
        if resolution is None:
            self._cells_per_range = float(CELLS_PER_RANGE.get(n, CELLS_PER_RANGE_BEYOND))
        else:
            self._cells_per_range = 1.0 / resolution
        self._scale = np.ones(n)  # powers of two: scaling back and forth is exact
        self._low = np.full(n, np.inf)
        self._high = np.full(n, -np.inf)
        self._held = GrowingPoints(n)
        self._refused = GrowingPoints(n)
        self._held_cells: dict[Cell, int] = {}
        self._refused_cells: dict[Cell, int] = {}
        self._forget_region()

    def __len__(self) -> int:
        """How many held torques are stored."""
        return len(self._held_cells)

    @property
    def torques(self) -> Array:
        """Stored torques that were held, shape (N, n) [N m]."""
        return self._held.points * self._scale

    @property
    def inadmissible(self) -> Array:
        """Stored torques that were not held, shape (M, n) [N m]."""
        return self._refused.points * self._scale

    @property
    def active(self) -> NDArray[np.bool_]:
        """Joints whose held torque varied, shape (n,)."""
        if not len(self):
            return np.zeros(self.n, dtype=bool)
        spread = self._high - self._low
        return spread > NEVER_VARIED * max(float(spread.max()), 1e-300)

    def add(self, torque: ArrayLike) -> None:
        """Take in torques that were held, shape (n,) or (m, n) [N m]."""
        rows = self._rows(torque)
        if not len(rows):
            return
        low = np.minimum(self._low, rows.min(axis=0))
        high = np.maximum(self._high, rows.max(axis=0))
        if (low < self._low).any() or (high > self._high).any():
            active = self.active
            self._low, self._high = low, high
            self._rescale()
            if (active != self.active).any():
                self._forget_region()
        self._put(rows / self._scale, self._held, self._held_cells, self._refused_cells)

    def mark_inadmissible(self, torque: ArrayLike) -> None:
        """Take in torques that were not held, shape (n,) or (m, n) [N m]."""
        rows = self._rows(torque) / self._scale
        self._put(rows, self._refused, self._refused_cells, self._held_cells)

    def contains(self, torque: ArrayLike) -> bool | NDArray[np.bool_]:
        """Whether torques are admissible as far as known.

        Parameters
        ----------
        torque : (n,) or (m, n) array
            Torques [N m].

        Returns
        -------
        bool or (m,) array of bool
        """
        rows = self._rows(torque)
        scaled = rows / self._scale
        to_held, nearest = self._held.nearest(scaled)
        to_refused, _ = self._refused.nearest(scaled)
        self._refresh_region()
        covered = to_held <= self._radius * (nearest >= self._region_end)
        active = self.active
        if self._shape is not None and not covered.all():
            covered = covered | self._shape.contains(scaled[:, active])
        admitted = covered & (to_held < to_refused)
        if not active.all() and len(self):
            allowed = 1e-6 * max(1.0, float(np.abs(self._high - self._low).max()))
            admitted &= (np.abs(rows - self._low)[:, ~active] <= allowed).all(axis=1)
        return admitted if np.ndim(torque) == 2 else bool(admitted[0])

    def nearest(self, torque: ArrayLike) -> Array:
        """Held torques nearest to the given ones (paper, Algorithm 2, line 18).

        Parameters
        ----------
        torque : (n,) or (m, n) array
            Torques [N m].

        Returns
        -------
        array of the same shape
            Torques that the arm has held, nearest in units of the range per joint [N m].

        Raises
        ------
        InputError
            If no torque was ever held.
        """
        rows = self._rows(torque)
        if not len(self):
            raise InputError("static torque set", "number of held torques", 0, "at least 1")
        _, indices = self._held.nearest(rows / self._scale)
        found = np.array([self._held[i] for i in indices]).reshape(-1, self.n) * self._scale
        return found if np.ndim(torque) == 2 else found[0]

    def admit(self, torque: ArrayLike) -> Array:
        """Torque (n,) itself where admissible, else the nearest held one [N m]."""
        return np.array(torque, dtype=float) if self.contains(torque) else self.nearest(torque)

    def region(self) -> tuple[Array, NDArray[np.intp]]:
        """Mesh of the region, for pictures and judges.

        Returns
        -------
        points : (N, r) array
            Torques of the r active joints [N m]; empty beyond three of them.
        simplices : (S, r + 1) array of int
            Rows of `points` that span the kept simplices.
        """
        self._forget_region()
        self._refresh_region()
        if self._shape is None:
            return np.empty((0, 0)), np.empty((0, 0), dtype=np.intp)
        return self._shape.points * self._scale[self.active], self._shape.simplices

    def _rows(self, torque: ArrayLike) -> Array:
        rows = np.asarray(torque, dtype=float)
        if rows.ndim not in (1, 2) or rows.shape[-1] != self.n:
            accepted = f"({self.n},) or (m, {self.n})"
            raise InputError("static torque set", "shape of torque", rows.shape, accepted)
        if not np.isfinite(rows).all():
            raise InputError("static torque set", "torque", rows, "finite numbers [N m]")
        return np.atleast_2d(rows)

    def _put(
        self,
        rows: Array,
        into: GrowingPoints,
        cells: dict[Cell, int],
        other_cells: dict[Cell, int],
    ) -> None:
        """Store scaled torques, one per cell; withdraw the opposite claim on the same torque."""
        other = self._refused if into is self._held else self._held
        for row, cell in zip(rows, self._cells(rows), strict=True):
            rival = other_cells.get(cell)
            if rival is not None and (other[rival] == row).all():
                other.remove(other_cells.pop(cell))
                self._changes += 1
            if cell not in cells:
                cells[cell] = into.append(row)
                self._changes += 1

    def _cells(self, rows: Array) -> list[Cell]:
        corners = np.floor(rows * self._cells_per_range).astype(np.int64)
        return [tuple(corner) for corner in corners.tolist()]

    def _rescale(self) -> None:
        """Follow the range of the held torques; it doubles only so often."""
        spread = np.where(self._high > self._low, self._high - self._low, 0.0)
        widest = float(spread.max())
        spread = np.where(spread > 0.0, np.maximum(spread, NEVER_VARIED * widest), 1.0)
        scale = np.exp2(np.ceil(np.log2(spread)))
        if (scale == self._scale).all():
            return
        held, refused = self.torques / scale, self.inadmissible / scale
        self._scale = scale
        self._held, self._refused = GrowingPoints(self.n), GrowingPoints(self.n)
        self._held_cells, self._refused_cells = {}, {}
        self._put(held, self._held, self._held_cells, self._refused_cells)
        self._put(refused, self._refused, self._refused_cells, self._held_cells)
        self._forget_region()

    def _forget_region(self) -> None:
        self._shape: AlphaShape | None = None
        self._radius = 0.0  # of the balls around the torques from index _region_end on
        self._region_end = 0
        self._changes = len(self._held_cells) + 9

    def _refresh_region(self) -> None:
        """Rebuild mesh and radius when the stored torques have changed by a quarter."""
        if self._changes <= max(8, len(self) // 4):
            return
        self._forget_region()
        self._changes = 0
        points = self._held.points[:, self.active]
        if len(points) < 2 or points.shape[1] == 0:
            return
        if points.shape[1] <= MAX_DIMENSION:
            shape = AlphaShape(points, self._edge_factor)
            if not shape.is_empty:
                self._shape = shape
                self._radius = shape.edge_limit / self._edge_factor
                self._region_end = int(self._held.indices[-1]) + 1
                return
        to_next = np.asarray(KDTree(points).query(points, k=2)[0])[:, 1]
        self._radius = 0.5 * self._edge_factor * float(np.median(to_next))
