"""The cost of a step: nanoseconds compiled and microseconds interpreted, and the growth of V² − f mod U."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial

from benchmarks.curves import least_seconds
from integrable import ChaplyginBall, EulerTop
from jacobian import MP
from jacobian.inexact import genus2_real

GAMMA = tuple(map(Fraction, ("0.48", "0.6", "0.64")))
MOMENTUM = tuple(map(Fraction, ("0.384", "1.28", "-1.488")))
SYSTEMS = {"S1, Chaplygin ball": ChaplyginBall(inertia=(1, 2, 3), d=0.7), "S2, Euler top": EulerTop(inertia=(1, 2, 3))}
CONJUGATE = (0.1j, -0.1j)
MOST_RESIDUAL, MOST_NANOSECONDS = 1e-9, 100


def seconds(action: Callable[[], object], calls: int) -> float:
    """The least processor time of one call among several, on one core. Other work on the machine does not count."""
    return least_seconds(lambda: [action() for _ in range(calls)], 5) / calls


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows (system, what, value, unit)."""
    rows: list[dict[str, object]] = []
    for name, system in SYSTEMS.items():
        state = system.state(GAMMA, MOMENTUM)
        flow = system.flow(state, kernel="compiled")
        steps = 10_000 if smoke else 1_000_000
        flow.residual_growth([10])  # loads or makes the compiled loop
        cost = 1e9 * seconds(lambda flow=flow, steps=steps: flow.residual_growth([steps]), 1) / steps  # type: ignore[misc]
        rows.append(_row(name, f"compiled step, {steps} of them", cost, "ns"))
        counts = [10**k for k in range(3, 5 if smoke else 8)]
        growth = flow.residual_growth(counts)
        rows += [_row(name, f"|V² − f mod U|/scale after {count} steps", float(value), "") for count, value in growth]
        if max(value for count, value in growth if count <= 10**6) > MOST_RESIDUAL:
            raise AssertionError(f"{name}: residual {growth}")
        if not smoke and cost > MOST_NANOSECONDS:
            raise AssertionError(f"{name}: {cost:.0f} ns a step, promised {MOST_NANOSECONDS}")
        rows += _interpreted(name, system, 5 if smoke else 300)
    return rows


def _interpreted(name: str, system: ChaplyginBall | EulerTop, calls: int) -> list[dict[str, object]]:
    state = system.state(GAMMA, MOMENTUM)
    setup = system.flow(state).setup
    f, start = setup.floats.f, setup.floats.start[:4]
    step = tuple(map(float, setup.translations.near(setup.problem.half_step)))[:4]
    move = system.translation(CONJUGATE)
    actions: dict[str, tuple[Callable[[], object], int]] = {
        "genus2_real.add, interpreted": (lambda: genus2_real.add(f, start, step), 10 * calls),
        "translation([0.1j, -0.1j])(state)": (lambda: move(state), calls),
    }
    for label, other in (("RR", system), ("MP(50)", type(system)(**_arguments(system), field=MP(50)))):
        D = other.divisor(other.state(GAMMA, MOMENTUM))
        actions[f"D + E over {label}"] = partial(D.jacobian.add, D, 2 * D), calls // 5 + 1
    return [_row(name, what, 1e6 * seconds(action, count), "µs") for what, (action, count) in actions.items()]


def _arguments(system: ChaplyginBall | EulerTop) -> dict[str, object]:
    return {"inertia": system.inertia} | ({"d": system.d} if system.body.rolls else {})


def _row(system: str, what: str, value: float, unit: str) -> dict[str, object]:
    return {"system": system, "what": what, "value": value, "unit": unit}
