"""Random states over finite fields and the rationals, for the exact tests."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.phase.state import State
from jacobian import GF, NotASquare

FIELDS = {"GF(2^61-1)": lambda: GF(2**61 - 1), "GF(10007)": lambda: GF(10007), "GF(7^3)": lambda: GF(7, 3)}
SYSTEMS = {
    "ball": lambda K: ChaplyginBall((1, 2, 4), 1, field=K),
    "top": lambda K: EulerTop((1, 2, 4), field=K),
}


def systems():
    """The mark of a test with a parameter ``system``, a function that makes one: every body over every field."""
    return pytest.mark.parametrize(
        "system",
        [
            pytest.param(lambda f=f, s=s: s(f()), id=f"{name} over {field}")
            for field, f in FIELDS.items()
            for name, s in SYSTEMS.items()
        ],
    )


def unit_vector(K: Any, rng: Any) -> tuple[Any, Any, Any]:
    """A rational point of the unit sphere, by stereographic projection."""
    while True:
        s, t = K.random(rng), K.random(rng)
        square = K.add(K.mul(s, s), K.mul(t, t))
        if not K.is_zero(K.add(K.one, square)):
            break
    scale = K.inv(K.add(K.one, square))
    return K.mul(K.add(s, s), scale), K.mul(K.add(t, t), scale), K.mul(K.sub(K.one, square), scale)


def random_state(system: Any, rng: Any) -> State:
    """A state of a system over an exact field, with no vanishing γ_i, M ≠ 0 and g in the field."""
    K = system.field
    while True:
        gamma = unit_vector(K, rng)
        if any(K.is_zero(x) for x in gamma):
            continue
        m1, m2 = K.random(rng), K.random(rng)
        m3 = K.neg(K.div(K.add(K.mul(gamma[0], m1), K.mul(gamma[1], m2)), gamma[2]))
        try:
            state: State = system.state(gamma, (m1, m2, m3))
        except (NotASquare, ZeroDivisionError):
            continue
        if not K.is_zero(system.integrals(state).H2):
            return state


def until_defined(make: Callable[[], Any], attempts: int = 200) -> Any:
    """The first result of ``make`` without NotASquare: over half of the abscissas there is no point of the curve."""
    for _ in range(attempts):
        try:
            return make()
        except NotASquare:
            continue
    raise AssertionError(f"no defined case in {attempts} attempts")
