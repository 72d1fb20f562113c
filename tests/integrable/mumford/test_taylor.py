"""Recorded formulas and their Taylor series, compared with the formulas, closed solutions and another integrator."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

from integrable import Check, Gyroscopic, Hat, Tilde
from integrable.deformations.carrier import widened
from integrable.motion.near import right_hand_sides
from integrable.mumford import taylor
from integrable.series.tape import (
    CONSTANT,
    DIFFERENCE,
    MULTIPLE,
    PRODUCT,
    QUOTIENT,
    ROOT,
    SUM,
    Tape,
    recorded,
)
from jacobian import MP, PrecisionLoss
from jacobian.errors import Infeasible
from tests.integrable.deformations.extrapolation import extrapolate

K = MP(40)
SYSTEMS = {
    "gyroscopic": Gyroscopic((1, 2, 4), 0.7),
    "tilde": Tilde((1, 2, 4), 0.7),
    "potential": Tilde((1, 2, 4), potential=(0.1, 0.2, 0.3, 0.4, 0.5)),
    "rolling potential": Tilde((1, 2, 4), 0.7, potential=(0.1, 0.2, 0.0, 0.4, 0.5)),
    "check": Check((1, 2, 4), potential=(0.1, 0.2, 0.3, 0.4, 0.5)),
    "hat": Hat((1, 2, 4)),
}
START = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)


def _run(tape: Tape, values):
    """Evaluates a tape node by node."""
    found = list(values)
    for kind, p, q, constant in list(zip(*tape[:4], strict=True))[len(values) :]:
        operations = {
            CONSTANT: lambda constant=constant: constant,
            SUM: lambda p=p, q=q: found[p] + found[q],
            DIFFERENCE: lambda p=p, q=q: found[p] - found[q],
            MULTIPLE: lambda p=p, q=q: found[p] * found[q],
            PRODUCT: lambda p=p, q=q: found[p] * found[q],
            QUOTIENT: lambda p=p, q=q: found[p] / found[q],
            ROOT: lambda p=p: found[p] ** 0.5,
        }
        found.append(operations[kind]())
    return [found[n] for n in tape.results]


def test_a_tape_does_what_its_formula_does() -> None:
    two, third = Fraction(2), Fraction(1, 3)

    def formula(y):
        a, b, c = y
        squared = a * b - third * (a * b) + 0 * c
        return [
            squared / (1 + c * c),
            -a + (two - b) / 5,
            c * 1 + 0,
            two * third + 0 * a,
            1 / c - (a - 0) * two,
            0 - b,
            0 / (1 + c),
        ]

    tape, rng = recorded(formula, 3), Random(3)
    # a·b is recorded once, products with one or zero not at all
    assert sum(kind == PRODUCT for kind in tape.kinds) == 2
    for _ in range(20):
        values = [Fraction(rng.randint(1, 50), rng.randint(1, 50)) for _ in range(3)]
        assert _run(tape, values) == formula(values)


def _start(name):
    """The system in 40 digits, and its variables: γ, M and for a rolling one τ."""
    system, state = widened(SYSTEMS[name], SYSTEMS[name].state(*START), MP(40))
    return system, [*state.gamma, *state.M, *([K.zero] if system.body.rolls else [])]


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_rates_of_a_deformation_are_recorded(name) -> None:
    system, y = _start(name)
    gap = zip(_run(recorded(right_hand_sides(system), len(y)), y), right_hand_sides(system)(y), strict=True)
    assert max(abs(a - b) for a, b in gap) < 1e-37


@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", SYSTEMS)
def test_compiled_and_interpreted_series_agree_with_extrapolation(name) -> None:
    (system, y), time = _start(name), K.coerce(-0.125)
    right = extrapolate(right_hand_sides(system), y, time, pieces=6)
    for digits in (20, 30):
        row, start = taylor.integrate(K, recorded(right_hand_sides(system), len(y)), y, [time, K.zero], digits)
        # double-double numbers lose a few of their digits in the potentials
        assert max(abs(a - b) for a, b in zip(row, right, strict=True)) < K.coerce(10) ** (3 - digits)
        assert start == y


@pytest.mark.parametrize("digits", [18, 35])
def test_closed_solutions_near_and_far_in_any_order(digits) -> None:
    # y = (cos t, −sin t), and z = 1/(1 + t) from a quotient
    tape = recorded(lambda y: [y[1], -y[0], -y[2] / y[3], 0 * y[0] + 1], 4)
    times = [K.coerce(t) for t in (30, -0.5, 1e-3, 30, 7)]
    rows = taylor.integrate(K, tape, [K.one, K.zero, K.one, K.one], times, digits)
    c = K.context
    for t, row in zip(times, rows, strict=True):
        right = [c.cos(t), -c.sin(t), 1 / (1 + t), 1 + t]
        assert max(abs(a - b) for a, b in zip(row, right, strict=True)) < K.coerce(10) ** (2 - digits)


@pytest.mark.parametrize("digits", [18, 35])
def test_a_pole_ends_the_motion(digits) -> None:
    tape = recorded(lambda y: [y[0] * y[0], 0 * y[0]], 2)
    half = taylor.integrate(K, tape, [K.one, K.one], [K.coerce("0.5")], digits)[0][0]
    assert abs(half - 2) < K.coerce(10) ** (2 - digits)
    with pytest.raises(PrecisionLoss, match=r"near t = (1|0\.9999\d*), before 2"):
        taylor.integrate(K, tape, [K.one, K.one], [K.coerce(2)], digits)


def test_numbers_beyond_floats_are_integrated_interpreted() -> None:
    tape = recorded(lambda y: [y[1], -y[0]], 2)
    large = K.coerce(10) ** 400
    row = taylor.integrate(K, tape, [large, K.zero], [K.one], 18)[0]
    assert abs(row[0] / large - K.context.cos(1)) < 1e-16


@pytest.mark.parametrize("digits", [18, 35])
def test_what_takes_too_many_steps_is_refused_with_what_is_within_reach(digits) -> None:
    tape = recorded(lambda y: [y[1] * y[2], -y[0] * y[2], 0 * y[0], 0 * y[0]], 4)
    with pytest.raises(
        Infeasible, match=r"times: .* t = 1e\+09 takes more than \d+ steps; about \|t\| = \S+ is within"
    ):
        taylor.integrate(K, tape, [K.one, K.zero, K.one, K.one], [K.coerce(10) ** 9], digits)
