"""The addition along an oval is that of the sign-resolved group of its curve: exactly, and in many digits."""

from random import Random
from types import SimpleNamespace

import pytest

from integrable.deformations.oval import SeparatedOval
from integrable.phase.jets import JetField
from jacobian import GF, MP, HyperellipticCurve, NotASquare, NotRepresentable, poly
from jacobian.relatives.signed import SignedDivisor, SignedGroup


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
    """In any order of the e_i; a sum of three is one sum or the other, signs included."""
    rng, N, done = Random(1), JetField(K, 0), 0
    while done < 10:
        e, (z, w) = [K.random(rng) for _ in range(3)], (K.random(rng) for _ in range(2))
        low = rng.randrange(3)
        signs = [1 if i == low else -1 for i in range(3)]
        oval = SimpleNamespace(low=low, signs=signs)
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

        def added(roots, steps, oval=oval):
            return [
                x.value
                for x in SeparatedOval.added(oval, [N.constant(x) for x in roots], [N.constant(x) for x in steps])
            ]

        assert added(r, s) == [sigma for sigma, _ in total.pairs]
        assert added(added(r, s), s) == [sigma for sigma, _ in again.pairs]
        assert group.add(D, twice) == again
        done += 1


def test_in_many_digits():
    K = MP(40)
    curve = SeparatedOval(
        K, [K.coerce(x) for x in (1, 2, 4)], K.coerce("3"), [K.coerce(x) for x in ("0.9", "0.4", "0.3")], 1
    )
    # a point of the oval: Z between the least two of e = 3, 3/2, 3/4
    z = K.one
    r = [abs(z - x) ** (K.one / 2) for x in curve.e]
    group, D = group_of(K, curve.e), on_the_oval(K, z, r, curve.signs)
    for w in ("3.5", "30", "4000"):
        s = [(K.coerce(w) - x) ** (K.one / 2) for x in curve.e]
        total = group.add(D, translation(K, K.coerce(w), s))
        found = curve.added(r, s)
        assert max(abs(x - y) for x, (y, _) in zip(found, total.pairs, strict=True)) < 1e-35
