"""The flow of the tilde pair at d = 0 with repelling poles Σb_i(a_j + a_k − 2s)/γ_i², b_i > 0, on two elliptic curves.

Let s = (γ, Aγ), h1 = (M, AM) + Σb_i(a_j + a_k − s)/γ_i², h2 = (M, M) + Σb_i/γ_i² and φ = −4Π(a_i − x). The state is a
divisor (U, V) of y² = f(x) = φ(x)(h1 − xh2 − Σb_ic_i/(x − a_i)), c_i = (a_j − a_i)(a_k − a_i). The roots ũ_k of (f −
V²)/U are variables of separation. The λ_k = h1 − ũ_kh2 are constant, H = λ1 + λ2 and K = −λ1λ2. The derivatives are
ũ_k' = −V(ũ_k), and ũ_k'² = φ(ũ_k)λ_k − 4Σb_ic_iΠ_{j≠i}(a_j − ũ_k) is a cubic in ũ_k. So Z = λ_kũ_k + const moves on Y²
= 4Z³ − g2Z − g3 (:class:`integrable.mumford.elliptic_torus.EllipticOval`).

γ_i = 0 would imply V(a_i)² = −4b_ic_i² < 0, so no γ_i changes sign. The ũ_k are the roots of ΣE_i²(x − a_j)(x − a_k)
with E_i² = (b_i/γ_i² + w_i²)/h2 > 0 and w = γ × M. They lie on opposite sides of the middle a_i, so the ovals never
meet, and the motion continues for all time. (The map to the ũ_k is the tilde pair's 2-torsion map, on the curve with
poles; tests/integrable/deformations/test_separations.py has the exact identities.)
"""

from __future__ import annotations

from typing import Any, NamedTuple

import gmpy2
import numpy as np

from integrable.deformations.carrier import CurvePoint, CurvesCarrier, GammaM
from integrable.deformations.deformed_flow import DeformedFlow
from integrable.deformations.separated_flow import check_distinct, interlaced
from integrable.moving_point.elliptic_integrals import complete
from integrable.mumford.elliptic_torus import EllipticOval
from integrable.phase.body import Vector, cross
from integrable.phase.state import State
from integrable.phase.ways import Cost
from integrable.portrait.spectrum import Sampled, Spectrum, lines_of
from integrable.torus.theta_series import half_turn
from jacobian import RR, poly
from jacobian.element import FormulaField, Real
from jacobian.errors import NotRepresentable, PrecisionLoss, shown
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted

__all__ = ["PoleFlow"]

# a point rests in an oval whose length, relative to its curve, is at most 2^SPARE_BITS·√eps
SPARE_BITS = 16


class PoleFrame(NamedTuple):
    """The constants from which states of a pair with repelling poles are computed: the λ_k, and the signs of γ_i."""

    lambdas: tuple[Real, Real]
    signs: Vector


