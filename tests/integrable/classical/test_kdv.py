"""Solutions of KdV against the equation itself, exactly; solitons; spectral integration; theta functions."""

from itertools import product
from random import Random

import numpy as np
import pytest

from integrable.classical.kdv import MANY, KdV, directions_of_waves, potential
from integrable.classical.two_gaps import TwoGaps
from integrable.mumford.fields import rates
from integrable.phase.jets import Jet, JetField
from integrable.portrait import oval_loops
from jacobian import CC, GF, MP, ArgumentError, HyperellipticCurve, PrecisionLoss, poly
from jacobian.errors import FieldError
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted
from jacobian.periods.matrix import periods
from tests.integrable.classical.rows import different, extrapolated
from tests.integrable.exact_points import attempt, over_fields

# band edges, γ_j and signs in genus 1, 2 and 3
WAVES = [
    ((0, 1, 2.5), (1.5,), (1,)),
    ((0, 1, 2, 3, 4.5), (1.5, 3.25), (1, -1)),
    ((-1, 0, 1, 2, 3, 4, 5.5), (0.5, 2.25, 5), (-1, 1, 1)),
]
over_waves = pytest.mark.parametrize(
    ("edges", "gamma", "signs"), [*WAVES[:2], pytest.param(*WAVES[2], marks=pytest.mark.slow)]
)


def wave(edges, gamma, signs, *field):
    kdv = KdV(edges, *field)
    return kdv.wave(kdv.state(gamma, signs))


@over_fields()
@pytest.mark.parametrize("gaps", [1, 2, 3, 4])
def test_the_equation_exactly(K, gaps) -> None:
    """u_t = 6uu_x − u_xxx, with every derivative by jets, and V = ½U_x."""
    K, rng = K(), Random(gaps)

    def make():
        kdv = KdV(different(K, rng, 2 * gaps + 1), K)
        return kdv.spectral(kdv.state(different(K, rng, gaps), [rng.choice((1, -1)) for _ in range(gaps)]))

    f, u, v = attempt(make)
    of_x, of_t = directions_of_waves(K, f)
    # the pair, then repeatedly the pair with its derivative along x in jets
    N, pair, steps = K, (u, v), []
    for _ in range(3):
        rate = rates(N, lifted(N, f), *pair, lifted(N, of_x))
        steps.append(rate)
        over = JetField(N, 1)
        pair = tuple(
            tuple(Jet(over, a, (b,)) for a, b in zip(x, y, strict=True)) for x, y in zip(pair, rate, strict=True)
        )
        N = over
    first, _, third = (inner(step[0][-2], n) for n, step in enumerate(steps))
    of_time = twice(K, rates(K, f, u, v, of_t)[0][-2])
    value = potential(K, f, u)
    assert of_time == K.sub(K.mul(poly.integer(K, 6), K.mul(value, twice(K, first))), twice(K, third))
    assert steps[0][0][:-1] == tuple(twice(K, c) for c in v)


def lifted(N, values):
    return tuple(map(N.coerce, values))


def twice(K, x):
    return K.add(x, x)


def inner(x, n):
    """The slope along all n directions of nested jets: an n-th derivative."""
    for _ in range(n):
        x = x.slopes[0]
    return x


def error_in_many_digits(edges, gamma, signs, x, t, steps):
    """The error of u(x, t), relative to an integration along x, then t."""
    found = wave(edges, gamma, signs, MP(36)).at(x, t)[()]
    kdv = KdV(edges, MP(36))
    with LongField(128) as K:
        f, u, v = kdv._spectral(K, kdv.state(gamma, signs))
        z, g = [*u[:-1], *v], len(v)
        for direction, time, count in zip(directions_of_waves(K, f), (x, t), steps, strict=True):

            def rate(z, direction=direction):
                of_u, of_v = rates(K, f, (*z[:g], K.one), tuple(z[g:]), direction)
                return [*of_u[:-1], *of_v]

            z = extrapolated(K, rate, z, K.coerce(time), count, 17)
        return abs(K.coerce(found) - potential(K, f, (*z[:g], K.one)))


@over_waves
def test_thirty_digits_against_an_integration(edges, gamma, signs) -> None:
    assert error_in_many_digits(edges, gamma, signs, 0.5, 0.03125, (10, 16)) < 1e-30


