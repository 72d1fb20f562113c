"""The problem of a motion, compared with the formulas of :mod:`integrable.phase`."""

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.moving_point.problem import Problem
from integrable.moving_point.setup import Setup
from integrable.moving_point.translations import REACH
from integrable.phase.body import Body
from integrable.phase.coordinates import kappas, to_mumford, to_pairs
from integrable.phase.state import State, onto_constraints
from jacobian import MP, poly
from jacobian.errors import ArgumentError, NotRepresentable

START = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
TILTED = START[0], (1.104, 2.18, -0.528)
ROWS = {
    "ball": (ChaplyginBall((1, 2, 3), 0.7), *START),
    "top": (EulerTop((1, 2, 3)), *START),
    "thin": (ChaplyginBall((1e-8, 1, 1.5), 1), *START),
    "heavy": (ChaplyginBall((1, 2, 3), 1e8), *START),
    "far apart": (ChaplyginBall((1, 1e4, 1e8), 1), *START),
    "nearly equal": (ChaplyginBall((1, 1 + 1e-12, 2), 0.7), *START),
    "tilted": (ChaplyginBall((1, 2, 3), 0.7), *TILTED),
    "tilted top": (EulerTop((1, 2, 3)), *TILTED),
    "tilted in digits": (
        ChaplyginBall((1, 2, 3), "0.7", field=MP(30)),
        ("0.48", "0.6", "0.64"),
        ("1.1", "2.2", "-0.5"),
    ),
}


def readable(setup, state) -> Problem:
    """The problem in numbers of the wide field."""
    K, tilt = setup.wide, setup.tilt
    body = Body.make(setup.body.inertia, setup.body.d, K)
    state = onto_constraints(body, state)
    matrix, alpha, beta = None, K.one, K.zero
    if tilt is not None:
        matrix, alpha, beta = tilt.inverse_matrix(), tilt.s, body.d * tilt.k * tilt.s * tilt.s / tilt.p
        body = tilt.upright
        state = onto_constraints(body, State(*tilt.apply_vectors(state.gamma, state.M)))
    h1, h2 = body.integrals(state.gamma, state.M)[2:]
    top, spin = max(body.a), K.sqrt(h2)
    alphas, ratio, d = [a / top for a in body.a], h1 / (h2 * top), body.d * top
    f = poly.mul(K, poly.mul(K, (-ratio, K.one), poly.scale(K, -K.one, poly.from_roots(K, alphas))), (K.one, -d))
    pairs = to_pairs(body, state)
    (u0, u1, _), (v0, v1) = to_mumford(body, pairs)
    twice = 2 * spin
    divisor = u0 / top**2, u1 / top, v0 / (twice * top**2), v1 / (twice * top)
    start = (*divisor, *(x for x, _ in pairs), *(y / twice for _, y in pairs))
    half_step = 2 * REACH * min(*alphas, ratio) / K.sqrt(-f[0])
    slowness = alpha * K.sqrt(body.contact[0] * body.contact[1] * body.contact[2])
    axes = (*alphas, *(kappa / top**2 for kappa in kappas(body)), alpha, beta * top * spin)
    f = (*f, *[K.zero] * (6 - len(f)))
    return Problem(f, axes, start, ratio, d, 2 * top * spin, spin, half_step, matrix, slowness)


@pytest.mark.parametrize("name", ROWS)
def test_it_is_the_readable_problem(name) -> None:
    system, gamma, M = ROWS[name]
    state = system.state(gamma, M, tilted="tilted" in name)
    setup = Setup(system.body, state.gamma, state.M, state.tilted)
    problem, bare, K = readable(setup, state), setup.bare, setup.wide
    assert (problem.matrix is None) == (bare.matrix is None)
    for field in (*Problem._fields, "branch_points"):
        true = getattr(problem, field)
        with setup.reals:
            found = getattr(bare, field)
        if true is None:
            continue
        rows = (
            (true, setup.reals.elements(K, found))
            if isinstance(true, tuple)
            else ([true], [setup.reals.element(K, found)])
        )
        size = max(map(abs, rows[0]))
        # at close branch points U and V vanish like powers of the distance of the two
        spare = 10**4 * (10**27 if name in ("heavy", "nearly equal") and field == "start" else 1)
        assert all(abs(x - y) <= spare * K.eps * (abs(x) + 1e-6 * size) for x, y in zip(*rows, strict=True)), field
    assert setup.problem == bare.over(lambda x: setup.reals.element(K, x))
    # 1/g of the upright motion at the start, times its constant factor
    u0, u1, *_ = problem.start
    square = K.dot(problem.start[4:7], problem.start[4:7])
    light = 1 + problem.d * (u1 + problem.d * u0)
    assert abs(problem.axes[6] * K.sqrt(light / square) - problem.slowness) < 1e-20 * problem.slowness


def test_motions_without_a_curve_are_refused() -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    with pytest.raises(ArgumentError, match="the body is at rest"):
        _ = Setup(ball.body, START[0], (0.0, 0.0, 0.0)).bare
    for scale in (2, -4):
        with pytest.raises(NotRepresentable, match="M is parallel to gamma"):
            _ = Setup(ball.body, START[0], tuple(scale * x for x in START[0]), tilted=True).time_scale
