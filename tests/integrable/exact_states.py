"""Random states over finite fields and the rationals, for the exact tests."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from integrable.state import State
from jacobian import NotASquare

EXACT = {"p": 2**61 - 1, "small": (3, 7), "prime": 10007}


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
    """The first result of ``make`` without NotASquare: half of the abscissas carry no point of the curve."""
    for _ in range(attempts):
        try:
            return make()
        except NotASquare:
            continue
    raise AssertionError(f"no defined case in {attempts} attempts")
