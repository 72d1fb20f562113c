"""The flow of the tilde pair at d = 0 with repelling poles Σb_i(a_j + a_k − 2s)/γ_i², b_i > 0, on two elliptic curves.

Let h1 = m1 + Σb_i(a_j + a_k − s)/γ_i² and h2 = m2 + Σb_i/γ_i². The state is a divisor (U, V) of y² = f(x) = φ(x)(h1 −
xh2 − Σb_ic_i/(x − a_i)), c_i = (a_j − a_i)(a_k − a_i). The other roots ũ_k of f − V² separate: λ_k = h1 − ũ_kh2 are
constant, H = λ1 + λ2, K = −λ1λ2, and ũ_k' = −V(ũ_k), where ũ_k'² = φ(ũ_k)λ_k − 4Σb_ic_iΠ_{j≠i}(a_j − ũ_k) is a cubic.
So Z = λ_kũ_k + const moves on Y² = 4Z³ − g2Z − g3 (:mod:`integrable.deformations.oval`).

γ_i = 0 would imply V(a_i)² = −4b_ic_i² < 0, so no γ_i changes sign. ũ_k are the roots of ΣE_i²(x − a_j)(x − a_k), E_i²
= (b_i/γ_i² + w_i²)/h2 > 0, w = γ × M. They lie on opposite sides of the middle a_i, so the ovals never meet, and the
motion continues for all time. (This is the tilde pair's 2-torsion map on the curve with poles;
tests/integrable/deformations/test_separations.py has the exact identities.)
"""

from __future__ import annotations

from typing import Any

from integrable.deformations.deformed_flow import CurvesCarrier, DeformedFlow, at_its_precision
from integrable.deformations.equations import BY_THETA_IN_POLES
from integrable.deformations.oval import SeparatedOval, root_of_rounded
from integrable.deformations.quick_states import packed_in_poles
from integrable.deformations.separated_flow import interlaced
from integrable.phase.body import cross
from integrable.phase.state import State
from jacobian import poly
from jacobian.element import Numbers, Real
from jacobian.errors import NotRepresentable, shown

__all__ = ["PoleFlow"]


class PoleFlow(DeformedFlow):
    """The motion through a state, over RR or MP(digits); ``system.flow`` returns it.

    NotRepresentable if moments are equal or a λ_k vanishes.
    """

    _cost = BY_THETA_IN_POLES
    _pack = staticmethod(packed_in_poles)

    def _terms(self) -> float:
        poles = self.system.potential.poles
        return super()._terms() + max(self.system.a) * sum(
            b / (x * x) for b, x in zip(poles, self.state.gamma, strict=True)
        )

    def _moving(self, system: Any, state: State) -> CurvesCarrier:
        return CubicCarrier(system, state)


