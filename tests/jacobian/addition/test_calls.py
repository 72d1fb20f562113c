"""The compiled kernels of single classes: equal to Cantor in Python on every pair, special case and ladder."""

from itertools import product
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian import GF, QQ, HyperellipticCurve
from jacobian.addition import cantor, cantor_flint
from jacobian.addition.calls import ExplicitKernel, WordKernel, word_kernel
from jacobian.addition.class_loops import signed_windows
from jacobian.addition.ladder import multiple, signed_digits
from tests.jacobian.group_curves import inside, random_curve, small_fields, triple
from tests.jacobian.jacobian_rows import ROWS

SMALL = small_fields("GF(2)")
SMALL_ROWS = [
    pytest.param(
        *(name, genus, model, with_h),
        id=f"{name}-g{genus}-{model}-{'h' if with_h else '0'}",
        # larger groups use the same code; GF(9) and GF(8) on elliptic curves and genus 3 over GF(3) are tested every
        # day
        marks=pytest.mark.slow if (K.order > 5 and genus > 1) or (K.order == 4 and genus == 3) else (),
    )
    for name, K in SMALL.items()
    for genus in (1, 2, 3)
    if genus < 3 or K.order < 5
    for model in ("ramified", "split", "inert")
    if model != "inert" or genus == 2
    for with_h in ((True,) if K.characteristic == 2 else (False, True))
]
# primes of every length that fits into a word, including the largest one below 2^63
PRIMES = (3, 5, 65537, 2**31 - 1, 2**31 + 11, 2**61 - 1, 2**62 + 135, 2**63 - 25)


def plain_multiple(C, m, a):
    return multiple(
        m,
        a,
        lambda a, b: cantor.sum_of(C, a, b),
        lambda a: cantor.double(C, a),
        lambda a: cantor.negate(C, a),
    )


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("name", "genus", "model", "with_h"), SMALL_ROWS)
def test_every_pair_of_a_small_group(name, genus, model, with_h):
    C = random_curve(SMALL[name], genus, "pairs", model=model, with_h=with_h).arithmetic_model
    kernel = word_kernel(C)
    triples = [triple(D) for D in C.jacobian().points()]
    assert len(triples) == C.jacobian().order()
    for a in triples:
        assert kernel.double(a) == cantor.double(C, a)
    for a, b in product(triples, repeat=2):
        assert kernel.sum_of(a, b) == cantor.sum_of(C, a, b), (a, b)


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", [pytest.param(row, id=str(row)) for row in ROWS if row.K != QQ])
def test_pairs_and_multiples_of_every_row(row):
    C = row.curve.arithmetic_model
    kernel, rng = word_kernel(C), Random(str(row))
    triples = [inside(D) for D in row.pool]
    for a in triples:
        assert kernel.double(a) == cantor.double(C, a)
    for a, b in product(triples, triples[: 12 if row.genus < 5 else 3]):
        assert kernel.sum_of(a, b) == cantor.sum_of(C, a, b), (a, b)
    for a in triples[:: 1 if row.genus < 4 else 3]:
        m = rng.getrandbits(rng.choice((4, 30, 61)))
        for scalar in (1, 2, 3, m + 1):
            assert kernel.multiple(scalar, a) == plain_multiple(C, scalar, a), (scalar, a)


@pytest.mark.thinned(3)
@pytest.mark.parametrize("p", PRIMES)
@pytest.mark.parametrize("model", ["ramified", "split"])
@pytest.mark.parametrize("genus", [2, 3])
def test_primes_up_to_the_end_of_a_word(p, model, genus):
    for with_h in (False, True):
        C = random_curve(GF(p), genus, "word", model=model, with_h=with_h).arithmetic_model
        kernel, J, rng = word_kernel(C), C.jacobian(), Random(p)
        if p < 100:
            a, b = triple(J.random(rng)), triple(J.random(rng))
        else:
            a, b = (triple(J.from_points([C.random_point(rng) for _ in range(genus)])) for _ in range(2))
        for _ in range(40):
            total = kernel.sum_of(a, b)
            assert total == cantor.sum_of(C, a, b)
            assert kernel.double(a) == cantor.double(C, a)
            a, b = b, total
        assert all(type(c) is int and 0 <= c < p for c in (*a[0], *a[1]))
        opposite, zero = cantor.negate(C, a), triple(C.jacobian().zero())
        assert kernel.sum_of(a, opposite) == zero == kernel.sum_of(zero, zero)
        assert kernel.sum_of(kernel.double(a), opposite) == a


