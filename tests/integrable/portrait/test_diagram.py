"""Diagrams compared with random states; rates of divergence compared with the motion itself."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.phase.body import Body
from integrable.portrait.ovals import Level
from jacobian import GF, MP
from jacobian.errors import ArgumentError

BALL = ChaplyginBall((3, 1, 2), 0.7)


def test_states_fill_the_strip_and_nothing_else():
    rng = np.random.default_rng(3)
    diagram = BALL.diagram()
    gamma, M = rng.normal(size=(2, 40000, 3))
    gamma /= np.linalg.norm(gamma, axis=1)[:, None]
    _, c, h1, h2 = BALL._integrals_along(gamma, M)
    X, Z = c**2 / h2, h1 / h2
    assert diagram.contains(X, Z * (1 + 1e-14)).mean() > 0.9999
    for X0 in (0.1, 0.5, 0.9):
        near = abs(X - X0) < 0.05
        ends = [diagram.height(X[near], zeta) for zeta in (min(BALL.a), max(BALL.a))]
        part = (Z[near] - ends[0]) / (ends[1] - ends[0])
        assert 0 <= part.min() < 0.05
        assert 0.95 < part.max() <= 1
    assert not diagram.contains([0.5, 0.5, 1.1], [0.1, 2.0, 0.5]).any()


def test_lines_are_those_of_rotations_at_any_tilt():
    diagram = BALL.diagram()
    for axis in range(3):
        omega = np.eye(3)[axis]
        for tilt in (0.1, 0.6, 0.95):
            gamma = np.roll([tilt, np.sqrt(1 - tilt**2), 0], axis)
            M = (np.array(BALL.inertia) + BALL.d) * omega - BALL.d * (gamma @ omega) * gamma
            X, Z = diagram.place(BALL.state(gamma, M, tilted=True))
            (x0, z0), (x1, z1) = diagram.lines[axis]
            assert abs(Z - z0 - (z1 - z0) * (X - x0) / (x1 - x0)) < 1e-14


@pytest.mark.parametrize(("ball", "tilt"), [(BALL, 0.0), (BALL, 0.7), (EulerTop((1, 2, 3)), 0.5)])
def test_neighbours_of_the_unstable_rotation_part_at_its_rate(ball, tilt):
    axis = sorted(range(3), key=lambda i: ball.inertia[i])[1]
    gamma = np.roll([tilt, np.sqrt(1 - tilt**2), 0], axis)
    omega = np.eye(3)[axis]
    M = (np.array(ball.inertia) + ball.d) * omega - ball.d * (gamma @ omega) * gamma
    state = ball.state(gamma, M, tilted=True)
    rate = float(ball.diagram().divergence(ball.diagram().place(state)[0])) * np.linalg.norm(M)
    # a small deviation from the rotation, over a few e-foldings
    nudge = 1e-8 * np.array([1.0, -0.7, 0.4])
    run = ball.flow(ball.state(gamma, M + nudge - (nudge @ gamma) * gamma, tilted=True)).at(
        np.linspace(6, 9, 100) / rate
    )
    off = np.linalg.norm(np.delete(run.omega, axis, axis=1), axis=1)
    slope = np.polyfit(run.times, np.log(off), 1)[0]
    assert slope == pytest.approx(rate, rel=0.02)


@pytest.mark.parametrize(
    ("inertia", "d"),
    [
        ((1, 2, 3), 0.7),
        ((1, 2, 3), 0),
        ((1e-6, 1, 1.0000005), 1),
        ((1e-8, 1, 1.000000001), 100),
        ((1e-6, 2e-6, 2.5e-6), 1),
    ],
)
def test_rates_of_divergence_of_thin_bodies_have_all_digits(inertia, d):
    """512 nodes of a quadrature did not resolve I/(I + d) = 1e-10: the rate was 22 % too small."""
    body = Body.make(inertia, d, MP(40))
    context = body.field.context
    for X in (0.0, 0.3, 1.0):
        level = Level.at(body, body.field.coerce(X), sorted(body.a)[1])
        (a1, a2, a3), d_upright = level.a, level.d
        s2 = context.sqrt(1 - d_upright * a2)

        def quotient(angle, a=(a1, a2, a3), d=d_upright, s2=s2):
            """The difference quotient of x/√(1 − d̃x) between x and a₂."""
            x = a[0] + (a[2] - a[0]) * context.sin(angle) ** 2
            s = context.sqrt(1 - d * x)
            return (x + a[1] - d * x * a[1]) / ((x * s2 + a[1] * s) * s * s2)

        right = context.pi / 2
        value = context.quad(quotient, [0, 1, 1.5, 1.57, right - 1e-4, right - 1e-6, right])
        expected = 2 * level.momentum * s2 * context.sqrt((a2 - a1) * (a3 - a2)) * value / (context.pi * level.s)
        assert float(ChaplyginBall(inertia, d).diagram().divergence(X)) == pytest.approx(float(expected), rel=1e-14)


def test_rotation_numbers_are_those_of_motions():
    X, Z, numbers = BALL.diagram().rotation_numbers(6)
    assert X.shape == Z.shape == numbers.shape == (6, 12)
    rng = np.random.default_rng(0)
    gamma, M = rng.normal(size=(2, 3))
    state = BALL.state(gamma / np.linalg.norm(gamma), M, tilted=True)
    portrait = BALL.flow(state).portrait
    from integrable.portrait.diagram import _rotation_number
    from integrable.portrait.ovals import Level

    place = BALL.diagram().place(state)
    assert _rotation_number(Level.at(BALL.body, place[0], portrait.zeta)) == pytest.approx(portrait.rotation_number)
    assert BALL.diagram().height(place[0], portrait.zeta) == pytest.approx(place[1], rel=1e-13)


def test_the_picture_and_refusals():
    pytest.importorskip("matplotlib")
    state = BALL.state((0.48, 0.6, 0.64), (0.1, 2, 0.3), tilted=True)
    assert len(BALL.diagram().figure(state).axes[0].lines) == 4
    with pytest.raises(ArgumentError, match="not over GF"):
        ChaplyginBall((1, 2, 4), 1, field=GF(10007)).diagram()
    for call, message in (
        (lambda: BALL.diagram().divergence([0, 1.5]), r"^X = \[0, 1.5\]: numbers from 0 to 1"),
        (lambda: BALL.diagram().divergence(None), "^X = None: "),
        (lambda: BALL.diagram().contains(0, "x"), "^Z = 'x': real numbers"),
        (lambda: BALL.diagram().height(10**400, 1), "^X = an int of 1329 bits: real numbers"),
        (lambda: BALL.diagram().contains([0, 1], [1, 2, 3]), r"^X, Z: shapes that broadcast .* \(2,\) and \(3,\)"),
        (lambda: BALL.diagram().height(0, 1j), "^zeta = 1j: real numbers"),
    ):
        with pytest.raises(ArgumentError, match=message):
            call()
    assert BALL.diagram().height([0, 1], 0.3).shape == (2,)
    with pytest.raises(ArgumentError, match="at rest"):
        BALL.diagram().place(BALL.state((0, 0, 1), (0, 0, 0)))


@pytest.mark.parametrize("count", [1, 301, 2**63, 10**400], ids=["1", "301", "2^63", "10^400"])
def test_grids_have_a_bound(count):
    with pytest.raises(ArgumentError, match=r"count = .*an int from 2 to 300"):
        BALL.diagram().rotation_numbers(count)


@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan])
def test_places_that_are_no_numbers_are_refused_by_name(value):
    """inf gave NaN and a warning of NumPy's."""
    diagram = BALL.diagram()
    calls = {
        "zeta": lambda: diagram.height(0.1, value),
        "X": lambda: diagram.height([0.1, value], 0.2),
        "Z": lambda: diagram.contains(0.1, value),
    }
    for name, call in calls.items():
        with pytest.raises(ArgumentError, match=f"^{name} = .*finite"):
            call()
    with pytest.raises(ArgumentError, match=r"zeta = .*1 − d·ζ"):
        diagram.height(0.1, 1 / 0.7)
