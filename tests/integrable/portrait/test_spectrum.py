"""The lines of a motion add up to it."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from jacobian import MP
from jacobian.errors import NotRepresentable

GAMMA = (0.48, 0.6, 0.64)
MOTIONS = {
    "upright": (ChaplyginBall((1, 2, 3), 0.7), (0.384, 1.28, -1.488)),
    "tilted": (ChaplyginBall((1, 2, 3), 0.7), (0.4, 1.2, 0.3)),
    "top": (EulerTop((3.5, 1, 2)), (0.4, 1.2, 0.3)),
    "heavy": (ChaplyginBall((3, 1, 2), 9.7), (1.4, -1.2, 1.3)),
}


def flow_of(name):
    system, M = MOTIONS[name]
    return system.flow(system.state(GAMMA, M, tilted=True))


@cache
def spectrum_of(name):
    return flow_of(name).spectrum()


@pytest.mark.parametrize("name", MOTIONS)
def test_the_lines_add_up_to_the_motion(name):
    flow = flow_of(name)
    found = spectrum_of(name)
    times = np.array([0, -3.7, 25.0, 1234.5])
    run = flow.at(times)
    waves = np.exp(2j * np.pi * times[:, None] * found.frequencies)
    for quantity in ("gamma", "M", "omega"):
        wanted = getattr(run, quantity)
        assert abs((waves @ getattr(found, quantity)).real - wanted).max() < 3e-13 * (1 + abs(wanted).max())
    f1, f2 = flow.portrait.frequencies
    assert np.allclose(found.frequencies, found.modes @ [f1, f2] / 2, rtol=0, atol=1e-13)
    assert (found.frequencies > 0).sum() == len(found) - 1


def test_what_lines_a_quantity_has():
    """For an upright ball, along the axis that M circles, the lines of γ have odd m₁ and even m₂, those of M even ones
    (signs after a period).
    """
    found, axis = spectrum_of("upright"), flow_of("upright").portrait.axis
    for values, parity in ((found.gamma[:, axis], (1, 0)), (found.M[:, axis], (0, 0)), (found.omega[:, axis], (0, 0))):
        strong = abs(values) > 1e-12 * abs(values).max()
        assert (found.modes[strong] % 2 == parity).all()
        assert strong.sum() > 10


def test_a_steady_precession_has_few_lines():
    """In a rotation almost about the axis of the largest moment, M rests in the body and γ turns: one line each."""
    ball = EulerTop((1, 2, 3))
    found = ball.flow(ball.state((1, 0, 0), (0, 1e-4, 1))).spectrum()
    strong = abs(found.gamma).max(axis=1) > 1e-3
    assert strong.sum() == 1
    assert found.frequencies[strong][0] == pytest.approx(1 / 3 / (2 * np.pi), rel=1e-6)


def test_a_picture():
    pytest.importorskip("matplotlib")
    figure = spectrum_of("tilted").figure()
    assert [ax.get_ylabel() for ax in figure.axes] == [f"amplitude of {x}" for x in "γMω"]
    assert all(len(ax.texts) == 6 for ax in figure.axes)


@pytest.mark.parametrize(
    ("flow", "message"),
    [
        (lambda: ChaplyginBall((1, 2, 2), 0.7).flow, "symmetric"),
        (lambda: ChaplyginBall((1, 2, 3), 0.7, field=MP(20)).flow, "computed in floats"),
    ],
)
def test_what_has_no_lines_says_so(flow, message):
    flow = flow()
    state = flow.__self__.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
    with pytest.raises(NotRepresentable, match=f"spectrum: .*{message}"):
        flow(state).spectrum()
