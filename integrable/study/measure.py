"""Measures one task, according to its kind. The result is plain data for JSON. If a task cannot be measured, an
exception is raised, whose message stands in the task's row of the report.

Run times are medians of ``time.perf_counter``, split as :class:`integrable.oracles.method.Spent` defines; "total" is
the time of set-up and evaluation. Every run starts from a new system and state. ``tick(label)`` is called between the
pieces of a task.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from time import perf_counter
from typing import Any

from integrable.oracles.method import Spent
from integrable.oracles.methods import METHODS
from integrable.oracles.reference import dop853
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.study.fresh import first_answer
from integrable.study.plan import Task
from integrable.study.rivals import affordable, at_one_time, first_use, flow_once, method_once, pilot, standing
from integrable.study.timing import Tick, Timed, Timing, TooLong, at_most, interleaved, silent
from integrable.study.truth import Truth, compute
from jacobian.errors import JacobianError

__all__ = ["Unjudged", "flow_run", "measured"]

TRIAL = 0.5
"""The time of all steps is extrapolated from steps that take this many seconds."""

Data = dict[str, Any]


class Unjudged(RuntimeError):
    """Raised where a run cannot be judged, because no truth exists to compare its states with."""


def measured(task: Task, truth: Data | None, tick: Tick = silent) -> Data:
    """The result of a task, given the result of the task that computed its truth."""
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
            break
        except (JacobianError, ArithmeticError):
            if digits > FLOAT_DIGITS:
                raise
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
    """The times and the function that ``conditioning`` takes.

    A motion is judged at about ``most`` of the scene's times, including the last one, and the function is None. An
    orbit is judged at its last step, and the function computes the orbit.
    """
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
    result, found = flow_run(task, tick)
    del result["first"]  # this time is nearly the sum of "machine" and "total"
    return result | _truth_of(task, kept).judge(found.gamma, found.M)


def flow_run(task: Task, tick: Tick) -> tuple[Data, Any]:
    """The result of a task of the kind "flow" without its errors, and the trajectory."""
    digits = int(task.value or FLOAT_DIGITS)
    machine, first = first_use(task) if digits <= FLOAT_DIGITS else (0.0, None)
    result, trajectory = _timed(flow_once(task.scene, digits, task.kernel, apart=True), task, tick)
    result["machine"] = machine
    return result | {"first": first, "way": trajectory.way}, trajectory


def _backlund(task: Task, kept: Data | None, tick: Tick) -> Data:
    """The result of a flow approximated by a number of Bäcklund maps.

    For a ball or top each map is the addition of the two points with x = ±iη, which advances τ by a multiple of η up to
    terms of third order. The maps lead from each τ of the scene's times to the next. These τ come from the truth, as
    the map has no physical time. Other systems move by steps of their own discretization, in physical time.
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
                        first = perf_counter()  # all imports are done by now
                    elif (spent := perf_counter() - first) > TRIAL:
                        affordable(spent * count / (done - 1), task)
            now = target
            rows.append(state)
        return Spent(0.0, 0.0, ready - begun, perf_counter() - ready), rows

    result, rows = _timed(once, task, tick)
    return result | truth.judge(*zip(*(x.vectors for x in rows), strict=True))


def _imaginary_pair(system: Any, state: Any) -> Callable[[float], Any]:
    """A function from h to the addition of the points with x = ±iη, where η = h·√(a₁a₂a₃H1) advances τ by h."""
    a1, a2, a3 = system.a
    scale = (a1 * a2 * a3 * system.integrals(state).H1) ** 0.5
    return lambda h: system.translation(points=[complex(0, scale * h), complex(0, -scale * h)])


def _classical_step(system: Any, _: Any) -> Callable[[float], Any]:
    """A function from h to the step of the system's discretization that advances time by about h."""
    return lambda h: lambda state: system.step(state, h)


