"""The addition of a moving point is the sign-resolved sum of jacobian.relatives.signed: exactly, and in floats."""

from random import Random

import pytest

from integrable.moving_point.addition import carried
from jacobian import GF, RR, HyperellipticCurve, NotASquare, NotRepresentable, poly
from jacobian.relatives.signed import SignedDivisor, SignedGroup

P = 2**61 - 1


class Residue:
    """A number modulo 2^61 − 1 for formulas written with operators. Where formulas choose by size, its size is the int
    and a float factor counts as 0: everything that is not zero is large.
    """

    def __init__(self, value):
        self.value = value % P

    def of(self, other):
        return other if isinstance(other, Residue) else Residue(0 if isinstance(other, float) else other)

    def __add__(self, other):
        return Residue(self.value + self.of(other).value)

    def __sub__(self, other):
        return Residue(self.value - self.of(other).value)

    def __rsub__(self, other):
        return self.of(other) - self

    def __mul__(self, other):
        return Residue(self.value * self.of(other).value)

    def __truediv__(self, other):
        return Residue(self.value * pow(self.of(other).value, -1, P))

    def __rtruediv__(self, other):
        return self.of(other) / self

    def __neg__(self):
        return Residue(-self.value)

    def __abs__(self):
        return self

    def __lt__(self, other):
        return self.value < (other.value if isinstance(other, Residue) else other)

    def __gt__(self, other):
        return self.value > (other.value if isinstance(other, Residue) else other)

    __radd__, __rmul__ = __add__, __mul__


def random_group(K, degree, rng):
    """Three branch points in the field."""
    roots = [K.random(rng) for _ in range(3)]
    f = poly.mul(K, poly.from_roots(K, roots), poly.random(K, degree - 2, rng))
    return SignedGroup(HyperellipticCurve(K, f), roots)


def random_pair(group, rng):
    K, (A, B) = group.field, (group.curve.random_point(rng) for _ in range(2))
    slope = K.div(K.sub(A.y, B.y), K.sub(A.x, B.x))
    return (K.mul(A.x, B.x), K.neg(K.add(A.x, B.x)), K.one), (K.sub(A.y, K.mul(slope, A.x)), slope)


def by_the_kernel(group, D, E, number):
    """D + E for a translation E, κ' = 1, as the flow computes it."""
    f = [number(c) for c in (*group.curve.f, 0, 0)[:6]]
    axes = [number(x) for x in (*group.branch_points, *D.kappas, 1, 0)]
    rows = []
    for X in (D, E):
        columns = zip(*X.pairs, strict=True)
        rows.append([number(x) for x in (*X.u[:2], *X.v, *(x for column in columns for x in column))])
    return carried(f, axes, *rows)


@pytest.mark.parametrize("degree", [5, 4])
def test_exactly_over_a_finite_field(degree):
    rng, K, done = Random(f"kernel {degree}"), GF(P), 0
    while done < 20:
        group = random_group(K, degree, rng)
        try:
            E = group.double(group.twist(*random_pair(group, rng)))
            D = rng.choice((group.twist(*random_pair(group, rng)), E, group.double(E)))
            total = group.add(D, E)
        except (NotRepresentable, NotASquare, ZeroDivisionError):
            continue
        found = [x.value for x in by_the_kernel(group, D, E, Residue)]
        assert tuple(found[:4]) == (*total.u[:2], *total.v)
        assert list(zip(found[4:7], found[7:], strict=True)) == list(total.pairs)
        assert total.kappas == D.kappas
        done += 1


@pytest.mark.parametrize("degree", [5, 4])
def test_in_floats(degree):
    """Two conjugate pairs of points, near each other and apart."""
    rng = Random(f"floats {degree}")
    f = poly.mul(RR, poly.from_roots(RR, (0.3, 0.5, 1.0)), (0.6, -1.0) if degree == 4 else (0.6, -1.42, 0.7))
    group = SignedGroup(HyperellipticCurve(RR, f), (0.3, 0.5, 1.0))
    for _ in range(30):
        D, E = (SignedDivisor(*conjugates(f, complex(rng.gauss(0.5, 1), rng.gauss(0, 1))), (), ()) for _ in range(2))
        D, E = (group.lift(X.u, X.v, [rng.choice((1, -1)) for _ in range(3)]) for X in (D, E))
        total, found = group.add(D, E), by_the_kernel(group, D, E, float)
        expected = (*total.u[:2], *total.v, *(x for column in zip(*total.pairs, strict=True) for x in column))
        # (b, σ'', ν'') and (−b, −σ'', −ν'') belong to q·y − p and its negative
        size = max(map(abs, expected))
        apart = min(max(abs(x - s * y) for x, y in zip(found[4:], expected[4:], strict=True)) for s in (1, -1))
        assert apart < 1e-9 * size**2
        assert max(abs(x - y) for x, y in zip(found[:4], expected[:4], strict=True)) < 1e-9 * size**2


def conjugates(f, z):
    """(U, V) of (z, √f(z)) and its conjugate."""
    y = sum(c * z**i for i, c in enumerate(f)) ** 0.5
    slope = y.imag / z.imag
    return (abs(z) ** 2, -2 * z.real, 1.0), (y.real - slope * z.real, slope)
