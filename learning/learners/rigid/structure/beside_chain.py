"""Torques beside a fitted chain: what samples leave room for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from isotorque.learning.learners.rigid.fitting.chain_fit import ChainFit
from isotorque.learning.learners.rigid.fitting.chain_parameters import raw_directions
from isotorque.learning.statistics.added_terms import (
    SPARE,
    AddedTerms,
    added_terms,
    second_harmonics,
    springs,
)
from isotorque.learning.statistics.tails import quantile
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]

WIDER = 1.2
"""Errors of these terms, to first order, are too small by so much where an arm hangs: it then moves
little, and its chain gives way by more than its derivatives say (measured on the 3R)."""
KINDS = CONSTANT, SPRING, CABLE, SCALE, COMPLIANCE = (
    "constant",
    "spring",
    "second harmonic",
    "angle scale",
    "compliance",
)
PROBES = 400
"""Configurations at which errors of angles are largest."""
WIDEST = 2
"""Terms per joint of the widest kind."""


@dataclass(frozen=True, eq=False)
class TermBeside:
    """Torques of one kind that every joint may have beside the chain.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
    change : (rank,) array
        Of the chain, if the torques are there, in the coordinates of ``Information.factor``.
    root : (rank, rank) array
        R with R R^T the covariance that they add in these coordinates, deviations included.
    largest : (n,) array
        Torque that each joint's may have [N m].
    """

    kind: str
    change: Array
    root: Array
    largest: Array

    def missed(self, relation: SymmetryRelation) -> Array:
        """How far the measured torque misses a relation of gravity through them, (n,) [N m]."""
        A, Y = relation.A, relation.Y
        unit = np.eye(len(Y))
        if self.kind in (SCALE, COMPLIANCE):  # of angles: every torque that depends on them
            follows = np.full(len(Y), relation.is_identity)
        elif self.kind == CONSTANT:
            follows = Y > 0.0
        else:
            same = unit * Y[:, None] if self.kind == SPRING else unit
            follows = (same == A).all(axis=1) & (relation.d == 0.0)
            follows &= (Y > 0.0) | (self.kind == SPRING)
        return np.where(follows, 0.0, 2.0 * self.largest)


@dataclass(frozen=True, eq=False)
class BesideChain:
    """Torques beside a fitted chain that samples do not exclude.

    Attributes
    ----------
    terms : tuple of TermBeside
        Of all kinds that there were samples enough for.
    samples_needed : int
        Samples from which all kinds are tried.
    """

    terms: tuple[TermBeside, ...]
    samples_needed: int

    @property
    def complete(self) -> bool:
        """Whether all kinds were tried."""
        return len(self.terms) == len(KINDS)


def beside_chain(fit: ChainFit, deviations: float) -> BesideChain:
    """Bound the torques, and errors of angles, that samples leave room for beside a chain.

    Parameters
    ----------
    fit : ChainFit
        An accepted fit.
    deviations : float
        Standard errors that ``TermBeside.largest`` allows for: any term of any joint exceeds it
        as rarely as one normal variable exceeds so many.

    Notes
    -----
    A chain is flexible enough to take part of a spring or of a constant torque for gravity, and
    what it leaves passes for noise. So terms of each kind are added at every joint, to first order
    (the chain gives way as far as its derivatives let it), as in `lack_of_fit`.
    """
    samples, information = fit.samples, fit.information
    q = samples.q
    slopes = fit.chain.derivatives(q, raw_directions(fit.chain.n))
    rows = fit.whitening @ slopes.by_parameters()[:, :, information.free] @ information.factor
    residual = np.einsum("kij,kj->ki", fit.whitening, samples.torque - slopes.torque)
    reach = np.maximum(np.pi, np.abs(q).max(axis=0))
    one = np.ones(samples.n)
    kinds = {
        CONSTANT: (np.ones((*q.shape, 1)), one),
        SPRING: (springs(q), reach),
        CABLE: (second_harmonics(q), one),
    }
    every = len(KINDS) * samples.n
    deviations = float(stats.norm.isf(stats.norm.sf(deviations) / every))
    stated = not np.isnan(fit.p_value)
    terms = []

    def tried(values: Array) -> AddedTerms | None:
        return added_terms(
            rows.reshape(samples.equations, -1),
            residual.ravel(),
            fit.whitening,
            values,
            floor=1.0 if stated else np.finfo(float).tiny,
            known_noise=stated,
        )

    for kind, (values, size) in kinds.items():
        added = tried(values)
        if added is not None:
            terms.append(_term(kind, added, size, deviations))
    probes = np.random.default_rng(0).uniform(-np.pi, np.pi, (PROBES, samples.n))
    anywhere = fit.chain.derivatives(probes, raw_directions(fit.chain.n))
    springs_held = np.diag(fit.chain.correction.rate)  # their rates make up for errors of angles
    for kind, here, there in (
        (SCALE, q, probes),
        (COMPLIANCE, slopes.torque, anywhere.torque),  # as fitted: noise gives way to nothing
    ):
        added = tried(((slopes.stiffness - springs_held) * here[:, None, :])[:, :, :, None])
        if added is not None:
            felt = np.abs((anywhere.stiffness - springs_held) * there[:, None, :]).max(axis=0)
            terms.append(_term_of_angles(kind, added, felt, deviations))
    needed = -(-(information.rank + WIDEST * samples.n + SPARE) // samples.n)
    return BesideChain(tuple(terms), needed)


def _term(kind: str, added: AddedTerms, reach: Array, deviations: float) -> TermBeside:
    allowed = WIDER * quantile(deviations, added.freedom)
    largest = added.largest(allowed, reach)
    return TermBeside(kind, added.change, _root(added, allowed), largest)


def _term_of_angles(kind: str, added: AddedTerms, felt: Array, deviations: float) -> TermBeside:
    """Errors of angles; ``felt`` (n, n): largest torque of a joint for one unit at another."""
    allowed = WIDER * quantile(deviations, added.freedom)
    sizes = added.largest(allowed, np.ones(len(felt)))
    largest = np.linalg.norm(felt * sizes, axis=1)  # of several joints: errors are independent
    return TermBeside(kind, added.change, _root(added, allowed), largest)


def _root(added: AddedTerms, allowed: float) -> Array:
    """R with ``R R^T`` the covariance that terms add, so many standard errors included."""
    values, vectors = np.linalg.eigh((added.more + added.more.T) / 2.0)
    return np.asarray(allowed * vectors * np.sqrt(np.maximum(values, 0.0)))
