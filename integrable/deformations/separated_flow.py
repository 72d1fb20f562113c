"""The geodesic flows of the tilde, check and hat pairs, by an addition on each of two elliptic curves.

Let ũ_k be the roots of Σ w_i²/(x − a_i), w = γ × M, φ(x) = 4(dx − 1)Π(a_i − x), and ' = d/dτ with dτ = g dt. In the ũ_k
the flow of H = λ1 + λ2 separates: ũ_k' = y_k and y_k² = λ_kφ(ũ_k) with constant λ_k, λ1 > 0 > λ2. With μ_k = λ_kΠ(1 −
da_i), the map Z = μ_k·ũ/(1 − dũ) brings each curve to Z'² = 4Π(Z − e_i), e_i = μ_k/I_i
(:mod:`integrable.deformations.oval`). There the motion is an addition, computed by theta functions, so any τ costs the
same. (The separation is Tsiganov's.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from integrable.deformations.carrier import CurvesCarrier
from integrable.deformations.deformed_flow import DeformedFlow
from integrable.deformations.equations import right_hand_sides
from integrable.deformations.oval import Pace, SeparatedOval, root_of_rounded
from integrable.deformations.oval_loops import Frame
from integrable.deformations.ovals_clock import OvalsClock
from integrable.moving_point.losses import digits_of
from integrable.phase.body import Body, cross
from integrable.phase.isometry import lift, roots
from integrable.phase.state import State
from jacobian.element import Real
from jacobian.errors import ArgumentError, NotRepresentable, shown
from jacobian.inexact.long_numbers import LongNumbers

__all__ = ["SeparatedFlow"]

TimeOf = Callable[[int, LongNumbers, Real, Sequence[Real]], Real]
"""The time in which the motion on curve k adds a point: a function of k, the field, μ_k and the μ_k/I_i."""


class OvalCarrier(CurvesCarrier):
    """The motion of a tilde, check or hat pair over the field of ``system``.

    ``pair`` is the tilde pair on whose curves it moves: ``system`` itself, or the tilde pair of A⁻¹.
    """

    pace: Pace

    def __init__(self, system: Any, state: State) -> None:
        super().__init__(system, state)
        isometry, K = system.isometry(), system.field
        back: Sequence[Real] = (K.one,) * 3
        if isometry is not None:
            diagonal = roots(K, isometry.squares)
            back, self.speed, system = [1 / b for b in diagonal], isometry.factor, isometry.pair
            state = State(*lift(K, diagonal, *state.vectors))
        self.pair, body = system, system.body
        check_distinct(body)
        _, M = state.vectors
        h2 = K.dot(M, M)
        if h2 == 0:
            raise ArgumentError("M = (0, 0, 0): at rest; a flow needs M ≠ 0")
        H, second = system.integrals(state)[2:]
        self.lambdas = _eigenvalues(K, H, second)
        if any(abs(x) <= 64 * K.eps * h2 * max(system.a) for x in self.lambdas):
            raise NotRepresentable(
                f"λ = {shown(self.lambdas)}: K vanishes, and one of the two curves degenerates; "
                "motion_through(state) integrates"
            )
        spin = root_of_rounded(K, h2)
        e, slope = (
            [x / spin for x in v] for v in _image(K, state, right_hand_sides(system, physical=False)(state.row), h2)
        )
        self._on_curves(e, slope)
        sizes = self.lambdas[0] - self.lambdas[1], abs(second)
        self.frame = Frame(self._numbers(e, slope), [back[i] for i in self.order], isometry is not None, False, sizes)
        self.sizes = (
            sizes if isometry is None else (abs(self.speed) * sizes[0], abs(self.system.integrals(self.start).K))
        )
        found = self._state(*(curve.start for curve in self.curves))[0]
        if sum(x * y for x, y in zip(found, self.start.vectors[0], strict=True)) < 0:
            # the last number is the sign of γ and M
            self.frame.numbers[-1] = -K.one

    def _on_curves(self, e: Sequence[Real], slope: Sequence[Real]) -> None:
        """Makes the curves through the image e = w/|M| of the start and its derivative ``slope``."""
        body = self.pair.body
        gaps, turns = _separated(body, e, slope)
        product = body.contact[0] * body.contact[1] * body.contact[2]
        self.mu = [value * product for value in self.lambdas]
        self.curves = [
            _oval(self.field, body, mu, row, turn) for mu, row, turn in zip(self.mu, gaps, turns, strict=True)
        ]
        self.tracks = [curve.track(mu, self.field.zero) for curve, mu in zip(self.curves, self.mu, strict=True)]
        spread = self.lambdas[0] - self.lambdas[1]
        weights = [abs(value) / spread for value in self.lambdas]
        self.pace = Pace(self.field, body.d, self.curves, self.tracks, self.mu, weights)
        self.order = sorted(range(3), key=lambda i: body.inertia[i])

    def _numbers(self, e: Sequence[Real], slope: Sequence[Real]) -> list[Real]:
        """The numbers of the :class:`Frame`, with the sign 1 of γ and M."""
        K, body, order = self.field, self.pair.body, self.order
        roots_of_weights = [r / root_of_rounded(K, c) for r, c in zip(body.contact, body.differences, strict=True)]
        weights = [s * w for s, w in zip(_signs(self.curves, e, slope), roots_of_weights, strict=True)]
        leans = [r / (w * c) for r, w, c in zip(body.contact, weights, body.differences, strict=True)]
        axes = [row[i] for row in (weights, body.contact, leans, body.a) for i in order]
        odd = order in ([0, 2, 1], [1, 0, 2], [2, 1, 0])
        return [*axes, body.d, *self.mu, *self.lambdas, -K.one if odd else K.one, K.one]

    def most_tau(self, t: Real) -> Real:
        # 1/g² is smallest, 1 − da_i, where γ is along the axis of the smallest moment
        return t / root_of_rounded(self.field, min(self.pair.body.contact))

    def tau(self, times: list[Real], digits: int) -> list[Real]:
        return [self.field.coerce(x) for x in self.clock(digits).tau(times)]

    def times(self, tau: list[Real], digits: int) -> list[Real]:
        return [self.field.coerce(t) for t in self.clock(digits).times(tau)]

    def clock_missing(self, tau: Real, digits: int) -> int:
        return digits_of(self.clock(digits).defect(tau, self.pace.at((tau, tau)))) + digits

    def clock(self, digits: int) -> OvalsClock:
        if self._clocks is None or self._clocks.digits < digits:
            self._clocks = OvalsClock(self.pace, digits)
        return self._clocks

    _clocks: OvalsClock | None = None

    def times_of(self, time_of: TimeOf) -> list[Real]:
        """The time on each curve from ``time_of``, for :meth:`SeparatedFlow.translated`."""
        return [time_of(k, self.field, mu, c.e) for k, (mu, c) in enumerate(zip(self.mu, self.curves, strict=True))]


class SeparatedFlow(DeformedFlow):
    """The motion of a tilde, check or hat pair without potential through a state; ``system.flow`` returns it.

    At d ≠ 0 a Fourier series on the torus gives physical times (:mod:`integrable.deformations.ovals_clock`).
    NotRepresentable if moments are equal or a λ_k vanishes (K = 0: a curve degenerates).
    """

    _carrier = OvalCarrier

    def translated(self, time_of: TimeOf) -> State:
        """The state after an addition of a point on each of the curves k = 0, 1.

        On curve k the motion adds this point in the time ``time_of(k, field, μ_k, μ_k/I_i)``.
        """
        many = self._many

        def compute(carrier: Any, _: object) -> tuple[Any, int] | None:
            times = carrier.times_of(time_of)
            if many.enough(max(map(abs, times)) / abs(carrier.speed)) is None:
                return None
            moved = carrier.moved(times)
            return moved, carrier.drift([moved]) + many.digits

        moved = many.settled([], compute)
        x1, x2, x3, m1, m2, m3 = self._curves.rows([moved])[0].tolist()
        return State((x1, x2, x3), (m1, m2, m3))


def check_distinct(body: Body) -> None:
    """Raises NotRepresentable if two moments of inertia are equal."""
    if any(c == 0 for c in body.differences):
        raise NotRepresentable(
            "two moments of inertia are equal: the separated variables do not tell how γ turns; "
            "motion_through(state) integrates"
        )


def _eigenvalues(K: LongNumbers, H: Real, second: Real) -> tuple[Real, Real]:
    """λ1 ≥ 0 ≥ λ2 with H = λ1 + λ2, K = −λ1λ2; the smaller is computed from the larger without cancellation."""
    spread = root_of_rounded(K, H * H + 4 * abs(second))
    if H >= 0:
        one = (H + spread) / 2
        return one, -second / one
    two = (H - spread) / 2
    return -second / two, two


def _image(K: LongNumbers, state: State, rate: Sequence[Real], h2: Real) -> tuple[list[Real], list[Real]]:
    """The vectors w = γ × M and |M|·(w/|M|)', from (γ, M)' = ``rate``."""
    (gamma, M), turn, pull = state.vectors, (rate[0], rate[1], rate[2]), (rate[3], rate[4], rate[5])
    w = cross(K, gamma, M)
    moved = [x + y for x, y in zip(cross(K, turn, M), cross(K, gamma, pull), strict=True)]
    growth = sum(x * y for x, y in zip(M, pull, strict=True)) / h2
    return list(w), [x - growth * y for x, y in zip(moved, w, strict=True)]


def _separated(body: Body, e: Sequence[Real], slope: Sequence[Real]) -> tuple[list[list[Real]], list[int]]:
    """ũ_k − a_i for both roots ũ1 < ũ2 of U(x) = Σe_i²(x − a_j)(x − a_k), and the signs of ũ_k'."""
    gaps = interlaced(body, [x * x for x in e])
    turns = []
    for k in range(2):
        change = sum(x * y * gaps[k][i - 2] * gaps[k][i - 1] for i, (x, y) in enumerate(zip(e, slope, strict=True)))
        # U'(ũ_k)ũ_k' = −change, and U' has the sign of ũ_k − ũ_other
        turns.append(1 if (change >= 0) == (k == 0) else -1)
    return gaps, turns


