"""The bare reals from which a torus is made, compared with those of the readable problem."""

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.moving_point.setup import Setup
from jacobian import MP
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


@pytest.mark.parametrize("name", ROWS)
def test_it_is_the_readable_problem(name) -> None:
    system, gamma, M = ROWS[name]
    state = system.state(gamma, M, tilted="tilted" in name)
    setup = Setup(system.body, state.gamma, state.M, state.tilted)
    problem, bare, K = setup.problem, setup.bare_problem, setup.wide
    assert (problem.matrix is None) == (bare.matrix is None)
    for field in ("f", "axes", "start", "matrix", "ratio", "d", "time_scale", "momentum", "half_step", "branch_points"):
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
        # U and V of close branch points vanish like powers of what these differ by
        spare = 10**4 * (10**27 if name in ("heavy", "nearly equal") and field == "start" else 1)
        assert all(abs(x - y) <= spare * K.eps * (abs(x) + 1e-6 * size) for x, y in zip(*rows, strict=True)), field


def test_motions_without_a_curve_are_refused() -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    with pytest.raises(ArgumentError, match="the body is at rest"):
        _ = Setup(ball.body, START[0], (0.0, 0.0, 0.0)).bare_problem
    for scale in (2, -4):
        with pytest.raises(NotRepresentable, match="M is parallel to gamma"):
            _ = Setup(ball.body, START[0], tuple(scale * x for x in START[0]), tilted=True).time_scale