class CubicCarrier(CurvesCarrier):
    """The motion of a tilde pair with repelling poles, on two cubics over the field of ``system``. The heights z on
    the curves are the ũ_k of the module's docstring.
    """

    def __init__(self, system: Any, state: State) -> None:
        super().__init__(system, state)
        system, state = self.inner, self.origin
        check_distinct(system.body)
        K, a, c, b = self.field, system.a, system.body.differences, system.potential.poles
        phi = poly.scale(K, K.coerce(4), poly.from_roots(K, a))
        self._pairs = [poly.from_roots(K, (a[i - 2], a[i - 1])) for i in range(3)]
        well: poly.Poly = (K.zero,) * 3
        for pole, difference, pair in zip(b, c, self._pairs, strict=True):
            well = poly.add(K, well, poly.scale(K, 4 * pole * difference, pair))
        u, rates, self.lambdas = self._separated(state)
        one, two = self.lambdas
        self.momentum = K.sqrt((one - two) / (u[1] - u[0]))
        self.sizes = abs(one) + abs(two), abs(one * two)
        self.curves, self.levels = [], []
        for x, rate, value in zip(u, rates, self.lambdas, strict=True):
            if abs(value) <= 64 * K.eps * max(map(abs, self.lambdas)):
                raise NotRepresentable(f"λ = {shown(self.lambdas)}: K vanishes, and one of the two curves degenerates")
            q = poly.sub(K, poly.scale(K, value, phi), well)
            # Z = λu + shift satisfies Z'² = 4Z³ − g2Z − g3
            shift = q[2] / 12
            e, curve = oval_of_cubic(K, q, shift, value * x + shift, value * rate)
            self.curves.append(curve)
            self.levels.append([*((x - shift) / value for x in e), 1 / value])
        x, y, z = (K.one if g > 0 else -K.one for g in state.vectors[0])
        self.frame = PoleFrame((one, two), (x, y, z))
        self.shown = self.moved((K.zero, K.zero))

    def moves(self, curve: EllipticOval) -> bool:
        # if the point rests, the ends of its oval are known to half of the digits
        return bool(curve.swing > self.field.doubled(self.field.root_of_eps, SPARE_BITS) * curve.breadth)

    @staticmethod
    def read(N: FormulaField, system: Any, frame: Any, first: CurvePoint, second: CurvePoint) -> GammaM:
        (one, two), (u1, u2) = frame.lambdas, (first[3], second[3])
        gap = u2 - u1
        h2 = (one - two) / gap
        # y_k = ũ_k'/gap, so that V(x) = −y1(u2 − x) − y2(x − u1)
        y1, y2 = (2 * r[0] * r[1] * r[2] / (value * gap) for r, value in ((first, one), (second, two)))
        gamma, w = [], []
        for a, b, c, sign in zip(system.a, system.potential.poles, system.body.differences, frame.signs, strict=True):
            # (a_i − u1)(a_i − u2) is c_iE_i², with the E_i of the module's docstring
            over, under = a - u1, a - u2
            v = y1 * under - y2 * over
            x = sign * N.sqrt((4 * b * c * c + v * v) / (4 * h2 * c * over * under))
            gamma.append(x)
            w.append(v / (2 * c * x))
        state = (gamma[0], gamma[1], gamma[2])
        return state, cross(N, (w[0], w[1], w[2]), state)

    @property
    def actions(self) -> list[Real]:
        # p_kdũ_k = (λ_k + Σb_ic_i/(a_i − ũ_k))dũ_k/y_k
        system, pi = self.inner, half_turn()
        near = float(self.field.root_of_eps) / 16
        found = []
        for value, curve, (first, second, *_) in zip(self.lambdas, self.curves, self.levels, strict=True):
            wide, total = self.field.sqrt(curve.breadth), value * curve.period
            ratio = self.field.sqrt(curve.above) / wide
            for a, b, c in zip(system.a, system.potential.poles, system.body.differences, strict=True):
                # a_i − ũ = (a_i − u₁)cos² + (a_i − u₂)sin² of the amplitude, from the end u₁ to the end u₂
                p, one = (a - second) / (a - first), self.field.one
                total += 2 * b * c / ((a - first) * wide) * complete(ratio, p, one, one, pi, near)
            found.append(abs(total) / (2 * pi))
        return found

    def _separated(self, state: State) -> tuple[list[Real], list[Real], list[Real]]:
        """The ũ_k, their derivatives, and the λ_k of the module's docstring."""
        K, a, poles = self.field, self.inner.a, self.inner.potential.poles
        gamma, M = state.vectors
        squares = [x * x for x in gamma]
        s = K.dot(a, squares)
        h1 = sum(x * m * m for x, m in zip(a, M, strict=True))
        h1 = h1 + sum(b * (a[i - 2] + a[i - 1] - s) / squares[i] for i, b in enumerate(poles))
        h2 = K.dot(M, M) + sum(b / x for b, x in zip(poles, squares, strict=True))
        w = cross(K, gamma, M)
        V: poly.Poly = (K.zero,) * 3
        for x, y, pair in zip(gamma, w, self._pairs, strict=True):
            V = poly.add(K, V, poly.scale(K, 2 * x * y, pair))
        images = [(b / x + y * y) / h2 for b, x, y in zip(poles, squares, w, strict=True)]
        u = [a[0] + gap[0] for gap in interlaced(self.inner.body, images)]
        return u, [-(V[0] + V[1] * x) for x in u], [h1 - x * h2 for x in u]


