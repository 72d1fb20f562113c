"""Poincaré sections compared with the flow."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.portrait.ovals import zeta_through
from integrable.portrait.section import tilde
from jacobian import MP
from jacobian.errors import ArgumentError, NotRepresentable

GAMMA = (0.48, 0.6, 0.64)
CASES = {
    "low": (ChaplyginBall((1, 2, 3), 0.7), (0.384, 1.28, -1.488)),
    "high": (ChaplyginBall((2, 3.1, 4.2), 9.72), (3, 2, -4)),
    "unsorted": (ChaplyginBall((3, 1, 2), 0.7), (0.1, 2, 0.3)),
    "top": (EulerTop((3, 1, 2)), (0.1, 2, 0.3)),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("axis", ["largest", "least"])
def test_all_crossings_and_no_others(name, axis):
    ball, M = CASES[name]
    flow = ball.flow(ball.state(GAMMA, M, tilted=True))
    found = flow.section(30, axis)
    assert len(found) == 30
    assert (np.diff(found.tau) > 0).all()
    gamma, _ = tilde(flow, found.run)
    assert abs(gamma[:, found.axis]).max() < 1e-13
    dense, _ = tilde(flow, flow.at_tau(np.linspace(1e-9, found.tau[-1] + 1e-6, 20000)))
    assert np.count_nonzero(np.diff(np.sign(dense[:, found.axis]))) == 30
    # the map is a rotation
    assert abs((np.diff(found.theta) - found.rotation + 0.5) % 1 - 0.5).max() < 1e-14
    if axis == "largest":
        level = flow.portrait.level
        zeta = zeta_through(level, found.phi, found.momentum)
        assert abs(zeta / float(level.zeta) - 1).max() < 1e-13


@pytest.mark.parametrize(
    ("gamma", "M", "axis"),
    [
        ((0.6, 0.8, 0), (0.4, -0.3, 0.225), "largest"),
        ((0, 0.6, 0.8), (0.3, 0.4, -0.3), "least"),
        ((0, 0, 1), (0.001, 1, 0), "least"),
    ],
)
def test_a_start_on_the_section_is_no_crossing_after_it(gamma, M, axis):
    ball = ChaplyginBall((1, 2, 3), 0.7)
    for sign in (1, -1):
        flow = ball.flow(ball.state(gamma, tuple(sign * x for x in M)))
        assert flow.section(2, axis).tau[0] > 1e-3


def test_sections_to_the_digits_of_the_field():
    ball = ChaplyginBall((1, 2, 3), "0.7", field=MP(40))
    flow = ball.flow(ball.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488")))
    found = flow.section(2)
    assert abs(found.run.gamma[:, found.axis]).max() < 1e-38


def test_beside_the_separatrix():
    """The series of an oval has 32768 terms there, which are summed for a few crossings at a time."""
    ball = ChaplyginBall((1, 2, 3), 0.7)
    flow = ball.flow(ball.state((0, 0, 1), (0.001, 1, 0)))
    assert flow.portrait.distance < 1e-5
    found = flow.section(40)
    assert abs(found.run.gamma[:, found.axis]).max() < 1e-13
    assert (np.diff(found.tau) > 0).all()


def test_refusals():
    ball = ChaplyginBall((1, 2, 3), 0.7)
    flow = ball.flow(ball.state((0.6, 0, 0.8), (0, 2, 0)))
    with pytest.raises(NotRepresentable, match=r"^section: this motion .separatrix"):
        flow.section(3)
    symmetric = ChaplyginBall((1, 1, 3), 0.7)
    with pytest.raises(NotRepresentable, match=r"^section: in this motion .symmetric"):
        symmetric.flow(symmetric.state(GAMMA, (0.384, 1.28, -1.488))).section(3)
    flow = ball.flow(ball.state(GAMMA, (0.384, 1.28, -1.488)))
    for wrong, argument in (((0,), "count"), ((10**12,), "from 1 to 1000000"), ((3, "middle"), "axis")):
        with pytest.raises(ArgumentError, match=argument):
            flow.section(*wrong)


def test_the_picture():
    pytest.importorskip("matplotlib")
    ball, M = CASES["low"]
    figure = ball.flow(ball.state(GAMMA, M)).section(20).figure()
    assert len(figure.axes[0].lines[-1].get_xdata()) == 20
