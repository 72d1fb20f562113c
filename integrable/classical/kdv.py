"""Real g-gap solutions of the Korteweg–de Vries equation u_t = 6uu_x − u_xxx, and their soliton limits.

(Dubrovin, Novikov & Matveev 1976; Mumford, Tata Lectures on Theta II, ch. IIIa §10.) The Schrödinger operator −ψ'' +
u(x, t)ψ has the bands [e_1, e_2], [e_3, e_4], … [e_{2g+1}, ∞) at every t. With the condition ψ(x) = 0 it has one
eigenvalue γ_j in each gap [e_{2j}, e_{2j+1}]:

    f = −Π(x − e_i),   U = Π(x − γ_j),   V = ½∂U/∂x,   u = Σe_i − 2Σγ_j

On the Jacobian of y² = f the pair (U, V) moves linearly in x and in t, with the directions −2e_{g−1} and −4Σe_i·e_{g−1}
− 8e_{g−2}. A band that shrinks to a point, e_{2j−1} = e_{2j}, becomes the eigenvalue of a soliton. A gap that shrinks
to a point has no effect.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from integrable.mumford.columns import Column, Columns
from integrable.mumford.flow import RIGHT, element
from integrable.mumford.motion import BITS_OF_TORUS, MumfordMotion, Read, Start, Vectors
from integrable.mumford.series import through
from integrable.mumford.system import Spectral
from integrable.phase.body import elements
from integrable.phase.enclosure import Precisions, ball_digits, exact_times, widest
from integrable.phase.made import Made
from integrable.phase.precisions import ROUNDED_TO_FLOATS, long_digits
from integrable.portrait.point_ovals import Form, Separation
from integrable.steps.step import checked_signs
from jacobian import RR, poly
from jacobian.element import Arithmetic, FormulaField, Numbers, Real, Value
from jacobian.errors import ArgumentError, NotRepresentable, PrecisionLoss, shown
from jacobian.fields.protocol import Field, check_field
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted
from jacobian.relatives.extended import Extended

if TYPE_CHECKING:
    from integrable.mumford.elliptic_torus import EllipticTorus
    from integrable.mumford.enclosure import EnclosedPlace
    from integrable.mumford.phase_torus import PhaseTorus
    from integrable.mumford.theta_torus import ThetaTorus

    Profile = EllipticTorus | ThetaTorus | PhaseTorus

# a profile is u as a function of x at one t, computed for MANY x or more on the torus of the motion in x, which starts
# from a pair of PROFILE_DIGITS digits. In genus ≥ 3 at most MOST_LOST of its bits may be lost because of narrow bands
PROFILE_DIGITS, MOST_LOST, MANY = 60, 24, 24


class Eigenvalues(NamedTuple):
    """γ_1 … γ_g at x = t = 0, and the signs of y at them, which are those of −U'(γ_j)·∂γ_j/∂x."""

    gamma: tuple[Real, ...]
    signs: tuple[int, ...]


