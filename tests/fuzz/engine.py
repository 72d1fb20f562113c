"""Fuzz of exact arithmetic: sums compared with a textbook Cantor on python-flint's polynomials, group laws, brute-force
counts.

The textbook is :mod:`tests.jacobian.addition.flint_cantor`. Everything is exact: any difference is an error.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from random import Random
from typing import Any

from jacobian import poly
from jacobian.errors import Infeasible, NotRepresentable
from tests.fuzz.case import Case, Complaint
from tests.fuzz.curves import Curve, curve_lines, field_of, power_text, random_curve
from tests.fuzz.run import Suite
from tests.jacobian.addition.flint_cantor import FlintCantor
from tests.jacobian.group_curves import inside, outside

F256, F243 = power_text(2, 8), power_text(3, 5)
SMALL = ("GF(2)", "GF(3)", "GF(5)", "GF(7)", "GF(11)", power_text(2, 2), power_text(2, 3), power_text(3, 2))
MIDDLE = ("GF(101)", "GF(251)", "GF(101)", "GF(1009)", F256, F243, power_text(7, 2))
MOST_PAIRS = 20000
# seconds: exact numbers grow, and first calls may compile
LIMIT = 10.0


def summands(curve: Curve, rng: Random) -> str:
    """Lines that make D and E in one of many relative positions."""
    D, E = (f"J.random(Random({rng.randrange(10**6)}))" for _ in range(2))
    P = f"C.random_point(Random({rng.randrange(10**6)}))"
    choices = [
        (f"D = {D}", f"E = {E}"),
        (f"D = {D}", f"E = {E}"),
        (f"D = {D}", "E = D"),
        (f"D = {D}", "E = -D"),
        (f"D = {D}", "E = J.zero()"),
        (f"D = {D}", f"F = {E}", "E = F - D"),
        (f"D = {D}", f"E = D + {E}", "D = -E"),
    ]
    if curve.C.model != "inert":
        choices += [
            (f"P = {P}", "D = J(P)", "E = J(C.involution(P))"),
            (f"P = {P}", "D = J(P)", "E = D"),
            (f"P = {P}", f"D = {D}", "E = D + J(P)"),
            (f"P = {P}", f"D = {D}", "E = J(P) - D"),
            (f"P = {P}", "D = 3 * J(P)", "E = -2 * J(P)"),
        ]
    if curve.C.model == "split":
        choices += [(f"D = {D}", "E = J(*C.points_at_infinity())"), ("D = J(*C.points_at_infinity())", f"E = {E}")]
    return "\n".join(rng.choice(choices)) + "\n"


def textbook_sum(rng: Random) -> Case:
    curve = random_curve(rng)
    call = rng.choice(("D + E", "D + E", "D - E", "D.double()", "3 * D - 2 * E", "J.combination([5, -3], [D, E])"))
    m, n = {"D + E": (1, 1), "D - E": (1, -1), "D.double()": (2, 0), "3 * D - 2 * E": (3, -2)}.get(call, (5, -3))
    return Case(curve.setup + summands(curve, rng), call, lambda names: _by_textbook(names, m, n), _only_points, LIMIT)


# points that a small field lacks, and inert curves of odd genus
_only_points = (NotRepresentable,)


def _by_textbook(names: dict[str, Any], m: int, n: int) -> Complaint | None:
    J, got = names["J"], names["got"]
    book = FlintCantor(J.curve.arithmetic_model)
    terms = [_multiple(book, k, inside(X)) for k, X in ((m, names["D"]), (n, names["E"])) if k]
    total = terms[0] if len(terms) == 1 else book.add(*terms)
    right = outside(J, book.convert_back(total))
    if (got.u, got.v, got.n) == (right.u, right.v, right.n):
        return None
    return Complaint("not the textbook's sum", _triple(right), "(got.u, got.v, got.n) == expected")


def _multiple(book: FlintCantor, m: int, triple: Any) -> Any:
    found = book.multiply(abs(m), book.convert(triple))
    if m > 0:
        return found
    u, v, n = found
    v = (-book.h - v) % u
    n = None if n is None else 2 * ((book.genus + 1) // 2) - u.degree() - n
    while n is not None and not 0 <= n <= book.genus - u.degree():
        part = book.minus if n < 0 else book.plus
        u, v, n = book.reflect(u, part + (v - part) % u, n)
    return u * (1 / u.leading_coefficient()), v % u, n


def _triple(D: Any) -> str:
    u, v = ("".join(f"{c}, " if isinstance(c, int) else f"C.field.coerce({str(c)!r}), " for c in a) for a in (D.u, D.v))
    return f"(({u}), ({v}), {D.n})"


def true(setup: str, checks: list[str], refusals: Any = _only_points, limit: float = LIMIT) -> Case:
    """A case that calls a list of expressions, all of which must be true."""

    def judge(names: dict[str, Any]) -> Complaint | None:
        wrong = [check for check, holds in zip(checks, names["got"], strict=True) if not bool(holds)]
        return Complaint(f"not true: {'; '.join(wrong)}", "True", "all(got)") if wrong else None

    return Case(setup, "[" + ", ".join(checks) + "]", judge, refusals, limit)


def axioms(rng: Random) -> Case:
    curve = random_curve(rng)
    m, n = (rng.choice((-1, 1)) * rng.randrange(1 << rng.choice((3, 8, 40))) for _ in range(2))
    if curve.C.field.order is None:
        m, n = m % 7, n % 5
    setup = curve.setup + summands(curve, rng) + f"F = J.random(Random({rng.randrange(10**6)}))\n"
    checks = [
        "(D + E) + F == D + (E + F)",
        "D + E == E + D",
        "D - E + E == D",
        "D + J.zero() == D",
        "not D - D",
        f"{m} * D + {n} * D == {m + n} * D",
        f"J.fixed_base(D)({m}) == {m} * D",
        "-(D + E) == -D - E",
        "hash(D + E) == hash(E + D)",
    ]
    return true(curve.setup and setup, checks)


def batch(rng: Random) -> Case:
    """Rows of every shape: as an array, and one by one."""
    curve = random_curve(rng)
    m = rng.randrange(-50, 51) if curve.C.field.order is not None else rng.randrange(-2, 3)
    setup = (
        curve.setup
        + "from jacobian.batch import DivisorArray\n"
        + summands(curve, rng)
        + f"F, G = J.random(Random({rng.randrange(10**6)})), J.random(Random({rng.randrange(10**6)}))\n"
        "rows = [D, E, F, G, J.zero(), -D, D + E, F, D, -F, E, J.zero()]\n"
        f"other = Random({rng.randrange(10**6)}).sample(rows, len(rows))\n"
        "A, B = DivisorArray.stack(rows), DivisorArray.stack(other)\n"
    )
    checks = [
        "(A + B).to_list() == [x + y for x, y in zip(rows, other)]",
        "(A - B).to_list() == [x - y for x, y in zip(rows, other)]",
        "A.double().to_list() == [x + x for x in rows]",
        f"({m} * A).to_list() == [{m} * x for x in rows]",
        "(-A).to_list() == [-x for x in rows]",
        "A.sum() == sum(rows[1:], rows[0])",
        "(A == B).tolist() == [x == y for x, y in zip(rows, other)]",
        "(DivisorArray.from_arrays(J, A.u, A.v, A.n) == A).all()",
    ]
    return true(setup, checks)


def counted(rng: Random) -> Case:
    """#J over tiny fields compared with a search through all Mumford pairs, and with the list of classes."""
    text = rng.choice(SMALL)
    K = field_of(text)
    most = max(g for g in range(1, 7) if K.order ** (2 * g) <= MOST_PAIRS)
    curve = random_curve(rng, text, rng.randrange(1, most + 1))
    if field_of(text) is not curve.C.field or curve.C.genus > most:
        return counted(rng)
    return Case(
        curve.setup,
        "(J.order(), len(set(J.points())))",
        lambda names: _by_trying(names["C"], names["got"]),
        limit=LIMIT,
    )


