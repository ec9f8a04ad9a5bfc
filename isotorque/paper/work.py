"""Piece of work: an experiment on a seed; any process on any machine can do it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from isotorque.learning.files.software_versions import software_versions
from isotorque.paper.experiments.experiments import experiment
from isotorque.paper.experiments.measured import Effort
from isotorque.plain import plain
from isotorque.symbolic.common.single_thread import single_thread
from isotorque.symbolic.robots.load_robot import load_robot


@dataclass(frozen=True)
class Piece:
    """An experiment on a seed.

    Attributes
    ----------
    experiment : str
        Its name.
    seed : int
    share : float
        See `Effort`.
    """

    experiment: str
    seed: int
    share: float = 1.0

    @property
    def name(self) -> str:
        """Name of its file, without ending."""
        return f"{self.experiment}-{self.seed}"


def perform(piece: Piece) -> dict[str, Any]:
    """Measure, and return plain ``numbers`` and ``pictures``, and the ``versions`` that made them.

    The same piece gives the same result wherever it is done (times apart).
    """
    chosen = experiment(piece.experiment)
    with single_thread():  # arrays are small: threads would only wait for each other
        measured = chosen.measure(load_robot(chosen.robot), piece.seed, Effort(piece.share))
    return {
        "numbers": plain(measured.numbers),
        "pictures": plain(measured.pictures),
        "versions": software_versions(),
    }
