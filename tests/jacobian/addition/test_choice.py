"""Which kernel a group uses, and when it switches to compiled code."""

import logging
import math
from random import Random

import pytest

from jacobian import GF, QQ, RR, HyperellipticCurve
from jacobian.addition import calls, choice
from jacobian.addition.calls import ExplicitKernel, TwoWordKernel, WordKernel
from jacobian.addition.choice import Counted, compiled_kernel, costs, is_two_words_long, kernel, python_kernel
from jacobian.addition.explicit import GmpFormulas, PrimeFormulas
from jacobian.native.library import Library
from tests.jacobian.group_curves import random_curve
from tests.jacobian.jacobian_rows import Row

CURVE = HyperellipticCurve(GF(10007), [3, 1, 4, 1, 5, 1])


@pytest.fixture
def fresh(monkeypatch):
    """Sets the process to the state before any addition: it switches after 1000 additions, or 5000 if nothing is
    cached.
    """
    monkeypatch.setattr(choice.PROCESS, "additions", 0)
    monkeypatch.setattr(choice, "READY", 1000)
    monkeypatch.setattr(choice, "COLD", 5000)
    return monkeypatch


def owner(J):
    return type(J._sum_of.__self__)


def test_work_makes_the_change(fresh):
    fresh.setattr(calls, "is_kept", lambda *given: True)
    J = HyperellipticCurve(GF(10007), [3, 1, 4, 1, 5, 1]).jacobian()
    D = E = J.random(Random(1))
    sums = [E := E + D for _ in range(900)]
    assert owner(J) is Counted
    counted = J._sum_of
    sums += [E := E + D for _ in range(300)]
    assert owner(J) is ExplicitKernel
    assert J._double.__self__ is J._multiple.__self__ is J._sum_of.__self__
    # a kept reference to the old kernel leads to the new one
    assert counted.__self__._sum_of == J._sum_of
    add = python_kernel(CURVE).sum_of
    total = (D.u, D.v, D.n)
    for found in sums:
        total = add(total, (D.u, D.v, D.n))
        assert (found.u, found.v, found.n) == total


def test_nothing_is_compiled_for_little_work(fresh):
    fresh.setattr(calls, "is_kept", lambda *given: False)
    fresh.setattr(calls, "word_kernel", None)
    J = HyperellipticCurve(GF(10007), [3, 1, 4, 1, 5, 1]).jacobian()
    D = J.random(Random(1))
    for _ in range(4700):
        D = D.double()
    assert owner(J) is Counted
    fresh.setattr(calls, "word_kernel", WordKernel)
    for _ in range(400):
        D = D.double()
    assert owner(J) is WordKernel


def test_an_addition_does_not_fail_for_want_of_compiled_code(fresh, caplog):
    def unusable(C):
        raise RuntimeError("cannot cache function: no locator available")

    fresh.setattr(calls, "is_kept", lambda *given: True)
    fresh.setattr(calls, "word_kernel", unusable)
    J = HyperellipticCurve(GF(10007), [3, 1, 4, 1, 5, 1]).jacobian()
    D = J.random(Random(1))
    assert 2**3000 * D == 2**1500 * (2**1500 * D)
    for _ in range(2000):
        D = D.double()
    assert owner(J) is Counted
    assert [record.getMessage() for record in caplog.records] == [
        "no compiled kernels in this process: cannot cache function: no locator available"
    ]


def test_multiples_are_counted_by_their_length(fresh):
    fresh.setattr(calls, "is_kept", lambda *given: True)
    J = HyperellipticCurve(GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)), [1, 5, 7, 0, 2, 1], [1, 1]).jacobian()
    D, m = J.random(Random(1)), (1 << 100) + 1
    expected = m * D
    for _ in range(7):
        assert m * D == expected
    assert owner(J) is Counted
    for _ in range(3):
        assert m * D == expected
    assert owner(J) is ExplicitKernel
    assert J.explain().endswith("explicit formulas, and Cantor in special positions")


def test_a_group_of_few_additions_stays_as_it_is(fresh):
    fresh.setattr(choice.PROCESS, "additions", 10**9)
    J = HyperellipticCurve(GF(10007), [3, 1, 4, 1, 5, 1]).jacobian()
    D = J.random(Random(1))
    J._adopt(kernel(J._model, J._adopt))
    for _ in range(choice.SHARE):
        D = D.double()
    assert owner(J) is Counted
    D.double()
    assert owner(J) is ExplicitKernel


def test_binary_fields_of_two_words_are_compiled():
    J = HyperellipticCurve(GF(2, 20), [1, 1, 0, 0, 0, 1], [1, 1]).jacobian()
    assert costs(J.curve) < costs(HyperellipticCurve(GF(2**89 - 1), [1, 1, 0, 0, 0, 1]))
    J.compile()
    assert owner(J) is TwoWordKernel
    assert J.explain().startswith("compiled code on two words, for genus 2 over GF(2^n), 16 < n < 128: explicit")


