"""The motion along an oval is an addition in the sign-resolved group of its curve: exactly, and in many digits."""

from math import pi
from random import Random

import pytest

from integrable.deformations.pole_flow import roots_of_cubic
from integrable.mumford.elliptic_torus import EllipticOval
from integrable.phase.jets import JetField
from jacobian import GF, MP, HyperellipticCurve, NotASquare, NotRepresentable, poly
from jacobian.inexact.long_field import LongField
from jacobian.numbers.long_reals import BareReals
from jacobian.relatives.signed import SignedDivisor, SignedGroup
from tests.integrable.deformations import additions


def group_of(K, e):
    """Y² = 4Π(Z − e_i), with pairs at the e_i."""
    f = poly.scale(K, poly.integer(K, 4) if K.exact else 4 * K.one, poly.from_roots(K, e))
    return SignedGroup(HyperellipticCurve(K, f), e)


def on_the_oval(K, z, r, signs):
    """(Z, 2R_1R_2R_3), κ_iR_i² = e_i − Z, κ_i = −signs_i."""
    y = K.mul(poly.integer(K, 2) if K.exact else 2 * K.one, K.mul(r[0], K.mul(r[1], r[2])))
    kappas = tuple(K.neg(K.one) if s > 0 else K.one for s in signs)
    pairs = tuple((x, K.div(y, K.mul(k, x))) for x, k in zip(r, kappas, strict=True))
    return SignedDivisor((K.neg(z), K.one), (y,), pairs, kappas)


def translation(K, z, s):
    """(℘, −2s_1s_2s_3), s_i² = ℘ − e_i."""
    step = on_the_oval(K, z, [K.neg(x) for x in s], (1, 1, 1))
    return step._replace(pairs=tuple((K.neg(x), K.neg(y)) for x, y in step.pairs))


@pytest.mark.parametrize("K", [GF(2**61 - 1), GF(7, 3, [4, 0, 6, 1])], ids=str)
def test_exactly(K):
    """For every order of the e_i, signs included; adding E twice is adding its double."""
    rng, N, done = Random(1), JetField(K, 0), 0
    while done < 10:
        e, (z, w) = [K.random(rng) for _ in range(3)], (K.random(rng) for _ in range(2))
        low = rng.randrange(3)
        signs = [1 if i == low else -1 for i in range(3)]
        try:
            r = [K.sqrt(K.sub(z, x) if s > 0 else K.sub(x, z)) for x, s in zip(e, signs, strict=True)]
            s = [rng.choice((1, -1)) * N.sqrt(N.constant(K.sub(w, x))) for x in e]
            s = [x.value for x in s]
            group = group_of(K, e)
            D, E = on_the_oval(K, z, r, signs), translation(K, w, s)
            total, twice = group.add(D, E), group.double(E)
            again = group.add(total, E)
        except (NotASquare, NotRepresentable, ZeroDivisionError, ValueError):
            continue

        def added(roots, steps, low=low, signs=signs):
            roots, steps = ([N.constant(x) for x in row] for row in (roots, steps))
            return [x.value for x in additions.added(low, signs, roots, steps)]

        assert added(r, s) == [sigma for sigma, _ in total.pairs]
        assert added(added(r, s), s) == [sigma for sigma, _ in again.pairs]
        assert group.add(D, twice) == again
        done += 1


def oval_of(K, e, z, turn):
    """The oval with these branch points, in ascending order, through Z = z."""
    return EllipticOval(K, e[1] - e[0], e[2] - e[1], (turn * K.sqrt(z - e[0]), K.sqrt(e[1] - z)))


