"""Translations by short times: the expansion in time compared with Newton's iteration, and as a group."""

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.moving_point import addition
from integrable.moving_point.legendre import LegendreSeries, legendre_transform
from integrable.moving_point.setup import Setup
from integrable.moving_point.translations import FEW, Expansion, Translations, expand_orders
from jacobian.numbers.long_reals import BareReals
from jacobian.numbers.roots import root
from tests.integrable.moving_point.expansion_by_lists import expansion
from tests.integrable.torus.translations import centre, series_of

BODIES = {
    "ball": ChaplyginBall((1, 2, 3), 0.7),
    "top": EulerTop((3, 1, 2)),
    "thin": ChaplyginBall((1e-8, 1, 1.5), 1),
    "heavy": ChaplyginBall((1, 2, 3), 1e8),
    "far apart": ChaplyginBall((1, 1e4, 1e8), 1),
    "moments nearly equal": ChaplyginBall((1, 1 + 1e-9, 2), 0.7),
}


def setup_of(ball, digits):
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    return Setup(ball.body, state.gamma, state.M, digits=digits)


@pytest.mark.parametrize("digits", [20, 150])
@pytest.mark.parametrize("ball", BODIES.values(), ids=BODIES.keys())
def test_the_expansion_in_time_solves_the_integrals_in_x(ball, digits) -> None:
    setup = setup_of(ball, digits)
    few, many = (Translations(setup.reals, setup.bare.f, setup.bare.axes, setup.bare.half_step) for _ in range(2))
    many._asked = FEW
    with setup.reals as reals:
        series, f0 = series_of(few.f, -1, reals.bits // 4), few.f[0]
        for part in ("0.9", "-0.4", "1e-7", "1e-90"):
            eps = setup.bare.half_step * reals.number(setup.wide.coerce(part))
            # so small that Newton's series are short
            small = eps / 16
            r = f0 * small * small / 4
            m, r = centre(series, f0, small, -series[1] * r / 3, r, 12)
            for translations in (few, many):
                u0, u1 = translations.near(small)[:2]
                assert abs(u0 - m * m + r) <= 1e3 * 2.0**-reals.bits * abs(u0)
                assert abs(u1 + 2 * m) <= 1e3 * 2.0**-reals.bits * abs(u1)
            one, other = few.near(eps), many.near(eps)
            bound = reals.number(setup.wide.coerce(10) ** -(digits + 15))
            assert max(abs(x - y) / max(1, abs(y)) for x, y in zip(one, other, strict=True)) < bound * abs(one[3])


@pytest.mark.parametrize("ball", BODIES.values(), ids=BODIES.keys())
def test_translations_add_up(ball) -> None:
    setup = setup_of(ball, 30)
    translations, reals = setup.translations, setup.reals
    with reals:
        half = setup.bare.half_step
        for a, b in ((0.75, 0.5), (3, -1.25), (-0.375, -9)):
            total = translations.sum(translations.near(half * a), translations.near(half * b))
            found = translations.near(half * (a + b))
            for x, y in zip(total, found, strict=True):
                assert abs(x - y) < 1e-30 * max(1, abs(y))


@pytest.mark.parametrize("name", ["ball", "top", "moments nearly equal", "thin"])
def test_the_rate_is_read_off_the_height_above_infinity(name) -> None:
    """Two digits of 1 − dα cost three digits: a thin ball shows why that formula is not used."""
    setup = setup_of(BODIES[name], 40)
    bare, reals = setup.bare, setup.reals
    with reals:
        d = reals.number(setup.problem.d)
        steps = [setup.translations.near(bare.half_step * x) for x in (0.75, -0.5, 1e-9, 3)]
        roots = [root(1 + d * (step[1] + d * step[0])) for step in steps]
        for n in range(8):
            point = setup.reached(1, n)
            found = addition.upright_rates(bare.f, bare.axes, d, point, steps, roots)
            for x, step in zip(found, steps, strict=True):
                assert abs(x / addition.rate_after(bare.f, bare.axes, point, step) - 1) < (
                    1e-30 if d > 0.5 and name == "thin" else 1e-55
                )


@pytest.mark.parametrize("count", [1, 2, 7, 12])
def test_the_coefficients_of_a_legendre_series_are_those_of_the_matrix(count) -> None:
    reals = BareReals(120)
    series, (nodes, rows) = LegendreSeries(reals, count), legendre_transform(reals, count)
    assert series.nodes == nodes
    with reals:
        values = [1 / (2 - x) for x in nodes]
        expected = [sum(c * v for c, v in zip(row, values, strict=True)) for row in rows]
        assert max(abs(x - y) for x, y in zip(series.coefficients(values), expected, strict=True)) < 1e-33


@pytest.mark.parametrize("ball", BODIES.values(), ids=BODIES.keys())
def test_the_expansion_of_compiled_loops_is_the_readable_one(ball) -> None:
    """In one call, and in two: the last orders after the others."""
    setup, count = setup_of(ball, 50), 14
    with setup.reals as reals:
        expected = expansion(setup.bare.f, count)
        for begin in (0, 1, 2, 8, count):
            rows = Expansion(*([reals.number(0)] * count for _ in Expansion._fields))
            expand_orders(setup.bare.f, rows, 0, begin)
            expand_orders(setup.bare.f, rows, begin, count)
            for found, row in zip(rows, expected, strict=False):
                assert all(abs(x - y) <= 1e-50 * abs(y) for x, y in zip(found, row, strict=True))
