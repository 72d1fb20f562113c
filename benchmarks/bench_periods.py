"""Periods: milliseconds for the period matrix and the real ovals of genus-2 curves at 15, 50 and 200 digits.

Gauss–Chebyshev quadrature on mpmath's numbers (on doubles for "RR"), roots found or given; each figure is the median of
repeats in one process, where the nodes are kept. The last column says how far the result is from a finer one.
"""

from __future__ import annotations

from statistics import median
from time import perf_counter
from typing import Any

from jacobian import MP, RR, HyperellipticCurve, poly
from jacobian.periods.abel import AbelMap, periods, real_periods

ROLLING = ["0.21", "0.36", "0.55", "0.75", "1.4"]


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each curve and precision. AssertionError where a result is not right to its digits."""
    rows: list[dict[str, object]] = []
    for dps in (0, 15) if smoke else (0, 15, 50, 200):
        K = MP(dps) if dps else RR
        repeats = 1 if smoke else 7
        for name, roots in (("rolling ball, five real roots", ROLLING), ("y² = x⁵ + 1", None)):
            C = _curve(K, roots)
            known = None if roots is None else [K.coerce(_number(K, e)) for e in roots]
            row: dict[str, object] = {"curve": name, "digits": dps or "RR"}
            row["matrix, ms"] = _milliseconds(lambda C=C: periods(C), repeats)
            row["roots given, ms"] = known and _milliseconds(lambda C=C, known=known: periods(C, known), repeats)
            row["ovals, ms"] = known and _milliseconds(lambda C=C, known=known: real_periods(C, known), repeats)
            A = AbelMap(C)
            point = A.curve.jacobian().from_points(
                [A.curve.lift_x(_number(K, "0.3")), A.curve.lift_x(_number(K, "0.6"))]
            )
            image = A(point)
            row["Abel map, ms"] = _milliseconds(lambda A=A, point=point: A(point), repeats)
            row["inverse, ms"] = _milliseconds(lambda A=A, image=image: A.inverse(image), repeats)
            row["log10 error"] = _error(C, dps)
            rows.append(row)
    return rows


def _number(K: Any, text: str) -> Any:
    return float(text) if K is RR else text


def _curve(K: Any, roots: list[str] | None) -> HyperellipticCurve:
    if roots is None:
        return HyperellipticCurve(K, [1, 0, 0, 0, 0, 1])
    f = poly.from_roots(K, [K.coerce(_number(K, e)) for e in roots])
    return HyperellipticCurve(K, poly.scale(K, K.coerce(_number(K, "4.2")), f))


def _milliseconds(work: Any, repeats: int) -> float:
    times = []
    for _ in range(repeats):
        begun = perf_counter()
        work()
        times.append(perf_counter() - begun)
    return 1e3 * median(times)


def _error(C: HyperellipticCurve, dps: int) -> float:
    """log₁₀ of the distance of the columns from the lattice computed with twice the digits."""
    from mpmath import log10, mpf, nint

    fine = MP(2 * (dps or 16))
    # the same coefficients, to the last bit
    P, Q = periods(C), periods(HyperellipticCurve(fine, C.f))
    worst = mpf(0)
    for column in zip(*P.big, strict=True):
        worst = max(worst, *(abs(c - nint(c)) for c in Q.coordinates(column)))
    found = float(log10(worst)) if worst else -float(fine.dps)
    if found > 3 - (dps or 16):
        raise AssertionError(f"the periods are right to {-found:.1f} digits only, {dps or 16} were asked for")
    return found
