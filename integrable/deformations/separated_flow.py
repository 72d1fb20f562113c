"""The geodesic flows of the tilde, check and hat pairs, by an addition on each of two elliptic curves.

In ũ_k, the roots of Σ w_i²/(x − a_i), w = γ × M, the flow of H = λ1 + λ2 separates: ũ_k' = y_k, y_k² = λ_kφ(ũ_k), φ(x)
= 4(dx − 1)Π(a_i − x), with λ_k constant, λ1 > 0 > λ2, and ' = d/dτ, dτ = g dt. Z = μ_k·ũ/(1 − dũ), μ_k = λ_kΠ(1 −
da_i), brings each curve to Z'² = 4Π(Z − e_i), e_i = μ_k/I_i, on which the motion is an addition
(:mod:`integrable.deformations.oval`), written by theta functions: any τ costs the same. (The separation: Tsiganov.)
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from integrable.deformations.deformed_flow import CurvesCarrier, DeformedFlow, at_its_precision
from integrable.deformations.oval import SeparatedOval, root_of_rounded
from integrable.moving_point.losses import digits_of
from integrable.phase.body import cross
from integrable.phase.isometry import lift, roots
from integrable.phase.state import State
from jacobian.errors import ArgumentError, NotRepresentable, shown

__all__ = ["IsometricFlow", "SeparatedFlow"]

if TYPE_CHECKING:
    from integrable.deformations.ovals_clock import OvalsClock


class SeparatedFlow(DeformedFlow):
    """The motion of a tilde pair without potential through a state; ``system.flow`` returns it.

    At d ≠ 0 a Fourier series on the torus gives physical times (:mod:`integrable.deformations.ovals_clock`).
    NotRepresentable if moments are equal or a λ_k vanishes (K = 0: a curve degenerates).
    """

    def _moving(self, system: Any, state: State) -> CurvesCarrier:
        return OvalCarrier(system, state)

    def translated(self, time_of: Any) -> State:
        """The state after an addition of a point on each of the curves k = 0, 1.

        On curve k the motion adds this point in the time ``time_of(k, field, μ_k, μ_k/I_i)``.
        """
        many = self._curves.many
        while True:
            carrier: Any = many.carrier
            times = carrier.times_of(time_of)
            # None: digits were added for the number of periods, and the carrier is new
            if many.enough(max(map(abs, times))) is None:
                continue
            moved = carrier.moved(times)
            missing = carrier.drift([moved]) + many.digits
            if missing <= 0:
                break
            many.add_digits(min(missing, carrier.field.dps))
        x1, x2, x3, m1, m2, m3 = self._curves.rows([moved])[0].tolist()
        return State((x1, x2, x3), (m1, m2, m3))


class IsometricFlow(DeformedFlow):
    """The motion of a check or hat pair: the motion of the tilde pair of A⁻¹ at another speed, lifted back."""

    def _moving(self, system: Any, state: State) -> CurvesCarrier:
        return LiftedCarrier(system, state)


class OvalCarrier(CurvesCarrier):
    """The motion of a tilde pair over the numbers of ``system``."""

    def __init__(self, system: Any, state: State) -> None:
        self.system, self.start = system, state
        body, K = system.body, system.field
        if any(c == 0 for c in body.differences):
            raise NotRepresentable(
                "two moments of inertia are equal: the separated variables do not tell how γ turns; "
                "motion_through(state) integrates"
            )
        h2 = K.dot(state.M, state.M)
        if h2 == 0:
            raise ArgumentError("M = (0, 0, 0): at rest; a flow needs M ≠ 0")
        H, second = system.integrals(state)[2:]
        self.lambdas = _eigenvalues(K, H, second)
        if any(abs(x) <= 64 * K.eps * h2 * max(system.a) for x in self.lambdas):
            raise NotRepresentable(
                f"λ = {shown(self.lambdas)}: K vanishes, and one of the two curves degenerates; "
                "motion_through(state) integrates"
            )
        self.sizes = self.lambdas[0] - self.lambdas[1], abs(second)
        self.roots_of_weights = [r / root_of_rounded(K, c) for r, c in zip(body.contact, body.differences, strict=True)]
        self._middle = sorted(range(3), key=lambda i: body.inertia[i])[1]
        spin = root_of_rounded(K, h2)
        e, slope = ([x / spin for x in v] for v in _image(K, state, _rate(system, state), h2))
        gaps, turns = _separated(body, e, slope)
        product = body.contact[0] * body.contact[1] * body.contact[2]
        self.mu = [value * product for value in self.lambdas]
        self.curves = [_oval(body, mu, row, turn) for mu, row, turn in zip(self.mu, gaps, turns, strict=True)]
        self.signs, self.side = _signs(self.curves, e, slope), 1
        found = self._state(*(curve.start for curve in self.curves))[0]
        self.side = 1 if sum(x * y for x, y in zip(found, state.gamma, strict=True)) > 0 else -1

    @property
    def period(self) -> Any:
        """The shorter of the two periods."""
        return min(curve.period for curve in self.curves)

    @at_its_precision
    def turns(self, tau: Any) -> Any:
        return abs(tau) / self.period

    @at_its_precision
    def most_tau(self, t: Any) -> Any:
        # 1/g² is smallest, 1 − da_i, where γ is along the axis of the smallest moment
        return t / root_of_rounded(self.field, min(self.system.body.contact))

    @at_its_precision
    def tau(self, times: list[Any], digits: int) -> list[Any]:
        return [self.field.coerce(x) for x in self.clock(digits).tau(times)]

    @at_its_precision
    def times(self, tau: list[Any], digits: int) -> list[Any]:
        return [self.field.coerce(t) for t in self.clock(digits).times(tau)]

    @at_its_precision
    def clock_missing(self, tau: Any, digits: int) -> int:
        rate = self.pace(*(self.z(k, curve.moved(tau)) for k, curve in enumerate(self.curves)))
        return digits_of(self.clock(digits).defect(tau, rate)) + digits

    def clock(self, digits: int) -> OvalsClock:
        from integrable.deformations.ovals_clock import OvalsClock

        if self._clocks is None or self._clocks.digits < digits:
            self._clocks = OvalsClock(self, digits)
        return self._clocks

    _clocks: OvalsClock | None = None

    @cached_property
    def weights(self) -> tuple[Any, Any]:
        """The weights of 1 + dz_k in g²: both positive, with the sum 1."""
        one, two = self.lambdas
        return one / (one - two), -two / (one - two)

    def z(self, k: int, r: Sequence[Any]) -> Any:
        """z = Z/μ_k at the roots R_i on curve k."""
        return self.curves[k].height(r) / self.mu[k]

    def pace(self, first: Any, second: Any) -> Any:
        """dt/dτ = 1/g from z on both curves: g² = Σ|λ_k|(1 + dz_k)/Σ|λ_k|."""
        one, two = self.weights
        d = self.system.d
        return 1 / root_of_rounded(self.field, one * (1 + d * first) + two * (1 + d * second))

    @at_its_precision
    def point(self, tau: Any) -> tuple[list[Any], list[Any]]:
        return self.moved([tau, tau])

    @at_its_precision
    def times_of(self, time_of: Any) -> list[Any]:
        """The time on each curve for :meth:`SeparatedFlow.translated`."""
        return [time_of(k, self.field, mu, c.e) for k, (mu, c) in enumerate(zip(self.mu, self.curves, strict=True))]

    @at_its_precision
    def moved(self, times: list[Any]) -> tuple[list[Any], list[Any]]:
        """(γ, M) after the point of each curve has moved for its time in ``times``."""
        return self._state(*(curve.moved(time) for curve, time in zip(self.curves, times, strict=True)))

    def _state(self, first: Any, second: Any) -> tuple[list[Any], list[Any]]:
        """(γ, M) from the roots R_i on both curves."""
        body, K = self.system.body, self.field
        one, two = self.curves
        e = [s * c * x * y for s, c, x, y in zip(self.signs, self.roots_of_weights, first, second, strict=True)]
        length = root_of_rounded(K, K.dot(e, e))
        f = [1 / (1 + body.d * self.z(k, r)) for k, r in enumerate((first, second))]
        # ũ2 − ũ1 as a sum without cancellation, since the two lie on opposite sides of the middle a_i
        middle = self._middle
        gap = f[0] * f[1] * (first[middle] ** 2 / abs(self.mu[0]) + second[middle] ** 2 / abs(self.mu[1]))
        scale = 2 * length * f[0] * f[1] / (self.mu[0] * self.mu[1] * gap)
        n = []
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            left = first[j] * first[k] * f[0] * two.signs[i] * second[i]
            right = second[j] * second[k] * f[1] * one.signs[i] * first[i]
            divisor = self.signs[i] * self.roots_of_weights[i] * body.differences[i]
            n.append(scale * body.contact[i] * (left - right) / divisor)
        e = [x / length for x in e]
        square = sum(x * x / r for x, r in zip(e, body.contact, strict=True))
        lean = sum(x * y / r for x, y, r in zip(e, n, body.contact, strict=True)) / square
        gamma = [(lean * x - y) / r for x, y, r in zip(e, n, body.contact, strict=True)]
        size = self.side * root_of_rounded(K, K.dot(gamma, gamma))
        gamma = [x / size for x in gamma]
        momentum = self.side * root_of_rounded(K, (self.lambdas[0] - self.lambdas[1]) / gap)
        x1, x2, x3 = (momentum * x for x in e)
        return gamma, list(cross(K, (x1, x2, x3), (gamma[0], gamma[1], gamma[2])))


class LiftedCarrier(CurvesCarrier):
    """The motion of a check or hat pair over the numbers of ``system``: the lifted motion of a tilde pair."""

    def __init__(self, system: Any, state: State) -> None:
        self.system, self.start = system, state
        K = system.field
        squares, self.speed, tilde = system.isometry()
        self._roots = roots(K, squares)
        self.back = [1 / b for b in self._roots]
        gamma, M = lift(K, self._roots, state.gamma, state.M)
        self.tilde = OvalCarrier(tilde, State(gamma, M))
        self.sizes = abs(self.speed) * self.tilde.sizes[0], abs(system.integrals(state).K)

    @at_its_precision
    def turns(self, tau: Any) -> Any:
        return self.tilde.turns(self.speed * tau)

    @at_its_precision
    def point(self, tau: Any) -> tuple[Any, Any]:
        gamma, M = self.tilde.point(self.speed * tau)
        return lift(self.field, self.back, (gamma[0], gamma[1], gamma[2]), (M[0], M[1], M[2]))


def _eigenvalues(K: Any, H: Any, second: Any) -> tuple[Any, Any]:
    """λ1 ≥ 0 ≥ λ2 with H = λ1 + λ2, K = −λ1λ2; the smaller is computed from the larger without cancellation."""
    spread = root_of_rounded(K, H * H + 4 * abs(second))
    if H >= 0:
        one = (H + spread) / 2
        return one, -second / one
    two = (H - spread) / 2
    return -second / two, two


def _rate(system: Any, state: State) -> State:
    """The derivatives (γ, M)' with respect to τ."""
    rate = system.vector_field(state)
    slow = system.body.conformal(state.gamma) ** (system.field.one / 2)
    return State(tuple(slow * x for x in rate.gamma), tuple(slow * x for x in rate.M))


