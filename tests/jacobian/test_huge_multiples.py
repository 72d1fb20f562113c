"""Multiples by huge numbers: by the order if it is found quickly, in parts, or refused with a reason."""

from random import Random

import pytest

from jacobian import GF, QQ, ArgumentError, HyperellipticCurve, Infeasible
from jacobian.addition.ladder import PART, by_parts
from jacobian.relatives.formal_sum import FormalSum, principal_divisor
from jacobian.relatives.glued import GeneralizedJacobian
from jacobian.relatives.ray_class import RayClassGroup

HUGE = 10**100000
FREE = HyperellipticCurve(QQ, [1, 2, 0, 0, 0, 1]).jacobian()
D = FREE((0, 1))
FIVE = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian()((0, 1))
SMALL = HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1]).jacobian()
E = SMALL((0, 1))


def test_elements_of_small_order():
    """The multiple by 10^100,000 used to take 21 s; it follows from the order of the element."""
    assert FIVE.jacobian.zero() == HUGE * FIVE
    assert (HUGE + 2) * FIVE == 2 * FIVE
    assert -(HUGE + 2) * FIVE == -2 * FIVE
    assert (HUGE + 3) % SMALL.order() * E == (HUGE + 3) * E


@pytest.mark.parametrize("bits", [PART - 1, PART, PART + 1, 2 * PART, 3 * PART + 7])
def test_scalars_are_taken_in_parts(bits):
    """This works in any group; here in the integers."""
    for m in (1 << (bits - 1), (1 << bits) - 1, Random(bits).getrandbits(bits) | 1 << (bits - 1)):
        most = []

        def multiple_of(k, a, most=most):
            most.append(k.bit_length())
            return k * a

        assert by_parts(m, 3, multiple_of, lambda a, b: a + b) == 3 * m
        assert max(most) <= PART + 1


def test_long_scalars_over_a_large_field():
    J = HyperellipticCurve(GF(2**61 - 1), [1, 1, 0, 0, 0, 1]).jacobian()
    L, k = J.random(Random(1)), Random(2).getrandbits(3 * PART)
    total, size = J.zero(), 4096
    for place in range(3 * PART - size, -1, -size):
        total = (1 << size) * total + (k >> place & ((1 << size) - 1)) * L
    assert k * L == total


CASES = {
    "at once": (lambda: 10**9 * D, "D is of infinite order"),
    "on the way": (lambda: 10**5 * D, "bits over QQ"),
    "a table": (lambda: FREE.fixed_base(D)(10**9), "bits over QQ"),
    "a combination": (lambda: FREE.combination([10**9, 10**9], [D, D]), "bits over QQ"),
    "glued": (
        lambda: 10**9 * GeneralizedJacobian(HyperellipticCurve(QQ, [1, 1, 0, 3, 1]))((0, 1), (0, -1)),
        "bits over",
    ),
    "a principal divisor": (lambda: 10**9 * principal_divisor(FREE.curve, [0, 1]), "scalar = 1000000000: "),
    "points of a sum": (lambda: FormalSum.from_points(FREE.curve, [(0, 1)] * 10**5), "points: 100000 of them"),
}


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(name, marks=pytest.mark.slow if name in ("glued", "a combination", "a table") else ())
        for name in CASES
    ],
)
def test_what_grows_without_end_is_refused(case):
    call, says = CASES[case]
    with pytest.raises(Infeasible) as caught:
        call()
    assert says in str(caught.value)


def test_ordinary_multiples_are_had():
    assert 3 * (33 * D) == 99 * D
    assert 10**6 * principal_divisor(FREE.curve, [1]) == principal_divisor(FREE.curve, [1])
    assert (500 * principal_divisor(FREE.curve, [0, 1])).numerator == (*[0] * 500, 1)
    R = RayClassGroup(FREE.curve, 5)
    assert 2 * (3 * R.lift(D)) == 6 * R.lift(D)


def test_pairings_of_a_huge_order_are_refused():
    with pytest.raises(ArgumentError, match=r"m = an int of .* bits: it is longer than the order of the group"):
        SMALL.weil_pairing(E, E, HUGE)
