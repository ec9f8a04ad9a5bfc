"""Parts of a run's report from what the scheme yields and keeps."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import OutcomeKind
from isotorque.learning.exploration.exploration import ExplorationStep
from isotorque.learning.scheme import Discovery, GateDecision
from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet
from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.verify.report.figures.torques import ProfileTrace
from isotorque.verify.report.report_sections import (
    DiscoveryReport,
    DomainReport,
    ExplorationReport,
    Gate,
    StaticTorqueReport,
)

Array = NDArray[np.float64]

MOST_POINTS = 4000
"""Configurations and torques kept for pictures; beyond, every so many-th."""

MOST_IMAGES = 16000
"""Symmetric configurations kept for pictures."""

MOST_TIMES = 300
"""Points in time kept of each torque profile."""

TRACES = 5
"""Torque profiles shown in the pictures."""


def summarise_discovery(
    motions: Sequence[Discovery],
    gates: Sequence[GateDecision],
    n_min: int,
    *,
    learned_anyway: bool = False,
    needs_gate: bool = True,
) -> DiscoveryReport:
    """Summarise symmetry discovery.

    Parameters
    ----------
    motions
        Everything ``Scheme.discover`` yielded.
    gates
        ``Scheme.gates``.
    n_min
        Relations that were needed.
    learned_anyway, needs_gate
        As in `DiscoveryReport`.
    """
    profiles = [motion for motion in motions if motion.playback is not None]
    ends = Counter(motion.outcome.kind for motion in motions)
    targets: list[Array] = []
    discovered: list[int] = []
    for motion in profiles:
        if motion.target is None:
            continue
        if not targets or not np.array_equal(targets[-1], motion.target):
            targets.append(motion.target)
            discovered.append(0)
        discovered[-1] += int(motion.new)
    n = len(motions[0].outcome.q) if motions else 0
    return DiscoveryReport(
        targets=np.array(targets).reshape(len(targets), n),
        discovered=np.array(discovered, dtype=np.int64),
        profiles=len(profiles),
        babbling=len(motions) - len(profiles),
        settled=ends[OutcomeKind.SETTLED],
        limit_hits=ends[OutcomeKind.LIMIT],
        timeouts=ends[OutcomeKind.TIMEOUT],
        n_min=n_min,
        gates=tuple(Gate(g.targets, g.order, g.passed, g.missing or "") for g in gates),
        traces=_traces(profiles),
        learned_anyway=learned_anyway,
        needs_gate=needs_gate,
    )


def _traces(profiles: Sequence[Discovery]) -> tuple[ProfileTrace, ...]:
    """Return the first profiles of the target torque that discovered most."""
    by_target: dict[bytes, list[Discovery]] = {}
    for motion in profiles:
        if motion.target is not None:
            by_target.setdefault(motion.target.tobytes(), []).append(motion)
    if not by_target:
        return ()
    best = max(by_target.values(), key=lambda motions: sum(m.new for m in motions))
    traces = []
    for motion in best[:TRACES]:
        played = motion.playback
        if played is not None and len(played.times):
            kept = np.unique(np.linspace(0, len(played.times) - 1, MOST_TIMES).astype(int))
            times = played.times[kept] - played.times[0]
            end = motion.outcome
            traces.append(
                ProfileTrace(times, played.torques[kept], played.q[kept], str(end.kind), end.q)
            )
    return tuple(traces)


def summarise_static_torques(estimate: StaticTorqueSet) -> StaticTorqueReport:
    """Summarise the estimated set of static torques."""
    triangles = None
    if estimate.n == 2 and len(estimate.torques) > 2 and bool(np.all(estimate.active)):
        corners, simplices = estimate.region()
        triangles = corners[simplices] if len(simplices) else None
    return StaticTorqueReport(thinned(estimate.torques), thinned(estimate.inadmissible), triangles)


def summarise_domain(domain: FundamentalDomain) -> DomainReport:
    """Summarise a fundamental domain; with a picture where it is a polygon of two joints."""
    group = domain.group
    polygon = images = None
    if group.n == 2 and group.rank == 2:
        polygon = np.linalg.solve(group.basis.astype(float), domain.vertices.T).T
        images = group.orbit(polygon)
    return DomainReport(
        basis=np.asarray(domain.basis),
        halfspaces=domain.halfspaces,
        vertices=domain.vertices,
        volume=domain.volume,
        order=domain.order,
        center=domain.center,
        polygon=polygon,
        images=images,
    )


def summarise_exploration(
    steps: Sequence[ExplorationStep], group: SymmetryGroup | None, radius: float | None = None
) -> ExplorationReport:
    """Summarise an exploration.

    Parameters
    ----------
    steps
        Every step taken.
    group
        The symmetries that were exploited, None for none.
    radius
        Within which a configuration counts as explored [rad].
    """
    ends = Counter(step.outcome.kind for step in steps)
    n = len(steps[0].torque) if steps else 0
    learned = [step.outcome.q for step in steps if step.learned]
    seen = np.array(learned).reshape(len(learned), n)
    shares = [step.explored for step in steps if step.explored is not None]
    images = np.zeros((0, n))
    if group is not None and learned:
        images = wrap(group.orbit(seen)[1:]).reshape(-1, n)  # the first is the identity
    return ExplorationReport(
        explored=thinned(seen),
        images=thinned(images, MOST_IMAGES),
        commands=len(steps),
        settled=ends[OutcomeKind.SETTLED],
        limit_hits=ends[OutcomeKind.LIMIT],
        timeouts=ends[OutcomeKind.TIMEOUT],
        projected=sum(step.projected for step in steps),
        explored_share=shares[-1] if shares else None,
        explored_radius=radius if shares else None,
    )


def thinned(values: Array, most: int = MOST_POINTS) -> Array:
    """Return at most ``most`` rows, evenly spaced in their order.

    Examples
    --------
    >>> thinned(np.arange(10.0)[:, None], 4).ravel().tolist()
    [0.0, 3.0, 6.0, 9.0]
    """
    rows = np.asarray(values, dtype=float)
    if len(rows) <= most:
        return rows
    return np.asarray(rows[np.linspace(0, len(rows) - 1, most).astype(int)])
