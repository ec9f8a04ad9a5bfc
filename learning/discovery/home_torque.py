"""The torque that holds an arm at home, found by the arm itself."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import Outcome, OutcomeKind, Playback, ProfileArm

Array = NDArray[np.float64]

Search = Generator[Outcome, None, Array | None]
"""Yields every motion, returns the torque that holds home (n,) [N m] or None."""

STEP_SECONDS = 0.02
STEPS = 50
"""Each release is observed for a second."""
VISIBLE = 0.05
"""Releases are compared where the first of them has moved so far [rad]."""
TELLING = 0.2
"""A torque is told from the one before by this share of what is visible."""
FIRST_CHANGE = 1e-3
"""First change of a joint's torque [N m]; it grows until it tells ..."""
GROWTH, UNFELT, LARGEST_CHANGE = 4.0, 256.0, 1e9
"""... by this factor, up to so many times what told at the first joint that did, or [N m]."""
FAR, SMALLEST_CHANGE = 0.2, 1e-15
"""A change that moves the arm farther [rad] is made smaller, but not below [N m]: the motion is
not linear in it."""
ROUNDS = 8
ERROR, TRIES = 0.01, 8
"""Home counts as held where it is kept under torque errors of 1 % (normal, of the largest torque
there) in half of the tries: no motor is as exact as a simulation."""
NEAR = 0.5
"""Where no torque at all keeps the arm at rest, errors are 1 % of what holds it so near [rad]."""


def find_home_torque(arm: ProfileArm) -> Search:
    """Look for the torque under which the arm stays at home, with torques alone.

    Parameters
    ----------
    arm
        Any arm that plays torque profiles.

    Yields
    ------
    Outcome
        Every motion.

    Returns
    -------
    (n,) array or None
        Zero, where the arm rests under no torque at all (it hangs); None where no torque is found.

    Notes
    -----
    The arm is let go at home under a torque tau and first moves by ``dq = G (tau - tau_home)``:
    G, unknown, is regular but for joints that gravity does not feel. One release under tau and one
    more for each joint, under a torque changed until the motion visibly changes, give G and with it
    the next tau: Newton's method on the first motion. It ends when the arm comes to rest under the
    torque instead of falling.
    """
    home, outcome = _at_home(arm), arm.apply(np.zeros(len(arm.q)))
    yield outcome
    if outcome.kind is OutcomeKind.SETTLED:
        return np.zeros(len(home))
    torque, begin = np.zeros(len(home)), np.full(len(home), FIRST_CHANGE)
    for _ in range(ROUNDS):
        released = _release(arm, torque)
        yield released.outcome
        if released.outcome.kind is OutcomeKind.SETTLED:
            return torque
        fell = released.q - home
        told = yield from _telling_changes(arm, torque, home, fell, begin)
        if not told:
            return None
        moment = min(_visible_at(fell), *(len(moved) - 1 for _, moved in told))
        slopes = np.array([moved[moment] - fell[moment] for _, moved in told])
        # dq = fell + shares @ slopes is to vanish
        shares = np.linalg.lstsq(slopes.T, -fell[moment], rcond=1e-6)[0]
        torque = torque + shares @ np.array([change for change, _ in told])
    return None