def _comparator(task: Task, kept: Data | None, tick: Tick) -> Data:
    truth = _truth_of(task, kept)
    affordable(pilot(task), task)
    _, once = method_once(task.scene, METHODS[task.method], task.value or 0.0)
    runs, flow = {"": once}, flow_once(task.scene, FLOAT_DIGITS, task.kernel)
    # a flow that refuses the motion, or takes long, is reported in its own row
    with suppress(JacobianError, ArithmeticError, TooLong), at_most(task.limits.run):
        flow()
        runs["flow"] = flow
    timings = _in_turn(runs, task, tick)
    result, solution = timings[""].as_dict(), timings[""].found
    # the flow is timed in turn with this method, so that the machine's state at other times does not matter
    result |= {"flow": timings["flow"].total} if "flow" in timings else {}
    return result | {"evaluations": solution.evaluations} | truth.judge(solution.gamma, solution.M)


def _tolerance(task: Task, kept: Data | None, tick: Tick) -> Data:
    """The result of DOP853 as a user of SciPy would run it, with one tolerance for all components."""
    system, state = task.scene.start(FLOAT_DIGITS)
    tolerance, times = float(task.value or 0.0), task.scene.times.floats()

    def once() -> Timed:
        begun = perf_counter()
        solution = dop853(system, state, times, rtol=tolerance, atol=tolerance)
        return Spent(0.0, 0.0, 0.0, perf_counter() - begun), solution

    dop853(system, state, [min(times, key=abs) or 1e-3], rtol=1e-3, atol=1e-3)  # imports SciPy, outside of the timing
    result, solution = _timed(once, task, tick)
    del result["setup"], result["evaluation"]  # SciPy's call does not separate them
    judged = _truth_of(task, kept).judge(solution.gamma, solution.M)
    return result | {"evaluations": solution.evaluations} | judged


def _growth(task: Task, _: Data | None, __: Tick) -> Data:
    system, state = task.scene.start(FLOAT_DIGITS)
    assert task.scene.report is not None, "the scene has no [report]"
    found = system.flow(state).residual_growth(list(task.scene.report.steps))
    return {"growth": tuple((int(n), float(r)) for n, r in found)}


def _truth_of(task: Task, kept: Data | None) -> Truth:
    if kept is None:
        raise Unjudged("not run: there is no truth to hold it against")
    return Truth(task.scene, kept)


def _timed(once: Callable[[], Timed], task: Task, tick: Tick) -> tuple[Data, Any]:
    timing = _in_turn({"": once}, task, tick)[""]
    return timing.as_dict(), timing.found


def _in_turn(runs: dict[str, Callable[[], Timed]], task: Task, tick: Tick) -> dict[str, Timing]:
    """The run times of several functions, each called repeatedly and in turn. A run longer than the limits allow is
    not repeated.
    """
    limits = task.limits
    return interleaved(runs, limits.repeat, min(limits.patience, limits.run), partial(tick, task.label))


def _horizon(task: Task, kept: Data | None, tick: Tick) -> Data:
    """The comparison of the flow with the fastest other method that is accurate enough.

    The comparison is made at one time T, or at all times of the scene.
    """
    if task.value is None:
        truth = _truth_of(task, kept)
    else:
        task = at_one_time(task)
        truth = Truth(task.scene, _truth(task, None, tick))
    found = standing(task, truth, _floor(task, None, tick)["floor_gamma"], tick)
    return {"time": max(task.scene.times.floats()), **found}


def _orbit(task: Task, _: Data | None, __: Tick) -> Data:
    from integrable.study.orbits import measure_orbit

    report = measure_orbit(task.scene, task.scene.digits, silent).report
    assert report is not None, "an orbit that is measured has a report"
    found = report.as_dict()
    for one in found["rows"]:
        del one["growth"]  # a pair for each step, which only `integrable run` shows
    return found


_KINDS: dict[str, Callable[[Task, Data | None, Tick], Data]] = {
    "truth": _truth,
    "floor": _floor,
    "flow": _flow,
    "first answer": lambda task, _, __: first_answer(task.source, task.method),
    "backlund": _backlund,
    "comparator": _comparator,
    "tolerance": _tolerance,
    "growth": _growth,
    "horizon": _horizon,
    "orbit": _orbit,
}
