"""Causes named from a data set, held against what is wrong with its arm."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from benchmarks.claims.data_sets import DataSet
from isotorque.learning.learners.rigid.causes.diagnose import diagnose
from isotorque.verify.testing.contaminated_arms import Contaminant, Contamination

Name = tuple[str, int | None]

WORDS = {
    Contaminant.OFFSET: "offset",
    Contaminant.GAIN: "gain",
    Contaminant.SIGN: "sign",
    Contaminant.SPRING: "spring",
    Contaminant.CABLE: "cable",
    Contaminant.FRICTION: "friction",
    Contaminant.ONE_SIDED: "friction",
    Contaminant.COMPLIANCE: "compliance",
    Contaminant.SCALE: "scale",
    Contaminant.PAYLOAD: "payload",
    Contaminant.AMPERES: "gain",
}
"""What a diagnosis calls a kind; others have no name."""
ALIKE = 1.0
"""Two causes are one if the best test could not tell them apart: they differ by less than so many
standard errors."""


@dataclass(frozen=True)
class Naming:
    """What was named, and what would have been right.

    Attributes
    ----------
    named : tuple of tuples of (str, int or None)
        The causes in the order in which they were named: each with what cannot be told apart from
        it, itself first.
    right : tuple of (str, int or None)
        Names of the contamination, those that no recording of these poses could tell from it
        included; empty where there is nothing to name, or no name for it.
    parts : tuple of (str, int or None)
        What is no lie beside these: gains of single joints where all have one.
    seconds : float
        Processor time.
    """

    named: tuple[tuple[Name, ...], ...]
    right: tuple[Name, ...]
    parts: tuple[Name, ...]
    seconds: float

    @property
    def first(self) -> bool:
        """Whether the right cause was named before any other."""
        return bool(self.named) and self.named[0][0] in self.right

    @property
    def among(self) -> bool:
        """Whether the right cause is one of those that the first one cannot be told apart from."""
        return bool(self.named) and not set(self.right).isdisjoint(self.named[0])

    @property
    def wrong(self) -> bool:
        """Whether something was named that is not there, nor anything it cannot be told from."""
        true = {*self.right, *self.parts}
        return any(true.isdisjoint(rivals) for rivals in self.named)


def judged_naming(data: DataSet) -> Naming:
    """Diagnose a data set, and say what would have been right."""
    recorded = data.recorded
    start = time.process_time()
    found = diagnose(
        recorded.q, recorded.tau, directions=recorded.directions, torque_noise=data.stated
    )
    seconds = time.process_time() - start
    named = tuple(
        tuple((str(kind), None if joint is None else int(joint)) for kind, joint in cause.rivals)
        for cause in found.causes
    )
    n = recorded.q.shape[1]
    parts = (
        tuple(("gain", joint) for joint in range(n))
        if data.contamination.kind is Contaminant.AMPERES
        else ()
    )
    return Naming(named, right_names(data), parts, seconds)


def right_names(data: DataSet) -> tuple[Name, ...]:
    """Names of a contamination.

    Notes
    -----
    Friction from one side, and an offset where nothing says from which side poses were reached,
    are one thing. So are gains (and signs) of two joints where no recording at these poses could
    tell them apart: only ratios of gains of coupled joints can be seen.
    """
    found = data.contamination
    if found.kind not in WORDS:
        return ()
    names: list[Name] = [(WORDS[found.kind], found.joint)]
    if found.kind in (Contaminant.OFFSET, Contaminant.ONE_SIDED) and not found.recorded_directions:
        names = [("offset", found.joint), ("friction", found.joint)]
    if found.kind in (Contaminant.GAIN, Contaminant.SIGN, Contaminant.AMPERES):
        names += _other_gains(data)
    return tuple(names)


def _other_gains(data: DataSet) -> list[Name]:
    """Gains of single joints that differ from a gain too little to be seen."""
    found = data.contamination
    kind = Contaminant.GAIN if found.kind is Contaminant.AMPERES else found.kind
    effect = found.effect(data.noise)
    others: list[Name] = []
    for joint in range(found.arm.n):
        other = Contamination.drawn(
            found.arm, kind, found.q, np.random.default_rng(0), joint=joint
        ).effect(data.noise)
        size = np.linalg.norm(other)
        if joint == found.joint or not size:
            continue
        rest = effect - other * (other @ effect) / size**2
        if abs(data.size) * np.linalg.norm(rest) < ALIKE:
            others.append((WORDS[Contaminant(str(kind))], joint))
    return others
