"""Common formulas of Lagrange's top and the spherical pendulum, on a curve y² = f(z) of genus 1.

z is the height of the axis, and the complex number g its horizontal part. U is x − z and V is z'. With constants m₁ and
m₂ of the motion, f is cubic with leading coefficient 2, f(1) = −m₁² and f(−1) = −m₂². With constants w and C,

    g = Ce^{iwt}σ₁σ₂,   σ_k the lift at the point (±1, −im_k),   σ_k'/σ_k = (z' − im_k)/(2(z ∓ 1))

If m_k = 0 the axis can pass through the vertical: ±1 is then a branch point, where the lift changes sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from integrable.mumford.fields import cofactor, elementary
from integrable.mumford.flow import Point
from integrable.mumford.motion import Start
from integrable.mumford.surfaces import SurfaceSystem
from integrable.mumford.system import Spectral, all_of
from integrable.phase.body import Vector
from integrable.portrait.point_ovals import Form, Separation
from jacobian import poly
from jacobian.element import Arithmetic, FormulaField, Real
from jacobian.errors import PrecisionLoss
from jacobian.relatives.extended import Extended, Kind, Lift, PointLift


class Axis(NamedTuple):
    """An axis: its height z and z', its horizontal part (g₁, g₂) and g', the constants (m₁, m₂) and w."""

    z: Real
    rate: Real
    g: tuple[Real, Real]
    g_rate: tuple[Real, Real]
    m: tuple[Real, Real]
    w: Real


class AxialSystem(SurfaceSystem):
    """Base class of Lagrange's top and the spherical pendulum."""

    size = 3
    complex_data = True

    def _axis(self, N: FormulaField, state: Point) -> Axis:
        """Defined by subclasses: the axis of a state."""
        raise NotImplementedError

    def _curve(self, N: FormulaField, state: Point) -> tuple[Real, ...]:
        """Defined by subclasses: the coefficients of f."""
        raise NotImplementedError

    def _top(self, N: FormulaField, state: Point) -> Vector | None:
        """Defined by subclasses: (jc, L, c) of :mod:`integrable.classical.lagrange` if the p of a state is the angular
        momentum of a top; None if it is a velocity.
        """
        return None

    # --- derived from the methods above

    def _spectral(self, N: FormulaField, state: Point) -> Spectral:
        axis = self._axis(N, state)
        return all_of(N, (self._curve(N, state), (-axis.z, N.one), (axis.rate,)), 1)

    def _genus(self) -> int:
        return 1

    def _direction(self, N: FormulaField, genus: int) -> Sequence[Real]:
        return (N.one,)

    def _separation(self, N: FormulaField, state: Point) -> Separation:
        """The differentials of the action and of the angle about the vertical.

        p dq without the angle's part is z' dz/(1 − z²). The angle grows at the rate w + ½m₁/(1 − z) − ½m₂/(1 + z).
        """
        axis, vertical = self._axis(N, state), (N.one, -N.one)
        (m1, m2), action = axis.m, Form(poly.neg(N, self._curve(N, state)), vertical)
        turn = Form(((m2 - m1) / 2, -(m1 + m2) / 2), vertical)
        return Separation([Form((N.one,))], (N.one,), action, [(turn, axis.w)], (self._momentum(N, state),))

    def _momentum(self, N: FormulaField, state: Point) -> Real:
        """Defined by subclasses: the momentum conjugate to the angle of the horizontal part."""
        raise NotImplementedError

    def _ends(self, N: FormulaField, axis: Axis) -> list[tuple[Real, Real]]:
        """The points (1, −im₁) and (−1, −im₂) of the curve, to which the lifts belong."""
        i = N.coerce(1j)
        return [(N.one, -i * axis.m[0]), (-N.one, -i * axis.m[1])]

    def _carrier(self, axis: Axis) -> int | None:
        """The index, 0 or 1, of the end z = 1 or −1 nearer to the start; None if this end is no branch point.

        At the start the lift at this branch point has the value g. All other lifts have the value 1.
        """
        near = 0 if abs(1 - axis.z) < abs(1 + axis.z) else 1
        return near if branches(axis.m[near]) else None

    def _start(self, N: FormulaField, state: Point) -> Start:
        f, u, v = self._spectral(N, state)
        axis, i = self._axis(N, state), N.coerce(1j)
        carrier, ends = self._carrier(axis), self._ends(N, axis)
        kinds: list[Kind] = []
        data: list[tuple[Real, Real, Real]] = []
        for k, (e, y) in enumerate(ends):
            if not branches(axis.m[k]):
                kinds.append(PointLift(e, y))
                data.append((axis.z - e, N.one, N.one))
            elif k != carrier:
                kinds.append(Lift(e))
                data.append((e - axis.z, N.one, -axis.rate / (axis.z - e)))
            else:
                g, g_rate = (a + i * b for a, b in (axis.g, axis.g_rate))
                other, y = ends[1 - k]
                # g' = (iw + l)g − ½ν, where l is σ'/σ at the other end
                nu = -2 * (g_rate - g * (i * axis.w + (axis.rate + y) / (2 * (axis.z - other))))
                kinds.append(Lift(e))
                data.append((self._unit(N, f, e, axis, g, nu), g, nu))
        return Start(f, u, v, self._direction(N, 1), kinds, tuple(data))

    def _unit(self, N: FormulaField, f: poly.Poly, e: Real, axis: Axis, g: Real, nu: Real) -> Real:
        """The κ of the lift g at e: κg² = U(e), κν² = −W(e)."""
        if abs(g) ** 2 > abs(nu) ** 2:
            return (e - axis.z) / (g * g)
        if nu == 0:
            return N.one
        w = poly.evaluate(N, cofactor(N, f, (-axis.z, N.one), (axis.rate,)), e)
        return -w / (nu * nu)

    def _back(self, N: FormulaField, start: Point, D: Extended, time: Real) -> Point:
        axis, i = self._axis(N, start), N.coerce(1j)
        z, rate = (-D.u[0]).real, D.v[0].real
        lifts = []
        for (e, y), m, datum in zip(self._ends(N, axis), axis.m, D.data, strict=True):
            _, sigma, last = datum
            lifts.append((sigma, -last / 2 if branches(m) else sigma * (rate + y) / (2 * (z - e))))
        (first, of_first), (second, of_second) = lifts
        turn = elementary(N, "exp", i * axis.w * time)
        if self._carrier(axis) is None:
            turn = turn * (axis.g[0] + i * axis.g[1])
        g = turn * first * second
        g_rate = i * axis.w * g + turn * (of_first * second + first * of_second)
        top = self._top(N, start)
        top = top and (top[0].real, top[1].real, top[2].real)
        return state_of((g.real, g.imag, z), (g_rate.real, g_rate.imag, rate), top)