@pytest.mark.slow
def test_thirty_digits_at_ten_periods() -> None:
    assert error_in_many_digits(*WAVES[0], 24, 1, (240, 240)) < 1e-30


@over_waves
def test_floats_against_forty_digits_far_away(edges, gamma, signs) -> None:
    x, t = np.array([1e6, -3.5, 1e9]), np.array([-1e6, 1e6, 0.25])
    rough, fine = wave(edges, gamma, signs).at(x, t), wave(edges, gamma, signs, MP(40)).at(x, t)
    assert np.abs(rough - fine.astype(float)).max() <= 4e-16 * (edges[-1] - edges[0])


@over_waves
def test_reversal_shape_and_bounds(edges, gamma, signs) -> None:
    """u(−x, −t) is the solution with the opposite signs; u lies between the sums that the gaps allow."""
    u = wave(edges, gamma, signs)
    back = wave(edges, gamma, tuple(-s for s in signs))
    x, t = np.linspace(-2, 2, 5), np.array([[0.0], [0.5]])
    table = u.at(x, t)
    assert table.shape == (2, 5)
    assert np.abs(table - back.at(-x, -t)).max() < 1e-14
    assert u.at(0.5).shape == ()
    assert u.at([]).shape == (0,)
    assert table.max() <= sum(edges) - 2 * sum(edges[1::2])
    assert table.min() >= sum(edges) - 2 * sum(edges[2::2])


@pytest.mark.skipif(interpreted(), reason="profiles are compiled")
def test_additions_take_over_where_points_of_a_profile_are_not_found(monkeypatch) -> None:
    """The values were refused instead."""
    ours, x = wave(*WAVES[2]), np.linspace(-5, 5, MANY)
    true = ours.at(x, 0.25)
    assert ours._profiles[0.25] is not None
    monkeypatch.setattr(oval_loops.LIBRARY, "points_at_times", lambda *given: False)
    assert np.abs(ours.at(x, 0.25) - true).max() < 1e-14


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("edges", "gamma", "signs", "count", "reach"),
    [
        ((0, 1, 2), (1.5,), (1,), 24, 1e6),
        ((-3, 0.5, 0.75), (0.5,), (1,), 24, 1e6),
        ((0, 1, 2, 3.5, 5), (1.5, 4), (1, -1), 24, 1e6),
        ((-3, -2, 0.5, 0.75, 6), (0.5, 3), (1, 1), 24, 1e6),
        ((0, 0.5, 1, 2, 3, 4, 5.5), (0.75, 2.5, 5), (1, 1, -1), 200, 20.0),
    ],
)
def test_many_points_at_one_time(edges, gamma, signs, count, reach) -> None:
    """Values from the torus or from tables compared with additions, near and far, at several t at once."""
    ours, fine = wave(edges, gamma, signs), wave(edges, gamma, signs, MP(30))
    x, t = np.random.default_rng(count).uniform(-reach, reach, count), np.array([0.0, -1e3 / 3])
    x[:2] = 0.0, 1e-3
    found = ours.at(x, t[:, None])
    assert list(ours._profiles) == [0.0]
    assert found.shape == (2, count)
    span = edges[-1] - edges[0]
    some = [0, 1, 2, 5, count - 1]
    assert np.abs(found[:, some] - fine.at(x[some], t[:, None]).astype(float)).max() < 4e-16 * span


def test_many_points_of_a_narrow_band_are_those_of_additions() -> None:
    """Tables of double-double numbers are not accurate enough, and with a double edge there is no torus."""
    for edges, gamma in (((0, 1, 2, 3, 3 + 1e-7, 4, 5), (1.5, 3 + 1e-7, 4.5)), ((-1, -1, 0.5, 1, 2), (0, 1.5))):
        ours, x = wave(edges, gamma, [1] * len(gamma)), np.linspace(-3, 3, 25)
        assert ours.at(x, 0.25).tolist() == [ours._value(a, 0.25) for a in x.tolist()]


