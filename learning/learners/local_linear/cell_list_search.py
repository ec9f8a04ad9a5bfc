"""Search in a cell list: points near a point, found at a cost that stays the same."""

from __future__ import annotations

import numpy as np

from isotorque.symbolic.common.compiled import compiled, tuple_setitem


@compiled
def cell_step(grid, y, axis):
    """Cell of the wrapped y along one axis, 0 to cells - 1."""
    count = grid.cells[axis]
    return min(max(int(np.floor((y[axis] + np.pi) * (count / (2 * np.pi)))), 0), count - 1)


@compiled
def enter(grid, entries, number, y):
    """Enter point ``number`` at the wrapped y with all its images; the new number of entries."""
    rank = y.size
    for i in range(rank):  # entry by entry: to assign rows takes numba seconds to compile
        grid.point[number, i] = y[i]
    if grid.start.size == 0:
        return entries
    home = np.empty(rank, dtype=np.int64)
    first = np.empty(rank, dtype=np.int64)
    last = np.empty(rank, dtype=np.int64)
    for axis in range(rank):
        count = grid.cells[axis]
        home[axis] = cell_step(grid, y, axis)
        first[axis] = -((home[axis] + grid.margin[axis]) // count)
        last[axis] = (count + grid.margin[axis] - 1 - home[axis]) // count
    turn = first.copy()
    while True:
        cell = 0
        for axis in range(rank):
            step = home[axis] + turn[axis] * grid.cells[axis] + grid.margin[axis]
            cell += step * grid.strides[axis]
        place = grid.start[cell + 1]
        for entry in range(entries, place, -1):
            grid.number[entry] = grid.number[entry - 1]
            for i in range(rank):
                grid.position[entry, i] = grid.position[entry - 1, i]
        for later in range(cell + 1, grid.start.size):
            grid.start[later] += 1
        grid.number[place] = number
        for i in range(rank):
            value = 0.0
            for j in range(i, rank):
                value += grid.isometry[i, j] * (y[j] + 2 * np.pi * turn[j])
            grid.position[place, i] = value
        entries += 1
        axis = rank - 1
        while axis >= 0 and turn[axis] == last[axis]:
            turn[axis] = first[axis]
            axis -= 1
        if axis < 0:
            return entries
        turn[axis] += 1


@compiled(error_model="numpy")
def find_near(grid, y, found, offset, squared):
    """All images within the search radius of the wrapped y.

    Writes the numbers of the points into ``found``, ``L (y - y_image)`` into the rows of
    ``offset`` and squared distances into ``squared`` (all one row longer than what can be found).
    Returns how many, and the least squared distance (infinity if there is none). Without cells
    nothing is found: see ``find_far``.
    """
    limit = grid.search_radius * grid.search_radius
    start, position, number = grid.start, grid.position, grid.number
    row_first, row_cells = grid.row_first, grid.row_cells
    z = grid.axes
    base = 0
    for i in range(len(grid.axes)):
        value = 0.0
        for j in range(i, len(grid.axes)):
            value += grid.isometry[i, j] * y[j]
        z = tuple_setitem(z, i, value)
        base += (cell_step(grid, y, i) + grid.margin[i]) * grid.strides[i]
    count = 0
    least = np.inf
    for row in range(row_first.size):
        cell = base + row_first[row]
        for entry in range(start[cell], start[cell + row_cells[row]]):
            total = 0.0
            for i in range(len(grid.axes)):
                step = z[i] - position[entry, i]
                offset[count, i] = step
                total += step * step
            # Written in any case, kept only if near: a branch here would be mispredicted often.
            found[count] = number[entry]
            squared[count] = total
            count += total <= limit
            least = min(least, total)
    return count, least if count else np.inf


@compiled
def find_far(grid, points, y, found, offset, squared):
    """Where ``find_near`` finds nothing: one image of each point, differences wrapped by component.

    Finds what lies within the search radius, or, if nothing does, what is hardly farther than the
    nearest point: up to the search radius more in squared distance.
    """
    reach = grid.search_radius * grid.search_radius
    least = scan_all(grid, points, y, -1.0, found, offset, squared)[1]
    limit = reach if least <= reach else least + reach
    return scan_all(grid, points, y, limit, found, offset, squared)


@compiled
def scan_all(grid, points, y, limit, found, offset, squared):
    """All of the first ``points`` points with a squared distance up to ``limit``; how many.

    The least squared distance, returned second, is that of all points.
    """
    rank = len(grid.axes)
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
