"""The display of values in notebooks: well-formed HTML with the values in it."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop, RigidBody, RollingBall, ensemble, laboratory_ensemble
from integrable.laboratory.fit import OrientationFit
from integrable.portrait.sensitivity import Sensitivity
from integrable.sweeps.sweep import Swept
from jacobian import GF, MP, QQ, HyperellipticCurve
from jacobian.notebook import named, table

BALL = ChaplyginBall((1, 2, 3), 0.7)
FLOW = BALL.flow(BALL.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)))
ROLLING = RollingBall((0.1, 0.12, 0.15), 2, 0.5).motion([[1, 0, 0], [0, 1, 0], [0, 0, 1]], (1, 2, 3))
MANY = ensemble(BALL, FLOW.state.gamma, FLOW.state.M, d=[0.7, -1])
CURVE = HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1])
VALUES = {
    "curve": (CURVE, "GF(101)"),
    "curve over QQ": (HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]), "genus"),
    "divisor": (CURVE.jacobian().from_points([(0, 1)]), "x"),
    "ball": (BALL, "0.7"),
    "top": (EulerTop((1, 2, 3), field=MP(20)), "MP(20)"),
    "state": (FLOW.state, "1.28"),
    "flow": (FLOW, "ChaplyginBall"),
    "run": (FLOW.at([0, 1, 2]), "0.384"),
    "long run": (FLOW.at(range(100)), "90 more"),
    "run in tau": (FLOW.at_tau([0.25]), "0.25"),
    "portrait": (FLOW.portrait, "low"),
    "body": (RigidBody((1, 2, 3)), "principal moments"),
    "rolling ball": (ROLLING.body, "mass, kg"),
    "laboratory": (ROLLING.at([0, 1]), "x, m"),
    "members": (MANY, "<td>-1</td>"),
    "runs of members": (MANY.at([0, 1]), "d = -1.0 is negative"),
    "starts in the laboratory": (laboratory_ensemble(ROLLING.body, np.eye(3), [(1, 2, 3)] * 12), "2 more"),
    "runs in the laboratory": (laboratory_ensemble(ROLLING.body, np.eye(3), [(1, 2, 3)] * 12).at([0]), "2 more"),
    "diagram": (BALL.diagram(), "<td>0.5882352941</td>"),
    "sweep": (Swept(Path("runs/ball.zarr"), 50, 2), "<td>runs/ball.zarr</td>"),
    "section": (FLOW.section(3), "ϑ"),
    "spectrum": (FLOW.spectrum(), "(0, -1)"),
    "sensitivity": (Sensitivity(np.array([2.0]), np.ones((1, 6, 10)), None, "torus"), "at t = 2.0"),
    "fit": (
        OrientationFit(RigidBody((1, 2, 3)).motion(np.eye(3), (1, 2, 3)), np.array([0.5, 0.7]), 0.1, np.eye(8)),
        "0.7",
    ),
}


class Balanced(HTMLParser):
    """Tags that have been opened and not closed."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.mark.parametrize("name", VALUES)
def test_values_show_themselves(name):
    value, part = VALUES[name]
    text = value._repr_html_()
    reader = Balanced()
    reader.feed(text)
    assert reader.open == []
    assert "<table>" in text
    assert part in text


def test_what_is_shown_is_text():
    assert "<script" not in named("<script>", [("<b>", "<script>")])
    assert table("t", ["a"], [["x" * 1000]]).count("x") == 120
