"""Relations files: read with every number checked, and written."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.strict_json import Field, read_json
from isotorque.symbolic.groups.correction import Correction
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup, group_structure
from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation

Array = NDArray[np.float64]

LARGEST_BASIS = 1_000_000
"""Frequencies of arms are -1, 0 and 1; what is above this is no basis of theirs."""

SAME = 1e-9
"""Numbers of a file that say the same thing twice may differ by this much."""


@dataclass(frozen=True, eq=False)
class RelationsFile:
    """Claims of a relations file; iterating gives the relations.

    Attributes
    ----------
    source : str
        The file it was read from.
    relations : tuple of SymmetryRelation
        ``exact`` and ``bound`` (NaN where the file has none) are the file's claims.
    joint_names : tuple of str or None
        The file's ``joints``.
    order : int or None
        The claimed order of the group they form or generate.
    complete : bool
        Whether the file claims that no exact relation is missing.
    generate : bool
        Whether the relations are generators, not all members.
    corrected : tuple of SymmetryRelation
        Further ones, of the measured torque less what joints carry beside gravity: each has a
        ``correction``.
    """

    source: str
    relations: tuple[SymmetryRelation, ...]
    joint_names: tuple[str, ...] | None = None
    order: int | None = None
    complete: bool = False
    generate: bool = False
    corrected: tuple[SymmetryRelation, ...] = ()

    def __iter__(self) -> Iterator[SymmetryRelation]:
        return iter(self.relations)

    def __len__(self) -> int:
        return len(self.relations)

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.relations[0].n


def load_relations(path: str | Path, *, joint_names: Sequence[str] | None = None) -> RelationsFile:
    """Read a relations file, as ``symmetries --json`` and ``relations --json`` write it.

    Parameters
    ----------
    path
        A JSON file: an object with ``relations``, a list of objects that hold at least ``A``,
        ``d`` and ``Y``, or that list alone; or an object with ``generators``, such a list of
        relations that generate a large group.
    joint_names
        The robot's joints; a file that names others, or the same in another order, is refused.

    Returns
    -------
    RelationsFile

    Raises
    ------
    InputError
        For a file that cannot be read or is not JSON, for wrong types, lengths, signs, numbers
        that are not finite, and for optional entries (``joints``, ``order``, ``complete``,
        ``rank``, ``basis``, ``free_directions``; ``M``, ``N``, ``rhs``, ``exact``, ``bound``,
        ``correction``) that are malformed or contradict ``A`` and ``d``. The message names
        the file, the field and the value.

    Notes
    -----
    Nothing is judged here: a relation that is false is still well formed.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
    ...     _ = file.write('{"relations": [{"A": [[-1]], "d": [3.14], "Y": [1]}]}')
    ...     file.flush()
    ...     print(load_relations(file.name).relations[0])
    q1' = -1 q1 +3.14; Y = diag(+1)
    """
    document = read_json(path)
    root = (
        document if document.is_object else Field(document.where, "", {"relations": document.value})
    )
    generate = root.optional("relations") is None and root.optional("generators") is not None
    entries = root.entry("generators" if generate else "relations").items(at_least=1)
    names = _joint_names(root, joint_names)
    n = len(names) if names is not None else None
    first = entries[0].entry("A").items(at_least=1)
    n = len(first) if n is None else n
    basis = root.optional("basis")
    B = None if basis is None else _basis(basis, n)
    relations = tuple(_relation(entry, n, B) for entry in entries)
    _check_group_entries(root, relations, B, n, generate)
    order, complete = root.optional("order"), root.optional("complete")
    more = root.optional("corrected")
    further = [] if more is None or more.value is None else more.items()
    corrected = tuple(_relation(entry, n, B) for entry in further)
    for entry, relation in zip(further, corrected, strict=True):
        if relation.correction is None:
            entry.refuse('a relation with a "correction"')
    return RelationsFile(
        source=document.where,
        relations=relations,
        joint_names=names,
        order=None if order is None else order.integer(),
        complete=complete is not None and complete.boolean(),
        generate=generate,
        corrected=corrected,
    )


def relations_document(
    relations: SymmetryGroup | Sequence[SymmetryRelation],
    joint_names: Sequence[str],
    *,
    extra: Sequence[dict[str, Any]] | None = None,
    generators: bool = False,
    corrected: Sequence[SymmetryRelation] = (),
) -> dict[str, Any]:
    """Return relations in the form of a relations file.

    Parameters
    ----------
    relations
        A group (then ``order`` and ``free_directions`` are written too) or a list.
    joint_names
        Joint names in the order of q.
    extra
        More entries for each relation, e.g. how it was learned; must not repeat the standard ones.
    generators
        Write generators of a group under ``generators``, in place of all its ``relations``.
    corrected
        Relations of the measured torque with a correction, written apart.

    Returns
    -------
    dict
        Numbers, strings and lists only; bounds that are not known are null.

    Examples
    --------
    >>> from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
    >>> from isotorque.symbolic.groups.symmetry_relation import identity
    >>> document = relations_document(SymmetryGroup([identity(1)]), ["elbow"])
    >>> document["order"], document["relations"][0]["M"]
    (1, [[-1]])
    """
    if not isinstance(relations, SymmetryGroup):
        members = list(relations)
    else:
        members = list(relations.generators if generators else relations.listed())
    basis = relations.basis if isinstance(relations, SymmetryGroup) else members[0].basis
    document: dict[str, Any] = {"joints": list(joint_names)}
    if isinstance(relations, SymmetryGroup):
        document["order"] = relations.order
    document |= {"rank": len(basis), "basis": _plain(basis)}
    if isinstance(relations, SymmetryGroup):
        document["free_directions"] = _plain(relations.free_directions)
        document["structure"] = {
            "text": group_structure(relations),
            "factors": [
                {
                    "joints": [joint_names[j] for j in factor.joints],
                    "order": factor.order,
                    "factors": list(factor.factors),
                }
                for factor in relations.direct_factors
            ],
        }
    additions = [{} for _ in members] if extra is None else extra
    document["generators" if generators else "relations"] = [
        _entry(relation) | more for relation, more in zip(members, additions, strict=True)
    ]
    return document | ({"corrected": [_entry(r) for r in corrected]} if corrected else {})


def _entry(relation: SymmetryRelation) -> dict[str, Any]:
    """A relation as plain data."""
    entry = {
        "A": _plain(relation.A),
        "d": relation.d.tolist(),
        "Y": _plain(relation.Y),
        "M": _plain(relation.M),
        "N": _plain(relation.N),
        "rhs": relation.rhs.tolist(),
        "exact": relation.exact,
        "bound": [x if math.isfinite(x) else None for x in relation.bound.tolist()],
    }
    found = relation.correction
    return entry if found is None else entry | {"correction": found.as_json()}


def write_relations(path: str | Path, document: dict[str, Any]) -> None:
    """Write a document of `relations_document` as a relations file.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    text = json.dumps(document, indent=1, allow_nan=False) + "\n"
    try:
        Path(path).write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(
            path, "file", error.strerror or error, "a path that can be written"
        ) from None


