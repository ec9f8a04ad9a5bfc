"""A model and its symmetries from a CSV file alone: no robot file, a rigid chain."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.learning.files.csv_samples import StaticSamples, joint_names_of, read_csv
from isotorque.learning.files.saved_models import SavedModel, load_model, save_model
from isotorque.learning.learners.rigid.fitting.fit_status import Verdict
from isotorque.learning.learners.rigid.process.rigid_chain_process import RigidChainProcess
from isotorque.learning.learners.rigid.rigid_chain import RigidChain
from isotorque.learning.learners.rigid.structure.chain_symmetries import ChainSymmetries
from isotorque.learning.statistics.poses import group_poses
from isotorque.runs.stages import DATABASE
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.files import output_directory, write_whole
from isotorque.verify.relations.relation_files import relations_document

Array = NDArray[np.float64]

RIGID, WITH_PROCESS = WITHOUT_ROBOT = ("rigid-chain", "rigid-chain+gaussian-process")
"""Learners that are told nothing but samples."""
MOST_LISTED = 64
"""Relations are listed up to this order, generators of larger groups."""


@dataclass(frozen=True)
class ChainDataOptions:
    """How to learn a chain from a recording.

    Attributes
    ----------
    file : Path
        The CSV file; its header names the joints.
    torque_noise, angle_noise : float or None
        Standard deviations where known [N m], [rad].
    seed : int
        Of the random starts.
    learner : str
        ``rigid-chain``, or ``rigid-chain+gaussian-process`` for arms with cables and springs.
    """

    file: Path
    torque_noise: float | None = None
    angle_noise: float | None = None
    seed: int = 0
    learner: str = RIGID

    def __post_init__(self) -> None:
        if self.learner not in WITHOUT_ROBOT:
            accepted = f"{' or '.join(WITHOUT_ROBOT)}, which need no robot; or a ROBOT"
            raise InputError("command line", "--learner", self.learner, accepted)
        if self.learner == WITH_PROCESS and self.angle_noise:
            accepted = f"nothing with {WITH_PROCESS}, which takes angles as exact"
            raise InputError("command line", "--angle-noise", self.angle_noise, accepted)


@dataclass(frozen=True, eq=False)
class ChainFromData:
    """What was learned, accepted or not.

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
    """

    options: ChainDataOptions
    joint_names: tuple[str, ...]
    samples: StaticSamples
    learner: RigidChain | RigidChainProcess
    symmetries: ChainSymmetries | None

    def save(self, out: Path) -> Path | None:
        """Write model and relations; None, and nothing, where the chain was not accepted."""
        if not self.learner.verdict_.accepted:
            return None
        content = hashlib.sha256(self.options.file.read_bytes()).hexdigest()
        notes = {
            "strategy": "data",
            "learner": self.options.learner,
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
            "learner": self.options.learner,
            "strategy": "data",
            "samples": len(self.samples.q),
            "poses": self.learner.n_samples_seen_,
            "verdict": str(verdict),
            "accepted": verdict.accepted,
            "missing": learner.remark_ or None,
            "model": None if model is None else str(model),
        }
        if isinstance(learner, RigidChain):
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
        if isinstance(learner, RigidChain) and self.symmetries is not None:
            found |= {
                "torque_noise": learner.fit_.samples.torque_noise.tolist(),
                "relations": self.symmetries.group.order,
                "statement": self.symmetries.statement,
            }
        return found

    def _box(self) -> Array:
        return np.array([self.samples.q.min(axis=0), self.samples.q.max(axis=0)])

    def _region(self, count: int) -> Array:
        """Configurations within the ranges of the recording."""
        low, high = self._box()
        return np.asarray(np.random.default_rng(0).uniform(low, high, (count, len(low))))


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
    return relations_document(group, joint_names, generators=group.order > MOST_LISTED) | {
        "method": "rigid chain",
        "statement": symmetries.statement,
        "corrections": symmetries.corrections.tolist() if group.order <= MOST_LISTED else None,
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
    Joints are in series in the order of their columns. Rows of one pose count as one sample. Where
    the samples are explained neither exactly nor within stated noise, a constant torque per joint
    is fitted too: left out, it would be taken for noise.
    """
    names = joint_names_of(options.file)
    samples = read_csv(options.file, names)
    poses = group_poses(samples.q)
    q, tau = samples.q, samples.tau
    if poses.repeated:
        q, tau = poses.configurations(q), poses.means(tau)
    stated = options.torque_noise is not None or options.angle_noise is not None

    if options.learner == WITH_PROCESS:
        process = RigidChainProcess(
            torque_noise=options.torque_noise, random_state=options.seed
        ).fit(q, tau)
        return ChainFromData(options, names, samples, process, None)

    def fitted(offsets: bool) -> RigidChain:
        return RigidChain(
            torque_noise=(options.torque_noise or 0.0) if stated else None,
            angle_noise=options.angle_noise or 0.0,
            unknown_offsets=offsets,
            random_state=options.seed,
        ).fit(q, tau)

    learner = fitted(False)
    if learner.verdict_ not in (Verdict.ROUNDING, Verdict.CHI_SQUARE, Verdict.TOO_FEW):
        learner = fitted(True)
    symmetries = learner.symmetries() if learner.verdict_.accepted else None
    return ChainFromData(options, names, samples, learner, symmetries)
