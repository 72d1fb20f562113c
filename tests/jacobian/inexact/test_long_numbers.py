"""The numbers of motions on elliptic curves have mpmath's functions, to all their digits."""

import pickle

import pytest

from jacobian import MP
from jacobian.errors import FieldError, PrecisionLoss
from jacobian.inexact.long_numbers import LongNumbers


@pytest.mark.parametrize("digits", [25, 80, 400])
def test_the_functions_are_those_of_mpmath(digits):
    K, numbers = MP(digits + 20), LongNumbers(digits)
    x, y, z = (K.coerce(v) for v in ("0.3", "1.7", "2.6"))

    def both(compute):
        with numbers:
            found = K.coerce(compute(numbers.context, *map(numbers.coerce, (x, y, z))))
        return abs(found / compute(K.context, x, y, z) - 1)

    for compute in (
        lambda f, x, y, z: f.elliprf(x, y, z),
        lambda f, x, y, z: f.elliprf(0, y, z * 1000),
        lambda f, x, y, z: f.elliprf(x * x, y, 1),
        lambda f, x, y, z: f.agm(y, z),
        lambda f, x, y, z: f.log(z, 2) + f.log10(y) + f.acos(x),
        lambda f, x, y, z: f.cospi(x) + f.sinpi(y) * f.pi,
        lambda f, x, y, z: f.ldexp(y, 7) + f.ldexp(1, -9) + f.nint(z) + f.sqrt(y) + f.cos(x) * f.sin(z),
    ):
        assert both(compute) < K.coerce(10) ** (2 - digits)


def test_they_are_numbers_of_other_fields_and_travel():
    numbers = pickle.loads(pickle.dumps(LongNumbers(40)))
    assert numbers == LongNumbers(40)
    assert numbers.bits == MP(40).context.prec
    with numbers:
        third, zero = numbers.one / 3, -numbers.zero
        infinite, nothing = numbers.one / zero, zero / zero
    assert abs(3 * MP(40).coerce(third) - 1) < 1e-40
    assert MP(40).coerce(zero) == 0
    assert repr(MP(40).coerce(zero)) == "mpf('0.0')"
    for x in (infinite, nothing):
        with pytest.raises(FieldError, match="not finite"):
            MP(40).coerce(x)


@pytest.mark.parametrize("given", [(-1e-30, 1, 2), (0, 0, 1)], ids=str)
def test_an_integral_without_a_value_is_refused(given):
    with LongNumbers(30) as numbers, pytest.raises(PrecisionLoss, match="elliptic integral"):
        numbers.context.elliprf(*given)
