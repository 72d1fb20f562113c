"""The Weil and Tate pairings on m-torsion, by Miller's algorithm (Miller 2004; Frey and Rück 1994 for Jacobians;
Galbraith, Hess and Vercauteren 2007).

Let [mD] be the reduced divisor of m·D. The function f_m with m·D = [mD] + div(f_m) is a product of functions from
Cantor's steps: composition divides out a gcd d and gives the factor d, and a reduction from (u, v) to (u', v') gives
(y − v)/u'. A function is evaluated at the affine points of a pair (u, v) by a norm, that is a resultant. Divisors are
shifted, D ~ (D + R) − R with random R of degree g, so that they are affine with disjoint supports. Then no function
needs normalising at infinity, and every model works: ramified, split, inert of even genus. Over a small field Miller's
functions would vanish at most points, so the field is extended before R is drawn.

In genus 1 over GF(p) on ramified models the function is evaluated at one point, without shifts
(:mod:`jacobian.finite.miller`).
"""

from __future__ import annotations

from collections.abc import Callable
from math import gcd
from random import Random
from typing import Any

from jacobian import poly
from jacobian.addition.cantor_flint import Flint, FlintCantor
from jacobian.curve.curve import HyperellipticCurve
from jacobian.element import Element, Rng
from jacobian.errors import ArgumentError, CurveMismatch, FieldError, Infeasible, shown
from jacobian.fields import GF
from jacobian.fields.change import change_of_field
from jacobian.fields.flint_polynomials import conversions
from jacobian.fields.irreducible import first_irreducible
from jacobian.fields.prime import prime_field
from jacobian.fields.protocol import Field
from jacobian.finite.miller import EllipticFunctions, has_functions
from jacobian.law.divisor import Divisor, check_scalar

ATTEMPTS = 200
# over a field of ROOM·g²·log₂ m elements one random shift in ten succeeds; smaller fields are extended
ROOM = 3


class _Collision(Exception):
    """A function of Miller's algorithm has a zero or a pole where it is evaluated; another shift is needed."""


def weil_pairing(D: Divisor[Element], E: Divisor[Element], m: int, rng: Rng | None = None) -> Element:
    """e_m(D, E) = f_D(E)/f_E(D), an m-th root of unity in the field, for m·D = m·E = 0 in one group; div(f_D) = m·D.

    It is bilinear, alternating, and non-degenerate on the full m-torsion (over the field that contains it). ``m``:
    positive, prime to the characteristic. ArgumentError for other m and for divisors that m does not annihilate,
    FieldError over infinite fields. ``rng`` chooses the shifts, which do not change the value; by default it has a
    fixed seed.
    """
    m = _check(D, E, m)
    there, back = _at_points(D, E, m), _at_points(E, D, m)
    if there is not None and back is not None:
        K: Any = D.jacobian.field
        value = K.div(there, back)
        return K.neg(value) if m % 2 else value
    _check_annihilated(D, m, "D")
    _check_annihilated(E, m, "E")
    if not D or not E:
        return D.jacobian.field.one
    move = _Extension(D.jacobian.curve, m, 1)
    return move.back(_shifted(lambda random: _weil(move(D), move(E), m, random(), random()), move, rng))


