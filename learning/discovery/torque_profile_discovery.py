"""Symmetry discovery with torque profiles (Algorithm 1)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.learning.arm import GuidedArm, Outcome, OutcomeKind, Playback, ProfileArm
from isotorque.learning.discovery.torque_profiles import ProfileShape, draw_profile
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError

Array = NDArray[np.float64]


_Begun = tuple[Array, Outcome]
"""Where a motion began, and how it ended."""


@dataclass(frozen=True)
class DiscoverySettings:
    """Effort and range of the search for symmetric configurations.

    Attributes
    ----------
    profiles_per_torque : int
        n_pr of Algorithm 1.
    patience : int
        A torque is left early when this many profiles in a row bring nothing new.
    babbling : int
        Torques tried at first to learn which the arm can hold (the SST); places at first, where it
        holds none and is guided.
    telling : int
        Torques at most, before these, that are chosen to tell most about the arm until it knows
        its relations; joints are moved in few steps then. It is for sensors with errors. 0: torques
        of joints are doubled step by step, and an arm of many joints is moved at random.
    guided_places : int
        Places that a guided arm is taken to between two looks at the relations.
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
    telling: int = 0
    guided_places: int = 60
    away_from_zero: float = 0.05
    same_angle: float = 1e-3
    profile: ProfileShape = field(default_factory=ProfileShape)

    def __post_init__(self) -> None:
        for name in ("profiles_per_torque", "patience", "babbling", "guided_places"):
            if getattr(self, name) < 1:
                raise InputError("discovery", name, getattr(self, name), "at least 1")
        if self.telling < 0:
            raise InputError("discovery", "telling", self.telling, "at least 0")
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


def lead(
    arm: GuidedArm, limits: ArrayLike, rng: np.random.Generator, count: int
) -> Iterator[Outcome]:
    """Lead an arm that cannot hold itself to random places, hold it there: yield every outcome.

    Parameters
    ----------
    arm
        An arm that can be placed and held from outside.
    limits : (n, 2) array
        Between which angles it is guided within, finite.
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
