"""The lines of a page; each is computed by another module of this package."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Any, NamedTuple

from jacobian import poly
from jacobian.arithmetic.endomorphism_algebras import Algebra, Seen, seen
from jacobian.arithmetic.record import LPolynomials
from jacobian.arithmetic.sato_tate import sato_tate_groups, with_endomorphisms
from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.curve.points import AffinePoint
from jacobian.errors import FieldError, JacobianError, whole, written
from jacobian.fields import QQ
from jacobian.fields.factor import roots
from jacobian.finite.integers import factorization
from jacobian.law.divisor import Divisor
from jacobian.models.invariants import g2_invariants, igusa_clebsch_invariants, igusa_invariants
from jacobian.models.isomorphic import automorphisms
from jacobian.numbers.long_reals import BallReals
from jacobian.page.record import CONJECTURAL, NOT_KNOWN, PROVEN, Line, Page, to_digits
from jacobian.periods.endomorphisms import Endomorphisms, endomorphisms
from jacobian.periods.proven import period_balls
from jacobian.periods.real import real_period
from jacobian.relatives.generators import Generators, from_points
from jacobian.relatives.rational_torsion import RationalTorsion

SHOWN_PRIMES, SHOWN_POINTS = 5, 12
"""The numbers of L-polynomials and of points in the text of a line; its ``value`` has all points."""
MOST_HEIGHT, MOST_DIGITS = 10_000, 200


def summary(C: HyperellipticCurve, bound: int = 2**12, height: int = 1000, digits: int = 20) -> Page:
    """A page about a curve over QQ of any genus: invariants, points, torsion, periods, endomorphisms.

    ``bound``: L-polynomials are computed at the primes up to this bound, which is 64 or more. ``height``: the largest
    height of the abscissas of rational points, 1 … 10,000; ``digits``: the digits of periods and regulators, 5 … 200. A
    line that could not be computed contains the error message. FieldError over other fields.
    """
    if check_curve(C).field != QQ:
        raise FieldError(f"field = {C.field.name}: the page of a curve is that of a curve over QQ")
    bound = whole(bound, "bound", "the largest prime is an int from 64 on", 64)
    height = whole(height, "height", f"the height of x is an int, 1 … {MOST_HEIGHT}", 1, MOST_HEIGHT)
    digits = whole(digits, "digits", f"the digits are an int, 5 … {MOST_DIGITS}", 5, MOST_DIGITS)
    facts = Facts(C, bound, height, digits)
    return Page(C, tuple(line for name, source, ask in LINES for line in _asked(facts, name, source, ask)))


class Facts:
    """The arguments of :func:`summary`, and values that several lines share, computed at the first use."""

    def __init__(self, C: HyperellipticCurve, bound: int, height: int, digits: int) -> None:
        self.curve, self.bound, self.height, self.digits = C, bound, height, digits

    @cached_property
    def l_polynomials(self) -> LPolynomials:
        return self.curve.l_polynomials(self.bound)

    @cached_property
    def torsion(self) -> RationalTorsion:
        return self.curve.jacobian().rational_torsion(min(self.height, 1000))

    @cached_property
    def generators(self) -> Generators:
        return from_points(self.curve.jacobian(), self.height, self.digits)

    @cached_property
    def real_period(self) -> Any:
        return real_period(period_balls(self.curve, self.digits + 5))

    @cached_property
    def endomorphisms(self) -> Endomorphisms:
        return endomorphisms(self.curve)

    @cached_property
    def seen(self) -> Seen:
        return seen(self.endomorphisms, self.l_polynomials if self.curve.genus < 4 else None)


class Answer(NamedTuple):
    """What a :class:`Line` of a page says: the line without its name and source."""

    text: str
    value: Any
    mark: str = PROVEN


Ask = Callable[[Facts], Answer | None]


def _asked(facts: Facts, name: str, source: str, ask: Ask) -> Iterable[Line]:
    try:
        found = ask(facts)
    except JacobianError as error:
        found = Answer(str(error), None, NOT_KNOWN)
    return [Line(name, found.text, found.value, found.mark, source)] if found else []


# --- the equation


def _equation(facts: Facts) -> Answer:
    return Answer(repr(facts.curve), {a: [str(c) for c in getattr(facts.curve, a)] for a in ("f", "h")})


def _genus(facts: Facts) -> Answer:
    return Answer(f"{facts.curve.genus}; at infinity {facts.curve.model}", [facts.curve.genus, facts.curve.model])


def discriminant(C: HyperellipticCurve) -> Any:
    """2^(−4(g+1)) times the discriminant of the form h² + 4f of degree 2g + 2 (Lockhart 1994): for minimal equations of
    genus 2 it is the discriminant in the LMFDB.
    """
    F, n = C.discriminant, len(C.discriminant) - 1
    found = poly.resultant(QQ, F, poly.derivative(QQ, F)) / F[-1] * (-1) ** (n * (n - 1) // 2)
    # a root at infinity contributes this factor
    found *= F[-1] ** 2 if n == 2 * C.genus + 1 else 1
    return found / 16 ** (C.genus + 1)


def _discriminant(facts: Facts) -> Answer:
    found = discriminant(facts.curve)
    parts = [(p, e) for p, e in factorization(abs(found.numerator)).items()]
    parts += [(p, -e) for p, e in factorization(found.denominator).items()]
    sign = "−" if found < 0 else ""
    product = " · ".join(f"{p}^{e}" if e != 1 else str(p) for p, e in sorted(parts)) or "1"
    return Answer(f"{sign}{product}", str(found))


def _bad_primes(facts: Facts) -> Answer:
    found = facts.curve.bad_primes()
    return Answer(", ".join(map(str, found)) or "none", found)


def _of_genus_2(function: Callable[[HyperellipticCurve], Iterable[Any]]) -> Ask:
    def ask(facts: Facts) -> Answer | None:
        if facts.curve.genus != 2:
            return None
        found = list(function(facts.curve))
        return Answer(", ".join(map(written, found)), [str(c) for c in found])

    return ask


def _automorphisms(facts: Facts) -> Answer | None:
    if facts.curve.genus < 2:
        return None
    group = automorphisms(facts.curve)
    orders = Counter(_order(sigma, group[0]) for sigma in group)
    listed = ", ".join(f"{count} of order {n}" for n, count in sorted(orders.items()))
    value = {"order": len(group), "orders": dict(orders), "matrices": [[str(c) for c in s.matrix] for s in group]}
    return Answer(f"{len(group)}: {listed}", value)


def _order(sigma: Any, one: Any) -> int:
    power, n = sigma, 1
    while power != one:
        power, n = power * sigma, n + 1
    return n


# --- points and classes


def _points(facts: Facts) -> Answer:
    found = list(facts.curve.points(facts.height))
    rest = f" and {len(found) - SHOWN_POINTS} more" if len(found) > SHOWN_POINTS else ""
    listed = ", ".join(
        f"({written(P.x)}, {written(P.y)})" if isinstance(P, AffinePoint) else repr(P) for P in found[:SHOWN_POINTS]
    )
    value = [[str(P.x), str(P.y)] if isinstance(P, AffinePoint) else repr(P) for P in found]
    return Answer(f"{len(found)} with x of height ≤ {facts.height}: {listed}{rest}", value)


def _branch_points(facts: Facts) -> Answer:
    found = [str(x) for x in sorted(roots(QQ, facts.curve.discriminant))]
    found += ["∞"] * (facts.curve.model == "ramified")
    return Answer(", ".join(found) or "none", found)


def _group(invariants: Iterable[int]) -> str:
    return " × ".join(f"ℤ/{d}" for d in invariants) or "0"


def _pair(D: Divisor) -> dict[str, Any]:
    return {"u": [str(c) for c in D.u], "v": [str(c) for c in D.v], "n": D.n}


def _torsion(facts: Facts) -> Answer:
    found = facts.torsion
    value = {"invariants": list(found.found.invariants), "generators": [_pair(D) for D in found.found.generators]}
    text = _group(found.found.invariants)
    if not found.proven:
        text, value = f"{text}, at most {_group(found.bound)}", {**value, "bound": list(found.bound)}
    return Answer(text, value, PROVEN if found.proven else CONJECTURAL)


def _rank(facts: Facts) -> Answer | None:
    if facts.curve.genus != 2:
        return None
    size = len(facts.generators.classes)
    return Answer(f"at least {size}", size)


def _generators(facts: Facts) -> Answer | None:
    if facts.curve.genus != 2 or not (found := facts.generators.classes):
        return None
    return Answer("; ".join(map(str, found)), [_pair(D) for D in found], CONJECTURAL)


def _regulator(facts: Facts) -> Answer | None:
    if facts.curve.genus != 2 or not facts.generators.classes:
        return None
    return _ball(facts.generators.regulator, facts.digits)


def _ball(x: Any, digits: int) -> Answer:
    """The answer for a ball, with the number of its known digits, at most ``digits``."""
    text = x.str(digits)
    known = min(digits, int(x.rel_accuracy_bits() * 0.30103))
    return Answer(text, text, to_digits(known))


# --- periods and primes


def _real_period(facts: Facts) -> Answer:
    return _ball(facts.real_period, facts.digits)


def _euler_factors(facts: Facts) -> Answer | None:
    if facts.curve.genus > 3:
        return None
    L = facts.l_polynomials
    value = {p: L.polynomial(p) for p in L.p[:SHOWN_PRIMES].tolist()}
    return Answer("; ".join(f"{p}: {poly.text(QQ, tuple(map(QQ.coerce, c)), 'T')}" for p, c in value.items()), value)


def _endomorphisms(choose: Callable[[Seen], Algebra]) -> Ask:
    def ask(facts: Facts) -> Answer:
        found = choose(facts.seen)
        text = f"{found.name}, of dimension {found.dimension}"
        if facts.seen.proven:
            return Answer(text, found._asdict())
        agreed = f"; L_p agree at {facts.seen.primes} primes" if facts.seen.primes else ""
        return Answer(text + agreed, found._asdict(), to_digits(facts.endomorphisms.digits))

    return ask


def _sato_tate(facts: Facts) -> Answer | None:
    """The Sato–Tate groups that agree with the endomorphisms, sorted by how well they fit the L-polynomials."""
    genus, found = facts.curve.genus, facts.seen
    if genus > 2:
        return None
    names = with_endomorphisms(genus, found.geometric.dimension, found.geometric.commutative, found.rational.dimension)
    if found.proven:
        return Answer(names[0], names)
    fitting = [v.group for v in sato_tate_groups(facts.l_polynomials) if v.group in names]
    return Answer(" or ".join(fitting) or "none of the groups over QQ fits; take a larger bound", fitting, CONJECTURAL)


def _quotient(facts: Facts) -> Answer | None:
    """Ω·Reg/#torsion². By the conjecture of Birch and Swinnerton-Dyer this is L^(r)(1)/r! divided by #Ш and the product
    of the Tamagawa numbers, if the generators found generate J(QQ) modulo torsion and the equation is minimal.
    """
    if facts.curve.genus != 2 or not facts.torsion.proven:
        return None
    with BallReals(64 + 4 * facts.digits):
        found = facts.real_period * facts.generators.regulator / facts.torsion.found.order**2
    return _ball(found, facts.digits)


LINES: tuple[tuple[str, str, Ask], ...] = (
    ("curve", "C", _equation),
    ("genus", "C.genus, C.model", _genus),
    ("discriminant", "jacobian.page.lines.discriminant(C)", _discriminant),
    ("bad primes of the equation", "C.bad_primes()", _bad_primes),
    ("Igusa–Clebsch invariants", "jacobian.models.invariants", _of_genus_2(igusa_clebsch_invariants)),
    ("Igusa invariants", "jacobian.models.invariants", _of_genus_2(igusa_invariants)),
    ("G2 invariants", "jacobian.models.invariants", _of_genus_2(g2_invariants)),
    ("automorphisms over QQ", "jacobian.models.isomorphic.automorphisms(C)", _automorphisms),
    ("rational points", "C.points(height)", _points),
    ("rational branch points", "C.discriminant", _branch_points),
    ("torsion", "C.jacobian().rational_torsion()", _torsion),
    ("rank", "jacobian.relatives.generators", _rank),
    ("generators found", "jacobian.relatives.generators", _generators),
    ("regulator of these", "jacobian.relatives.generators", _regulator),
    ("real period", "jacobian.periods.real.real_period", _real_period),
    ("real period · regulator / torsion²", "the lines above", _quotient),
    ("L-polynomials", "C.l_polynomials(bound)", _euler_factors),
    ("endomorphisms over QQ", "jacobian.periods.endomorphisms", _endomorphisms(lambda s: s.rational)),
    ("endomorphisms over ℂ", "jacobian.periods.endomorphisms", _endomorphisms(lambda s: s.geometric)),
    ("Sato–Tate group", "jacobian.arithmetic.sato_tate", _sato_tate),
)