def test_genus_3_is_compiled_on_two_words_where_its_formulas_apply():
    K = GF(2**127 - 1)
    J = HyperellipticCurve(K, [1, 1, 0, 0, 0, 0, 0, 1]).jacobian()
    D = J.random(Random(1))
    total, multiple = D + D.double(), 12345 * D
    J.compile()
    assert owner(J) is TwoWordKernel
    assert J.explain().startswith("compiled code on two words, for genus 3 over GF(p), 2^63 < p < 2^128: explicit")
    assert (D + D.double(), 12345 * D) == (total, multiple)
    others = [1, 1, 0, 0, 0, 0, 0, 0, 1], [1, 1, 0, 0, 0, 0, 0, 2]
    assert not any(is_two_words_long(HyperellipticCurve(K, f)) for f in others)


def test_primes_of_two_words_change_over_earlier(fresh):
    fresh.setattr(choice, "READY", 200)
    fresh.setattr(choice, "COLD", 700)
    fresh.setattr(Library, "is_kept", lambda self: False)
    J = HyperellipticCurve(GF(2**89 - 1), [3, 1, 4, 1, 5, 1]).jacobian()
    assert "compiled code after 200 additions" in J.explain()
    D = E = J.random(Random(1))
    sums = [E := E + D for _ in range(600)]
    assert owner(J) is Counted
    fresh.setattr(Library, "is_kept", lambda self: True)
    sums += [E := E + D for _ in range(100)]
    assert owner(J) is TwoWordKernel
    assert J.explain().startswith("compiled code on two words, for genus 2 over GF(p), 2^63 < p < 2^128: explicit")
    add = python_kernel(J.curve).sum_of
    total = (D.u, D.v, D.n)
    for found in sums:
        total = add(total, (D.u, D.v, D.n))
        assert (found.u, found.v, found.n) == total


def test_compile_at_once(caplog):
    C = random_curve(GF(101), 2, "compile", model="split", with_h=True)
    J, rng = C.jacobian(), Random(2)
    D, E = J.random(rng), J.random(rng)
    expected = D + E, D.double(), 77 * D, -77 * D
    with caplog.at_level(logging.WARNING):
        J.compile()
    assert owner(J) is WordKernel
    assert (D + E, D.double(), 77 * D, -77 * D) == expected
    assert not caplog.records


def test_a_moved_model_is_compiled_too():
    # formal degree 6 with one point at infinity: additions use another equation, results are in the curve's own
    # coordinates
    C = Row("GF(7)", "moved", 2, True).curve
    assert C.arithmetic_model is not C
    J = C.jacobian()
    every = list(J.points())
    sums = [D + E for D in every for E in every[:5]]
    J.compile()
    assert owner(J) in (WordKernel, ExplicitKernel)
    assert [D + E for D in every for E in every[:5]] == sums


@pytest.mark.parametrize(
    "C",
    [
        HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]),
        HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1]),
        HyperellipticCurve(GF(2), [1, 0, 0, 0, 0, 1], [1]),
        HyperellipticCurve(GF(2**128 + 51), [1, 1, 0, 0, 0, 1]),
        HyperellipticCurve(GF(2**89 - 1), [1, 1, 0, 0, 0, 2]),
        HyperellipticCurve(GF(2**89 - 1), [1, 1, 0, 0, 0, 1], [1]),
        HyperellipticCurve(GF(2**63 + 29), [1, 1, 0, 1]),
        HyperellipticCurve(GF(2**61 - 1, 2, (1, 0, 1)), [1, 1, 0, 0, 0, 1]),
        HyperellipticCurve(GF(2, 20), [1, 1, 0, 0, 0, 2], [1]),
        HyperellipticCurve(GF(2, 128), [1, 1, 0, 0, 0, 1], [1]),
    ],
    ids=repr,
)
def test_other_fields_have_no_compiled_kernel(C):
    J = C.jacobian()
    before = getattr(J, "_sum_of", None)
    J.compile()
    assert getattr(J, "_sum_of", None) == before
    if C.field.exact:
        assert owner(J) is not Counted
        assert compiled_kernel(C) is None


@pytest.mark.parametrize(("p", "formulas"), [(10007, PrimeFormulas), (2**89 - 1, GmpFormulas)])
def test_long_primes_take_gmp(p, formulas):
    C = HyperellipticCurve(GF(p), [1, 1, 0, 0, 0, 1])
    assert type(kernel(C).sum_of.__self__) is formulas


