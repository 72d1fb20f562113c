"""The measurement of one row, by its kind. Each function returns plain data for JSON, or raises: the row then says why.

Run times are medians of ``time.perf_counter``, set-up included; every run starts from a new system and state.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable
from time import perf_counter
from typing import Any

from integrable.oracles.methods import METHODS, time_scale
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.study.plan import LIMITS, Row
from integrable.study.truth import Truth, compute
from integrable.study.ways import clock_of
from jacobian.errors import JacobianError

__all__ = ["TooLong", "Unjudged", "measured"]

PATIENCE = 3.0  # seconds of repeats after which a median of fewer runs is taken
FLOOR_TIMES = 20
"""About how many of the scene's times the conditioning is the largest of."""
PILOT = 2.0**-7
"""Time scales of the first trial of an integrator, from which the time of a whole run is told in advance."""
ENOUGH = 0.1
"""Each trial goes four times as far, until one takes so many seconds, or is the whole run."""

TRIAL = 0.5
"""Seconds of successive steps from which the time of all of them is told."""

Data = dict[str, Any]


class TooLong(RuntimeError):
    """A run that would take longer than the study allows: a greater cost of the method need not be tried."""


class Unjudged(RuntimeError):
    """There is nothing to hold a run against."""


def measured(row: Row, truth: Data | None) -> Data:
    """The result of a row, given the result of the row that it takes its truth from."""
    return _KINDS[row.kind](row, truth)


def _truth(row: Row, _: Data | None) -> Data:
    return compute(row.scene, LIMITS[row.mode].check)


def _floor(row: Row, _: Data | None) -> Data:
    from integrable.motion.conditioning import conditioning

    scene = row.scene
    for digits in (FLOAT_DIGITS, 30):
        begun = perf_counter()
        chosen, motion = _chosen(scene, digits)
        try:
            found = conditioning(*scene.start(digits), chosen, motion)
        except (JacobianError, ArithmeticError):
            if digits > FLOAT_DIGITS:
                raise
            continue
        break
    floors = found.floor()
    return {
        "floor_gamma": floors[0],
        "floor_M": floors[1],
        "conditioning_gamma": found.gamma,
        "conditioning_M": found.M,
        "inputs": found.inputs,
        "digits": digits,
        "times": len(chosen),
        "seconds": perf_counter() - begun,
    }


