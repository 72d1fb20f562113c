"""A scene: a system, a start, times or steps, and the requested output. It is immutable, with exact fractions."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from importlib import import_module
from typing import Any, NamedTuple

from integrable.phase.body import unwarned
from integrable.phase.precisions import FLOAT_DIGITS
from jacobian.errors import ArgumentError, shortened, whole, written

__all__ = ["MOST_STEPS", "SYSTEMS", "Comparison", "Map", "Scene", "Steps", "Times", "plain"]

MOST_STEPS = 10_000_000
"""The largest number of steps of an orbit: the states after all steps are kept in memory."""


class Kind(NamedTuple):
    """Where a scene's system is defined: the folder and the class, and the keys of its ``[body]``.

    ``module`` is given only if the name of the class's module differs from the name of the system.
    """

    room: str
    name: str
    keys: tuple[str, ...]
    module: str = ""


SYSTEMS = {
    "chaplygin_ball": Kind("systems", "ChaplyginBall", ("inertia", "d", "mass", "radius")),
    "euler_top": Kind("systems", "EulerTop", ("inertia",)),
    "tilde": Kind("deformations", "Tilde", ("inertia", "d", "potential")),
    "check": Kind("deformations", "Check", ("inertia", "potential"), "isometric"),
    "hat": Kind("deformations", "Hat", ("inertia", "potential"), "isometric"),
    "gyroscopic": Kind("deformations", "Gyroscopic", ("inertia", "c")),
    "ellipsoid": Kind("classical", "Ellipsoid", ("a",)),
    "garnier": Kind("classical", "Garnier", ("a", "alpha", "beta")),
    "henon_heiles": Kind("classical", "HenonHeiles", ("a", "alpha", "beta", "gamma", "barriers")),
    "kdv_two_gaps": Kind("classical", "TwoGaps", ("sums",), "two_gaps"),
    "kuzmin_kutuzov": Kind("classical", "KuzminKutuzov", ("axes", "GM")),
    "lagrange": Kind("classical", "LagrangeTop", ("j",)),
    "neumann": Kind("classical", "Neumann", ("a",)),
    "spherical_pendulum": Kind("classical", "SphericalPendulum", ()),
    "toda": Kind("classical", "TodaLattice", ("n",)),
    "veselova": Kind("classical", "Veselova", ("inertia",)),
}
"""The systems of scenes. To add a system of ``classical``, only a line here is needed."""


def system_class(system: str) -> Any:
    """The class of a system of SYSTEMS."""
    kind = SYSTEMS[system]
    return getattr(import_module(f"integrable.{kind.room}.{kind.module or system}"), kind.name)


@dataclass(frozen=True)
class Times:
    """Physical times: either a given list, or ``count`` times from ``first`` to ``until``.

    Listed times are exact at any number of digits. Spaced times are the same floats at any number of digits.
    """

    given: tuple[Fraction, ...] = ()
    first: Fraction = Fraction(0)
    until: Fraction = Fraction(0)
    count: int = 0
    spacing: str = "linear"

    def floats(self) -> list[float]:
        """The times as floats."""
        if self.given:
            return [float(time) for time in self.given]
        steps = max(self.count - 1, 1)
        if self.spacing == "linear":
            # each time is a quotient of two integers, which is rounded only once
            below = self.first.denominator * self.until.denominator
            begin, end = int(self.first * below), int(self.until * below)
            return [(begin * steps + (end - begin) * k) / (below * steps) for k in range(self.count)]
        ratio, first = float(self.until / self.first), float(self.first)
        return [*(first * ratio ** (k / steps) for k in range(self.count - 1)), float(self.until)]

    def at(self, digits: int) -> list[Any]:
        """The times as numbers of a run at ``digits`` digits."""
        if digits <= FLOAT_DIGITS:
            return self.floats()
        return list(map(_numbers(digits), self.given or map(Fraction, self.floats())))


@dataclass(frozen=True)
class Comparison:
    """The settings of a report: digits of its runs and of the truth, SciPy's tolerances, and repeats of each timing.

    At ``check_time`` the truth is compared with an independent run. ``steps`` are numbers of additions, after which the
    residual V² − f mod U is measured.
    """

    digits: tuple[int, ...]
    tolerances: tuple[Fraction, ...]
    truth_digits: int
    check_time: Fraction
    repeat: int
    steps: tuple[int, ...]


@dataclass(frozen=True)
class Map:
    """One map of ``[steps]``: its kind, which is the name of a method of the system, and arguments for this method."""

    kind: str
    arguments: tuple[tuple[str, Any], ...] = ()

    def of(self, system: Any, number: Callable[[Fraction], Any]) -> Any:
        """The map of this kind for a ``system``; ``number`` converts fractions to the system's numbers."""
        method = getattr(system, self.kind, None)
        if method is None:
            raise ArgumentError(f'kind: "{self.kind}" given, which {type(system).__name__} has not')
        given = dict(self.arguments)
        if "conjugate" in given:
            re_part, im_part = map(number, given.pop("conjugate"))
            unit = getattr(getattr(system.field, "context", None), "j", 1j)
            given["points"] = (re_part + unit * im_part, re_part - unit * im_part)
        if "weights" in given:
            first, second = map(number, given.pop("weights"))
            given["F"] = lambda h1, h2: first * h1 + second * h2
        return method(**{key: _as_numbers(value, number) for key, value in given.items()})


