"""The gravity potential of a kinematic tree as an exact trigonometric polynomial."""

from __future__ import annotations

from typing import Any

import numpy as np
from flint import fmpq

from isotorque.symbolic.polynomials.coefficients import is_zero, to_sympy
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.kinematic_tree import Entries, KinematicTree


def derive_potential(tree: KinematicTree) -> TrigonometricPolynomial:
    """Derive the gravity potential U(q) of a tree, without its constant part.

    Parameters
    ----------
    tree
        Any serial or branched tree of revolute joints; float entries are taken as the exact
        rationals that they are.

    Returns
    -------
    TrigonometricPolynomial
        U(q) = sum_k a_k cos(k.q) + b_k sin(k.q) [J], k in {-1, 0, 1}^n, with exact rational or
        SymPy coefficients; terms whose coefficients cancel exactly are left out.

    Notes
    -----
    Only the direction of gravity is carried down the chain, as a row vector seen from each link:
    ``v_i = v_parent R_i (R0 + R1 cos q_i + R2 sin q_i)`` with Rodrigues' ``R0 = a a^T``,
    ``R1 = 1 - a a^T``, ``R2 = [a]x``. Then
    ``U = -sum_i (v_parent . p_i) m_subtree,i + v_i . m_i c_i``.
    Since q_i is new to v_parent, every term spawns its three successors without collisions; the
    whole derivation is a handful of matrix products per joint.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, chapter 2 (rotations).

    Examples
    --------
    >>> from isotorque.symbolic.robots.kinematic_tree import planar_arm
    >>> print(derive_potential(planar_arm(1)))
    c1*g*m1*sin(q1)
    """
    tree = tree.exact()
    n = tree.n
    half = fmpq(1, 2) if isinstance(tree.masses[0], fmpq) else to_sympy(fmpq(1, 2))
    total: dict[tuple[int, ...], Any] = {}
    zero = half - half
    subtree = [zero + m for m in tree.masses]
    for i in range(n - 1, -1, -1):
        if tree.parents[i] >= 0:
            subtree[tree.parents[i]] = subtree[tree.parents[i]] + subtree[i]
    base = _GravityRow(
        np.zeros((1, n), dtype=np.int8),
        tree.gravity[None, :] * (half + half),
        np.array([[zero] * 3], dtype=object),
    )
    rows: list[_GravityRow] = []
    for i in range(n):
        parent = base if tree.parents[i] < 0 else rows[tree.parents[i]]
        if tree.parents[i] >= 0:  # before the first joint the offset is constant
            parent.add_to(total, tree.translations[i], -subtree[i])
        row = parent.turned(i, tree.rotations[i], tree.axes[i], half)
        row.add_to(total, tree.levers[i], -tree.masses[i])
        rows.append(row)
    keys = sorted(
        (k for k, (a, b) in total.items() if any(k) and not (is_zero(a) and is_zero(b))),
        key=lambda k: (sum(map(abs, k)), tuple(-x for x in k)),
    )
    return TrigonometricPolynomial(
        np.array(keys, dtype=np.int64).reshape(len(keys), n),
        np.array([total[k][0] for k in keys], dtype=object),
        np.array([total[k][1] for k in keys], dtype=object),
        names=tree.joint_names,
    )


class _GravityRow:
    """Direction of gravity seen from a link: sum over k of cos (m,3) and sin (m,3) parts."""

    def __init__(self, frequencies: np.ndarray, cos: Entries, sin: Entries) -> None:
        self.frequencies, self.cos, self.sin = frequencies, cos, sin

    def add_to(self, total: dict[tuple[int, ...], Any], vector: Entries, factor: Any) -> None:
        """Add ``factor * (this row . vector)`` to the coefficients in ``total``."""
        if is_zero(factor) or all(is_zero(x) for x in vector):
            return
        scaled = np.array([factor * x for x in vector], dtype=object)
        for k, a, b in zip(
            map(tuple, self.frequencies.tolist()), self.cos @ scaled, self.sin @ scaled, strict=True
        ):
            if k in total:
                a, b = a + total[k][0], b + total[k][1]
            total[k] = (a, b)

    def turned(self, joint: int, rotation: Entries, axis: Entries, half: Any) -> _GravityRow:
        """Return the row seen from behind joint ``joint``."""
        fixed = np.outer(axis, axis)
        one = half + half
        x, y, z = axis
        zero = half - half
        cos_part = np.array([[one if i == j else zero for j in range(3)] for i in range(3)]) - fixed
        sin_part = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]], dtype=object)
        cos, sin = self.cos @ rotation, self.sin @ rotation
        cc, cs = cos @ cos_part, cos @ sin_part
        sc, ss = sin @ cos_part, sin @ sin_part
        constant = ~np.any(self.frequencies, axis=1)
        moving = ~constant
        up, down = self.frequencies.copy(), self.frequencies.copy()
        up[:, joint], down[:, joint] = 1, -1
        # cos k cos q = (cos(k+q) + cos(k-q)) / 2 and so on; the constant term gives cos q, sin q
        parts = [
            (self.frequencies, cos @ fixed, sin @ fixed),
            (up[constant], cc[constant], cs[constant]),
            (up[moving], half * (cc - ss)[moving], half * (cs + sc)[moving]),
            (down[moving], half * (cc + ss)[moving], half * (sc - cs)[moving]),
        ]
        frequencies = np.concatenate([p[0] for p in parts])
        cos = np.concatenate([p[1] for p in parts])
        sin = np.concatenate([p[2] for p in parts])
        keep = [
            not all(map(is_zero, (*a, *b))) for a, b in zip(cos.tolist(), sin.tolist(), strict=True)
        ]
        return _GravityRow(frequencies[keep], cos[keep], sin[keep])
