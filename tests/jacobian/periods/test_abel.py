"""Periods and the Abel–Jacobi map: Riemann's relations, endomorphisms, closed forms, doubled precision, the inverse."""

import subprocess
import sys
from random import Random

import mpmath
import pytest

from jacobian import (
    CC,
    GF,
    MP,
    RR,
    ArgumentError,
    CurveMismatch,
    FieldError,
    HyperellipticCurve,
    Infeasible,
    JacobianError,
    PrecisionLoss,
    poly,
)
from jacobian.periods.abel import AbelMap
from jacobian.periods.matrix import periods, real_periods, symplectic_basis
from jacobian.periods.roots import simple_roots

# name: (f, the real roots of f as decimal strings, or None if they must be computed)
FIFTH = ["1", "0", "0", "0", "0", "1"]
REAL_CURVES = {
    "five real roots": ("1", ["0", "1", "2", "3", "4"]),
    "a rolling ball": ("4.2", ["0.21", "0.36", "0.55", "0.75", "1.4"]),
    "six real roots": ("-2", ["-3", "-1.5", "0", "0.5", "1", "4"]),
}
DIGITS = [15, 50, pytest.param(200, marks=pytest.mark.slow)]


def _curve(K, name):
    lead, roots = REAL_CURVES[name]
    lead, *roots = [K.coerce(float(x) if K is RR else x) for x in (lead, *roots)]
    return HyperellipticCurve(K, poly.scale(K, lead, poly.from_roots(K, roots)))


def _whole(coordinates, tolerance):
    """The coordinates as integers; asserts that they are, within the tolerance."""
    rounded = [int(mpmath.nint(c)) for c in coordinates]
    assert max(abs(c - m) for c, m in zip(coordinates, rounded, strict=True)) < tolerance
    return rounded


def _columns(P):
    return list(zip(*P.big, strict=True))


def _assert_same_lattice(P, Q, tolerance):
    """Asserts that P's columns are integral in Q's basis, and that the change of basis is unimodular."""
    matrix = mpmath.matrix([_whole(Q.coordinates(column), tolerance) for column in _columns(P)])
    assert abs(abs(mpmath.det(matrix)) - 1) < 1e-9


@pytest.mark.parametrize("dps", DIGITS)
def test_the_curve_with_an_automorphism_of_order_five(dps):
    """y² = x⁵ + 1: x → ζx maps the periods to integral combinations of themselves; two of them are beta functions."""
    K = MP(dps)
    P = periods(HyperellipticCurve(K, FIFTH))
    tolerance = mpmath.mpf(10) ** (3 - dps)
    assert P.bilinear_residual() < tolerance
    numbers = P.cover.numbers
    zeta = numbers.context.expjpi(numbers.real(2) / 5)
    images = [P.coordinates([zeta ** (k + 1) * x for k, x in enumerate(column)]) for column in _columns(P)]
    matrix = mpmath.matrix([_whole(image, tolerance) for image in images])
    assert matrix**5 == mpmath.eye(4)
    assert matrix + matrix**2 + matrix**3 + matrix**4 == -mpmath.eye(4)
    beta, half = numbers.context.beta, numbers.real(1) / 2
    through_infinity = []
    for k in range(2):
        a = numbers.real(k + 1) / 5
        through_infinity.append(((-1) ** k * beta(a, half) + beta(a, half - a)) * 2 / 5)
    assert any(_whole(P.coordinates(through_infinity), tolerance))
    _assert_same_lattice(P, periods(HyperellipticCurve(MP(2 * dps), FIFTH)), tolerance)