def _image(K: Any, state: State, rate: State, h2: Any) -> tuple[list[Any], list[Any]]:
    """The vectors w = γ × M and |M|·(w/|M|)'."""
    w = cross(K, state.gamma, state.M)
    moved = [x + y for x, y in zip(cross(K, rate.gamma, state.M), cross(K, state.gamma, rate.M), strict=True)]
    growth = sum(x * y for x, y in zip(state.M, rate.M, strict=True)) / h2
    return list(w), [x - growth * y for x, y in zip(moved, w, strict=True)]


def _separated(body: Any, e: Any, slope: Any) -> tuple[list[list[Any]], list[int]]:
    """ũ_k − a_i for both roots ũ1 < ũ2 of U(x) = Σe_i²(x − a_j)(x − a_k), and the signs of ũ_k'."""
    gaps = interlaced(body, [x * x for x in e])
    turns = []
    for k in range(2):
        change = sum(x * y * gaps[k][i - 2] * gaps[k][i - 1] for i, (x, y) in enumerate(zip(e, slope, strict=True)))
        # U'(ũ_k)ũ_k' = −change, and U' has the sign of ũ_k − ũ_other
        turns.append(1 if (change >= 0) == (k == 0) else -1)
    return gaps, turns


def interlaced(body: Any, squares: Sequence[Any]) -> list[list[Any]]:
    """ũ_k − a_i for both roots ũ1 < ũ2 of U(x) = Σ squares_i(x − a_j)(x − a_k), squares ≥ 0 with the sum 1.

    They are computed as roots in x − a_middle, and from (ũ1 − a_i)(ũ2 − a_i) = U(a_i) = c_i·squares_i. Differences of
    nearly equal numbers would cost half the digits of √|ũ_k − a_i| at a turning point.
    """
    K, c = body.field, body.differences
    low, middle, high = sorted(range(3), key=lambda i: body.a[i])

    def apart(i: int, j: int) -> Any:
        return (body.inertia[j] - body.inertia[i]) * body.a[i] * body.a[j]

    below, above = apart(middle, low), apart(high, middle)
    total = squares[high] * below - squares[low] * above + squares[middle] * (below - above)
    product = abs(c[middle]) * squares[middle]
    larger = (abs(total) + root_of_rounded(K, total * total + 4 * product)) / 2
    smaller = product / larger if larger else larger
    first, second = (larger, smaller) if total >= 0 else (smaller, larger)
    gaps = [[K.zero] * 3, [K.zero] * 3]
    gaps[0][middle], gaps[1][middle] = -first, second
    gaps[0][high], gaps[1][low] = -first - above, second + below
    gaps[0][low] = c[low] * squares[low] / gaps[1][low]
    gaps[1][high] = c[high] * squares[high] / gaps[0][high]
    return gaps