@dataclass(frozen=True)
class Steps:
    """An orbit of ``count`` steps, and the settings of its report. A step applies ``maps`` in their order."""

    maps: tuple[Map, ...]
    count: int
    digits: tuple[int, ...]
    truth_digits: int
    repeat: int


@dataclass(frozen=True)
class Scene:
    """A run described as data: read from TOML by :mod:`integrable.scene.file`, run by :func:`integrable.run`."""

    name: str
    title: str
    description: str
    system: str
    inertia: tuple[Fraction, ...]
    d: Fraction | None
    mass: Fraction | None
    radius: Fraction | None
    gamma: tuple[Fraction, ...]
    M: tuple[Fraction, ...]
    """M of the start. For a system of ``classical`` ``gamma`` and ``M`` are q and p."""
    times: Times = Times()
    digits: int = FLOAT_DIGITS
    report: Comparison | None = None
    pictures: tuple[str, ...] = ()
    sphere: Times | None = None
    tilted: bool = False
    """Whether (γ, M) may differ from 0."""
    potential: tuple[Fraction, ...] | None = None
    """The five parameters of the potential of a deformation."""
    c: Fraction | None = None
    """The constant of the gyroscopic deformation."""
    steps: Steps | None = None
    """The orbit of a map, for a scene without a motion, whose ``times`` are empty; None for a motion."""
    finite_field: str = ""
    """The field of an exact orbit, such as ``"GF(2^61-1)"``; empty: floats or multiprecision."""
    constants: tuple[tuple[str, Any], ...] = ()
    """The arguments of a system of ``classical``."""
    reference: str = ""
    """The source that describes the motion; the scenes that have one are the problems of :mod:`integrable.problems`."""
    place: str = "scene"
    """The name of the scene in error messages: its file."""

    @property
    def rolls_or_spins(self) -> bool:
        """Whether the system is the ball or the top, not a deformation."""
        return self.system in ("chaplygin_ball", "euler_top")

    @property
    def classical(self) -> bool:
        """Whether the system is one of :mod:`integrable.classical`, with q and p for γ and M."""
        return SYSTEMS[self.system].room == "classical"

    @property
    def letters(self) -> tuple[str, str]:
        """The names of the two halves of a state."""
        return ("q", "p") if self.classical else ("γ", "M")

    def body(self, digits: int) -> Any:
        """The system: in floats up to 15 digits, in multiprecision above. Over a finite field digits do not matter.

        Raises ArgumentError if no such body exists.
        """
        number = self._numbers(digits)
        with self._placed("[body]"):
            make, field = system_class(self.system), self._field(digits)
            if self.classical:
                from integrable.scene.classical import ClassicalSystem

                given = {key: _argument(value, number) for key, value in self.constants}
                return ClassicalSystem(make(**given, field=field))
            numbers = {key: getattr(self, key) for key in ("inertia", "d", "mass", "radius", "c", "potential")}
            own = {key: _as_numbers(value, number) for key, value in numbers.items() if value is not None}
            with unwarned():
                return make(**own, field=field)

    def start(self, digits: int) -> tuple[Any, Any]:
        """The system and its state at time 0; ArgumentError if |γ| ≠ 1 or (γ, M) is not allowed."""
        body, number = self.body(digits), self._numbers(digits)
        extra = {"tilted": True} if self.tilted else {}
        with self._placed("[start]"):
            return body, body.state(tuple(map(number, self.gamma)), tuple(map(number, self.M)), **extra)

    def step(self, system: Any, digits: int) -> Any:
        """The map of ``steps`` on a ``system`` that :meth:`body` made at this number of digits; ArgumentError if there
        is no map.
        """
        assert self.steps is not None, "the scene has no [steps]"
        with self._placed("[steps] maps:"):
            steps = [one.of(system, self._numbers(digits)) for one in self.steps.maps]
            return reduce(lambda first, second: second @ first, steps)

    def _field(self, digits: int) -> Any:
        from jacobian import MP, RR

        if self.finite_field:
            return finite_field(self.finite_field)
        return RR if digits <= FLOAT_DIGITS else MP(digits)

    def _numbers(self, digits: int) -> Callable[[Fraction], Any]:
        digits = whole(digits, "digits", "give an int ≥ 1, a number of decimal digits (15: floats)", 1)
        return _elements(self._field(digits)) if self.finite_field else _numbers(digits)

    def describe(self) -> dict[str, Any]:
        """The scene as plain data: fractions as strings such as "7/10"."""
        content = dataclasses.asdict(self)
        del content["place"]
        content["constants"] = dict(self.constants)
        if self.classical:
            content = {{"gamma": "q", "M": "p"}.get(key, key): value for key, value in content.items()}
        if self.steps is not None:
            content["steps"]["maps"] = [{"kind": one.kind, **dict(one.arguments)} for one in self.steps.maps]
        return {key: plain(value) for key, value in content.items()}

    @contextmanager
    def _placed(self, table: str) -> Iterator[None]:
        try:
            yield
        except ArgumentError as error:
            raise ArgumentError(f"{self.place}: {table} {error}") from error


