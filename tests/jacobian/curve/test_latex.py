"""Values as LaTeX."""

import pytest

from jacobian import CC, GF, MP, QQ, RR, HyperellipticCurve
from jacobian.curve import latex

QUINTIC = [1, 0, 0, 0, 0, 1]


@pytest.mark.parametrize(
    ("K", "written"),
    [
        (GF(101), r"\mathbf{F}_{101}"),
        (GF(2, 8), r"\mathbf{F}_{2^{8}}"),
        (QQ, r"\mathbf{Q}"),
        (RR, r"\mathbf{R}"),
        (CC, r"\mathbf{C}"),
        (MP(30), r"\mathbf{R}"),
        (MP(30, complex=True), r"\mathbf{C}"),
    ],
)
def test_fields(K, written):
    assert latex.field(K) == written


def test_polynomials():
    assert latex.polynomial(GF(7), ()) == "0"
    assert latex.polynomial(GF(7), (3, 1, *[0] * 8, 5)) == "5 x^{10} + x + 3"
    half = QQ.coerce("-1/2")
    assert latex.polynomial(QQ, (half, half, QQ.one)) == r"x^{2} + (-\tfrac{1}{2}) x - \tfrac{1}{2}"
    assert latex.polynomial(RR, (1e-07, 2.5e20)) == r"(2.5 \cdot 10^{20}) x + 1 \cdot 10^{-7}"
    assert latex.polynomial(CC, (1 + 2j,)) == "(1+2i)"


def test_curves_groups_and_divisors():
    C = HyperellipticCurve(GF(7), [1, 1, 0, 0, 0, 0, 1], [1, 2])
    assert C._latex_() == r"y^{2} + \left(2 x + 1\right) y = x^{6} + x + 1 \text{ over } \mathbf{F}_{7}"
    C = HyperellipticCurve(GF(101), QUINTIC)
    J = C.jacobian()
    assert J._latex_() == rf"\mathrm{{Jac}}\left({C._latex_()}\right)"
    assert J.from_points([(0, 1)])._latex_() == r"\left(x, 1\right)"
    assert J._repr_latex_() == f"${J._latex_()}$"
    assert C._repr_latex_() == f"${C._latex_()}$"
    split = HyperellipticCurve(GF(7), [1, 1, 0, 0, 0, 0, 1]).jacobian()
    assert split.zero()._repr_latex_() == r"$\left(1, 0, n = 1\right)$"


@pytest.mark.parametrize(
    ("h", "plain", "written"),
    [
        ([1], "y^2 + y", "y^{2} + y"),
        ([0, 0, 1], "y^2 + x^2·y", "y^{2} + x^{2} y"),
        ([0, -3], "y^2 - 3·x·y", "y^{2} - 3 x y"),
        (["1/2"], "y^2 + (1/2)·y", r"y^{2} + \tfrac{1}{2} y"),
        ([-1, 0, 1], "y^2 + (x^2 - 1)·y", r"y^{2} + \left(x^{2} - 1\right) y"),
    ],
)
def test_the_term_of_y(h, plain, written):
    C = HyperellipticCurve(QQ, QUINTIC, h)
    assert repr(C) == f"{plain} = x^5 + 1 over QQ"
    assert C._latex_().startswith(f"{written} = x^{{5}} + 1")


def test_zeta_functions():
    zeta = HyperellipticCurve(GF(7), [1, 2, 0, 0, 0, 1]).zeta_function()
    assert zeta._repr_latex_() == r"$\frac{49 T^{4} + 14 T^{3} + 2 T + 1}{(1 - T)(1 - 7 T)}$"
