"""Published integrators and discretizations to stand beside the divisor flow, behind one interface: :data:`METHODS`.

    METHODS["Gauss-Legendre 6"].solve(system, state, times, 0.1)     # Solution(gamma, M, evaluations)

Every :class:`Method` says which systems it takes, what its one setting means (a step, a tolerance, a number of digits),
and what has to be installed; ``prepare`` keeps its set-up (compilation included) apart from the run. A system is an
object of :mod:`integrable.systems`: a body with ``inertia`` and ``d`` (ball, top), or one with a ``vector_field`` alone
(the deformations) or with ``rates_in`` any numbers (those of :mod:`integrable.classical`). Nothing of
:mod:`jacobian`'s arithmetic is used.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from integrable.extras import command, installed
from integrable.oracles.collocation import collocation
from integrable.oracles.discrete_tops import hirota_kimura, moser_veselov
from integrable.oracles.reference import Solution, equations, is_body, odefun, scipy_solution, taylor
from integrable.oracles.stepping import Advance, follow
from jacobian.errors import ArgumentError

__all__ = ["METHODS", "Method", "time_scale"]

Run = Callable[[Iterable[Any]], Solution]
Prepare = Callable[[Any, Any, Any], Run]

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 3e-14)
DOUBLE_DIGITS = 15
STEPS = (0.5, 0.25, 0.12, 0.06, 0.03, 0.015)
"""In units of the time scale of :meth:`Method.ladder`."""


@dataclass(frozen=True)
class Method:
    """One integrator.

    ``parameter`` is what the setting means: "step" (a time), "tolerance" or "digits"; ``settings`` are sensible values,
    cheapest first, steps in units of the motion's own time scale (:meth:`ladder`). ``only``: "any" system, "formulas"
    (a body, or a system that gives its equations in any numbers), "body" (ball or top) or "top" (d = 0). ``number``:
    "float", or "any" for methods that also run in the mpf of a system over MP(digits). ``compiled``: numba compiles at
    first use and keeps the result on disk.
    """

    name: str
    source: str
    parameter: str
    settings: tuple[float, ...]
    prepare_run: Prepare
    only: str = "any"
    number: str = "float"
    module: str = ""
    extra: str = ""
    """The module that is imported, and the optional dependency of this package that installs it."""
    compiled: bool = False
    order: int | None = None
    """Of convergence, for a fixed step."""
    guard: int = 0
    """Digits that its numbers hold beyond doubles, where the setting is no number of digits."""

    def digits(self, setting: float) -> int:
        """Digits of the numbers that a run at that setting starts from, 15 for doubles."""
        return (int(setting) if self.parameter == "digits" else DOUBLE_DIGITS) + self.guard

    @property
    def in_doubles(self) -> bool:
        """Whether it computes in doubles, and not in numbers of more digits."""
        return self.parameter != "digits" and not self.guard

    @property
    def multiprecision(self) -> bool:
        """Whether it integrates in mpf: a step takes hundreds of times as long as in doubles."""
        return self.parameter == "digits" and not self.module

    @property
    def installed(self) -> bool:
        """Whether what it needs is installed."""
        return not self.module or installed(self.module)

    def refusal(self, system: Any) -> str | None:
        """Why the method does not take a system, or None."""
        if self.only != "any" and not (is_body(system) or (self.only == "formulas" and hasattr(system, "rates_in"))):
            return f"{self.name} is for the ball and the top: {system!r} has other equations"
        if self.only == "top" and system.d:
            return f"d = {system.d}: {self.name} is for the Euler top, d = 0"
        if not self.installed:
            return f"{self.name} needs {self.module}: {command(self.extra)}"
        return None

    def takes(self, system: Any) -> bool:
        """Whether the method is installed and integrates this system."""
        return self.refusal(system) is None

    def prepare(self, system: Any, state: Any, setting: Any) -> Run:
        """The set-up for one start: a function times ↦ Solution that may be called again.

        ArgumentError where the system or the setting is refused.
        """
        refusal = self.refusal(system)
        if refusal:
            raise ArgumentError(refusal)
        if not setting > 0:
            raise ArgumentError(f"{self.parameter} = {setting}: give a positive {self.parameter}")
        return self.prepare_run(system, state, setting)

    def solve(self, system: Any, state: Any, times: Iterable[Any], setting: Any) -> Solution:
        """γ and M at ``times``, any order and either sign, the state being at time 0: shapes (N, 3), of other systems q
        and p of shape (N, n).

        What an integrator cannot do it says: PrecisionLoss (a step whose equations have no solution) or RuntimeError
        (SciPy's and heyoka's own message). An error that is merely large is not noticed by any of them.
        """
        return self.prepare(system, state, setting)(times)

    def ladder(self, system: Any, state: Any) -> list[float]:
        """``settings`` for one start: steps are multiplied by its time scale, 1/max(|γ̇|, |Ṁ|/|M|) at time 0."""
        if self.parameter != "step":
            return list(self.settings)
        scale = time_scale(system, state)
        return [scale * x for x in self.settings]


def time_scale(system: Any, state: Any) -> float:
    """1/max(|γ̇|, |Ṁ|/|M|) at a state, 1 where nothing moves: the time in which γ or M turns by about a radian."""
    rates = [float(x) for x in equations(system, state)([*state.gamma, *state.M])]
    size = sum(float(m) ** 2 for m in state.M) ** 0.5
    half = len(state.gamma)
    rate = max(
        sum(x * x for x in rates[:half]) ** 0.5,
        sum(x * x for x in rates[half:]) ** 0.5 / size if size else 0.0,
    )
    return 1 / rate if rate else 1.0


def _scipy(method: str) -> Prepare:
    def prepare(system: Any, state: Any, tolerance: Any) -> Run:
        import scipy.integrate  # noqa: F401  # belongs to the set-up

        relative = float(tolerance)
        size = sum(float(m) ** 2 for m in state.M) ** 0.5 or 1.0
        absolute = [relative] * len(state.gamma) + [relative * size] * len(state.M)
        return lambda times: scipy_solution(system, state, times, method=method, rtol=relative, atol=absolute)

    return prepare


def _fixed(make: Callable[[Any, Any], Advance]) -> Prepare:
    """A fixed-step method in plain Python, in the numbers of the system's field."""

    def prepare(system: Any, state: Any, step: Any) -> Run:
        field, advance = system.field, make(system, state)
        start, h = [*state.gamma, *state.M], field.coerce(step, "step")
        return lambda times: follow(advance, start, [field.coerce(t, "times") for t in times], h)

    return prepare


