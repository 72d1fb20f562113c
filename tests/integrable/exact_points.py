"""Random bodies and phase points over exact fields, as numbers with operators, for the tests of identities."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.phase.brackets import image_brackets
from integrable.phase.jets import JetField
from jacobian import GF, NotASquare, NotRepresentable
from jacobian.errors import ArgumentError, FieldError
from tests.integrable.exact_states import random_state

# the modulus of GF(7^3) is given, so that galois is not imported for it
FIELDS = {"GF(2^61-1)": lambda: GF(2**61 - 1), "GF(7^3)": lambda: GF(7, 3, [4, 0, 6, 1])}
# here −1 is a square
FIELDS_WITH_I = {"GF(2^61-31)": lambda: GF(2**61 - 31), "GF(5^3)": lambda: GF(5, 3, [3, 3, 0, 1])}


def over_fields(fields: dict[str, Any] = FIELDS) -> Any:
    """Parametrizes a test by ``K``, a function that makes the field."""
    return pytest.mark.parametrize("K", [pytest.param(make, id=name) for name, make in fields.items()])


def attempt(make: Callable[[], Any], attempts: int = 2000) -> Any:
    """The first result of ``make``; attempts that meet special positions or missing roots are skipped."""
    for _ in range(attempts):
        try:
            return make()
        except (NotASquare, NotRepresentable, ZeroDivisionError, ArgumentError, FieldError):
            continue
    raise AssertionError(f"no defined case in {attempts} attempts")


def random_system(K: Any, rng: Random, kind: str = "ball", squares: bool = False) -> Any:
    """A ball (or top) with three different moments; with ``squares`` every 1 − d·a_i is a square."""

    def make() -> Any:
        t = [K.random(rng) for _ in range(3)]
        if squares:
            t = [K.div(K.mul(x, x), K.sub(K.one, K.mul(x, x))) for x in t]
        # d = 1 for squares: I = t²/(1 − t²), 1 − d·a = I/(I + d) = t²
        d = K.one if squares else K.random(rng)
        system = EulerTop(t, field=K) if kind == "top" else ChaplyginBall(t, d, field=K)
        if K.zero in system.body.differences or (kind == "ball" and not system.body.rolls):
            raise ZeroDivisionError
        return system

    return attempt(make)


def random_case(K: Any, rng: Random, kind: str = "ball", squares: bool = False) -> tuple[Any, Any]:
    """(system, state) with (γ, M) = 0."""
    system = random_system(K, rng, kind, squares)
    return system, random_state(system, rng)


def step_case(K: Any, seed: int, kind: str, make_step: Callable[[Any, Random], Any], squares: bool = False) -> Any:
    """(system, state, step, brackets of the image, bracket at the image)."""
    rng = Random(seed)

    def make() -> Any:
        system, state = random_case(K, rng, kind, squares)
        step = make_step(system, rng)
        return system, state, step, *image_brackets(system, step, state)

    return attempt(make)


@dataclass
class Phase:
    """A point (γ, M), with (γ, M) = c, |γ| = 1, and the constants of the body, all with operators."""

    d: Any
    a: tuple[Any, ...]
    gamma: tuple[Any, ...]
    M: tuple[Any, ...]
    g: Any

    @property
    def G(self) -> Any:
        return self.g * self.g

    @property
    def A(self) -> tuple[Any, ...]:
        return tuple(1 - self.d * x for x in self.a)

    @property
    def c(self) -> tuple[Any, ...]:
        """c_i = (a_j − a_i)(a_k − a_i)."""
        return tuple((self.a[j] - self.a[i]) * (self.a[k] - self.a[i]) for i, j, k in CYCLIC)

    @property
    def B(self) -> tuple[Any, ...]:
        """The diagonal of B = diag((a_i − a_j)(a_i − a_k)γ_i²)."""
        return tuple(c * x * x for c, x in zip(self.c, self.gamma, strict=True))

    @property
    def AM(self) -> tuple[Any, ...]:
        return tuple(x * y for x, y in zip(self.a, self.M, strict=True))

    @property
    def A_gamma(self) -> tuple[Any, ...]:
        return tuple(x * y for x, y in zip(self.a, self.gamma, strict=True))

    @property
    def omega(self) -> tuple[Any, ...]:
        n = self.G * dot(self.gamma, self.AM)
        return tuple(x + self.d * n * y for x, y in zip(self.AM, self.A_gamma, strict=True))

    @property
    def w(self) -> tuple[Any, ...]:
        return cross(self.gamma, self.M)

    @property
    def H(self) -> tuple[Any, Any]:
        return dot(self.omega, self.M), dot(self.M, self.M)


CYCLIC = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def dot(x: Any, y: Any) -> Any:
    return sum((p * q for p, q in zip(x, y, strict=True)), start=0)


def cross(x: Any, y: Any) -> tuple[Any, ...]:
    return tuple(x[j] * y[k] - x[k] * y[j] for _, j, k in CYCLIC)


def phase(system: Any, state: Any, numbers: Any = None) -> Phase:
    """A state as numbers with operators."""
    K = numbers or JetField(system.field, 0)
    wrap = lambda values: tuple(map(K.coerce, values))  # noqa: E731
    g = K.one if state.g is None else K.coerce(state.g)
    return Phase(K.coerce(system.d), wrap(system.a), wrap(state.gamma), wrap(state.M), g)


def tilted_phase(K: Any, rng: Random, kind: str = "ball") -> tuple[Any, Phase]:
    """(system, point) with a random (γ, M) = c."""
    system, state = random_case(K, rng, kind)
    point = phase(system, state)
    N = point.g.field
    shift = N.random(rng)
    point.M = tuple(m + shift * x for m, x in zip(point.M, point.gamma, strict=True))
    return system, point


def evaluate(coefficients: Any, x: Any) -> Any:
    """Σ c_i x^i."""
    return sum((c * x**i for i, c in enumerate(coefficients)), start=0)


def wrapped(system: Any, values: Any) -> tuple[Any, ...]:
    """Elements of the field of a system with operators."""
    N = JetField(system.field, 0)
    return tuple(map(N.coerce, values))