def test_in_many_digits():
    """D(a) + D(b) = D(0) + D(a + b) in the group of the curve, signs included; and D(0) plus a translation."""
    K, N = MP(40), LongField(140)
    e = [K.coerce(x) / 4 for x in (3, 6, 12)]
    group = group_of(K, e)
    with N:
        curve = oval_of(N, [*map(N.coerce, e)], N.one, 1)

        def divisor(tau):
            r = curve.moved(N.coerce(tau))
            height, *r = BareReals(140).elements(K, (additions.height(curve, r), *r))
            return on_the_oval(K, e[0] + height, r, additions.SIGNS)

        for a, b in ((0.25, -1.75), (2.5, 100.25), (-7, 7)):
            one, other = (group.add(divisor(x), divisor(y)) for x, y in ((a, b), (0, a + b)))
            for (x, v), (y, w) in zip(one.pairs, other.pairs, strict=True):
                assert max(abs(x - y), abs(v - w)) < 1e-33
        D, start = divisor(0), BareReals(140).elements(K, curve.start)
    for w in map(K.coerce, ("3.5", "30", "4000")):
        s = [(w - x) ** (K.one / 2) for x in e]
        total = group.add(D, translation(K, w, s))
        found = additions.added(0, additions.SIGNS, start, s)
        assert max(abs(x - y) for x, (y, _) in zip(found, total.pairs, strict=True)) < 1e-35


CURVES = {
    "generic": ((0.75, 1.5, 3), 1.25),
    "below zero": ((-2, -0.5, 1), -1),
    "lowest point": ((0.5, 2, 3), 0.5),
    "highest point": ((0.5, 2, 3), 2),
    "nearly a separatrix": ((0, 2, 2 + 2.0**-40), 1),
    "nearly a circle": ((0, 2.0**-40, 1), 2.0**-42),
    "large": ((0, 2.0**200, 2.0**201), 2.0**198),
}


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("name", CURVES)
def test_theta_functions_give_what_additions_give(name, turn):
    """R_1, R_2, R_3 with their signs, and periods; starts at both ends of the oval."""
    e, z = CURVES[name]
    with LongField(200) as K:
        curve = oval_of(K, [K.coerce(x) for x in e], K.coerce(z), turn)
        size = max(map(abs, curve.start))
        assert max(abs(x - y) for x, y in zip(curve.moved(K.zero), curve.start, strict=True)) < 1e-40 * size
        for turns in (0.01, -0.3, 0.49, 0.5, 1, -7.75, 1e6, -12345678.25):
            tau = K.coerce(turns) * curve.period
            gaps = zip(curve.moved(tau), additions.moved(curve, tau), strict=True)
            assert max(abs(x - y) for x, y in gaps) < 1e-36 * size


@pytest.mark.parametrize("name", ["generic", "below zero", "nearly a separatrix"])
def test_times_beyond_the_oval(name):
    """Times from beyond both ends, by Carlson's integral."""
    e, _ = CURVES[name]
    with LongField(200) as K:
        curve = oval_of(K, [*map(K.coerce, e)], K.coerce(e[0]), 1)
        mp = MP(60).context
        for gap in (1e-3, 0.7, 40.0):
            above = mp.elliprf(*(e[2] + mp.mpf(gap) - x for x in e))
            half = mp.elliprf(0, mp.mpf(e[1]) - e[0], mp.mpf(e[2]) - e[0])
            below = half - mp.elliprf(*(x - (e[0] - mp.mpf(gap)) for x in e))
            assert abs(K.coerce(above) - curve.time_above(K.coerce(gap))) < 1e-45
            assert abs(K.coerce(below) - curve.time_below(K.coerce(gap))) < 1e-45


def test_a_point_is_an_oval_that_does_not_move():
    with LongField(100) as K:
        e = [K.coerce(x) for x in (0, 0, 1)]
        curve = oval_of(K, e, K.zero, 1)
        assert curve.moved(K.coerce(12.5)) == (0, 0, 1)
        assert abs(float(curve.period) - pi) < 1e-15


def test_the_roots_of_a_cubic():
    with LongField(140) as K:
        for e in ((-3, 1, 2), (-1, -1, 2), (-2, 1, 1)):
            one, two, three = map(K.coerce, e)
            g2, g3 = -4 * (one * two + two * three + three * one), 4 * one * two * three
            found = roots_of_cubic(K, g2, g3)
            # two equal roots have half the digits
            assert max(abs(x - y) for x, y in zip(found, e, strict=True)) < (1e-38 if len(set(e)) == 3 else 1e-19)
