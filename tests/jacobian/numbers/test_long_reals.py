"""Bare reals and balls compared with mpmath; afterwards the precision is as before."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import flint
import gmpy2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jacobian import MP
from jacobian.numbers.long_reals import BallReals, BareReals
from jacobian.numbers.roots import root

K = MP(60)
KINDS = (BareReals, BallReals)
NUMBERS = st.one_of(
    st.integers(-(10**80), 10**80),
    st.floats(allow_nan=False, allow_infinity=False),
    st.tuples(st.integers(-(2**190), 2**190), st.integers(-300, 300)).map(lambda p: K.context.ldexp(p[0], p[1])),
)


@pytest.mark.parametrize("kind", KINDS)
@given(x=NUMBERS)
def test_numbers_come_back_as_they_were(kind, x) -> None:
    reals, wide = kind(1200), MP(400)
    assert reals.element(wide, reals.number(x)) == wide.coerce(x)


@pytest.mark.parametrize("kind", KINDS)
@given(x=st.floats(1e-3, 1e3), y=st.floats(1e-3, 1e3))
def test_operations_have_the_digits_of_the_context(kind, x, y) -> None:
    reals, wide = kind(300), MP(100)
    exact = root(wide.coerce(x)) * y - wide.coerce(x) / y
    with reals:
        found = root(reals.number(x)) * y - reals.number(x) / y
    size = abs(wide.coerce(x)) + x * y + x / y + y
    assert abs(reals.element(wide, found) - exact) <= wide.coerce(2) ** -294 * size


@pytest.mark.parametrize("kind", KINDS)
def test_a_lower_precision_is_used_inside_at(kind) -> None:
    reals = kind(300)
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
    reals = kind(300)
    with reals:
        assert reals.nearest(reals.number(n) + reals.number(part)) == n


def test_other_peoples_precision_is_left_alone() -> None:
    before = gmpy2.get_context().precision, flint.ctx.prec
    for kind in KINDS:
        with pytest.raises(RuntimeError), kind(999):
            raise RuntimeError
        with kind(500) as reals, reals, reals.at(60):
            pass
    assert (gmpy2.get_context().precision, flint.ctx.prec) == before


@pytest.mark.parametrize("kind", KINDS)
def test_two_threads_have_a_precision_each(kind) -> None:
    """Each is inside its own ``with`` while the other opens and closes: neither sees the other's precision."""
    failures = []

    def thirds(bits: int) -> None:
        reals, wide = kind(bits), MP(400)
        for _ in range(200):
            with reals:
                found = reals.number(1) / 3
            error = abs(3 * reals.element(wide, found) - 1)
            if not error < wide.coerce(2) ** (2 - bits):
                failures.append((bits, error))

    with ThreadPoolExecutor(2) as pool:
        list(pool.map(thirds, (80, 1000)))
    assert not failures


def test_what_is_no_number_becomes_nan() -> None:
    # a translation that leads to the identity divides by 0
    for kind in KINDS:
        reals = kind(100)
        with reals:
            found = reals.element(K, reals.number(1) / (reals.number(0.1) - reals.number(0.1)))
        assert K.context.isnan(found)