def _telling_changes(
    arm: ProfileArm, torque: Array, home: Array, fell: Array, begin: Array
) -> Generator[Outcome, None, list[tuple[Array, Array]]]:
    """Change one joint's torque after the other until the first motion visibly changes.

    Returns pairs of a change (n,) and the motion under it (T, n). ``begin`` (n,) is where the
    search for each joint's change begins; it is set for the next time. Joints that tell nothing
    under 256 times the change that told first are left out: gravity does not reach them.
    """
    told: dict[int, tuple[Array, Array]] = {}
    moment, size, largest = _visible_at(fell), float(begin.min()), LARGEST_CHANGE

    def changed(joint: int, size: float) -> Generator[Outcome, None, tuple[Array, Array, float]]:
        change = np.zeros(len(home))
        change[joint] = size
        played = _release(arm, torque + change)
        yield played.outcome
        moved = played.q - home
        at = min(moment, len(moved) - 1)
        return change, moved, float(np.abs(moved[at] - fell[at]).max())

    while len(told) < len(home) and size <= largest:
        for joint in np.flatnonzero(begin <= size).tolist():
            if joint in told:
                continue
            change, moved, told_by = yield from changed(joint, size)
            least = size
            while told_by > FAR and least > SMALLEST_CHANGE:
                smaller, motion, by = yield from changed(joint, least / GROWTH)
                if by < TELLING * VISIBLE:
                    break
                change, moved, told_by, least = smaller, motion, by, least / GROWTH
            if told_by >= TELLING * VISIBLE:
                told[joint] = change, moved
                begin[joint] = least / GROWTH
                largest = min(largest, UNFELT * least)
        size *= GROWTH
    return list(told.values())


def measure_home_torque(arm: Any, rng: np.random.Generator) -> Search:
    """Measure the torque that holds a guided arm at home, and whether it would stay by itself.

    Parameters
    ----------
    arm
        An arm that can be placed and held from outside (`LimitedGuidedArm` where limits are near).
    rng
        Source of the torque errors.

    Yields
    ------
    Outcome
        Every motion.

    Returns
    -------
    (n,) array or None
        None where the arm falls from home under the torque that was measured there, or under one
        that is off by 1 %: it has to be guided. Zero where it rests under no torque, and stays at
        rest under errors of that size.
    """
    _at_home(arm)
    resting = arm.apply(np.zeros(len(arm.q)))
    yield resting
    rests = resting.kind is OutcomeKind.SETTLED
    if rests:
        torque = np.zeros(len(resting.q))
        size = yield from _sizes_about(arm, resting.q, rng)
    else:
        _at_home(arm)
        held = arm.hold()
        yield held
        torque = np.array(held.torque, dtype=float)
        size = np.full(len(torque), np.abs(torque).max())
    kept = int(rests)  # the first try, without an error, has been made already
    for attempt in range(kept, TRIES):
        error = ERROR * size * rng.standard_normal(len(torque))
        _at_home(arm)
        outcome = arm.apply(torque + (error if attempt else 0.0))
        yield outcome
        if outcome.kind is OutcomeKind.SETTLED:
            kept += 1
        elif attempt == 0:
            return None
    return torque if 2 * kept >= TRIES else None


def _sizes_about(
    arm: Any, rest: Array, rng: np.random.Generator
) -> Generator[Outcome, None, Array]:
    """Root mean square of each joint's torque [N m] where the arm is held near where it rests."""
    torques = []
    for q in rng.uniform(rest - NEAR, rest + NEAR, (TRIES, len(rest))):
        arm.place(q)
        held = arm.hold()
        yield held
        torques.append(np.array(held.torque, dtype=float))
    return np.sqrt(np.mean(np.square(torques), axis=0))


def holds_itself(arm: Any, rng: np.random.Generator) -> bool:
    """Say whether a guided arm would stay at home, or at rest elsewhere, without being held.

    Examples
    --------
    >>> from isotorque.learning.simulator.simulated_arm import SimulatedArm
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> rng = np.random.default_rng(0)
    >>> [holds_itself(SimulatedArm(load_robot(x), "guided"), rng) for x in ("ur5", "panda")]
    [True, False]
    """
    search = measure_home_torque(arm, rng)
    while True:
        try:
            next(search)
        except StopIteration as end:
            return end.value is not None


def _at_home(arm: ProfileArm) -> Array:
    arm.go_home()
    return np.array(arm.q, dtype=float)


def _release(arm: ProfileArm, torque: Array) -> Playback:
    arm.go_home()
    return arm.play(np.tile(torque, (STEPS, 1)), STEP_SECONDS)


def _visible_at(moved: Array) -> int:
    """Return the first moment at which a release (T, n) has visibly moved; the last if never."""
    seen = np.flatnonzero(np.abs(moved).max(axis=1) >= VISIBLE)
    return int(seen[0]) if len(seen) else len(moved) - 1
