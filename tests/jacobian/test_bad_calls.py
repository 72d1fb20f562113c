"""Wrong arguments of the public calls: the error names the argument, its value and what would be right."""

import pytest

from jacobian import GF, QQ, RR, ArgumentError, CurveMismatch, FieldError, HyperellipticCurve
from jacobian.abel import AbelMap
from jacobian.batch import DivisorArray
from jacobian.conic import representative
from jacobian.generalized import GeneralizedJacobian
from jacobian.group import Jacobian
from jacobian.periods import periods
from jacobian.ray_class import RayClassGroup
from tests.messages import assert_says

J = HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1]).jacobian()
D = J.from_points([(0, 1)])
REAL = HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1])
ELSEWHERE = HyperellipticCurve(GF(7), [1, 1, 0, 0, 0, 0, 1]).jacobian().zero()
CASES = {
    "no sequence of points": (lambda: J.from_points(3), ArgumentError, "points = 3: ", "(x, y)"),
    "no sequence of multiplicities": (
        lambda: J.from_points([(0, 1)], multiplicities=2),
        ArgumentError,
        "multiplicities = 2: ",
        "one for each point",
    ),
    "no divisor to take logarithms of": (lambda: J.log(D, 5), ArgumentError, "target = 5: ", "a Divisor"),
    "no base": (lambda: J.log("D", D), ArgumentError, "base = 'D': ", "a Divisor"),
    "logarithm of a class elsewhere": (lambda: J.log(ELSEWHERE, ELSEWHERE), CurveMismatch, "base = ", "does not lie"),
    "no divisor for a table": (lambda: J.fixed_base(5), ArgumentError, "D = 5: ", "a Divisor"),
    "no divisor for Frobenius": (lambda: J.frobenius(3), ArgumentError, "D = 3: ", "a Divisor"),
    "no divisor with an order": (lambda: J.order_of((0, 1)), ArgumentError, "D = (0, 1): ", "a Divisor"),
    "no divisor to divide": (lambda: J.is_divisible(2, 3), ArgumentError, "D = 2: ", "a Divisor"),
    "no divisor to pair": (lambda: J.weil_pairing(D, None, 5), ArgumentError, "E = None: ", "a Divisor"),
    "no divisor to pair first": (lambda: J.tate_pairing(0, D, 5), ArgumentError, "D = 0: ", "a Divisor"),
    "torsion of a half": (lambda: J.torsion(2.5), ArgumentError, "m = 2.5: ", "an int"),
    "torsion of a string": (lambda: J.torsion("2"), ArgumentError, "m = '2': ", "an int"),
    "divisible by a half": (lambda: J.is_divisible(D, 0.5), ArgumentError, "m = 0.5: ", "an int"),
    "pairing of a half": (lambda: J.weil_pairing(D, D, 2.5), ArgumentError, "m = 2.5: ", "an int"),
    "half a power of Frobenius": (lambda: J.frobenius(D, 0.5), ArgumentError, "power = 0.5: ", "an int"),
    "no order": (lambda: J.log(D, D, order=1.5), ArgumentError, "order = 1.5: ", "an int"),
    "no multiple": (lambda: J.order_of(D, multiple="x"), ArgumentError, "multiple = 'x': ", "an int"),
    "one scalar": (lambda: J.combination(1, [D]), ArgumentError, "scalars = 1: ", "ints"),
    "one divisor": (lambda: J.combination([1], D), ArgumentError, "divisors = (x, 1): ", "Divisors"),
    "half a scalar": (lambda: J.combination([1, 1.5], [D, D]), ArgumentError, "scalars[1] = 1.5: ", "an int"),
    "an extension that is none": (lambda: D.support(extension=5), FieldError, "extension = 5: ", "a finite field"),
    "an infinite extension": (lambda: D.support(extension=QQ), FieldError, "extension = QQ: ", "a finite field"),
    "stack of one": (lambda: DivisorArray.stack(D), ArgumentError, "parts = (x, 1): ", "[D]"),
    "arrays of no Jacobian": (lambda: DivisorArray.from_arrays(3, [], []), ArgumentError, "J = 3: ", "a Jacobian"),
    "zeros of no Jacobian": (lambda: DivisorArray.zeros("J", 3), ArgumentError, "J = 'J': ", "a Jacobian"),
    "stack in no Jacobian": (lambda: DivisorArray.stack([], 7), ArgumentError, "J = 7: ", "a Jacobian"),
    "ray classes of no curve": (lambda: RayClassGroup(3), ArgumentError, "curve = 3: ", "a HyperellipticCurve"),
    "periods of no curve": (lambda: periods(3), ArgumentError, "curve = 3: ", "a HyperellipticCurve"),
    "Abel map of no curve": (lambda: AbelMap([1, 2]), ArgumentError, "curve = [1, 2]: ", "a HyperellipticCurve"),
    "pairs of no curve": (lambda: GeneralizedJacobian("C"), ArgumentError, "curve = 'C': ", "a HyperellipticCurve"),
    "Jacobian of no curve": (lambda: Jacobian(None), ArgumentError, "curve = None: ", "a HyperellipticCurve"),
    "one prime": (lambda: J.structure(primes=5), ArgumentError, "primes = 5: ", "prime factors"),
    "a prime in letters": (lambda: J.structure(primes=["x"]), ArgumentError, "primes = ['x']: ", "prime factors"),
    "rows beyond the array": (
        lambda: DivisorArray.stack([D, D])[[0, 7]],
        IndexError,
        "index[1] = 7: ",
        "the array has 2 rows",
    ),
    "roots in letters": (lambda: periods(REAL, "abcde"), ArgumentError, "roots = 'abcde': ", "5 numbers"),
    "one root": (lambda: periods(REAL, 5), ArgumentError, "roots = 5: ", "5 numbers"),
    "a root in letters": (lambda: periods(REAL, [1, 2, 3, 4, "x"]), FieldError, "roots[4] = 'x' ", "a number"),
    "no image": (lambda: AbelMap(REAL).inverse(3), ArgumentError, "z = 3: ", "2 numbers"),
    "an image in letters": (lambda: AbelMap(REAL).inverse("ab"), ArgumentError, "z = 'ab': ", "2 numbers"),
    "pencil of no class": (lambda: representative(3, (0, 1)), ArgumentError, "D = 3: ", "a Divisor"),
    "a field that is none": (lambda: HyperellipticCurve(101, [1, 1, 0, 1]), ArgumentError, "K = 101 ", "give GF(p)"),
    "a coefficient that is no number": (
        lambda: HyperellipticCurve(RR, [1, float("nan"), 0, 1]),
        FieldError,
        "f[1] = nan ",
        "finite",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_message_says_what_and_why(case):
    assert_says(*CASES[case])