class KdV(Made):
    """Solutions of u_t = 6uu_x − u_xxx with the band ``edges`` e_1 ≤ e_2 ≤ … ≤ e_{2g+1}, over RR, MP or an exact field.

    Example: ``kdv = KdV((0, 1, 2))``, ``kdv.wave(kdv.state([1.5])).at(x, t)``. The unit of u is that of the edges,
    1/length².
    """

    def __init__(self, edges: Iterable[Value], field: Field = RR) -> None:
        self.field = check_field(field, "field")
        if not self.field.exact:
            long_digits(self.field)
        wanted = "an odd number of band edges, 3 or more, in ascending order"
        self.edges = elements(self.field, edges, "edges", None, wanted)
        descends = not self.field.exact and any(x > y for x, y in pairwise(self.edges))
        if len(self.edges) < 3 or len(self.edges) % 2 == 0 or descends:
            raise ArgumentError(f"edges = {shown(edges)}: {wanted}")
        self.gaps = len(self.edges) // 2

    @property
    def arguments(self) -> dict[str, object]:
        return {"edges": self.edges}

    def state(self, gamma: Iterable[Value], signs: Iterable[int] | None = None) -> Eigenvalues:
        """The state with the eigenvalues γ_j in the gaps at x = t = 0, and the signs ±1 of their y, by default all 1.

        Over an exact field f(γ_j) must be a square; +1 then stands for the root that the field's ``sqrt`` returns.
        """
        K, wanted = self.field, f"a sequence of {self.gaps} numbers, one in each gap [edges[2j − 1], edges[2j]]"
        found = elements(K, gamma, "gamma", self.gaps, wanted)
        for j, x in enumerate(found):
            low, high = self.edges[2 * j + 1 : 2 * j + 3]
            if not K.exact and not low <= x <= high:
                raise ArgumentError(f"gamma[{j}] = {shown(x)}: a number in the gap [{shown(low)}, {shown(high)}]")
            if x in found[:j]:
                raise ArgumentError(f"gamma = {shown(gamma)}: {shown(x)} twice, where they do not determine a solution")
        return Eigenvalues(found, tuple(map(int, checked_signs(signs, self.gaps, "signs"))))

    def spectral(self, state: Eigenvalues) -> Spectral:
        """The polynomials f, u and v of a state, in ascending order, without double edges that equal a γ_j."""
        return self._spectral(self.field, self._checked(state))

    def _checked(self, state: Eigenvalues) -> Eigenvalues:
        if not isinstance(state, Eigenvalues) or len(state.gamma) != self.gaps:
            raise ArgumentError(f"state = {shown(state)}: give one that state(gamma, signs) of {self!r} returns")
        return state

    def _spectral(self, K: FormulaField, state: Eigenvalues) -> Spectral:
        edges, points = self._moving(K, state)
        ys = []
        for x, sign in points:
            value = K.neg(K.one)
            for e in edges:
                value = K.mul(value, K.sub(x, e))
            y = K.sqrt(value)
            ys.append(y if sign > 0 else K.neg(y))
        return Spectral(poly.neg(K, poly.from_roots(K, edges)), *through(K, [x for x, _ in points], ys))

    def _moving(self, K: FormulaField, state: Eigenvalues) -> tuple[list[Real], list[tuple[Real, int]]]:
        """The edges and the pairs (γ_j, sign), without double edges that equal a γ_j, and without these γ_j.

        A γ_j at a double edge never moves.
        """
        edges, points = [*map(K.coerce, self.edges)], []
        for x, sign in zip(map(K.coerce, state.gamma), state.signs, strict=True):
            if edges.count(x) > 1:
                edges.remove(x)
                edges.remove(x)
            else:
                points.append((x, sign))
        return edges, points

    def wave(self, state: Eigenvalues) -> Wave:
        """The solution with these eigenvalues at x = t = 0, over RR or MP(digits)."""
        return Wave(self, state)


