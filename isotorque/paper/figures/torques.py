"""Figures 3, 4, 7 and 13 of the paper, and errors of batch learning, from our data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from isotorque.paper import published as paper
from isotorque.verify.report.figures.learning_curves import LearningCurve, learning_curves
from isotorque.verify.report.figures.torques import (
    ProfileTrace,
    joint_trajectories,
    static_torque_map,
    torque_profiles,
)
from isotorque.verify.report.run_figures import Picture

Data = Mapping[str, Any]
LINEAR_TOP = 0.03
"""Upper end of the linear axis of Fig. 13 [N m]: beyond it curves are about to fall."""


def discovery_pictures(data: Data) -> Iterator[Picture]:
    """Draw Fig. 3 and 4 from the experiment ``discovery-2r``."""
    traces = [
        ProfileTrace(
            np.array(t["times"]),
            np.array(t["torques"]),
            np.array(t["q"]),
            t["outcome"],
            np.array(t["final"]),
        )
        for t in data["traces"]
    ]
    if not traces:
        return
    yield Picture(
        "fig3",
        "2r",
        f"{len(traces)} torque profiles of one sequence; they begin and end at the "
        "same absolute torque.",
        torque_profiles(traces),
    )
    yield Picture(
        "fig4",
        "2r",
        "The motion they led to. Dots: where the arm settled; red crosses: a joint "
        "limit was met, or it did not settle, and went home.",
        joint_trajectories(traces),
    )


def static_torque_pictures(data: Data) -> Iterator[Picture]:
    """Draw Fig. 7 from the experiment ``static-torques-2r``."""
    for name, key, words in (
        ("fig7a", "babbling", "Torques of the original Goal Babbling"),
        ("fig7b", "constrained_babbling", "Torques of Constrained Goal Babbling"),
        ("directions-original", "sampling", "Torques of the original Direction Sampling"),
        (
            "directions-constrained",
            "constrained_sampling",
            "Torques of Constrained Direction Sampling",
        ),
    ):
        held, refused = np.array(data[key]["held"]), np.array(data[key]["refused"])
        shape = (-1, held.shape[1])
        yield Picture(
            name,
            "2r",
            f"{words}: settled under, and inadmissible ones.",
            static_torque_map(held, refused.reshape(shape)),
        )


def learning_pictures(
    literal: Sequence[Data], guided: Sequence[Data], iterated: Sequence[Data]
) -> Iterator[Picture]:
    """Draw Fig. 13 from all seeds, and the same with logarithmic axes."""
    curves = [
        _curve("LLM", [d["curve"] for d in literal], "66"),
        _curve("LLM, guided arm", [d["curve"] for d in guided], "66"),
        _curve("LLM_it", [d["curve"] for d in iterated], "84"),
        _curve("LLM_it, kernel as printed", [d["printed_curve"] for d in iterated], "84"),
    ]
    size = paper.SAMPLES_PER_ITERATION
    printed = [
        (paper.ITERATIONS_LLM * size, paper.RMSE_66),
        (paper.LONG_ITERATIONS * size, paper.LONG_RMSE),
        (paper.ITERATIONS_LLM_IT * size, paper.RMSE_84),
    ]
    for name, logarithmic in (("fig13", False), ("fig13-log", True)):
        yield Picture(
            name,
            "2r",
            "Torque RMSE at the paper's targets against iterations of 100 samples"
            + (", logarithmic axes." if logarithmic else "."),
            learning_curves(
                curves,
                logarithmic=logarithmic,
                iteration=size,
                published=printed,
                goal=paper.RMSE_66 if logarithmic else None,
                top=LINEAR_TOP,
            ),
        )


def batch_pictures(arm: str, batch: Sequence[Data], error: float) -> Iterator[Picture]:
    """Draw error against samples with and without symmetries."""
    curves = [
        _curve("with symmetries", [d["symmetric"] for d in batch], "dense"),
        _curve("without", [d["plain"] for d in batch], "dense"),
    ]
    yield Picture(
        f"factor-{arm}",
        "batch",
        f"{arm.upper()}: error on the dense set against samples, "
        f"networks of {paper.HIDDEN} neurons; dashed: the paper's error. The horizontal distance "
        "is the factor.",
        learning_curves(curves, goal=error),
    )


def _curve(name: str, seeds: Sequence[Data], key: str) -> LearningCurve:
    """Return the median over seeds with the lowest and highest, at the samples of the first."""
    samples = np.array(seeds[0]["samples"], dtype=float)
    errors = np.array([np.interp(samples, seed["samples"], seed[key]) for seed in seeds])
    middle = np.median(errors, axis=0)
    if len(seeds) == 1:
        return LearningCurve(name, samples, middle)
    return LearningCurve(name, samples, middle, errors.min(axis=0), errors.max(axis=0))
