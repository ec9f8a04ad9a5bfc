"""Section 4.1: symmetric configurations that torque profiles discover (Fig. 3 and 4)."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from isotorque.learning.discovery.torque_profile_discovery import DiscoverySettings
from isotorque.learning.relations.learned_symmetries import Knowledge
from isotorque.learning.scheme import Scheme, SchemeSettings
from isotorque.learning.simulator.simulated_arm import SimulatedArm
from isotorque.paper.experiments.measured import Effort, Measured
from isotorque.paper.experiments.online import literal
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.level_sets.level_set import level_set
from isotorque.symbolic.robots.load_robot import Robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries
from isotorque.verify.relations.learned_symmetries import judge_symmetries
from isotorque.verify.report.summaries import summarise_discovery

PROFILES = 32
"""Torque profiles in a sequence, n_pr of Algorithm 1; the paper does not give its number."""


def measure_discovery(robot: Robot, seed: int, effort: Effort) -> Measured:
    """Let the arm discover its symmetries and count what each sequence of profiles finds.

    Learning would begin when as many relations are known as the arm has (the paper's n_min).
    """
    gravity = GravityModel(robot)
    group = primary_symmetries(gravity.potential)
    scheme = Scheme(
        SimulatedArm(robot),
        np.random.default_rng(seed),
        literal,
        SchemeSettings(
            discovery=DiscoverySettings(
                profiles_per_torque=effort.of(PROFILES, 4), patience=effort.of(PROFILES, 4)
            ),
            n_min=group.order,
        ),
    )
    motions = list(scheme.discover())
    summary = summarise_discovery(motions, scheme.gates, group.order)
    potential = gravity.potential.to_float()
    held = [int(level_set(potential, t, group=group).stable.sum()) for t in summary.targets]
    numbers = {
        "discovered": float(np.median(summary.discovered)),
        "most_discovered": int(summary.discovered.max()),
        "stable_members": float(np.median(held)),
        "most_stable_members": max(held),
        "profiles": summary.profiles,
        "motions": len(motions),
        "samples": len(scheme.samples[0]),
        "relations": 0,
        "false_relations": 0,
        "observed_relations": 0,
    }
    if scheme.learned is not None:
        judged = judge_symmetries(scheme.learned, gravity, truth=group)
        known = [entry.known for entry in scheme.learned.relations]
        numbers["relations"] = judged.found
        numbers["false_relations"] = judged.false
        numbers["observed_relations"] = sum(k is not Knowledge.IDENTIFIED for k in known)
    return Measured(numbers, {"traces": [asdict(trace) for trace in summary.traces]})
