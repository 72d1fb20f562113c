"""Curves y² = x⁷ + … over GF(p), split models of genus 3, and special classes of both."""

from random import Random

from jacobian import GF, HyperellipticCurve, poly
from jacobian.batch.equation import Equation
from tests.jacobian.group_curves import random_curve


def septic(p, seed):
    """y² = f, f monic of degree 7."""
    return Equation(random_curve(GF(p), 3, seed, model="ramified")).curve


def octic(p, seed):
    """A split model y² = f."""
    return random_curve(GF(p), 3, seed, model="split")


def with_branch_points(p, model="ramified"):
    """y² = (x − 2)(x − 3)(x − 4)·g: (2, 0), (3, 0), (4, 0) are branch points."""
    rng, K = Random(p), GF(p)
    top = (1,) if model == "ramified" else (rng.randrange(p), rng.randrange(1, p) ** 2 % p)
    roots = poly.mul(K, poly.mul(K, (p - 2, 1), (p - 3, 1)), (p - 4, 1))
    while True:
        g = (*[rng.randrange(p) for _ in range(4)], *top)
        f = poly.mul(K, roots, g)
        if len(poly.gcd(K, f, poly.derivative(K, f))) == 1:
            return HyperellipticCurve(K, f)


def special_classes(C, rng):
    """0, classes with common, opposite and double points, every weight, classes of order 2."""
    J = C.jacobian()
    P, Q, R, S, T = (C.random_point(rng) for _ in range(5))
    i = C.involution
    A, B = (2, 0), (3, 0)
    full = [(P, Q, R), (P, Q, S), (P, S, T), (P, P, Q), (P, P, P), (i(P), Q, R), (i(P), i(Q), R), (i(P), i(Q), i(R))]
    torsion = [(A, B, (4, 0)), (A, B, P), (A, P, Q), (A, B), (A,), (A, P)]
    lower = [(P, Q), (i(P), Q), (R, S), (P, P), (P,), (i(P),), (T,)]
    if C.model == "split":
        plus, minus = C.points_at_infinity()
        lower += [(plus,), (minus,), (plus, plus), (minus, P), (plus, P, Q), (minus, minus, P), (plus, A, B)]
    return [J.zero(), *(J.from_points(list(some)) for some in full + torsion + lower)]