class Wave:
    """A solution u, returned by ``kdv.wave(state)``; ``at(x, t)`` evaluates it.

    It is a function of x and t, not the motion of a state, and has no events, certificates or sensitivities. A two-gap
    solution at a fixed x is a motion that has them: :class:`integrable.classical.two_gaps.TwoGaps`.
    """

    def __init__(self, kdv: KdV, state: Eigenvalues) -> None:
        self.digits = long_digits(kdv.field)
        self.kdv = kdv
        self.start = kdv._checked(state)
        self._edges, points = kdv._moving(kdv.field, state)
        self._genus = len(points)
        self._motion = MumfordMotion(self._place, self._genus)
        self._profiles: dict[float, Profile | None] = {}

    def _place(self, N: LongField) -> Start:
        f, u, v = self.kdv._spectral(N, self.start)
        of_x, of_t = directions_of_waves(N, f)
        return Start(f, u, v, of_x, further=(of_t,))

    def at(self, x: Numbers, t: Numbers = 0) -> np.ndarray:
        """u(x, t), an array of the shape to which x and t broadcast; ``at(x, t[:, None])`` is a table over all x and t.

        For a g-gap solution the error is below the last digit of floats, or of MP(digits), times the span of the edges,
        at any x and t. In floats, 24 or more x at one t are evaluated on one torus, which is fast for many x. With
        a double edge the number of lost bits grows in proportion to x and t: PrecisionLoss beyond about 500 widths of
        the soliton.
        """
        xs, ts = self._given(x, t)
        found = np.empty_like(xs)
        times, which = np.unique(ts, return_inverse=True)
        order, counts = np.argsort(which.ravel(), kind="stable"), np.bincount(which.ravel())
        for time, places in zip(times.tolist(), np.split(order, np.cumsum(counts)), strict=False):
            found.flat[places] = self._at_one_time(xs.flat[places], time)
        return found

    def enclosure(self, x: Numbers, t: Numbers = 0, digits: int | None = None) -> np.ndarray:
        """Enclosures of u(x, t): balls (``flint.arb``) that provably contain it, in an array as :meth:`at` returns.

        Their radius is at most 10^(−digits) times the span of the edges. The edges, γ_j, x and t count as exact.
        ``digits`` defaults to those of the field, 15 for RR. PrecisionLoss if no such balls are found.
        """
        from integrable.moving_point.balls import Balls
        from integrable.mumford.enclosure import EnclosedPlace, lost_bits

        wanted = ball_digits(self.kdv.field, digits)
        motion = Precisions(lambda bits: EnclosedPlace(Balls(bits), self._place), wanted)

        def value(x: Real, t: Real) -> Real:
            if not self._genus:
                return exact_times([self._edges[0]])[0]

            def read(place: EnclosedPlace) -> tuple[Real, Real]:
                K = place.field
                ((u, span),) = self._read(K, place.at(K.coerce(x), (K.coerce(t),)))
                return u, widest(((u,), span))

            return motion.narrow(read, lost_bits(self._genus, x, t))[0]

        xs, ts = self._given(x, t)
        balls = [value(*pair) for pair in zip(xs.flat, ts.flat, strict=True)]
        return np.array(balls, dtype=object).reshape(xs.shape)

    def _given(self, x: Numbers, t: Numbers) -> list[np.ndarray]:
        """x and t, broadcast to arrays of one shape, with elements of the field."""
        K = self.kdv.field
        found = []
        for name, values in (("x", x), ("t", t)):
            read = np.vectorize(partial(K.coerce, argument=name), otypes=[float if K is RR else object])
            found.append(read(np.array(values, dtype=object)))
        try:
            return [*np.broadcast_arrays(*found)]
        except ValueError:
            raise ArgumentError(
                f"x, t have the shapes {found[0].shape}, {found[1].shape}: one shape fits both"
            ) from None

    def _at_one_time(self, xs: np.ndarray, t: Real) -> Sequence[Real] | np.ndarray:
        """u at many x and one t: for MANY x or more in floats by :meth:`_profile`, else by additions."""
        if self._genus and self.kdv.field is RR and not interpreted() and len(xs) >= MANY:
            profile = self._profile(float(t))
            carries = self._genus <= 2 or self._lost(max(abs(xs)), t) <= MOST_LOST
            if profile is not None and carries and profile.reaches(xs):
                try:
                    return self._on(profile, xs)
                except PrecisionLoss:
                    # points were not found at these x
                    pass
        return [self._value(x, t) for x in xs.tolist()]

    def _profile(self, t: float) -> Profile | None:
        """The profile, u as a function of x at the time t; None if additions do not agree with it.

        Only the profile of the last t is cached.
        """
        if t not in self._profiles:
            try:
                torus = self._made_profile(t)
                found = zip(torus.witnesses.tolist(), self._on(torus, torus.witnesses).tolist(), strict=True)
                apart = max(abs(u - self._value(x, t)) for x, u in found)
                right = apart <= RIGHT * (self._edges[-1] - self._edges[0])
            except (NotRepresentable, PrecisionLoss, ZeroDivisionError):
                right = False
            self._profiles = {t: torus if right else None}
        return self._profiles[t]

    def _made_profile(self, t: float) -> Profile:
        from integrable.mumford.elliptic_torus import EllipticTorus
        from integrable.mumford.phase_torus import PhaseTorus, in_pairs
        from integrable.mumford.theta_torus import ThetaTorus
        from integrable.portrait.separated import SeparatedTorus

        size = self._genus + 1
        (pair,) = self._row(0.0, t, lambda N, D: ((*D.u, *D.v),), PROFILE_DIGITS)

        def place(N: LongField) -> Start:
            return self._place(N)._replace(u=tuple(pair[:size]), v=tuple(pair[size:]))

        if self._genus <= 2:
            return EllipticTorus(place) if self._genus == 1 else ThetaTorus(place)
        with LongField(BITS_OF_TORUS) as N:
            start = place(N)
            forms = [Form((*[N.zero] * j, N.one)) for j in range(self._genus)]
            torus = SeparatedTorus(N, (start.f, start.u, start.v), Separation(forms, start.direction))
            pairs = torus.pairs(())
            return PhaseTorus(torus, lambda points, _: Extended(*pairs.at(Columns(), in_pairs(points))[:2]))

    def _on(self, torus: Profile, xs: np.ndarray) -> np.ndarray:
        ((u, _),) = self._read(Columns(), torus.at(xs))
        return Column.of(u).hi

    def _value(self, x: Real, t: Real) -> Real:
        if not self._genus:
            return self._edges[0]
        return element(self.kdv.field, self._row(x, t, self._read, self.digits)[0][0])

    def _row(self, x: Real, t: Real, read: Read, digits: int = ROUNDED_TO_FLOATS) -> Vectors:
        return self._motion.row(x, read, digits, further=(t,), lost=self._lost(x, t))

    def _lost(self, x: Real, t: Real) -> int:
        """A bound on the bits lost between (0, 0) and (x, t) because of a narrow band or double edge at n.

        Between these points U(n) = ψ² may shrink. By −ψ'' + uψ = nψ and ψ_t = (2u + 4n)ψ_x − u_xψ, log ψ changes at
        rates of at most κ in x and about max|2u + 4n|κ in t, κ² = max|u − n|. Rounding keeps U(n) from falling below
        the square root of the rounding unit. Both precisions that are compared lose these bits, so their difference
        does not show the loss. The width of the band bounds the loss.
        """
        edges, needed = self._edges, 0.0
        bounds = [float(sum(edges) - 2 * sum(edges[k::2])) for k in (1, 2)]
        for low, high in zip(edges[:-1:2], edges[1::2], strict=True):
            n, width = float(low), float((high - low) / (edges[-1] - edges[0]))
            square, speed = (max(abs(c * u + d * n) for u in bounds) for c, d in ((1, -1), (2, 4)))
            size = 2 * math.sqrt(square) * float(abs(x) + speed * abs(t))
            needed = max(needed, min(size, -math.log(width)) if width else size)
        return math.ceil(2 * needed / math.log(2))

    def _read(self, N: FormulaField, D: Extended) -> list[list[Real]]:
        f = poly.neg(N, poly.from_roots(N, [*map(N.coerce, self._edges)]))
        # the error of u is relative to the distance of the last edge from the first, which is therefore returned too
        return [[potential(N, f, D.u), N.coerce(self._edges[-1]) - N.coerce(self._edges[0])]]


def directions_of_waves(K: Arithmetic, f: poly.Poly) -> tuple[tuple[Real, ...], tuple[Real, ...]]:
    """The directions (c, c') of x and t: Σ_j γ_j^k dγ_j/y_j = c_k dx + c'_k dt."""
    gaps = len(f) // 2 - 1
    of_x, of_t = [K.zero] * gaps, [K.zero] * gaps
    of_x[-1] = poly.integer(K, -2)
    of_t[-1] = K.mul(poly.integer(K, -4), f[-2])
    if gaps > 1:
        of_t[-2] = poly.integer(K, -8)
    return tuple(of_x), tuple(of_t)


def potential(K: Arithmetic, f: poly.Poly, u: poly.Poly) -> Real:
    """The solution at a pair: u = Σe_i − 2Σγ_j."""
    return K.add(f[-2], K.mul(poly.integer(K, 2), u[-2]))
