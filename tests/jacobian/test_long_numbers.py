"""Numbers of more than 4300 digits, which Python's ``str`` refuses to write: in texts of values and in messages."""

from fractions import Fraction

import pytest

from jacobian import GF, MP, QQ, AffinePoint, HyperellipticCurve, Infeasible, JacobianError
from jacobian.batch import DivisorArray
from jacobian.errors import shown, written
from jacobian.relatives.formal_sum import FormalSum, principal_divisor
from jacobian.relatives.ray_class import RayClassGroup

LONG = 10**5000
C = HyperellipticCurve(QQ, [1, 2, 0, 0, 0, 1])
J = C.jacobian()
D = J((0, 1))
F = HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1])
G = F.jacobian()
E = G((0, 1))


@pytest.mark.parametrize("exponent", [199, 200, 201, 300, 4300, 15000])
@pytest.mark.parametrize("offset", [-1, 0, 1])
def test_both_ends_and_the_number_of_digits(exponent, offset):
    n = 10**exponent + offset
    digits = "9" * exponent if offset < 0 else f"1{offset:0{exponent}d}"
    text = digits if len(digits) <= 200 else f"{digits[:8]}…{digits[-8:]}[{len(digits)} digits]"
    assert written(n) == text
    assert written(Fraction(1, -n)) == f"-1/{text}"


def test_what_is_short_is_written_as_ever():
    assert written(Fraction(-1, 3)) == "-1/3"
    assert written(True) == "True"
    assert written(0.1) == "0.1"
    assert written(MP(20).coerce("0.5")) == "0.5"


def test_what_a_message_shows_of_long_numbers():
    assert shown(LONG) == "an int of 16610 bits"
    assert shown([1, LONG]) == "[1, an int of 16610 bits]"
    assert shown(Fraction(1, LONG)) == "1/10000000…00000000[5001 digits]"
    circle = [LONG]
    circle.append(circle)
    assert len(shown(circle)) < 300


def test_a_multiple_over_the_rationals_shows_itself():
    m = 170 * D
    assert repr(m).startswith("(x^2 + (40170603…81994448[3321 digits]/91804571…34178009[3321 digits])·x + 1646")
    assert r"\tfrac{40170603\ldots 81994448_{[3321\,\mathrm{digits}]}}{9180" in m._latex_()
    assert "3321 digits" in m._repr_html_()
    assert "3321 digits" in repr(2 * FormalSum.from_divisor(m))
    assert str(C.lift_x(0)) == "AffinePoint(x=Fraction(0, 1), y=Fraction(1, 1))"
    assert repr(AffinePoint(Fraction(LONG), 1)) == "AffinePoint(x=10000000…00000000[5001 digits], y=1)"


def test_texts_for_other_systems_have_all_digits():
    curve = HyperellipticCurve(QQ, [1, 0, Fraction(1, LONG), 0, 0, 1])
    for text in (curve.to_pari(), curve.to_sage()):
        assert "1/1" + "0" * 5000 in text


CASES = {
    "support": (lambda: (170 * D).support(), "3321 digits"),
    "from_mumford": (lambda: J.from_mumford((LONG, 1), (1,)), "x + 10000000…00000000"),
    "not monic": (lambda: J.from_mumford((1, LONG), ()), "leading coefficient 10000000…00000000"),
    "n": (lambda: J.from_mumford((0, 1), (1,), n=LONG), "n = an int of"),
    "weight": (
        lambda: HyperellipticCurve(GF(7), [1, 1, 0, 0, 0, 0, 1]).jacobian().from_mumford((1,), (), n=LONG),
        "n = an int of",
    ),
    "order of base": (lambda: J.log(170 * D, D, order=1), "order = 1: "),
    "order": (lambda: G.log(E, E, order=LONG + 1), "order = an int of"),
    "empty interval": (lambda: G.log(E, E, interval=(LONG, 0)), "interval = (an int of"),
    "long interval": (lambda: G.log(E, E, interval=(0, LONG)), "an int of"),
    "lift_x": (lambda: C.lift_x(10**4400), "x = 10000000…00000000[4401 digits]"),
    "point": (lambda: C.point(LONG, 1), "point = (10000000…00000000[5001 digits], 1)"),
    "curve": (lambda: HyperellipticCurve(QQ, [0, 0, LONG, 0, 0, 1]), "10000000…00000000[5001 digits]·x^2"),
    "tate_pairing": (lambda: G.tate_pairing(E, E, LONG), "m = an int of"),
    "weil_pairing": (lambda: G.weil_pairing(E, E, -LONG), "m = an int of"),
    "multiple": (lambda: G.order_of(E, multiple=LONG + 1), "multiple = an int of"),
    "torsion": (lambda: G.torsion(-LONG), "m = an int of"),
    "is_divisible": (lambda: G.is_divisible(E, -LONG), "m = an int of"),
    "frobenius": (lambda: G.frobenius(E, -LONG), "power = an int of"),
    "degree of a field": (lambda: GF(7, LONG), "k = an int of"),
    "index": (lambda: DivisorArray.stack([E])[[LONG]], "index = array([an int of"),
    "primes": (lambda: G.structure([LONG]), "primes = [an int of"),
    "a root": (lambda: QQ.sqrt(QQ.coerce(2 * LONG)), "20000000…00000000[5001 digits]"),
    "a twist": (lambda: C.quadratic_twist(LONG), "d = 10000000…00000000[5001 digits]"),
    "a modulus": (lambda: RayClassGroup(C, LONG)((LONG, 1), (0, 1)), "10000000…00000000"),
    "a principal divisor": (lambda: LONG * principal_divisor(C, [0, 1]), "scalar = an int of"),
    "scalar": (lambda: LONG * FormalSum.from_divisor(2 * E), "scalar = an int of"),
}


@pytest.mark.parametrize("case", CASES)
def test_messages_hold_long_numbers(case):
    call, contains = CASES[case]
    with pytest.raises(JacobianError) as caught:
        call()
    assert contains in str(caught.value)
    assert len(str(caught.value)) < 1000


def test_an_index_beyond_an_array():
    with pytest.raises(IndexError, match="index = an int of 16610 bits: the array has 1 rows"):
        DivisorArray.stack([E])[LONG]


def test_log_names_itself_where_an_option_is_misspelt():
    with pytest.raises(TypeError, match=r"\blog\(\) got an unexpected keyword argument 'intervall'"):
        G.log(E, E, intervall=(1, 3))
    assert G.log(E, 3 * E, interval=(1, 3)) == 3
    with pytest.raises(Infeasible):
        G.log(E, E, interval=(0, 2**50))