def _by_trying(C: Any, got: Any) -> Complaint | None:
    book = FlintCantor(C.arithmetic_model)
    f, h, g, elements = book.f, book.h, C.genus, list(C.field.elements())
    total = 0
    for degree in range(0, g + 1, 2 if C.model == "inert" else 1):
        pairs = 0
        vs = [book.into(v) for v in product(elements, repeat=degree)]
        values = [v * (v + h) - f for v in vs]
        for low in product(elements, repeat=degree):
            u = book.into((*low, C.field.one))
            pairs += sum((value % u).is_zero() for value in values)
        total += pairs * (g - degree + 1 if C.model == "split" else 1)
    return None if got == (total, total) else Complaint(f"{got}", f"{(total, total)}", "got == expected")


def orders(rng: Random) -> Case:
    text = rng.choice(MIDDLE + SMALL)
    curve = random_curve(rng, text, rng.choice((1, 2, 2, 3)))
    setup = curve.setup + f"D = J.random(Random({rng.randrange(10**6)}))\nN, P = J.order(), J.frobenius_polynomial()\n"
    checks = [
        "not N * D",
        "N == sum(P)",
        "N % D.order() == 0",
        "not D.order() * D",
        "all(D.order() % p or (D.order() // p) * D for p in (2, 3, 5, 7, 11, 13))",
        "not sum((c * J.frobenius(D, C.field.degree * i) for i, c in enumerate(P)), J.zero())"
        if "," in text
        else "not sum((c * J.frobenius(D, i) for i, c in enumerate(P)), J.zero())",
    ]
    return true(setup, checks, (NotRepresentable, Infeasible))


