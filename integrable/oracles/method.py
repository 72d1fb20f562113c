"""The interface of integrators. They are built for a kind of system, started at a state, and evaluated at times.

    class Euler(Method):
        def build(self, kind, setting):                             # once a machine: compilation
            def of_system(system):                                  # once a system: its coefficients
                rates = kind.right_hand_side(kind.coefficients_of(system.constants))

                def started(start):                                 # once a start
                    def advance(y, h, _):
                        return [v + h * k for v, k in zip(y, rates(y), strict=True)], None, 1

                    return lambda times: follow(advance, start, times, setting)

                return started

            return of_system

    METHODS["Euler"] = Euler("Euler", "Euler (1768)", "step", (0.01, 0.001), order=1)

Every part is timed separately (:class:`Spent`). One rule holds for all methods and compilers: work that depends on
neither body nor start is not part of a start's cost.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from numbers import Real
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from integrable.extras import command, installed
from integrable.oracles.body import Solution, body_equations, is_body
from integrable.oracles.expressions import Kind, recorded
from jacobian.errors import ArgumentError, shown

__all__ = ["Given", "Method", "Problem", "Spent", "problem_of", "time_scale", "timed_run"]

Run = Callable[[Iterable[Any]], Solution]
"""A function times ↦ Solution. The times may have any order and sign; the start is at time 0."""


class Given(NamedTuple):
    """The data of a system for an integrator: the constants of the system, and a conversion to its number type."""

    constants: tuple[Any, ...]
    number: Callable[[Any], Any]
    context: Any = None
    """mpmath's context for numbers with more digits than a float."""


Started = Callable[[Sequence[Any]], Run]
"""A function from a start to its Run."""
Built = Callable[[Given], Started]
"""A function from a system to its Started."""
DOUBLE_DIGITS = 15


class Problem(NamedTuple):
    """A motion to integrate: equations, constants and start, (γ, M) or (q, p)."""

    kind: Kind
    system: Given
    start: tuple[Any, ...]


class Spent(NamedTuple):
    """Seconds of one run, in parts: work done once per machine, once per system and once per start, and evaluation."""

    machine: float
    """The seconds of work done once a machine, which depends on no body and no start: mainly compilation."""
    system: float
    """The seconds of work done once a system, which serves all starts of a body."""
    start: float
    """The seconds of work done once a start."""
    evaluation: float

    @property
    def counted(self) -> float:
        """The run time that comparisons use: the sum of ``start`` and ``evaluation``."""
        return self.start + self.evaluation

    @property
    def first(self) -> float:
        """The seconds until the first result: the sum of all parts."""
        return sum(self)


@dataclass(frozen=True)
class Method(ABC):
    """One integrator.

    ``parameter`` names the meaning of a setting: "step" (a time), "tolerance" or "digits". ``settings`` are sensible
    values, cheapest first; steps are in units of the motion's own time scale (:meth:`ladder`).
    """

    name: str
    source: str
    parameter: str
    settings: tuple[float, ...]
    kinds: tuple[str, ...] = ()
    """The kinds of systems that it accepts, such as "ball" and "top"; empty: every kind."""
    module: str = ""
    extra: str = ""
    """``module`` is the library that the method imports, and ``extra`` the extra of this package that installs it."""
    compiled: bool = False
    """Whether a compiler is part of :meth:`build`."""
    order: int | None = None
    """The order of convergence, for a fixed step."""
    guard: int = 0
    """The extra digits of its numbers beyond doubles, where the setting is not a number of digits."""

    @abstractmethod
    def build(self, kind: Kind, setting: Any) -> Built:
        """The code for all systems of a kind; all compilation happens here."""

    def digits(self, setting: float) -> int:
        """The number of digits of a run's start values at a setting; 15 for doubles."""
        return (int(setting) if self.parameter == "digits" else DOUBLE_DIGITS) + self.guard

    @property
    def in_doubles(self) -> bool:
        """Whether the method computes in doubles rather than in a higher precision."""
        return self.parameter != "digits" and not self.guard

    @property
    def multiprecision(self) -> bool:
        """Whether the method integrates in mpf, where a step takes hundreds of times as long as in doubles."""
        return self.parameter == "digits" and not self.module

    @property
    def installed(self) -> bool:
        """Whether the libraries of the method are installed."""
        return not self.module or installed(self.module)

    def refusal(self, system: Any) -> str | None:
        """The reason why the method refuses a system, or None."""
        name = kind_name(system)
        if self.kinds and name not in self.kinds:
            if self.kinds == ("top",) and name == "ball":
                return f"d = {system.d}: {self.name} is for the Euler top, d = 0"
            return f"{self.name} is for the {' and the '.join(self.kinds)}: {system!r} has other equations"
        if not self.installed:
            return f"{self.name} needs {self.module}: {command(self.extra)}"
        return None

    def takes(self, system: Any) -> bool:
        """Whether the method is installed and integrates this system."""
        return self.refusal(system) is None

    def prepare(self, system: Any, state: Any, setting: Any) -> Run:
        """A function times ↦ Solution for one start, which may be called repeatedly. Built code is cached.

        Raises ArgumentError where the method refuses the system or the setting.
        """
        refusal = self.refusal(system)
        if refusal:
            raise ArgumentError(refusal)
        if not isinstance(setting, Real) or not float(setting) > 0:
            raise ArgumentError(f"{self.parameter} = {shown(setting)}: give a positive {self.parameter}")
        kind, given, start = problem_of(system, state)
        built, _ = _kept(self, kind, setting)
        return built(given)(start)

    def solve(self, system: Any, state: Any, times: Iterable[Any], setting: Any) -> Solution:
        """γ and M at ``times``, each of shape (N, 3); for other systems q and p, each of shape (N, n).

        ``state`` is the state at time 0; times may be in any order and of either sign. An integrator that fails raises
        PrecisionLoss (the equations of a step have no solution) or RuntimeError (the message is SciPy's or heyoka's).
        No integrator detects an error that is merely large.
        """
        return self.prepare(system, state, setting)(times)

    def ladder(self, system: Any, state: Any) -> list[float]:
        """The settings for one start: steps are multiplied by its time scale, 1/max(|γ̇|, |Ṁ|/|M|) at time 0."""
        if self.parameter != "step":
            return list(self.settings)
        scale = time_scale(system, state)
        return [scale * x for x in self.settings]


