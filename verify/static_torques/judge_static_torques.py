"""Judge of a learned set of static torques: what it has in common with the true one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.verify.static_torques.true_static_torques import TrueStaticTorques
from isotorque.verify.verdict import Status, Verdict

Array = NDArray[np.float64]

MOST_JOINTS = 3
"""Beyond, random torques hardly ever hit the set: its volume cannot be measured this way."""


class TorqueSet(Protocol):
    """A set of torques: says of torques (m, n) [N m] which it admits."""

    def contains(self, torque: ArrayLike, /) -> bool | NDArray[np.bool_]:
        """Whether torques are admitted, (m,) bool."""
        ...


@dataclass(frozen=True, eq=False)
class StaticTorqueJudgement:
    """A learned set of static torques beside the true one.

    Areas and volumes are in N m to the power of the number of joints that gravity reaches.

    Attributes
    ----------
    true_volume, learned_volume, common_volume : float
        Of the true set, the learned one, and what they share.
    samples : int
        Random torques they were measured with; see `standard_error`.
    box_volume : float
        Of the box these were drawn from.
    stable_only : bool
        Whether the true set is what an arm without a controller can hold.
    false_torques : (k, n) array
        Those of the random torques that are admitted and that no configuration holds [N m].
    outside : (k,) array
        How far each of them is from the true set, at most [N m].
    """

    true_volume: float
    learned_volume: float
    common_volume: float
    samples: int
    box_volume: float
    stable_only: bool
    false_torques: Array
    outside: Array

    @property
    def coverage(self) -> float:
        """Share of the true set that is admitted."""
        return self.common_volume / self.true_volume if self.true_volume else 0.0

    @property
    def false_share(self) -> float:
        """Share of the admitted torques that no configuration holds."""
        if not self.learned_volume:
            return 0.0
        return 1.0 - self.common_volume / self.learned_volume

    @property
    def overlap(self) -> float:
        """What both have in common, as a share of what either has."""
        either = self.true_volume + self.learned_volume - self.common_volume
        return self.common_volume / either if either else 0.0

    @property
    def worst_outside(self) -> float:
        """Distance from the true set of the worst false admission found [N m]."""
        return float(self.outside.max(initial=0.0))

    @property
    def standard_error(self) -> float:
        """Of ``coverage``, from the number of random torques."""
        inside = self.true_volume / self.box_volume * self.samples
        share = self.coverage
        return float(np.sqrt(share * (1.0 - share) / inside)) if inside else np.nan

    def verdicts(
        self, *, least_coverage: float = 0.9, most_outside: float = 1.0
    ) -> tuple[Verdict, ...]:
        """Claims that the learned set is large enough, and not too large.

        Parameters
        ----------
        least_coverage
            Share of the true set that must be admitted.
        most_outside
            How far from the true set an admitted torque may lie [N m].
        """
        covered = self.coverage >= least_coverage
        tight = self.worst_outside <= most_outside
        return (
            Verdict(
                f"{self.coverage:.1%} of the static torques are admitted, at least "
                f"{least_coverage:.0%} claimed",
                Status.TESTED if covered else Status.REFUTED,
                1.0 - self.coverage,
            ),
            Verdict(
                f"{self.false_share:.1%} of the admitted torques cannot be held, none more than "
                f"{most_outside:g} N m outside the static torques",
                Status.TESTED if tight else Status.REFUTED,
                self.worst_outside,
            ),
        )


def judge_static_torques(
    estimate: TorqueSet,
    gravity: GravityModel,
    limits: ArrayLike,
    *,
    stable_only: bool = True,
    samples: int = 2000,
    margin: float = 1.1,
    rng: np.random.Generator | None = None,
) -> StaticTorqueJudgement:
    """Hold a learned set of static torques against the true one.

    Parameters
    ----------
    estimate
        Anything with ``contains(torques)``, such as a
        `StaticTorqueSet`.
    gravity
        The true gravity torque; up to three joints that it reaches.
    limits
        Joint limits (n, 2) [rad]; infinite where a joint has none.
    stable_only
        Count only torques under which some configuration rests without a controller.
    samples
        Random torques, uniform in a box around the true set.
    margin
        Size of that box, relative to the largest torques there are. What is admitted beyond it
        is not seen.
    rng
        Where they come from; by default always the same ones.

    Returns
    -------
    StaticTorqueJudgement

    Raises
    ------
    InputError
        If gravity reaches no joint or more than three, or for limits that cannot be used.

    Notes
    -----
    Volumes are counted by Monte Carlo. A torque belongs to the true set if a configuration that
    needs it was found (`TrueStaticTorques`); an admitted torque is called false only if its level
    set (`level_set`, which shares nothing with the learner) has no member within the
    limits, stable where that is asked. The learned set may know nothing of torques that only
    other branches of configurations hold: then its coverage is low, which is no false admission.

    Examples
    --------
    >>> from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet
    >>> from isotorque.symbolic.robots.load_robot import load_robot
    >>> from isotorque.verify.models.stability import is_stable
    >>> arm = load_robot("2r")
    >>> gravity = GravityModel(arm)
    >>> q = np.random.default_rng(0).uniform(-np.pi, np.pi, (2000, 2))
    >>> held = StaticTorqueSet(2)
    >>> held.add(gravity.torque(q[is_stable(q, gravity)]))
    >>> judged = judge_static_torques(held, gravity, arm.limits, samples=500)
    >>> judged.coverage > 0.9, judged.false_share < 0.1, judged.worst_outside < 1.0
    (True, True, True)
    """
    joints = np.flatnonzero(gravity.potential.to_float().frequencies.any(axis=0))
    if not 1 <= len(joints) <= MOST_JOINTS:
        accepted = f"1 to {MOST_JOINTS} joints that gravity reaches"
        raise InputError("static torques", gravity.name, f"{len(joints)} joints", accepted)
    rng = np.random.default_rng(0) if rng is None else rng
    truth = TrueStaticTorques(gravity, limits, stable_only=stable_only, rng=rng)
    reach = margin * np.abs(gravity.potential.to_float().gradient_bound())
    torques = rng.uniform(-reach, reach, (samples, len(reach)))
    admitted = np.asarray(estimate.contains(torques)).reshape(-1)
    true = truth.reached(torques)
    doubtful = np.flatnonzero(admitted & ~true)
    true[doubtful] = [truth.holds(torque) for torque in torques[doubtful]]
    false = admitted & ~true
    box = float(np.prod(2.0 * reach[joints]))
    return StaticTorqueJudgement(
        true_volume=box * float(true.mean()),
        learned_volume=box * float(admitted.mean()),
        common_volume=box * float((true & admitted).mean()),
        samples=samples,
        box_volume=box,
        stable_only=stable_only,
        false_torques=torques[false],
        outside=truth.distance(torques[false]),
    )
