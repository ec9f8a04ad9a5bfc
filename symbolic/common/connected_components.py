"""Connected components of graphs of a few nodes, without loading SciPy's sparse matrices."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def connected_components(linked: ArrayLike) -> NDArray[np.int64]:
    """Label the nodes of an undirected graph by component, in the order of their first nodes.

    Parameters
    ----------
    linked : (n, n) array of bool
        Whether two nodes are linked; either direction counts.

    Returns
    -------
    (n,) array
        Labels 0, 1, ..; equal for nodes that a path joins.

    Examples
    --------
    >>> connected_components([[0, 0, 1], [0, 0, 0], [0, 0, 0]])
    array([0, 1, 0])
    """
    near = np.asarray(linked, dtype=bool)
    near = near | near.T | np.eye(len(near), dtype=bool)
    label = np.full(len(near), -1, dtype=np.int64)
    count = 0
    for start in range(len(near)):
        if label[start] < 0:
            part = near[start]
            while np.any(part != (wider := near[part].any(axis=0))):
                part = wider
            label[part] = count
            count += 1
    return label