def _chosen(scene: Scene, digits: int) -> tuple[list[Any], Any]:
    """Some of the scene's times, the last among them, or of an orbit its last step; and what moves there."""
    if scene.steps is None:
        times = scene.times.at(digits)
        return times[:: -max(1, (len(times) - 1) // FLOOR_TIMES)], None
    last = scene.steps.count

    def motion(system: Any, state: Any, _times: Any) -> Any:
        from integrable.scene.orbit import orbit

        found = orbit(scene.step(system, digits), state, last)
        return found.gamma[-1:], found.M[-1:]

    return [last], motion


def _flow(row: Row, kept: Data | None) -> Data:
    digits = 30 if row.setting == "30 digits" else FLOAT_DIGITS
    options = {"kernel": "compiled"} if row.setting == "compiled" else {}
    times = row.scene.times.at(digits)

    def once() -> tuple[tuple[float, float], Any]:
        system, state = row.scene.start(digits)
        begun = perf_counter()
        flow = system.flow(state, **options) if options else system.motion_through(state)
        ready = perf_counter()
        trajectory = flow.at(times)
        found = flow, trajectory.gamma, trajectory.M
        return (ready - begun, perf_counter() - ready), found

    if digits <= FLOAT_DIGITS:
        once()  # imports and compiles, or loads what an earlier run has compiled: rows of their own
    result, (flow, gamma, M) = _timed(once, row)
    return result | {"clock": clock_of(flow)} | _truth_of(row, kept).judge(gamma, M)


def _backlund(row: Row, kept: Data | None) -> Data:
    """Successive additions of the pair {±iη}, the H1 flow to second order in η, between the τ of the scene's times.

    The τ are those of the truth: the map knows no physical time, and its error is that of the points alone.
    """
    truth = _truth_of(row, kept)
    if truth.tau is None:
        raise Unjudged("not run: the truth is that of an integrator, which knows no τ")
    targets = [float(t) for t in truth.tau]
    count = int(row.value or 0)

    def once() -> tuple[tuple[float, float], Any]:
        system, state = row.scene.start(FLOAT_DIGITS)
        begun = perf_counter()
        a1, a2, a3 = system.a
        scale = (a1 * a2 * a3 * system.integrals(state).H1) ** 0.5
        ready = perf_counter()
        now, rows, done = 0.0, [], 0
        for target in targets:
            steps = max(1, round(count * (target - now) / targets[-1])) if target > now else 0
            if steps:
                eta = scale * (target - now) / steps
                step = system.translation(points=[complex(0, eta), complex(0, -eta)])
                for _ in range(steps):
                    state = step(state)
                    done += 1
                    if done == 1:
                        first = perf_counter()  # from here on nothing is imported
                    elif (spent := perf_counter() - first) > TRIAL:
                        _affordable(spent * count / (done - 1), row)
            now = target
            rows.append(state)
        return (ready - begun, perf_counter() - ready), rows

    result, rows = _timed(once, row)
    return result | truth.judge([x.gamma for x in rows], [x.M for x in rows])


def _comparator(row: Row, kept: Data | None) -> Data:
    method, scene, truth = METHODS[row.method], row.scene, _truth_of(row, kept)
    value = row.value or 0.0
    times = scene.times.at(int(value) if method.parameter == "digits" else FLOAT_DIGITS)
    begin = method.digits(value)
    _affordable(_pilot(row, times), row)

    def once() -> tuple[tuple[float, float], Any]:
        system, state = scene.start(begin)
        begun = perf_counter()
        run = method.prepare(system, state, row.value)
        ready = perf_counter()
        solution = run(times)
        return (ready - begun, perf_counter() - ready), solution

    result, solution = _timed(once, row)
    return result | {"evaluations": solution.evaluations} | truth.judge(solution.gamma, solution.M)


def _affordable(told: float, row: Row) -> None:
    """TooLong where a whole run would take more seconds than the study allows."""
    allowed = LIMITS[row.mode].run
    if told > allowed:
        raise TooLong(f"not run: a whole run would take about {told:.2g} s, more than the {allowed:g} s of this study")


def _pilot(row: Row, times: list[Any]) -> float:
    """Seconds that a whole run would take, from short ones, each to four times the time of the one before."""
    system, state = row.scene.start(FLOAT_DIGITS)
    last = float(max(times))
    run = METHODS[row.method].prepare(system, state, row.value)

    def seconds_to(time: float) -> float:
        begun = perf_counter()
        run([time])
        return perf_counter() - begun

    time = min(PILOT * time_scale(system, state), last)
    run([time])  # imports, and compiles or loads what an earlier run has compiled
    before = seconds = seconds_to(time)
    while time < last and seconds < ENOUGH + before:
        done, before = time, seconds
        time = min(4 * time, last)
        seconds = seconds_to(time)
        if seconds >= ENOUGH + before:  # a real cost, or a hiccup of the machine?
            seconds = min(seconds, seconds_to(time))
    return seconds + max(0.0, seconds - before) / (time - done) * (last - time) if time < last else seconds


def _truth_of(row: Row, kept: Data | None) -> Truth:
    if kept is None:
        raise Unjudged("not run: there is no truth to hold it against")
    return Truth(row.scene, kept)


def _timed(once: Callable[[], tuple[tuple[float, float], Any]], row: Row) -> tuple[Data, Any]:
    """``once`` up to the study's number of repeats; medians of set-up, evaluation and both, and what it returned last.

    A run longer than the study allows is taken for what it is, once.
    """
    durations: list[tuple[float, float]] = []
    limits = LIMITS[row.mode]
    while len(durations) < limits.repeat and sum(map(sum, durations)) < min(PATIENCE, limits.run):
        duration, found = once()
        durations.append(duration)
    return {
        "setup": statistics.median(setup for setup, _ in durations),
        "evaluation": statistics.median(evaluation for _, evaluation in durations),
        "total": statistics.median(map(sum, durations)),
        "runs": len(durations),
    }, found


def _first_use(row: Row, _: Data | None) -> Data:
    from integrable.study.fresh import first_use

    return first_use(row.source)


def _additions(row: Row, _: Data | None) -> Data:
    from integrable.study.additions import near_additions

    return near_additions(row.scene)


def _left_out(row: Row, _: Data | None) -> Data:
    from integrable.study.fresh import left_out

    return left_out(row.source)


def _compile(row: Row, _: Data | None) -> Data:
    from integrable.study.fresh import compilation

    return compilation(row.source, row.method)


def _orbit(row: Row, _: Data | None) -> Data:
    from integrable.scene.orbit import measure_orbit

    report = measure_orbit(row.scene, row.scene.digits, lambda _label: None).report
    assert report is not None, "an orbit that is measured has a report"
    found = report.as_dict()
    for one in found["rows"]:
        del one["growth"]  # one pair for each step: `integrable run` shows it
    return found


_KINDS: dict[str, Callable[[Row, Data | None], Data]] = {
    "truth": _truth,
    "floor": _floor,
    "flow": _flow,
    "first use": _first_use,
    "compile": _compile,
    "backlund": _backlund,
    "comparator": _comparator,
    "left out": _left_out,
    "additions": _additions,
    "orbit": _orbit,
}
