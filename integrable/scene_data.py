"""What a scene is: a body, a start, times, and what is wanted of the motion. Frozen, numbers as exact fractions."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from jacobian.errors import ArgumentError

__all__ = ["FLOAT_DIGITS", "Comparison", "Scene", "Times"]

FLOAT_DIGITS = 15
"""Up to this many digits a run is in floats, above it in multiprecision."""


@dataclass(frozen=True)
class Times:
    """Physical times: a list as given, or ``count`` times spaced from ``first`` to ``until``.

    Listed times are exact at any number of digits; spaced times are floats, the same floats at any number of digits.
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
            return [float(self.first + (self.until - self.first) * k / steps) for k in range(self.count)]
        ratio, first = float(self.until / self.first), float(self.first)
        return [*(first * ratio ** (k / steps) for k in range(self.count - 1)), float(self.until)]

    def at(self, digits: int) -> list[Any]:
        """The times as numbers of a run at ``digits`` digits."""
        if digits <= FLOAT_DIGITS:
            return self.floats()
        exact = self.given or [Fraction(time) for time in self.floats()]
        number = _numbers(digits)
        return [number(time) for time in exact]


@dataclass(frozen=True)
class Comparison:
    """What the report is to hold: costs of both methods, the truth to hold them against, and repeats of each timing."""

    digits: tuple[int, ...]
    tolerances: tuple[Fraction, ...]
    truth_digits: int
    check_time: Fraction
    repeat: int
    steps: tuple[int, ...]


@dataclass(frozen=True)
class Scene:
    """A run described as data: read from TOML by :mod:`integrable.scene_file`, run by :func:`integrable.run`."""

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
    times: Times
    digits: int = FLOAT_DIGITS
    report: Comparison | None = None
    pictures: tuple[str, ...] = ()
    sphere: Times | None = None
    tilted: bool = False
    """Whether (γ, M) may differ from 0."""
    place: str = "scene"
    """What error messages call the scene: the file it came from."""

    def body(self, digits: int) -> Any:
        """The body, in floats up to 15 digits, in multiprecision above; ArgumentError if there is no such body."""
        import integrable

        number = _numbers(digits)
        given = {"d": self.d, "mass": self.mass, "radius": self.radius}
        shape = {key: number(value) for key, value in given.items() if value is not None}
        kind = integrable.EulerTop if self.system == "euler_top" else integrable.ChaplyginBall
        with self._placed("[body]"):
            return kind(inertia=tuple(map(number, self.inertia)), field=_field(digits), **shape)

    def start(self, digits: int) -> tuple[Any, Any]:
        """The body and its state at time 0; ArgumentError if |γ| ≠ 1 or (γ, M) is not allowed."""
        body, number = self.body(digits), _numbers(digits)
        with self._placed("[start]"):
            return body, body.state(tuple(map(number, self.gamma)), tuple(map(number, self.M)), tilted=self.tilted)

    def describe(self) -> dict[str, Any]:
        """The scene as plain data: fractions as strings such as "7/10"."""
        content = dataclasses.asdict(self)
        del content["place"]
        return {key: _plain(value) for key, value in content.items()}

    @contextmanager
    def _placed(self, table: str) -> Iterator[None]:
        try:
            yield
        except ArgumentError as error:
            raise ArgumentError(f"{self.place}: {table} {error}") from error


def _field(digits: int) -> Any:
    from jacobian import MP, RR

    return RR if digits <= FLOAT_DIGITS else MP(digits)


def _numbers(digits: int) -> Callable[[Fraction], Any]:
    """How a run at ``digits`` digits writes a fraction."""
    if digits <= FLOAT_DIGITS:
        return float
    context = _field(digits).context
    return lambda value: context.mpf(value.numerator) / context.mpf(value.denominator)


def _plain(value: Any) -> Any:
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, list | tuple) else value
