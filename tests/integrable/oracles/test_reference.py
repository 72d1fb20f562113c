"""The oracles compared with the shipped trajectories, with each other and with closed forms."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

from integrable.oracles.reference import dop853, equations, right_hand_side, taylor
from integrable.phase.state import State
from jacobian import MP
from jacobian.errors import ArgumentError

SCENES = json.loads((Path(__file__).parents[2] / "data" / "trajectories.json").read_text(encoding="utf-8"))["scenes"]


def problem(name):
    content = SCENES[name]
    return SimpleNamespace(inertia=content["I"], d=content["d"]), SimpleNamespace(
        gamma=content["gamma0"], M=content["M0"]
    )


def largest(array, rows):
    return max(
        abs(x - mpmath.mpf(y)) for row, other in zip(array, rows, strict=True) for x, y in zip(row, other, strict=True)
    )


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["S1", "S2", "S6"])
def test_taylor_meets_the_shipped_trajectories(name):
    states = SCENES[name]["states"]
    solution = taylor(*problem(name), ["10", "1"], digits=34)
    with mpmath.workdps(50):
        assert largest(solution.gamma, [states[T]["gamma"] for T in ("10", "1")]) < 1e-33
        assert largest(solution.M, [states[T]["M"] for T in ("10", "1")]) < 1e-33


@pytest.mark.parametrize("time", ["1", pytest.param("10", marks=pytest.mark.slow)])
def test_taylor_meets_the_thin_ball(time):
    solution = taylor(*problem("S4a"), [time], digits=36)
    with mpmath.workdps(50):
        assert largest(solution.gamma, [SCENES["S4a"]["states"][time]["gamma"]]) < 1e-33


@pytest.mark.parametrize("digits", [10, 25, pytest.param(60, marks=pytest.mark.slow)])
def test_taylor_keeps_what_it_promises_at_any_number_of_digits(digits):
    body, start = problem("S1")
    some, more = (taylor(body, start, ["2.5"], digits=n) for n in (digits, digits + 20))
    with mpmath.workdps(digits + 30):
        assert largest(some.gamma, more.gamma) < mpmath.mpf(10) ** -digits
        assert largest(some.M, more.M) < mpmath.mpf(10) ** -digits


def test_taylor_takes_times_in_any_order_back_and_forth():
    body, start = problem("S1")
    mixed = taylor(body, start, ["1", "-1", "0", "0.25", "1"], digits=20)
    assert [float(x) for x in mixed.gamma[2]] == [0.48, 0.6, 0.64]
    assert list(mixed.gamma[0]) == list(mixed.gamma[4])
    there = SimpleNamespace(gamma=list(mixed.gamma[1]), M=list(mixed.M[1]))
    back = taylor(body, there, ["1"], digits=20)
    with mpmath.workdps(30):
        assert largest(back.gamma, [start.gamma]) < 1e-19
        assert largest(back.M, [start.M]) < 1e-19


def test_taylor_stands_still_where_nothing_moves():
    still = SimpleNamespace(gamma=["1", "0", "0"], M=["0", "0", "0"])
    solution = taylor(problem("S1")[0], still, ["1000"], digits=15)
    assert [float(x) for x in (*solution.gamma[0], *solution.M[0])] == [1, 0, 0, 0, 0, 0]


def test_taylor_leaves_the_global_precision_alone():
    before = mpmath.mp.dps
    taylor(*problem("S2"), ["0.1"], digits=before + 30)
    assert mpmath.mp.dps == before


def test_taylor_refuses_no_digits():
    with pytest.raises(ArgumentError, match="digits: 0 given"):
        taylor(*problem("S1"), ["1"], digits=0)


@pytest.mark.parametrize(("name", "bound"), [("S1", 1e-11), ("S2", 1e-11), ("S6", 1e-11)])
def test_dop853_meets_the_shipped_trajectories(name, bound):
    states = SCENES[name]["states"]
    solution = dop853(*problem(name), [100, 1, 10], rtol=3e-14, atol=3e-14)
    wanted = np.array([states[T]["gamma"] for T in ("100", "1", "10")], dtype=float)
    assert np.abs(solution.gamma - wanted).max() < bound
    assert solution.evaluations > 100


def test_dop853_follows_its_tolerance():
    body, start = problem("S1")
    wanted = np.array(SCENES["S1"]["states"]["10"]["gamma"], dtype=float)
    errors = [
        np.abs(dop853(body, start, [10], rtol=tol, atol=tol).gamma[0] - wanted).max() for tol in (1e-4, 1e-7, 1e-10)
    ]
    assert errors[0] > 10 * errors[1] > 100 * errors[2]


def test_dop853_takes_times_back_and_forth():
    body, start = problem("S6")
    times = [1.0, -2.0, 0.0, 1.0]
    solution = dop853(body, start, times, rtol=1e-13, atol=1e-13)
    exact = taylor(body, start, times, digits=20)
    assert np.abs(solution.M - exact.M.astype(float)).max() < 1e-11
    assert solution.gamma[2].tolist() == [0.48, 0.6, 0.64]
    assert solution.gamma[0].tolist() == solution.gamma[3].tolist()


def test_right_hand_side_is_the_equation_of_motion():
    rng = np.random.default_rng(1)
    inertia, d = np.array([1.0, 2.5, 3.0]), 0.6
    gamma, M = rng.normal(size=(2, 3))
    gamma /= np.linalg.norm(gamma)
    omega = np.linalg.solve(
        np.diag(inertia + d) - d * np.outer(gamma, gamma), M
    )  # M = Iω + dω − d(γ,ω)γ, a formula without g
    wanted = np.concatenate([np.cross(gamma, omega), np.cross(M, omega)])
    got = right_hand_side(inertia, d)(0.0, np.concatenate([gamma, M]))
    assert np.allclose(got, wanted, rtol=0, atol=1e-14)
    assert np.allclose(
        right_hand_side(inertia, 0.0)(0.0, np.concatenate([gamma, M]))[3:], np.cross(M, M / inertia), atol=1e-14
    )


class Spring:
    """q̈ = −√2 q: a root of a constant is a coefficient of the equations."""

    def __init__(self, field):
        self.field, self.stiffness = field, field.coerce(2)

    def rates_in(self, numbers, y):
        q, p = y
        return [p, -numbers.sqrt(numbers.coerce(self.stiffness)) * q]


def test_roots_of_constants_have_all_digits():
    K = MP(40)
    rates = equations(Spring(K), State((K.one,), (K.zero,)))([K.one, K.zero])
    assert rates == [0, -K.sqrt(K.coerce(2))]