def tate_pairing(D: Divisor[Element], E: Divisor[Element], m: int, rng: Rng | None = None) -> Element:
    """The reduced Tate–Lichtenbaum pairing f_D(E)^((q−1)/m), an m-th root of unity, for m·D = 0 and any E over GF(q).

    It is bilinear, and non-degenerate on J[m] × J/mJ (Frey and Rück 1994). ``m`` divides q − 1; otherwise
    ArgumentError: extend the field until it does. Everything else is as for :func:`weil_pairing`.
    """
    m = _check(D, E, m)
    q: Any = D.jacobian.field.order
    if (q - 1) % m:
        raise ArgumentError(
            f"m = {shown(m)} does not divide q − 1 = {q - 1}: the field lacks the m-th roots of unity, extend it"
        )
    at_point = _at_points(D, E, m)
    if at_point is not None:
        return pow(at_point, (q - 1) // m, q)
    _check_annihilated(D, m, "D")
    if not D or not E:
        return D.jacobian.field.one
    move = _Extension(D.jacobian.curve, m, m)
    value = _shifted(lambda random: _tate(move(D), move(E), m, random()), move, rng)
    L: Any = move.curve.field
    value = L.power(value, (L.order - 1) // m)
    # with Q the order of L, (Q − 1)/(q − 1) ≡ degree modulo m
    return move.back(L.power(value, pow(move.degree, -1, m) if m > 1 else 1))


def _check(D: Divisor, E: Divisor, m: Any) -> int:
    m = check_scalar(m, "m")
    if E.jacobian != D.jacobian:
        raise CurveMismatch(f"D and E lie on two curves: {D.jacobian.curve!r} and {E.jacobian.curve!r}")
    K = D.jacobian.field
    if K.order is None:
        raise FieldError(f"field = {K.name}: pairings are computed over finite fields")
    if m.bit_length() > D.jacobian.curve.genus * (K.order.bit_length() + 2):
        raise ArgumentError(f"m = {shown(m)}: it is longer than the order of the group; give the order of D, or that")
    if m < 1 or m % K.characteristic == 0:
        raise ArgumentError(
            f"m = {shown(m)}: a positive integer prime to the characteristic {K.characteristic} is needed"
        )
    return m


def _check_annihilated(D: Divisor, m: int, name: str) -> None:
    if m * D:
        raise ArgumentError(f"{name} = {D}: m·{name} must be 0, which it is not for m = {shown(m)}")


def _at_points(D: Divisor, E: Divisor, m: int) -> Any:
    """f(E), where div f = m·D and f has the leading coefficient 1 at infinity, for classes D and E of single points on
    a curve of genus 1 over a prime field; no shift is needed. None on other curves, for D = 0 or E = 0, where m·D ≠ 0,
    and where a line of Miller's loop passes through E.
    """
    if not D or not E or not has_functions(D.jacobian.curve):
        return None
    is_zero, over, under = EllipticFunctions(D.jacobian.curve)(D, E, m)
    return D.jacobian.field.div(over, under) if is_zero and over and under else None


def _shifted(pairing: Callable[..., Any], move: _Extension, rng: Rng | None) -> Any:
    """The value of a pairing with the first random shifts of degree g for which no :class:`_Collision` is raised."""
    rng = Random(0) if rng is None else rng
    J = move.curve.jacobian()
    for _ in range(ATTEMPTS):
        try:
            return pairing(lambda: J.random(rng))
        except _Collision:
            continue
    raise Infeasible(f"{ATTEMPTS} random shifts on {move.curve!r} all met zeros of Miller's functions")


def _weil(D: Divisor, E: Divisor, m: int, R1: Divisor, R2: Divisor) -> Any:
    K = D.jacobian.field
    first, second = _affine(D + R1, R1), _affine(E + R2, R2)
    over = _quotient_at(D.jacobian, first, second, m)
    under = _quotient_at(D.jacobian, second, first, m)
    return K.div(over, under)


def _tate(D: Divisor, E: Divisor, m: int, R: Divisor) -> Any:
    plus, minus = _values(D.jacobian, D, _affine(E + R, R), m)
    return D.jacobian.field.div(plus, minus)


def _affine(S: Divisor, R: Divisor) -> tuple[Divisor, Divisor]:
    if S.degree != S.jacobian.curve.genus or R.degree != S.degree:
        raise _Collision
    return S, R


def _quotient_at(J: Any, functions: tuple[Divisor, Divisor], at: tuple[Divisor, Divisor], m: int) -> Any:
    """f(A − B) for div f = m(S − R): ``functions`` = (S, R) and ``at`` = (A, B), affine of equal degrees."""
    K = J.field
    (a, b), (c, d) = (_values(J, S, at, m) for S in functions)
    return K.div(K.mul(a, d), K.mul(b, c))


def _values(J: Any, D: Divisor, at: tuple[Divisor, ...], m: int) -> list[Any]:
    """The values, up to a common factor, of f_m at the affine divisors ``at`` of equal degrees, where m·D = [mD] + div
    f_m. Miller's loop computes numerators and denominators modulo the u of each divisor; at the end the norm of each is
    taken.
    """
    law, K = FlintCantor(J._model), J.field
    into, back = conversions(K)
    pairs = [J._in(E)[:2] for E in at]
    places = [(into(u), into(v)) for u, v in pairs]
    u, v, n = J._in(D)
    total = start = into(u), into(v), n
    one = into((K.one,))
    values = [(one, one)] * len(places)
    for bit in bin(m)[3:]:
        values = [(x * x % u, y * y % u) for (x, y), (u, _) in zip(values, places, strict=True)]
        total, values = _step(law, law.doubled(total), places, values)
        if bit == "1":
            total, values = _step(law, law.composed(total, start), places, values)
    norms = ([_norm(K, u, back(z)) for z in value] for (u, _), value in zip(pairs, values, strict=True))
    return [K.div(over, under) for over, under in norms]


def _step(law: FlintCantor, composed: Any, places: Any, values: Any) -> tuple[Flint, list[tuple[Any, Any]]]:
    """The composed divisor, reduced, and ``values`` multiplied by the functions of this step of Miller's loop.

    ``values`` are pairs (numerator, denominator), one for each of the ``places`` (u, v), modulo u and with y = v.
    """
    *start, cancelled = composed
    total: Any = tuple(start)
    values = [(x * cancelled % u, y) for (x, y), (u, _) in zip(values, places, strict=True)]
    for line, total in law.reductions(*start):
        below = total[0]
        values = [(x * (v - line) % u, y * below % u) for (x, y), (u, v) in zip(values, places, strict=True)]
    return total, values


def _norm(K: Field, u: poly.Poly, c: poly.Poly) -> Any:
    """The product Π c(x) over the roots x of the monic u; _Collision if it is 0."""
    value = poly.resultant(K, u, c) if c else K.zero
    if value == K.zero:
        raise _Collision
    return value


class _Extension:
    """The curve over an extension large enough for random shifts, of odd degree prime to ``coprime``; degree 1 for
    large q.
    """

    def __init__(self, C: HyperellipticCurve, m: int, coprime: int) -> None:
        K: Any = C.field
        enough = ROOM * C.genus**2 * (m.bit_length() + 1)
        self.degree = 1
        # an odd degree leaves an inert model inert
        while K.order**self.degree < enough or gcd(self.degree, coprime) > 1:
            self.degree += 2
        self.curve = C
        if self.degree == 1:
            return
        size = K.degree * self.degree
        L = GF(K.characteristic, size, first_irreducible(prime_field(K.characteristic), size))
        self.curve = C.change_ring(L)
        self._back = change_of_field(L, K)

    def __call__(self, D: Divisor) -> Divisor:
        return D.change_ring(self.curve.field)

    def back(self, value: Any) -> Any:
        """The element of the smaller field that equals ``value``."""
        return value if self.degree == 1 else self._back(value)
