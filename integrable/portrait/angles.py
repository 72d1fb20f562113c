"""Abelian integrals along the two ovals of a curve, for the angles of a state and for Poincaré sections.

They run from the outer end of each oval (a₁ of the first, a₃ of the second) to a point u: ∫x^k dx/|y|, k = 0 and 1.
With x = e + (e' − e)sin²φ, e the outer and e' the inner end, the integrand is smooth.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from integrable.portrait.ovals import Level, Ovals

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup


def part_of_oval(level: Level, oval: int, x: Any) -> tuple[Any, Any]:
    """∫x^k dx/|y|, k = 0 and 1, between the outer end of an oval (0 or 1) and x on it, ≥ 0; wide numbers."""
    a, b, c, e = level.ends
    outer, inner, others = (a, b, (c, e)) if oval == 0 else (e, c, (a, b))
    context = x.context
    if inner == outer:
        return context.zero, context.zero
    part = min(max((x - outer) / (inner - outer), context.zero), context.one)
    end = context.asin(context.sqrt(part))

    def integrand(angle: Any) -> Any:
        x = outer + (inner - outer) * context.sin(angle) ** 2
        return 1 / (level.momentum * context.sqrt(abs((1 - level.d * x) * (x - others[0]) * (x - others[1]))))

    def moment(angle: Any) -> Any:
        return (outer + (inner - outer) * context.sin(angle) ** 2) * integrand(angle)

    # next to the separatrix the integrand has a narrow peak at the inner end
    cuts = [context.zero, *(end * (1 - context.mpf(4) ** -k) for k in range(1, _cuts(level))), end]
    return context.quad(integrand, cuts), context.quad(moment, cuts)


def _cuts(level: Level) -> int:
    a, b, c, e = map(float, level.ends)
    count = 1
    while count < 40 and 4.0 ** -(2 * count) * (e - a) > c - b:
        count += 1
    return count


def divisor_of(setup: Setup) -> tuple[tuple[Any, bool], tuple[Any, bool]]:
    """(x, whether y > 0) of both points of the start, x ascending, wide."""
    problem = setup.problem
    top = problem.time_scale / (2 * problem.momentum)
    u0, u1, v0, v1 = problem.start[:4]
    context = setup.wide.context
    spread = context.sqrt(max(u1 * u1 / 4 - u0, context.zero))
    low, high = -u1 / 2 - spread, -u1 / 2 + spread
    return (low * top, bool(v0 + v1 * low > 0)), (high * top, bool(v0 + v1 * high > 0))


def start_sums(divisor: tuple[tuple[Any, bool], tuple[Any, bool]], level: Level) -> tuple[Any, Any]:
    """Σ∫dx/y and Σ∫x dx/y from (a₁, a₃) to a :func:`divisor_of` a start, along the direction of the flow."""
    total = [level.zeta.context.zero] * 2
    for oval, (x, positive) in enumerate(divisor):
        # y has the sign of dx, but on the second oval the direction to a₃ is upwards
        sign = 1 if positive == (oval == 0) else -1
        for k, value in enumerate(part_of_oval(level, oval, x)):
            total[k] += sign * value
    return total[0], total[1]


def start_angles(divisor: tuple[tuple[Any, bool], tuple[Any, bool]], level: Level, ovals: Ovals) -> tuple[Any, Any]:
    """θ with Σ∫(dx, x dx)/y = θ1·2(A0, A1) + θ2·2(B0, B1) at the start, modulo 1."""
    first, second = start_sums(divisor, level)
    one, two = (first * ovals.B1 - second * ovals.B0), (second * ovals.A0 - first * ovals.A1)
    floor = level.zeta.context.floor
    turns = one / (2 * ovals.D), two / (2 * ovals.D)
    return turns[0] - floor(turns[0]), turns[1] - floor(turns[1])
