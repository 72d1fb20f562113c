"""Periods in balls: milliseconds for period matrices with proven radii, and the times of Molin and Neurohr.

Genus 3 and 14 at 38, 154 and 600 digits; "theirs" are the times of Molin and Neurohr (2019) in C on a 2.27 GHz Xeon,
for curves of these genera, not for these curves. "kept" is a second call, which reuses the nodes of the first.
"""

from __future__ import annotations

from time import perf_counter

from jacobian import QQ, HyperellipticCurve
from jacobian.periods.proven import period_balls

THEIRS = {(3, 38): 3.2, (3, 154): 15.0, (3, 600): 220.0, (14, 38): 51.0, (14, 154): 240.0, (14, 600): 4300.0}


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each genus and precision. AssertionError where a radius is too large."""
    return [_row(g, digits, theirs) for (g, digits), theirs in THEIRS.items() if not smoke or digits == 38]


def _row(g: int, digits: int, theirs: float) -> dict[str, object]:
    C = HyperellipticCurve(QQ, [1, 1, *[0] * (2 * g - 1), 1])
    times = []
    for _ in range(3):
        begun = perf_counter()
        P = period_balls(C, digits)
        times.append(1e3 * (perf_counter() - begun))
    with P.cover.numbers.working():
        radius = max((x.rad() for row in P.big for x in row), key=float)
        if not radius < 10 * P.cover.numbers.ten(-digits):
            raise AssertionError(f"genus {g}, {digits} digits: a radius of {radius}")
    return {"genus": g, "digits": digits, "first, ms": times[0], "kept, ms": min(times[1:]), "theirs, ms": theirs}
