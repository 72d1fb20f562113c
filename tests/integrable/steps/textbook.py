"""Steps over small prime fields by textbook formulas, in Python's ints: nothing of the packages is imported.

A state becomes (U, V) by U = Σr_i(gγ_i)²(x − a_j)(x − a_k), V = Σr_i gγ_i n_i(x − a_j)(x − a_k), n = 2γ × M + 2gd(Aγ, γ
× M)gγ, r_i = 1 − da_i; a sum is found by trying every polynomial P that passes through the summands.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product as choices
from typing import Any

Poly = list[int]
Pair = tuple[Poly, Poly]


class Body:
    """A ball, or a top for d = 0, over GF(p)."""

    def __init__(self, p: int, inertia: Sequence[int], d: int) -> None:
        self.p, self.d = p, d
        self.a = [pow(x + d, -1, p) for x in inertia]

    def pair(self, gamma: Any, M: Any, g: int | None) -> Pair:
        p, a, d = self.p, self.a, self.d
        root = 1 if g is None else g
        w = cross(gamma, M)
        lean = 2 * root * d * sum(x * y * z for x, y, z in zip(a, gamma, w, strict=True))
        U, V = [0, 0, 0], [0, 0, 0]
        for i in range(3):
            two = [a[i - 2] * a[i - 1], -a[i - 2] - a[i - 1], 1]
            sigma, nu = root * gamma[i], 2 * w[i] + lean * root * gamma[i]
            r = 1 - d * a[i]
            U = [u + r * sigma * sigma * t for u, t in zip(U, two, strict=True)]
            V = [v + r * sigma * nu * t for v, t in zip(V, two, strict=True)]
        assert V[2] % p == 0
        return [x % p for x in U], [x % p for x in V[:2]]

    def energies(self, gamma: Any, M: Any) -> tuple[int, int]:
        p, a, d = self.p, self.a, self.d
        lean = sum(x * y * z for x, y, z in zip(a, gamma, M, strict=True))
        below = 1 - d * sum(x * y * y for x, y in zip(a, gamma, strict=True))
        h1 = sum(x * m * m for x, m in zip(a, M, strict=True)) + d * lean * lean * pow(below, -1, p)
        return h1 % p, sum(m * m for m in M) % p

    def curve(self, gamma: Any, M: Any) -> Poly:
        """f = 4(1 − dx)Π(a_i − x)(xh2 − h1)."""
        h1, h2 = self.energies(gamma, M)
        f = times(self.p, [4, -4 * self.d], [-h1, h2])
        for e in self.a:
            f = times(self.p, f, [e, -1])
        return f


def cross(x: Any, y: Any) -> list[int]:
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def times(p: int, x: Poly, y: Poly) -> Poly:
    found = [0] * (len(x) + len(y) - 1)
    for i, a in enumerate(x):
        for j, b in enumerate(y):
            found[i + j] += a * b
    return [c % p for c in found]


def less(p: int, x: Poly, y: Poly) -> Poly:
    """x − y, without leading zeros."""
    size = max(len(x), len(y))
    found = [(a - b) % p for a, b in zip(x + [0] * (size - len(x)), y + [0] * (size - len(y)), strict=True)]
    while found and not found[-1]:
        found.pop()
    return found


def at(p: int, a: Sequence[int], x: int) -> int:
    return sum(int(c) * x**i for i, c in enumerate(a)) % p


def divided(p: int, x: Poly, monic: Poly) -> tuple[Poly, Poly]:
    """(quotient, rest)."""
    rest, m = list(x), len(monic) - 1
    for i in range(len(rest) - m - 1, -1, -1):
        for j in range(m):
            rest[i + j] = (rest[i + m] * -monic[j] + rest[i + j]) % p
    return rest[m:], less(p, rest[:m], [])


def through(p: int, D: Pair, degree: int) -> Iterator[Poly]:
    """Every P of at most that degree with P ≡ V mod U."""
    u, v = D
    for c in choices(range(p), repeat=degree - len(u) + 2):
        yield less(p, times(p, u, list(c)) if c else [], [-x for x in v])


def opposite(p: int, D: Pair) -> Pair:
    return D[0], [-x % p for x in D[1]]


def sum_of(p: int, f: Poly, D: Pair, E: Pair) -> Pair | None:
    """The (U, V) of degree two with P² − f = b·U_D·U_E·U, P ≡ −V mod U, for a P through D and E: this is D + E for f of
    odd degree, and for even degree the sum in the generalized Jacobian. None where there is none.
    """
    found, both = [], times(p, D[0], E[0])
    for P in through(p, D, len(both) - 2):
        if divided(p, less(p, P, E[1]), E[0])[1]:
            continue
        rest = less(p, times(p, P, P) if P else [], f)
        quotient, left = divided(p, rest, both)
        if left or len(quotient) != 3:
            continue
        u = [c * pow(quotient[-1], -1, p) % p for c in quotient]
        found.append((u, _residue(p, P, u)))
    return found[0] if len(found) == 1 else None


def _residue(p: int, P: Poly, u: Poly) -> Poly:
    """−P mod U as two coefficients."""
    v = divided(p, [-x % p for x in P], u)[1]
    return v + [0] * (2 - len(v))


def member(p: int, f: Poly, D: Pair, P: Poly) -> Pair | None:
    """The zeros of y − P other than (U, P), reflected; None if one of them is at infinity."""
    quotient = divided(p, less(p, times(p, P, P) if P else [], f), D[0])[0]
    if len(quotient) != 3:
        return None
    u = [c * pow(quotient[-1], -1, p) % p for c in quotient]
    return u, _residue(p, P, u)


def added(p: int, e: Sequence[int], P: Any, Q: Any) -> Any:
    """P + Q on Y² = 4Π(Z − e_i), None for infinity: the chord, or the tangent."""
    if P is None or Q is None:
        return Q if P is None else P
    (x, y), (z, w) = P, Q
    if x == z and (y + w) % p == 0:
        return None
    if x == z:
        slope = 4 * sum((x - e[i - 2]) * (x - e[i - 1]) for i in range(3)) * pow(2 * y, -1, p)
    else:
        slope = (w - y) * pow(z - x, -1, p)
    third = (slope * slope * pow(4, -1, p) + sum(e) - x - z) % p
    return third, (slope * (x - third) - y) % p
