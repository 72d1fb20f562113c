"""Curves with chosen rational branch points through chosen rational points."""

from jacobian import QQ, HyperellipticCurve, poly


def curve_through(branch_points, points, K=QQ):
    """y² = Π(x − e)·g(x) with g of the lowest degree for which the points (x, y) are on the curve."""
    f = poly.from_roots(K, [K.coerce(e) for e in branch_points])
    rest, product = (), (K.one,)
    for x, y in points:
        x, y = K.coerce(x), K.coerce(y)
        value = K.div(K.mul(y, y), poly.evaluate(K, f, x))
        step = K.div(K.sub(value, poly.evaluate(K, rest, x)), poly.evaluate(K, product, x))
        rest = poly.add(K, rest, poly.scale(K, step, product)) if step != K.zero else rest
        product = poly.mul(K, product, (K.neg(x), K.one))
    return HyperellipticCurve(K, poly.mul(K, f, rest))


def pair_of(curve, P, Q):
    """(u, v) of P + Q, untrimmed, u monic; the tangent for P = Q."""
    K, (x1, y1), (x2, y2) = curve.field, P, Q
    if P == Q:
        slope = K.div(poly.evaluate(K, poly.derivative(K, curve.f), x1), K.add(y1, y1))
    else:
        slope = K.div(K.sub(y1, y2), K.sub(x1, x2))
    return (K.mul(x1, x2), K.neg(K.add(x1, x2)), K.one), (K.sub(y1, K.mul(slope, x1)), slope)


def pairs_of(curve, points):
    """(u, v) of every P + Q with P ≠ ιQ, for the points and their opposites, including branch points and P = Q."""
    K = curve.field
    points = list(dict.fromkeys(Q for x, y in points for Q in ((x, y), (x, K.neg(y)))))
    sums = [(P, Q) for i, P in enumerate(points) for Q in points[i:]]
    return [pair_of(curve, P, Q) for P, Q in sums if P[0] != Q[0] or (P == Q and P[1] != K.zero)]


QUINTIC = curve_through((0, 1, -2), ((-1, 1), (2, 3), (3, -2)))
QUARTIC = curve_through((0, 1), ((-1, 1), (2, 3), (3, -2)))


def known_points(curve):
    """The rational points of small height."""
    return [tuple(P) for x in range(-3, 5) for P in curve.lift_x(x, all=True)]
