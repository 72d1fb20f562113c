"""The motion along an oval is an addition in the sign-resolved group of its curve: exactly, and in many digits."""

from random import Random

import pytest

from integrable.deformations.oval import SeparatedOval
from integrable.deformations.pole_flow import roots_of_cubic
from integrable.phase.jets import JetField
from jacobian import GF, MP, HyperellipticCurve, NotASquare, NotRepresentable, poly
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
    """The oval with these branch points through Z = z."""
    sizes = [abs(z - x) ** (K.one / 2) for x in e]
    return SeparatedOval(K, e, lambda i, j: e[i] - e[j], sizes, turn)


def test_in_many_digits():
    """D(a) + D(b) = D(0) + D(a + b) in the group of the curve, signs included; and D(0) plus a translation."""
    K = MP(40)
    e = [K.coerce(x) / 4 for x in (12, 6, 3)]
    curve = oval_of(K, e, K.one, 1)
    group = group_of(K, e)

    def divisor(tau):
        r = curve.moved(K.coerce(tau))
        return on_the_oval(K, additions.height(curve, r), r, curve.signs)

    for a, b in (("0.3", "-1.7"), ("2.5", "100.25"), ("-7", "7")):
        one, other = (group.add(divisor(x), divisor(y)) for x, y in ((a, b), (0, K.coerce(a) + K.coerce(b))))
        for (x, v), (y, w) in zip(one.pairs, other.pairs, strict=True):
            assert max(abs(x - y), abs(v - w)) < 1e-33
    D = divisor(0)
    for w in ("3.5", "30", "4000"):
        s = [(K.coerce(w) - x) ** (K.one / 2) for x in curve.e]
        total = group.add(D, translation(K, K.coerce(w), s))
        found = additions.added(curve.low, curve.signs, curve.start, s)
        assert max(abs(x - y) for x, (y, _) in zip(found, total.pairs, strict=True)) < 1e-35


CURVES = {
    "generic": ((3, 1.5, 0.75), 1.25),
    "in another order": ((-2, 1, -0.5), -1),
    "lowest point": ((0.5, 3, 2), 0.5),
    "highest point": ((0.5, 3, 2), 2),
    "nearly a separatrix": ((0, 2, 2 + 2.0**-40), 1),
    "nearly a circle": ((0, 2.0**-40, 1), 2.0**-42),
    "large": ((0, 2.0**200, 2.0**201), 2.0**198),
}


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("name", CURVES)
def test_theta_functions_give_what_additions_give(name, turn):
    """R_1, R_2, R_3 with their signs, and periods; any order of e_i, starts at both ends of the oval."""
    K = MP(60)
    e, z = CURVES[name]
    curve = oval_of(K, [K.coerce(x) for x in e], K.coerce(z), turn)
    size = max(map(abs, curve.start))
    assert max(abs(x - y) for x, y in zip(curve.moved(K.zero), curve.start, strict=True)) < 1e-40 * size
    for turns in ("0.01", "-0.3", "0.49", "0.5", "1", "-7.75", "1e6", "-12345678.25"):
        tau = K.coerce(turns) * curve.period
        gaps = zip(curve.moved(tau), additions.moved(curve, tau), strict=True)
        assert max(abs(x - y) for x, y in gaps) < 1e-36 * size


def test_a_point_is_an_oval_that_does_not_move():
    K = MP(30)
    e = [K.coerce(x) for x in (0, 0, 1)]
    curve = oval_of(K, e, K.zero, 1)
    assert curve.moved(K.coerce(12.5)) == [0, 0, 1]
    assert abs(curve.period - K.context.pi) < 1e-28


def test_the_roots_of_a_cubic():
    K = MP(40)
    for e in ((-3, 1, 2), (-1, -1, 2), (-2, 1, 1)):
        one, two, three = map(K.coerce, e)
        g2, g3 = -4 * (one * two + two * three + three * one), 4 * one * two * three
        found = roots_of_cubic(K, g2, g3)
        # two equal roots have half the digits
        assert max(abs(x - y) for x, y in zip(found, e, strict=True)) < (1e-38 if len(set(e)) == 3 else 1e-19)