def huge_multiples(rng: Random) -> Case:
    """Scalars of up to 17,000 bits compared with their remainders modulo the order of the group."""
    curve = random_curve(rng, rng.choice(MIDDLE + SMALL), rng.choice((1, 2, 2, 3)))
    m = rng.choice((-1, 1)) * (10 ** rng.choice((400, 1300, 5000)) + rng.randrange(10**6))
    setup = curve.setup + f"D, m, N = J.random(Random({rng.randrange(10**6)})), {m:#x}, J.order()\n"
    checks = ["m * D == m % N * D", "J.combination([m, 1], [D, D]) == (m + 1) % N * D", "J.fixed_base(D)(m) == m * D"]
    return true(setup, checks, (NotRepresentable, Infeasible))


def structures(rng: Random) -> Case:
    curve = random_curve(rng, rng.choice(SMALL + MIDDLE), rng.choice((1, 2, 2)))
    setup = curve.setup + "from math import prod\nS = J.structure()\n"
    checks = [
        "prod(S.invariants) == J.order()",
        "all(b % a == 0 for a, b in zip(S.invariants, S.invariants[1:]))",
        "[G.order() for G in S.generators] == list(S.invariants)",
        "J.exponent() == (S.invariants[-1] if S.invariants else 1)",
    ]
    return true(setup, checks, (NotRepresentable, Infeasible))


def pairings(rng: Random) -> Case:
    """Bilinear and alternating on torsion over small fields."""
    curve = random_curve(rng, rng.choice(SMALL + MIDDLE), rng.choice((1, 2, 2, 3)))
    setup = (
        curve.setup + "K, N = C.field, J.order()\n"
        "m = next((m for m in (7, 5, 3, 2, 1) if N % m == 0 and m % K.characteristic), 1)\n"
        "T = list(J.torsion(m).generators) or [J.zero()]\n"
        f"rng = Random({rng.randrange(10**6)})\n"
        "D, E, F = (sum((rng.randrange(m) * G for G in T), J.zero()) for _ in range(3))\n"
        "e = lambda X, Y: J.weil_pairing(X, Y, m)\n"
    )
    checks = [
        "e(D + E, F) == K.mul(e(D, F), e(E, F))",
        "e(D, E + F) == K.mul(e(D, E), e(D, F))",
        "e(D, D) == K.one",
        "K.mul(e(D, E), e(E, D)) == K.one",
    ]
    return true(setup, checks, (NotRepresentable, Infeasible))


def logarithms(rng: Random) -> Case:
    curve = random_curve(rng, rng.choice(SMALL + MIDDLE), rng.choice((1, 2, 2, 3)))
    a, m = rng.randrange(10**6), rng.randrange(10**9)
    setup = curve.setup + f"D = J.random(Random({a}))\nE = {m} * D\nfound = J.log(D, E)\n"
    return true(setup, ["found * D == E", "0 <= found < D.order()"], (NotRepresentable, Infeasible))


def supports(rng: Random) -> Case:
    curve = random_curve(rng)
    P, Q = (f"C.random_point(Random({rng.randrange(10**6)}))" for _ in range(2))
    setup = (
        curve.setup
        + f"P, Q = {P}, {Q}\npoints = {rng.choice(('[P, Q]', '[P, P]', '[P, Q, P, Q]', '[P, C.involution(P)]'))}\n"
        "D = J.from_points(points)\nagain = [P for P, k in D.support() for _ in range(k)]\n"
    )
    odd = curve.C.model == "split" and curve.C.genus % 2
    checks = ["J.from_points(points[::-1]) == D"]
    if not odd:
        checks += ["J.from_points(again) == D" if curve.C.model != "split" else "len(again) <= C.genus + 1"]
    return true(setup, checks)


def ray_classes(rng: Random) -> Case:
    curve = random_curve(rng, rng.choice(SMALL + MIDDLE + ("GF(2**61 - 1)",)), rng.choice((1, 2, 3)))
    K = curve.C.field
    x0 = None if rng.random() < 0.3 else rng.randrange(K.order)
    setup = (
        curve.setup + f"from jacobian.relatives.ray_class import RayClassGroup\nR = RayClassGroup(C, {x0})\n"
        f"a, b, c = (R.random(Random(s)) for s in {[rng.randrange(10**6) for _ in range(3)]})\n"
    )
    m, n = rng.randrange(1000), rng.randrange(1000)
    checks = [
        "(a + b) + c == a + (b + c)",
        "a + b == b + a",
        "not a - a",
        "a + R.zero() == a",
        f"{m} * a + {n} * a == {m + n} * a",
        "(a + b).divisor == a.divisor + b.divisor",
        "R.lift(a.divisor).divisor == a.divisor",
    ]
    if K.order < 300 and curve.C.genus < 3:
        checks.append("not R.order() * a")
    return true(setup, checks)


