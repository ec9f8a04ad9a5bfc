"""Judge of relations by fresh measurements: pairs of poses, and forms fitted to these alone."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from isotorque.learning.relations.potential.errors_in_variables import MeasurementNoise
from isotorque.learning.relations.testing.relation_errors import RelationErrors, relation_errors
from isotorque.learning.statistics.fresh_errors import (
    LEAST_POSES,
    RESOLVED,
    FreshErrors,
    RowNoise,
    fresh_errors,
    scatter_within_poses,
    unknown_noise,
)
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation
from isotorque.verify.models.fresh_measurements import (
    OBJECT,
    FreshMeasurements,
    MeasuredJudgement,
)
from isotorque.verify.relations.relation_files import RelationsFile
from isotorque.verify.relations.relations_file_claims import judge_closure
from isotorque.verify.relations.verify_relation import describe_relation
from isotorque.verify.verdict import Status, Verdict, sizes

Array = NDArray[np.float64]

TURN = 2.0 * np.pi
NEAR = 0.1
"""Poses are a pair where their distance changes no torque by more than this share of a tolerance,
torques of rigid links changing by no more per radian than they are large (Bernstein)."""


def verify_relations_on_measurements(
    file: RelationsFile,
    fresh: FreshMeasurements,
    *,
    tolerance: float | None = None,
    noise: MeasurementNoise | None = None,
) -> MeasuredJudgement:
    """Judge the relations of a file by torques that were measured, and by nothing else.

    Parameters
    ----------
    file
        From `load_relations`; corrections of its relations are part of the claims.
    fresh
        Measurements that the relations were not learned from.
    tolerance
        Torque error of every relation that is allowed beside the bound that the file gives for it
        [N m]; by default 1 % of each joint's largest measured torque, at least 1e-3 of the arm's.
    noise
        Noise of the measurements where it is known.

    Returns
    -------
    MeasuredJudgement
        One verdict per relation, whose reason says by what means it was reached; then, where the
        file gives an order, one on its relations being a group.

    Raises
    ------
    InputError
        If the file is about another number of joints or other joint names.

    Notes
    -----
    Poses that a relation carries into each other are compared directly (model-free): they are rare.
    Beside that waves and a rigid chain are fitted to the measurements alone (`relation_errors`).
    ``refuted``: a pair, or the least error that a form leaves, is above what is allowed.
    ``tested``: the error seen is not above it, and no error of three times what is allowed is left
    possible by a form, or would have passed unnoticed at five pairs at least. Otherwise ``not
    tested``, which does not pass.
    """
    n = len(fresh.joint_names)
    if file.n != n:
        raise InputError(file.source, "number of joints", file.n, f"{n}, as {fresh.file} has")
    if file.joint_names is not None and file.joint_names != fresh.joint_names:
        found, accepted = list(file.joint_names), f"{list(fresh.joint_names)}, as in {fresh.file}"
        raise InputError(file.source, "joints", found, accepted)
    every = [*file.relations, *file.corrected]
    by_form = relation_errors(every, fresh.samples.q, fresh.samples.tau, noise=noise)
    known = _noise(fresh, noise, by_form[0][0])
    beside = fresh.tolerances(tolerance)
    verdicts, entries = [], []
    for number, relation in enumerate(every, 1):
        judged = _Judged(number, relation, beside, fresh, known)
        verdicts.append(judged.verdict(by_form[number - 1]))
        entries.append(judged.document(by_form[number - 1]))
    if file.order is not None:
        verdicts.append(judge_closure(file))
    document = {
        "file": str(fresh.file),
        "rows": len(fresh.samples.q),
        "poses": fresh.poses.count,
        "noise_known_by": known.source or None,
        "tolerance": beside,
        "relations": entries,
    }
    return MeasuredJudgement(tuple(verdicts), _remarks(file, known), document)


class _Judged:
    """One relation, what it is allowed, and the pairs of poses that it relates."""

    def __init__(
        self,
        number: int,
        relation: SymmetryRelation,
        beside: Array,
        fresh: FreshMeasurements,
        noise: RowNoise,
    ) -> None:
        bound = np.where(np.isfinite(relation.bound), relation.bound, 0.0)
        self.allowed = bound + beside
        self._relation, self._fresh = relation, fresh
        self._claim = (
            f"{OBJECT}: relation {number}: {describe_relation(relation)}, within "
            f"{sizes(self.allowed)} Nm"
        )
        self._pairs = _pairs(relation, fresh, beside)
        allowed = self.allowed + NEAR * beside
        self._found = _compared(self._pairs, relation, fresh, noise, allowed)

    def verdict(self, by_form: tuple[RelationErrors, ...]) -> Verdict:
        """Judge by pairs and by every form: one that contradicts is enough."""
        if self._relation.is_identity:
            return Verdict(self._claim, Status.PROVED, 0.0)
        found = self._found
        if found is not None and (found.refuted.any() or found.missed.any()):
            return self._refuted_by_pairs(found)
        fitted = [errors for errors in by_form if errors.means]
        for errors in fitted:
            if (errors.least > self.allowed).any():
                return self._refuted_by_form(errors)
        for errors in fitted:
            if (errors.seen > self.allowed).any():
                return self._seen_by_form(errors)
        best = min(fitted, key=lambda e: float((e.most / self._scale).max()), default=None)
        if best is not None and (best.most <= RESOLVED * self.allowed).all():
            reason = (
                f"by {best.means} fitted to {self._fresh.poses.count} poses: wrong by at most "
                f"{best.most.max():.2g} N m, {best.beside.max():.2g} with torques beside gravity "
                f"that they do not show{self._and_pairs()}"
            )
            return Verdict(self._claim, Status.TESTED, float(best.estimate.max()), reason=reason)
        if found is not None and found.poses >= LEAST_POSES and found.resolved.all():
            largest = float(np.abs(found.errors).max())
            reason = f"by {found.poses} pairs of poses, compared directly; nowhere else"
            return Verdict(self._claim, Status.TESTED, largest, reason=reason)
        return Verdict(self._claim, Status.UNTESTED, np.nan, reason=self._untested(best, by_form))

    def document(self, by_form: tuple[RelationErrors, ...]) -> dict[str, Any]:
        """What was compared, as plain data."""
        return {
            "allowed": self.allowed,
            "pairs": len(self._pairs),
            "fitted": [
                {
                    "means": e.means,
                    "error": e.estimate,
                    "seen": e.seen,
                    "at_least": e.least,
                    "at_most": e.most,
                    "at_most_beside_gravity": e.beside,
                }
                for e in by_form
                if e.means
            ],
        }

    @property
    def _scale(self) -> Array:
        return np.maximum(self.allowed, np.finfo(float).tiny)

    def _and_pairs(self) -> str:
        return f", and {len(self._pairs)} pairs of poses agree" if len(self._pairs) else ""

    def _refuted_by_pairs(self, found: FreshErrors) -> Verdict:
        excess = np.abs(found.errors) - found.allowed_at_poses
        pair, joint = np.unravel_index(int(np.argmax(excess)), excess.shape)
        first, second = self._pairs[pair]
        rows = f"row {self._fresh.row(int(first))}"
        if first != second:
            rows += f" and row {self._fresh.row(int(second))}"
        reason = (
            f"by {found.poses} pairs of poses, compared directly; worst: {rows}, "
            f"{self._fresh.joint_names[joint]}, {found.errors[pair, joint]:+.3g} N m, "
            f"{found.allowed_at_poses[pair, joint]:.3g} explained"
        )
        largest = float(np.abs(found.errors).max())
        return Verdict(self._claim, Status.REFUTED, largest, self._fresh.q[first], reason=reason)

    def _refuted_by_form(self, errors: RelationErrors) -> Verdict:
        joint = int(np.argmax(errors.least - self.allowed))
        reason = (
            f"by {errors.means} fitted to {self._fresh.poses.count} poses: "
            f"{self._fresh.joint_names[joint]} misses it by {errors.least[joint]:.3g} N m at least"
        )
        return Verdict(
            self._claim,
            Status.REFUTED,
            float(errors.estimate.max()),
            errors.where[joint],
            reason=reason,
        )

    def _seen_by_form(self, errors: RelationErrors) -> Verdict:
        joint = int(np.argmax(errors.seen - self.allowed))
        reason = (
            f"by {errors.means} fitted to {self._fresh.poses.count} poses "
            f"{self._fresh.joint_names[joint]} misses it by {errors.seen[joint]:.3g} N m at least, "
            "unless springs, cables or constants that so few poses do not show are there"
        )
        return Verdict(self._claim, Status.UNTESTED, float(errors.estimate.max()), reason=reason)

    def _untested(self, best: RelationErrors | None, by_form: tuple[RelationErrors, ...]) -> str:
        pairs = f"{len(self._pairs)} pairs of poses can be compared directly"
        if best is None:
            return (
                f"{pairs}, and no form of the torque can be fitted; missing: {by_form[0].missing}"
            )
        joint = int(np.argmax(best.most / self._scale))
        return (
            f"{pairs}, and by {best.means} fitted to {self._fresh.poses.count} poses "
            f"{self._fresh.joint_names[joint]} could miss it by {best.most[joint]:.2g} N m, more "
            f"than {RESOLVED:g} times what is allowed; more poses, or a larger --tolerance"
        )


def _noise(
    fresh: FreshMeasurements, stated: MeasurementNoise | None, fitted: RelationErrors
) -> RowNoise:
    """Of rows: stated, by the scatter within poses, or by what a form that was fitted leaves."""
    tau = fresh.samples.tau
    if stated is None:
        scatter = scatter_within_poses(tau, fresh.poses)
        if scatter is not None:
            return scatter
        if not fitted.means:
            return unknown_noise(tau)
        variance = np.array(np.broadcast_to(fitted.noise**2, tau.shape))
        return RowNoise(variance, fitted.freedom, f"residuals of {fitted.means} fitted to them")
    # torques of rigid links change by no more per radian than they are large
    turned = stated.angle * np.sqrt(tau.shape[1]) * np.abs(fresh.tau).max(axis=0)
    variance = np.broadcast_to(stated.torque**2 + turned**2, tau.shape)
    return RowNoise(np.array(variance), np.inf, "stated")


def _pairs(
    relation: SymmetryRelation, fresh: FreshMeasurements, beside: Array
) -> list[tuple[int, int]]:
    """Poses that a relation carries into each other; each pair once."""
    largest = np.maximum(np.abs(fresh.tau).max(axis=0), np.finfo(float).tiny)
    radius = NEAR * float((beside / largest).min())
    rows = relation.basis.astype(float)

    def places(q: Array) -> Array:
        turned = np.mod(q @ rows.T, TURN)
        return np.where(turned >= TURN, 0.0, turned)

    if not len(rows):
        return []
    here = KDTree(places(fresh.q), boxsize=TURN)
    there = here.query_ball_point(places(relation.configuration(fresh.q)), radius, p=1.0)
    pairs: dict[frozenset[int], tuple[int, int]] = {}
    for pose, images in enumerate(there):
        for image in images:
            pairs.setdefault(frozenset((pose, image)), (pose, int(image)))
    return list(pairs.values())


def _compared(
    pairs: list[tuple[int, int]],
    relation: SymmetryRelation,
    fresh: FreshMeasurements,
    noise: RowNoise,
    allowed: Array,
) -> FreshErrors | None:
    if not pairs:
        return None
    first, second = np.array(pairs).T
    tau = fresh.tau
    errors = tau[second] - relation.torque(tau[first], fresh.q[first])
    variance = fresh.poses.means(noise.variance) / fresh.poses.rows[:, None]
    both = variance[first] + variance[second]
    itself = (1.0 - relation.Y) ** 2 * variance[first]
    spread = np.where((first == second)[:, None], itself, both)
    return fresh_errors(errors, np.sqrt(spread), noise.freedom, allowed)


def _remarks(file: RelationsFile, noise: RowNoise) -> tuple[str, ...]:
    said = [f"noise: {noise.source or 'not known, of pairs it counts as error'}"]
    exact = any(r.exact and not r.is_identity for r in file)
    if exact or file.complete:
        parts = ["that relations are exact"] if exact else []
        parts += ["that none is missing"] if file.complete else []
        named = " and ".join(parts)
        said.append(f"not judged, because measurements cannot tell: {named} (--robot judges it)")
    return tuple(said)