@pytest.mark.parametrize("name", REAL_CURVES)
@pytest.mark.parametrize("dps", DIGITS)
def test_three_real_curves(name, dps):
    """Riemann's relations, the real ovals, and the same with twice the digits."""
    C, D = _curve(MP(dps), name), _curve(MP(2 * dps), name)
    P, tolerance = periods(C), mpmath.mpf(10) ** (3 - dps)
    assert P.bilinear_residual() < tolerance
    assert all(P.tau[k][k].imag > 0 for k in range(2))
    Q = periods(D, REAL_CURVES[name][1])
    # the coefficients of C are rounded to dps digits, those of D to twice as many
    _assert_same_lattice(P, Q, tolerance)
    ovals, finer = real_periods(C), real_periods(D, REAL_CURVES[name][1])
    assert len(ovals) == len(finer) == len(C.f) // 2 - 1 + (name == "six real roots")
    for oval, fine in zip(ovals, finer, strict=True):
        assert max(abs(x - y) / abs(y) for x, y in zip(oval.periods, fine.periods, strict=True)) < tolerance
        assert any(_whole(P.coordinates(oval.periods), tolerance))


def test_the_ovals_against_another_quadrature():
    """Gauss–Chebyshev compared with tanh–sinh, on a curve with real and complex branch points."""
    K = MP(25)
    C = HyperellipticCurve(K, [6, -5, -2, 3, 1, 1, -1])
    ovals = real_periods(C)
    assert ovals
    with mpmath.workdps(30):
        for oval in ovals:
            for k, period in enumerate(oval.periods):
                a, b = mpmath.mpf(oval.start), mpmath.mpf(oval.end)
                f = [mpmath.mpf(c) for c in C.f]

                def integrand(t, k=k, a=a, b=b, f=f):
                    # x = m + d·sin t removes the singularities at the ends
                    x = (a + b) / 2 + (b - a) / 2 * mpmath.sin(t)
                    quotient = poly.evaluate(MP(30), f, x) / ((x - a) * (b - x))
                    return x**k / mpmath.sqrt(quotient)

                expected = 2 * mpmath.quad(
                    integrand, [-mpmath.pi / 2 + mpmath.mpf(10) ** -14, mpmath.pi / 2 - mpmath.mpf(10) ** -14]
                )
                assert abs(expected - period) < 1e-12


@pytest.mark.parametrize("K", [RR, MP(40)], ids=str)
def test_genus_one_against_the_arithmetic_geometric_mean(K):
    """2∫ dx/y over the oval of y² = (x−e₁)(x−e₂)(x−e₃) is 2π/agm(√(e₃−e₁), √(e₃−e₂)) (Gauss)."""
    e = [K.coerce(x) for x in (-2, 1, 5)]
    C = HyperellipticCurve(K, poly.from_roots(K, e))
    (oval,) = real_periods(C)
    with mpmath.workdps(45):
        expected = 2 * mpmath.pi / mpmath.agm(mpmath.sqrt(7), 2)
        assert abs(oval.periods[0] - expected) < 100 * K.eps
    assert (oval.start, oval.end) == pytest.approx((-2, 1))


def test_the_square_lattice():
    """y² = x³ − x has τ ~ i, y² = x³ + 1 has τ ~ e^{iπ/3}: up to SL₂(ℤ)."""
    for f, expected in (([0, -1, 0, 1], 1j), ([1, 0, 0, 1], 0.5 + 0.75**0.5 * 1j)):
        tau = periods(HyperellipticCurve(RR, f)).tau[0][0]
        while abs(tau) < 1 - 1e-9 or abs(tau.real) > 0.5 + 1e-9:
            tau -= round(tau.real)
            tau = -1 / tau if abs(tau) < 1 - 1e-9 else tau
        assert min(abs(tau - expected), abs(tau + expected.conjugate())) < 1e-13


def _table():
    for K in (RR, CC, MP(30), MP(20, complex=True)):
        for genus in (1, 2, 3):
            for degree in (2 * genus + 1, 2 * genus + 2):
                for with_h in (False, True):
                    yield K, genus, degree, with_h


