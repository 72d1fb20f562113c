"""The geodesic flows of the tilde, check and hat pairs, by an addition on each of two elliptic curves.

Let ũ_k be the roots of Σ w_i²/(x − a_i), w = γ × M, φ(x) = 4(dx − 1)Π(a_i − x), and ' = d/dτ with dτ = g dt. In the ũ_k
the flow of H = λ1 + λ2 separates: ũ_k' = y_k and y_k² = λ_kφ(ũ_k) with constant λ_k, λ1 > 0 > λ2. With μ_k = λ_kΠ(1 −
da_i), the map Z = μ_k·ũ/(1 − dũ) brings each curve to Z'² = 4Π(Z − e_i), e_i = μ_k/I_i
(:class:`integrable.mumford.elliptic_torus.EllipticOval`). There the motion is an addition, computed by theta functions,
so any τ costs the same. (The separation is Tsiganov's.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from integrable.deformations.carrier import CurvePoint, CurvesCarrier, GammaM
from integrable.deformations.deformed_flow import DeformedFlow
from integrable.deformations.oval import Pace
from integrable.deformations.ovals_clock import OvalsClock, mean_of_pace
from integrable.deformations.scalars import dot
from integrable.motion.near import right_hand_sides
from integrable.moving_point.losses import digits_of
from integrable.mumford.elliptic_torus import EllipticOval
from integrable.phase.body import Body, Vector, cross
from integrable.phase.isometry import lift, roots
from integrable.phase.state import State, state_of_row
from integrable.torus.theta_series import half_turn
from jacobian.element import FormulaField, Real
from jacobian.errors import ArgumentError, NotRepresentable, shown
from jacobian.inexact.long_field import LongField

__all__ = ["SeparatedFlow"]

TimeOf = Callable[[int, EllipticOval, Real], Real]
"""The time for which the motion along curve k is the addition of a point: a function of k, the curve and μ_k."""
# the signs of R_i' = ±R_jR_k on the two curves, by axis
SLOPES = (-1, -1, 1), (1, -1, -1)


class FreeFrame(NamedTuple):
    """The constants from which the states of a pair without potential are computed. The axes are those of the tilde
    pair on whose curves the motion runs.

    ``spread`` is λ1 − λ2. w_i/|M| is proportional to ``weights``_i·p_iq_i, with the roots p_i and q_i = ±√|Z − μ_k/I_i|
    on the curves k = 1 and 2. ``leans``_i is the constant factor of N_i (:mod:`integrable.deformations.two_curves`),
    ``contact`` is 1 − da_i, ``side`` = ±1 the common sign of γ and M, which the points do not determine. ``back`` is
    the diagonal of the lift to a check or hat pair, empty if there is none.
    """

    d: Real
    mu: tuple[Real, Real]
    spread: Real
    weights: Vector
    leans: Vector
    contact: Vector
    side: Real
    back: tuple[Real, ...]


def free_state(N: FormulaField, frame: FreeFrame, first: CurvePoint, second: CurvePoint) -> GammaM:
    """(γ, M) of the tilde pair without potential, from the points on both curves, with axes in ascending order of the
    moments.
    """
    # the roots of curve k are in ascending order of μ_k/I_i. Since μ1 > 0 > μ2, the order of the axes is reversed on
    # the first curve
    p, q, (mu1, mu2) = first[2::-1], second[:3], frame.mu
    f1, f2 = 1 / (1 + frame.d * first[3]), 1 / (1 + frame.d * second[3])
    e = [w * x * y for w, x, y in zip(frame.weights, p, q, strict=True)]
    length = N.sqrt(dot(e, e))
    gap = f1 * f2 * (p[1] * p[1] / mu1 - q[1] * q[1] / mu2)
    scale = 2 * length * f1 * f2 / (mu1 * mu2 * gap)
    turns = [
        SLOPES[1][i] * q[i - 2] * q[i - 1] * f2 * p[i] - SLOPES[0][i] * p[i - 2] * p[i - 1] * f1 * q[i]
        for i in range(3)
    ]
    n = [scale * lean * x for lean, x in zip(frame.leans, turns, strict=True)]
    e = [x / length for x in e]
    over = [x / r for x, r in zip(e, frame.contact, strict=True)]
    lean = dot(over, n) / dot(over, e)
    x = [(lean * one - other) / r for one, other, r in zip(e, n, frame.contact, strict=True)]
    size, momentum = frame.side / N.sqrt(dot(x, x)), frame.side * N.sqrt(frame.spread / gap)
    gamma = (x[0] * size, x[1] * size, x[2] * size)
    return gamma, cross(N, (momentum * e[0], momentum * e[1], momentum * e[2]), gamma)


class OvalCarrier(CurvesCarrier):
    """The motion of a tilde, check or hat pair over the field of ``system``.

    ``pair`` is the tilde pair on whose curves the motion runs. For a tilde pair it is ``inner``, the system with its
    axes in ascending order of the moments; for a check or hat pair it is the tilde pair of A⁻¹.
    """

    pace: Pace
    frame: FreeFrame

    def __init__(self, system: Any, state: State) -> None:
        super().__init__(system, state)
        isometry, K, self.pair, state = self.inner.isometry(), self.field, self.inner, self.origin
        back: tuple[Real, ...] = ()
        if isometry is not None:
            diagonal = roots(K, isometry.squares)
            back, self.speed, self.pair = tuple(1 / b for b in diagonal), isometry.factor, isometry.pair
            state = State(*lift(K, diagonal, *state.vectors))
        check_distinct(self.pair.body)
        _, M = state.vectors
        h2 = K.dot(M, M)
        if h2 == 0:
            raise ArgumentError("M = (0, 0, 0): at rest; a flow needs M ≠ 0")
        H, second = self.before if isometry is None else self.pair.integrals(state)[2:]
        self.lambdas = _eigenvalues(K, H, second)
        if any(abs(x) <= 64 * K.eps * h2 * max(self.pair.a) for x in self.lambdas):
            raise NotRepresentable(
                f"λ = {shown(self.lambdas)}: K vanishes, and one of the two curves degenerates; "
                "motion_through(state) integrates"
            )
        self.sizes = abs(self.speed) * (self.lambdas[0] - self.lambdas[1]), abs(self.before[1])
        rate, spin = right_hand_sides(self.pair, physical=False)(state.row), K.sqrt(h2)
        e, slope = ([x / spin for x in v] for v in _image(K, state, rate, h2))
        self._on_curves(e, slope)
        self.frame = self._frame(e, slope, back)
        self.shown = x, M = self.moved((K.zero, K.zero))
        if dot(x, self.start.vectors[0]) < 0:
            self.frame, self.shown = self.frame._replace(side=-K.one), ((-x[0], -x[1], -x[2]), M)

    def _on_curves(self, e: Sequence[Real], slope: Sequence[Real]) -> None:
        """Makes both curves with their points at the start, from e = w/|M| there and its derivative ``slope``."""
        body, one = self.pair.body, self.field.one
        product = body.contact[0] * body.contact[1] * body.contact[2]
        self.mu = self.lambdas[0] * product, self.lambdas[1] * product
        gaps, turns = _separated(body, e, slope)
        self.curves = [_oval(self.field, body, *given) for given in zip(self.mu, gaps, turns, strict=True)]
        # z = Z/μ is 1/I_i at the branch points
        x, y, z = (one / moment for moment in body.inertia)
        self.levels = (z, y, x, one / self.mu[0]), (x, y, z, one / self.mu[1])
        spread = self.lambdas[0] - self.lambdas[1]
        weights = [abs(value) / spread for value in self.lambdas]
        self.pace = Pace(self.field, body.d, self.curves, self.levels, weights)

    def _frame(self, e: Sequence[Real], slope: Sequence[Real], back: tuple[Real, ...]) -> FreeFrame:
        """The :class:`FreeFrame` with ``side`` 1, from e = w/|M| at the start and its derivative ``slope``."""
        K, body = self.field, self.pair.body
        sizes = [r / K.sqrt(abs(c)) for r, c in zip(body.contact, body.differences, strict=True)]
        weights = [s * w for s, w in zip(_signs(self.curves, e, slope), sizes, strict=True)]
        leans = [r / (w * abs(c)) for r, w, c in zip(body.contact, weights, body.differences, strict=True)]
        spread = self.lambdas[0] - self.lambdas[1]
        return FreeFrame(body.d, self.mu, spread, tuple(weights), tuple(leans), body.contact, K.one, back)

    @staticmethod
    def read(N: FormulaField, system: Any, frame: Any, first: CurvePoint, second: CurvePoint) -> GammaM:
        gamma, M = free_state(N, frame, first, second)
        return lift(N, frame.back, gamma, M) if frame.back else (gamma, M)

    def most_tau(self, t: Real) -> Real:
        # 1/g² is smallest, 1 − da_i, where γ is along the axis of the smallest moment
        return t / self.field.sqrt(min(self.pair.body.contact))

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

    @property
    def slowness(self) -> Real:
        return mean_of_pace(self.pace, self.digits) if self.rolls else super().slowness

    @property
    def actions(self) -> list[Real]:
        # p_kdũ_k = λ_kdũ_k/y_k, and ∮dũ_k/y_k is the period
        return [abs(x) * c.period / (2 * half_turn()) for x, c in zip(self.lambdas, self.curves, strict=True)]


class SeparatedFlow(DeformedFlow):
    """The motion of a tilde, check or hat pair without potential through a state; ``system.flow`` returns it.

    If d ≠ 0, a Fourier series on the torus gives physical times (:mod:`integrable.deformations.ovals_clock`).
    NotRepresentable if moments are equal or a λ_k vanishes (K = 0: a curve degenerates).
    """

    _carrier = OvalCarrier

    def translated(self, time_of: TimeOf) -> State:
        """The state after an addition of a point on each of the curves k = 0, 1.

        The addition on curve k is the motion along this curve for the time ``time_of(k, curve, μ_k)``.
        """
        many = self._many

        def compute(carrier: Any, _: object) -> tuple[Any, int] | None:
            times = list(map(time_of, range(2), carrier.curves, carrier.mu))
            if many.enough(max(map(abs, times)) / abs(carrier.speed)) is None:
                return None
            moved = carrier.moved(times)
            return moved, carrier.drift([moved]) + many.digits

        moved = many.settled([], compute)
        return state_of_row(self._curves.rows([moved])[0].tolist())


def check_distinct(body: Body) -> None:
    """Raises NotRepresentable if two moments of inertia are equal."""
    if any(c == 0 for c in body.differences):
        raise NotRepresentable(
            "two moments of inertia are equal: the separated variables do not determine γ; "
            "motion_through(state) integrates"
        )


def _eigenvalues(K: LongField, H: Real, second: Real) -> tuple[Real, Real]:
    """λ1 ≥ 0 ≥ λ2 with H = λ1 + λ2, K = −λ1λ2; the smaller is computed from the larger without cancellation."""
    spread = K.sqrt(H * H + 4 * abs(second))
    if H >= 0:
        one = (H + spread) / 2
        return one, -second / one
    two = (H - spread) / 2
    return -second / two, two


def _image(K: LongField, state: State, rate: Sequence[Real], h2: Real) -> tuple[list[Real], list[Real]]:
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
    """ũ_k − a_i for both roots ũ1 < ũ2 of U(x) = Σ squares_i(x − a_j)(x − a_k), squares ≥ 0 with the sum 1, a_1 > a_2 >
    a_3.

    The differences are computed as roots in x − a_2, and from (ũ1 − a_i)(ũ2 − a_i) = U(a_i) = c_i·squares_i.
    Differences of nearly equal numbers would cost half the digits of √|ũ_k − a_i| at a turning point.
    """
    K, c, a, moments = body.field, body.differences, body.a, body.inertia
    above, below = ((moments[i + 1] - moments[i]) * a[i] * a[i + 1] for i in range(2))
    total = squares[0] * below - squares[2] * above + squares[1] * (below - above)
    product = abs(c[1]) * squares[1]
    larger = (abs(total) + K.sqrt(total * total + 4 * product)) / 2
    smaller = product / larger if larger else larger
    first, second = (larger, smaller) if total >= 0 else (smaller, larger)
    high, low = -first - above, second + below
    return [[high, -first, c[2] * squares[2] / low], [c[0] * squares[0] / high, second, low]]


def _oval(K: LongField, body: Body, mu: Real, gaps: Sequence[Real], turn: int) -> EllipticOval:
    """The curve and its point with ũ − a_i = ``gaps`` and the sign ``turn`` of ũ'.

    Z − e_i = μ(ũ − a_i)/((1 − dũ)(1 − da_i)).
    """
    # 1 − dũ = (1 − da_i) − d(ũ − a_i) is computed with the smallest ũ − a_i
    slow = next(r - body.d * x for r, x in sorted(zip(body.contact, gaps, strict=True), key=lambda pair: abs(pair[1])))
    x, y, z = (K.sqrt(abs(mu * x / (slow * r))) for x, r in zip(gaps, body.contact, strict=True))
    one, two, three = body.inertia
    above, below = abs(mu) * (two - one) / (one * two), abs(mu) * (three - two) / (two * three)
    return EllipticOval(K, below, above, (turn * z, y)) if mu > 0 else EllipticOval(K, above, below, (-turn * x, y))


def _signs(curves: Sequence[EllipticOval], e: Sequence[Real], slope: Sequence[Real]) -> list[int]:
    """The signs of e_i = ±const·R_i(curve 1)R_i(curve 2), from e_i and its derivative, which do not both vanish."""
    one, two = curves
    p, q, result = one.start[::-1], two.start, []
    for i in range(3):
        j, k = i - 2, i - 1
        rate = SLOPES[0][i] * p[j] * p[k] * q[i] + SLOPES[1][i] * q[j] * q[k] * p[i]
        # |M| contributes to the derivative too: with one by t in place of τ the sum had the wrong sign for a large d
        match = p[i] * q[i] * e[i] * (one.breadth + two.breadth) + rate * slope[i]
        result.append(1 if match > 0 else -1)
    return result
