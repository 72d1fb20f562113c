"""The truth of a scene: the divisor flow at more than twice the digits, held against an integrator that shares no code.

It is kept as decimal strings; :class:`Truth` reads it back and judges the states that other rows found.
"""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter
from typing import Any

from integrable.oracles.methods import time_scale
from integrable.oracles.reference import is_body, taylor
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State
from integrable.scene.data import Scene
from integrable.study.ways import clock_of
from jacobian.errors import JacobianError, PrecisionLoss

__all__ = ["CHECK_DIGITS", "DIGITS", "Truth", "compute", "is_divisor_flow"]

DIGITS = (40, 60, 100)
"""Digits of the truth: the first of these that carries the motion."""
CHECK_DIGITS = 30


def compute(scene: Scene, patience: float) -> dict[str, Any]:
    """The truth at the scene's times as plain data, with what the check against the Taylor series found.

    ``patience``: seconds that the series may take; the check goes as far in time as they allow. Where the flow of a
    body refuses the motion at any digits, the series alone is the truth, "check" is None and "refusal" what was said.
    """
    begun = perf_counter()
    refusal: JacobianError | None = None
    for digits in DIGITS:
        system, state = scene.start(digits)
        try:
            flow = system.motion_through(state)
            trajectory = flow.at(scene.times.at(digits))
            found = {"clock": clock_of(flow), **_kept(system, trajectory, digits)}
            return {**found, "seconds": perf_counter() - begun, "check": _check(scene, flow, patience)}
        except PrecisionLoss as error:
            refusal = error
        except JacobianError as error:
            refusal = error
            break
    assert refusal is not None, "no digits to try"
    digits = CHECK_DIGITS + 2
    system, state = scene.start(digits)
    if not is_body(system):
        raise refusal
    series = taylor(system, state, scene.times.at(digits), digits=digits)
    found = {"clock": "Taylor series", **_kept(system, series, digits), "refusal": str(refusal)}
    return {**found, "seconds": perf_counter() - begun, "check": None}


def _kept(system: Any, found: Any, digits: int) -> dict[str, Any]:
    context = system.field.context
    tau = getattr(found, "tau", None)
    return {
        "digits": digits,
        "gamma": _strings(context, found.gamma, digits),
        "M": _strings(context, found.M, digits),
        "tau": None if tau is None else [context.nstr(t, digits) for t in tau],
    }


def _strings(context: Any, rows: Any, digits: int) -> list[list[str]]:
    return [[context.nstr(x, digits) for x in row] for row in rows]


def _check(scene: Scene, flow: Any, patience: float) -> dict[str, Any]:
    """The largest differences between the truth and the independent integrator, as far in time as it can afford."""
    system, state = scene.start(CHECK_DIGITS + 10)
    K, last = system.field, max(scene.times.at(CHECK_DIGITS + 10))
    time = min(K.coerce(time_scale(*scene.start(FLOAT_DIGITS))), last)
    method = "Taylor series" if is_body(system) else "extrapolation" if is_divisor_flow(system) else "mpmath.odefun"
    while True:
        begun = perf_counter()
        found = _independent(method, system, state, time)
        seconds = perf_counter() - begun
        if seconds > patience / 3 or time == last:
            break
        time = min(2 * time, last)
    context = flow.system.field.context
    ours = flow.at([context.mpf(time)])
    size = context.sqrt(sum(m * m for m in _row(context, state.M)))
    differences = [
        max(abs(x - y) for x, y in zip(_row(context, a), _row(context, b), strict=True))
        for a, b in ((ours.gamma[0], found[0]), (ours.M[0], found[1]))
    ]
    return {
        "by": method,
        "digits": CHECK_DIGITS,
        "time": float(time),
        "error_gamma": float(differences[0]),
        "error_M": float(differences[1] / size),
        "seconds": seconds,
    }


def is_divisor_flow(system: Any) -> bool:
    """Whether the motion of a system is an addition of divisors; otherwise its equations are integrated."""
    return is_body(system) or bool(system.separates or system.repels)


def _independent(method: str, system: Any, state: Any, time: Any) -> tuple[Any, Any]:
    """γ and M at one time by an integrator that has nothing in common with the truth."""
    from integrable.deformations.integrated import IntegratedMotion, rates

    if method == "mpmath.odefun":
        rate = rates(system)
        solution = system.field.context.odefun(lambda _time, y: rate(y), 0, [*state.gamma, *state.M])
        row = solution(time)
        return row[:3], row[3:]
    if method == "Taylor series":
        found: Any = taylor(system, state, [time], digits=CHECK_DIGITS)
    else:
        found = IntegratedMotion(system, state).at([time])
    return found.gamma[0], found.M[0]


def _row(context: Any, values: Any) -> list[Any]:
    """Floats or mpf of another context as mpf of this one, digit for digit."""
    return [context.mpf(x) for x in values]


class Truth:
    """A computed truth, read back: the states to hold others against, and the integrals of the exact start."""

    def __init__(self, scene: Scene, kept: dict[str, Any]) -> None:
        self.digits: int = kept["digits"]
        self.system, self.state = scene.start(self.digits + 10)
        self.context = self.system.field.context
        read = self.context.mpf
        self.gamma = [[read(x) for x in row] for row in kept["gamma"]]
        self.M = [[read(x) for x in row] for row in kept["M"]]
        self.tau = None if kept["tau"] is None else [read(x) for x in kept["tau"]]
        self.integrals = self.system.integrals(self.state)
        self.size_of_M = self.context.sqrt(sum(m * m for m in self.state.M))

    def judge(self, gamma: Any, M: Any) -> dict[str, Any]:
        """Errors of γ and of M (relative to |M|), the largest over the times, and the drift of each integral.

        Drifts are relative to the value at the start, that of (γ, M) to |M|.
        """
        rows = [[self._vector(a), self._vector(b)] for a, b in zip(gamma, M, strict=True)]
        scales = {
            name: self.size_of_M if name == "C2" else abs(value) or self.context.one
            for name, value in zip(self.integrals._fields, self.integrals, strict=True)
        }
        drift = dict.fromkeys(scales, self.context.zero)
        for x, m in rows:
            now = self.system.integrals(State((x[0], x[1], x[2]), (m[0], m[1], m[2])))
            for name, start, value in zip(drift, self.integrals, now, strict=True):
                drift[name] = max(drift[name], abs(value - start) / scales[name])
        return {
            "error_gamma": float(_distance([x for x, _ in rows], self.gamma)),
            "error_M": float(_distance([m for _, m in rows], self.M) / self.size_of_M),
            "drift": {name: float(value) for name, value in drift.items()},
        }

    def _vector(self, values: Sequence[Any]) -> list[Any]:
        row = _row(self.context, values)
        if not all(self.context.isfinite(x) for x in row):
            raise ArithmeticError("the method returned a number that is not finite, and said nothing")
        return row


def _distance(rows: list[list[Any]], others: list[list[Any]]) -> Any:
    return max(abs(x - y) for row, other in zip(rows, others, strict=True) for x, y in zip(row, other, strict=True))