@pytest.mark.thinned(5)
@pytest.mark.parametrize("with_h", [False, True])
@pytest.mark.parametrize("model", ["ramified", "split", "inert"])
@pytest.mark.parametrize("p", [101, 2**61 - 1, 2**127 - 1, 2**255 - 19])
def test_gmp_gives_the_same_ints(p, model, with_h):
    C = random_curve(GF(p), 2, "gmp", model=model, with_h=with_h).arithmetic_model
    on_gmp, on_ints = GmpFormulas(C), choice._with_ladder(C, PrimeFormulas(C).sum_of, PrimeFormulas(C).double)
    rng, J = Random(p), C.jacobian()
    a, b = ((D.u, D.v, D.n) for D in (J.from_points([C.random_point(rng) for _ in range(2)]) for _ in range(2)))
    zero = (1,), (), J.weight_of_zero
    for _ in range(10):
        total = on_gmp.sum_of(a, b)
        assert total == on_ints.sum_of(a, b)
        assert on_gmp.double(a) == on_ints.double(a)
        m = rng.getrandbits(rng.choice((3, 60, 140))) + 1
        found = on_gmp.multiple(m, a)
        assert found == on_ints.multiple(m, a)
        assert {type(c) for c in (*total[0], *total[1], *found[0], *found[1])} == {int}
        assert on_gmp.sum_of(a, zero) == a
        a, b = b, total


EXPLAINED = [
    (GF(2**89 - 1), [1, 2, 0, 0, 0, 1], "gmpy2's integers: genus 2"),
    (GF(10007), [1, 2, 0, 0, 0, 1], "explicit formulas on ints: genus 2 over GF(p), p of less than 32 bits"),
    (GF(2**89 - 1, 2), [1, 2, 0, 0, 0, 1], "over GF("),
    (QQ, [1, 2, 0, 0, 0, 1], "python-flint's polynomials: over QQ in genus 2"),
    (GF(2**89 - 1), [1, 2, 0, 0, 0, 0, 0, 0, 1], "gmpy2's integers: genus 3"),
    (GF(2**89 - 1), [1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 1], "python-flint's polynomials"),
    (GF(2**89 - 1), [1, 2, 0, 0, 0, 0, 0, 1], "gmpy2's integers: genus 3"),
    (GF(10007), [1, 2, 0, 0, 0, 0, 0, 1], "explicit formulas on ints: genus 3 over GF(p), p of less than 32 bits"),
    (RR, [1, 2, 0, 0, 0, 1], "orthogonal transformations"),
]


@pytest.mark.parametrize(("K", "f", "said"), EXPLAINED)
def test_a_group_says_what_it_runs(K, f, said):
    assert said in HyperellipticCurve(K, f).jacobian().explain()


def test_what_a_group_says_follows_what_it_runs(fresh):
    J = HyperellipticCurve(GF(10007), [3, 1, 4, 1, 5, 1]).jacobian()
    before = J.explain()
    assert "after 1000 additions" in before
    assert "(0 so far); J.compile() changes over now" in before
    J.compile()
    assert J.explain().startswith("compiled code")
    assert J.explain().endswith("explicit formulas, and Cantor in special positions")
    for f, h in (([3, 1, 4, 1, 5, 2], ()), ([3, 1, 4, 1, 5, 1], [1, 1])):
        J = HyperellipticCurve(GF(10007), f, h).jacobian()
        J.compile()
        assert type(J._sum_of.__self__) is WordKernel
        assert "want h = 0" in J.explain()
    fresh.setattr(choice.PROCESS, "additions", -math.inf)
    assert "compiled code failed" in HyperellipticCurve(GF(10007), [5, 1, 4, 1, 5, 1]).jacobian().explain()


def test_what_genus_3_says_when_compiled():
    said = {
        (1, 2, 0, 0, 0, 0, 0, 1): "explicit formulas, and Cantor in special positions",
        (1, 2, 0, 0, 0, 0, 0, 2): "explicit formulas in genus 3 want GF(p), h = 0 and a monic f of degree 7",
        (1, 2, 0, 0, 0, 0, 0, 0, 1): "explicit formulas in genus 3 want GF(p), h = 0 and a monic f of degree 7",
        (1, 2, 0, 0, 0, 0, 0, 0, 0, 1): "explicit formulas are for genus 2 and 3",
    }
    for f, text in said.items():
        J = HyperellipticCurve(GF(10007), f).jacobian()
        D = J.random(Random(1))
        expected = 1234 * D, D.double(), -D + 5 * D
        J.compile()
        assert J.explain().endswith(text)
        assert (1234 * D, D.double(), -D + 5 * D) == expected


def test_kernels_in_python_by_genus():
    K = GF(2, 127, (1, 1, *[0] * 125, 1))
    for genus, said in ((3, "Cantor in Python: below genus 5"), (5, "NUCOMP in Python: from genus 5")):
        C = HyperellipticCurve(K, [1] + [0] * (2 * genus) + [1], [1])
        assert choice.explained(C, python_kernel(C).sum_of).startswith(said)