def state_of(axis: Vector, rate: Vector, top: Vector | None) -> Point:
    """The state with this axis and its rate; ``top`` is that of :meth:`AxialSystem._top`."""
    return Point(axis, rate if top is None else momentum(axis, rate, top))


def momentum(axis: Vector, rate: Vector, top: Vector) -> Vector:
    """The angular momentum of a top with this axis and its rate; ``top`` is that of :meth:`AxialSystem._top`.

    With axis = (Re g, Im g, z) and top = (jc, L, c), M_1 + iM_2 is (g' + ijcg)/(iz), and also g(L − cz + iz')/(1 − z²).
    The first times z² plus the second times 1 − z² is a formula without divisions.
    """
    (x, y, z), (dx, dy, dz), (turn, along, c) = axis, rate, top
    rest = along - c * z
    return z * (dy + turn * x) + x * rest - y * dz, z * (turn * y - dx) + x * dz + y * rest, c


def branches(m: Real) -> bool:
    """Whether the end z = 1 or −1 is a branch point: whether its constant ``m``, which is m₁ or m₂, is 0.

    PrecisionLoss if m is an enclosure that contains 0 and other numbers.
    """
    if m == 0 or m != 0:
        return bool(m == 0)
    raise PrecisionLoss("whether the axis passes through the vertical is not seen: use more digits")


def heavy(N: Arithmetic, h: Real, along: poly.Poly) -> poly.Poly:
    """The cubic f = 2(1 − x²)(h − x) − L(x)², where ``along`` is L with L(1)² = m₁² and L(−1)² = m₂²."""
    height = poly.mul(N, (2 * N.one, N.zero, -2 * N.one), (h, -N.one))
    return poly.sub(N, height, poly.mul(N, along, along))
