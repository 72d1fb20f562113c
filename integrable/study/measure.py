"""The measurement of one task, by its kind: plain data for JSON, or what is raised, and its row then says why.

Run times are medians of ``time.perf_counter``, set-up included; every run starts from a new system and state.
``tick(label)`` is called between the pieces of a task.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import inf
from time import perf_counter
from typing import Any

from integrable.oracles.methods import METHODS, time_scale
from integrable.oracles.reference import dop853
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene, Times
from integrable.study.additions import near_additions
from integrable.study.fresh import compilation, first_use, left_out
from integrable.study.plan import Task
from integrable.study.timing import Tick, Timed, TooLong, at_most, silent, timed
from integrable.study.truth import Truth, compute
from jacobian.errors import JacobianError

__all__ = ["Unjudged", "flow_measured", "measured"]

PILOT = 2.0**-7
"""Time scales of the first trial of an integrator, from which the time of a whole run is told in advance."""
ENOUGH = 0.1
"""Each trial goes four times as far, until one takes so many seconds, or is the whole run."""
FIRST = 15.0
"""Seconds that the first trial of a method may take, which imports."""

NEAR = 30.0
"""An error so many times the allowed one is not rounding that adds up over too many steps."""

MARGIN = 2.0
"""A trial tells no more than this many times the fastest run so far, or it is not looked at."""

TRIAL = 0.5
"""Seconds of successive steps from which the time of all of them is told."""

Data = dict[str, Any]


class Unjudged(RuntimeError):
    """There is nothing to hold a run against."""


def measured(task: Task, truth: Data | None, tick: Tick = silent) -> Data:
    """The result of a task, given the result of the task that it takes its truth from."""
    return _KINDS[task.kind](task, truth, tick)


def _truth(task: Task, _: Data | None, tick: Tick) -> Data:
    digits = None if task.value is None else int(task.value)
    return compute(task.scene, task.limits.check, digits=digits, time=task.limits.check_time, tick=tick)


def _floor(task: Task, _: Data | None, __: Tick) -> Data:
    from integrable.motion.conditioning import conditioning

    scene = task.scene
    for digits in (FLOAT_DIGITS, 30):
        begun = perf_counter()
        chosen, motion = _chosen(scene, digits, task.limits.floor_times)
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


def _chosen(scene: Scene, digits: int, most: float) -> tuple[list[Any], Any]:
    """About so many of the scene's times, the last among them, or of an orbit its last step; and what moves there."""
    if scene.steps is None:
        times = scene.times.at(digits)
        return times[:: -max(1, int((len(times) - 1) // most))], None
    last = scene.steps.count

    def motion(system: Any, state: Any, _times: Any) -> Any:
        from integrable.scene.orbit import orbit

        found = orbit(scene.step(system, digits), state, last)
        return found.gamma[-1:], found.M[-1:]

    return [last], motion


def _flow(task: Task, kept: Data | None, tick: Tick) -> Data:
    result, _ = flow_measured(task, kept, tick)
    del result["first"]  # tasks of their own measure that in a fresh process
    return result


def flow_measured(task: Task, kept: Data | None, tick: Tick) -> tuple[Data, Any]:
    """The result of a task of the kind "flow", and the trajectory."""
    scene, digits = task.scene, int(task.value or FLOAT_DIGITS)
    times = scene.times.at(digits)

    def once() -> Timed:
        system, state = scene.start(digits)
        begun = perf_counter()
        flow = system.flow(state, kernel=task.kernel) if scene.rolls_or_spins else system.motion_through(state)
        flow._prepare(times)
        ready = perf_counter()
        trajectory = flow.at(times)
        _ = trajectory.gamma, trajectory.M
        return (ready - begun, perf_counter() - ready), trajectory

    # what imports and compiles, or loads what an earlier run has compiled, counts as the first use
    first = sum(once()[0]) if digits <= FLOAT_DIGITS else None
    result, trajectory = _timed(once, task, tick)
    result |= {"first": first, "way": trajectory.way}
    return result | _truth_of(task, kept).judge(trajectory.gamma, trajectory.M), trajectory


def _backlund(task: Task, kept: Data | None, tick: Tick) -> Data:
    """Successive additions of the pair {±iη}, the H1 flow to second order in η, between the τ of the scene's times;
    of another system steps of its own discretization between the times.

    The τ are those of the truth: the map knows no physical time, and its error is that of the points alone.
    """
    truth = _truth_of(task, kept)
    if truth.tau is None and not task.scene.classical:
        raise Unjudged("not run: the truth is that of an integrator, which knows no τ")
    targets = task.scene.times.floats() if truth.tau is None else [float(t) for t in truth.tau]
    count = int(task.value or 0)

    def once() -> Timed:
        system, state = task.scene.start(FLOAT_DIGITS)
        begun = perf_counter()
        step_of = _classical_step if task.scene.classical else _imaginary_pair
        step_in = step_of(system, state)
        ready = perf_counter()
        now, rows, done = 0.0, [], 0
        for target in targets:
            steps = max(1, round(count * (target - now) / targets[-1])) if target > now else 0
            if steps:
                step = step_in((target - now) / steps)
                for _ in range(steps):
                    state = step(state)
                    done += 1
                    if done == 1:
                        first = perf_counter()  # from here on nothing is imported
                    elif (spent := perf_counter() - first) > TRIAL:
                        _affordable(spent * count / (done - 1), task)
            now = target
            rows.append(state)
        return (ready - begun, perf_counter() - ready), rows

    result, rows = _timed(once, task, tick)
    return result | truth.judge([x.gamma for x in rows], [x.M for x in rows])


def _imaginary_pair(system: Any, state: Any) -> Callable[[float], Any]:
    """h ↦ the addition of {±iη} that is a step of h in τ."""
    a1, a2, a3 = system.a
    scale = (a1 * a2 * a3 * system.integrals(state).H1) ** 0.5
    return lambda h: system.translation(points=[complex(0, scale * h), complex(0, -scale * h)])


def _classical_step(system: Any, _: Any) -> Callable[[float], Any]:
    """h ↦ a step of about h in time of the system's discretization."""
    return lambda h: lambda state: system.step(state, h)


def _comparator(task: Task, kept: Data | None, tick: Tick) -> Data:
    truth = _truth_of(task, kept)
    _affordable(_pilot(task), task)
    return _compared(task, truth, tick)


def _compared(task: Task, truth: Truth, tick: Tick) -> Data:
    """A run of a method, however long it takes."""
    method, scene, value = METHODS[task.method], task.scene, task.value or 0.0
    times = scene.times.at(int(value) if method.parameter == "digits" else FLOAT_DIGITS)
    begin = method.digits(value)

    def once() -> Timed:
        system, state = scene.start(begin)
        begun = perf_counter()
        run = method.prepare(system, state, task.value)
        ready = perf_counter()
        solution = run(times)
        return (ready - begun, perf_counter() - ready), solution

    result, solution = _timed(once, task, tick)
    return result | {"evaluations": solution.evaluations} | truth.judge(solution.gamma, solution.M)


def _tolerance(task: Task, kept: Data | None, tick: Tick) -> Data:
    """DOP853 as a user of SciPy would run it, with one tolerance for everything."""
    system, state = task.scene.start(FLOAT_DIGITS)
    tolerance, times = float(task.value or 0.0), task.scene.times.floats()

    def once() -> Timed:
        begun = perf_counter()
        solution = dop853(system, state, times, rtol=tolerance, atol=tolerance)
        return (perf_counter() - begun,), solution

    dop853(system, state, [min(times, key=abs) or 1e-3], rtol=1e-3, atol=1e-3)  # imports SciPy, outside of the timing
    result, solution = _timed(once, task, tick)
    judged = _truth_of(task, kept).judge(solution.gamma, solution.M)
    return result | {"evaluations": solution.evaluations} | judged


def _growth(task: Task, _: Data | None, __: Tick) -> Data:
    system, state = task.scene.start(FLOAT_DIGITS)
    assert task.scene.report is not None, "the scene has no [report]"
    found = system.flow(state).residual_growth(list(task.scene.report.steps))
    return {"growth": tuple((int(n), float(r)) for n, r in found)}


def _affordable(told: float, task: Task) -> None:
    """TooLong where a whole run would take more seconds than the study allows."""
    allowed = task.limits.run
    if told > allowed:
        raise TooLong(f"not run: a whole run would take about {told:.2g} s, more than the {allowed:g} s of this study")


def _pilot(task: Task) -> float:
    """Seconds that a whole run would take, from short ones, each to four times the time of the one before.

    TooLong where one of these takes longer than a whole run may: a coarse setting that stiff bodies or poles stop, the
    first step of a series of many digits.
    """
    system, state = task.scene.start(FLOAT_DIGITS)
    last, method = max(task.scene.times.floats()), METHODS[task.method]
    run = method.prepare(system, state, task.value)

    def seconds_to(time: float) -> float:
        begun = perf_counter()
        with at_most(max(ENOUGH, task.limits.run)):
            run([time])
        return perf_counter() - begun

    time = min(PILOT * time_scale(system, state), last)
    with at_most(inf if method.compiled else max(FIRST, task.limits.run)):
        run([time])  # imports, and compiles or loads what an earlier run has compiled
    before = seconds = seconds_to(time)
    while time < last and seconds < ENOUGH + before:
        done, before = time, seconds
        time = min(4 * time, last)
        seconds = seconds_to(time)
        if seconds >= ENOUGH + before:  # a real cost, or a hiccup of the machine?
            seconds = min(seconds, seconds_to(time))
    return seconds + max(0.0, seconds - before) / (time - done) * (last - time) if time < last else seconds


def _truth_of(task: Task, kept: Data | None) -> Truth:
    if kept is None:
        raise Unjudged("not run: there is no truth to hold it against")
    return Truth(task.scene, kept)


def _timed(once: Callable[[], Timed], task: Task, tick: Tick) -> tuple[Data, Any]:
    """As :func:`timed`; a run longer than the limits allow is taken for what it is, once."""
    limits = task.limits
    return timed(once, limits.repeat, min(limits.patience, limits.run), partial(tick, task.label))


def _horizon(task: Task, _: Data | None, tick: Tick) -> Data:
    """The state at one time T, in time scales of the motion: the flow as it comes, and the fastest other method whose
    error is at most the flow's or that of rounding the inputs, None where no setting of any is.
    """
    scale = time_scale(*task.scene.start(FLOAT_DIGITS))
    scene = replace(task.scene, times=Times(given=(Fraction((task.value or 1.0) * scale),)))
    task = replace(task, scene=scene, value=None, limits=replace(task.limits, check=0.0))
    truth, floor = _truth(task, None, tick), _floor(task, None, tick)["floor_gamma"]
    flow, judge = _flow(task, truth, tick), _truth_of(task, truth)
    found: Data = {"time": scene.times.floats()[0], "flow": flow, "floor_gamma": floor, "peer": None}
    error = max(flow["error_gamma"], floor)
    for method in sorted(METHODS.values(), key=lambda method: (method.multiprecision, not method.compiled)):
        if method.multiprecision and found["peer"]:
            break  # none of them is the fastest where one in doubles is near enough
        result = _rival(replace(task, method=method.name), judge, error, found["peer"], tick)
        if result is not None:
            found["peer"] = min(found["peer"] or result, result, key=lambda one: float(one["total"]))
    return found


def _rival(task: Task, truth: Truth, error: float, fastest: Data | None, tick: Tick) -> Data | None:
    """A method at its cheapest setting that has at most so large an error; None where it has none, or where even its
    cheapest setting is slower than the fastest so far or than the study allows.

    Settings are tried from the most accurate on, once each. Where steps are too small rounding adds up, and a cheaper
    setting may have the smaller error: the first that misses by little is not the last that is tried.
    """
    method, (system, state) = METHODS[task.method], task.scene.start(FLOAT_DIGITS)
    settings = method.ladder(system, state) if method.takes(system) else []
    if not settings or _cheapest(replace(task, value=settings[0])) > (fastest or {"total": task.limits.run})["total"]:
        return None
    most = min(task.limits.run, MARGIN * fastest["total"]) if fastest else task.limits.run
    once, found, before = replace(task.limits, run=most, repeat=1), None, inf
    for setting in reversed(settings):
        row = replace(task, value=setting, limits=once)
        try:
            _affordable(_pilot(row), row)
            met = _compared(row, truth, tick)["error_gamma"]
        except (JacobianError, ArithmeticError, RuntimeError):
            continue
        if met <= error:
            found = row
        elif met >= min(before, NEAR * error):
            break
        before = met
    if found is None:
        return None
    # it has run: another trial might refuse it on a busy machine, and with it the flow's own figures
    result = _compared(replace(found, limits=task.limits), truth, tick)
    return result | {"method": method.name, "setting": f"{method.parameter} {found.value:.3g}"}


def _cheapest(task: Task) -> float:
    """Seconds of a whole run as short ones tell them; 0 where those fail, as they may where a whole one does not."""
    try:
        return _pilot(task)
    except (JacobianError, ArithmeticError, RuntimeError):
        return 0.0


def _orbit(task: Task, _: Data | None, __: Tick) -> Data:
    from integrable.study.orbits import measure_orbit

    report = measure_orbit(task.scene, task.scene.digits, silent).report
    assert report is not None, "an orbit that is measured has a report"
    found = report.as_dict()
    for one in found["rows"]:
        del one["growth"]  # one pair for each step: `integrable run` shows it
    return found


_KINDS: dict[str, Callable[[Task, Data | None, Tick], Data]] = {
    "truth": _truth,
    "floor": _floor,
    "flow": _flow,
    "first use": lambda task, _, __: first_use(task.source),
    "compile": lambda task, _, __: compilation(task.source, task.method),
    "backlund": _backlund,
    "comparator": _comparator,
    "tolerance": _tolerance,
    "growth": _growth,
    "left out": lambda task, _, __: left_out(task.source),
    "horizon": _horizon,
    "additions": lambda task, _, __: near_additions(task.scene),
    "orbit": _orbit,
}
