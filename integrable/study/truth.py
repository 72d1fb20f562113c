"""The truth of a scene: its motion with more digits than any method of the report uses, checked by another integrator.

The truth is stored as decimal strings. :class:`Truth` reads it and measures the errors of other tasks' states.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from time import perf_counter
from typing import Any

from integrable.oracles.collocation import collocation
from integrable.oracles.methods import time_scale
from integrable.oracles.reference import equations, is_body, taylor
from integrable.oracles.stepping import follow
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State
from integrable.scene.classical import ClassicalSystem
from integrable.scene.data import Scene
from integrable.study.timing import Tick, silent
from jacobian.errors import JacobianError, PrecisionLoss

__all__ = [
    "ADDITIONS",
    "CHECK_DIGITS",
    "DIGITS",
    "INTEGRATED",
    "Judge",
    "Truth",
    "compute",
    "kept",
    "moved_by",
    "parts",
]

DIGITS = (40, 60, 100)
"""Digits of the truth of a study: the first of these that resolves the motion."""
CHECK_DIGITS = 30
PART = 20
"""The number of states of the truth that are computed between two steps of the progress bar."""
ADDITIONS = "additions"
"""The method of the systems of :mod:`integrable.classical`."""
COLLOCATED, STEPS_OF_A_SCALE = "Gauss collocation", 4
"""The integrator that checks the truths of :mod:`integrable.classical`, with half as many stages as digits, and its
steps per time scale of the motion.
"""
INTEGRATED = "integrated"
"""The method of systems for which no divisor flow is known."""


def compute(
    scene: Scene,
    patience: float,
    *,
    digits: int | None = None,
    time: Fraction | None = None,
    tick: Tick = silent,
) -> dict[str, Any]:
    """The truth at the scene's times as plain data, with its check against another integrator.

    With ``digits`` given, the truth has that many, and is checked at one ``time`` to as many digits. Otherwise its
    digits are the first of :data:`DIGITS` that resolve the motion, and the check goes as far in time as the integrator
    gets in ``patience`` seconds (0: no check). If no number in DIGITS suffices, the error is raised, except for a body:
    its truth is then the Taylor series alone, with "check" None and the message as "refusal". ``tick(label)`` is called
    between the pieces of work.
    """
    begun = perf_counter()
    if digits is not None:
        flow, found = _carried(scene, digits, tick)
        tick("truth against an integrator")
        return {**found, "seconds": perf_counter() - begun, "check": _check(scene, flow, digits, time=time)}
    for digits in DIGITS:
        try:
            flow, found = _carried(scene, digits, tick)
            seconds = perf_counter() - begun
            check = _check(scene, flow, CHECK_DIGITS, patience) if patience else None
            return {**found, "seconds": seconds, "check": check}
        except JacobianError as error:
            refusal = error
            if not isinstance(error, PrecisionLoss):
                break
    digits = CHECK_DIGITS + 2
    system, state = scene.start(digits)
    if not is_body(system):
        raise refusal
    series = taylor(system, state, scene.times.at(digits), digits=digits)
    found = {"way": "Taylor series", **kept(system, [series], digits), "refusal": str(refusal)}
    return {**found, "seconds": perf_counter() - begun, "check": None}


def _carried(scene: Scene, digits: int, tick: Tick) -> tuple[Any, dict[str, Any]]:
    """The motion of a scene at ``digits`` digits, and its states at the scene's times in the stored form."""
    system, state = scene.start(digits)
    flow = system.motion_through(state)
    trajectories: list[Any] = []
    for times in parts(scene, digits):
        if trajectories:
            tick(f"truth, {digits} digits")
        trajectories.append(flow.at(times))
    return flow, {"way": trajectories[0].way, **kept(system, trajectories, digits)}


def parts(scene: Scene, digits: int) -> list[list[Any]]:
    """The scene's times, divided into pieces of work.

    An integrator receives all times in one piece, since it must pass through all earlier times.
    """
    times = scene.times.at(digits)
    size = PART if scene.rolls_or_spins or scene.classical else len(times)
    return [times[first : first + size] for first in range(0, len(times), size)]


def kept(system: Any, found: Sequence[Any], digits: int) -> dict[str, Any]:
    """States of trajectories in the stored form, from which a :class:`Truth` with ``digits`` digits is read."""

    def written(values: Any) -> list[str]:
        return [system.field.context.nstr(x, digits) for x in values]

    known = all(getattr(part, "tau", None) is not None for part in found)
    return {
        "digits": digits,
        "gamma": [written(row) for part in found for row in part.gamma],
        "M": [written(row) for part in found for row in part.M],
        "tau": written(t for part in found for t in part.tau) if known else None,
    }


def _check(scene: Scene, flow: Any, digits: int, patience: float = 0.0, time: Fraction | None = None) -> dict[str, Any]:
    """The largest differences between the truth and the independent integrator.

    Both are compared at ``time``. By default this time is one time scale of the motion, doubled as long as the
    integrator needs little of ``patience`` seconds.
    """
    system = flow.system
    context = system.field.context
    last = context.mpf(max(scene.times.at(digits)))
    by = "Taylor series" if is_body(system) else COLLOCATED if moved_by(system) == ADDITIONS else INTEGRATED
    if time is None:
        by = "mpmath.odefun" if moved_by(system) == INTEGRATED else by
        moment = min(context.mpf(time_scale(*scene.start(FLOAT_DIGITS))), last)
    else:
        moment = last = context.mpf(time.numerator) / time.denominator
    while True:
        begun = perf_counter()
        found = _independent(by, scene, flow, moment, digits)
        seconds = perf_counter() - begun
        if seconds > patience / 3 or moment == last:
            break
        moment = min(2 * moment, last)
    errors = Judge(system, flow.state, *_states(flow.at([moment]))).errors(*found)
    return {"by": by, "digits": digits, "time": float(moment), **errors, "seconds": seconds}