def oval_of_cubic(K: LongField, q: poly.Poly, shift: Real, z: Real, slope: Real) -> tuple[list[Real], EllipticOval]:
    """The branch points and the oval of Z'² = 4Z³ − g2Z − g3 through (Z, Z') = (``z``, ``slope``).

    With Z = λu + ``shift``, q(u) = (Z'/λ)² has degree 3 and leading coefficient 4λ.
    """
    scale = q[3] / 4
    g2 = 12 * shift * shift - scale * q[1]
    # g3 follows from λ²q(0) = 4Z³ − g2Z − g3 at u = 0, where Z = shift
    g3 = (4 * shift * shift - g2) * shift - scale * scale * q[0]
    e = roots_of_cubic(K, g2, g3)
    sizes = [K.sqrt(abs(z - x)) for x in e]
    # next to a branch point Z − e_i loses digits, which Z' restores
    i = min(range(3), key=lambda n: sizes[n])
    others = sizes[i - 2] * sizes[i - 1]
    if others:
        sizes[i] = abs(slope) / (2 * others)
    one = sizes[0] if slope >= 0 else -sizes[0]
    return e, EllipticOval(K, abs(e[1] - e[0]), abs(e[2] - e[1]), (one, sizes[1]))


def roots_of_cubic(K: LongField, g2: Real, g3: Real) -> list[Real]:
    """The real roots of 4Z³ − g2Z − g3 in ascending order, by Viète's formula with cos 3θ."""
    # rounding may push the cosine beyond 1 at an equilibrium, where the oval is a point
    cosine = max(-K.one, min(K.one, g3 * K.sqrt(27 / g2**3)))
    third, radius = gmpy2.acos(cosine) / 3, K.sqrt(g2 / 3)
    return [radius * gmpy2.cos(third + 2 * half_turn() * k / 3) for k in (1, 2, 0)]


class PoleFlow(DeformedFlow):
    """The motion of a tilde pair with repelling poles through a state, over RR or MP(digits); ``system.flow`` returns
    it.

    NotRepresentable if moments are equal or a λ_k vanishes.
    """

    _carrier = CubicCarrier
    # in microseconds, as integrable.deformations.deformed_flow.BY_THETA
    _cost = Cost(450, 1)

    def spectrum(self) -> Spectrum:
        portrait, system = self.portrait, self.system
        if system.field is not RR:
            raise NotRepresentable(f"spectrum: it is computed in floats, this flow is over {system.field.name}")

        def read(phases: np.ndarray) -> dict[str, np.ndarray]:
            rows = self._many.at_phases(phases) if interpreted() else self._compiled.at_phases(phases)
            if rows is None:
                raise PrecisionLoss("spectrum: floats have too few digits for this motion, next to a separatrix")
            gamma, M = rows[:, :3], rows[:, 3:]
            return {"gamma": gamma, "M": M, "omega": system._omega_along(gamma, M)}

        # phases on the curves increase with time, and those of the portrait may decrease
        senses = np.diag(np.sign(portrait.frequencies))
        return lines_of(Sampled(read, (1, 1), senses, portrait.frequencies))

    def _terms(self) -> float:
        poles = self.system.potential.poles
        return super()._terms() + max(self.system.a) * sum(
            b / (x * x) for b, x in zip(poles, self.state.vectors[0], strict=True)
        )
