"""Set of static torques (SST): which torques the arm can hold, learned from what it held."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import KDTree

from isotorque.learning.static_torques.alpha_shape import MAX_DIMENSION, AlphaShape
from isotorque.learning.static_torques.incremental_kd_tree import GrowingPoints
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]
Cell = tuple[int, ...]
NEVER_VARIED = 1e-9  # of the largest range: the joint was always given the same torque
CELLS_PER_RANGE = {1: 512, 2: 128, 3: 40}
CELLS_PER_RANGE_BEYOND = 16
FINEST = 1.0 / 32.0  # of a cell: torques are not told apart more finely
GRADE = 0.25  # near the border torques are stored this share of the distance to it apart
BORDER = (0.1, 0.3)  # of the spacing: how far beyond the mesh; second: once a torque has failed
CAUTION = 0.15  # but at most this share of the distance to one that failed, beyond ...
BUDGET = 0.008  # nothing is tried beyond the mesh while more of the admitted torques failed
MARGIN = 1.0 / 16.0  # ... so much of a cell


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
    torque varies, otherwise a union of balls around them. Beyond the mesh a torque may be tried
    with caution: 0.3 spacings away from a held one at most, far nearer to it than to any that
    failed, and while less than 0.8 % of the torques admitted failed. Torques are compared in
    units of their range per joint, rounded up to a power of two; a joint that always had the same
    torque (a free joint) must have it again. The last observation of a torque wins.

    One torque is stored per cell, but more where they tell more: outside the mesh, and between
    held and failed torques, the closer together the closer these are: angles go with the square
    root of the torque at the border, 1/128 of the range is 0.2 rad there on the 2R arm.

    Trees and mesh are rebuilt only when the stored torques have grown by a fraction (an eighth, a
    quarter), so the cost of rebuilding is constant per update on average.

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
        self._held_cells: Counter[Cell] = Counter()
        self._refused_cells: Counter[Cell] = Counter()
        self._seen = self._failed = 0  # torques that were admitted beforehand, and failed
        self._forget_region()

    def __len__(self) -> int:
        """How many held torques are stored."""
        return len(self._held)

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
        self._seen += len(rows)
        self._put(rows / self._scale, self._held, self._refused)

    def mark_inadmissible(self, torque: ArrayLike) -> None:
        """Take in torques that were not held, shape (n,) or (m, n) [N m]."""
        rows = self._rows(torque)
        self._failed += int(np.sum(self.contains(rows)))
        self._put(rows / self._scale, self._refused, self._held)

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
        to_held, _ = self._held.nearest(scaled)
        to_refused, _ = self._refused.nearest(scaled)
        self._refresh_region()
        active = self.active
        nearer = to_held < to_refused
        if self._shape is None:
            admitted = nearer & (to_held <= self._radius)
        else:
            room = CAUTION * (to_refused - MARGIN / self._cells_per_range)
            reach = BORDER[len(self._refused) > 0] * self._radius
            reach *= self._failed <= 1 + BUDGET * self._seen
            admitted = nearer & (to_held <= np.clip(room, 0.0, reach))
            if not admitted.all():
                admitted |= nearer & self._shape.contains(scaled[:, active])
        if not active.all() and len(self):
            allowed = 1e-6 * float(np.maximum(np.abs(self._low), np.abs(self._high)).max())
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

    def _put(self, rows: Array, into: GrowingPoints, other: GrowingPoints) -> None:
        """Store scaled torques that tell something; withdraw the opposite claim on the same one."""
        cells, other_cells = self._held_cells, self._refused_cells
        if into is self._refused:
            cells, other_cells = other_cells, cells
        for row, cell in zip(rows, self._cells(rows), strict=True):
            to_other, rival = (found[0] for found in other.nearest(row[None]))
            if to_other == 0.0:
                other_cells[self._cells(other[rival][None])[0]] -= 1
                other.remove(int(rival))
                self._changes += 1
            if not cells[cell] or self._tells_more(row, into, to_other):
                cells[cell] += 1
                into.append(row)
                self._changes += 1

    def _tells_more(self, row: Array, into: GrowingPoints, to_other: float) -> bool:
        """Whether a torque in an occupied cell narrows the border down."""
        spacing = GRADE * min(to_other, 1.0)  # in units of the range
        if self._shape is not None and into is self._held:
            spacing *= bool(self._shape.contains(row[None, self.active])[0])  # beyond: any
        to_own = into.nearest(row[None])[0][0]
        return bool(to_own > max(spacing, FINEST / self._cells_per_range))

    def _cells(self, rows: Array) -> list[Cell]:
        corners = np.floor(rows * self._cells_per_range).astype(np.int64)
        return [tuple(corner) for corner in corners.tolist()]

    def _rescale(self) -> None:
        """Follow the range of the held torques; it doubles only so often."""
        spread = np.where(self._high > self._low, self._high - self._low, 0.0)
        widest = float(spread.max())
        spread = np.where(spread > 0.0, np.maximum(spread, NEVER_VARIED * widest), widest or 1.0)
        scale = np.exp2(np.ceil(np.log2(spread)))
        if (scale == self._scale).all():
            return
        held, refused = self.torques / scale, self.inadmissible / scale
        self._scale = scale
        self._held, self._refused = GrowingPoints(self.n), GrowingPoints(self.n)
        for rows, into in ((held, self._held), (refused, self._refused)):
            for row in rows:
                into.append(row)
        self._held_cells = Counter(self._cells(held))
        self._refused_cells = Counter(self._cells(refused))
        self._forget_region()

    def _forget_region(self) -> None:
        self._shape: AlphaShape | None = None
        self._radius = 0.0  # spacing of the torques
        self._changes = len(self) + 9

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
                return
        to_next = np.asarray(KDTree(points).query(points, k=2)[0])[:, 1]
        self._radius = 0.5 * self._edge_factor * float(np.median(to_next))
