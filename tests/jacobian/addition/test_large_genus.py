"""NUCOMP, the quadratic-time addition of large genus, equals Cantor's step-by-step one."""

from itertools import product
from random import Random

import pytest

from jacobian import GF, QQ
from jacobian.addition import cantor, nucomp
from jacobian.addition.choice import NUCOMP_GENUS, python_kernel
from jacobian.fields.factor import roots
from tests.jacobian.group_curves import inside, next_curve, outside, triple
from tests.jacobian.jacobian_rows import FIELDS, ROWS, moved

GENERA = (5, 6, 7, 8, 10, 13, 20, 30)
MODELS = ("ramified", "split", "inert")


def classes(C, rng):
    """Sums of points of every weight, with points in common, opposite ones, multiple ones and branch points."""
    J, g, K = C.jacobian(), C.genus, C.field
    step = 2 if C.model == "inert" else 1
    points = [C.random_point(rng) for _ in range(g)]
    others = [C.random_point(rng) for _ in range(g)]
    half = g // 2 - (g // 2) % step
    full = g - g % step
    chosen = [
        points[:full],
        others[:full],
        points[:half] + others[half:full],
        [C.involution(P) for P in points[:half]] + others[half:full],
        [points[0]] * full,
        points[:step],
        [],
    ]
    locus = C.h if K.characteristic == 2 else C.discriminant
    branch = [C.lift_x(x) for x in roots(K, locus)] if len(locus) > 1 else []
    if branch:
        chosen.append((branch + points)[:full])
    result = [triple(J.from_points(P)) for P in chosen]
    if C.model == "split":
        plus, minus = C.points_at_infinity()
        result += [triple(J(plus, minus)), triple(J.from_points([plus, *points[: g - 1]]))]
    return result


def assert_equal(C, triples):
    for a in triples:
        assert nucomp.double(C, a) == cantor.double(C, a)
    for a, b in product(triples, repeat=2):
        assert nucomp.sum_of(C, a, b) == cantor.sum_of(C, a, b), (a, b)


@pytest.mark.thinned(7)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("genus", GENERA)
@pytest.mark.parametrize("field", ["GF(7)", "GF(2^61-1)"])
@pytest.mark.parametrize("with_h", [False, True])
def test_large_genus(field, genus, model, with_h):
    if model == "inert" and genus % 2:
        genus += 1
    rng = Random(f"{field} {genus} {model} {with_h}")
    C = next_curve(FIELDS[field], genus, rng, model=model, with_h=with_h)
    triples = classes(C, rng)
    assert_equal(C, triples[:5] if genus > 10 else triples)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("genus", [6, 12])
@pytest.mark.parametrize("field", ["GF(2^8)", "GF(3^5)"])
def test_extension_fields(field, genus, model):
    rng = Random(f"{field} {genus} {model}")
    triples = classes(C := next_curve(FIELDS[field], genus, rng, model=model, with_h=True), rng)
    assert_equal(C, triples[:5])


@pytest.mark.slow
@pytest.mark.parametrize("field", ["GF(7)", "GF(101)", "GF(2^8)", "GF(3^5)"])
@pytest.mark.parametrize("model", MODELS)
def test_every_genus_up_to_thirty(field, model):
    for genus in range(5, 31):
        if model == "inert" and genus % 2:
            continue
        rng = Random(f"every {field} {genus} {model}")
        C = next_curve(FIELDS[field], genus, rng, model=model, with_h=True)
        assert_equal(C, classes(C, rng)[:4])


@pytest.mark.thinned(4)
@pytest.mark.parametrize(
    "row", [pytest.param(row, id=str(row)) for row in ROWS if row.genus <= 4 and row.model != "moved"]
)
def test_small_genus_too(row):
    """NUCOMP is also correct below the genus from which it is used."""
    assert_equal(row.curve, [triple(D) for D in row.pool[: 5 if row.K == QQ else None]])


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("p", "genus"), [(5, 1), (5, 2), (3, 3)])
def test_every_pair_of_a_small_group(p, genus, model):
    genus += genus % 2 if model == "inert" else 0
    C = next_curve(GF(p) if genus < 4 else GF(2), genus, Random(f"{p} {genus} {model}"), model=model, with_h=True)
    assert_equal(C, [triple(D) for D in C.jacobian().points()])


def test_the_group_takes_nucomp_from_the_measured_genus():
    rng = Random(1)
    for model, first in NUCOMP_GENUS.items():
        for genus in (first - 2, first):
            C = next_curve(GF(101), genus, rng, model=model) if model != "inert" or genus % 2 == 0 else None
            if C is not None:
                add, double, _ = python_kernel(C)
                expected = nucomp if genus >= first else cantor
                assert (add.func, double.func) == (expected.sum_of, expected.double)


def test_moved_models_of_large_genus():
    rng = Random(2)
    C = moved(next_curve(GF(101), 9, rng, model="ramified", with_h=True), 17)
    J = C.jacobian()
    A, B = (J.from_points([C.random_point(rng) for _ in range(9)]) for _ in range(2))
    through_cantor = outside(J, cantor.sum_of(J.curve.arithmetic_model, inside(A), inside(B)))
    assert through_cantor == A + B
    assert 12 * A - 5 * A == 7 * A
