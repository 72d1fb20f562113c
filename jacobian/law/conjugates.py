"""Points over an extension field: the support of a divisor, and divisors from complete sets of conjugate points."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from math import lcm

from jacobian import poly
from jacobian.curve.points import INFINITY_MINUS, INFINITY_PLUS, AffinePoint, Given, Point, PointAtInfinity
from jacobian.errors import FieldError, NotRepresentable, shown
from jacobian.fields.change import embedding
from jacobian.fields.factor import factor, roots, without_root
from jacobian.fields.protocol import Field
from jacobian.law.divisor import Divisor, GroupLaw
from jacobian.law.from_points import Descent, divisor_of_points


def divisor_of_conjugates(J: GroupLaw, points: Iterable[Given], extension: Field) -> Divisor:
    """The class of Σ P_i minus infinity for points over an extension of the field, each with all its conjugates.

    Points at infinity must be those of the curve over its own field. Raises NotRepresentable when the points are not
    closed under Frobenius, counted with multiplicity.
    """
    C, inclusion = J.curve, embedding(J.field, extension)
    above = C.change_ring(extension)
    checked = [(C if isinstance(point, PointAtInfinity) else above).check_point(point) for point in points]
    affine = [point for point in checked if isinstance(point, AffinePoint)]
    number = Counter(affine)
    for point in affine:
        conjugate = AffinePoint(*map(inclusion.frobenius, point))
        if number[conjugate] != number[point]:
            raise NotRepresentable(
                f"points: {shown(tuple(point))} is given {number[point]} times and its conjugate {tuple(conjugate)} "
                f"over {J.field.name} {number[conjugate]} times: give all conjugates of a point alike"
            )
    return divisor_of_points(J, checked, Descent(above, inclusion))


def support(D: Divisor, extension: Field | None = None) -> list[tuple[Point, int]]:
    """The points of D with their multiplicities: :meth:`jacobian.law.divisor.Divisor.support`."""
    C = D.jacobian.curve
    K, u, v = C.field, D.u, D.v
    if extension is not None:
        inclusion = embedding(K, extension)
        K, u, v = extension, inclusion.polynomial(u), inclusion.polynomial(v)
    if not K.exact:
        raise FieldError(f"field = {K.name}: multiplicities of points are not decided over an inexact field")
    points: list[tuple[Point, int]] = []
    rest = u
    for x in roots(K, u):
        multiplicity, rest = without_root(K, rest, x)
        points.append((AffinePoint(x, poly.evaluate(K, v, x)), multiplicity))
    if len(rest) > 1:
        degree = splitting_degree(D)
        hint = "" if degree is None else f": give the extension of degree {degree} of {C.field.name}"
        raise NotRepresentable(
            f"u = {poly.text(C.field, D.u)} has no more than {D.degree - (len(rest) - 1)} of its {D.degree} roots in "
            f"{K.name}{hint}"
        )
    if D.n is not None:
        weights = ((INFINITY_PLUS, D.n), (INFINITY_MINUS, C.genus - D.degree - D.n))
        points += [(point, weight) for point, weight in weights if weight]
    return points


def splitting_degree(D: Divisor) -> int | None:
    """The degree of the extension over which u splits into linear factors; None over an infinite field."""
    K = D.jacobian.field
    if K.order is None:
        return None
    return lcm(*(len(P) - 1 for P, _ in factor(K, D.u)))