def interlaced(body: Body, squares: Sequence[Real]) -> list[list[Real]]:
    """ũ_k − a_i for both roots ũ1 < ũ2 of U(x) = Σ squares_i(x − a_j)(x − a_k), squares ≥ 0 with the sum 1.

    The differences are computed as roots in x − a_middle, and from (ũ1 − a_i)(ũ2 − a_i) = U(a_i) = c_i·squares_i.
    Differences of nearly equal numbers would cost half the digits of √|ũ_k − a_i| at a turning point.
    """
    K, c = body.field, body.differences
    low, middle, high = sorted(range(3), key=lambda i: body.a[i])

    def apart(i: int, j: int) -> Real:
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


def _oval(K: LongNumbers, body: Body, mu: Real, gaps: Sequence[Real], turn: int) -> SeparatedOval:
    """The curve through the point with ũ − a_i = ``gaps``: Z − e_i = μ(ũ − a_i)/((1 − dũ)(1 − da_i))."""
    # 1 − dũ = (1 − da_i) − d(ũ − a_i) is computed with the smallest ũ − a_i
    slow = next(r - body.d * x for r, x in sorted(zip(body.contact, gaps, strict=True), key=lambda pair: abs(pair[1])))
    sizes = [root_of_rounded(K, mu * x / (slow * r)) for x, r in zip(gaps, body.contact, strict=True)]
    inertia = body.inertia

    def gap(i: int, j: int) -> Real:
        return mu * (inertia[j] - inertia[i]) / (inertia[i] * inertia[j])

    return SeparatedOval(K, [mu / x for x in inertia], gap, sizes, turn if mu > 0 else -turn)


def _signs(curves: Sequence[SeparatedOval], e: Sequence[Real], slope: Sequence[Real]) -> list[int]:
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