def test_one_soliton() -> None:
    u, x = wave((-1, -1, 0), (0,), (1,)), np.array([-30, -1, 0.5, 3, 21])
    for t in (0.0, 0.75):
        assert np.allclose(u.at(x, t), -2 / np.cosh(x - 4 * t) ** 2, rtol=1e-14, atol=0)
    # κ = 2, shifted by 3
    moved = wave((-4, -4, 0), (-4 * np.tanh(6) ** 2,), (-1,))
    assert np.allclose(moved.at(x[1:4], 0.25), -8 / np.cosh(2 * (x[1:4] - 4 - 3)) ** 2, rtol=1e-9, atol=0)


def test_two_solitons_pass_each_other() -> None:
    """u = −2∂²log det(1 + C), the matrix of Kay & Moses (1956), symmetric about x = t = 0."""
    from mpmath import MPContext

    context = MPContext()
    context.dps = 60
    kappa, h = (1, 2), context.mpf(10) ** -15

    def logarithm(x, t):
        weights = [context.sqrt(6 * k) * context.exp(-k * x + 4 * k**3 * t) for k in kappa]
        entries = [[weights[i] * weights[j] / (kappa[i] + kappa[j]) for j in (0, 1)] for i in (0, 1)]
        return context.log(context.det(context.eye(2) + context.matrix(entries)))

    def determinant(x, t):
        return -2 * (logarithm(x + h, t) - 2 * logarithm(x, t) + logarithm(x - h, t)) / h**2

    # −6 sech² x, begun where sech² x = ½: U(−4) = 9 sech⁴ x, U(−1) = −9 sech² x tanh² x
    start = float(np.arccosh(np.sqrt(2)))
    root = np.sqrt(11.25)
    u = wave((-4, -4, -1, -1, 0), ((-3.5 - root) / 2, (root - 3.5) / 2), (-1, 1))
    for x, t in ((-2, 0), (1, 0), (0, 0), (-2, 0.25), (6, 0.5), (9, 0.5)):
        assert abs(float(u.at(x - start, t)) - float(determinant(context.mpf(x), context.mpf(t)))) < 2e-13


def spectral(u, length, t, steps):
    """u of period ``length`` at t, by Fourier series and Runge–Kutta steps with an integrating factor."""
    k = 2 * np.pi / length * np.fft.rfftfreq(len(u), 1 / len(u))
    h = t / steps
    half = np.exp(0.5j * h * k**3)

    # products need the upper third
    kept = 3j * k * (np.arange(len(k)) < len(u) / 3)

    def rate(a):
        return kept * np.fft.rfft(np.fft.irfft(a) ** 2)

    a = np.fft.rfft(u)
    for _ in range(steps):
        first = rate(a)
        second = rate(half * (a + h / 2 * first))
        third = rate(half * a + h / 2 * second)
        fourth = rate(half**2 * a + h * half * third)
        a = half**2 * (a + h / 6 * first) + h / 3 * half * (second + third) + h / 6 * fourth
    return np.fft.irfft(a)


@pytest.mark.slow
def test_a_spectral_integration_of_two_solitons() -> None:
    root = np.sqrt(11.25)
    u = wave((-4, -4, -1, -1, 0), ((-3.5 - root) / 2, (root - 3.5) / 2), (-1, 1))
    length, count = 24.0, 256
    x = length * (np.arange(count) / count - 0.5)
    found = spectral(u.at(x), length, 0.125, 4000)
    sample = slice(0, count, 16)
    assert np.abs(found[sample] - u.at(x[sample], 0.125)).max() < 2e-6


