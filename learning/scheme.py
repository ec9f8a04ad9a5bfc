"""The general scheme: discover symmetries, learn the static torques, learn the model (Fig. 8)."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.arm import Outcome, OutcomeKind, Playback, ProfileArm
from isotorque.learning.discovery.home_torque import Search, find_home_torque, measure_home_torque
from isotorque.learning.discovery.motor_babbling import DOUBLED, GROWTH, STEPS, babble
from isotorque.learning.discovery.telling_torques import TellingTorques
from isotorque.learning.discovery.torque_profile_discovery import (
    DiscoverySettings,
    choose_target,
    discover,
    lead,
)
from isotorque.learning.exploration.central_domain import central_domain
from isotorque.learning.exploration.exploration import Exploration, ExplorationStep, Learner
from isotorque.learning.exploration.explored_share import ExploredShare
from isotorque.learning.exploration.registry import (
    DIRECTIONS,
    check_exploration,
    exploration_by_name,
)
from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.learners.rigid.chain_watch import ChainWatch
from isotorque.learning.relations.identification.chain_identification import relations_of_chain
from isotorque.learning.relations.identification.identify import SECOND_OPINION
from isotorque.learning.relations.learn_relations import learn_relations
from isotorque.learning.relations.learned_symmetries import LearnedSymmetries
from isotorque.learning.relations.next_sample import next_torque
from isotorque.learning.static_torques.static_torque_set import StaticTorqueSet
from isotorque.learning.static_torques.visited_torques import visited_torques
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup

Array = NDArray[np.float64]
DEFAULT_N_MIN = 2
SHARE_POINTS = 1000
"""Points of the BCTS that tell how much of it has been explored."""

LearnerFactory = Callable[[SymmetryGroup | None, Array], Learner]


@dataclass(frozen=True)
class SchemeSettings:
    """Settings of the whole scheme.

    Attributes
    ----------
    discovery : DiscoverySettings
        Torque profiles and babbling.
    exploration : ExplorationSettings
        The learning phase.
    strategy : str
        Which exploration it is, see `exploration_by_name`.
    n_min : int
        Relations needed before learning begins (n_min of section 5.4). With the default, an arm
        that is shown by a rigid chain to have none but the identity is not waited for.
    confirmations : int
        Target torques in a row that must leave the learned group as it is.
    max_targets : int
        Target torques at most; without enough relations by then the gate is not passed
        (`Scheme.gate_passed`), and whoever runs the scheme decides whether to learn all the same.
    samples : int
        Torques commanded while learning.
    confirm : int
        Torques at the end of the discovery, each chosen to say most about the relations.
    guided : bool
        Whether the arm can be placed and held from outside: its home torque is then measured, and
        an arm that would not stay there by itself is guided through its whole range, with
        ``arm.reach`` the limits (n, 2) [rad] it is guided within.
    parents : tuple of int or None
        Joint that carries each joint, -1 for the base; None: joints in series. Nothing else of
        the arm is told.
    from_trajectories : bool
        Whether the static torques of configurations passed by are admitted too, once the
        relations are known (`visited_torques`).
    """

    discovery: DiscoverySettings = field(default_factory=DiscoverySettings)
    exploration: ExplorationSettings = field(default_factory=ExplorationSettings)
    n_min: int = DEFAULT_N_MIN
    confirmations: int = 2
    max_targets: int = 12
    samples: int = 2000
    strategy: str = DIRECTIONS
    confirm: int = 0
    guided: bool = False
    parents: tuple[int, ...] | None = None
    from_trajectories: bool = False

    def __post_init__(self) -> None:
        check_exploration(self.strategy)
        positive = ("n_min", "max_targets", "samples")
        for name in (*positive, "confirmations", "confirm"):
            if getattr(self, name) < (least := int(name in positive)):
                raise InputError("scheme", name, getattr(self, name), f"at least {least}")


@dataclass(frozen=True, eq=False)
class Discovery:
    """One motion of the discovery phase.

    Attributes
    ----------
    target : (n,) array or None
        tau* of the torque profile [N m]; None while babbling.
    outcome : Outcome
        How the motion ended.
    playback : Playback or None
        The profile and its joint trajectory.
    new : bool
        Whether a configuration was seen for the first time for this |tau*|.
    """

    target: Array | None
    outcome: Outcome
    playback: Playback | None
    new: bool


_Motions = Generator[Discovery, None, Array | None]


@dataclass(frozen=True, eq=False)
class GateDecision:
    """Knowledge after a target torque, and whether it suffices to begin learning."""

    targets: int
    order: int
    passed: bool
    missing: str | None


class Scheme:
    """The run of Fig. 8 on any arm that can play torque profiles.

    Parameters
    ----------
    arm : ProfileArm
        Nothing else is known of the robot.
    rng : numpy.random.Generator
        Source of randomness.
    make_learner : callable
        ``make_learner(group, torque_range)`` returns a fresh learner that exploits ``group``
        (None: no symmetries).
    settings : SchemeSettings
        Numbers.
    group : SymmetryGroup or None
        Relations to use instead of learned ones (for comparisons); ``use_symmetries`` False: none.

    Attributes
    ----------
    learned : LearnedSymmetries or None
        What is known of the symmetries.
    static_torques : StaticTorqueSet
        The estimate of the SST.
    domain : FundamentalDomain or None
        The estimate of the BCTS, where the arm has settled and away from its limits.
    learner : Learner or None
        The inverse statics model.
    chain : ChainWatch
        The rigid chain behind everything that has settled, if there is one.
    home_torque : (n,) array or None
        Torque about which the first ones are commanded [N m]; None where the arm was found not to
        hold itself.
    """

    def __init__(
        self,
        arm: ProfileArm,
        rng: np.random.Generator,
        make_learner: LearnerFactory,
        settings: SchemeSettings | None = None,
        *,
        group: SymmetryGroup | None = None,
        use_symmetries: bool = True,
    ) -> None:
        self.arm, self.rng = arm, rng
        self.settings = settings if settings is not None else SchemeSettings()
        self.home = np.array(arm.q, dtype=float)
        self.static_torques = StaticTorqueSet(len(self.home))
        self.chain = ChainWatch(len(self.home), self.settings.parents)
        self.learned: LearnedSymmetries | None = None
        self.domain: FundamentalDomain | None = None
        self.learner: Learner | None = None
        self.home_torque: Array | None = None
        self.gates: list[GateDecision] = []
        self.targets: list[Array] = []
        self.exploration: Exploration | None = None
        self.make_learner = make_learner
        self._given, self._use = group, use_symmetries
        self._telling = TellingTorques(self.chain, self.static_torques, self.home, rng)
        self._seen: list[Array] = []
        self._trajectories: list[Array] = []
        self._settled_q: list[Array] = []
        self._settled_torque: list[Array] = []

    # -- what has been seen ---------------------------------------------------------------------

    @property
    def samples(self) -> tuple[Array, Array]:
        """Settled configurations and torques of the discovery, shapes (m, n) [rad], [N m]."""
        n = len(self.home)
        return (
            np.array(self._settled_q).reshape(-1, n),
            np.array(self._settled_torque).reshape(-1, n),
        )

    @property
    def torque_range(self) -> Array:
        """Largest torque held at each joint [N m], shape (n,); zero for joints without gravity."""
        _, torques = self.samples
        return self._range_about(np.zeros(torques.shape[1]))

    def _range_about(self, centre: Array) -> Array:
        """Largest difference of a held torque from ``centre`` at each joint [N m], (n,)."""
        _, torques = self.samples
        largest = np.abs(torques - centre).max(axis=0, initial=0.0)
        # joints that could not hold the smallest torque tried: gravity does not reach them
        return np.where(largest > 1e-9 * largest.max(initial=0.0), largest, 0.0)

    @property
    def group(self) -> SymmetryGroup | None:
        """The relations in use; None where symmetries are not exploited."""
        if not self._use:
            return None
        if self._given is not None:
            return self._given
        return None if self.learned is None else self.learned.group

    @property
    def gate_passed(self) -> bool:
        """Whether enough relations are known to begin learning; also where none are asked for."""
        if not self._use or self._given is not None:
            return True
        return bool(self.gates) and self.gates[-1].passed

    def _take(self, outcome: Outcome) -> None:
        self._seen.append(np.array(outcome.q))
        if outcome.kind is OutcomeKind.SETTLED:
            self.static_torques.add(outcome.torque)
            self._settled_q.append(np.array(outcome.q))
            self._settled_torque.append(np.array(outcome.torque))
            self.chain.add(outcome.q, outcome.torque)
        else:
            self.static_torques.mark_inadmissible(outcome.torque)

    # -- the two phases -------------------------------------------------------------------------

    def discover(self) -> Iterator[Discovery]:
        """Babble, then play torque profiles until enough relations are known; confirm them.

        Yields
        ------
        Discovery
            Every motion. After each target torque the relations are learned anew and the gate
            ``n_sym >= n_min`` is asked; ``gates`` keeps the answers.
        """
        settings = self.settings.discovery
        self.arm.go_home()
        babbling = babble(
            self.arm,
            self.rng,
            settings.babbling,
            self._search(),
            self._wanted,
            always=self.settings.guided,
            most_wanted=settings.telling or STEPS,
            growth=GROWTH if settings.telling else DOUBLED,
        )
        self.home_torque = yield from self._taken(babbling)
        self.arm.go_home()
        if self.home_torque is None:
            if self.settings.guided:
                yield from self._lead()
            return
        for _ in range(self.settings.max_targets):
            _, torques = self.samples
            target = choose_target(torques, self.rng, settings.away_from_zero, self.targets)
            if target is None:
                break
            self.targets.append(target)
            about, spread = self.home_torque, self._range_about(self.home_torque)
            for played in discover(self.arm, target, spread, self.rng, settings, centre=about):
                self._take(played.playback.outcome)
                self._trajectories.append(np.asarray(played.playback.q))
                yield Discovery(target, played.playback.outcome, played.playback, played.new)
            if self._gate():
                break
        yield from self._confirm()
        self._take_trajectories()

    def _search(self) -> Callable[[ProfileArm], Search]:
        if self.settings.guided:
            return lambda arm: measure_home_torque(arm, self.rng)
        return find_home_torque

    def _taken(self, motions: Generator[Outcome, None, Array | None]) -> _Motions:
        """Take every outcome in; return what the motions return."""
        while True:
            try:
                outcome = next(motions)
            except StopIteration as end:
                return None if end.value is None else np.asarray(end.value)
            self._take(outcome)
            yield Discovery(None, outcome, None, outcome.kind is OutcomeKind.SETTLED)

    def _wanted(self, centre: Array, scale: Array) -> Array | None:
        """Torque that a chain lacks, once the torque scale of every joint is known."""
        self.chain.unloaded = scale == 0.0
        if self.settings.discovery.telling:
            return self._telling(centre, scale)
        if self._many_joints and self.chain.learner is None:
            return self._telling.at_random(centre, scale)
        return None

    def _lead(self) -> Iterator[Discovery]:
        """Lead the arm about until its samples show the relations."""
        arm: Any = self.arm
        settings = self.settings.discovery
        for batch in range(1 + self.settings.max_targets):
            count = settings.guided_places if batch else settings.babbling
            for outcome in lead(arm, arm.reach, self.rng, count):
                self._take(outcome)
                yield Discovery(None, outcome, None, True)
            if self._gate():
                break

    def _take_trajectories(self) -> None:
        """Admit the torques that would have held the arm where it passed by."""
        known = self.learned
        if not self.settings.from_trajectories or known is None or not known.decided:
            return
        fit = known.fit if known.chain is None else known.chain.snapped().chain
        if fit is not None:
            for trajectory in self._trajectories:
                self.static_torques.add(visited_torques(fit, trajectory))

    def _confirm(self) -> Iterator[Discovery]:
        """Command the torques that say most about the relations; ask the gate again."""
        orders: list[int] = []
        for _ in range(self.settings.confirm):
            q, _ = self.samples
            wanted = None if self.learned is None else next_torque(self.learned, q, self.rng)
            if wanted is None:
                break
            outcome = self.arm.apply(wanted.torque)
            self._take(outcome)
            yield Discovery(None, outcome, None, outcome.kind is OutcomeKind.SETTLED)
            self.learned = self.relations(*self.samples)
            orders.append(self.learned.order)
        if self.learned is not None and orders:  # they may confirm, or contradict
            order, decided = self.learned.order, self.learned.decided
            unchanged = len(orders) >= self.settings.confirmations and set(orders) == {order}
            confirmed = unchanged or bool(self.gates and self.gates[-1].passed)
            passed = decided and self._enough(order) and confirmed
            missing = self.learned.missing
            self.gates.append(GateDecision(len(self.targets), order, passed, missing))

    def _gate(self) -> bool:
        """Learn the relations from all settled samples; say whether they suffice."""
        self.learned = self.relations(*self.samples)
        order, decided = self.learned.order, self.learned.decided
        recent = [g.order for g in self.gates[-self.settings.confirmations :]]
        confirmed = len(recent) >= self.settings.confirmations and all(o == order for o in recent)
        passed = decided and self._enough(order) and confirmed
        sure = self.learned.chain is not None and self._many_joints
        if self.settings.confirmations == 0 or sure:
            passed = decided and self._enough(order)
        asked = len(self.targets) or len(self.gates) + 1
        self.gates.append(GateDecision(asked, order, passed, self.learned.missing))
        return passed

    def _enough(self, order: int) -> bool:
        """Whether relations suffice to begin; fewer do if a chain shows that there are no more.

        Asked for more than the default, an arm is waited for in vain, as it was asked for.
        """
        if order >= self.settings.n_min:
            return True
        return self.settings.n_min <= DEFAULT_N_MIN and self.chain.confirmed is not None

    def relations(self, q: Array, torque: Array) -> LearnedSymmetries:
        """Learn the relations from static samples (m, n) [rad], (m, n) [N m].

        Where joints are many, a chain that later samples have confirmed tells them.
        """
        if self._many_joints and self.chain.confirmed is not None:
            known = self.chain.knowledge().learner
            by_chain = None if known is None else relations_of_chain(known)
            if by_chain is not None and by_chain.decided:
                return by_chain
        return learn_relations(q, torque, parents=self.settings.parents)

    @property
    def _many_joints(self) -> bool:
        return len(self.home) > SECOND_OPINION

    def learn(self) -> Iterator[ExplorationStep]:
        """Explore within the BCTS and learn online.

        Yields
        ------
        ExplorationStep
            Every commanded torque.
        """
        group = self.group
        explored = None
        if group is not None:
            q, _ = self.samples
            self.domain = central_domain(group, q, np.array(self._seen or [self.home]))
            points = self.domain.sample(np.random.default_rng(0), SHARE_POINTS)
            explored = ExploredShare(points, self.settings.exploration.step_width, group)
        self.learner = self.make_learner(group, self.torque_range)
        about = {} if self.home_torque is None else {"home_torque": self.home_torque}
        self.exploration = exploration_by_name(
            self.settings.strategy,
            self.arm,
            self.learner,
            self.rng,
            domain=self.domain,
            seen=np.array(self._seen or [self.home]),
            torque_range=self.torque_range,
            static_torques=self.static_torques,
            settings=self.settings.exploration,
            explored=explored,
            **about,
        )
        for step in self.exploration.steps(self.settings.samples):
            if step.outcome.kind is OutcomeKind.SETTLED:
                self.chain.add(step.outcome.q, step.outcome.torque)
            yield step
