"""Locked joints of a robot and their angles, and what is said of joints that cannot move."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.robot_options import RobotOptions
from isotorque.symbolic.robots.urdf.urdf_elements import REVOLUTE, Mimic

AT_NEUTRAL_ONLY = ("planar", "floating")
"""Joints of several numbers: they can be locked where they are drawn, nowhere else."""


@dataclass(frozen=True)
class JointOfRobot:
    """Joint as locking needs it.

    Attributes
    ----------
    name, kind : str
        Name and kind; `REVOLUTE` ones can move.
    above : frozenset of str
        The joints between the root and this one, of any kind that moves.
    lower, upper : float or None
        Limits [rad or m]; None where there are none.
    mimic : Mimic or None
        The joint that it follows.
    """

    name: str
    kind: str
    above: frozenset[str] = frozenset()
    lower: float | None = None
    upper: float | None = None
    mimic: Mimic | None = None

    @property
    def can_move(self) -> bool:
        """Whether it turns, and by itself."""
        return self.kind in REVOLUTE and self.mimic is None

    @property
    def rest(self) -> float:
        """Where it is locked if nothing is said: at 0, or at the nearest place within its limits.

        Examples
        --------
        >>> JointOfRobot("elbow", "revolute", lower=-2.6, upper=-0.1).rest
        -0.1
        """
        if self.kind not in ("revolute", "prismatic") or None in (self.lower, self.upper):
            return 0.0
        lower, upper = float(self.lower or 0.0), float(self.upper or 0.0)
        return min(max(0.0, lower), upper) if lower <= upper else 0.0


def locked_positions(
    joints: Sequence[JointOfRobot],
    options: RobotOptions,
    carriers: Callable[[str], Collection[str]],
    where: str,
) -> dict[str, float]:
    """Return the joints that stand still, and where [rad or m].

    Parameters
    ----------
    joints
        All joints of the robot that are not fixed.
    options
        ``lock``, ``joints`` and ``tip``: a joint stands still for any of these reasons.
    carriers
        Called with the name of a link; returns the joints between the root and that link.
    where
        What to call the robot in an error.

    Returns
    -------
    dict
        A joint that follows a locked one stands still too, where that one puts it unless the
        options say otherwise.

    Raises
    ------
    InputError
        For names that match no joint or link, joints that are both to move and to be locked,
        positions of joints that have none, and joints left over that cannot move; all of the
        latter are named, with the option that would work.

    Examples
    --------
    >>> arm = [JointOfRobot("j1", "revolute"), JointOfRobot("grip", "prismatic", lower=0.01,
    ...     upper=0.04)]
    >>> locked_positions(arm, RobotOptions("a.urdf", lock=["g*"]), lambda link: (), "a.urdf")
    {'grip': 0.01}
    >>> locked_positions(arm, RobotOptions("a.urdf"), lambda link: (), "a.urdf")
    Traceback (most recent call last):
    isotorque.InputError: a.urdf: kind of joint 'grip' (prismatic) is neither revolute nor
    continuous; accepted: other kinds where they are locked: --lock grip
    """
    known = {joint.name: joint for joint in joints}
    chosen: dict[str, float | None] = {}
    for pattern, position in options.lock:
        for name in _matching(pattern, known, "--lock", where):
            chosen[name] = position
    if options.joints is not None:
        wanted: set[str] = set()
        for pattern in options.joints:
            wanted.update(_matching(pattern, known, "--joints", where))
        _refuse_both(wanted, chosen, "--lock", where)
        chosen |= {name: None for name in known if name not in wanted and name not in chosen}
    if options.tip is not None:
        chain = set(carriers(options.tip))
        if options.joints is not None:
            _refuse_both(wanted, known.keys() - chain, f"--tip {options.tip}", where)
        chosen |= {name: None for name in known if name not in chain and name not in chosen}
    for name, position in chosen.items():
        if position and known[name].kind in AT_NEUTRAL_ONLY:
            accepted = f"--lock {shlex.quote(name)}, where the file draws it"
            raise InputError(
                where, f"position of {known[name].kind} joint '{name}'", position, accepted
            )
    positions = _with_followers(known, chosen)
    _check_the_rest(known, positions, options, where)
    return positions


def _matching(pattern: str, known: Collection[str], option: str, where: str) -> list[str]:
    """Return the joint of that name, or those that match it as a glob."""
    if pattern in known:
        return [pattern]
    found = [name for name in known if fnmatchcase(name, pattern)]
    if not found:
        accepted = f"names or globs of moving joints: {', '.join(known)}"
        raise InputError(where, option, repr(pattern), accepted)
    return found


def _refuse_both(wanted: Iterable[str], locked: Collection[str], option: str, where: str) -> None:
    for name in wanted:
        if name in locked:
            accepted = f"a joint that is not locked by {option}"
            raise InputError(where, "--joints", repr(name), accepted)


def _with_followers(
    known: dict[str, JointOfRobot], chosen: dict[str, float | None]
) -> dict[str, float]:
    """Give a position to every locked joint, and to all that follow one."""
    positions: dict[str, float] = {}

    def position(name: str, asked: frozenset[str] = frozenset()) -> float | None:
        if name in positions:
            return positions[name]
        joint, given = known[name], chosen.get(name)
        leader = None if joint.mimic is None else joint.mimic.joint
        if given is None and joint.mimic is not None and leader in known and name not in asked:
            there = position(joint.mimic.joint, asked | {name})
            if there is not None:
                given = joint.mimic.multiplier * there + joint.mimic.offset
        if given is None and name in chosen:
            given = joint.rest
        if given is not None:
            positions[name] = given
        return given

    for name in known:
        position(name)
    return {name: positions[name] for name in known if name in positions}


def _check_the_rest(
    known: dict[str, JointOfRobot], positions: dict[str, float], options: RobotOptions, where: str
) -> None:
    left = [joint for joint in known.values() if joint.name not in positions]
    able = [joint for joint in left if joint.can_move]
    refused = [joint for joint in left if not joint.can_move]
    if not left:
        found = "0, all are locked" if known else 0
        raise InputError(where, "number of moving joints", found, "at least one revolute joint")
    if not refused:
        return
    names = ", ".join(f"'{joint.name}' ({_why(joint)})" for joint in refused)
    field = f"kind of joint{'s' * (len(refused) > 1)} {names}"
    accepted = "revolute and continuous joints that follow no other"
    if able:
        accepted = "other kinds where they are locked: " + _advice(known, left, options)
    raise InputError(where, field, "neither revolute nor continuous", accepted)


def _why(joint: JointOfRobot) -> str:
    return joint.kind if joint.mimic is None else f"follows '{joint.mimic.joint}'"


def _advice(known: dict[str, JointOfRobot], left: list[JointOfRobot], options: RobotOptions) -> str:
    """Return options that lock all that cannot move, as on a command line."""
    if options.joints is not None:
        return "--joints " + shlex.quote(",".join(j.name for j in left if j.can_move))
    locked = _worth_locking(left)
    others = [joint.name for joint in left if joint.name not in locked and joint.can_move]
    return " ".join(f"--lock {shlex.quote(glob)}" for glob in globs(locked, others))


def _worth_locking(left: list[JointOfRobot]) -> list[str]:
    """Joints whose locking makes all others move: leaders of a gripper rather than followers."""
    names = {joint.name: joint for joint in left}
    able = [joint for joint in left if joint.can_move]
    leaders = {j.mimic.joint for j in left if j.mimic is not None and j.mimic.joint in names}
    arm = [joint for joint in able if joint.name not in leaders]
    locked: set[str] = set()
    for joint in left:
        if joint.can_move:
            continue
        leader = names.get(joint.mimic.joint) if joint.mimic is not None else None
        # a joint of a hand leads, with none of the arm beyond it: the whole hand stands still
        of_hand = leader is not None and not any(leader.name in j.above for j in arm)
        if leader is not None and (not leader.can_move or (of_hand and len(arm) > 1)):
            locked.add(leader.name)
        else:
            locked.add(joint.name)
    return [name for name in names if name in locked]


def globs(names: Sequence[str], others: Collection[str]) -> list[str]:
    """Return few patterns that match all names and none of the others.

    Examples
    --------
    >>> globs(["l_finger_1", "l_finger_2", "lift"], ["l_arm_1", "l_arm_2"])
    ['l_finger_*', 'lift']
    """
    left, out = list(names), []
    while left:
        best, covered = left[0], [left[0]]
        for pattern in dict.fromkeys(p for name in left for p in _patterns(name)):
            matched = [name for name in left if fnmatchcase(name, pattern)]
            if len(matched) > len(covered) and not any(fnmatchcase(x, pattern) for x in others):
                best, covered = pattern, matched
        out.append(best)
        left = [name for name in left if name not in covered]
    return out


def _patterns(name: str) -> list[str]:
    """Globs made of words of a name, the most telling first."""
    words = name.split("_")
    n = len(words)
    runs = [(i, j) for size in range(n, 0, -1) for i in range(n - size + 1) for j in [i + size]]
    out = []
    for i, j in runs:
        before, after = "*_" if i else "", "_*" if j < n else ""
        out.append(before + "_".join(words[i:j]) + after)
        if j == n:  # the words alone, or with a number or more behind
            out.append(before + "_".join(words[i:j]).rstrip("0123456789") + "*")
    return [pattern for pattern in out if pattern.strip("*_")]