_KEPT: dict[tuple[Method, str, Any], tuple[Built, float]] = {}


def _kept(method: Method, kind: Kind, setting: Any) -> tuple[Built, float]:
    """The built code of a method for a kind, and the seconds that building took in this process.

    The seconds are the maximum over all settings: code that serves all settings is compiled for the first of them.
    """
    key = (method, kind.key, setting)
    if key not in _KEPT:
        begun = perf_counter()
        built = method.build(kind, setting)
        _KEPT[key] = built, perf_counter() - begun
    return _KEPT[key][0], max(taken for other, (_, taken) in _KEPT.items() if other[:2] == key[:2])


def timed_run(method: Method, problem: Problem, times: Iterable[Any], setting: Any) -> tuple[Spent, Solution]:
    """Runs a method on a problem; returns the seconds of the run's parts, and the solution.

    The part spent once per machine is the longest time that building the method for this kind took in this process.
    """
    kind, system, start = problem
    built, machine = _kept(method, kind, setting)
    clock = [perf_counter()]

    def done(part: Any) -> Any:
        clock.append(perf_counter())
        return part

    started = done(built(system))
    run = done(started(start))
    solution = done(run(times))
    return Spent(machine, *(after - before for before, after in pairwise(clock))), solution


def kind_name(system: Any) -> str:
    """The name of a system's kind: "ball", "top" (d = 0), or the class name of a system with other equations."""
    if is_body(system):
        return "ball" if float(system.d) else "top"
    return type(getattr(system, "system", system)).__name__


def problem_of(system: Any, state: Any) -> Problem:
    """The problem of integrating a system from a state.

    The system is a body, whose equations this folder contains, or has a method ``rates_in`` that takes any numbers.
    """
    # a state over RR has NumPy's floats, which tolist turns into Python's
    start = tuple(np.hstack([state.gamma, state.M]).tolist())
    field = getattr(system, "field", None)
    number = float if field is None else field.coerce
    given: tuple[Any, ...] = ()
    if is_body(system):
        given = (*map(number, system.inertia), *([number(system.d)] if float(system.d) else []))
        start = tuple(map(number, start))

    def of_body(numbers: Any, y: Sequence[Any]) -> list[Any]:
        moments = [numbers.constant(x) for x in given]
        return body_equations(moments[:3], moments[3] if len(given) > 3 else 0)(y)

    kind, constants = recorded(kind_name(system), of_body if given else system.rates_in, start)
    return Problem(kind, Given(given or constants, number, getattr(field, "context", None)), start)


def time_scale(system: Any, state: Any) -> float:
    """The time in which γ or M turns by about a radian: 1/max(|γ̇|, |Ṁ|/|M|) at a state, or 1 at rest."""
    kind, given, start = problem_of(system, state)
    y = [float(x) for x in start]
    rates = kind.right_hand_side(kind.coefficients_of(given.constants))(y)
    half = len(y) // 2
    size = sum(m * m for m in y[half:]) ** 0.5
    rate = max(
        sum(x * x for x in rates[:half]) ** 0.5,
        sum(x * x for x in rates[half:]) ** 0.5 / size if size else 0.0,
    )
    return 1 / rate if rate else 1.0