_FINITE_FIELD = re.compile(r"GF\((\d{1,40})(?:\^(\d{1,4})([+-]\d{1,40})?)?\)")


def finite_field(name: str) -> Any:
    """The field written GF(p), GF(p^k) or GF(2^k-c), where 2^k-c is a prime; ArgumentError for anything else."""
    from jacobian import GF

    found = _FINITE_FIELD.fullmatch(name.replace(" ", ""))
    if found is None:
        raise ArgumentError(f'field: "{shortened(name)}" given; GF(101), GF(2^61-1) or GF(7^3) would be one')
    base, power, offset = int(found[1]), int(found[2] or 1), int(found[3] or 0)
    return GF(base**power + offset) if offset else GF(base, power)


def _elements(K: Any) -> Callable[[Fraction], Any]:
    """A function from fractions to elements of a finite field.

    An integer 0 … q − 1, where q is the order of the field, is the number of an element. Any other fraction is an
    element of the prime field.
    """
    from jacobian import poly

    def number(value: Fraction) -> Any:
        if value.denominator == 1 and 0 <= value < K.order:
            return K.coerce(int(value))
        below = poly.integer(K, value.denominator)
        if below == K.zero:
            raise ArgumentError(f"{written(value)} has a denominator that is zero in {K.name}")
        return K.div(poly.integer(K, value.numerator), below)

    return number


def _as_numbers(value: Any, number: Callable[[Fraction], Any]) -> Any:
    if isinstance(value, Fraction):
        return number(value)
    return [_as_numbers(item, number) for item in value] if isinstance(value, tuple) else value


def _argument(value: Any, number: Callable[[Fraction], Any]) -> Any:
    """An argument of a system of ``classical``. A single integer, such as a number of particles, becomes an int."""
    if isinstance(value, Fraction) and value.denominator == 1:
        return int(value)
    return _as_numbers(value, number)


def _numbers(digits: int) -> Callable[[Fraction], Any]:
    """The function that converts fractions to the numbers of a run at ``digits`` digits."""
    from jacobian import MP

    return float if digits <= FLOAT_DIGITS else MP(digits).coerce


def plain(value: Any) -> Any:
    """A value as data for JSON: arrays and tuples as lists, and fractions and multiprecision numbers as strings."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value if value is None or isinstance(value, int | float | str) else str(value)
