"""Cases of periods and Abel–Jacobi images in balls: they contain the values computed with twice the digits."""

from __future__ import annotations

from random import Random
from typing import Any

from jacobian.fields.factor import factor
from jacobian.periods.abel_balls import AbelBalls
from tests.fuzz.case import Case, Complaint
from tests.jacobian.periods.ball_curves import random_curve

SETUP = """
from fractions import Fraction
from jacobian import CC, QQ, HyperellipticCurve
from jacobian.periods.abel_balls import AbelBalls
"""


def balls(rng: Random) -> Case:
    """The class of a point on a curve of genus 1 … 6 over QQ or CC, branch points in clusters 1e-6 wide among them."""
    kind = rng.choice(("small", "complex", "cluster"))
    C = random_curve(rng, rng.choice((1, 2, 2, 3, 3, 4, 5, 6)), kind)
    curve = f"HyperellipticCurve({C.field.name}, {list(C.f)}, {list(C.h)})"
    x: Any = complex(rng.uniform(-2, 2), rng.uniform(-2, 2)) if kind == "complex" else 0
    if kind == "cluster":
        x = -factor(C.field, C.f)[0][0][0]
    setup = SETUP + f"C = {curve}\nA, D = AbelBalls(C, 15), C.jacobian().from_points([C.lift_x({x!r})])\n"
    return Case(setup, "A(D)", _contained, limit=20)


def _contained(names: dict[str, Any]) -> Complaint | None:
    """Checks that the balls of periods and image contain the values at twice the digits, the image up to periods."""
    A, finer = names["A"], AbelBalls(names["C"], 30)
    image = finer(names["D"])
    with finer.periods.cover.numbers.working():
        gap = [x - y for x, y in zip(names["got"], image, strict=True)]
        # at other digits a different tree may join equidistant branch points
        vectors = [gap, *zip(*A.periods.big, strict=True)]
        found = [c - round(float(c)) for vector in vectors for c in finer.periods.coordinates(vector)]
        missed = [c for c in found if not c.contains(0)]
    return Complaint(f"{len(missed)} of {len(found)} coordinates", "0", "False") if missed else None