def _gauss16(parameter: str) -> Prepare:
    def prepare(system: Any, state: Any, setting: Any) -> Run:
        if not is_body(system):
            return _fixed(lambda system, state: collocation(system, state, 8))(system, state, setting)
        from integrable.oracles.gauss16 import gauss16

        return lambda times: gauss16(system, state, times, **{parameter: float(setting)})

    return prepare


def _taylor() -> Prepare:
    def prepare(system: Any, state: Any, tolerance: Any) -> Run:
        from integrable.oracles.taylor_compiled import compiled_taylor

        return lambda times: compiled_taylor(system, state, times, tolerance=float(tolerance))

    return prepare


def _heyoka(extended: bool) -> Prepare:
    def prepare(system: Any, state: Any, tolerance: Any) -> Run:
        from integrable.oracles.heyoka_taylor import heyoka_run

        return heyoka_run(system, state, float(tolerance), extended=extended)

    return prepare


def _elliptic(system: Any, state: Any, digits: Any) -> Run:
    from integrable.oracles.elliptic_top import EllipticTop

    return EllipticTop(system, state, int(digits)).at


def _multiprecision(integrate: Callable[..., Solution]) -> Prepare:
    return lambda system, state, digits: lambda times: integrate(system, state, times, digits=int(digits))


