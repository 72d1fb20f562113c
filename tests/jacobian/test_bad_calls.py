"""Wrong arguments of the public calls: the error names the argument, its value and what is accepted."""

import numpy as np
import pytest

from jacobian import (
    CC,
    GF,
    MP,
    QQ,
    RR,
    ArgumentError,
    CurveMismatch,
    FieldError,
    HyperellipticCurve,
    NotRepresentable,
    PrecisionLoss,
)
from jacobian.batch import DivisorArray
from jacobian.group import Jacobian
from jacobian.periods.abel import AbelMap
from jacobian.periods.matrix import periods
from jacobian.relatives.conic import representative
from jacobian.relatives.glued import GeneralizedJacobian
from jacobian.relatives.pseudo_group import PseudoGroup
from jacobian.relatives.ray_class import RayClassGroup
from tests.messages import Raising, assert_says

J = HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1]).jacobian()
D = J.from_points([(0, 1)])
REAL = HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1])
INEXACT = HyperellipticCurve(RR, [1, 0.5, 0, 0, 0, 1]).jacobian()
PLANE = HyperellipticCurve(GF(101), [1, 2, 0, 3, 1])
FIBRE = RayClassGroup(J.curve, 2).fibre
POINTS = PseudoGroup(J.curve)
SQUARE = np.ones((2, 2))

