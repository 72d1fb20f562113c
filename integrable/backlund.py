"""Bäcklund maps as additions: D ↦ D + D' with D' on the current curve.

Every D' preserves H1 and H2. The map is canonical for points of fixed abscissa, the point at infinity, branch points,
and sums of these (Tsiganov, Proposition 1, made precise: D' must not depend on the integrals but through y' = √f(x')).
"""

from __future__ import annotations

from collections.abc import Sequence
from operator import index
from typing import TYPE_CHECKING, Any

from integrable import coordinates
from jacobian import poly
from jacobian.errors import ArgumentError, NotASquare
from jacobian.lift import SignedDivisor, SignedGroup

if TYPE_CHECKING:
    from integrable.state import State
    from integrable.systems.system import System


class Translation:
    """The map that adds [multiple](Σ (x_k, y_k) − ∞'s): call it on a state.

    ``points``: one or two abscissas, real or a complex-conjugate pair; ``sheets``: the signs of y_k = ±√f(x_k);
    ``signs``: those of the roots √U'(a_i) that turn γ. Use :meth:`System.translation` and :meth:`System.torsion`. ``2 *
    step`` is its double, ``-step`` the inverse.
    """

    def __init__(
        self,
        system: System,
        points: Sequence[Any],
        sheets: Sequence[int] | None = None,
        signs: Sequence[int] | None = None,
        multiple: int = 1,
    ) -> None:
        self.system = system
        self.points = _abscissas(system, points)
        self.sheets = _signs(sheets, len(self.points), "sheets")
        self.signs = _signs(signs, 3, "signs")
        self.multiple = _multiple(multiple)
        self._last: tuple[Any, ...] | None = None

    def __repr__(self) -> str:
        points = ", ".join(map(str, self.points))
        return f"<addition of {self.multiple}·({points}) on {self.system!r}>"

    def __mul__(self, m: int) -> Translation:
        return Translation(self.system, self.points, self.sheets, self.signs, self.multiple * _multiple(m))

    __rmul__ = __mul__

    def __neg__(self) -> Translation:
        return self * -1

    def __call__(self, state: State) -> State:
        """The image of a state.

        Raises NotASquare where the image is not real (or not over the field), NotRepresentable where it has no
        representative.
        """
        system = self.system
        body = system.body
        state = system._checked(state)
        pairs = coordinates.to_pairs(body, state)
        u, v = coordinates.to_mumford(body, pairs)
        h1, h2 = system.integrals(state)[2:]
        group, move = self._move(h1, h2)
        total = group.add(SignedDivisor(u, v, pairs, coordinates.kappas(body)), move)
        return coordinates.from_pairs(body, total.pairs)

    def divisor(self, state: State) -> Any:
        """D' on the curve of a state, as a divisor of its Jacobian."""
        h1, h2 = self.system.integrals(self.system._checked(state))[2:]
        _, move = self._move(h1, h2)
        return self.system.group(h1, h2).from_mumford(move.u, move.v)

    def _move(self, h1: Any, h2: Any) -> tuple[SignedGroup, SignedDivisor]:
        """The sign-resolved D' on the curve of (h1, h2); kept, because an orbit stays on one curve."""
        if self._last is None or self._last[:2] != (h1, h2):
            system = self.system
            group = SignedGroup(system.curve(h1, h2), coordinates.branch_points(system.body))
            self._last = (h1, h2, group, self._signed(group))
        return self._last[2], self._last[3]

    def _signed(self, group: SignedGroup) -> SignedDivisor:
        u, v = self._mumford(group)
        if self.multiple % 2 == 0:
            # the double of anything has rational roots
            move = group.double(group.twist(u, v))
            move = move if self.multiple == 2 else group.multiple(self.multiple // 2, move)
        else:
            move = self._lifted(group, u, v)
            move = move if self.multiple == 1 else group.multiple(self.multiple, move)
        if self.multiple % 2 == 0:
            pairs = [
                pair if sign > 0 else (self.system.field.neg(pair[0]), self.system.field.neg(pair[1]))
                for pair, sign in zip(move.pairs, (*self.signs, 1), strict=False)
            ]
            move = move._replace(pairs=tuple(pairs))
        return move

    def _lifted(self, group: SignedGroup, u: poly.Poly, v: poly.Poly) -> SignedDivisor:
        try:
            return group.lift(u, v, (*self.signs, 1)[: len(group.branch_points)])
        except NotASquare:
            raise NotASquare(
                f"points = ({', '.join(map(str, self.points))}): the image of a state is not over {group.field.name}, "
                "because a root √U'(a_i) is not; over the reals take both points on one oval, both beyond 1/d, or a "
                "conjugate pair; or an even multiple"
            ) from None

    def _mumford(self, group: SignedGroup) -> tuple[poly.Poly, poly.Poly]:
        K, f = group.field, group.curve.f
        if any(isinstance(x, complex) or hasattr(x, "_mpc_") for x in self.points):
            return self._conjugate_pair(K, f)
        y = [self._ordinate(K, f, x, sheet) for x, sheet in zip(self.points, self.sheets, strict=True)]
        if len(y) == 1:
            return (K.neg(self.points[0]), K.one), poly.trim(K, (y[0],)) if K.exact else (y[0],)
        x1, x2 = self.points
        if x1 == x2:
            if y[0] != y[1]:
                raise ArgumentError(f"points = ({x1}, {x2}): a point and its opposite add up to zero")
            slope = K.div(poly.evaluate(K, poly.derivative(K, f), x1), K.add(y[0], y[0]))
        else:
            slope = K.div(K.sub(y[0], y[1]), K.sub(x1, x2))
        v = (K.sub(y[0], K.mul(slope, x1)), slope)
        return (K.mul(x1, x2), K.neg(K.add(x1, x2)), K.one), poly.trim(K, v) if K.exact else v

    def _ordinate(self, K: Any, f: poly.Poly, x: Any, sheet: int) -> Any:
        if x in self.system.a or (self.system.body.rolls and x == K.inv(self.system.d)):
            return K.zero
        value = poly.evaluate(K, f, x)
        try:
            y = K.sqrt(value)
        except NotASquare:
            raise NotASquare(
                f"points: f({x}) = {value} has no square root in {K.name}: no point of the curve lies there"
            ) from None
        return y if sheet > 0 else K.neg(y)

    def _conjugate_pair(self, K: Any, f: poly.Poly) -> tuple[poly.Poly, poly.Poly]:
        z = self.points[0]
        value = poly.evaluate(K, f, z)
        y = value**0.5 if self.sheets[0] > 0 else -(value**0.5)
        slope = y.imag / z.imag
        return (K.coerce(abs(z) ** 2), -2 * z.real, K.one), (y.real - slope * z.real, slope)


def _abscissas(system: System, points: Sequence[Any]) -> tuple[Any, ...]:
    K = system.field
    try:
        given = list(points)
    except TypeError:
        given = []
    if isinstance(points, (str, bytes)) or len(given) not in (1, 2):
        raise ArgumentError(f"points = {points!r}: give one or two abscissas x'")
    if len(given) == 1 and not system.body.rolls:
        raise ArgumentError(f"points = {points!r}: at d = 0 give two abscissas; one point and ∞ needs d > 0")
    complex_ones = [x for x in given if isinstance(x, complex) or hasattr(x, "_mpc_")]
    if not complex_ones:
        return tuple(K.coerce(x, f"points[{i}]") for i, x in enumerate(given))
    if K.exact or len(complex_ones) != 2 or given[0] != given[1].conjugate() or not given[0].imag:
        raise ArgumentError(f"points = {points!r}: complex abscissas come as a conjugate pair (z, z̄) over RR or MP")
    return tuple(given)


def _signs(values: Sequence[int] | None, count: int, argument: str) -> tuple[int, ...]:
    if values is None:
        return (1,) * count
    given = tuple(values)
    if len(given) != count or any(x not in (1, -1) for x in given):
        raise ArgumentError(f"{argument} = {values!r}: give {count} signs, each 1 or -1")
    return given


def _multiple(m: Any) -> int:
    try:
        value = index(m)
    except TypeError:
        raise ArgumentError(f"multiple = {m!r}: a multiple of a step is an int") from None
    if value == 0:
        raise ArgumentError("multiple = 0: the identity map needs no step")
    return value
