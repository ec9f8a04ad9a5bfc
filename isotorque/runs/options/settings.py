"""Settings of discovery, exploration, scheme and learner, chosen by name: ``--set NAME=VALUE``."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Self

from isotorque.learning.discovery.torque_profile_discovery import DiscoverySettings
from isotorque.learning.exploration.settings import ExplorationSettings
from isotorque.learning.learners.registry import LearningTask, check_learner, learner_by_name
from isotorque.learning.scheme import SchemeSettings
from isotorque.symbolic.common.errors import InputError

SYMBOLS = {
    "n_pr": "discovery.profiles_per_torque",
    "epsilon": "exploration.step_width",
    "sigma": "exploration.noise",
    "p_home": "exploration.home_probability",
    "phi": "exploration.turn_angle",
    "e_max": "exploration.target_error",
    "from_trajectories": "scheme.from_trajectories",
    "d": "learner.radius",
    "kappa": "learner.kernel_width",
    "eta": "learner.learning_rate",
}
"""The paper's symbols, and what they are called here."""
SCHEME_BY_OPTION = (
    "discovery",
    "exploration",
    "n_min",
    "samples",
    "strategy",
    "confirm",
    "guided",
    "parents",
)
SECTIONS = (
    ("discovery", DiscoverySettings, ("profile",)),
    ("exploration", ExplorationSettings, ()),
    # other options stand for the rest
    ("scheme", SchemeSettings, SCHEME_BY_OPTION),
)
DECIDED = ("group", "random_state", "robot")
"""Parameters of learners that relations, seed and robot decide."""
WORDS = {"none": None, "yes": True, "true": True, "no": False, "false": False}


class Kind(NamedTuple):
    """Kind of value: its name in an annotation, the values that are of it, and how it is said."""

    name: str
    fits: Callable[[Any], bool]
    said: str


KINDS = (
    Kind("bool", lambda value: isinstance(value, bool), "yes or no"),
    Kind("int", lambda value: type(value) is int, "a whole number"),
    Kind("float", lambda value: type(value) in (int, float), "a number"),
    Kind("tuple", lambda value: isinstance(value, tuple), "numbers with commas"),
    Kind("str", lambda value: isinstance(value, str), "a word"),
    Kind("None", lambda value: value is None, "none"),
)