def _oval(body: Any, mu: Any, gaps: Any, turn: int) -> SeparatedOval:
    """The curve through the point with ũ − a_i = ``gaps``: Z − e_i = μ(ũ − a_i)/((1 − dũ)(1 − da_i))."""
    K = body.field
    # 1 − dũ = (1 − da_i) − d(ũ − a_i), from the smallest ũ − a_i
    slow = next(r - body.d * x for r, x in sorted(zip(body.contact, gaps, strict=True), key=lambda pair: abs(pair[1])))
    sizes = [root_of_rounded(K, mu * x / (slow * r)) for x, r in zip(gaps, body.contact, strict=True)]
    inertia = body.inertia

    def gap(i: int, j: int) -> Any:
        return mu * (inertia[j] - inertia[i]) / (inertia[i] * inertia[j])

    return SeparatedOval(K, [mu / x for x in inertia], gap, sizes, turn if mu > 0 else -turn)


def _signs(curves: list[SeparatedOval], e: Any, slope: Any) -> list[int]:
    """The signs of e_i = ±const·R_i(curve 1)R_i(curve 2), from e_i and its derivative, which do not both vanish."""
    one, two = curves
    result = []
    for i in range(3):
        j, k = i - 2, i - 1
        p, q = one.start, two.start
        rate = one.signs[i] * p[j] * p[k] * q[i] + two.signs[i] * q[j] * q[k] * p[i]
        match = p[i] * q[i] * e[i] * (one.breadth + two.breadth) + rate * slope[i]
        result.append(1 if match > 0 else -1)
    return result