def test_a_spectral_integration_of_a_periodic_wave() -> None:
    """Genus 1 over two periods: the period 2K/√(e_3 − e_1) of x, K of the parameter (e_3 − e_2)/(e_3 − e_1)."""
    from mpmath import MPContext

    u = wave((0, 1, 2.5), (1.5,), (1,))
    length, count = 4 * float(MPContext().ellipk(0.6)) / 2.5**0.5, 96
    x = length * np.arange(count) / count
    start = u.at(x)
    assert np.abs(start[: count // 2] - start[count // 2 :]).max() < 1e-14
    found = spectral(start, length, 0.25, 2000)
    assert np.abs(found - u.at(x, 0.25)).max() < 1e-9


@pytest.mark.parametrize("gaps", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_theta_functions(gaps) -> None:
    """Its & Matveev 1975: u = −2∂²log θ(z(x, t)) + const, one constant and a half-period to be found for all x, t."""
    acb_mat = pytest.importorskip("flint").acb_mat
    if not hasattr(acb_mat, "theta"):
        pytest.skip("this python-flint has no theta functions")
    from flint import acb, ctx

    K, edges = MP(50), list(range(2 * gaps + 1))
    u = wave(edges, edges[1::2], [1] * gaps, K)
    f = tuple(map(K.coerce, u.kdv.spectral(u.start).f))
    matrix = periods(HyperellipticCurve(K, f))
    of_x, of_t = directions_of_waves(K, f)
    ctx.dps = 60
    try:
        A, tau = (acb_mat([[number(acb, c) for c in row] for row in rows]) for rows in (matrix.A, matrix.tau))
        along, over = (A.solve(acb_mat([[number(acb, c)] for c in c])) for c in (of_x, of_t))
        places = [(K.coerce(x), K.coerce(t)) for x, t in ((0, 0), ("0.5", 0), (-3, "1.5"), (40, 7))]
        values = [number(acb, u.at(x, t)[()]) for x, t in places]
        differences = []
        for half in product((0, 1), repeat=2 * gaps):
            shift = acb_mat([[c] for c in half[:gaps]]) + tau * acb_mat([[c] for c in half[gaps:]])
            z = [along * number(acb, x) + over * number(acb, t) + shift * acb(0.5) for x, t in places]
            try:
                rest = [value + 2 * curvature(acb, tau, w, along) for value, w in zip(values, z, strict=True)]
            except ZeroDivisionError:
                continue
            differences.append(max(float(abs((a - rest[0]).mid())) for a in rest))
        assert min(d for d in differences if d == d) < 1e-25
        assert sorted(d for d in differences if d == d)[1] > 1e-3
    finally:
        ctx.dps = 15


def number(acb, c):
    return acb(str(c.real), str(c.imag)) if hasattr(c, "imag") else acb(str(c))


def curvature(acb, tau, z, along):
    """∂² log θ(z) along a vector, by differences."""
    h = acb(10) ** -15
    below, middle, above = (tau.theta(z + along * (h * k))[0, 0] for k in (-1, 0, 1))
    if not abs(middle) > 1e-20:
        raise ZeroDivisionError
    return (below * above / middle**2).log() / h**2


def test_closed_gaps_and_bands_leave_no_trace() -> None:
    """A double edge at an eigenvalue is left out: fewer gaps, the same u; with none left u is constant."""
    x, t = np.array([0.0, 0.75, -2]), np.array([1.0, 0.5, 0.25])
    plain = wave((0, 3, 4), (3.5,), (1,)).at(x, t)
    assert (wave((0, 1, 1, 3, 4), (1, 3.5), (1, 1)).at(x, t) == plain).all()
    assert (wave((0, 2, 2, 3, 4), (2, 3.5), (1, 1)).at(x, t) == plain).all()
    assert (wave((-1, -1, 0, 3, 4), (-1, 3.5), (1, 1)).at(x, t) == plain).all()
    assert (wave((0, 1, 1), (1,), (1,)).at(x, t) == 0).all()
    assert (wave((2, 2, 2), (2,), (1,)).at(x, t) == 2).all()


def test_a_soliton_before_a_periodic_wave_is_a_solution() -> None:
    """One band is closed; the residual of the equation, by differences of long numbers."""
    K = MP(60)
    u, h = wave((-1, -1, 0, 1, 2), (-0.5, 1.5), (1, 1), K), K.coerce("1e-8")
    x, t = K.coerce("0.25"), K.coerce("0.5")
    at = u.at([x + k * h for k in range(-4, 5)], t)
    times = u.at(x, [t + k * h for k in range(-4, 5)])
    first, of_time = (K.dot((3, -32, 168, -672, 0, 672, -168, 32, -3), a) / (840 * h) for a in (at, times))
    third = K.dot((-7, 72, -338, 488, 0, -488, 338, -72, 7), at) / (240 * h**3)
    assert abs(of_time - 6 * at[4] * first + third) < 1e-25


def test_a_soliton_in_a_gap_above_the_potential() -> None:
    """u < 0.04 and the double edge at 1.01: the decay there comes from interference."""
    u = wave((0, 1, 1.01, 1.01, 1.02), (1.005, 1.015), (1, 1))
    fine = wave((0, 1, 1.01, 1.01, 1.02), (1.005, 1.015), (1, 1), MP(40))
    x, t = np.array([0.5, -20]), np.array([1.0, -3])
    assert np.abs(u.at(x, t) - fine.at(x, t).astype(float)).max() < 4e-16


def test_a_narrow_band_is_no_double_edge() -> None:
    """Solitons in a row, so far apart that the eigenvalue is as close to the band as the band is narrow."""
    width = 2.0**-50
    u, fine = (wave((-1, width - 1, 0), (-0.25,), (1,), *K) for K in ((), (MP(40),)))
    x, t = np.array([17.5, 1e3, -1e5]), np.array([0, 10.0, -1e3])
    assert np.abs(u.at(x, t) - fine.at(x, t).astype(float)).max() < 4e-16
    # the distance of solitons: K(1 − width) = log(4/√width)
    period = 2 * np.log(4 / np.sqrt(width))
    assert abs(u.at(5 * period) - u.at(0.0)) < 1e-11


def test_a_soliton_too_far_away_is_refused() -> None:
    """On the way to t its eigenvalue comes so near its edge that no digit is left: u would be 0 at x = 4t instead of
    −2.
    """
    u = wave((-1, -1, 0), (0,), (1,))
    assert abs(u.at(40.0, 10.0) + 2) < 1e-14
    for x, t in ((4e6, 1e6), (4000, 1000), (900, 0)):
        with pytest.raises(PrecisionLoss):
            u.at(x, t)
    assert u.at(0.0) == -2


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: KdV((0, 1)), "edges = (0, 1)"),
        (lambda: KdV((0, 2, 1)), "edges = (0, 2, 1)"),
        (lambda: KdV(3), "edges = 3"),
        (lambda: KdV((0, 1, "x")), "edges[2]"),
        (lambda: KdV((0, 1, 2), CC), "field = CC"),
        (lambda: KdV((0, 1, 2)).state([3]), "gamma[0] = 3"),
        (lambda: KdV((0, 1, 2)).state([1, 2]), "gamma = [1, 2]"),
        (lambda: KdV((0, 1, 2)).state([1.5], [2]), "signs = [2]"),
        (lambda: KdV((-4, -4, -1, -1, 0)).state([-1, -1]), "gamma = [-1, -1]"),
        (lambda: KdV((0, 1, 2)).wave("rest"), "state = 'rest'"),
        (lambda: KdV((0, 1, 2)).spectral(3), "state = 3"),
        (lambda: KdV((0, 1, 2, 3, 4)).spectral(KdV((0, 1, 2)).state([1.5])), "state = "),
        (lambda: KdV((0, 1, 2), GF(101)).wave(KdV((0, 1, 2)).state([1.5])), "GF(101)"),
        (lambda: wave((0, 1, 2), (1.5,), (1,)).at("a"), "x = 'a'"),
        (lambda: wave((0, 1, 2), (1.5,), (1,)).at(0, float("inf")), "t = inf"),
        (lambda: wave((0, 1, 2), (1.5,), (1,)).at([1, 2], [1, 2, 3]), "x, t"),
    ],
)
def test_bad_input_is_named(call, words) -> None:
    with pytest.raises((ArgumentError, FieldError)) as caught:
        call()
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_wave_at_one_place_from_the_edges_of_its_gaps() -> None:
    """Both γ_j at edges, u even in x and t: u, u_x at x = 0 by TwoGaps are those of the wave with these edges."""
    K = MP(40)
    system, wide = TwoGaps((0, -5, 0), K), wave((-2, -1, 0, 1, 2), (0, 2), (1, 1), K)
    state = system.state((-4, 28), (0, 0))
    assert system.integrals(state) == {"s4": 4, "s5": 0}
    times, h = [K.coerce(t) for t in (0.1, 3, 1000)], K.coerce(10) ** -12
    path = system.flow(state).at(times)
    values, right, left = (wide.at(x, times) for x in (K.zero, h, -h))
    assert np.abs(path.q[:, 0] - values).max() < 1e-37
    assert np.abs(path.p[:, 0] - (right - left) / (2 * h)).max() < 1e-19


@pytest.mark.parametrize("sums", [(1, 2), "abc", (1, 2, "x"), 3])
def test_sums_of_edges_are_three_numbers(sums) -> None:
    with pytest.raises(ArgumentError, match="sums"):
        TwoGaps(sums)
