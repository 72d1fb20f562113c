"""Curves for the tests of orders, structure, logarithms and pairings."""

from random import Random

from jacobian import ArgumentError, HyperellipticCurve, poly


def random_curve(K, genus, seed, *, model=None, with_h=False):
    """The first smooth curve of this genus (and model) from a seeded generator."""
    rng = Random(f"{K.name} {genus} {model} {with_h} {seed}")
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