def moved_by(system: Any) -> str:
    """The name of the method that computes a system's motion: divisors on one curve, additions, two elliptic curves, or
    integration of the equations of motion.
    """
    if is_body(system):
        return "divisor flow"
    if isinstance(system, ClassicalSystem):
        return ADDITIONS
    return "elliptic curves" if system.separates or system.repels else INTEGRATED


def _independent(by: str, scene: Scene, flow: Any, time: Any, digits: int) -> tuple[Any, Any]:
    """γ and M at one time, shapes (1, 3), by the integrator ``by``; all integrators except the Taylor series compute
    with ten more digits.
    """
    from integrable.deformations.integrated import IntegratedMotion
    from integrable.motion.near import right_hand_sides

    if by == "Taylor series":
        return _states(taylor(flow.system, flow.state, [time], digits=digits))
    system, state = scene.start(digits + 10)
    if by == INTEGRATED:
        return _states(IntegratedMotion(system, state).at([time]))
    context = system.field.context
    if by == COLLOCATED:
        step = time_scale(*scene.start(FLOAT_DIGITS)) / STEPS_OF_A_SCALE
        advance = collocation(equations(system, state), system.field.coerce, context.dps, digits // 2)
        return _states(follow(advance, state.row, [context.mpf(time)], context.mpf(step)))
    rate = right_hand_sides(system)
    row = context.odefun(lambda _time, y: rate(y), 0, state.row)(context.mpf(time))
    return [row[:3]], [row[3:]]


def _states(found: Any) -> tuple[Any, Any]:
    return found.gamma, found.M


class Judge:
    """The reference for errors: states of a motion or orbit, in rows of γ and of M, and the integrals of the start."""

    def __init__(self, system: Any, state: State, gamma: Any, M: Any) -> None:
        self.system, self.state = system, state
        self.context = system.field.context
        self.gamma, self.M = self._rows(gamma), self._rows(M)
        self.integrals = system.integrals(state)
        self.size_of_M = self.context.sqrt(sum(m * m for m in state.vectors[1])) or self.context.one
        # the γ of a body is a unit vector; ``gamma`` of a classical system holds its positions
        classical = isinstance(system, ClassicalSystem)
        self.size_of_gamma = (max(map(abs, state.vectors[0])) if classical else 0) or self.context.one

    def judge(self, gamma: Any, M: Any) -> dict[str, Any]:
        """The :meth:`errors`, and the "drift" of each integral: its largest change from the start over the rows.

        Drifts are relative to the value at the start; that of (γ, M) is relative to |M|.
        """
        start = {name: _several(value) for name, value in self.integrals._asdict().items()}
        scales = {
            name: self.size_of_M if name == "C2" else max(map(abs, values)) or self.context.one
            for name, values in start.items()
        }
        drift = dict.fromkeys(scales, self.context.zero)
        for x, m in zip(self._rows(gamma), self._rows(M), strict=True):
            now = self.system.integrals(State(tuple(x), tuple(m)))
            for name, values in now._asdict().items():
                gaps = (abs(a - b) for a, b in zip(_several(values), start[name], strict=True))
                drift[name] = max(drift[name], max(gaps) / scales[name])
        return {**self.errors(gamma, M), "drift": {name: float(value) for name, value in drift.items()}}

    def errors(self, gamma: Any, M: Any) -> dict[str, float]:
        """The errors of γ and of M (relative to |M|), the largest over the rows.

        Errors of q and p in a row are relative to the largest component at the start or in that row of the truth.
        Rounding next to a pole then does not count.
        """
        parts = {"error_gamma": (gamma, self.gamma, self.size_of_gamma), "error_M": (M, self.M, self.size_of_M)}
        return {name: float(max(self._relative(*part))) for name, part in parts.items()}

    def _relative(self, rows: Any, true: list[list[Any]], size: Any) -> list[Any]:
        if not isinstance(self.system, ClassicalSystem):
            return [x / size for x in self.distances(rows, true)]
        return [x / max(size, *map(abs, row)) for x, row in zip(self.distances(rows, true), true, strict=True)]

    def distances(self, rows: Any, true: list[list[Any]]) -> list[Any]:
        """For each row, the largest difference over its components from the true row."""
        pairs = zip(self._rows(rows), true, strict=True)
        return [max(abs(x - y) for x, y in zip(row, other, strict=True)) for row, other in pairs]

    def _rows(self, array: Any) -> list[list[Any]]:
        """Rows of floats, strings or other contexts' mpf, converted to mpf of this context without loss."""
        rows = [[self.context.mpf(x) for x in row] for row in array]
        if not all(self.context.isfinite(x) for row in rows for x in row):
            raise ArithmeticError("the method returned a number that is not finite, and said nothing")
        return rows


def _several(value: Any) -> tuple[Any, ...]:
    """The components of an integral as a tuple, also where it is a single number."""
    return value if isinstance(value, tuple) else (value,)


class Truth(Judge):
    """A truth, read from its stored form."""

    def __init__(self, scene: Scene, kept: dict[str, Any]) -> None:
        self.digits: int = kept["digits"]
        super().__init__(*scene.start(self.digits + 10), kept["gamma"], kept["M"])
        self.tau = None if kept["tau"] is None else [self.context.mpf(x) for x in kept["tau"]]
