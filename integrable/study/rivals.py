"""Comparison of the flow with the fastest other method that is accurate enough, at one time or all times of a scene.

Each method is first run once at each of its settings. The flow and the methods of similar run time then run in turn, so
their ratio is measured in one process on one machine. Run times include set-up and evaluation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from math import inf
from time import perf_counter
from typing import Any

from integrable.oracles.method import Method, Problem, Spent, problem_of, timed_run
from integrable.oracles.methods import METHODS, time_scale
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene, Times
from integrable.study.plan import STRONG, Task
from integrable.study.timing import Tick, Timed, TooLong, at_most, interleaved
from integrable.study.truth import Truth
from jacobian.errors import JacobianError

__all__ = ["affordable", "at_one_time", "at_times", "first_use", "flow_once", "method_once", "pilot", "standing"]

PILOT = 2.0**-7
"""The length of an integrator's first trial, in time scales of the motion; trials predict the run time of a whole run.
"""
ENOUGH = 0.1
"""Each trial is four times as long as the one before, until a trial takes this many seconds or is the whole run."""
FIRST = 15.0
"""Seconds that the first trial of a method may take, imports included."""
NEAR = 30.0
"""Where the error of a setting exceeds this multiple of the allowed error, more than accumulated rounding is its cause,
and cheaper settings are not tried.
"""
MARGIN, CLOCK = 2.0, 0.01
"""A run that takes more than MARGIN times as long as the fastest so far, and more than CLOCK seconds, is not timed
again. The time of a single shorter run is too uncertain.
"""

Data = dict[str, Any]


def flow_once(scene: Scene, digits: int, kernel: str, apart: bool = False) -> Callable[[], Timed]:
    """A function that runs the flow with a new system and a new start, at the scene's times.

    The set-up of the start is timed together with the evaluation, as users run it. With ``apart`` the set-up is timed
    separately; the flow then processes the times twice.
    """
    times = scene.times.at(digits)

    def once() -> Timed:
        begun = perf_counter()
        system, state = scene.start(digits)
        made = perf_counter()
        flow = system.flow(state, kernel=kernel) if scene.rolls_or_spins else system.motion_through(state)
        if apart:
            flow._prepare()
        ready = perf_counter()
        trajectory = flow.at(times)
        _ = trajectory.gamma, trajectory.M
        return Spent(0.0, made - begun, ready - made, perf_counter() - ready), trajectory

    return once


_KEPT: dict[tuple[str, str], tuple[float, float]] = {}


def first_use(task: Task) -> tuple[float, float]:
    """Two times of the flow in floats: the seconds spent once per machine for a kind of system, and those until the
    first answer.

    Both are measured at the flow's first use in this process, as for the other methods. They include imports, and
    compiling or loading compiled code.
    """
    begun = perf_counter()
    if task.kernel == "auto":  # another kernel uses no series
        _compile_walks(task.scene)
    compiled, key = perf_counter() - begun, (task.scene.system, task.kernel)
    if key not in _KEPT:
        once = flow_once(task.scene, FLOAT_DIGITS, task.kernel)
        (first, _), (second, _) = once(), once()
        _KEPT[key] = compiled + max(0.0, first.first - second.first), compiled + first.counted
    return _KEPT[key]


def _compile_walks(scene: Scene) -> None:
    """Compiles, or loads from disk, the Taylor series that systems of this kind use for times near the start. The flow
    compiles each of them by itself only when it is needed.
    """
    from integrable.motion.near import NearWalk
    from integrable.series.steps import steps_for

    system, state = scene.start(FLOAT_DIGITS)
    if not scene.classical:
        first = next(system.motion_through(state)._ways())
        if isinstance(first, NearWalk):
            first.compile()
    elif kind := system.system._kind:
        for steps in steps_for(None):
            kind.walk(steps.orders)


def method_once(scene: Scene, method: Method, value: float) -> tuple[Problem, Callable[[], Timed]]:
    """The problem that a scene poses to a method, and a function that runs the method on it."""
    times = scene.times.at(int(value) if method.parameter == "digits" else FLOAT_DIGITS)
    problem = problem_of(*scene.start(method.digits(value)))
    return problem, lambda: timed_run(method, problem, times, value)


def at_times(scene: Scene, times: Iterable[Any]) -> Scene:
    """The scene with its times replaced by ``times``."""
    return replace(scene, times=Times(given=tuple(map(Fraction, times))))


def at_one_time(task: Task) -> Task:
    """The task at the single time that its setting gives, in time scales of the motion."""
    scale = time_scale(*task.scene.start(FLOAT_DIGITS))
    return replace(
        task,
        scene=at_times(task.scene, [(task.value or 1.0) * scale]),
        value=None,
        limits=replace(task.limits, check=0.0),
    )


def standing(task: Task, truth: Truth, floor: float, tick: Tick) -> Data:
    """The comparison of the flow with other methods, with the keys "flow", "floor_gamma", "peer", "tried" and "strong".

    "peer" is the fastest other method whose error is at most max(flow's error, ``floor``), or None. "tried" has the
    most accurate run of each method, or the reason why there is none. "strong" has the names in
    :data:`~integrable.study.plan.STRONG`.
    """
    limits = task.limits
    flow = flow_once(task.scene, FLOAT_DIGITS, task.kernel)
    machine, _ = first_use(task)
    _, trajectory = flow()
    own = truth.judge(trajectory.gamma, trajectory.M)
    error = max(own["error_gamma"], floor)
    found: dict[str, tuple[float, float]] = {}
    tried: dict[str, Data] = {}
    system, _ = task.scene.start(FLOAT_DIGITS)
    # methods of many digits are never the fastest where a method in doubles is accurate enough
    for method in sorted(METHODS.values(), key=lambda method: (method.multiprecision, not method.compiled)):
        if not method.takes(system) or (method.multiprecision and found):
            continue
        fastest = min((seconds for _, seconds in found.values()), default=inf)
        chosen, tried[method.name] = near_enough(replace(task, method=method.name), truth, error, fastest)
        if chosen is not None:
            found[method.name] = chosen
    fastest = min((seconds for _, seconds in found.values()), default=inf)
    near = {name: value for name, (value, seconds) in found.items() if seconds <= max(MARGIN * fastest, CLOCK)}
    runs = {name: method_once(task.scene, METHODS[name], value)[1] for name, value in near.items()}
    timings = interleaved({"": flow, **runs}, limits.repeat, limits.patience, lambda: tick(task.label))
    mine = {**timings[""].as_dict(), **own, "way": trajectory.way, "machine": machine}
    peers = []
    for name, value in near.items():
        solution, method = timings[name].found, METHODS[name]
        setting = {"method": name, "setting": f"{method.parameter} {value:.3g}"}
        peers.append({**timings[name].as_dict(), **truth.errors(solution.gamma, solution.M), **setting})
    peer = min(peers, key=lambda one: float(one["total"]), default=None)
    return {"flow": mine, "floor_gamma": floor, "peer": peer, "tried": tried, "strong": list(STRONG)}


def near_enough(task: Task, truth: Truth, error: float, fastest: float) -> tuple[tuple[float, float] | None, Data]:
    """A method's cheapest setting with at most the given error, with the seconds of a run, and a record of the search.

    The setting is None if none is accurate enough, or if even the cheapest takes too long: longer than the study
    allows, or MARGIN times the fastest method so far. Settings are tried once each, the most accurate first. Rounding
    accumulates over very small steps, so a near miss does not end the search: a cheaper setting may be more accurate.
    """
    method = METHODS[task.method]
    settings = method.ladder(*task.scene.start(FLOAT_DIGITS))
    allowed = min(task.limits.run, max(MARGIN * fastest, CLOCK))
    with suppress(JacobianError, ArithmeticError, RuntimeError):  # where a trial fails, the whole run may succeed
        if pilot(replace(task, value=settings[0])) > allowed:
            return None, {"slower": allowed}
    row, found, before = replace(task, limits=replace(task.limits, run=allowed)), None, inf
    told: Data = {}
    for setting in reversed(settings):
        try:
            affordable(pilot(replace(row, value=setting)), row)
            spent, solution = method_once(task.scene, method, setting)[1]()
            met = truth.errors(solution.gamma, solution.M)["error_gamma"]
        except TooLong:
            told = told or {"slower": allowed}
            continue
        except (JacobianError, ArithmeticError, RuntimeError) as problem:
            told = told or {"refused": " ".join(f"{type(problem).__name__}: {problem}".split())}
            continue
        if "error_gamma" not in told or met < told["error_gamma"]:
            told = {"setting": setting, "error_gamma": met, "total": spent.counted}
        if met <= error:
            found = setting, spent.counted
        elif met >= min(before, NEAR * error):
            break
        before = met
    return found, told


def affordable(told: float, task: Task) -> None:
    """Raises TooLong if a whole run, of about ``told`` seconds, would take longer than the study allows."""
    if told > task.limits.run:
        more = f"more than the {task.limits.run:.2g} s of this study"
        raise TooLong(f"not run: a whole run would take about {told:.2g} s, {more}")


def pilot(task: Task) -> float:
    """The seconds of a whole run, estimated from trials, each over four times the time span of the previous one.

    Raises TooLong if a trial takes longer than a whole run may. This happens to coarse settings if the body is stiff or
    a pole is near, and in the first step of a series with many digits.
    """
    system, state = task.scene.start(FLOAT_DIGITS)
    last, method = max(task.scene.times.floats()), METHODS[task.method]
    first = inf if method.compiled else max(FIRST, task.limits.run)
    with at_most(first):
        run = method.prepare(system, state, task.value)

    def seconds_to(time: float) -> float:
        begun = perf_counter()
        with at_most(max(ENOUGH, task.limits.run)):
            run([time])
        return perf_counter() - begun

    time = min(PILOT * time_scale(system, state), last)
    with at_most(first):
        run([time])
    before = seconds = seconds_to(time)
    while time < last and seconds < ENOUGH + before:
        done, before = time, seconds
        time = min(4 * time, last)
        seconds = seconds_to(time)
        if seconds >= ENOUGH + before:  # run again: other work on the machine may have delayed this run
            seconds = min(seconds, seconds_to(time))
    return seconds + max(0.0, seconds - before) / (time - done) * (last - time) if time < last else seconds
