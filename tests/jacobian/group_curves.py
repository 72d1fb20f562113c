"""Small fields and random curves for the tests of kernels, orders, structure, logarithms and pairings."""

from random import Random

import pytest

from jacobian import GF, ArgumentError, Divisor, HyperellipticCurve, poly

SMALL = {
    "GF(2)": GF(2),
    "GF(3)": GF(3),
    "GF(4)": GF(2, 2, (1, 1, 1)),
    "GF(5)": GF(5),
    "GF(7)": GF(7),
    "GF(8)": GF(2, 3, (1, 1, 0, 1)),
    "GF(9)": GF(3, 2, (2, 2, 1)),
}


def small_fields(*without):
    """:data:`SMALL` without the fields of these names."""
    return {name: K for name, K in SMALL.items() if name not in without}


def genus_two_rows(fields):
    """(name, model, with_h) for every field, with and without h where the characteristic is odd; for the largest fields
    one model is tested every day, since smaller fields take the same paths.
    """
    return [
        pytest.param(
            *(name, model, with_h),
            id=f"{name}-{model}-{'h' if with_h else '0'}",
            marks=pytest.mark.slow if K.order > 7 and (model != "ramified" or not with_h) else (),
        )
        for name, K in fields.items()
        for model in ("ramified", "split", "inert")
        for with_h in ((True,) if K.characteristic == 2 else (False, True))
    ]


def triple(D):
    """The representation that :mod:`jacobian.addition.cantor` computes with."""
    return D.u, D.v, D.n


def inside(D):
    """The triple of a class on the arithmetic model of its curve."""
    return inner(D.jacobian, *triple(D))


def inner(J, u, v, n):
    """(u, v, n) on the arithmetic model of the curve, where v is v − z₀x^(g+1) mod u."""
    return u, _moved(J, u, v, poly.sub), n


def outside(J, found):
    """The class with a triple on the arithmetic model of the curve."""
    u, v, n = found
    return Divisor(J, u, _moved(J, u, v, poly.add), n)


def _moved(J, u, v, way):
    C, K = J.curve, J.field
    if C.arithmetic_model is C:
        return v
    return poly.mod(K, way(K, v, poly.monomial(K, C.infinity_plus, C.genus + 1)), u)


def random_curve(K, genus, seed, *, model=None, with_h=False):
    """The first smooth curve of this genus (and model) from a generator with this seed."""
    return next_curve(K, genus, Random(f"{K.name} {genus} {model} {with_h} {seed}"), model=model, with_h=with_h)


def next_curve(K, genus, rng, *, model=None, with_h=False):
    """The next smooth curve of this genus (and model) from a generator."""
    with_h = with_h or K.characteristic == 2
    for _ in range(5000):
        size = 2 * genus + 2 if model == "ramified" else 2 * genus + 3
        f, h = poly.random(K, size, rng), poly.random(K, genus + (model != "ramified") + 1, rng) if with_h else ()
        try:
            C = HyperellipticCurve(K, f, h)
        except ArgumentError:
            continue
        if C.genus == genus and model in (None, C.model):
            return C
    raise AssertionError(f"no curve of genus {genus}, {model}, over {K.name}")