def _moments(system: Any) -> list[Any]:
    return [system.field.coerce(x) for x in system.inertia]


_TABLE = (
    Method(
        "SciPy DOP853", "Hairer, Nørsett & Wanner (1993)", "tolerance", TOLERANCES, _scipy("DOP853"),
        module="scipy", extra="app",
    ),
    Method(
        "SciPy LSODA", "Hindmarsh & Petzold (1983)", "tolerance", TOLERANCES[:-1], _scipy("LSODA"),
        module="scipy", extra="app",
    ),
    Method(
        "SciPy Radau", "Hairer & Wanner (1996)", "tolerance", TOLERANCES[:-2], _scipy("Radau"),
        module="scipy", extra="app",
    ),
    Method(
        "implicit midpoint", "Gauss collocation, one stage", "step", STEPS,
        _fixed(lambda system, state: collocation(system, state, 1)), number="any", order=2,
    ),
    Method(
        "Gauss-Legendre 6", "Kuntzmann (1961), Butcher (1964), three stages", "step", STEPS,
        _fixed(lambda system, state: collocation(system, state, 3)), number="any", order=6,
    ),
    Method(
        "Moser-Veselov", "Moser & Veselov (1991)", "step", STEPS,
        _fixed(lambda system, _: moser_veselov(_moments(system))), only="top", number="any", order=2,
    ),
    Method(
        "Moser-Veselov, order 4", "Hairer & Vilmart (2006)", "step", STEPS,
        _fixed(lambda system, _: moser_veselov(_moments(system), 4)), only="top", number="any", order=4,
    ),
    Method(
        "Hirota-Kimura", "Hirota & Kimura (2000), γ by Kahan's rule (1993)", "step", STEPS,
        _fixed(lambda system, _: hirota_kimura(_moments(system))), only="top", number="any", order=2,
    ),
    Method(
        "Gauss-Legendre 16", "Hairer, McLachlan & Razakarivony (2008), compiled for bodies", "step",
        (2.0, 1.4, 1.0, 0.7, 0.5), _gauss16("step"), only="formulas", compiled=True, order=16,
    ),
    Method(
        "Gauss-Legendre 16, adaptive", "the same with a chosen step, compiled", "tolerance",
        (1e-6, 1e-9, 1e-12, 1e-15, 1e-18), _gauss16("tolerance"), only="body", compiled=True,
    ),
    Method(
        "Taylor, compiled", "Jorba & Zou (2005), compensated sums", "tolerance", (1e-6, 1e-9, 1e-12, 1e-15, 1e-17),
        _taylor(), only="body", compiled=True,
    ),
    Method(
        "heyoka", "Biscani & Izzo (2021)", "tolerance", (1e-6, 1e-9, 1e-12, 1e-15, 1e-18),
        _heyoka(extended=False), only="formulas", module="heyoka", extra="peers",
    ),
    Method(
        "heyoka, long double", "Biscani & Izzo (2021)", "tolerance", (1e-15, 1e-17, 1e-19, 1e-21),
        _heyoka(extended=True), only="formulas", module="heyoka", extra="peers", guard=10,
    ),
    Method(
        "closed elliptic form", "Jacobi (1850); floats by SciPy, above 15 digits mpmath", "digits", (15, 30, 50),
        _elliptic, only="top", module="scipy", extra="app", number="any",
    ),
    Method(
        "Taylor, multiprecision", "Jorba & Zou (2005), on mpmath", "digits", (15, 20, 30, 40),
        _multiprecision(taylor), only="body", number="any",
    ),
    Method(
        "mpmath odefun", "mpmath.odefun: Taylor series from differences", "digits", (15, 20),
        _multiprecision(odefun), only="body", number="any",
    ),
)  # fmt: skip

METHODS: dict[str, Method] = {method.name: method for method in _TABLE}
"""The methods by name."""
