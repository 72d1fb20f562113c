"""A ball whose momentum about the point of contact is vertical: M = cγ.

Then γ̇ = λγ × Aγ with A = diag(1/(I_i + d)) and the constant λ = c/(1 − d(γ, Aγ)). So a free body of moments I_i + d
and momentum λγ turns as the ball does; any vector orthogonal to M serves as its γ. (Chaplygin 1903 excludes the case.)
The centre x moves with ẋ = r(ω_y, −ω_x). In a period T of γ in the body the ball turns by an angle Δ about the vertical
and moves by δ. So x(nT + s) = Σ_{j<n} R(jΔ)δ + R(nΔ)x(s), where R(φ) is the rotation by φ. For any time an integral
within one period suffices.
"""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from integrable.laboratory.ways import Along, WideFlow, numbers
from integrable.moving_point.arithmetic import LONG
from integrable.moving_point.legendre import integral
from integrable.torus.panels import Panels, panel_integrals
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import PrecisionLoss

# tolerance for the last coefficients of the Chebyshev series of the velocity on a panel
TOLERANCE = 1e-14
# initial number of panels of a period
PANELS = 8


class Vertical(Along):
    """A ball with vertical momentum M = cγ. ``flow`` is that of the free body that turns as the ball does; ``radius``
    is a wide number, and ``sign`` the sign of c.
    """

    def __init__(self, flow: WideFlow, frame: Any, radius: Real, sign: int) -> None:
        super().__init__(flow, frame)
        self._radius, self._sign = numbers(self._field, np.array([radius]))[0], sign

    def contact(self, times: np.ndarray) -> Any:
        """The path of the point of contact from the start."""
        K = self._field
        pace, advance, wide = self._rates
        sin: Any = np.sin
        cos: Any = np.cos
        # each time is n periods T and ``since``; in a period the ball turns by an angle Δ, and ``half`` is nΔ/2
        if K is RR:
            counts, rest = LONG.turns_of(times, pace, wide.zero)
            since = (rest / np.longdouble(float(pace))).astype(float)
            half = 2 * np.pi * LONG.turns_of(counts, advance / 2, wide.zero)[1].astype(float)
        else:
            counts = np.array([K.context.nint(t * pace) for t in times], dtype=object)
            since = np.array([K.coerce(t - n / pace) for t, n in zip(times, counts, strict=True)])
            half = np.array([K.coerce(wide.context.pi * advance * n) for n in counts], dtype=object)
            sin, cos = (np.frompyfunc(f, 1, 1) for f in (K.context.sin, K.context.cos))
        s, c = (f(np.array([self._half_turn]))[0] for f in (sin, cos))
        ends = self._path(np.array([-self._half_period, self._half_period]))
        delta = ends[1] - _turned(*_double(s, c), ends[0])
        sines, cosines = sin(half), cos(half)
        sums = sines / s if s else counts
        # with the rotation R(φ) by φ, Σ_{j<n} R(jΔ)δ = (sin(nΔ/2)/sin(Δ/2))·R((n − 1)Δ/2)δ
        gone = sums[:, None] * _turned(sines * c - cosines * s, cosines * c + sines * s, delta)
        return gone + _turned(*_double(sines, cosines), self._path(since))

    # --- one period of γ in the body

    @cached_property
    def _rates(self) -> tuple[Any, Any, Any]:
        """(1/T, Δ/2π, field of these wide numbers): T is the period of γ in the body, and Δ the angle by which the ball
        turns about the vertical in that period.
        """
        portrait = self.flow.portrait
        if portrait.axis is None:
            raise PrecisionLoss(
                "contact: the period of γ in the body, next to an unstable rotation, is beyond all digits"
            )
        turn, rest = portrait.wide_turns
        return abs(turn + rest) / 2, self._sign * turn / abs(turn + rest), self.flow.setup.wide

    @cached_property
    def _half_period(self) -> Any:
        return self._field.coerce(1 / (2 * self._rates[0]))

    @cached_property
    def _half_turn(self) -> Any:
        """Half of the angle by which the ball turns about the vertical in a period of γ, without whole turns."""
        _, advance, wide = self._rates
        return self._field.coerce(wide.context.pi * (advance - wide.context.nint(advance)))

    def _path(self, times: np.ndarray) -> Any:
        """The path of the point of contact at times within half a period of γ before or after the start."""
        if self._field is not RR:
            return np.array([self._by_gauss(t) for t in times], dtype=object).reshape(-1, 2)
        found = np.zeros((len(times), 2))
        for sign, panels in zip((1, -1), self._panels, strict=True):
            chosen = np.flatnonzero(sign * times > 0)
            if len(chosen):
                found[chosen] = sign * panel_integrals(panels, abs(times[chosen]))
        return found

    @cached_property
    def _panels(self) -> tuple[Panels, Panels]:
        # a rounded time may lie slightly beyond the half period
        end = self._half_period * (1 + 1e-9)
        first, second = (
            Panels(lambda s, sign=sign: self._velocity(sign * s), 0.0, end, end / PANELS, TOLERANCE)  # type: ignore[misc]
            for sign in (1, -1)
        )
        return first, second

    def _by_gauss(self, time: Any) -> Any:
        K = self._field
        if not time:
            return np.array([K.zero, K.zero], dtype=object)
        cuts = [time * k / PANELS for k in range(PANELS + 1)]
        return sum(integral(K, self._velocity, first, last, 1.0) for first, last in pairwise(cuts))

    def _velocity(self, times: np.ndarray) -> Any:
        matrices, omega = self.at(times)
        space = np.einsum("nij,nj->ni", matrices, omega)
        return self._radius * np.stack([space[:, 1], -space[:, 0]], axis=1)


def _double(s: Any, c: Any) -> tuple[Any, Any]:
    return 2 * s * c, c * c - s * s


def _turned(s: Any, c: Any, points: Any) -> Any:
    """The points, turned by the angles with sines ``s`` and cosines ``c``."""
    x, y = points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
