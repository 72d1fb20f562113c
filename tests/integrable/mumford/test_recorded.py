"""Recorded formulas between states and pairs agree with the formulas themselves; roots in long numbers."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.classical.two_gaps import TwoGaps
from integrable.classical.veselova import Veselova
from integrable.mumford.branch_points import long_roots
from integrable.mumford.columns import Column, Columns
from integrable.mumford.flow import Point
from integrable.mumford.motion import Start
from integrable.mumford.phase_torus import PhaseTorus, in_pairs
from integrable.mumford.recorded import PairFormulas, parts_of
from integrable.systems.on_layer import BodyOnLayer
from integrable.torus.theta_series import long_numbers
from jacobian import poly
from jacobian.errors import PrecisionLoss
from jacobian.numbers.compiler import interpreted

STATES = {
    "Neumann": (Neumann((1, 2, 4)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "Neumann on S³": (Neumann((1, 2, 4, 7)), (0.5, 0.5, 0.5, 0.5), (0.3, -0.4, 0.2, -0.1)),
    "ellipsoid": (Ellipsoid((1, 2, 4)), (1, 0, 0), (0, 0.6, 0.8)),
    "ellipsoid in four dimensions": (Ellipsoid((1, 2, 4, 7)), (0, 0, 0, 7**0.5), (0.6, 0.8, 0.1, 0)),
    "Garnier": (Garnier((0, 1), 2, -0.5), (0.3, 0.5), (0.2, -0.4)),
    "Hénon and Heiles with a barrier": (HenonHeiles((2.625,), -0.5, -0.25, 0, (0.25,)), (0.1, 0.35), (0.0, 0.1)),
    "Hénon and Heiles": (HenonHeiles.with_frequencies(1, 1.25), (0.05, 0.03), (0, 0.01)),
    "Toda": (TodaLattice(3), (0, 0.5, -0.25), (1, -0.75, -0.25)),
    "Toda, four particles": (TodaLattice(4), (0, 0.5, -0.25, 1), (1, -0.75, -0.25, 0.5)),
    "two gaps": (TwoGaps((0, -5, 0)), (-4, 28), (0.5, 0.25)),
    "ball": (BodyOnLayer((1, 2, 3), 0.7), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "Veselova": (Veselova((4, 2, 1)), (0.48, -0.6, 0.64), (0.384, 1.28, 0.912)),
}


def numbers_in(parts):
    return [x for part in parts for x in (numbers_in(part) if isinstance(part, tuple | list) else [part])]


@pytest.mark.parametrize("name", STATES)
def test_recorded_starts_are_those_of_the_formulas(name) -> None:
    system, q, p = STATES[name]
    state = system.state(q, p)
    with long_numbers(200) as N:
        inner = system._constrained(N, system._inside(N, state))
        start = system._start(N, inner)
        numbers = *state.q, *state.p, *system.constants, *system.parameters
        vectors, found = system._formulas.start(N, numbers)
        assert [type(kind) for kind in found.kinds] == [type(kind) for kind in start.kinds]
        for some, true in zip(
            numbers_in([*vectors, *parts_of(found)]), numbers_in([*inner, *parts_of(start)]), strict=True
        ):
            assert abs(some - true) <= 1e-55 * (1 + abs(true))


@pytest.mark.skipif(interpreted(), reason="recorded formulas of many pairs are compiled")
@pytest.mark.parametrize("name", STATES)
def test_states_of_many_pairs_are_those_of_the_formulas(name) -> None:
    """There are more pairs than are read at once, and all differ."""
    system, q, p = STATES[name]
    state = system.state(q, p)
    flow = system.by_additions(state) if name == "ball" else system.flow(state)
    times = np.linspace(-2, 3, 300)
    torus, N = flow._made_torus(), Columns()
    if isinstance(torus, PhaseTorus):
        with long_numbers(160) as L:
            lifted = flow._pairs_on(L, flow._separated(L))
        pairs = lifted.at(N, in_pairs(torus.points(times)))
    else:
        pairs = torus.at(times)
    true = system._back(N, Point(*(tuple(map(N.coerce, part)) for part in flow._recorded[0])), pairs, Column(times))
    found = system._formulas.states(flow._recorded[2], pairs, times)
    for k, part in enumerate(true):
        for i, column in enumerate(part):
            assert np.abs(found[:, k, i] - column.hi).max() < 1e-15 * np.abs(found[:, k]).max()


def test_an_exponential_of_a_pair_is_not_recorded() -> None:
    """The compiled loop has none: it multiplied instead, without a word."""

    def formulas(of_the_pair):
        def start(N, y):
            return ((N.context.exp(y[0]),), (y[1],)), Start((N.one,) * 4, (y[0], N.one), (y[1],), (N.one,))

        def back(N, y, D, time):
            return (N.context.exp(D.u[0] if of_the_pair else y[0]) + D.v[0],), (N.context.log(D.u[0]),)

        return PairFormulas(start, back, 2)

    formulas(of_the_pair=False)
    with pytest.raises(TypeError, match="exponential"):
        formulas(of_the_pair=True)


def test_roots_of_a_real_polynomial_are_all_found_and_told_from_complex_ones() -> None:
    generator = np.random.default_rng(5)
    with long_numbers(160) as N:
        for n in range(200):
            roots = generator.normal(size=2 + n % 5) * 10.0 ** generator.uniform(-8, 8)
            if n % 3 == 0:
                roots[1] = roots[0] * (1 + 10.0 ** -generator.uniform(1, 4))
            own = sorted(map(N.coerce, roots.tolist()))
            f = poly.scale(N, N.coerce(-3), poly.from_roots(N, own))
            size = max(map(abs, own))
            assert max(abs(x - y) for x, y in zip(long_roots(N, f, own[:1]), own, strict=True)) < 1e-28 * size
            if n % 3 == 1:
                # a pair of complex roots a ± bi, from far apart to nearly real
                a, b = own[0], size * N.coerce(10.0 ** -generator.uniform(0, 5))
                f = poly.mul(N, poly.from_roots(N, own[1:]), (a * a + b * b, -2 * a, N.one))
                found = long_roots(N, f, [])
                assert sum(x.imag != 0 for x in found) == 2
                assert max(min(abs(x - y) for y in found) for x in own[1:]) < 1e-28 * size
        with pytest.raises(PrecisionLoss, match=r"coincide|not told apart"):
            long_roots(N, poly.from_roots(N, [N.one, N.one + N.coerce(1e-12), N.coerce(3)]), [])