@dataclass(frozen=True)
class Settings:
    """Settings that differ from their defaults.

    Attributes
    ----------
    values : tuple of (str, value)
        ``section.name`` and value, by name; sections are discovery, exploration, scheme, learner.

    Examples
    --------
    >>> chosen = Settings.of(["epsilon=0.2", "learner.replay=20"])
    >>> chosen.exploration.step_width, chosen.learner
    (0.2, {'replay': 20})
    >>> chosen.words
    ('exploration.step_width=0.2', 'learner.replay=20')
    """

    values: tuple[tuple[str, Any], ...] = ()

    @classmethod
    def of(cls, words: Sequence[str]) -> Self:
        """Read ``NAME=VALUE`` words; learners' parameters are checked by `check_learner_settings`.

        Raises
        ------
        InputError
            For a name or a value that there is not.
        """
        found: dict[str, Any] = {}
        for word in words:
            name, equals, text = word.partition("=")
            name = SYMBOLS.get(name.strip(), name.strip())
            if not equals:
                raise InputError("command line", "--set", word, "NAME=VALUE")
            if name in found:
                raise InputError("command line", "--set", word, f"{name} once")
            found[name] = _value(text.strip())
        chosen = cls(tuple(sorted(found.items())))
        chosen._check()
        return chosen

    def section(self, name: str) -> dict[str, Any]:
        """Return the settings of one section, by their names in it."""
        inside = ((key.partition("."), value) for key, value in self.values)
        return {key[2]: value for key, value in inside if key[0] == name}

    @property
    def discovery(self) -> DiscoverySettings:
        """Settings of the discovery."""
        return replace(DiscoverySettings(), **self.section("discovery"))

    @property
    def exploration(self) -> ExplorationSettings:
        """Settings of the exploration."""
        return replace(ExplorationSettings(), **self.section("exploration"))

    @property
    def scheme(self) -> dict[str, Any]:
        """Settings of the scheme."""
        return self.section("scheme")

    @property
    def learner(self) -> dict[str, Any]:
        """Parameters of the learner that is named."""
        return self.section("learner")

    @property
    def words(self) -> tuple[str, ...]:
        """What `of` reads."""
        return tuple(f"{name}={_text(value)}" for name, value in self.values)

    def recorded(self, *sections: str) -> dict[str, Any]:
        """Return what a recording says of some sections: nothing where nothing was chosen."""
        said = {name: value for name, value in self.values if name.partition(".")[0] in sections}
        return {"settings": said} if said else {}

    def require_only(self, *sections: str) -> None:
        """Refuse settings of other sections, which would change nothing.

        Raises
        ------
        InputError
            For the first of them.
        """
        for name, _ in self.values:
            if name.partition(".")[0] not in sections:
                accepted = " or ".join(f"{section}.NAME" for section in sections)
                raise InputError("command line", "--set", name, accepted)

    def joined(self, recorded: Mapping[str, Any]) -> Settings:
        """Return these and what a recording says of others; these have the last word."""
        return Settings(tuple(sorted((dict(recorded) | dict(self.values)).items())))

    def _check(self) -> None:
        known = {
            f"{section}.{name}": kind
            for section, settings, left_out in SECTIONS
            for name, kind in _kinds(settings).items()
            if name not in left_out
        }
        for name, value in self.values:
            if name.startswith("learner."):
                continue
            if name not in known:
                accepted = ", ".join((*SYMBOLS, *known, "learner.NAME"))
                raise InputError("command line", "--set", name, accepted)
            _check_kind(name, value, known[name])
        replace(SchemeSettings(), **self.scheme)
        _ = self.discovery, self.exploration


def check_learner_settings(learner: str, chosen: Mapping[str, Any], task: LearningTask) -> None:
    """Refuse a learner that there is not, and parameters that it has not or does not accept.

    Raises
    ------
    InputError
        Naming the parameters that there are.
    """
    check_learner(learner)
    if not chosen:
        return
    fresh = learner_by_name(learner, None, replace(task, parameters={}))
    known = {k: v for k, v in _kinds(type(fresh).__init__).items() if k not in DECIDED}
    for name, value in chosen.items():
        if name not in known:
            accepted = ", ".join(f"learner.{each}" for each in known)
            raise InputError("command line", "--set", f"learner.{name}", f"{accepted} ({learner})")
        _check_kind(f"learner.{name}", value, known[name])
    learner_by_name(learner, None, replace(task, parameters=chosen))


def _kinds(of: Any) -> dict[str, str]:
    """Annotations of the parameters of a settings class, or of a learner's constructor."""
    there = inspect.signature(of).parameters
    return {name: str(each.annotation) for name, each in there.items() if name != "self"}


def _check_kind(name: str, value: Any, annotation: str) -> None:
    kinds = [kind for kind in KINDS if kind.name in annotation]
    if kinds and not any(kind.fits(value) for kind in kinds):
        accepted = " or ".join(kind.said for kind in kinds)
        raise InputError("command line", f"--set {name}", _text(value), accepted)


def _value(text: str) -> Any:
    """Read a number, numbers with commas, yes, no, none, or a word.

    Examples
    --------
    >>> [_value(text) for text in ("3", "0.5", "1,2.5", "none", "yes", "auto")]
    [3, 0.5, (1, 2.5), None, True, 'auto']
    """
    if text.lower() in WORDS:
        return WORDS[text.lower()]
    if "," in text:
        return tuple(_value(part.strip()) for part in text.split(","))
    for read in (int, float):
        try:
            return read(text)
        except ValueError:
            continue
    return text


def _text(value: Any) -> str:
    if isinstance(value, tuple | list):
        return ",".join(_text(each) for each in value)
    if value is None or isinstance(value, bool):
        return {None: "none", True: "yes", False: "no"}[value]
    return str(value)
