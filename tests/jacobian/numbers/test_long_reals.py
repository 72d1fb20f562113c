"""Bare reals of all three kinds beside mpmath, and the precision that they leave as they found it."""

from __future__ import annotations

import sys

import flint
import gmpy2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jacobian import MP
from jacobian.errors import ArgumentError
from jacobian.numbers.long_reals import KINDS, BareReals
from jacobian.numbers.roots import root

K = MP(60)
NUMBERS = st.one_of(
    st.integers(-(10**80), 10**80),
    st.floats(allow_nan=False, allow_infinity=False),
    st.tuples(st.integers(-(2**190), 2**190), st.integers(-300, 300)).map(lambda p: K.context.ldexp(p[0], p[1])),
)


@pytest.mark.parametrize("kind", KINDS)
@given(x=NUMBERS)
def test_numbers_come_back_as_they_were(kind, x) -> None:
    reals, wide = BareReals(1200, kind), MP(400)
    assert reals.element(wide, reals.number(x)) == wide.coerce(x)


@pytest.mark.parametrize("kind", KINDS)
@given(x=st.floats(1e-3, 1e3), y=st.floats(1e-3, 1e3))
def test_operations_have_the_digits_of_the_context(kind, x, y) -> None:
    reals, wide = BareReals(300, kind), MP(100)
    exact = root(wide.coerce(x)) * y - wide.coerce(x) / y
    with reals:
        found = root(reals.number(x)) * y - reals.number(x) / y
    size = abs(wide.coerce(x)) + x * y + x / y + y
    assert abs(reals.element(wide, found) - exact) <= wide.coerce(2) ** -294 * size


@pytest.mark.parametrize("kind", KINDS)
def test_a_lower_precision_is_used_inside_at(kind) -> None:
    reals = BareReals(300, kind)
    with reals:
        third = reals.number(1) / 3
        with reals.at(80):
            rough = reals.number(1) / 3
        again = reals.number(1) / 3
    assert reals.element(MP(100), third) == reals.element(MP(100), again)
    apart = abs(reals.element(MP(100), rough) - reals.element(MP(100), third))
    assert 2**-88 < apart < 2**-79


@pytest.mark.parametrize("kind", KINDS)
@given(n=st.integers(-(10**30), 10**30), part=st.floats(-0.5, 0.4999))
def test_nearest_integers(kind, n, part) -> None:
    reals = BareReals(300, kind)
    with reals:
        assert reals.nearest(reals.number(n) + reals.number(part)) == n


def test_other_peoples_precision_is_left_alone() -> None:
    before = gmpy2.get_context().precision, flint.ctx.prec
    for kind in KINDS:
        with pytest.raises(RuntimeError), BareReals(999, kind):
            raise RuntimeError
        with BareReals(500, kind) as reals, reals, reals.at(60):
            pass
    assert (gmpy2.get_context().precision, flint.ctx.prec) == before


def test_an_unknown_kind_is_refused() -> None:
    with pytest.raises(ArgumentError, match=r"kind = 'decimal'.*'gmpy2', 'python-flint', 'mpmath'"):
        BareReals(100, "decimal")


@pytest.mark.parametrize("missing", [("gmpy2",), ("gmpy2", "flint")])
def test_what_is_not_installed_is_done_without(missing, monkeypatch) -> None:
    for name in missing:
        monkeypatch.setitem(sys.modules, name, None)
    assert BareReals(100).kind == KINDS[len(missing)]


def test_what_is_no_number_becomes_nan() -> None:
    # a translation that leads to the identity divides by 0; with mpf that is Python's ZeroDivisionError
    for kind in ("gmpy2", "python-flint"):
        reals = BareReals(100, kind)
        with reals:
            found = reals.element(K, reals.number(1) / (reals.number(0.1) - reals.number(0.1)))
        assert K.context.isnan(found)
