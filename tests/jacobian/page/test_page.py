"""The page of a curve: the LMFDB's curves, curves of other genera, the command, and refusals."""

from __future__ import annotations

import json
from math import prod

import pytest

from jacobian import GF, QQ, ArgumentError, FieldError, HyperellipticCurve
from jacobian.__main__ import main
from jacobian.models.invariants import igusa_invariants
from jacobian.page.lines import discriminant
from jacobian.page.record import NOT_KNOWN, PROVEN
from jacobian.relatives.heights import regulator
from tests.jacobian.test_published_curves import EVERY_DAY, MISSED, ROWS, curve, most_are_slow

# endomorphisms of the geometric Jacobian by the LMFDB, for curves whose source does not state them
MORE = {
    "QQ × QQ": "294.a.294.1 336.a.172032.1 360.a.6480.1 363.a.11979.1 450.a.2700.1 450.a.36450.1 504.a.27216.1 "
    "600.a.18000.1 600.b.30000.1 720.a.6480.1 1300.a.130000.1 8281.a.8281.1",
    "M_2(QQ)": "169.a.169.1 196.a.21952.1 256.a.512.1 324.a.648.1 400.a.409600.1 676.b.17576.1 784.c.614656.1 "
    "16384.a.32768.1 102400.b.102400.1 123201.c.369603.1",
    "QQ(√5)": "529.a.529.1",
    "quaternion algebra of discriminant 6": "20736.l.373248.1",
    "M_2(QQ(√-2))": "40000.e.200000.1",
}


@pytest.mark.thinned(3)
@pytest.mark.parametrize("label", most_are_slow(ROWS))
def test_the_whole_page_of_a_published_curve(label):
    row, C = ROWS[label], curve(ROWS[label])
    page = C.summary(bound=2**11)
    assert not [line for line in page if line.mark == NOT_KNOWN]
    assert abs(int(page["discriminant"].value)) == int(label.split(".")[2])
    assert page["Igusa–Clebsch invariants"].value == [str(c) for c in row["igusa_clebsch"]]
    torsion = page["torsion"]
    if "torsion" in row and label != MISSED:
        assert torsion.value["invariants"] == row["torsion"]
    if "classes" in row:
        # the published points generate, and the points found give all of it
        classes = [C.jacobian().from_mumford(*given) for given in row["classes"]]
        assert page["rank"].value == len(classes)
        if classes:
            assert (
                abs(float(page["regulator of these"].text.strip("[").split()[0]) / float(regulator(classes)) - 1)
                < 1e-12
            )
    if "leading" in row and torsion.mark == PROVEN:
        # Ш and the Tamagawa numbers are 1
        quotient = float(page["real period · regulator / torsion²"].text.strip("[").split()[0])
        assert abs(quotient / float(row["leading"]) - 1) < 1e-12
    assert_endomorphisms(label, page)
    assert str(page).count("\n") + 1 == len(page.lines)
    assert json.loads(page.to_json())["lines"][-1]["name"] == "Sato–Tate group"


def assert_endomorphisms(label, page):
    name = page["endomorphisms over ℂ"].value["name"]
    special = [algebra for algebra, labels in MORE.items() if label in labels.split()]
    if special:
        assert name == special[0]
    elif ROWS[label]["source"] == "real multiplication":
        assert name in ("QQ(√2)", "QQ(√5)")
    else:
        assert name == "QQ"
    proven = page["endomorphisms over QQ"].mark == page["Sato–Tate group"].mark == PROVEN
    assert proven == (name == "QQ")
    assert (page["Sato–Tate group"].text == "USp(4)") == (name == "QQ")


def test_most_days_have_a_curve_of_each_kind():
    assert set(EVERY_DAY) <= set(ROWS)
    assert sum(label in labels for labels in MORE.values() for label in EVERY_DAY) >= 3


@pytest.mark.parametrize(
    ("f", "names"),
    [
        ([0, -1, 0, 1], ("torsion", "real period", "endomorphisms over ℂ", "Sato–Tate group")),
        pytest.param(
            [1, 0, 0, 0, 0, 0, 0, 1],
            ("torsion", "real period", "L-polynomials", "endomorphisms over ℂ"),
            marks=pytest.mark.slow,
        ),
        pytest.param(
            [1, -1, 0, 0, 0, 0, 0, 0, 0, 1],
            ("torsion", "real period", "automorphisms over QQ"),
            marks=pytest.mark.slow,
        ),
    ],
)
def test_other_genera(f, names):
    page = HyperellipticCurve(QQ, f).summary(bound=2**10, height=10)
    assert all(page[name].mark != NOT_KNOWN for name in names), str(page)


def test_the_discriminant_of_any_genus():
    """2¹²·J10 in genus 2; −16(4a³ + 27b²) in genus 1; it is that of the curve without h."""
    for f, h in (([1, 0, 0, 0, 0, 1], []), ([3, 1, 4, 1, 5, 2], [1, 2]), ([-1, 2, 0, 0, 1, 0, -3], [1, 2, 0, 1])):
        C = HyperellipticCurve(QQ, f, h)
        assert discriminant(C) == igusa_invariants(C)[4]
    assert discriminant(HyperellipticCurve(QQ, [5, 2, 0, 1])) == -16 * (4 * 2**3 + 27 * 5**2)
    assert discriminant(HyperellipticCurve(QQ, [0, -1, 0, 1], [1])) == 37
    # x⁷ − x has two pairs of complex roots
    assert discriminant(HyperellipticCurve(QQ, [0, -1, 0, 0, 0, 0, 0, 1])) == 2**12 * 6**6


def test_a_line_that_is_refused_says_why():
    """An inert model of odd genus has no classes to compute with."""
    page = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 0, 0, 1, 2]).summary(bound=100, height=10)
    assert page["torsion"].mark == NOT_KNOWN
    assert "inert of odd genus" in page["torsion"].text
    assert page["L-polynomials"].mark == PROVEN


def test_the_command(capsys):
    assert main(["page", "[x^5+x^4, x^3+x+1]", "--bound", "2^11", "--json"]) == 0
    found = {line["name"]: line for line in json.loads(capsys.readouterr().out)["lines"]}
    assert found["torsion"]["value"]["invariants"] == [19]
    assert main(["page", "x^5-x+1", "--height", "10", "--bound", "2^11"]) == 0
    assert "rank                                at least 2  [proven]" in capsys.readouterr().out
    assert main(["page", "x^5-x+1", "--height", "0"]) == 2
    assert "height = 0" in capsys.readouterr().err


def test_a_page_in_a_notebook_and_its_names():
    page = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).summary(bound=2**10, height=10)
    html = page._repr_html_()
    assert "ℤ/10" in html
    assert "proven" in html
    with pytest.raises(ArgumentError, match="torsion"):
        page["torsions"]


def test_curves_and_limits_that_have_no_page():
    C = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1])
    with pytest.raises(FieldError, match="QQ"):
        HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1]).summary()
    for limits in ({"bound": 10}, {"height": 0}, {"height": 10**6}, {"digits": 2}, {"digits": 20.0}):
        with pytest.raises(ArgumentError, match=next(iter(limits))):
            C.summary(**limits)
    assert prod(C.summary(bound=2**10, height=10)["torsion"].value["invariants"]) == 10