@pytest.mark.thinned(3)
@pytest.mark.parametrize("with_h", [False, True])
@pytest.mark.parametrize("model", ["ramified", "split", "inert"])
@pytest.mark.parametrize("K", [GF(7), GF(2, 3, (1, 1, 0, 1)), GF(3, 2, (2, 2, 1))], ids=["GF(7)", "GF(8)", "GF(9)"])
def test_ladders_through_every_multiple_of_a_class(K, model, with_h):
    """All m up to beyond the order: every ladder meets 0, equal and opposite classes on its way."""
    if K.characteristic == 2 and not with_h:
        pytest.skip("y² = f is singular in characteristic 2")
    C = random_curve(K, 2, "ladder", model=model, with_h=with_h).arithmetic_model
    kernel, J = word_kernel(C), C.jacobian()
    for D in list(J.points())[:: max(1, J.order() // 4)]:
        a = total = triple(D)
        for m in range(1, 2 * J.order() + 2):
            assert kernel.multiple(m, a) == total, (m, a)
            total = cantor.sum_of(C, total, a)
        assert kernel.multiple(J.order(), a) == triple(C.jacobian().zero())


@given(m=st.integers(1, 2**400), width=st.sampled_from((2, 4, 5)))
def test_the_windows_are_those_of_the_ladder_in_python(m, width):
    data = m.to_bytes((m.bit_length() + 7) // 8, "little")
    digits = [0] * (8 * len(data) + 1)
    last = signed_windows(data, width, digits)
    assert digits[: last + 1] == signed_digits(m, width)
    assert not any(digits[last + 1 :])


KERNELS = {
    f"{K.name}-g{genus}-{model}": random_curve(K, genus, "any", model=model)
    for K in (GF(2**61 - 1), GF(2**63 - 25), GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)), GF(3, 5, (1, 2, 0, 0, 0, 1)))
    for genus, model in ((2, "ramified"), (2, "split"), (3, "ramified"))
}


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", KERNELS)
@settings(max_examples=15)
@given(seed=st.integers(0, 2**32), m=st.integers(1, 2**260), n=st.integers(1, 2**260))
def test_multiples_add_up(name, seed, m, n):
    C = KERNELS[name].arithmetic_model
    kernel, rng = word_kernel(C), Random(seed)
    # few points, so that classes have points in common
    points = [C.random_point(rng) for _ in range(3)]
    J = C.jacobian()
    a, b = (triple(J.from_points(rng.choices(points, k=rng.randrange(C.genus + 1)))) for _ in range(2))
    assert kernel.sum_of(a, b) == cantor.sum_of(C, a, b)
    first, second = kernel.multiple(m, a), kernel.multiple(n, a)
    assert kernel.multiple(m + n, a) == cantor.sum_of(C, first, second)
    total = cantor.sum_of(C, a, b)
    assert kernel.multiple(m, total) == cantor.sum_of(C, first, kernel.multiple(m, b))


ROWS_TO_WALK = {
    "GF(2^61-1) ramified": (random_curve(GF(2**61 - 1), 2, "walk", model="ramified"), 40_000),
    "GF(2^61-1) split": (random_curve(GF(2**61 - 1), 2, "walk", model="split"), 40_000),
    "GF(2^63-25) ramified": (random_curve(GF(2**63 - 25), 2, "walk", model="ramified"), 20_000),
    "GF(2^61-1) genus 3": (random_curve(GF(2**61 - 1), 3, "walk", model="ramified"), 20_000),
    "GF(2^61-1) with h": (random_curve(GF(2**61 - 1), 2, "walk", model="split", with_h=True), 20_000),
    "GF(2^8)": (random_curve(GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)), 2, "walk", model="split"), 10_000),
    "GF(3^5)": (random_curve(GF(3, 5, (1, 2, 0, 0, 0, 1)), 2, "walk", model="ramified"), 10_000),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", ROWS_TO_WALK)
def test_a_long_walk(name):
    """Walks of 10 000 to 40 000 additions, against Cantor on flint; every hundredth against Python's."""
    C, steps = ROWS_TO_WALK[name]
    C, rng = C.arithmetic_model, Random(name)
    kernel, other = word_kernel(C), cantor_flint.FlintCantor(C)
    a, b = (triple(C.jacobian().from_points([C.random_point(rng) for _ in range(C.genus)])) for _ in range(2))
    for step in range(steps):
        total = kernel.sum_of(a, b)
        assert total == other.sum_of(a, b), (a, b)
        if step % 100 == 0:
            assert total == cantor.sum_of(C, a, b)
            total = kernel.double(total)
        a, b = b, total


def test_which_kernel_a_curve_gets():
    K = GF(10007)
    f = [3, 1, 4, 1, 5, 1]
    assert type(word_kernel(HyperellipticCurve(K, f))) is ExplicitKernel
    assert type(word_kernel(HyperellipticCurve(K, [*f, 4]))) is ExplicitKernel
    # the formulas for short equations need h = 0 and, in degree 5, a monic f
    assert type(word_kernel(HyperellipticCurve(K, [*f[:5], 2]))) is WordKernel
    assert type(word_kernel(HyperellipticCurve(K, f, [1]))) is WordKernel
    assert type(word_kernel(HyperellipticCurve(K, [1, 0, 3, 1]))) is WordKernel


def test_a_degenerate_line_is_left_to_the_general_path(monkeypatch):
    """v₁ = 0 in the sum of two general classes: the short call cannot tell it from a special case."""
    K = GF(101)
    C = HyperellipticCurve(K, [3, 1, 4, 1, 5, 1])
    kernel, asked = word_kernel(C), []
    original = WordKernel.sum_of
    monkeypatch.setattr(WordKernel, "sum_of", lambda self, a, b: asked.append(1) or original(self, a, b))
    flat = next(D for D in C.jacobian().points() if D.degree == 2 and len(D.v) == 1)
    rng = Random(0)
    while True:
        b = triple(C.jacobian().random(rng))
        a = cantor.sum_of(C, triple(flat), cantor.negate(C, b))
        if len(a[1]) == len(b[1]) == 2:
            break
    assert kernel.sum_of(a, b) == triple(flat)
    assert asked == [1]
