"""The structure of the group: invariant factors, generators, m-torsion, divisibility.

The group is taken apart into its Sylow subgroups. One is grown from random elements: the relation of a new element to
the generators is found by discrete logarithms (Pohlig and Hellman 1978, generalised to several generators as in
Teske 1999 and Sutherland 2011), and the relation matrix is diagonalised over the integers localised at the prime. It
is complete when its order is the power of the prime in #J, so nothing here is left to chance but the time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import gcd, isqrt, lcm, prod
from random import Random
from typing import TYPE_CHECKING, Any, NamedTuple

from jacobian.errors import ArgumentError, Infeasible
from jacobian.finite.integers import factorization
from jacobian.law.divisor import check_scalar

if TYPE_CHECKING:
    from jacobian.law.divisor import Divisor, GroupLaw

FULL_TABLE = 4096
LARGEST_TABLE = 1 << 21


class Structure(NamedTuple):
    """A finite group ⊕ Z/d_i: ``invariants`` d_1 | d_2 | … all > 1, and independent ``generators`` of these orders."""

    invariants: tuple[int, ...]
    generators: tuple[Any, ...]

    @property
    def order(self) -> int:
        """Π d_i."""
        return prod(self.invariants)

    @property
    def exponent(self) -> int:
        """The largest order of an element: the last d_i."""
        return self.invariants[-1] if self.invariants else 1

    def elements(self) -> Iterator[Any]:
        """All elements but none twice, zero first; nothing when there are no generators to name zero by."""
        if not self.generators:
            return
        zero = self.generators[0].jacobian.zero()
        yield from (element for _, element in _combinations(zero, self.generators, self.invariants))


def _combinations(start: Any, steps: Any, counts: Any) -> Iterator[tuple[tuple[int, ...], Any]]:
    """(c, start + Σ c_i steps_i) for all 0 ≤ c_i < counts_i, one addition each."""
    if not steps:
        yield (), start
        return
    for c in range(counts[-1]):
        for head, element in _combinations(start, steps[:-1], counts[:-1]):
            yield (*head, c), element
        start = start + steps[-1]


class PrimaryGroup:
    """A group of ℓ-power order with independent ``generators`` of orders ℓ^``exponents``, descending; starts as {0}."""

    def __init__(self, zero: Divisor, prime: int) -> None:
        self.zero = zero
        self.prime = prime
        self.generators: list[Divisor] = []
        self.exponents: list[int] = []
        self._tables: dict[int, dict[Divisor, tuple[int, ...]]] = {}

    @property
    def order(self) -> int:
        """ℓ to the sum of the exponents."""
        return int(self.prime ** sum(self.exponents))

    def combination(self, coefficients: Iterable[int]) -> Divisor:
        """Σ c_i · generator_i."""
        total = self.zero
        for c, generator in zip(coefficients, self.generators, strict=True):
            if c:
                total = total + c * generator
        return total

    def coordinates(self, y: Divisor) -> list[int] | None:
        """The c_i with y = Σ c_i · generator_i, or None for a y outside: digit by digit, in the elements of order ℓ."""
        top = max(self.exponents, default=0)
        if self.prime**top * y:
            return None
        digits = [0] * len(self.generators)
        for level in range(top):
            size = sum(1 for e in self.exponents if e + level >= top)
            found = self._socle_coordinates(self.prime ** (top - 1 - level) * (y - self.combination(digits)), size)
            if found is None:
                return None
            for i, c in enumerate(found):
                digits[i] += c * self.prime ** (level - top + self.exponents[i])
        return digits

    def _socle_coordinates(self, y: Divisor, size: int) -> tuple[int, ...] | None:
        """y in the elements of order ℓ that the first ``size`` generators lead to: baby steps and giant steps."""
        if not y:
            return (0,) * size
        step = self._baby_steps(size)
        table = self._tables[size]
        giants = [-step * self._socle(i) for i in range(size)]
        for high, element in _combinations(y, giants, [-(-self.prime // step)] * size):
            low = table.get(element)
            if low is not None:
                return tuple(a + step * b for a, b in zip(low, high, strict=True))
        return None

    def _socle(self, i: int) -> Divisor:
        return self.prime ** (self.exponents[i] - 1) * self.generators[i]

    def _baby_steps(self, size: int) -> int:
        full = self.prime**size <= FULL_TABLE
        step = self.prime if full else isqrt(self.prime - 1) + 1
        if size not in self._tables:
            if step**size > LARGEST_TABLE:
                raise Infeasible(
                    f"{size} generators of order {self.prime}: a discrete logarithm among them needs a table of "
                    f"{step}^{size} entries, more than {LARGEST_TABLE}"
                )
            socle = [self._socle(i) for i in range(size)]
            self._tables[size] = {e: c for c, e in _combinations(self.zero, socle, [step] * size)}
        return step

    def insert(self, x: Divisor) -> bool:
        """Enlarges the group by x, of ℓ-power order; whether it grew."""
        height, multiple = 0, x
        while (known := self.coordinates(multiple)) is None:
            multiple = self.prime * multiple
            height += 1
        if height == 0:
            return False
        size = len(self.generators)
        relations = [[self.prime**e if i == j else 0 for j in range(size + 1)] for i, e in enumerate(self.exponents)]
        relations.append([*[-c for c in known], self.prime**height])
        self._set(*_diagonalise(relations, [*self.generators, x], self.prime, sum(self.exponents) + height + 1))
        return True

    def _set(self, exponents: list[int], generators: list[Divisor]) -> None:
        pairs = sorted(zip(exponents, generators, strict=True), key=lambda pair: -pair[0])
        self.exponents = [e for e, _ in pairs if e]
        self.generators = [generator for e, generator in pairs if e]
        self._tables = {}


def _diagonalise(rows: list[list[int]], basis: list[Any], prime: int, top: int) -> tuple[list[int], list[Any]]:
    """Exponents and generators of the group of these relations, of order below ℓ^top: Smith's form modulo ℓ^top.

    The pivot is an entry of least valuation, which divides all the others; a column operation changes the generators.
    """
    modulus, exponents, done = prime**top, [], []
    basis = list(basis)
    while basis:
        valuation, i, j = min(
            (_valuation(entry, prime, top), i, j) for i, row in enumerate(rows) for j, entry in enumerate(row)
        )
        power = prime**valuation
        pivot = rows.pop(i)
        unit = pow(pivot[j] // power, -1, modulus)
        pivot = [entry * unit % modulus for entry in pivot]
        for k, entry in enumerate(pivot):
            if k != j and entry:
                # column k minus (entry/power) times column j: generator j takes up the difference
                basis[j] = basis[j] + entry // power * basis[k]
        rows = [[entry - row[j] // power * c for entry, c in zip(row, pivot, strict=True)] for row in rows]
        rows = [[entry % modulus for k, entry in enumerate(row) if k != j] for row in rows]
        exponents.append(valuation)
        done.append(basis.pop(j))
    return exponents, done


def _valuation(entry: int, prime: int, top: int) -> int:
    for e in range(top):
        if entry % prime:
            return e
        entry //= prime
    return top


def sylow_subgroup(J: GroupLaw, prime: int, rng: Any = None) -> PrimaryGroup:
    """The elements of ℓ-power order. ``rng`` is seeded by default: the same generators every time."""
    rng = Random(0) if rng is None else rng
    order, exponent = J.order(), 0
    cofactor = order
    while cofactor % prime == 0:
        cofactor //= prime
        exponent += 1
    group = PrimaryGroup(J.zero(), prime)
    while sum(group.exponents) < exponent:
        group.insert(cofactor * J.random(rng))
    return group


def structure(J: GroupLaw, primes: Iterable[int] | None = None, rng: Any = None) -> Structure:
    """The invariant factors d_1 | d_2 | … of the group, at most 2g of them, and generators of these orders.

    ``primes``: the prime factors of #J, where they are known. Time: √ℓ^r for the largest prime ℓ whose Sylow subgroup
    has rank r > 1; Infeasible beyond tables of 2^21 classes, or where #J is out of reach or cannot be factored.
    """
    rng = Random(0) if rng is None else rng
    return joined([sylow_subgroup(J, prime, rng) for prime in factorization(J.order(), primes)])


def joined(groups: list[PrimaryGroup]) -> Structure:
    """The direct sum of groups of coprime orders (Chinese remainders)."""
    rank = max((len(group.generators) for group in groups), default=0)
    invariants, generators = [], []
    for i in range(rank):
        parts = [group for group in groups if i < len(group.generators)]
        invariants.append(prod(group.prime ** group.exponents[i] for group in parts))
        generators.append(sum((group.generators[i] for group in parts[1:]), parts[0].generators[i]))
    return Structure(tuple(invariants[::-1]), tuple(generators[::-1]))


def torsion(J: GroupLaw, m: int, rng: Any = None) -> Structure:
    """The classes D with m·D = 0 over the finite field, as a group with generators; only primes of m are looked at."""
    m = _check_positive(m)
    rng = Random(0) if rng is None else rng
    groups = []
    for prime, exponent in factorization(gcd(J.order(), m)).items() if m > 1 else ():
        group = sylow_subgroup(J, prime, rng)
        exponent = _valuation(m, prime, m.bit_length())
        part = PrimaryGroup(J.zero(), prime)
        pairs = zip(group.exponents, group.generators, strict=True)
        part.generators = [prime ** max(e - exponent, 0) * generator for e, generator in pairs]
        part.exponents = [min(e, exponent) for e in group.exponents]
        groups.append(part)
    return joined(groups)


def is_divisible(D: Divisor, m: int) -> bool:
    """Whether D = m·E for a class E over the same finite field, by the coordinates of D in the Sylow subgroups."""
    m = _check_positive(m)
    J: Any = D.jacobian
    order = J.order()
    for prime in factorization(gcd(order, m)):
        group = sylow_subgroup(J, prime)
        coordinates = group.coordinates(order // group.order * D)
        if coordinates is None or any(c % gcd(m, prime**e) for c, e in zip(coordinates, group.exponents, strict=True)):
            return False
    return True


def exponent(J: GroupLaw, primes: Iterable[int] | None = None) -> int:
    """The exponent of the group: the largest invariant factor."""
    return lcm(*structure(J, primes).invariants)


def _check_positive(m: Any) -> int:
    m = check_scalar(m, "m")
    if m < 1:
        raise ArgumentError(f"m = {m}: a positive integer is needed")
    return m