class CubicCarrier(CurvesCarrier):
    """The motion on two cubics, over the numbers of ``system``."""

    def __init__(self, system: Any, state: State) -> None:
        self.system, self.start = system, state
        if any(c == 0 for c in system.body.differences):
            raise NotRepresentable(
                "two moments of inertia are equal: the separated variables do not tell how γ turns; "
                "motion_through(state) integrates"
            )
        K, self._poles = system.field, system.potential.poles
        self._phi: poly.Poly = (K.coerce(-4),)
        for e in system.a:
            self._phi = poly.mul(K, self._phi, (e, -K.one))
        self._pairs = [poly.mul(K, (system.a[i - 2], -K.one), (system.a[i - 1], -K.one)) for i in range(3)]
        self._well: poly.Poly = (K.zero,) * 3
        for b, c, pair in zip(self._poles, system.body.differences, self._pairs, strict=True):
            self._well = poly.add(K, self._well, poly.scale(K, 4 * b * c, pair))
        self.signs = [1 if x > 0 else -1 for x in state.gamma]
        u, rate, self.lambdas = self._separated(state)
        one, two = self.lambdas
        self.momentum = ((one - two) / (u[1] - u[0])) ** (K.one / 2)
        self.sizes = abs(one) + abs(two), abs(one * two)
        self.cubics = [self._curve(*row) for row in zip(u, rate, self.lambdas, strict=True)]

    @at_its_precision
    def turns(self, tau: Real) -> Any:
        return abs(tau) / min(curve.period for curve in self.cubics)

    @at_its_precision
    def point(self, tau: Numbers) -> tuple[list[Any], list[Any]]:
        return self._state(*(curve.moved(tau) for curve in self.cubics))

    def _separated(self, state: State) -> tuple[list[Any], list[Any], list[Any]]:
        """The ũ_k, their derivatives, and the λ_k."""
        K, a = self.system.field, self.system.a
        squares = [x * x for x in state.gamma]
        s = K.dot(a, squares)
        h1 = sum(x * m * m for x, m in zip(a, state.M, strict=True))
        h1 = h1 + sum(b * (a[i - 2] + a[i - 1] - s) / squares[i] for i, b in enumerate(self._poles))
        h2 = K.dot(state.M, state.M) + sum(b / x for b, x in zip(self._poles, squares, strict=True))
        w = cross(K, state.gamma, state.M)
        V: poly.Poly = (K.zero,) * 3
        for x, y, pair in zip(state.gamma, w, self._pairs, strict=True):
            V = poly.add(K, V, poly.scale(K, 2 * x * y, pair))
        images = [(b / x + y * y) / h2 for b, x, y in zip(self._poles, squares, w, strict=True)]
        u = [a[0] + gap[0] for gap in interlaced(self.system.body, images)]
        return u, [-(V[0] + V[1] * x) for x in u], [h1 - x * h2 for x in u]

    def _cofactor(self, h1: Any, h2: Any, U: poly.Poly, V: poly.Poly) -> poly.Poly:
        """The cofactor (f − V²)/U of a quadratic U."""
        K = self.system.field
        f = poly.sub(K, poly.mul(K, self._phi, (h1, -h2)), self._well)
        return poly.quotient(K, poly.sub(K, f, poly.mul(K, V, V)), U)

    def _curve(self, u: Any, rate: Any, value: Any) -> _Cubic:
        K = self.system.field
        if abs(value) <= 64 * K.eps * max(map(abs, self.lambdas)):
            raise NotRepresentable(f"λ = {shown(self.lambdas)}: K vanishes, and one of the two curves degenerates")
        cubic = poly.sub(K, poly.scale(K, value, self._phi), self._well)
        return _Cubic(K, cubic, value, u, rate)

    def _state(self, first: Any, second: Any) -> tuple[list[Any], list[Any]]:
        """(γ, M) from (ũ, ũ') on both curves."""
        K, one, two = self.system.field, *self.lambdas
        (u1, y1), (u2, y2) = first, second
        h2 = (one - two) / (u2 - u1)
        slope = (y2 - y1) / (u2 - u1)
        V = (slope * u1 - y1, -slope)
        U = self._cofactor(one + u1 * h2, h2, (u1 * u2, -u1 - u2, K.one), V)
        gamma, w = [], []
        for i, (a, c) in enumerate(zip(self.system.a, self.system.body.differences, strict=True)):
            square = poly.evaluate(K, U, a) / (U[2] * c)
            x = self.signs[i] * abs(square) ** (K.one / 2)
            gamma.append(x)
            w.append((V[0] + V[1] * a) / (2 * c * x))
        return gamma, list(cross(K, (w[0], w[1], w[2]), (gamma[0], gamma[1], gamma[2])))


class _Cubic:
    """The motion u' = y on y² = q(u), along the bounded oval of its start.

    q has degree 3 and leading coefficient 4λ. With Z = λu + ``shift``, Z'² = 4Z³ − g2Z − g3 = 4Π(Z − e_i).
    """

    def __init__(self, K: Any, q: poly.Poly, scale: Any, u: Any, rate: Any) -> None:
        self.scale, self.shift = scale, q[2] / 12
        g2 = 12 * self.shift * self.shift - scale * q[1]
        # at u = 0, where Z = shift: λ²q(0) = 4Z³ − g2Z − g3
        g3 = (4 * self.shift * self.shift - g2) * self.shift - scale * scale * q[0]
        e, z, slope = roots_of_cubic(K, g2, g3), scale * u + self.shift, scale * rate
        sizes = [root_of_rounded(K, z - x) for x in e]
        # next to a branch point Z − e_i loses digits, which Z' restores
        i = min(range(3), key=lambda n: sizes[n])
        others = sizes[i - 2] * sizes[i - 1]
        if others:
            sizes[i] = abs(slope) / (2 * others)
        self.oval = SeparatedOval(K, e, lambda i, j: e[i] - e[j], sizes, 1 if slope >= 0 else -1)
        self.period = self.oval.period

    def moved(self, t: Any) -> tuple[Any, Any]:
        """(u, u') after a time t from the start."""
        r = self.oval.moved(t)
        return (self.oval.height(r) - self.shift) / self.scale, 2 * r[0] * r[1] * r[2] / self.scale


def roots_of_cubic(K: Any, g2: Real, g3: Any) -> list[Real]:
    """The real roots of 4Z³ − g2Z − g3 in ascending order, by Viète's formula with cos 3θ."""
    # rounding may push the cosine beyond 1 at an equilibrium, where the oval is a point
    cosine = max(-K.one, min(K.one, g3 * (27 / g2**3) ** (K.one / 2)))
    turn = K.context.acos(cosine) / 3
    radius = (g2 / 3) ** (K.one / 2)
    return [radius * K.context.cos(turn + 2 * K.context.pi * k / 3) for k in (1, 2, 0)]
