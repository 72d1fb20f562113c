"""Special equations: a given point at infinity, odd degree, h = 0."""

from __future__ import annotations

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve, check_curve, coefficient
from jacobian.curve.points import INFINITY_PLUS, Given, PointAtInfinity
from jacobian.errors import FieldError, NotRepresentable
from jacobian.fields.factor import roots
from jacobian.models.isomorphism import Isomorphism


def move_to_infinity(C: HyperellipticCurve, P: Given) -> Isomorphism:
    """The isomorphism by x' = 1/(x − x(P)), which maps a rational point P to infinity.

    A Weierstrass point P is mapped to the only point at infinity of an equation of odd degree, any other P to ∞₊. If P
    is at infinity, x' = x: at most y or the names of ∞₊ and ∞₋ change. The field is exact.
    """
    K, P = check_curve(C).field, C.check_point(P)
    if isinstance(P, PointAtInfinity):
        if C.model == "split":
            plus = C.infinity_plus if P == INFINITY_PLUS else C.infinity_minus
            return Isomorphism(C, (1, 0, 0, 1), infinity_plus=plus)
        return Isomorphism(C, (1, 0, 0, 1), move=poly.monomial(K, K.neg(C.infinity_plus), C.genus + 1))
    matrix = K.zero, K.one, K.one, K.neg(P.x)
    if C.involution(P) == P:
        return Isomorphism(C, matrix, move=(K.neg(P.y),))
    return Isomorphism(C, matrix, infinity_plus=P.y)


def odd_degree_model(C: HyperellipticCurve) -> Isomorphism:
    """An isomorphism to an equation with deg f = 2g + 1, deg h ≤ g, over QQ or a finite field.

    It maps a rational Weierstrass point to infinity: the one already there, or the one of least x. NotRepresentable
    where no such point is rational.
    """
    K = check_curve(C).field
    if not K.exact:
        raise FieldError(f"field = {K.name}: whether a branch point is rational is not decided over an inexact field")
    if C.model == "ramified":
        return move_to_infinity(C, C.points_at_infinity()[0])
    branches = roots(K, C.h if K.characteristic == 2 else C.discriminant)
    if not branches:
        raise NotRepresentable(
            f"{C!r} has no rational Weierstrass point, so no equation of odd degree over {K.name}; a larger field has"
        )
    return move_to_infinity(C, C.lift_x(branches[0]))


def without_h(C: HyperellipticCurve) -> Isomorphism:
    """The isomorphism y' = 2y + h to y² = h² + 4f; FieldError in characteristic 2."""
    K = check_curve(C).field
    if K.characteristic == 2:
        raise FieldError(f"field = {K.name}: in characteristic 2 every curve has an h")
    plus = None
    if C.model == "split":
        plus = K.add(K.add(C.infinity_plus, C.infinity_plus), coefficient(K, C.h, C.genus + 1))
    return Isomorphism(C, (1, 0, 0, 1), scale=poly.integer(K, 2), move=C.h, infinity_plus=plus)
