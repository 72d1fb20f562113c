"""States with proven bounds: the flow in ball arithmetic (:mod:`integrable.moving_point.balls`), with bounds of all
truncation errors.

A state at a given τ is the start plus T(τ), one addition; T(τ) is 2^k times a translation near the identity. Physical
time is a sum of Gauss–Legendre rules on panels. A bound of |1/g| on a disc of complex τ bounds the error of a rule
(Trefethen 2008, theorem 4.5). The disc comes from Picard's theorem for the differential equations of the moving point,
which are polynomial. For a given t, τ is found from the monotonic t(τ), dt/dτ = 1/g > 0. The body's constants, γ, M and
the times count as exact; γ is divided by |γ|, and M (of an upright state) loses its part along γ.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import ceil
from typing import TYPE_CHECKING

from mpmath import mag, nstr

from integrable.motion.precise import PreciseFlow
from integrable.moving_point import addition
from integrable.moving_point.addition import opposite
from integrable.moving_point.balls import BOUND_BITS, Balls, BallTranslations, around, picard_box
from integrable.moving_point.problem import Problem, vectors
from integrable.phase.enclosure import Enclosure, Precisions, enclosed, exact_times, is_bounded, widest
from jacobian.element import Real
from jacobian.errors import ArgumentError, PrecisionLoss
from jacobian.progress import Progress

if TYPE_CHECKING:
    from flint import acb, arb

    from integrable.phase.body import Body
    from integrable.phase.enclosure import Vectors
    from integrable.phase.state import State

# the sum of the semi-axes of a panel's Bernstein ellipse, in units of half the panel; a larger sum means shorter panels
ELLIPSE = 3
# approximate number of bits that balls lose in one addition
LOST = 14
MOST_PANELS = 100_000
# largest number of doublings of a translation: with more, the number of steps exceeds the range of floats
MOST_DOUBLINGS = 1000


def enclosure(body: Body, state: State, times: Sequence[Real], digits: int, in_tau: bool) -> Enclosure:
    """Enclosures of the states at physical times, or at values of τ."""
    motions = Precisions(partial(BallMotion, body, state, digits), digits)
    clocked = body.rolls and not in_tau
    guesses = PreciseFlow(body, state, digits).at(list(times))[0] if clocked else None
    rows = enclosed(motions, times, guesses, partial(_lost, body, state))
    return Enclosure(None if in_tau and body.rolls else exact_times(times), rows)


def _lost(body: Body, state: State, tau: Real) -> int:
    """A guess of the number of bits that balls lose until τ."""
    # exponents are added, since the product may exceed the range of floats
    doublings = 4 + max(0, mag(tau) + mag(2 * max(body.a) * max(map(abs, state.vectors[1]))))
    if doublings > MOST_DOUBLINGS:
        raise ArgumentError(
            f"tau = {nstr(tau, 5)}: enclosures reach turns up to 2^{MOST_DOUBLINGS}; give a nearer time"
        )
    return LOST * doublings


class BallMotion:
    """The flow of one body and state in balls of ``bits`` bits; to be used inside ``with motion.reals``."""

    def __init__(self, body: Body, state: State, digits: int, bits: int) -> None:
        import flint

        self._flint = flint
        K = self.field = Balls(bits)
        self.reals, self._digits = K.reals, digits
        with K:
            given = (*body.inertia, body.d, *state.row)
            problem = self.problem = Problem.of(self.reals, given, state.tilted)
            self._translations = BallTranslations(self.reals, problem.f, problem.axes, problem.half_step)
            # an exact coordinate 0 would send an addition into a branch for degenerate positions. This branch is
            # wrong for the other points of a ball
            tiny = self._flint.arb(0, K.one / 2**bits)
            self._start = tuple(x + tiny for x in problem.start)
        # for physical time: ``_half`` is half the length of a panel, ``_reach`` the radius of the last disc, and
        # ``_sums`` has the integrals over whole panels in either direction
        self._half, self._reach = 0.0, 1.0
        self._sums: dict[int, list[arb]] = {}
        self._kept_nodes: list[tuple[tuple[arb, ...], arb]] = []

    def point(self, tau: arb) -> tuple[arb, ...]:
        """The moving point at a ball τ, in the flow's units."""
        middle = tau.mid()
        point, width = self._start, tau.rad().abs_upper()
        if middle != 0:
            step = self._translations.near(middle)
            point = addition.carried(self.problem.f, self.problem.axes, self._start, step)
        if tau.is_exact():
            return point
        sizes = [width * (1.1 * abs(x).abs_upper() + 2.0**-20) for x in self._velocity(point)]
        found = picard_box(self._velocity, point, sizes, width)
        if found is None:
            raise PrecisionLoss("a time is not known well enough to enclose the state there: use more digits")
        return tuple(map(around, point, found[1]))

    def scaled(self, time: Real) -> arb:
        return self.field.coerce(time) * self.problem.time_scale

    def state(self, tau: arb, time: Real) -> tuple[Vectors, arb]:
        problem = self.problem
        gamma, M = vectors(self.point(tau), problem.momentum, problem.matrix)
        return (tau / problem.time_scale, gamma, M), widest((gamma, 1), (M, problem.momentum))

    def rate(self, tau: arb) -> arb:
        return addition.rate_at(self.problem.axes, self.point(tau))

    def clock(self, tau: arb) -> arb:
        """∫_0^τ dτ/g for an exact τ ≠ 0; its panels are cached for later times."""
        if not self._half:
            self._half = self._bounded_disc(self._start, 1.0, 0)[0] * 2 / (ELLIPSE + 1 / ELLIPSE) * 0.7
        while True:
            panels = ceil(abs(float(tau)) / (2 * self._half))
            if panels > MOST_PANELS:
                raise ArgumentError(
                    f"times: enclosing physical time there takes {panels} panels, more than {MOST_PANELS}; "
                    "enclosure_at_tau has no such limit"
                )
            found = self._swept(tau, panels - 1)
            if found is not None:
                return found
            self._half *= 0.7
            self._sums.clear()
            self._kept_nodes.clear()

    def _swept(self, tau: arb, whole: int) -> arb | None:
        """∫dτ/g over ``whole`` panels and the remainder up to τ; None where a disc of analyticity is too small for a
        panel.
        """
        sign = 1 if tau > 0 else -1
        half, sums = self.field.one * sign * self._half, self._sums.setdefault(sign, [self.field.zero])
        progress = Progress(f"enclosing physical time on {whole} panels", whole + 1 - len(sums))
        while len(sums) <= whole:
            piece = self._panel((2 * len(sums) - 1) * half, half)
            if piece is None:
                return None
            sums.append(sums[-1] + piece)
            progress.add(1)
        rest = (tau - 2 * whole * half) / 2
        piece = self._panel(2 * whole * half + rest, rest)
        return None if piece is None else sums[whole] + piece

    def _panel(self, middle: arb, half: arb) -> arb | None:
        """∫dτ/g from ``middle`` − ``half`` to ``middle`` + ``half``; None where the disc of analyticity is smaller than
        the panel's Bernstein ellipse.
        """
        axes, f, arb = self.problem.axes, self.problem.f, self._flint.arb
        needed = abs(half) * (ELLIPSE + 1 / ELLIPSE) / 2
        centre = self.point(middle)
        if not is_bounded(centre):
            raise PrecisionLoss("a panel of physical time has no bound at this precision: use more digits")
        self._reach, bound = self._bounded_disc(centre, 1.3 * self._reach, needed)
        if bound is None or not self._reach >= needed:
            self._reach = 1.0
            return None
        nodes = self._nodes(half)
        error = bound * 64 / 15 / (1 - arb(ELLIPSE) ** -2) * arb(ELLIPSE) ** (2 - len(nodes) * 2)
        return half * sum((w * addition.rate_after(f, axes, centre, step) for step, w in nodes), arb(0, error))

    def _nodes(self, half: arb) -> list[tuple[tuple[arb, ...], arb]]:
        """The pairs (translation, weight) for the nodes of a panel's rule; the pairs of whole panels are cached."""
        whole = abs(half) == self._half
        if whole and self._kept_nodes:
            return self._kept_nodes
        count = 2 * ceil(((self._digits + 8) / 0.954 + 3) / 2)
        rule = [self._flint.arb.legendre_p_root(count, k, weight=True) for k in range(count // 2)]
        nodes = [(self._translations.near(half * x), w) for x, w in rule]
        nodes += [(opposite(step), w) for step, w in nodes]
        self._kept_nodes = nodes if whole else self._kept_nodes
        return nodes

    # --- a disc of complex τ on which the motion is analytic

    def _bounded_disc(self, point: Sequence[arb], start: float, enough: Real) -> tuple[float, arb | None]:
        """(radius, bound of |1/g|) of a disc of complex τ about the τ of ``point``.

        Radii are tried from ``start`` downwards, until by Picard's theorem the motion exists on the disc, and |1/g| has
        a bound there. The result is (0, None) if this fails for all radii above ``enough``.
        """
        with self.reals.at(BOUND_BITS):
            speed = [abs(x).abs_upper() for x in self._velocity(point)]
            radius = min(start, 1.0)
            while radius > 1e-6 and not radius < enough:
                found = picard_box(self._velocity, point, [radius * (1.5 * x + 0.01) for x in speed], radius)
                bound = None if found is None else self._rate_bound(found[0])
                if bound is not None:
                    return radius, bound
                radius *= 0.85
        return 0.0, None

    def _velocity(self, point: Sequence[arb | acb]) -> list[arb | acb]:
        """The derivative of a moving point with respect to τ.

        U' = v1·U − (x + u1)V, 2V' = (x + u1)W − s·U with W = (f − V²)/U and s the quotient of (x + u1)W by U; at the
        branch point α, 2σ' = v1σ − (α + u1)ν and 2ν' = −s(α)σ − v1ν.
        """
        f = self.problem.f
        u0, u1, v0, v1, *pairs = point
        w0, w1, w2, _ = addition.cofactor_at(f, (u0, u1, v0, v1))
        s0 = w1 - u0 * f[5]
        velocity = [v1 * u0 - u1 * v0, -v0, (u1 * w0 - s0 * u0) / 2, (w0 + u1 * w1 - s0 * u1 - w2 * u0) / 2]
        lifts = list(zip(self.problem.axes[:3], pairs[:3], pairs[3:], strict=True))
        velocity += [(v1 * x - (a + u1) * y) / 2 for a, x, y in lifts]
        return velocity + [-(((f[5] * a + w2) * a + s0) * x + v1 * y) / 2 for a, x, y in lifts]

    def _rate_bound(self, box: Sequence[acb]) -> arb | None:
        """An upper bound of |1/g| on a box of complex moving points, or None if the box is too large for one."""
        # 1/g has the denominator √(σ₁² + σ₂² + σ₃²), and is analytic on the box if that sum avoids the cut of the root
        if not sum(x * x for x in box[4:7]).real > 0:
            return None
        bound = abs(addition.rate_at(self.problem.axes, box))
        return bound.abs_upper() if bound.is_finite() else None
