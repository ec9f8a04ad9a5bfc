"""Motor babbling: which torques the arm can hold, knowing nothing."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import Outcome, OutcomeKind, ProfileArm
from isotorque.learning.discovery.home_torque import Search, find_home_torque
from isotorque.learning.discovery.torque_profile_discovery import _Begun
from isotorque.symbolic.common.angles import wrap

Array = NDArray[np.float64]

FIRST_TORQUE = 1e-3
"""First torque tried at every joint [N m]: minute for most arms, made smaller for others."""

VISIBLE_MOTION = 0.1
"""A joint that has moved this far has shown its torque scale [rad]."""

SHRINKAGE, SHRINKINGS = 16.0, 10
"""A first torque that carries a joint away is made smaller by this factor, so often at most."""

MOST_DOUBLINGS, DOUBLED = 80, 2.0

AIM = 0.2
"""Torques grow to where the motion seen so far lets expect this angle [rad]."""

GROWTH = 16.0
"""Factor between two torques of a joint at most, where few steps are wanted."""

TRIES_PER_RAY = 8

STEPS = 24
"""Torques about home before the rays, if they are wanted."""


def babble(
    arm: ProfileArm,
    rng: np.random.Generator,
    tries: int,
    search: Callable[[ProfileArm], Search] = find_home_torque,
    wanted: Callable[[Array, Array], Array | None] | None = None,
    always: bool = False,
    *,
    most_wanted: int = STEPS,
    growth: float = DOUBLED,
) -> Generator[Outcome, None, Array | None]:
    """Find out which torques the arm can hold, knowing nothing: yield every outcome.

    Parameters
    ----------
    arm
        Any arm, at home.
    rng
        Source of randomness.
    tries
        Torques applied along the rays.
    search
        Finds the home torque of an arm that does not rest under a minute torque.
    wanted
        ``wanted(home torque, torque scales)``, zero for joints that hold none: the torque to try
        before the rays, or None for no more of them.
    always
        Whether ``search`` is asked first, even of an arm that rests under a minute torque: one
        that rests but falls under any other torque is not seen by that.
    most_wanted
        So many of these torques are tried at most.
    growth
        Factor between two torques of a joint at most while it has not visibly moved; 2 doubles
        them.

    Yields
    ------
    Outcome
        Settled or inadmissible, in order.

    Returns
    -------
    (n,) array or None
        The home torque [N m], about which all others lie: zero for an arm that hangs at home.
        None where ``search`` found none; nothing more is tried then.

    Notes
    -----
    Joint by joint, a minute torque is added to the home torque and made larger until the arm
    visibly moves: that is the scale. It grows by no more than ``growth``, and to no more than what
    moves the joint by 0.2 rad if it goes on as it did; noise of the angle only makes that less. One
    that carries the arm away is followed by a smaller one. What is minute for one arm carries
    another one away: then the torque is made smaller until the joint rests under it. A joint that
    neither rests nor moves far under its torque has no stiffness (a vertical first axis) and is
    driven no further. Then random rays from the home torque are followed, each to where the arm
    gives way: in growing steps, then by bisection. So the set of static torques becomes known up to
    its boundary.
    """
    n = len(arm.q)
    size, centre = np.zeros(n), np.zeros(n)
    begun: _Begun | None = None
    if not always:
        begun = np.array(arm.q), arm.apply(FIRST_TORQUE * np.eye(n)[0])
        yield begun[1]
    if begun is None or begun[1].kind is not OutcomeKind.SETTLED:
        found = yield from search(arm)
        if found is None:
            return None
        centre, begun = found, None
        arm.go_home()
    for joint in range(n):
        yield from _find_scale(arm, joint, centre, size, begun, growth)
        begun = None
    for _ in range(most_wanted):
        torque = None if wanted is None else wanted(centre, size)
        if torque is None or not size.any():
            break
        yield arm.apply(torque)
    left = tries
    while left > 0 and size.any():
        direction = rng.normal(size=n)
        direction *= size / np.abs(direction).max()
        held, failed, share = 0.0, np.inf, 1.0
        for _ in range(min(left, TRIES_PER_RAY)):
            outcome = arm.apply(centre + share * direction)
            yield outcome
            left -= 1
            if outcome.kind is OutcomeKind.SETTLED:
                held = share
                size = np.maximum(size, np.abs(outcome.torque - centre))
            else:
                failed = share
            if failed - held < 0.05 * held:
                break
            share = 1.5 * held if np.isinf(failed) else 0.5 * (held + failed)
    return centre


def _find_scale(
    arm: ProfileArm,
    joint: int,
    centre: Array,
    size: Array,
    begun: _Begun | None,
    growth: float,
) -> Iterator[Outcome]:
    """Set ``size[joint]`` to a torque that visibly moves the joint; leave 0 where none holds.

    ``begun``: where the first torque was applied already, and what it led to.
    """
    torque = np.zeros(len(size))
    torque[joint] = FIRST_TORQUE
    home = float(arm.q[joint] if begun is None else begun[0][joint])
    factor, shrinkings = growth, 0
    for _ in range(MOST_DOUBLINGS):
        if begun is None:
            before = np.array(arm.q, dtype=float)
            outcome = arm.apply(centre + torque)
            yield outcome
        else:
            (before, outcome), begun = begun, None
        moved = abs(float(wrap(outcome.q - before)[joint])) > VISIBLE_MOTION
        if outcome.kind is OutcomeKind.SETTLED:
            if outcome.torque[joint] == centre[joint]:
                break
            size[joint] = torque[joint]
            if moved:
                break
            far = abs(float(wrap(outcome.q[joint] - home)))
            factor = min(factor, max(DOUBLED, AIM / max(far, AIM / growth)))
            torque *= factor
        elif size[joint] and factor > DOUBLED:
            factor = max(DOUBLED, factor**0.5)
            torque[joint] = factor * size[joint]
            arm.go_home()
        else:
            moved |= outcome.kind is OutcomeKind.LIMIT
            if size[joint] or not moved or shrinkings == SHRINKINGS:
                break
            torque /= SHRINKAGE
            shrinkings += 1
            arm.go_home()
    arm.go_home()
