"""The objects on which bad calls are made: name → the line that makes it, and the names that the line needs."""

from __future__ import annotations

import re
from typing import Any

IMPORTS = (
    "from random import Random\nfrom decimal import Decimal\nfrom fractions import Fraction\nimport numpy as np\n"
    "from jacobian import *\nfrom integrable import *\nfrom jacobian.batch import DivisorArray, set_threads\n"
)
LINES = {
    "C": "C = HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1])",
    "J": "J = C.jacobian()",
    "D": "D = J.random(Random(1))",
    "E": "E = J.random(Random(2))",
    "F": "F = HyperellipticCurve(GF(7), [1, 1, 0, 0, 0, 0, 1])",
    "H": "H = F.jacobian()",
    "other": "other = F.jacobian().random(Random(3))",
    "Q": "Q = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1])",
    "L": "L = HyperellipticCurve(RR, [1, 0.5, 0, 0, 0, 1]).jacobian()",
    "B": "B = L.from_points([(0.5, L.curve.lift_x(0.5).y), (1.5, L.curve.lift_x(1.5).y)])",
    "A": "A = DivisorArray.stack([D, E, D + E])",
    "N": "N = DivisorArray.stack([B, B + B])",
    "R": "from jacobian.relatives.ray_class import RayClassGroup\nR = RayClassGroup(C, 2)",
    "r": "r = R.random(Random(4))",
    "U": "U = R.fibre",
    "G": "from jacobian.relatives.glued import GeneralizedJacobian\n"
    "G = GeneralizedJacobian(HyperellipticCurve(GF(101), [1, 2, 0, 3, 1]))",
    "g": "g = G.random(Random(5))",
    "S": "S = J.structure()",
    "T": "T = J.fixed_base(D)",
    "Z": "from jacobian.periods.abel import AbelMap\nZ = AbelMap(L.curve)",
    "W": "from jacobian.relatives.conic import representative\nW = representative(D, C.random_point(Random(6)))",
    "Y": "from jacobian.relatives.formal_sum import FormalSum\n"
    "Y = 2 * FormalSum.from_divisor(D) - FormalSum.from_divisor(E)",
    "ball": "ball = ChaplyginBall((1, 2, 3), 0.7)",
    "state": "state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))",
    "flow": "flow = ball.flow(state)",
    "motion": "motion = flow.at([0, 1, 20])",
    "top": "top = EulerTop((1, 2, 3))",
    "spin": "spin = top.flow(top.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)))",
    "many": "many = ensemble(top, (0.48, 0.6, 0.64), [(0.384, 1.28, -1.488)] * 3)",
    "exact": "exact = ChaplyginBall((1, 2, 3), 5, field=GF(10007))",
    "tilde": "tilde = Tilde((1, 2, 4))",
    "bent": "bent = tilde.flow(tilde.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)))",
    "hat": "hat = Hat((1, 2, 4))",
    "gyro": "gyro = Gyroscopic((1, 2, 4), 0.5)",
    "step": "step = ball.translation([1.8, 2.5])",
    "keyless": "keyless = ball.keyless()",
    "diagram": "diagram = ball.diagram()",
    "rolling": "from integrable.systems.on_layer import BodyOnLayer\nlayer = BodyOnLayer((1, 2, 3), 0.7)\n"
    "rolling = layer.flow(layer.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)))",
    # a step may refuse its own arguments, or a state
    "multiplied": "multiplied = lambda factor: ball.multiplication(factor)(state)",
    "added": "added = lambda multiple: tilde.translation([30, -30], multiple=multiple)(state)",
}


def lines_for(text: str) -> str:
    """The imports and the lines that a text needs, in order."""
    needed = set(re.findall(r"\b\w+\b", text)) & set(LINES)
    while more := {n for name in needed for n in re.findall(r"\b\w+\b", LINES[name]) if n in LINES} - needed:
        needed |= more
    return IMPORTS + "".join(LINES[name] + "\n" for name in LINES if name in needed)


def made() -> dict[str, Any]:
    """All of them, made once."""
    names: dict[str, Any] = {}
    exec(IMPORTS + "\n".join(LINES.values()), names)
    return names
