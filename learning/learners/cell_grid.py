"""Cell list on a torus: the points near a point, at a cost that does not grow with their number."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: More cells than this are not worth their memory; all prototypes are scanned instead.
LARGEST_GRID = 2_000_000


class CellGrid(NamedTuple):
    """Box cells over [-pi, pi)^r with a margin of ghost cells, and a linked list in each.

    A point is entered once per periodic image that lies in the margin, so that a search never has
    to wrap anything: it visits the cells at fixed offsets from the cell of the query and compares
    unwrapped positions. A search radius wider than the torus sees several images of one point.

    Attributes
    ----------
    isometry : (r, r) array
        L; distances are ``|L dy|``.
    cells, margin : (r,) integer arrays
        Cells per turn and ghost cells on either side. No cells (zeros): scan everything.
    strides, offsets : integer arrays
        Steps of the flat cell index per axis (r,), and to every cell to be visited (o,).
    head : (number of cells,) integer array
        First entry of each cell, -1 if there is none.
    following, prototype : (e,) integer arrays
        Next entry of the same cell (-1: none) and the number of the point it is an image of.
    position : (e, r) array
        Position ``L y`` of the image.
    point : (p, r) array
        Wrapped coordinates y of every point.
    search_radius : float
        Radius within which every image is found.
    """

    isometry: Array
    cells: Integers
    margin: Integers
    strides: Integers
    offsets: Integers
    head: NDArray[np.int32]
    following: NDArray[np.int32]
    prototype: NDArray[np.int32]
    position: Array
    point: Array
    search_radius: float


def make_cell_grid(isometry: Array, search_radius: float, cell_side: float) -> CellGrid:
    """An empty cell list.

    Parameters
    ----------
    isometry : (r, r) array
        L of the distance ``|L dy|``.
    search_radius : float
        Largest distance at which points must be found.
    cell_side : float
        Wanted side of a cell, as a distance.

    Returns
    -------
    CellGrid
        With room for no entry yet (``with_room``). Without cells where their number would exceed
        ``LARGEST_GRID`` (many dimensions): then every search looks at all points.
    """
    rank = len(isometry)
    axis_length = np.linalg.norm(isometry, axis=0)
    cells = np.maximum(1, np.floor(2 * np.pi * axis_length / cell_side)).astype(np.int64)
    width = 2 * np.pi / cells
    reach = search_radius * np.linalg.norm(np.linalg.inv(isometry), axis=1)
    margin = np.ceil(reach / width - 1e-9).astype(np.int64)
    padded = cells + 2 * margin
    strides = np.ones(rank, dtype=np.int64)
    for axis in range(rank - 2, -1, -1):
        strides[axis] = strides[axis + 1] * padded[axis + 1]
    if np.prod(padded.astype(float)) > LARGEST_GRID:
        cells = np.zeros(rank, dtype=np.int64)
        margin = np.zeros(rank, dtype=np.int64)
        offsets = np.zeros(0, dtype=np.int64)
        head = np.zeros(0, dtype=np.int32)
    else:
        offsets = _reached_offsets(isometry * width, margin, search_radius) @ strides
        head = np.full(int(np.prod(padded)), -1, dtype=np.int32)
    return CellGrid(
        np.ascontiguousarray(isometry, dtype=float),
        cells,
        margin,
        strides,
        np.sort(offsets),
        head,
        np.zeros(0, dtype=np.int32),
        np.zeros(0, dtype=np.int32),
        np.zeros((0, rank)),
        np.zeros((0, rank)),
        float(search_radius),
    )


def images_per_point(grid: CellGrid) -> int:
    """Largest number of entries one point can need (0 without cells)."""
    if grid.head.size == 0:
        return 0
    return int(np.prod(1 + -(-2 * grid.margin // grid.cells)))


def sees_several_images(grid: CellGrid) -> bool:
    """Whether one point can be found at two periodic images in one search."""
    reach = grid.search_radius * np.linalg.norm(np.linalg.inv(grid.isometry), axis=1)
    return bool(grid.head.size and np.any(reach >= np.pi))


def with_room(grid: CellGrid, points: int) -> CellGrid:
    """The same list with room for ``points`` points (never less than it has)."""
    points = max(points, len(grid.point))
    entries = max(points * images_per_point(grid), len(grid.following))

    def longer(old: NDArray, length: int) -> NDArray:
        new = np.zeros((length, *old.shape[1:]), dtype=old.dtype)
        new[: len(old)] = old
        return new

    return grid._replace(
        following=longer(grid.following, entries),
        prototype=longer(grid.prototype, entries),
        position=longer(grid.position, entries),
        point=longer(grid.point, points),
    )


def _reached_offsets(cell: Array, margin: Integers, radius: float) -> Integers:
    """All integer steps between cells that have points within ``radius`` of each other.

    The columns of ``cell`` are the edges of one cell. Two cells a step ``o`` apart hold points at
    ``cell (o + t)``, t in [-1, 1]^r; the least norm is a box-constrained least squares problem.
    Coordinate descent solves it for all steps at once and the duality gap of Frank and Wolfe makes
    the result a true lower bound: a cell is never left out by mistake.
    """
    steps = np.array(
        list(itertools.product(*(range(-m, m + 1) for m in margin))), dtype=np.int64
    ).reshape(-1, len(margin))
    gram = cell.T @ cell
    free = np.zeros(steps.shape)
    for _ in range(50):
        for axis in range(len(margin)):
            gradient = (steps + free) @ gram[:, axis]
            free[:, axis] = np.clip(free[:, axis] - gradient / gram[axis, axis], -1.0, 1.0)
    gradient = (steps + free) @ gram
    squared = np.einsum("ij,ij->i", gradient, steps + free)
    gap = np.sum(gradient * free + np.abs(gradient), axis=1)
    lower = squared - 2 * gap
    return np.asarray(steps[lower <= radius**2 * (1 + 1e-9)])


@njit(cache=True)
def cell_of(grid, y):
    """Flat index of the cell that holds the wrapped point y."""
    flat = 0
    for axis in range(y.size):
        count = grid.cells[axis]
        step = int(np.floor((y[axis] + np.pi) * (count / (2 * np.pi))))
        flat += (min(max(step, 0), count - 1) + grid.margin[axis]) * grid.strides[axis]
    return flat


@njit(cache=True)
def enter(grid, entries, number, y):
    """Enter point ``number`` at the wrapped y with all its images; the new number of entries."""
    rank = y.size
    for axis in range(rank):
        grid.point[number, axis] = y[axis]
    if grid.head.size == 0:
        return entries
    first = np.empty(rank, dtype=np.int64)
    shift = np.empty(rank, dtype=np.int64)
    last = np.empty(rank, dtype=np.int64)
    home = np.empty(rank, dtype=np.int64)
    for axis in range(rank):
        count = grid.cells[axis]
        step = int(np.floor((y[axis] + np.pi) * (count / (2 * np.pi))))
        home[axis] = min(max(step, 0), count - 1)
        first[axis] = -((home[axis] + grid.margin[axis]) // count)
        last[axis] = (count + grid.margin[axis] - 1 - home[axis]) // count
        shift[axis] = first[axis]
    while True:
        flat = 0
        for axis in range(rank):
            step = home[axis] + shift[axis] * grid.cells[axis]
            flat += (step + grid.margin[axis]) * grid.strides[axis]
        for i in range(rank):
            value = 0.0
            for j in range(rank):
                value += grid.isometry[i, j] * (y[j] + 2 * np.pi * shift[j])
            grid.position[entries, i] = value
        grid.prototype[entries] = number
        grid.following[entries] = grid.head[flat]
        grid.head[flat] = entries
        entries += 1
        axis = rank - 1
        while axis >= 0 and shift[axis] == last[axis]:
            shift[axis] = first[axis]
            axis -= 1
        if axis < 0:
            return entries
        shift[axis] += 1


@njit(cache=True)
def find_near(grid, points, y, found, offset, squared):
    """All images within the search radius of the wrapped y.

    Writes the numbers of the points into ``found``, ``L (y - y_image)`` into the rows of
    ``offset`` and squared distances into ``squared``. Returns how many, and the least squared
    distance (infinity if there is none). Without cells the nearest image of every point counts.
    """
    rank = y.size
    limit = grid.search_radius * grid.search_radius
    if grid.head.size == 0:
        return scan_all(grid, points, y, limit, found, offset, squared)
    count = 0
    least = np.inf
    z = np.empty(rank)
    for i in range(rank):
        z[i] = 0.0
        for j in range(i, rank):
            z[i] += grid.isometry[i, j] * y[j]
    base = cell_of(grid, y)
    for o in range(grid.offsets.size):
        entry = grid.head[base + grid.offsets[o]]
        while entry >= 0:
            total = 0.0
            for i in range(rank):
                step = z[i] - grid.position[entry, i]
                offset[count, i] = step
                total += step * step
            if total <= limit:
                found[count] = grid.prototype[entry]
                squared[count] = total
                least = min(least, total)
                count += 1
            entry = grid.following[entry]
    return count, least


@njit(cache=True)
def scan_all(grid, points, y, limit, found, offset, squared):
    """As ``find_near``, but looks at every point: one image each, differences wrapped by component.

    Finds those with squared distance up to ``limit``; the least squared distance is that of all.
    """
    rank = y.size
    count = 0
    least = np.inf
    difference = np.empty(rank)
    for number in range(points):
        for axis in range(rank):
            turn = y[axis] - grid.point[number, axis]
            difference[axis] = turn - 2 * np.pi * np.floor(turn / (2 * np.pi) + 0.5)
        total = 0.0
        for i in range(rank):
            step = 0.0
            for j in range(i, rank):
                step += grid.isometry[i, j] * difference[j]
            offset[count, i] = step
            total += step * step
        least = min(least, total)
        if total <= limit:
            found[count] = number
            squared[count] = total
            count += 1
    return count, least
