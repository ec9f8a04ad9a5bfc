"""A model and its symmetries from a CSV file alone: no robot file, a rigid chain."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.files.csv_samples import joint_names_of, read_csv
from isotorque.learning.files.saved_models import SavedModel, load_model, save_model
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus
from isotorque.learning.learners.rigid.fitting.gains import GainGroup
from isotorque.learning.learners.rigid.fitting.known_load import gain_from_load
from isotorque.learning.learners.rigid.misread_samples import other_reading
from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.structure.chain_symmetries import ChainSymmetries
from isotorque.learning.statistics.causes.cause import Cause
from isotorque.learning.statistics.causes.cause_words import causes_in_words
from isotorque.learning.statistics.poses import by_pose_and_side
from isotorque.runs.from_data.model_choice import (
    RIGID,
    WITH_PROCESS,
    Contender,
    ModelChoice,
    choose_model,
)
from isotorque.runs.from_data.poses_to_take import poses_to_take
from isotorque.runs.stages import DATABASE
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.files import output_directory, write_whole
from isotorque.verify.relations.relation_files import relations_document

Array = NDArray[np.float64]

WITHOUT_ROBOT = (RIGID, WITH_PROCESS)
"""Learners that are told nothing but samples."""
MOST_LISTED = 64
"""Relations are listed up to this order, generators of larger groups."""


@dataclass(frozen=True)
class ChainDataOptions:
    """Options of learning a chain from a recording.

    Attributes
    ----------
    file : Path
        The CSV file; its header names the joints.
    torque_noise, angle_noise : float or None
        Standard deviations where known [N m], [rad].
    seed : int
        Of the random starts.
    learner : str or None
        ``rigid-chain``, or ``rigid-chain+gaussian-process`` for arms with cables and bending links;
        None: whichever errs less at poses left out.
    unknown_gains : bool
        Whether torques are in units of their own at every joint.
    known_gains : tuple of str
        ``JOINT=GAIN`` of those joints whose units are known.
    loaded : Path or None
        A second recording, with a known load on the link of a joint.
    known_load : str or None
        ``JOINT=NM``: that joint, and weight of the load times its distance from the axis.
    """

    file: Path
    torque_noise: float | None = None
    angle_noise: float | None = None
    seed: int = 0
    learner: str | None = None
    unknown_gains: bool = False
    known_gains: tuple[str, ...] = ()
    loaded: Path | None = None
    known_load: str | None = None

    def __post_init__(self) -> None:
        for option, value, other in (
            ("--loaded", self.loaded, self.known_load),
            ("--known-load", self.known_load, self.loaded),
        ):
            if value is not None and (other is None or not self.unknown_gains):
                accepted = "--loaded FILE.csv, --known-load JOINT=NM and --unknown-gains together"
                raise InputError("command line", option, str(value), accepted)
        if self.known_gains and not self.unknown_gains:
            value, accepted = " ".join(self.known_gains), "this together with --unknown-gains"
            raise InputError("command line", "--known-gain", value, accepted)
        if self.unknown_gains and self.learner == WITH_PROCESS:
            accepted = f"nothing with {WITH_PROCESS}, which takes gains as known"
            raise InputError("command line", "--unknown-gains", "given", accepted)
        if self.learner is not None and self.learner not in WITHOUT_ROBOT:
            accepted = f"{' or '.join(WITHOUT_ROBOT)}, which need no robot; or a ROBOT"
            raise InputError("command line", "--learner", self.learner, accepted)
        if self.learner == WITH_PROCESS and self.angle_noise:
            accepted = f"nothing with {WITH_PROCESS}, which takes angles as exact"
            raise InputError("command line", "--angle-noise", self.angle_noise, accepted)


@dataclass(frozen=True, eq=False)
class ChainFromData:
    """Chain learned from a recording, accepted or not.

    Attributes
    ----------
    options : ChainDataOptions
        What was asked for.
    joint_names : tuple of str
        As the header says.
    samples : StaticSamples
        The recording.
    learner : RigidChain or RigidChainProcess
        Fitted; ``verdict_`` says whether it may be used.
    symmetries : ChainSymmetries or None
        None where the chain was not accepted, and where it is not alone.
    other_reading : str or None
        What would make the samples those of a rigid chain, where they are none as they stand.
    choice : ModelChoice or None
        What was tried, unless a learner was named.
    """

    options: ChainDataOptions
    joint_names: tuple[str, ...]
    samples: StaticSamples
    learner: RigidChain | RigidChainProcess
    symmetries: ChainSymmetries | None
    other_reading: str | None = None
    choice: ModelChoice | None = None

    @property
    def name(self) -> str:
        """Of the learner."""
        return WITH_PROCESS if isinstance(self.learner, RigidChainProcess) else RIGID

    def save(self, out: Path) -> Path | None:
        """Write model and relations; None, and nothing, where the chain was not accepted."""
        if not self.learner.verdict_.accepted:
            return None
        content = hashlib.sha256(self.options.file.read_bytes()).hexdigest()
        notes = {
            "strategy": "data",
            "learner": self.name,
            "file": str(self.options.file),
            "verdict": str(self.learner.verdict_),
        }
        saved = SavedModel(self.learner, self.options.file.stem, content, self.joint_names, notes)
        path = save_model(saved, output_directory(out))
        if self.symmetries is not None:
            found = chain_relations(self.symmetries, self.joint_names, len(self.samples.q))
            write_relations(out, found)
        return path

    def document(self, model: Path | None) -> dict[str, Any]:
        """Return all there is to tell, for JSON."""
        learner, verdict = self.learner, self.learner.verdict_
        found: dict[str, Any] = {
            "joints": list(self.joint_names),
            "learner": self.name,
            "strategy": "data",
            "samples": len(self.samples.q),
            "poses": self.learner.n_samples_seen_,
            "verdict": str(verdict),
            "accepted": verdict.accepted,
            "missing": learner.remark_ or None,
            "explained_if": self.other_reading,
            "model": None if model is None else str(model),
        }
        still = self.constant_torques
        if still:
            found["constant_torques"] = {
                name: float(self.samples.tau[0, j]) + 0.0 for j, name in still
            }
        if isinstance(learner, RigidChain):
            next_poses = poses_to_take(learner.fit_, self.options.seed)
            if next_poses is not None:
                found |= {
                    "next_poses": next_poses.poses.tolist(),
                    "numbers_known": next_poses.known,
                    "numbers_of_a_chain": next_poses.numbers,
                }
            p_value = learner.fit_.p_value
            found |= {
                "starts": learner.fit_.starts,
                "p_value": None if np.isnan(p_value) else p_value,
            }
        if verdict.accepted:
            error = learner.standard_error(self._region(400))
            found |= {
                "standard_error": {
                    "region": self._box().T.tolist(),
                    "rms": float(np.sqrt(np.mean(error**2))),
                    "largest": float(error.max()),
                },
            }
        if isinstance(learner, RigidChainProcess) and verdict.accepted:
            found["process_share"] = learner.process_share_.tolist()
        causes = self.causes
        found |= {
            "beside_gravity": causes_in_words(causes, self.joint_names) or None,
            "causes": [self._cause(cause) for cause in causes],
        }
        if self.choice is not None:
            found |= choice_document(self.choice, self.joint_names)
        if isinstance(learner, RigidChain) and self.symmetries is not None:
            found |= {
                "torque_noise": learner.fit_.samples.torque_noise.tolist(),
                "relations": self.symmetries.group.order,
                "statement": self.symmetries.statement,
            }
            if learner.gain_groups_:
                gains = learner.chain_.gains
                found["gains"] = [self._gains(group, gains) for group in learner.gain_groups_]
        return found

    @property
    def causes(self) -> tuple[Cause, ...]:
        """What the samples show beside gravity."""
        if self.choice is not None:
            return self.choice.causes
        return tuple(getattr(self.learner, "causes_", ()))

    @property
    def constant_torques(self) -> list[tuple[int, str]]:
        """Joints whose torque is the same in all poses, though these differ: number and name."""
        if len(np.unique(self.samples.q, axis=0)) < 2:
            return []
        still = np.ptp(self.samples.tau, axis=0) == 0.0
        return [(j, name) for j, name in enumerate(self.joint_names) if still[j]]

    def _cause(self, cause: Cause) -> dict[str, Any]:
        """What is known of a cause beside gravity, joints by name."""
        found = cause.as_json()

        def name(joint: int | None) -> str | None:
            return None if joint is None else self.joint_names[joint]

        rivals = [[kind, name(joint)] for kind, joint in found["rivals"]]
        return found | {"joint": name(cause.joint), "rivals": rivals}

    def _gains(self, group: GainGroup, gains: Array) -> dict[str, Any]:
        """Return gains that are known relative to each other."""
        return {
            "gains": {self.joint_names[j]: float(gains[j]) for j in group.joints},
            "common_factor_known": group.scale_known,
        }

    def _box(self) -> Array:
        return np.array([self.samples.q.min(axis=0), self.samples.q.max(axis=0)])

    def _region(self, count: int) -> Array:
        """Configurations within the ranges of the recording."""
        low, high = self._box()
        return np.asarray(np.random.default_rng(0).uniform(low, high, (count, len(low))))


def gains_by_joint(
    texts: Sequence[str], joint_names: Sequence[str], option: str = "--known-gain"
) -> list[float | None]:
    """Known gains in the order of the joints, None for the others.

    Raises
    ------
    InputError
        For a text that is not ``JOINT=GAIN`` with a joint of the recording and a number other
        than 0, and for a joint that is named twice.

    Examples
    --------
    >>> gains_by_joint(["elbow=2.5"], ["shoulder", "elbow"])
    [None, 2.5]
    """
    gains: list[float | None] = [None] * len(joint_names)
    for text in texts:
        name, _, value = text.partition("=")
        try:
            gain = float(value)
        except ValueError:
            gain = 0.0
        if name not in joint_names or gain == 0.0 or not np.isfinite(gain):
            form = "JOINT=NM" if option == "--known-load" else "JOINT=GAIN"
            accepted = f"{form}, a number other than 0, one of {', '.join(joint_names)}"
            raise InputError("command line", option, text, accepted)
        place = list(joint_names).index(name)
        if gains[place] is not None:
            raise InputError("command line", option, text, f"one gain for {name}")
        gains[place] = gain
    return gains


def relations_of_saved_chain(out: Path) -> dict[str, Any] | None:
    """The relations of a directory in which a chain was learned without a robot, as a document.

    Returns
    -------
    dict or None
        None where there is no such model.
    """
    if (out / DATABASE).exists() or not (out / "model.json").is_file():
        return None
    saved = load_model(out)
    if isinstance(saved.learner, RigidChainProcess):
        accepted = f"a model that {RIGID} has learned: cables and springs share no symmetries"
        raise InputError(str(out), "learner", WITH_PROCESS, accepted)
    if not isinstance(saved.learner, RigidChain):
        return None
    return chain_relations(
        saved.learner.symmetries(), saved.joint_names, saved.learner.n_samples_seen_
    )


def chain_relations(
    symmetries: ChainSymmetries, joint_names: tuple[str, ...], samples: int
) -> dict[str, Any]:
    """The relations of a chain as a document."""
    group = symmetries.group
    many, extra = group.order > MOST_LISTED, None
    if symmetries.correction is not None:
        beside = {"correction": symmetries.correction.as_json()}
        extra = [beside] * len(group.generators if many else group.listed())
    return relations_document(group, joint_names, generators=many, extra=extra) | {
        "method": "rigid chain",
        "statement": symmetries.statement,
        "hypotheses": [str(h) for h in symmetries.snapped.hypotheses],
        "samples": samples,
    }


def write_relations(out: Path, document: dict[str, Any]) -> None:
    """Write a document to ``relations.json`` in a directory."""
    write_whole(out / "relations.json", json.dumps(document, indent=1, allow_nan=False) + "\n")


def chain_from_data(options: ChainDataOptions) -> ChainFromData:
    """Learn the statics of an arm from static samples and nothing else.

    Parameters
    ----------
    options
        The file, and noise levels where they are known.

    Raises
    ------
    InputError
        For a file that cannot be used.

    Notes
    -----
    Joints are in series in the order of their columns. Rows of one pose count as one sample.
    Constants and gains that the samples show beside gravity are fitted with the chain: left out,
    they would be taken for noise.
    """
    names = joint_names_of(options.file)
    samples = read_csv(options.file, names)
    _refuse_constant_torques(options.file, samples)
    if options.learner is None and not options.unknown_gains:
        return _chosen(options, names, samples)
    rows = np.ones(len(samples.q))
    q, tau, sides, _ = by_pose_and_side(samples.q, samples.tau, samples.directions, rows)
    stated = options.torque_noise is not None or options.angle_noise is not None

    if options.learner == WITH_PROCESS:
        process = RigidChainProcess(
            torque_noise=options.torque_noise, random_state=options.seed
        ).fit(q, tau)
        return ChainFromData(options, names, samples, process, None)

    known = gains_by_joint(options.known_gains, names) if options.unknown_gains else None
    load = _known_load(options, names)

    def fitted() -> RigidChain:
        alone = RigidChain(
            torque_noise=(options.torque_noise or 0.0) if stated else None,
            angle_noise=options.angle_noise or 0.0,
            unknown_gains=options.unknown_gains,
            known_gains=known,
            random_state=options.seed,
        ).fit(q, tau, directions=sides)
        return alone.with_causes() or alone

    learner = fitted()
    if learner.verdict_.accepted and load is not None and known is not None:
        joint, moment, loaded = load
        found = gain_from_load(
            learner.fit_,
            loaded.q,
            loaded.tau,
            joint,
            moment,
            str(options.loaded),
            learner.errors_.replicas,
        )
        known[joint] = found.gain
        learner = fitted()
    if learner.verdict_.accepted:
        return ChainFromData(options, names, samples, learner, learner.symmetries())
    reading = None
    if learner.verdict_ is FitStatus.MISFIT:
        reading = other_reading(learner, q, tau, names)
    return ChainFromData(options, names, samples, learner, None, reading)


def _chosen(
    options: ChainDataOptions, names: tuple[str, ...], samples: StaticSamples
) -> ChainFromData:
    """The model that errs least at poses left out; the chain, refused, where none can be used."""
    choice = choose_model(
        samples,
        torque_noise=options.torque_noise,
        angle_noise=options.angle_noise or 0.0,
        seed=options.seed,
        joint_names=names,
    )
    learner = choice.rigid if choice.chosen is None else choice.chosen.learner
    symmetries = None
    if isinstance(learner, RigidChain) and learner.verdict_.accepted:
        symmetries = learner.symmetries()
    return ChainFromData(options, names, samples, learner, symmetries, choice.reading, choice)


def choice_document(choice: ModelChoice, joint_names: Sequence[str]) -> dict[str, Any]:
    """What was tried and how it erred at poses left out, for JSON."""
    found: dict[str, Any] = {"contenders": {c.name: _contender(c) for c in choice.contenders}}
    if choice.chosen is not None and choice.chosen.held_out is not None:
        found["held_out"] = _contender(choice.chosen)
    if choice.friction.any():
        found["friction"] = dict(zip(joint_names, choice.friction.tolist(), strict=True))
    if choice.left_out:
        found["poses_after_another_payload"] = choice.left_out
    return found


def _contender(contender: Contender) -> dict[str, Any]:
    tried = contender.held_out
    if tried is None:
        return {"missing": contender.reason or None}
    return {
        "folds": tried.folds,
        "poses": tried.poses.count,
        "rmse": tried.rmse,
        "rmse_by_joint": tried.rmse_by_joint.tolist(),
        "rmse_without_outliers": tried.rmse_of_others,
        "outliers": int(tried.outliers.sum()),
    }


def _refuse_constant_torques(file: Path, samples: StaticSamples) -> None:
    """Refuse torques that are the same whatever the pose, unless they are zero (no gravity)."""
    moved = len(np.unique(samples.q, axis=0)) > 1
    if moved and not np.ptp(samples.tau, axis=0).any() and samples.tau.any():
        found = f"the same in all {len(samples.q)} rows, though angles differ"
        raise InputError(str(file), "torques", found, "torques measured in each of the poses")


def _known_load(
    options: ChainDataOptions, names: tuple[str, ...]
) -> tuple[int, float, StaticSamples] | None:
    """Number of the joint, moment of the load [N m] and the recording with it."""
    if options.known_load is None or options.loaded is None:
        return None
    moments = gains_by_joint([options.known_load], names, "--known-load")
    joint = next(j for j, moment in enumerate(moments) if moment is not None)
    moment = moments[joint] or 0.0
    if moment < 0 or gains_by_joint(options.known_gains, names)[joint] is not None:
        accepted = "a positive moment, of a joint whose gain is not given"
        raise InputError("command line", "--known-load", options.known_load, accepted)
    return joint, moment, read_csv(options.loaded, names)
