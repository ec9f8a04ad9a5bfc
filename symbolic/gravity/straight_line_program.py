"""The gravity torque as a straight list of sums of products: what C and CasADi are written from."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from isotorque.symbolic.gravity.recursion import GravityChain
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial

WAVE_COST, SECOND_WAVE_COST = 40, 20
"""What a sine or cosine costs, in additions and multiplications; C compilers compute the sine and
cosine of one angle together, so the second costs less (measured by benchmarks/gravity_forms.py)."""


Term = tuple[float, tuple[str, ...]]
"""A factor times a product of at most two variables; without variables a constant."""

Terms = tuple[Term, ...]


@dataclass(frozen=True)
class Wave:
    """The statement ``name = function(frequency . q)``."""

    name: str
    function: Literal["cos", "sin"]
    frequency: tuple[int, ...]


@dataclass(frozen=True)
class Sum:
    """The statement ``name = sum of the terms``."""

    name: str
    terms: Terms


@dataclass(frozen=True)
class GravityProgram:
    """Statements that compute the gravity torque, each from names defined before it.

    Attributes
    ----------
    n : int
        Number of joints.
    waves : tuple of Wave
        Sines and cosines, computed first.
    sums : tuple of Sum
        Then these, in order.
    torques : tuple of tuple
        Per joint the terms of a last sum: its gravity torque [N m]; empty where it is zero.

    Notes
    -----
    Factors of zero and one are folded away and nothing unused is computed, so an axis-aligned arm
    costs a fraction of a general one.

    Examples
    --------
    >>> from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
    >>> f = TrigonometricPolynomial([[1, 0], [1, 1]], [0.0, 0.0], [18.4, 6.1])
    >>> program = expanded_program(f)
    >>> for wave in program.waves:
    ...     print(wave.name, "=", wave.function, wave.frequency)
    cos1 = cos (1, 0)
    cos2 = cos (1, 1)
    >>> program.torques[1]
    ((6.1, ('cos2',)),)
    """

    n: int
    waves: tuple[Wave, ...]
    sums: tuple[Sum, ...]
    torques: tuple[Terms, ...]

    @property
    def cost(self) -> int:
        """Additions and multiplications; sines and cosines as `WAVE_COST`, `SECOND_WAVE_COST`."""
        total = 0
        angles: set[tuple[int, ...]] = set()
        for wave in self.waves:
            again = wave.frequency in angles
            total += SECOND_WAVE_COST if again else WAVE_COST + sum(map(bool, wave.frequency)) - 1
            angles.add(wave.frequency)
        for terms in (*(s.terms for s in self.sums), *self.torques):
            total += sum(len(names) - (abs(factor) == 1) for factor, names in terms)
            total += max(len(terms) - 1, 0)
        return total


def cheaper_program(chain: GravityChain, potential: TrigonometricPolynomial) -> GravityProgram:
    """Return whichever of the two forms costs less; the expanded one if they cost the same."""
    expanded, recursion = expanded_program(potential), recursion_program(chain)
    return expanded if expanded.cost <= recursion.cost else recursion


def expanded_program(potential: TrigonometricPolynomial) -> GravityProgram:
    """Write the gradient of a potential with numbers as coefficients, frequency by frequency."""
    f = potential.to_float()
    builder = _Builder()
    torques: list[list[Term]] = [[] for _ in range(f.n)]
    for index, (k, a, b) in enumerate(zip(f.frequencies.tolist(), f.cos, f.sin, strict=True)):
        wave: list[Term] = []
        if b:
            wave.append((float(b), (builder.wave(f"cos{index + 1}", "cos", k),)))
        if a:
            wave.append((-float(a), (builder.wave(f"sin{index + 1}", "sin", k),)))
        if len(wave) == 2 and sum(map(bool, k)) > 1:
            wave = [builder.name_of(wave)]
        for joint, factor in enumerate(k):
            if factor:
                torques[joint] += [(factor * x, names) for x, names in wave]
    return builder.program(torques)


def recursion_program(chain: GravityChain) -> GravityProgram:
    """Write the recursion along the chain, with all that is constant in it folded away."""
    builder = _Builder()
    n = chain.n
    children = [[j for j in range(n) if chain.parents[j] == i] for i in range(n)]
    cos: list[Term] = []
    sin: list[Term] = []
    before: list[list[Term]] = []
    after: list[list[Term]] = []
    for i in range(n):
        k = [int(i == j) for j in range(n)]
        cos.append((1.0, (builder.wave(f"cos{i + 1}", "cos", k),)))
        sin.append((1.0, (builder.wave(f"sin{i + 1}", "sin", k),)))
        parent = int(chain.parents[i])
        seen = [_constant(x) for x in chain.gravity] if parent < 0 else after[parent]
        x, y, z = (builder.dot(chain.rotations[i][:, j], seen) for j in range(3))
        before.append([x, y])
        after.append(
            [
                builder.sum([_product(cos[i], x), _product(sin[i], y)]),
                builder.sum([_product(cos[i], y), _product(sin[i], x, -1.0)]),
                z,
            ]
        )
    # What a joint carries, seen from the frame that its parent's rotation leads to.
    handed: list[list[Term]] = [[]] * n
    torques: list[list[Term]] = [[] for _ in range(n)]
    for i in range(n - 1, -1, -1):
        u, v, z = (
            builder.sum([_constant(chain.moments[i, j]), *(handed[c][j] for c in children[i])])
            for j in range(3)
        )
        x = builder.sum([_product(cos[i], u), _product(sin[i], v, -1.0)])
        y = builder.sum([_product(sin[i], u), _product(cos[i], v)])
        torques[i] = [_product(y, before[i][0]), _product(x, before[i][1], -1.0)]
        handed[i] = [builder.dot(chain.rotations[i][j], [x, y, z]) for j in range(3)]
    return builder.program(torques)


def _constant(value: float) -> Term:
    return float(value), ()


def _product(a: Term, b: Term, sign: float = 1.0) -> Term:
    return sign * a[0] * b[0], a[1] + b[1]


class _Builder:
    """Collects statements, folding constants as it goes."""

    def __init__(self) -> None:
        self.waves: list[Wave] = []
        self.sums: list[Sum] = []

    def wave(self, name: str, function: Literal["cos", "sin"], k: Iterable[int]) -> str:
        self.waves.append(Wave(name, function, tuple(k)))
        return name

    def dot(self, factors: Iterable[float], terms: Iterable[Term]) -> Term:
        return self.sum(
            [(float(f) * x, names) for f, (x, names) in zip(factors, terms, strict=True)]
        )

    def sum(self, terms: Iterable[Term]) -> Term:
        """Return a term of at most one variable that stands for the sum."""
        merged = _merged(terms)
        if not merged:
            return _constant(0.0)
        if len(merged) == 1 and (
            len(merged[0][1]) == 0 or (len(merged[0][1]) == 1 and abs(merged[0][0]) == 1)
        ):
            return merged[0]
        return self.name_of(merged)

    def name_of(self, terms: Iterable[Term]) -> Term:
        """Add a statement for the sum and return its name as a term."""
        name = f"t{len(self.sums) + 1}"
        self.sums.append(Sum(name, tuple(terms)))
        return 1.0, (name,)

    def program(self, torques: Iterable[Iterable[Term]]) -> GravityProgram:
        """Return the program without what no torque needs, names numbered through."""
        last = tuple(tuple(_merged(terms)) for terms in torques)
        needed = {name for terms in last for _, names in terms for name in names}
        kept: list[Sum] = []
        for statement in reversed(self.sums):
            if statement.name in needed:
                kept.append(statement)
                needed.update(name for _, names in statement.terms for name in names)
        kept.reverse()
        new = {s.name: f"t{i + 1}" for i, s in enumerate(kept)}

        def renamed(terms: Iterable[Term]) -> Terms:
            return tuple((x, tuple(new.get(name, name) for name in names)) for x, names in terms)

        return GravityProgram(
            len(last),
            tuple(w for w in self.waves if w.name in needed),
            tuple(Sum(new[s.name], renamed(s.terms)) for s in kept),
            tuple(renamed(terms) for terms in last),
        )


def _merged(terms: Iterable[Term]) -> list[Term]:
    """Add up terms of the same variables and drop those that vanish."""
    total: dict[tuple[str, ...], float] = {}
    for factor, names in terms:
        key = tuple(sorted(names))
        total[key] = total.get(key, 0.0) + factor
    return [(factor, names) for names, factor in total.items() if factor != 0]
