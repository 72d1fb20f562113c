"""The costs of a torus that "auto" assumes, and the accuracy of the clock of short runs."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall
from integrable.motion.short import FREE, ROLLING, THIN, panels_within, torus_cost
from tests.integrable.ways import short_runs


def test_the_costs_of_a_torus_follow_from_its_clock() -> None:
    """For d = 0 there is no clock; if moments differ much relative to d, 1/g has many modes; a change of d by tenths
    does not matter.
    """
    bodies = ((1.0, 3.0, 0.0), (1.0, 3.0, 0.7), (1e-4, 1.5, 1.0), (0.1, 0.3, 1e3))
    assert [torus_cost(*body) for body in bodies] == [FREE, ROLLING, THIN, ROLLING]


def test_a_torus_that_is_cheap_leaves_fewer_panels_and_many_times_more() -> None:
    one = [panels_within(cost, 1) for cost in (FREE, ROLLING, THIN)]
    assert 0 < one[0] < one[1] < one[2]
    assert one[1] < panels_within(ROLLING, 100)


@pytest.mark.parametrize(("inertia", "d", "T"), [((1e-4, 1.0, 1.5), 1.0, 100.0), ((1.0, 2.0, 3.0), 0.7, 300.0)])
def test_the_clock_of_many_panels_has_no_rate_that_rounding_gives_it(inertia, d, T) -> None:
    """Rounding changes all σ at a node by a common factor, for thin balls by hundreds of roundings: γ was off by 10⁻¹³
    here.
    """
    ball = ChaplyginBall(inertia, d)
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    times = np.linspace(0.9, 1, 20) * T
    found = short_runs(ball, state).at(times)
    assert found is not None
    assert abs(found[0][:, :3] - ball.flow(state, kernel="compiled").at(times).gamma).max() < 5e-15