def _random_map(K, genus, degree, with_h):
    rng = Random(f"abel {K} {degree} {with_h}")
    f = [K.random(rng) for _ in range(degree + 1)]
    h = [K.random(rng) for _ in range(genus + (degree % 2 == 0))] if with_h else []
    C = HyperellipticCurve(K, f, h)
    assert C.genus == genus
    return AbelMap(C), rng


@pytest.mark.thinned(11)
@pytest.mark.parametrize(("K", "genus", "degree", "with_h"), list(_table()))
def test_the_map_and_its_inverse(K, genus, degree, with_h):
    A, rng = _random_map(K, genus, degree, with_h)
    assert A.periods.bilinear_residual() < 1e4 * K.eps
    J = A.curve.jacobian()
    assert A(J.zero()) == (0,) * genus
    D = J.random(rng)
    z = A(D)
    found = A.inverse(z)
    assert found.n == D.n
    scale = max(map(abs, (*D.u, *D.v)))
    assert max(abs(x - y) for x, y in zip((*found.u, *found.v), (*D.u, *D.v), strict=True)) < 1e6 * K.eps * scale
    # the same class, shifted by lattice vectors
    far = [x + 3 * row[0] - 2 * row[-1] for x, row in zip(z, A.periods.big, strict=True)]
    again = A.inverse(far)
    assert max(abs(x - y) for x, y in zip((*again.u, *again.v), (*D.u, *D.v), strict=True)) < 1e6 * K.eps * scale
    assert A.inverse([row[0] for row in A.periods.big]) == J.zero()
    if A.curve.model == "ramified" or genus % 2 == 0:
        E = J.random(rng)
        gap = [x + y - w for x, y, w in zip(z, A(E), A(D + E), strict=True)]
        _whole(A.periods.coordinates(gap), 1e6 * K.eps)
        _whole(A.periods.coordinates([x + y for x, y in zip(z, A(-D), strict=True)]), 1e6 * K.eps)


