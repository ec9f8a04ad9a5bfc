"""Symmetry discovery with torque profiles (Algorithm 1)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from learning.arm import Outcome, OutcomeKind, Playback, ProfileArm
from learning.torque_profiles import ProfileShape, draw_profile
from symbolic.errors import InputError
from symbolic.relations import wrap

Array = NDArray[np.float64]


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
        Torques tried at first to learn which torques the arm can hold (the SST).
    away_from_zero : float
        Every target component is at least this share of the joint's torque scale: signs of
        smaller ones would say nothing.
    same_angle : float
        Settled configurations nearer than this are one [rad], modulo 2 pi.
    profile : ProfileShape
        Distributions of the profiles.
    """

    profiles_per_torque: int = 12
    patience: int = 6
    babbling: int = 40
    away_from_zero: float = 0.05
    same_angle: float = 1e-3
    profile: ProfileShape = field(default_factory=ProfileShape)

    def __post_init__(self) -> None:
        for name in ("profiles_per_torque", "patience", "babbling"):
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


class TorqueScale:
    """What the arm can hold, found by trying: a growing box of torques around the home torque.

    Knows nothing but outcomes. The first torque is minute; it grows until the arm visibly moves,
    then on until as many tries fail as succeed.
    """

    def __init__(self, n: int) -> None:
        self.scale = np.zeros(n)

    def seen(self, outcome: Outcome) -> None:
        """Take in one outcome."""
        if outcome.kind is OutcomeKind.SETTLED:
            self.scale = np.maximum(self.scale, np.abs(outcome.torque))


def babble(
    arm: ProfileArm, rng: np.random.Generator, tries: int, active: ArrayLike | None = None
) -> Iterator[Outcome]:
    """Try torques of growing size to learn which the arm can hold; yield every outcome.

    Parameters
    ----------
    arm
        Any arm.
    rng
        Source of randomness.
    tries
        Number of torques after the arm first moved visibly.
    active : (n,) array of bool, optional
        Joints to drive; torque zero elsewhere.

    Yields
    ------
    Outcome
        Settled or inadmissible, in order.
    """
    home = np.asarray(arm.q, dtype=float)
    n = len(home)
    mask = np.ones(n) if active is None else np.asarray(active, dtype=float)
    size = np.full(n, 1e-3) * mask
    for joint in np.flatnonzero(mask):
        # the joint's own stiffness sets the scale: double until it moves by a tenth of a radian
        for _ in range(40):
            torque = np.zeros(n)
            torque[joint] = size[joint]
            before = np.asarray(arm.q, dtype=float)
            outcome = arm.apply(torque)
            yield outcome
            moved = abs(float(wrap(outcome.q - before)[joint]))
            if outcome.kind is not OutcomeKind.SETTLED or moved > 0.1:
                break
            size[joint] *= 2
        arm.go_home()
    grown = 0
    for _ in range(tries):
        outcome = arm.apply(rng.uniform(-1, 1, n) * size)
        yield outcome
        if outcome.kind is OutcomeKind.SETTLED:
            grown += 1
            # grow where the arm held a large share of what was tried
            size = np.where(np.abs(outcome.torque) > 0.5 * size, size * 1.25, size)
        else:
            size = size * 0.95


def discover(
    arm: ProfileArm,
    target: ArrayLike,
    scale: ArrayLike,
    rng: np.random.Generator,
    settings: DiscoverySettings | None = None,
    known: Callable[[], Array] | None = None,
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
        profile = draw_profile(signs * tau, ending * tau, scale, rng, settings.profile)
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
