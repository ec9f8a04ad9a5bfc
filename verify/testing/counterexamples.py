"""Search for configurations where a claim fails, and shrink them to the simplest."""

from __future__ import annotations

import random
from collections.abc import Callable

import numpy as np
import scipy.optimize
from numpy.typing import ArrayLike, NDArray

Vector = NDArray[np.float64]

DIGITS = (0, 1, 2, 3, 6, 9)
EXAMPLES = 400


def largest_value(
    value: Callable[[Vector], Vector],
    n: int,
    *,
    gradient: Callable[[Vector], Vector] | None = None,
    limits: ArrayLike | None = None,
    samples: int = 512,
    refined: int = 4,
    seed: int = 0,
    starts: ArrayLike | None = None,
    climb: bool = True,
) -> tuple[float, Vector]:
    """Search for the largest value of a function of the configuration.

    Parameters
    ----------
    value
        Function of configurations (m, n) [rad] with values (m,), of period 2 pi or nearly so.
    n
        Number of joints.
    gradient
        Its gradient at one configuration, (n,) -> (n,); by differences where it is None.
    limits
        Search between these angles, (n, 2) [rad]; one turn around zero by default.
    samples
        Number of random starting points.
    refined
        How many of the best are climbed from (L-BFGS-B).
    seed
        Seed of the starting points: the same call finds the same point.
    starts
        More starting points, (k, n) [rad], within the limits.
    climb
        Whether to climb at all; otherwise the best starting point is returned.

    Returns
    -------
    value : float
        The largest value found; a lower bound of the supremum.
    q : (n,) array
        Where it was found, within the limits.

    Examples
    --------
    >>> best, q = largest_value(lambda q: np.cos(q[:, 0] - 1.0), 1)
    >>> bool(1.0 - best < 1e-9)
    True
    """
    rng = np.random.default_rng(seed)
    box = np.array([[-np.pi, np.pi]] * n if limits is None else limits, dtype=float)
    middle = np.clip(np.zeros((1, n)), box[:, 0], box[:, 1])
    more = np.empty((0, n)) if starts is None else np.asarray(starts, dtype=float)
    points = np.concatenate([middle, more, rng.uniform(box[:, 0], box[:, 1], (samples, n))])
    values = value(points)
    order = np.argsort(-values, kind="stable")[:refined]
    best, at = float(values[order[0]]), points[order[0]]
    spread = best - float(values.min())
    if not climb or spread <= 0.0:  # or constant, as far as can be seen
        return best, at
    scale = 1.0 / max(spread, float(np.finfo(float).tiny))
    for start in points[order]:
        ascent = scipy.optimize.minimize(
            lambda q: -scale * float(value(q[None, :])[0]),
            start,
            jac=None if gradient is None else lambda q: -scale * gradient(q),
            method="L-BFGS-B",
            bounds=box,
        )
        here = float(value(ascent.x[None, :])[0])
        if here > best:
            best, at = here, ascent.x
    return best, at


def simplest_configuration(fails: Callable[[Vector], bool], found: Vector) -> Vector:
    """Shrink a configuration where a claim fails to a simple one, with Hypothesis.

    Parameters
    ----------
    fails
        Whether the claim fails at a configuration (n,).
    found
        A configuration (n,) where it fails [rad].

    Returns
    -------
    (n,) array
        A configuration where the claim fails too: in tenths of a radian and as close to zero as
        Hypothesis can get it; where no such configuration fails, the fewest digits of ``found``
        that do; ``found`` itself where it takes all of them.

    Notes
    -----
    Deterministic: Hypothesis is given a fixed seed and no example database.

    References
    ----------
    MacIver and Donaldson, Test-case reduction via test-case generation: insights from the
    Hypothesis reducer, ECOOP 2020.

    Examples
    --------
    >>> simplest_configuration(lambda q: abs(q[1]) > 0.42, np.array([2.8174, -1.9021])).tolist()
    [0.0, 0.5]
    """
    # here, not above: the import takes a third of a second that a claim that holds never needs
    from hypothesis import HealthCheck, Phase, find, settings
    from hypothesis import strategies as st
    from hypothesis.errors import NoSuchExample

    options = settings(
        max_examples=EXAMPLES,
        phases=[Phase.generate, Phase.shrink],
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    tenths = st.integers(-31, 31).map(lambda i: i / 10)
    rounded = [
        st.sampled_from([0.0, *(float(round(x, digits)) for digits in DIGITS), float(x)])
        for x in found
    ]
    for strategy in (st.tuples(*[tenths] * len(found)), st.tuples(*rounded)):
        try:
            example = find(
                strategy,
                lambda q: fails(np.array(q, dtype=float)),
                settings=options,
                random=random.Random(0),
            )
        except NoSuchExample:
            continue
        return np.array(example, dtype=float) + 0.0  # + 0.0 turns -0.0 into 0.0
    return np.array(found, dtype=float)