@pytest.mark.thinned(5)
@pytest.mark.parametrize(("K", "genus", "degree", "with_h"), [row for row in _table() if row[0] in (CC, MP(30))])
def test_abels_theorem(K, genus, degree, with_h):
    """The zeros of y − p(x), deg p ≤ g, add up to zero: only roots of a polynomial are used, no group law."""
    A, rng = _random_map(K, genus, degree, with_h)
    C, F = A.curve, A.curve.field
    p = [F.random(rng) for _ in range(genus + 1)]
    total = [0] * genus
    norm = poly.sub(F, poly.mul(F, p, poly.add(F, p, C.h)), C.f)
    size = degree if C.model == "ramified" else 2 * genus + 2
    zeros = simple_roots(A.cover.numbers, [A.cover.numbers.convert(c) for c in norm[: size + 1]])
    J = C.jacobian()
    for x in zeros:
        x = F.coerce(x)
        D = J.from_mumford((-x, 1), (poly.evaluate(F, p, x),))
        total = [s + t for s, t in zip(total, A(D), strict=True)]
    if C.model == "split":
        # every image was that of P and of a weight at ∞₊: 2n + 1 − 2⌈g/2⌉ images of ∞₊ too many
        excess = 2 * D.n + 1 - 2 * ((genus + 1) // 2)
        total = (
            [s - len(zeros) * excess * a for s, a in zip(total, A._from_infinity(), strict=True)] if excess else total
        )
    _whole(A.periods.coordinates(total), 1e7 * K.eps)


@pytest.mark.parametrize("K", [CC, MP(30, complex=True)], ids=str)
@pytest.mark.parametrize("genus", [1, 2, 3])
def test_the_point_at_infinity_plus(K, genus):
    """y − V₊ has d zeros, a zero of order g+1−d at ∞₊ and a pole of order g+1 at ∞₋."""
    A, _ = _random_map(K, genus, 2 * genus + 2, True)
    C, g = A.curve, genus
    plus = C.principal_parts[0]
    norm = poly.sub(K, poly.mul(K, plus, poly.add(K, plus, C.h)), C.f)[: g + 1]
    total = [(2 * g + 2 - g) * a for a in A._from_infinity()]
    points = []
    for x in simple_roots(A.cover.numbers, [A.cover.numbers.convert(c) for c in norm]):
        points.append((x, poly.evaluate(K, plus, x) + A._half_h(x)))
    total = [s + t for s, t in zip(total, A._image_of(points, 0), strict=True)]
    _whole(A.periods.coordinates(total), 1e7 * K.eps)


@pytest.mark.parametrize("with_h", [False, True])
def test_the_differential_of_the_map(with_h):
    """d(Σ∫) = x^k dx/(y + h/2), which fixes the normalisation."""
    A, _ = _random_map(MP(30), 2, 5, with_h)
    C, K = A.curve, A.curve.field
    J, x, step = C.jacobian(), K.coerce(0.7 + 0.4j), K.coerce("1e-10")
    P = C.lift_x(x)
    near, far = (min(C.lift_x(x + s, all=True), key=lambda Q: abs(Q.y - P.y)) for s in (step, -step))
    change = A.periods.reduce([a - b for a, b in zip(A(J.from_points([near])), A(J.from_points([far])), strict=True)])
    denominator = P.y + poly.evaluate(K, C.h, x) / 2
    for k, d in enumerate(change):
        assert abs(d / (2 * step) - x**k / denominator) < 1e-17


def test_branch_points_are_half_periods():
    A = AbelMap(_curve(MP(30), "a rolling ball"), REAL_CURVES["a rolling ball"][1])
    J = A.curve.jacobian()
    images = [A(J.from_points([(e, 0)])) for e in REAL_CURVES["a rolling ball"][1]]
    halves = {tuple(_whole([2 * c for c in A.periods.coordinates(z)], 1e-25)) for z in images}
    assert len({tuple(m % 2 for m in half) for half in halves}) == 5
    # a real divisor, given on the real curve
    D = A.given.jacobian().from_points([A.given.lift_x("0.3"), A.given.lift_x("0.6")])
    back = A.inverse(A(D))
    assert max(abs(x - y) for x, y in zip((*back.u, *back.v), (*D.u, *D.v), strict=True)) < 1e-26


@pytest.mark.slow
def test_the_inverse_to_two_hundred_digits():
    A = AbelMap(HyperellipticCurve(MP(200), FIFTH))
    D = A.curve.jacobian().random(Random(4))
    back = A.inverse(A(D))
    assert max(abs(x - y) for x, y in zip((*back.u, *back.v), (*D.u, *D.v), strict=True)) < mpmath.mpf(10) ** -195


def test_symplectic_bases():
    rng = Random(6)
    for size in (2, 4, 6, 8):
        # the intersection numbers of a chain of cycles in another basis
        change = [[int(i == j) for j in range(size)] for i in range(size)]
        for _ in range(3 * size):
            (i, j), sign = rng.sample(range(size), 2), rng.choice((-1, 1))
            change[i] = [x + sign * y for x, y in zip(change[i], change[j], strict=True)]
        chain = mpmath.matrix(size)
        for i in range(size - 1):
            chain[i, i + 1], chain[i + 1, i] = 1, -1
        change = mpmath.matrix(change)
        crossings = change * chain * change.T
        basis = mpmath.matrix(symplectic_basis([[int(crossings[i, j]) for j in range(size)] for i in range(size)]))
        found = basis * crossings * basis.T
        for i in range(size):
            for j in range(size):
                assert found[i, j] == (j == i + size // 2) - (i == j + size // 2)
    with pytest.raises(PrecisionLoss, match="unimodular"):
        symplectic_basis([[0, 2], [-2, 0]])


def test_bad_input():
    C = _curve(RR, "five real roots")
    with pytest.raises(FieldError, match="RR, CC or MP"):
        periods(HyperellipticCurve(GF(7), [1, 0, 0, 1]))
    with pytest.raises(ArgumentError, match=r"roots = \[0, 1, 2, 3\]: 5 numbers"):
        periods(C, [0, 1, 2, 3])
    with pytest.raises(ArgumentError, match="another coefficient"):
        periods(C, [0, 1, 2, 3, 5])
    with pytest.raises(FieldError, match="roots"):
        periods(_curve(MP(20), "five real roots"), ["zero", 1, 2, 3, 4])
    with pytest.raises(FieldError, match="ovals"):
        real_periods(HyperellipticCurve(CC, [0, -1, 0, 1]))
    with pytest.raises(PrecisionLoss, match="coincide"):
        periods(HyperellipticCurve(RR, [0, 0, 1, -2, 0, 1]))
    close = [0.0, 1.0, 2.0, 3.0, 3.0 + 2e-7]
    with pytest.raises((Infeasible, PrecisionLoss)):
        periods(HyperellipticCurve(RR, poly.from_roots(RR, close)), close)
    A = AbelMap(C)
    with pytest.raises(ArgumentError, match=r"z = \[1, 2, 3\]: 2 numbers"):
        A.inverse([1, 2, 3])
    with pytest.raises(FieldError, match=r"z\[0\] = "):
        A.inverse(["a", 1])
    with pytest.raises(CurveMismatch, match="not a divisor class"):
        A(_curve(RR, "a rolling ball").jacobian().zero())
    with pytest.raises(CurveMismatch, match="not a divisor class"):
        A(0)
    # methods with internal numbers or unchecked classes as arguments are not public
    assert {name for name in dir(A) if not name.startswith("_") and callable(getattr(A, name))} == {
        "check_divisor",
        "check_image",
        "inverse",
    }
    assert issubclass(Infeasible, JacobianError)


def test_nothing_global_is_touched_or_imported():
    before = mpmath.mp.dps
    AbelMap(HyperellipticCurve(MP(40), FIFTH))
    assert mpmath.mp.dps == before
    code = (
        "import sys; from jacobian import RR, HyperellipticCurve; from jacobian.periods.abel import AbelMap;"
        "AbelMap(HyperellipticCurve(RR, [0, -1, 0, 1]));"
        "print([m for m in ('numpy', 'mpmath', 'galois') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


@pytest.mark.slow
def test_the_inverse_looks_at_what_it_returns():
    """For far points, the divisor that is found is on the curve and has the requested image, or PrecisionLoss is
    raised.
    """
    rng, seen = Random(5), 0
    A = AbelMap(HyperellipticCurve(RR, [1, 2, 0, 3, 0, 1, 0, 1]))
    for size in (1e3, 6.7e7):
        xs = [complex(rng.gauss(0, 1), rng.gauss(0, 1)) * s for s in (1, 1, size)]
        D = A.curve.jacobian().from_points([A.curve.lift_x(x) for x in xs])
        z = A(D)
        try:
            back = A.inverse(z)
        except PrecisionLoss:
            continue
        seen += 1
        A.curve.jacobian().from_mumford(back.u, back.v)
        gap = A.periods.coordinates([x - y for x, y in zip(A(back), z, strict=True)])
        assert max(abs(c - round(c.real)) for c in gap) < 1e-7
    assert seen


def test_a_divisor_with_another_image_is_not_returned(monkeypatch):
    A = AbelMap(HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1]))
    D = A.curve.jacobian().random(Random(4))
    z = A(D)
    polished = AbelMap._polished

    def astray(self, points, target, *rest):
        x, y = (found := polished(self, points, target, *rest))[0]
        return [self._moved(x, y, 1e-4), *found[1:]] if not rest else found

    monkeypatch.setattr(AbelMap, "_polished", astray)
    with pytest.raises(PrecisionLoss, match="image of the divisor"):
        A.inverse(z)
