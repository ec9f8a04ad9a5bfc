"""The parts of a run's report: one frozen record per part of the scheme."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isotorque.verify.report.figures.torques import ProfileTrace
from isotorque.verify.static_torques.judge_static_torques import StaticTorqueJudgement

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LevelSetReport:
    """All configurations of one absolute torque (Fig. 2).

    Attributes
    ----------
    torque : (n,) array
        The torque [N m].
    q : (m, n) array
        The configurations [rad].
    sets : (m,) int array
        Primary set of each, from 0.
    stable : (m,) bool array
        Whether the arm can hold itself there.
    curves : tuple of (component, sign, (p, 2) array)
        Component-wise level sets; two joints only.
    links : (m, joints + 1, 2) array or None
        Joints and tip in the plane of gravity, for stick figures [m].
    complete : bool
        Whether these are provably all, or "at least" these.
    """

    torque: Array
    q: Array
    sets: NDArray[np.int64]
    stable: NDArray[np.bool_]
    curves: tuple[tuple[int, int, Array], ...] = ()
    links: Array | None = None
    complete: bool = True


@dataclass(frozen=True)
class Gate:
    """Knowledge after a target torque (n_sym >= n_min of Fig. 8)."""

    targets: int
    order: int
    passed: bool
    missing: str = ""


@dataclass(frozen=True, eq=False)
class DiscoveryReport:
    """Course of symmetry discovery (Algorithm 1).

    Attributes
    ----------
    targets : (t, n) array
        Target torques tau* [N m].
    discovered : (t,) int array
        Different configurations settled in for each of them.
    profiles, babbling : int
        Torque profiles played; constant torques tried.
    settled, limit_hits, timeouts : int
        How these motions ended.
    n_min : int
        Relations needed before learning begins.
    gates : tuple of Gate
        What was known after each target torque.
    learned_anyway : bool
        Whether learning was to begin even if the last gate was not passed.
    needs_gate : bool
        Whether learning uses the relations discovered, and so waits for them.
    traces : tuple of ProfileTrace
        Profiles played for one target torque (Fig. 3 and 4).
    """

    targets: Array
    discovered: NDArray[np.int64]
    profiles: int
    babbling: int
    settled: int
    limit_hits: int
    timeouts: int
    n_min: int
    gates: tuple[Gate, ...] = ()
    traces: tuple[ProfileTrace, ...] = ()
    learned_anyway: bool = False
    needs_gate: bool = True

    @property
    def gate_passed(self) -> bool:
        """Whether enough relations were known in the end, where they are needed."""
        return not self.needs_gate or bool(self.gates and self.gates[-1].passed)


@dataclass(frozen=True)
class ChainReport:
    """Rigid chain that was looked for in everything that settled.

    Attributes
    ----------
    accepted : bool
        Whether one was, and is the model.
    said : str
        The learner's verdict; where none was accepted, why.
    poses : int
        Poses that differ, of all samples.
    known_after : int or None
        The fewest of them after which the chain found agrees with all that came later.
    later : int
        Samples that came later.
    largest_error : float
        Largest torque error of that chain in them [N m].
    exact : bool
        Whether that is rounding.
    told : str
        What the learner was told of the arm.
    instead : str
        Name of the learner that the model is of where no chain was accepted; empty for none.
    beside : str
        Name of the learner that learned beside an accepted chain; empty for none.
    beside_samples : int
        Samples it learned from.
    beside_rmse : float
        Its torque RMSE on the dense set in the end [N m].
    """

    accepted: bool
    said: str
    poses: int
    known_after: int | None
    later: int
    largest_error: float
    exact: bool
    told: str
    instead: str = ""
    beside: str = ""
    beside_samples: int = 0
    beside_rmse: float = math.nan

    @property
    def tried(self) -> str:
        """How the chain was tried, in words."""
        agree = "to rounding" if self.exact else f"within {self.largest_error:.2g} N m"
        return f"{self.later} later samples agree with it {agree}"


@dataclass(frozen=True, eq=False)
class StaticTorqueReport:
    """The estimated set of static torques (SST, Fig. 7).

    Attributes
    ----------
    admissible, inadmissible : (m, n), (k, n) arrays
        Torques the arm settled under, and those that drove it to a limit or a time out [N m].
    triangles : (t, 3, 2) array or None
        Corners of the estimated region [N m]; two joints only.
    discovered, judgement : StaticTorqueJudgement or None
        What the estimate has in common with the true set, after discovery and in the end; up to
        three joints. Exploration keeps to one domain and refuses torques that it could not reach
        there, so the second may be the smaller one.
    """

    admissible: Array
    inadmissible: Array
    triangles: Array | None = None
    discovered: StaticTorqueJudgement | None = None
    judgement: StaticTorqueJudgement | None = None


@dataclass(frozen=True, eq=False)
class DomainReport:
    """The domain explored (BCTS, Fig. 6).

    Attributes
    ----------
    basis : (r, n) int array
        B of the coordinates y = B q.
    halfspaces : (f, r + 1) array
        Rows [a.., b]: a . y <= b.
    vertices : (v, r) array
        Corners in y [rad].
    volume : float
        In y coordinates [rad^r].
    order : int
        By how much it is smaller than the whole space.
    center : (n,) array
        Its centre [rad].
    polygon : (v, 2) array or None
        Corners in (q1, q2) [rad], for two joints of full rank.
    images : (g, v, 2) array or None
        The same of its images under the group.
    """

    basis: NDArray[np.int64]
    halfspaces: Array
    vertices: Array
    volume: float
    order: int
    center: Array
    polygon: Array | None = None
    images: Array | None = None


@dataclass(frozen=True, eq=False)
class ExplorationReport:
    """Course of exploration (Algorithm 2, Fig. 10).

    Attributes
    ----------
    explored : (m, n) array
        Configurations learned from [rad] (evenly thinned where there were very many).
    images : (k, n) array
        Where they taught the torque by symmetry [rad] (likewise).
    commands, settled, limit_hits, timeouts : int
        Torques commanded and how they ended.
    projected : int
        Commands moved to the nearest static torque.
    explored_share : float or None
        Share of the domain within ``explored_radius`` of what was learned from, or of its copies.
    explored_radius : float or None
        In the metric of ``SymmetryCoordinates`` [rad].
    """

    explored: Array
    images: Array
    commands: int
    settled: int
    limit_hits: int
    timeouts: int
    projected: int = 0
    explored_share: float | None = None
    explored_radius: float | None = None
