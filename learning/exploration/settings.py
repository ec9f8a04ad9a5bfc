"""Settings of an exploration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from isotorque.symbolic.common.errors import InputError


@dataclass(frozen=True)
class ExplorationSettings:
    """Settings of an exploration; the defaults suit arms with joint angles in radians.

    Attributes
    ----------
    step_width : float
        epsilon of Eq. 13: distance between targets [rad].
    noise : float
        Standard deviation of the exploratory noise, as a share of each joint's torque range.
    noise_drift : float
        Step of the noise's random walk, as a share of its standard deviation.
    home_probability : float
        Probability of a visit home in every step.
    turn_angle : float
        phi: a direction ends when the arm moves more than this away from it [rad]; pi/2 is Eq. 15.
    to_boundary : bool
        A torque outside the set of static torques is replaced by the last admissible one on the
        way to it from the nearest torque ever held, less 30 % of the way; False: by that
        nearest held torque itself, which leaves the fringe of the set unexplored.
    joint_weights : tuple of float or None
        w of Eq. 13 where joints have different units; None: all 1.
    window : int
        Settled samples in one iteration (the paper's 100).
    window_samples : int
        Samples drawn from an iteration to evaluate e_val.
    target_error : float or None
        e_max [N m]: stop when e_val was at most this ...
    windows_below : int
        ... in so many iterations one after the other ...
    required_share : float
        ... and this share of the domain has been explored (0 to 1).
    learn_inadmissible : bool
        Learn also what is wrong: torque and configuration where a joint limit stopped the arm. The
        unconstrained originals do; it destroys the model (Fig. 7).
    """

    step_width: float = 0.3
    noise: float = 0.02
    noise_drift: float = 0.3
    home_probability: float = 0.02
    turn_angle: float = np.pi / 2
    to_boundary: bool = True
    joint_weights: tuple[float, ...] | None = None
    window: int = 100
    window_samples: int = 50
    target_error: float | None = None
    windows_below: int = 3
    required_share: float = 0.0
    learn_inadmissible: bool = False

    def __post_init__(self) -> None:
        """Refuse unusable settings."""
        for name, low, high in (
            ("step_width", 1e-9, np.inf),
            ("noise", 0.0, np.inf),
            ("noise_drift", 0.0, np.inf),
            ("home_probability", 0.0, 1.0),
            ("turn_angle", 0.0, np.pi),
            ("window", 1, np.inf),
            ("window_samples", 1, np.inf),
            ("windows_below", 1, np.inf),
            ("required_share", 0.0, 1.0),
        ):
            value = getattr(self, name)
            if not (low <= value <= high) or (name != "turn_angle" and np.isinf(value)):
                accepted = f"a number from {low} to {high}"
                if np.isinf(high):
                    accepted = f"a finite number, at least {low}"
                raise InputError("exploration settings", name, value, accepted)
        if self.target_error is not None and not self.target_error > 0:
            raise InputError(
                "exploration settings", "target_error", self.target_error, "None or > 0 [N m]"
            )