def _plain(values: Array | NDArray[np.int64]) -> list[Any]:
    """Return nested lists, with integers where every entry is one."""
    if np.array_equal(values, np.round(values)):
        return np.asarray(values, dtype=np.int64).tolist()
    return values.tolist()


def _joint_names(root: Field, expected: Sequence[str] | None) -> tuple[str, ...] | None:
    field = root.optional("joints")
    if field is None:
        return None if expected is None else tuple(expected)
    names = tuple(item.text() for item in field.items(at_least=1))
    if len(set(names)) != len(names):
        field.refuse("distinct joint names")
    if expected is not None and names != tuple(expected):
        field.refuse(f"the robot's joints in its order, {json.dumps(list(expected))}")
    return names


def _basis(field: Field, n: int) -> NDArray[np.int64]:
    rows = field.matrix(columns=n)
    small = bool(np.all(np.abs(rows) <= LARGEST_BASIS))
    if not small or not np.array_equal(rows, np.round(rows)) or not _independent(rows):
        field.refuse(f"linearly independent rows of integers up to {LARGEST_BASIS:,}")
    return rows.astype(np.int64)


def _independent(rows: NDArray[np.float64]) -> bool:
    """Say whether rows are linearly independent; NumPy 2.2 knows no rank of no rows."""
    return not len(rows) or int(np.linalg.matrix_rank(rows)) == len(rows)


