"""Data sets of the protocol: which arms, poses, noise and contaminations, and one of each drawn."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.verify.testing.contaminated_arms import (
    OF_ALL_JOINTS,
    Contaminant,
    Contamination,
    Measurements,
    TrueArm,
)

Array = NDArray[np.float64]

ROBOTS = ("2r", "3r", "ur5", "panda")
KNOWN, UNKNOWN, ANGLES, UNEQUAL = CLEAN = (
    "clean",
    "clean-unknown",
    "clean-angles",
    "clean-unequal",
)
"""Pools of clean arms: the noise of torques is known; is not; angles have noise too, which nobody
tells; every joint has a noise of its own, unknown. Others are named after contaminations."""
POOLS = (*CLEAN, *map(str, Contaminant))

NOISES = (0.01, 0.05)
"""Standard deviations of torques [N m]: at the smaller one the small torques of the last joints
count, at the larger one they drown."""
DATA_SETS = {20: 180, 100: 108, 500: 12}
"""Data sets of a pool by number of poses, both noises together."""
SIZES = (2.0, 4.5, 8.0, 16.0)
"""Sizes of contaminations, in least standard errors."""
ANGLE_NOISE = float(np.deg2rad(0.05))
UNEQUAL_NOISE = 0.7
"""Standard deviation of the logarithms of the joints' noises."""
DRAWS = 1000


@dataclass(frozen=True)
class Setting:
    """One data set, before it is drawn.

    Attributes
    ----------
    robot, pool : str
    poses : int
    noise : float
        Of torques [N m].
    index : int
        Which of the data sets that agree in the rest; decides about size, stated noise, recorded
        directions in turn.
    seed : int
        Of the whole benchmark.
    """

    robot: str
    pool: str
    poses: int
    noise: float
    index: int
    seed: int

    @property
    def kind(self) -> Contaminant | None:
        """What is wrong with the arm, if anything is."""
        return None if self.pool in CLEAN else Contaminant(self.pool)

    @property
    def deviations(self) -> float:
        """Size of the contamination in least standard errors."""
        return 0.0 if self.kind is None else SIZES[self.index % len(SIZES)]

    @property
    def noise_stated(self) -> bool:
        """Whether the learner is told the noise of the torques.

        Not where that of the angles moves torques more, which nobody tells: it would be a lie.
        """
        if self.pool in (KNOWN, UNKNOWN, UNEQUAL):
            return self.pool == KNOWN
        if self.pool == ANGLES and self.noise < NOISES[-1]:
            return False
        return self.index // len(SIZES) % 2 == 0

    @property
    def directions_recorded(self) -> bool:
        """Whether directions are, where the kind does not say so itself."""
        return self.index // (2 * len(SIZES)) % 2 == 0

    def generator(self) -> np.random.Generator:
        """Random numbers of this data set alone."""
        places = ROBOTS.index(self.robot), POOLS.index(self.pool), NOISES.index(self.noise)
        return np.random.default_rng([self.seed, *places, self.poses, self.index])


@dataclass(frozen=True, eq=False)
class DataSet:
    """A data set and the truth about it.

    Attributes
    ----------
    contamination : Contamination
    size : float
        In the unit of its kind.
    deviations : float
        In least standard errors; that of a sign is what it is.
    noise : (n,) array
        Of torques [N m].
    stated : float or None
        What the learner is told of it.
    recorded : Measurements
    """

    contamination: Contamination
    size: float
    deviations: float
    noise: Array
    stated: float | None
    recorded: Measurements


def settings(
    robots: Sequence[str] = ROBOTS,
    pools: Sequence[str] = POOLS,
    *,
    share: float = 1.0,
    seed: int = 0,
) -> Iterator[Setting]:
    """All data sets, or a share of every pool, few poses first.

    Examples
    --------
    >>> len(list(settings(["2r"], ["offset"]))), len(list(settings(["2r"], ["offset"], share=0.05)))
    (300, 15)
    """
    for poses, count in DATA_SETS.items():
        whole = [(noise, index) for index in range(count // len(NOISES)) for noise in NOISES]
        for robot in robots:
            for pool in pools:
                chosen = whole
                if share < 1.0:
                    places = ROBOTS.index(robot), POOLS.index(pool)
                    rng = np.random.default_rng([seed, poses, *places])
                    some = rng.choice(len(whole), max(1, round(share * count)), replace=False)
                    chosen = [whole[i] for i in sorted(some.tolist())]
                for noise, index in chosen:
                    yield Setting(robot, pool, poses, noise, index, seed)


@cache
def true_arm(robot: str) -> TrueArm:
    """A built-in arm."""
    return TrueArm.of(load_robot(robot))


def draw(setting: Setting) -> DataSet:
    """Draw a data set.

    Notes
    -----
    Poses lie anywhere. The joint is one on which the contamination has a plausible size.
    """
    rng, arm = setting.generator(), true_arm(setting.robot)
    q = rng.uniform(-np.pi, np.pi, (setting.poses, arm.n))
    noise = np.full(arm.n, setting.noise)
    if setting.pool == UNEQUAL:
        noise = noise * np.exp(UNEQUAL_NOISE * rng.normal(size=arm.n))
    found, size, deviations = _sized(setting, arm, q, noise, rng)
    angle_noise = ANGLE_NOISE if setting.pool == ANGLES else 0.0
    recorded = found.measured(size, noise, rng, angle_noise=angle_noise)
    stated = setting.noise if setting.noise_stated else None
    return DataSet(found, size, deviations, noise, stated, recorded)


def _sized(
    setting: Setting, arm: TrueArm, q: Array, noise: Array, rng: np.random.Generator
) -> tuple[Contamination, float, float]:
    """A contamination with its size, also in standard errors."""
    kind = setting.kind
    for _ in range(DRAWS):
        found = Contamination.drawn(
            arm,
            kind,
            q,
            rng,
            joint=int(rng.integers(arm.n)),
            recorded_directions=setting.directions_recorded,
        )
        if kind is None:
            return found, 0.0, 0.0
        error = found.standard_error(noise)
        if kind is Contaminant.SIGN and np.isfinite(error):
            return found, -found.largest, found.largest / error
        if kind is not Contaminant.SIGN and setting.deviations * error <= found.largest:
            sign = 1.0 if kind in OF_ALL_JOINTS else float(rng.choice([-1.0, 1.0]))
            return found, sign * setting.deviations * error, setting.deviations
    raise RuntimeError(f"no joint of {setting} can have such a contamination")
