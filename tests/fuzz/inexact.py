"""Fuzz of inexact arithmetic: sums over RR, CC and MP(30) compared with the same sums to 600 digits.

A coefficient of (u, v) is wrong if it has lost more than 0.6 of its digits (six of sixteen are left), and its error is
also more than a thousand times its condition. The condition is the effect on it of one unit in the last place of the
coefficients of f and of the summands (:func:`exact_sums.rounding`). Each coefficient is judged relative to its own
size, so small roots are checked as closely as large ones. A sum is not judged if that unit decides all its
coefficients. A degree other than that of the exact sum is wrong if the unit moves every coefficient by less than a
sixteenth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

from tests.fuzz import exact_sums as exact
from tests.fuzz.balls import balls
from tests.fuzz.case import Case, Complaint, Undecided
from tests.fuzz.distributions import magnitude
from tests.fuzz.run import Suite

C = exact.CONTEXT
EPS = {"RR": 2.0**-52, "CC": 2.0**-52, "MP(30)": 1e-30}
FACTOR, KEPT = 1000, 0.4
# a degree counts as decided if the same unit changes every coefficient by less than this part of itself
DECIDED = 1 / 16
GENERA = (2, 2, 3, 3, 4, 5, 6)
# attempts without a point after which other abscissas are drawn
MISSES = 200


@dataclass(frozen=True)
class Setting:
    """A field, a curve y² = f(x) of float coefficients, and a generator of its points."""

    field: str
    genus: int
    f: tuple[Any, ...]
    rng: Random

    @property
    def wide(self) -> list[Any]:
        return [C.convert(c) for c in self.f]

    def point(self, x: Any) -> Any:
        """The point over a float x on a random sheet; None where there is none."""
        return exact.lifted(self.wide, C.convert(x), self.rng.choice((1, -1)))

    def abscissa(self, low: int, high: int) -> Any:
        if self.field != "CC":
            return self.rng.choice((1, -1)) * magnitude(self.rng, low, high)
        size = magnitude(self.rng, low, high)
        return complex(size * (2 * self.rng.random() - 1), size * (2 * self.rng.random() - 1))

    def points(self, count: int, low: int, high: int) -> list[Any]:
        """Points with |x| from 2^low to 2^high, or as near to that range as the curve has points: f > 0 at 0 and far
        away.
        """
        found: list[Any] = []
        missed = 0
        while len(found) < count:
            wider = missed // MISSES
            P = self.point(self.abscissa(low - wider, high + wider))
            if P is None:
                missed += 1
            else:
                found.append(P)
        return found

    def near(self, P: Any, distance: float, sign: int) -> Any:
        """A point at the given relative distance from P or its opposite, over a number of the field; P itself where
        there is none.
        """
        x = P[0] * (1 + C.convert(distance))
        x = C.convert(complex(x) if self.field == "CC" else float(x))
        Q = exact.lifted(self.wide, x, 1)
        if Q is None:
            return P[0], sign * P[1]
        same = abs(Q[1] - P[1]) < abs(Q[1] + P[1])
        return Q if same == (sign > 0) else (Q[0], -Q[1])

    @property
    def setup(self) -> str:
        name = self.field.split("(")[0]
        return (
            f"from jacobian import {name}, HyperellipticCurve\n"
            f"C = HyperellipticCurve({self.field}, {list(self.f)})\nJ = C.jacobian()\n"
        )

    def text(self, points: Any) -> str:
        """The points as numbers of the field: x exactly, y rounded once."""
        return "[" + ", ".join(f"({self._number(x)}, {self._number(y)})" for x, y in points) + "]"

    def _number(self, x: Any) -> str:
        if self.field == "RR":
            return repr(float(x))
        if self.field == "CC":
            return repr(complex(x))
        return repr(C.nstr(x, 40))


def setting(rng: Random, field: str | None = None, genus: int | None = None) -> Setting:
    field = field or rng.choice(("RR", "RR", "RR", "CC", "MP(30)"))
    genus = genus or rng.choice(GENERA)
    size = 2 * genus + 2 + (genus % 2 == 0 and rng.random() < 0.15)

    def number() -> Any:
        x = 4 * rng.random() - 2
        return complex(x, 4 * rng.random() - 2) if field == "CC" else x

    f = [number() for _ in range(size)]
    if field != "CC":
        f[0], f[-1] = abs(f[0]), abs(f[-1])
    return Setting(field, genus, tuple(f), rng)


def sum_case(at: Setting, first: Any, second: Any) -> Case:
    """D + E for two lists of points."""
    setup = at.setup + f"D = J.from_points({at.text(first)})\nE = J.from_points({at.text(second)})\n"
    return Case(
        setup, "D + E", lambda names: judged(names["got"], at, [first, second]), limit=3 if "MP" in at.field else 1
    )


def judged(got: Any, at: Setting, summands: Any) -> Complaint | None:
    f = at.wide
    u, v = exact.total(f, at.genus, [P for part in summands for P in part])
    if len(u) - 1 > at.genus:
        raise Undecided("the sum has a point at infinity")
    right = exact.flat((u, v))
    if len(got.u) != len(u):
        noise = exact.rounding(f, at.genus, summands, EPS[at.field])
        if any(x >= DECIDED * abs(y) for x, y in zip(noise, right, strict=True)):
            raise Undecided("rounding of the summands decides the degree")
        return Complaint(f"degree {len(got.u) - 1} for {len(u) - 1}", f"{len(u)}", "len(got.u) == expected")
    found = [C.convert(c) for c in (*got.u[:-1], *got.v)]
    errors = [abs(x - y) for x, y in zip(found, right, strict=True)]
    eps = EPS[at.field]
    if all(e <= eps**KEPT * abs(y) for e, y in zip(errors, right, strict=True)):
        return None
    noise = exact.rounding(f, at.genus, summands, eps)
    allowed = [FACTOR * x + eps**KEPT * abs(y) for x, y in zip(noise, right, strict=True)]
    if all(a > abs(y) for a, y in zip(allowed, right, strict=True)):
        raise Undecided("rounding of the summands decides")
    i = max(range(len(right)), key=lambda k: errors[k] / allowed[k] if allowed[k] else C.inf * (errors[k] > 0))
    if errors[i] <= allowed[i]:
        return None
    place = f"(*got.u[:-1], *got.v)[{i}]"
    number = at._number(right[i])
    return Complaint(
        f"coefficient {i}: off by {C.nstr(errors[i] / abs(right[i]), 2)} of itself, allowed "
        f"{C.nstr(allowed[i] / abs(right[i]), 2)}",
        f"C.field.coerce({number})",
        f"abs({place} - expected) <= {C.nstr(allowed[i], 3)}",
    )


# --- kinds


def mixed(rng: Random) -> Case:
    """Points of |x| from 2^-30 to 2^30, each of its own size."""
    at = setting(rng)
    return sum_case(at, at.points(at.genus, -30, 30), at.points(rng.randrange(1, at.genus + 1), -30, 30))


def large(rng: Random) -> Case:
    """All points of one size."""
    at = setting(rng)
    low = rng.randrange(-30, 29)
    return sum_case(at, at.points(at.genus, low, low + 2), at.points(at.genus, low, low + 2))


def moderate(rng: Random) -> Case:
    at = setting(rng)
    return sum_case(at, at.points(at.genus, -2, 2), at.points(rng.randrange(1, at.genus + 1), -2, 2))


def cluster(rng: Random) -> Case:
    """The points of a divisor near each other."""
    at = setting(rng)
    distance = 2.0 ** -rng.randrange(1, 16)
    parts = []
    for _ in range(2):
        (P,) = at.points(1, -3, 3)
        parts.append([P, *(at.near(P, k * distance, 1) for k in range(1, at.genus))])
    return sum_case(at, *parts)


def one_cluster(rng: Random) -> Case:
    """The points of both divisors near one point."""
    at = setting(rng)
    (P,) = at.points(1, -3, 3)

    def part(count: int) -> list[Any]:
        return [
            at.near(P, 10.0 ** rng.uniform(-8, -1) * rng.choice((1, -1)), rng.choice((1, -1))) for _ in range(count)
        ]

    while True:
        parts = part(rng.randrange(1, at.genus + 1)), part(rng.randrange(1, at.genus + 1))
        points = [*parts[0], *parts[1]]
        if len({x for x, _ in points}) == len(points):
            return sum_case(at, *parts)


def near_double(rng: Random) -> Case:
    """E at any distance of D, down to D itself."""
    at = setting(rng)
    size = rng.choice((2, 2, 20))
    first = at.points(at.genus, -size, size)
    distance = rng.choice((0.0, 2.0 ** -rng.randrange(2, 52)))
    return sum_case(at, first, [at.near(P, distance, 1) for P in first])


def near_opposite(rng: Random) -> Case:
    """Some points of E at any distance of opposites of points of D."""
    at = setting(rng)
    first = at.points(at.genus, -2, 2)
    distance = 2.0 ** -rng.randrange(2, 50)
    count = rng.randrange(1, at.genus + 1)
    second = [at.near(P, distance, -1) for P in first[:count]] + at.points(at.genus - count, -2, 2)
    return sum_case(at, first, second)


def scaled(rng: Random) -> Case:
    """Moderate points moved to another size together with their curve: x → 4^k x."""
    at = setting(rng)
    k = rng.randrange(-15, 16)
    size = len(at.f) - 1
    moved = Setting(at.field, at.genus, tuple(c * 4.0 ** (k * (size - i)) for i, c in enumerate(at.f)), rng)
    return sum_case(moved, moved.points(at.genus, 2 * k - 2, 2 * k + 2), moved.points(at.genus, 2 * k - 2, 2 * k + 2))


def from_points(rng: Random) -> Case:
    """(u, v) of points of all sizes in any order."""
    at = setting(rng)
    size = rng.choice((2, 10, 30))
    points = at.points(at.genus, -size, size)
    if rng.random() < 0.2:
        points[-1] = points[0]
    rng.shuffle(points)
    return Case(at.setup, f"J.from_points({at.text(points)})", lambda names: judged(names["got"], at, [points]))


def batch(rng: Random) -> Case:
    """Rows of floats in genus 2, one time in three of any genus and field."""
    at = setting(rng) if rng.random() < 1 / 3 else setting(rng, rng.choice(("RR", "CC")), 2)
    size, count = rng.choice((1, 2, 10, 20, 30)), 4
    rows = [(at.points(at.genus, -size, size), at.points(at.genus, -size, size)) for _ in range(count)]
    made = [", ".join(f"J.from_points({at.text(row[k])})" for row in rows) for k in (0, 1)]
    setup = (
        at.setup
        + "from jacobian.batch import DivisorArray\n"
        + "".join(f"{name} = DivisorArray.stack([{text}])\n" for name, text in zip("AB", made, strict=True))
    )

    def judge(names: dict[str, Any]) -> Complaint | None:
        for i, summands in enumerate(rows):
            if names["status"][i]:
                continue
            complaint = judged(names["got"][i], at, list(summands))
            if complaint:
                return Complaint(
                    f"row {i}: {complaint.why}", complaint.expected, complaint.check.replace("got", f"got[{i}]")
                )
        return None

    setup += "total = A + B\nstatus = total.status.tolist()\n"
    return Case(setup, "[total[i] if s == 0 else None for i, s in enumerate(status)]", judge, limit=4)


def abel(rng: Random) -> Case:
    """A(D + E) = A(D) + A(E) modulo periods, and D from A(D)."""
    at = setting(rng, rng.choice(("RR", "RR", "CC")), rng.choice((2, 2, 3)))
    size = rng.choice((1, 2, 2, 10))
    points = [at.points(at.genus, -size, size) for _ in range(2)]
    setup = (
        at.setup + "from jacobian.periods.abel import AbelMap\n"
        f"A, D, E = AbelMap(C), J.from_points({at.text(points[0])}), J.from_points({at.text(points[1])})\n"
        "far = lambda z: max(abs(x - round(x.real)) for x in A.periods.coordinates(z))\n"
    )
    call = rng.choice(("far([x + y - z for x, y, z in zip(A(D), A(E), A(D + E))])", "A.inverse(A(D))"))
    if "inverse" not in call:
        return Case(setup, call, _small, limit=5)
    return Case(setup, call, lambda names: _same_divisor(names, at, points[0]), limit=10)


def _small(names: dict[str, Any]) -> Complaint | None:
    return None if names["got"] < 1e-6 else Complaint(f"{names['got']} of a period", "0", "got < 1e-6")


def _same_divisor(names: dict[str, Any], at: Setting, points: Any) -> Complaint | None:
    u, v = exact.pair(at.wide, points)
    right = exact.flat((u, v))
    found = [C.convert(c) for c in (*names["got"].u[:-1], *names["got"].v)]
    if len(found) != len(right):
        return Complaint("another degree", f"{len(u)}", "len(got.u) == expected")
    radius = max(abs(x) for x, _ in points)
    sizes = [radius ** (at.genus - i) for i in range(at.genus)] + [
        max(abs(c) * radius**j for j, c in enumerate(v)) / radius**i for i in range(at.genus)
    ]
    errors = [float(abs(x - y) / s) for x, y, s in zip(found, right, sizes, strict=True)]
    if max(errors) < 1e-3:
        return None
    return Complaint(f"off by {max(errors):.1e}", "D", "abs(got.u[0] - D.u[0]) < 1e-3 * abs(D.u[0])")


WARM = """
from jacobian import CC, RR, HyperellipticCurve
from jacobian.batch import DivisorArray
for K in (RR, CC):
    J = HyperellipticCurve(K, [1, 0, 0, 0, 0, 1]).jacobian()
    A = DivisorArray.stack([J.from_points([(0.5, J.curve.lift_x(0.5).y)])] * 4)
    (A + A + A).to_list()
"""

KINDS: dict[str, Callable[[Random], Case]] = {
    "moderate": moderate,
    "mixed": mixed,
    "large": large,
    "cluster": cluster,
    "one cluster": one_cluster,
    "near double": near_double,
    "near opposite": near_opposite,
    "scaled": scaled,
    "from points": from_points,
    "batch": batch,
    "abel": abel,
    "balls": balls,
}
SUITE = Suite("inexact", KINDS, {"moderate": 2, "mixed": 4, "large": 4}, {"batch": WARM})