def generalized(rng: Random) -> Case:
    """The Jacobian of y² = quartic with both points at infinity glued."""
    text = rng.choice(("GF(7)", "GF(101)", "GF(2**61 - 1)", F243, "QQ"))
    curve = random_curve(rng, text, 1, rng.choice(("split", "inert")))
    while curve.C.h or len(curve.C.f) != 5 or curve.C.field is not field_of(text):
        curve = random_curve(rng, text, 1, "split")
    a, b, c = (rng.randrange(10**6) for _ in range(3))
    m = rng.randrange(2, 6)
    setup = (
        curve.setup + "from jacobian.relatives.glued import GeneralizedJacobian\nG = GeneralizedJacobian(C)\n"
        f"D, E, F = (G.random(Random(s)) for s in ({a}, {b}, {c}))\n"
    )
    checks = ["(D + E) + F == D + (E + F)", "D + E == E + D", "not D - D", f"{m} * D == {m - 1} * D + D"]
    return true(setup, checks)


def conics(rng: Random) -> Case:
    """The member of a pencil through a point, its class, and steps that compose."""
    curve = random_curve(rng, rng.choice(("GF(11)", "GF(101)", "GF(2**61 - 1)", F256, F243)))
    a, b = rng.randrange(10**6), rng.randrange(10**6)
    setup = (
        curve.setup + "from jacobian.relatives.conic import representative\n"
        f"D, P, Q = J.random(Random({a})), C.random_point(Random({b})), C.random_point(Random({b + 1}))\n"
        "R = representative(D, P)\n"
    )
    return true(setup, ["R.divisor() == D", "R.containing(Q).divisor() == D", "R.containing(P) == R"])


def signed(rng: Random) -> Case:
    """Divisors with roots at branch points: a commutative group over the Jacobian."""
    text = rng.choice(("GF(101)", "GF(1009)", "GF(2**61 - 1)"))
    K = field_of(text)
    roots = rng.sample(range(K.order), 5)
    lead = rng.randrange(1, K.order)
    f = poly.scale(K, lead, poly.from_roots(K, roots))
    seeds = [rng.randrange(10**6) for _ in range(3)]
    setup = curve_lines(text, f, ()) + (
        f"from jacobian.relatives.signed import SignedGroup\nS = SignedGroup(C, {roots[:3]})\n"
        f"D, E, F = (S.double(S.twist(X.u, X.v)) for X in (J.random(Random(s)) for s in {seeds}))\n"
        "same = lambda X, Y: X[:3] == Y[:3]\n"
    )
    m = rng.randrange(3, 9)
    checks = [
        "same(S.add(S.add(D, E), F), S.add(D, S.add(E, F)))",
        "same(S.add(D, E), S.add(E, D))",
        "same(S.add(S.add(D, E), S.negate(E)), D)",
        f"same(S.multiple({m}, D), S.add(S.multiple({m - 1}, D), D))",
        "J.from_mumford(*S.add(D, E)[:2]) == J.from_mumford(*D[:2]) + J.from_mumford(*E[:2])",
    ]
    return true(setup, checks)


KINDS: dict[str, Callable[[Random], Case]] = {
    "textbook sum": textbook_sum,
    "axioms": axioms,
    "batch": batch,
    "counted": counted,
    "orders": orders,
    "huge multiples": huge_multiples,
    "structures": structures,
    "pairings": pairings,
    "logarithms": logarithms,
    "supports": supports,
    "ray classes": ray_classes,
    "generalized": generalized,
    "conics": conics,
    "signed": signed,
}
WARM = """
from random import Random
from jacobian import GF, HyperellipticCurve
from jacobian.batch import DivisorArray
for K in (GF(101), GF(2**61 - 1), GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)), GF(3, 5, (1, 2, 0, 0, 0, 1))):
    for f in ([1, 2, 0, 0, 0, 1], [1, 2, 0, 0, 0, 0, 0, 1], [1, 2, 1, 0, 0, 0, 1]):
        if K.characteristic == 2 and len(f) == 7:
            continue
        J = HyperellipticCurve(K, f, [1, 1] if K.characteristic == 2 else ()).jacobian()
        A = DivisorArray.stack([J.random(Random(k)) for k in range(6)])
        3 * (A + A.double()) - A == A
"""
SUITE = Suite("engine", KINDS, {"textbook sum": 8, "axioms": 4, "batch": 4}, {"batch": WARM})
