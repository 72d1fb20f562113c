"""The ball and the top among the systems of any genus: their flow has the methods of every other."""

from __future__ import annotations

import pytest

from integrable import ChaplyginBall
from integrable.mumford.flow import MumfordFlow
from integrable.systems.on_layer import BodyOnLayer
from jacobian.errors import ArgumentError

STATE = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)


@pytest.mark.parametrize("d", [0, 0.7])
def test_the_flow_of_a_body_has_what_every_flow_of_the_layer_has(d) -> None:
    system = BodyOnLayer((1, 2, 3), d)
    state = system.state(*STATE)
    flow = system.flow(state)
    names = {name for name in dir(MumfordFlow) if not name.startswith("_")} | {"digits", "start", "system"}
    assert names <= set(dir(flow))
    assert flow.start == state
    assert flow.system is system


def test_enclosures_and_the_time_of_the_flow() -> None:
    """Balls at values of τ contain the states at the corresponding times; τ is compared with the body's own run."""
    flow = BodyOnLayer((1, 2, 3), 0.7).flow(BodyOnLayer((1, 2, 3), 0.7).state(*STATE))
    ball = ChaplyginBall((1, 2, 3), 0.7)
    run = ball.flow(ball.state(*STATE)).at_tau([1.25])
    found = flow.enclosure_at_tau([1.25])
    for balls, row in ((found.q[0], run.gamma[0]), (found.p[0], run.M[0])):
        assert all(abs(float(x.mid()) - y) < 1e-14 for x, y in zip(balls, row, strict=True))
    assert abs(float(flow.tau_near(run.times[0], 30)) - 1.25) < 1e-14


@pytest.mark.parametrize("digits", [None, "x", 0, 10**400, [1]])
def test_digits_of_the_time_of_the_flow_are_counted(digits) -> None:
    flow = BodyOnLayer((1, 2, 3), 0.7).flow(BodyOnLayer((1, 2, 3), 0.7).state(*STATE))
    if digits is None:
        assert abs(float(flow.tau_near(0, digits))) == 0
    else:
        with pytest.raises(ArgumentError, match="digits = "):
            flow.tau_near(1, digits)