NONE = Raising()
ELSEWHERE = HyperellipticCurve(GF(7), [1, 1, 0, 0, 0, 0, 1]).jacobian().zero()
CASES = {
    "points that raise": (lambda: J.from_points(NONE), ArgumentError, "points = <raising>: ", "(x, y)"),
    "a point that raises": (lambda: J.curve.involution(NONE), ArgumentError, "point = <raising>: ", "(x, y)"),
    "coefficients that raise": (lambda: J.from_mumford(NONE, ()), ArgumentError, "u = <raising>: ", "numbers"),
    "divisors that raise": (lambda: J.combination([1], NONE), ArgumentError, "divisors = <raising>: ", "Divisors"),
    "primes that raise": (lambda: J.structure(NONE), ArgumentError, "primes = <raising>: ", "prime factors"),
    "an image that raises": (lambda: AbelMap(REAL).inverse(NONE), ArgumentError, "z = <raising>: ", "2 numbers"),
    "rows that raise": (lambda: DivisorArray.stack(NONE), ArgumentError, "parts = <raising>: ", "a sequence"),
    "a scalar that raises": (lambda: D * NONE, ArgumentError, "scalar = <raising>: ", "an int"),
    "a multiplicity that raises": (
        lambda: J.from_points([(0, 1)], multiplicities=[NONE]),
        ArgumentError,
        "multiplicities: multiplicities[0] = <raising>: ",
        "an int",
    ),
    "a matrix for a scalar": (lambda: D * SQUARE, ArgumentError, "scalar = array([[1., 1.], [1., 1.]]): ", "an int"),
    "a matrix of scalars": (lambda: DivisorArray.stack([D, D]) * SQUARE, ArgumentError, "scalar = array(", "flat"),
    "lists of scalars": (
        lambda: DivisorArray.stack([D, D]) * [[1, 2], [3]],
        ArgumentError,
        "scalar[0] = [1, 2]: ",
        "an int",
    ),
    "all as an array": (lambda: J.curve.lift_x(0, all=np.arange(3)), ArgumentError, "all = array(", "True or False"),
    "complex as an array": (lambda: MP(20, complex=np.arange(3)), ArgumentError, "complex = array(", "True or False"),
    "complex as a number": (lambda: MP(20, complex=1), ArgumentError, "complex = 1: ", "True or False"),
    "a bound in an array": (lambda: next(J.curve.points(SQUARE)), ArgumentError, "bound = array(", "an int ≥ 1"),
    "no generator": (lambda: INEXACT.random(3), ArgumentError, "rng = 3: ", "random.Random"),
    "a group as a generator": (lambda: INEXACT.random(J), ArgumentError, "rng = Jacobian", "random.Random"),
    "a class as a generator": (lambda: J.random(np.random.Generator), ArgumentError, "rng = <class", "random.Random"),
    "support of no divisor": (lambda: J.support([1]), ArgumentError, "D = [1]: ", "a Divisor"),
    "support of a class elsewhere": (lambda: J.support(ELSEWHERE), CurveMismatch, "D = ", "does not lie"),
    "an extension in a list": (lambda: D.support(extension=[1]), FieldError, "extension = [1]: ", "a finite field"),
    "a group as extension": (lambda: D.support(extension=J), FieldError, "extension = Jacobian", "a finite field"),
    "points in no extension": (
        lambda: GeneralizedJacobian(PLANE).from_points([(0, 1)], multiplicities=[2], extension=1j),
        NotRepresentable,
        "extension = 1j: ",
        "over the field itself",
    ),
    "height of no class": (lambda: FIBRE.height(3), ArgumentError, "c = 3: ", "a pair"),
    "inverse of three numbers": (lambda: FIBRE.inverse((1, 2, 3)), ArgumentError, "c = (1, 2, 3): ", "a pair"),
    "power of a pair of pairs": (lambda: FIBRE.power([(0, 1), (0, 1)], 5), FieldError, "a = (0, 1) ", "an int"),
    "inverse of no unit": (lambda: FIBRE.inverse((0, 0)), ArgumentError, "(a, b) = (0, 0): ", "a unit"),
    "translation by no class": (
        lambda: representative(J.from_points([(0, 1), (0, 1)]), J.curve.lift_x(5)).translate(2, 1j),
        ArgumentError,
        "unit = 1j: ",
        "a pair",
    ),
    "an index that raises": (lambda: DivisorArray.stack([D])[NONE], ArgumentError, "index = <raising>: ", "an int"),
    "indices of two lengths": (
        lambda: DivisorArray.stack([D])[[[1, 2], [3]]],
        ArgumentError,
        "index = [[1, 2], [3]]: ",
        "a flat array",
    ),
    "stack in an array": (lambda: DivisorArray.stack([D], J=SQUARE), ArgumentError, "J = array(", "a Jacobian"),
    "rows beyond a memory": (lambda: DivisorArray.zeros(J, 10**400), ArgumentError, "count = an int of", "at most"),
    "a sum along no axis": (lambda: DivisorArray.stack([D]).sum(SQUARE), ArgumentError, "axis = array(", "axis 0"),
    "coefficients of a long element": (
        lambda: GF(7, 2).coerce([1, 2, SQUARE]),
        FieldError,
        "value = [1, 2, array([[1., 1.], [1., 1.]])] ",
        "2 coefficients",
    ),
    "the number of a matrix": (lambda: CC.coerce(SQUARE), FieldError, "value = array([[1., 1.], [1., 1.]]) ", "number"),
    "a multiple beyond the digits": (
        lambda: 2**50 * INEXACT.random(np.random.default_rng(1)),
        PrecisionLoss,
        "scalar = 1125899906842624: ",
        "more digits",
    ),
    "no sequence of points": (lambda: J.from_points(3), ArgumentError, "points = 3: ", "(x, y)"),
    "no sequence of multiplicities": (
        lambda: J.from_points([(0, 1)], multiplicities=2),
        ArgumentError,
        "multiplicities = 2: ",
        "one for each point",
    ),
    "bytes as scalars": (lambda: b"ab" * DivisorArray.stack([D, D]), ArgumentError, "scalar = b'ab'", "an int"),
    "masked scalars": (
        lambda: DivisorArray.stack([D, D]) * np.ma.array([1, 2], mask=[0, 1]),
        ArgumentError,
        "scalar[1] = masked",
        "an int",
    ),
    "bytes as scalars of points": (
        lambda: POINTS.multiple(b"ab", [POINTS.zero] * 2),
        ArgumentError,
        "m = b'ab'",
        "int",
    ),
    "a half of a point": (lambda: POINTS.multiple(0.5, POINTS.zero), ArgumentError, "m = 0.5", "an int"),
    "scalars beside one point": (lambda: POINTS.multiple([1], POINTS.zero), ArgumentError, "m = [1]", "an int"),
    "too few scalars of points": (
        lambda: POINTS.multiple([1, 2.5], [POINTS.zero] * 2),
        ArgumentError,
        "m[1] = 2.5",
        "an int",
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