def _relation(entry: Field, n: int, basis: NDArray[np.int64] | None) -> SymmetryRelation:
    A = entry.entry("A").matrix(rows=n, columns=n)
    d = entry.entry("d").vector(n)
    signs = entry.entry("Y")
    Y = signs.vector(n)
    if not np.all(np.abs(Y) == 1.0):
        signs.refuse("signs, each 1 or -1")
    exact = entry.optional("exact")
    bound = entry.optional("bound")
    limits = None if bound is None else _bound(bound, n)
    relation = SymmetryRelation(
        A,
        d,
        Y,
        basis,
        exact=exact is not None and exact.boolean(),
        bound=limits,
        correction=_correction(entry.optional("correction"), n),
    )
    if basis is not None:
        y_map = basis @ A @ np.linalg.pinv(basis) @ basis
        if not np.allclose(y_map, basis @ A, atol=SAME):
            entry.entry("A").refuse("a matrix that maps y = B q to y, B being the file's basis")
    _check_paper_form(entry, relation)
    return relation


def _correction(field: Field | None, n: int) -> Correction | None:
    if field is None or field.value is None:
        return None
    constant, rate = (field.optional(name) for name in ("constant", "rate"))
    if constant is None and rate is None:
        field.refuse('an object with "constant" [N m], "rate" [N m/rad] or both')
    none = np.zeros(n)
    return Correction(
        none if constant is None else constant.vector(n), none if rate is None else rate.vector(n)
    )


def _bound(field: Field, n: int) -> Array | None:
    if field.value is None:
        return None
    values = [np.nan if x.value is None else x.number() for x in field.items(exactly=n)]
    if any(x < 0 for x in values):
        field.refuse("numbers >= 0 [Nm] or null")
    return np.array(values)


def _check_paper_form(entry: Field, relation: SymmetryRelation) -> None:
    """Check M q_r + N q_s = rhs against A and d: M = -N A, rhs = N d, zero rows allowed."""
    n = relation.n
    fields = {name: entry.optional(name) for name in ("M", "N", "rhs")}
    present = fields["N"]
    N = relation.N if present is None else present.matrix(columns=n)
    if present is not None:
        rows = N[np.any(N != 0, axis=1)]
        if rows.shape != relation.N.shape or not np.allclose(rows, relation.N, atol=SAME):
            present.refuse(f"the basis B of y = B q, {json.dumps(_plain(relation.N))}")
    if fields["M"] is not None:
        M = fields["M"].matrix(columns=n)
        if M.shape != N.shape or not np.allclose(M, -N @ relation.A, atol=SAME):
            fields["M"].refuse(f"-A_sat B = {json.dumps(_plain(-N @ relation.A + 0.0))}")
    if fields["rhs"] is not None:
        rhs = fields["rhs"].vector(len(N))
        if np.any(np.abs(wrap(rhs - N @ relation.d)) > SAME):
            fields["rhs"].refuse(f"B d modulo 2 pi = {json.dumps(wrap(N @ relation.d).tolist())}")


def _check_group_entries(
    root: Field,
    relations: tuple[SymmetryRelation, ...],
    basis: NDArray[np.int64] | None,
    n: int,
    generate: bool,
) -> None:
    order, rank = root.optional("order"), root.optional("rank")
    if generate:
        if order is not None and order.integer() < 2:
            order.refuse("the order of a group with generators, at least 2")
    elif order is not None and order.integer() != len(relations):
        order.refuse(f"the number of relations listed, {len(relations)}")
    r = n if basis is None else len(basis)
    if rank is not None and (rank.integer() != r if basis is not None else rank.integer() > n):
        rank.refuse(f"the number of rows of the basis, {r}" if basis is not None else f"0 to {n}")
    free = root.optional("free_directions")
    if free is not None:
        directions = free.matrix(columns=n)
        rows = np.eye(n) if basis is None else basis.astype(float)
        whole = len(directions) == n - r and _independent(directions)
        if not whole or np.any(np.abs(directions @ rows.T) > SAME):
            free.refuse(f"{n - r} independent directions v with B v = 0")
