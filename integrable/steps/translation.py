"""Bäcklund maps as additions: D ↦ D + D' with D' on the current curve.

Each map preserves H1 and H2. It is canonical if D' is a point of fixed abscissa, the point at infinity, a branch point,
or a sum of these (Tsiganov, Proposition 1, made precise: D' may depend on the integrals only through y' = √f(x')).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

from integrable.phase import coordinates
from integrable.phase.jets import apply
from integrable.phase.space import PhaseSpace
from integrable.steps.guard_digits import LARGEST, MOST_CONDITION, body_condition
from integrable.steps.moves import Move
from integrable.steps.step import Abscissa, check_doublings, checked_multiple, checked_signs
from jacobian import Divisor, poly
from jacobian.element import Element, Real, Value
from jacobian.errors import ArgumentError, NotASquare, entries, shown, written
from jacobian.fields.inexact import InexactField
from jacobian.fields.protocol import Field
from jacobian.immutable import replaced
from jacobian.relatives.signed import SignedDivisor, SignedGroup

if TYPE_CHECKING:
    from integrable.phase.state import State
    from integrable.phase.upright import ChaplyginTransformation


class Translation(Move):
    """The map that adds the divisor [multiple](Σ (x_k, y_k) − points at infinity) to a state's divisor.

    ``points`` are one or two abscissas, real or a complex-conjugate pair, or functions x'(h1, h2) of the integrals,
    written with Python's operators. ``sheets`` are the signs of y_k = ±√f(x_k); ``signs`` are those of the roots
    √U'(a_i), which decide the signs of γ. :meth:`System.translation` and :meth:`System.torsion` create translations.
    ``2 * step`` is the double, ``-step`` the inverse, and ``@`` composes.

    H1 and H2 are always preserved. The bracket of :meth:`System.poisson` is preserved for points of fixed abscissa, the
    branch points a_i, 1/d and h1/h2 (:func:`moving_branch_point`), :func:`on_line`, and their sums. A generic
    x'(h1, h2) changes it. The map commutes with the flow in τ, but not with the flow in t (d ≠ 0). NotASquare if the
    image is not real (or not over the field), NotRepresentable if it has no representative.
    """

    _caches = ("_last", "_upright")
    _last: tuple[Any, ...] | None = None
    _upright: tuple[PhaseSpace, Translation] | None = None

    def __init__(
        self,
        system: PhaseSpace,
        points: Iterable[Abscissa],
        sheets: Sequence[int] | None = None,
        signs: Sequence[int] | None = None,
        multiple: int = 1,
    ) -> None:
        self.system = system
        self.points = _abscissas(system, points)
        self.sheets = checked_signs(sheets, len(self.points), "sheets")
        self.signs = checked_signs(signs, 3, "signs")
        self.multiple = checked_multiple(multiple)
        check_doublings(system.field, self.multiple, "multiple")
        K: Any = system.field
        self._rounding: Any = None if K.exact else K.eps
        twice = len(self.points) == 2 and self.points[0] == self.points[1]
        branch = system.body.rolls and self.points[0] == K.inv(system.d)
        if twice and (branch or self.sheets[0] != self.sheets[1]):
            raise self._cancelling(*self.points)

    def __repr__(self) -> str:
        points = ", ".join(map(str, self.points))
        return f"<addition of {self.multiple}·({points}) on {self.system!r}>"

    def __mul__(self, m: int) -> Translation:
        return Translation(self.system, self.points, self.sheets, self.signs, self.multiple * checked_multiple(m))

    __rmul__ = __mul__

    def __neg__(self) -> Translation:
        return self * -1

    def over(self, system: Any) -> Translation:
        return Translation(system, self.points, self.sheets, self.signs, self.multiple)

    def wider(self, system: Any) -> Translation:
        """The same map over a field of more digits: a_i and 1/d become those of ``system``."""
        K, body = self.system.field, self.system.body
        same = dict(zip(body.a, system.a, strict=True))
        if body.rolls:
            same[K.inv(body.d)] = system.field.inv(system.d)
        points = [same.get(x, x) for x in self.points]
        moved = Translation(system, points, self.sheets, self.signs, self.multiple)
        return replaced(moved, _rounding=self._rounding, guarded=True)

    def _condition(self, state: State) -> float:
        """The amplification of rounding errors. Its causes are a small distance δ of D' from zero (a factor of 1/δ),
        cancellation in f(x') and between two points, and the multiple. The value is inf beyond the range of floats.
        """
        if not isinstance(self.system.field, InexactField):
            return 1.0
        try:
            found = self._condition_of_class(*self.system.integrals(state)[2:])
        except NotASquare:
            # f(x') may be negative, or negative only by rounding
            found = float(min(1 / self.system.field.eps, LARGEST))
        except (OverflowError, ZeroDivisionError):
            found = inf
        # every doubling loses at least a digit, and partial multiples may come near special positions
        times = min(abs(self.multiple), LARGEST)
        return found if times <= 2 else max(found, 1.0) * MOST_CONDITION * times * times

    def _condition_of_class(self, h1: Real, h2: Real) -> float:
        group, u, v = self._class(h1, h2)
        K, f = group.field, group.curve.f
        x = [apply(K, x, h1, h2) if callable(x) else _own(K, x) for x in self.points]
        found = [poly.size_at(f, y) / abs(poly.evaluate(K, f, y)) for y in x if not self._is_branch(y, h1, h2)]
        worst = max((float(y) ** 0.5 for y in found), default=1.0)
        if len(x) == 2 and x[0] != x[1]:
            worst = max(worst, float((abs(x[0]) + abs(x[1])) / abs(x[0] - x[1])))
        # if D' is near zero, V'/U' is large at every branch point, in units of √f/x²
        radius = max(map(abs, group.branch_points))
        near = min(
            float(abs(poly.evaluate(K, v, e)) / abs(value)) if (value := poly.evaluate(K, u, e)) else inf
            for e in group.branch_points
        )
        worst = max(worst, near * float(radius**2 / poly.size_at(f, radius) ** 0.5))
        # three more causes of loss: cancellation in U'(a_i), a distant branch point, and cancellation where the a_i are
        # close together
        values = [(poly.size_at(u, e), abs(poly.evaluate(K, u, e))) for e in self.system.a]
        worst = max([worst, *(float(size / value) for size, value in values if value)])
        worst = max([worst, *(float(abs(y) / radius) for y in x if self._is_branch(y, h1, h2))])
        worst *= body_condition(self.system)
        return worst if isfinite(worst) else inf

    def _image(self, state: State) -> State:
        system, body = self.system, self.system.body
        pairs = coordinates.to_pairs(body, state)
        u, v = coordinates.to_mumford(body, pairs)
        h1, h2 = system.integrals(state)[2:]
        group, move = self._move(h1, h2)
        total = group.add(SignedDivisor(u, v, pairs, coordinates.kappas(body)), move)
        return coordinates.from_pairs(body, total.pairs)

    def divisor(self, state: State[Element]) -> Divisor[Element]:
        """The divisor [multiple]D' in the group of a state's curve. It exists even if the state has no image over the
        field.
        """
        if self.system._checked(state).tilted:
            step, plain, _ = self._transformed(state)
            return step.divisor(plain)
        h1, h2 = self.system.integrals(state)[2:]
        _, u, v = self._class(h1, h2)
        found: Divisor = self.system.group(h1, h2).from_mumford(u, v)
        return self.multiple * found

    def _transformed(self, state: State) -> tuple[Translation, State, ChaplyginTransformation]:
        """(step, state, transformation) for a tilted state: the step on the body of :meth:`System.upright`, with 1/d of
        that body, and the upright state.
        """
        system, plain, change = self.system.upright(state)
        if self._upright is None or self._upright[0] != system:
            points = self.points
            if system.body.rolls:
                K = self.system.field
                branch, image = K.inv(self.system.d), K.inv(system.d)
                points = tuple(image if x == branch else x for x in points)
            step = Translation(system, points, self.sheets, self.signs, self.multiple)
            vars(self)["_upright"] = (system, replaced(step, _rounding=self._rounding))
        assert self._upright is not None
        return self._upright[1], plain, change

    def _move(self, h1: Real, h2: Real) -> tuple[SignedGroup, SignedDivisor]:
        """[multiple]D' with its signed roots, on the curve of (h1, h2); cached, because an orbit stays on one curve."""
        group, u, v = self._class(h1, h2)
        assert self._last is not None
        if len(self._last) == 5:
            vars(self)["_last"] = (*self._last, self._signed(group, u, v))
        return group, self._last[5]

    def _class(self, h1: Real, h2: Real) -> tuple[SignedGroup, poly.Poly, poly.Poly]:
        """The group of the curve of (h1, h2), and (u, v) of D' = Σ (x_k, y_k) − points at infinity; cached."""
        if not self._is_last(h1, h2):
            system = self.system
            group = SignedGroup(system.curve(h1, h2), coordinates.branch_points(system.body))
            vars(self)["_last"] = (h1, h2, group, *self._mumford(group, h1, h2))
        assert self._last is not None
        return self._last[2], self._last[3], self._last[4]

    def _is_last(self, h1: Real, h2: Real) -> bool:
        """Whether D' is cached for this curve. With guard digits (h1, h2) may differ from the cached ones by
        rounding.
        """
        if self._last is None:
            return False
        K = self.system.field
        if K.exact or self._rounding <= K.eps:
            return self._last[:2] == (h1, h2)
        return all(abs(x - y) <= K.eps**0.75 * abs(y) for x, y in zip((h1, h2), self._last, strict=False))

    def _signed(self, group: SignedGroup, u: poly.Poly, v: poly.Poly) -> SignedDivisor:
        if self.multiple % 2:
            return group.multiple(self.multiple, self._lifted(group, u, v))
        # for the double of any divisor (U, V) the roots of U at the branch points are in the field
        move = group.multiple(self.multiple // 2, group.double(group.twist(u, v)))
        neg = self.system.field.neg
        signed = zip(move.pairs, (*self.signs, 1), strict=False)
        return move._replace(pairs=tuple((x, y) if sign > 0 else (neg(x), neg(y)) for (x, y), sign in signed))

    def _lifted(self, group: SignedGroup, u: poly.Poly, v: poly.Poly) -> SignedDivisor:
        try:
            return group.lift(u, v, (*self.signs, 1)[: len(group.branch_points)])
        except NotASquare:
            raise NotASquare(
                f"points = ({', '.join(map(written, self.points))}): the image of a state is not over "
                f"{group.field.name}, because a root √U'(a_i) is not; over the reals take two points on one oval, "
                "one or two beyond 1/d, or a conjugate pair; or an even multiple"
            ) from None

    def _mumford(self, group: SignedGroup, h1: Real, h2: Real) -> tuple[poly.Poly, poly.Poly]:
        K, f = group.field, group.curve.f
        if any(isinstance(x, complex) or hasattr(x, "_mpc_") for x in self.points):
            return self._conjugate_pair(K, f)
        x = [apply(K, x, h1, h2) if callable(x) else x for x in self.points]
        y = [
            K.zero if self._is_branch(e, h1, h2) else self._ordinate(K, f, e, sheet)
            for e, sheet in zip(x, self.sheets, strict=True)
        ]
        if len(y) == 1:
            return (K.neg(x[0]), K.one), poly.trim(K, (y[0],)) if K.exact else (y[0],)
        x1, x2 = x
        if x1 == x2:
            if y[0] != y[1] or y[0] == K.zero:
                raise self._cancelling(x1, x2)
            slope = K.div(poly.evaluate(K, poly.derivative(K, f), x1), K.add(y[0], y[0]))
            u, v = poly.from_roots(K, x), (K.sub(y[0], K.mul(slope, x1)), slope)
        else:
            u, v = poly.through(K, list(zip(x, y, strict=True)))
        return u, poly.trim(K, v) if K.exact else v

    @staticmethod
    def _cancelling(first: Any, second: Any) -> ArgumentError:
        return ArgumentError(f"points = ({written(first)}, {written(second)}): a point and its opposite add up to zero")

    def _is_branch(self, x: Any, h1: Real, h2: Real) -> bool:
        """Whether x is a root of f: one of the a_i, 1/d, or h1/h2 (up to rounding over an inexact field)."""
        K, system = self.system.field, self.system
        if x in system.a or (system.body.rolls and x == K.inv(system.d)):
            return True
        rest = K.sub(K.mul(x, h2), h1)
        return bool(rest == K.zero if K.exact else abs(rest) <= 4 * self._rounding * abs(h1))

    @staticmethod
    def _ordinate(K: Field, f: poly.Poly, x: Real, sheet: int) -> Any:
        value = poly.evaluate(K, f, x)
        try:
            y = K.sqrt(value)
        except NotASquare:
            raise NotASquare(
                f"points: f({written(x)}) = {written(value)} has no square root in {K.name}: no point of the curve "
                "lies there"
            ) from None
        return y if sheet > 0 else K.neg(y)

    def _conjugate_pair(self, K: Field, f: poly.Poly) -> tuple[poly.Poly, poly.Poly]:
        z = _own(K, self.points[0])
        value = poly.evaluate(K, f, z)
        y = value**0.5 if self.sheets[0] > 0 else -(value**0.5)
        slope = y.imag / z.imag
        return (K.coerce(abs(z) ** 2), -2 * z.real, K.one), (y.real - slope * z.real, slope)


def moving_branch_point(h1: Real, h2: Real) -> Real:
    """The abscissa h1/h2 of the branch point that depends on the integrals; one of the ``points`` of a Translation."""
    abscissa: Real = h1 / h2
    return abscissa


def on_line(c0: Value, c1: Value) -> Callable[[Real, Real], Real]:
    """The abscissa x' that solves h1 − x'h2 = c0 + c1·x', for ``points``. The square of its ordinate, y'² = φ(x')(c0 +
    c1·x') with φ of :mod:`integrable.phase.separation`, is then fixed.
    """

    def abscissa(h1: Any, h2: Real) -> Any:
        K = h1.field
        return K.div(K.sub(h1, c0), K.add(h2, c1))

    return abscissa


def _abscissas(system: PhaseSpace, points: Iterable[Abscissa]) -> tuple[Any, ...]:
    K = system.field
    given = entries(points, "points", "a sequence of one or two abscissas x'")
    if len(given) not in (1, 2):
        raise ArgumentError(f"points = {shown(points)}: give one or two abscissas x'")
    if len(given) == 1 and not system.body.rolls:
        raise ArgumentError(f"points = {shown(points)}: at d = 0 give two abscissas; one point and ∞ needs d > 0")
    complex_ones = [x for x in given if isinstance(x, complex) or hasattr(x, "_mpc_")]
    if not complex_ones:
        return tuple(x if callable(x) else K.coerce(x, f"points[{i}]") for i, x in enumerate(given))
    if K.exact or len(complex_ones) != 2 or given[0] != given[1].conjugate() or not 0 < abs(given[0].imag) < inf:
        raise ArgumentError(
            f"points = {shown(points)}: complex abscissas come as a conjugate pair (z, z̄) of finite numbers, over RR "
            "or MP"
        )
    K.coerce(given[0].real, "points[0].real")
    return tuple(given)


def _own(K: Any, x: Any) -> Any:
    """The abscissa x. A complex x over MP becomes a complex number with the digits of MP, without rounding."""
    return K.context.mpc(x) if not K.exact and K.dps and (isinstance(x, complex) or hasattr(x, "_mpc_")) else x
