"""Symmetry discovery with torque profiles (Algorithm 1)."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from learning.arm import Outcome, OutcomeKind, Playback, ProfileArm
from learning.exploration.strategies import GuidedArm
from learning.home_torque import Search, find_home_torque
from learning.torque_profiles import ProfileShape, draw_profile
from symbolic.errors import InputError
from symbolic.relations import wrap

Array = NDArray[np.float64]

SMALLEST_TORQUE = 1e-3
"""First torque tried at every joint [N m]."""
VISIBLE_MOTION = 0.1
"""A joint that has moved this far has shown its torque scale [rad]."""
MOST_DOUBLINGS = 40
TRIES_PER_RAY = 8

_Begun = tuple[Array, Outcome]
"""Where a motion began, and how it ended."""


@dataclass(frozen=True)
class DiscoverySettings:
    """How long and how widely to look for symmetric configurations.

    Attributes
    ----------
    profiles_per_torque : int
        n_pr of Algorithm 1.
    patience : int
        A torque is left early when this many profiles in a row bring nothing new.
    babbling : int
        Torques tried at first to learn which the arm can hold (the SST); places at first, where it
        holds none and is led.
    led : int
        Places that a led arm is taken to between two looks at the relations.
    away_from_zero : float
        Every target component is at least this share of the joint's torque scale: signs of
        smaller ones would say nothing.
    same_angle : float
        Settled configurations nearer than this are one [rad], modulo 2 pi.
    profile : ProfileShape
        Distributions of the profiles.
    """

    profiles_per_torque: int = 16
    patience: int = 8
    babbling: int = 120
    led: int = 60
    away_from_zero: float = 0.05
    same_angle: float = 1e-3
    profile: ProfileShape = field(default_factory=ProfileShape)

    def __post_init__(self) -> None:
        for name in ("profiles_per_torque", "patience", "babbling", "led"):
            if getattr(self, name) < 1:
                raise InputError("discovery", name, getattr(self, name), "at least 1")
        if not 0 < self.away_from_zero < 1:
            raise InputError("discovery", "away_from_zero", self.away_from_zero, "0 to 1")
        if not self.same_angle > 0:
            raise InputError("discovery", "same_angle", self.same_angle, "> 0 [rad]")


@dataclass(frozen=True, eq=False)
class ProfilePlayed:
    """One profile of Algorithm 1 and what it led to.

    Attributes
    ----------
    target : (n,) array
        tau* [N m].
    playback : Playback
        Torques, joint trajectory and outcome.
    new : bool
        Whether the settled configuration was not yet in the discovered set.
    """

    target: Array
    playback: Playback
    new: bool


def babble(
    arm: ProfileArm,
    rng: np.random.Generator,
    tries: int,
    search: Callable[[ProfileArm], Search] = find_home_torque,
) -> Generator[Outcome, None, Array | None]:
    """Find out which torques the arm can hold, knowing nothing: yield every outcome.

    Parameters
    ----------
    arm
        Any arm, at home.
    rng
        Source of randomness.
    tries
        Torques applied after the scale of each joint has been found.
    search
        Finds the home torque of an arm that does not rest under a minute torque.

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
    Joint by joint, a minute torque is added to the home torque and doubled until the arm visibly
    moves: that is the scale. A joint that does not come to rest even under the minute torque has
    no stiffness (a vertical first axis) and is driven no further. Then random rays from the home
    torque are followed, each to where the arm gives way: in growing steps, then by bisection. So
    the set of static torques becomes known up to its boundary.
    """
    n = len(arm.q)
    size, centre = np.zeros(n), np.zeros(n)
    home, first = np.array(arm.q), arm.apply(SMALLEST_TORQUE * np.eye(n)[0])
    yield first
    begun: _Begun | None = (home, first)
    if first.kind is not OutcomeKind.SETTLED:
        found = yield from search(arm)
        if found is None:
            return None
        centre, begun = found, None
        arm.go_home()
    for joint in range(n):
        yield from _find_scale(arm, joint, centre, size, begun)
        begun = None
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
    arm: ProfileArm, joint: int, centre: Array, size: Array, begun: _Begun | None
) -> Iterator[Outcome]:
    """Set ``size[joint]`` to a torque that visibly moves the joint; leave 0 where none holds.

    ``begun``: where the minute torque was applied already, and what it led to.
    """
    torque = np.zeros(len(size))
    torque[joint] = SMALLEST_TORQUE
    for _ in range(MOST_DOUBLINGS):
        if begun is None:
            before = np.array(arm.q, dtype=float)
            outcome = arm.apply(centre + torque)
            yield outcome
        else:
            (before, outcome), begun = begun, None
        if outcome.kind is not OutcomeKind.SETTLED or outcome.torque[joint] == centre[joint]:
            break
        size[joint] = torque[joint]
        if abs(float(wrap(outcome.q - before)[joint])) > VISIBLE_MOTION:
            break
        torque *= 2
    arm.go_home()


def lead(
    arm: GuidedArm, limits: ArrayLike, rng: np.random.Generator, count: int
) -> Iterator[Outcome]:
    """Lead an arm that cannot hold itself to random places, hold it there: yield every outcome.

    Parameters
    ----------
    arm
        An arm that can be placed and held from outside.
    limits : (n, 2) array
        Between which angles it is led [rad], finite.
    rng
        Source of randomness.
    count
        Number of places, uniformly drawn.
    """
    low, high = np.asarray(limits, dtype=float).T
    for q in rng.uniform(low, high, (count, len(low))):
        arm.place(q)
        yield arm.hold()


def discover(
    arm: ProfileArm,
    target: ArrayLike,
    scale: ArrayLike,
    rng: np.random.Generator,
    settings: DiscoverySettings | None = None,
    known: Callable[[], Array] | None = None,
    centre: ArrayLike = 0.0,
) -> Iterator[ProfilePlayed]:
    """Play torque profiles that start and end at +-tau* and collect where the arm settles.

    Parameters
    ----------
    arm
        An arm that can play torque profiles.
    target : (n,) array
        tau* [N m].
    scale : (n,) array
        Torque scale of each joint [N m].
    rng
        Source of randomness.
    settings
        Number of profiles, patience, distributions.
    known
        Configurations (m, n) already discovered for this |tau*|, if any.
    centre
        Home torque (n,) [N m]: torques between start and end of a profile lie about it.

    Yields
    ------
    ProfilePlayed
        One per profile; ``settings.patience`` profiles in a row without a new configuration end
        the search early.

    References
    ----------
    Algorithm 1 of the paper.
    """
    if settings is None:
        settings = DiscoverySettings()
    tau = np.asarray(target, dtype=float)
    found = list(known()) if known is not None else []
    signs = np.ones_like(tau)
    idle = 0
    for _ in range(settings.profiles_per_torque):
        # the next profile starts where the last one ended; all signs are tried in time
        ending = rng.choice([-1.0, 1.0], len(tau))
        profile = draw_profile(signs * tau, ending * tau, scale, rng, settings.profile, centre)
        playback = arm.play(profile, settings.profile.step_seconds)
        settled = playback.outcome.kind is OutcomeKind.SETTLED
        q = playback.outcome.q
        new = settled and not any(np.all(np.abs(wrap(q - p)) < settings.same_angle) for p in found)
        if new:
            found.append(q)
        signs = ending if settled else np.ones_like(tau)
        idle = 0 if new else idle + 1
        yield ProfilePlayed(tau, playback, bool(new))
        if idle >= settings.patience:
            return


def choose_target(
    settled: ArrayLike,
    rng: np.random.Generator,
    away_from_zero: float = 0.05,
    used: ArrayLike | None = None,
) -> Array | None:
    """Choose a target torque among those the arm has held.

    Parameters
    ----------
    settled : (m, n) array
        Torques the arm has settled under [N m].
    rng
        Source of randomness.
    away_from_zero
        Each component is at least this share of the largest seen at that joint.
    used : (k, n) array, optional
        Targets used before; one far from all of them, in size, is preferred.

    Returns
    -------
    (n,) array or None
        None if no settled torque has all components away from zero.

    Examples
    --------
    >>> choose_target([[1.0, 0.0], [4.0, -1.0]], np.random.default_rng(0))
    array([ 4., -1.])
    """
    torques = np.asarray(settled, dtype=float)
    if torques.ndim != 2 or not len(torques):
        return None
    scale = np.abs(torques).max(axis=0)
    active = scale > 0
    if not active.any():
        return None
    share = np.abs(torques[:, active]) / scale[active]
    candidates = torques[np.all(share >= away_from_zero, axis=1)]
    if not len(candidates):
        return None
    if used is None or not len(np.asarray(used)):
        return np.array(candidates[int(rng.integers(len(candidates)))])
    pick = candidates[rng.integers(len(candidates), size=min(8, len(candidates)))]
    gap = np.abs(np.abs(pick)[:, None] - np.abs(np.asarray(used))[None])[..., active]
    distance = (gap / scale[active]).max(axis=2).min(axis=1)
    return np.array(pick[int(np.argmax(distance))])
