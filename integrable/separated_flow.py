"""The geodesic flows of the tilde, check and hat pairs: two elliptic curves, and an addition on each.

In ũ_k, the roots of Σ w_i²/(x − a_i), w = γ × M, the flow of H = λ1 + λ2 separates: ũ_k' = y_k, y_k² = λ_kφ(ũ_k), φ(x)
= 4(dx − 1)Π(a_i − x), with λ_k constant and ' = d/dτ, dτ = g dt. Z = μ_k·ũ/(1 − dũ), μ_k = λ_kΠ(1 − da_i), brings each
curve to Z'² = 4Π(Z − e_i), e_i = μ_k/I_i, on which the motion is the addition of (℘(τ), ℘'(τ)). The signs of γ come
from the roots R_i = √|Z − e_i|, which the addition moves too:

    R_i(u + v) = (s_i(v)R_i'(u) + R_i(u)s_j(v)s_k(v))/(℘(v) − Z(u)),   s_i = √(℘ − e_i),   R_i' = ±R_jR_k.

Any τ costs one addition on each curve, its translation a few terms of the Laurent series and log₂ τ doublings. (The
separation: Tsiganov; the addition: Weierstrass.)
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.body import cross
from integrable.isometry import lift, roots
from integrable.state import State
from jacobian import MP, RR
from jacobian.errors import ArgumentError, NotRepresentable

if TYPE_CHECKING:
    from integrable.separated_clock import SeparatedClock
    from integrable.systems.deformation import Deformation

FLOAT_DIGITS = 34
GUARD_DIGITS = 18
RR_DIGITS = 16


@dataclass
class Motion:
    """γ and M of shape (N, 3) at physical times ``times`` and times ``tau`` of the flow, shape (N,), dτ = g dt.

    ``times`` is None where only τ was asked for at d ≠ 0. ``report`` is the report of a scene's run, or None.
    """

    times: np.ndarray | None
    tau: np.ndarray | None
    gamma: np.ndarray
    M: np.ndarray
    report: Any = None


class SeparatedFlow:
    """The motion of a tilde pair without potential through a state, over RR or MP(digits): get it from ``system.flow``.

    All is computed with guard digits and rounded once, also for floats (about a millisecond a state).
    NotRepresentable where moments are equal or a λ_k vanishes (K = 0: a curve degenerates).
    """

    method = "elliptic curves"

    def __init__(self, system: Deformation, state: State) -> None:
        self._outer = system.field
        self.system, state = widened(system, state)
        system = self.system
        body, K = system.body, system.field
        if any(c == 0 for c in body.differences):
            raise NotRepresentable("two moments of inertia are equal: the separated variables do not tell how γ turns")
        h1, h2 = body.integrals(state.gamma, state.M)[2:]
        if h2 == 0:
            raise ArgumentError("M = (0, 0, 0): at rest; a flow needs M ≠ 0")
        self._weights = [r / abs(c) ** (K.one / 2) for r, c in zip(body.contact, body.differences, strict=True)]
        spin = h2 ** (K.one / 2)
        rate = _rate(system, state)
        e, slope = ([x / spin for x in v] for v in _image(K, state, rate, h2))
        u, du = _roots(system.a, e, slope)
        self._lambdas = [h1 - x * h2 for x in u]
        if any(abs(x) <= 64 * K.eps * h2 * max(system.a) for x in self._lambdas):
            raise NotRepresentable(f"λ = {self._lambdas}: K vanishes, and one of the two curves degenerates")
        product = body.contact[0] * body.contact[1] * body.contact[2]
        self.curves = [
            Oval(K, [x * product / i for i in body.inertia], product * x, body, v, w)
            for x, v, w in zip(self._lambdas, u, du, strict=True)
        ]
        self._signs = _signs(self, e, slope)
        found = self._state(*(curve.start for curve in self.curves))
        self._side = 1 if sum(x * y for x, y in zip(found[0], state.gamma, strict=True)) > 0 else -1

    def at_tau(self, tau: Any) -> Motion:
        """The states at values of the flow's own time τ, dτ = g dt (τ = t at d = 0), of any order, size and sign."""
        given = numbers_of(self._outer, tau, "tau")
        return self._motion(None if self.system.body.rolls else given, given)

    def at(self, times: Any) -> Motion:
        """The states at physical times t, of any order, size and sign.

        At d = 0 they are those of the flow; at d ≠ 0 a clock steps there once (:mod:`integrable.separated_clock`), up
        to 200000 steps, and ArgumentError beyond.
        """
        given = numbers_of(self._outer, times, "times")
        if not self.system.body.rolls:
            return self._motion(given, given)
        return self._motion(given, [self._clock.tau(self.system.field.coerce(x)) for x in given])

    def translated(self, roots_of: Any) -> State:
        """The state with the points ``roots_of``(k, field, μ_k, μ_k/I_i) added on the curves k = 0, 1: roots √(Z' −
        μ_k/I_i) and how many times, or None.
        """
        moved = []
        for k, curve in enumerate(self.curves):
            found = roots_of(k, self.system.field, curve.mu, curve.e)
            point = curve.start
            for _ in range(0 if found is None else found[1]):
                point = curve.added(point, found[0])
            moved.append(point)
        row = motion_of(self._outer, None, [], [self._state(*moved)], self._side)
        x, m = row.gamma[0].tolist(), row.M[0].tolist()
        return State((x[0], x[1], x[2]), (m[0], m[1], m[2]))

    @cached_property
    def _clock(self) -> SeparatedClock:
        from integrable.separated_clock import SeparatedClock

        K = self._outer
        return SeparatedClock(self, RR_DIGITS if K == RR else K.dps + RR_DIGITS // 2)

    def _motion(self, times: Any, tau: list[Any]) -> Motion:
        wide = map(self.system.field.coerce, tau)
        rows = [self._state(*(curve.moved(x) for curve in self.curves)) for x in wide]
        return motion_of(self._outer, times, tau, rows, self._side)

    def pace(self, first: Any, second: Any) -> Any:
        """dt/dτ = 1/g, from the roots R_i on both curves."""
        K, d = self.system.field, self.system.d
        z = [curve.height(r) for curve, r in zip(self.curves, (first, second), strict=True)]
        # 1 − dũ = 1/(1 + dz)
        f = [1 / (1 + d * x) for x in z]
        u = [x * y for x, y in zip(z, f, strict=True)]
        size = (self._lambdas[0] - self._lambdas[1]) / (u[1] - u[0])
        return (size * f[0] * f[1] / (size * f[0] - d * self._lambdas[0])) ** (K.one / 2)

    def _state(self, first: Any, second: Any) -> tuple[list[Any], list[Any]]:
        """(γ, M), up to a common sign, from the roots R_i on both curves."""
        body, K = self.system.body, self.system.field
        one, two = self.curves
        e = [s * c * x * y for s, c, x, y in zip(self._signs, self._weights, first, second, strict=True)]
        length = K.dot(e, e) ** (K.one / 2)
        z = one.height(first), two.height(second)
        f = [1 / (1 + body.d * x) for x in z]
        u = [x * y for x, y in zip(z, f, strict=True)]
        scale = 2 * length * f[0] * f[1] / (one.mu * two.mu * (u[0] - u[1]))
        n = []
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            left = first[j] * first[k] * f[0] * two.signs[i] * second[i]
            right = second[j] * second[k] * f[1] * one.signs[i] * first[i]
            divisor = self._signs[i] * self._weights[i] * body.differences[i]
            n.append(scale * body.contact[i] * (right - left) / divisor)
        e = [x / length for x in e]
        square = sum(x * x / r for x, r in zip(e, body.contact, strict=True))
        lean = sum(x * y / r for x, y, r in zip(e, n, body.contact, strict=True)) / square
        gamma = [(lean * x - y) / r for x, y, r in zip(e, n, body.contact, strict=True)]
        size = K.dot(gamma, gamma) ** (K.one / 2)
        gamma = [x / size for x in gamma]
        momentum = ((self._lambdas[0] - self._lambdas[1]) / (u[1] - u[0])) ** (K.one / 2)
        return gamma, list(cross(K, tuple(momentum * x for x in e), tuple(gamma)))


class IsometricFlow:
    """The motion of a check or hat pair, as that of the tilde pair of A⁻¹ at another pace."""

    method = "elliptic curves"

    def __init__(self, system: Deformation, state: State) -> None:
        self._outer = system.field
        self.system, state = widened(system, state)
        K = self.system.field
        squares, self._pace, tilde = self.system.isometry()
        self._roots = roots(K, squares)
        gamma, M = lift(K, self._roots, state.gamma, state.M)
        self._flow = SeparatedFlow(tilde, State(gamma, M))

    def at(self, times: Any) -> Motion:
        """The states at times t, in any order, of any size and sign."""
        K = self.system.field
        given = numbers_of(self._outer, times, "times")
        run = self._flow.at_tau([self._pace * K.coerce(x) for x in given])
        back = [1 / b for b in self._roots]
        rows = [lift(K, back, tuple(x), tuple(m)) for x, m in zip(run.gamma, run.M, strict=True)]
        return motion_of(self._outer, given, given, rows, 1)

    at_tau = at


class Oval:
    """The curve Z'² = 4Π(Z − e_i) of one separated variable, and the motion along its bounded oval."""

    def __init__(self, K: Any, roots: Any, mu: Any, body: Any, u: Any, du: Any) -> None:
        self._field = K
        self.e = list(roots)
        self.mu = mu
        # on the bounded oval, e_min ≤ Z ≤ e_mid ≤ e_max
        low = self.e.index(min(self.e))
        self.signs = [1 if i == low else -1 for i in range(3)]
        z = u / (1 - body.d * u)
        self._far = low
        sizes = [self._size(x, z, u, a, body) for x, a in zip(body.inertia, body.a, strict=True)]
        turn = 1 if du * mu * sizes[0] * sizes[1] * sizes[2] >= 0 else -1
        # Z' = 2R_1R_2R_3
        self.start = [turn * sizes[0], *sizes[1:]]
        self._mean = sum(self.e) / 3
        self.centred = [x - self._mean for x in self.e]
        one, two, three = self.centred
        self._series = laurent(K, -4 * (one * two + two * three + three * one), 4 * one * two * three)

    def _size(self, moment: Any, z: Any, u: Any, a: Any, body: Any) -> Any:
        """√|μ(z − 1/I)|, from u − a where that is more exact."""
        gap = (u - a) * (1 + body.d * z) / (moment * a)
        return abs(self.mu * gap) ** (self._field.one / 2)

    def height(self, r: Any) -> Any:
        """z = Z/μ at the roots R_i, from the root that is least."""
        i = min(range(3), key=lambda n: abs(r[n]))
        return (self.e[i] + self.signs[i] * r[i] * r[i]) / self.mu

    def moved(self, tau: Any) -> list[Any]:
        """The roots R_i a time τ later."""
        return self.start if tau == 0 else self.added(self.start, self.translation(tau))

    def added(self, r: Any, s: Any) -> list[Any]:
        """The roots R_i at the sum of a point with roots r and a translation s."""
        i = self._far
        # ℘(v) − Z(u) = s_i² ∓ R_i², a sum where the sign of R_i² is −
        j = (i + 1) % 3
        down = s[j] * s[j] + r[j] * r[j]
        return [(s[n] * self.signs[n] * r[n - 2] * r[n - 1] + r[n] * s[n - 2] * s[n - 1]) / down for n in range(3)]

    def translation(self, tau: Any) -> list[Any]:
        """s_i(τ) = √(℘(τ) − e_i): the Laurent series at τ/2^m, then m doublings."""
        K, size, halvings = self._field, max(map(abs, self.centred)), 0
        v = tau
        while v * v * size > 1 / 16:
            v, halvings = v / 2, halvings + 1
        square = v * v
        tail = K.zero
        for c in reversed(self._series):
            tail = tail * square + c
        # v²(℘ − e) = 1 − v²e + v⁴·tail
        s = [(1 - square * e + square * square * tail) ** (K.one / 2) / v for e in self.centred]
        for _ in range(halvings):
            e = self.e
            down = 2 * s[0] * s[1] * s[2]
            s = [(s[n] ** 4 - (e[n] - e[n - 2]) * (e[n] - e[n - 1])) / down for n in range(3)]
        return s


def widened(system: Deformation, state: State) -> tuple[Any, State]:
    """The same system and state with guard digits, the constraints made exact; ArgumentError over an exact field."""
    K = system.field
    if K.exact or getattr(K, "complex", False):
        raise ArgumentError(f"field = {K.name}: a flow runs over RR or MP(digits)")
    wide = MP(FLOAT_DIGITS if K == RR else K.dps + GUARD_DIGITS)
    gamma, M = ([wide.coerce(x) for x in v] for v in (state.gamma, state.M))
    length = wide.sqrt(wide.dot(gamma, gamma))
    gamma = [x / length for x in gamma]
    tilt = wide.dot(gamma, M)
    M = [m - tilt * x for m, x in zip(M, gamma, strict=True)]
    return system.over(wide), State(tuple(gamma), tuple(M))


def numbers_of(K: Any, values: Any, argument: str) -> list[Any]:
    """The values, or one, as elements of K; FieldError that names ``argument``."""
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        values = [values]
    return [K.coerce(x, f"{argument}[{i}]") for i, x in enumerate(values)]


def motion_of(K: Any, times: Any, tau: list[Any], rows: list[Any], side: int) -> Motion:
    """Times and rows (γ, M) rounded to the field K."""
    kind = np.float64 if K == RR else object
    number = float if K == RR else K.coerce
    gamma, M = (
        np.array([[number(side * x) for x in row[k]] for row in rows], dtype=kind).reshape(-1, 3) for k in (0, 1)
    )
    t, s = (None if x is None else np.array([number(y) for y in x], dtype=kind) for x in (times, tau))
    assert s is not None
    return Motion(t, s, gamma, M)


def laurent(K: Any, g2: Any, g3: Any) -> list[Any]:
    """c_0, c_1, … with ℘(v) = v⁻² + v²Σ c_n v^(2n), ℘'² = 4℘³ − g2℘ − g3."""
    count = ceil(0.5 * K.dps + 10)
    c = [K.zero, K.zero, g2 / 20, g3 / 28]
    for n in range(4, count + 2):
        c.append(3 * sum(c[m] * c[n - m] for m in range(2, n - 1)) / ((2 * n + 1) * (n - 3)))
    return c[2:]


def _rate(system: Deformation, state: State) -> State:
    """(γ, M)' in the time of the flow."""
    rate = system.vector_field(state)
    slow = system.body.conformal(state.gamma) ** (system.field.one / 2)
    return State(tuple(slow * x for x in rate.gamma), tuple(slow * x for x in rate.M))


def _image(K: Any, state: State, rate: State, h2: Any) -> tuple[list[Any], list[Any]]:
    """w = γ × M, and |M|·(w/|M|)'."""
    w = cross(K, state.gamma, state.M)
    moved = [x + y for x, y in zip(cross(K, rate.gamma, state.M), cross(K, state.gamma, rate.M), strict=True)]
    growth = sum(x * y for x, y in zip(state.M, rate.M, strict=True)) / h2
    return list(w), [x - growth * y for x, y in zip(moved, w, strict=True)]


def _roots(a: Any, e: Any, slope: Any) -> tuple[list[Any], list[Any]]:
    """The roots u1 < u2 of Σe_i²(x − a_j)(x − a_k), and their derivatives."""
    total = [
        sum(x * x * (a[i - 2] + a[i - 1]) for i, x in enumerate(e)),
        sum(x * x * a[i - 2] * a[i - 1] for i, x in enumerate(e)),
    ]
    half = total[0] / 2
    low, middle, high = sorted(a)
    # the discriminant is positive but for rounding
    gap = abs(half * half - total[1]) ** ((half * 0 + 1) / 2)
    u = [min(max(half - gap, low), middle), max(min(half + gap, high), middle)]
    du = []
    for k in range(2):
        change = sum(
            2 * x * y * (u[k] - a[i - 2]) * (u[k] - a[i - 1]) for i, (x, y) in enumerate(zip(e, slope, strict=True))
        )
        du.append(-change / (u[k] - u[1 - k]))
    return u, du


def _signs(flow: SeparatedFlow, e: Any, slope: Any) -> list[int]:
    """The signs with e_i ∝ ±R_iR_i of the two curves, from e_i or, where that is small, from its derivative."""
    one, two = flow.curves
    result = []
    for i in range(3):
        j, k = i - 2, i - 1
        p, q = one.start, two.start
        match = p[i] * q[i] * e[i]
        if abs(e[i]) < 1e-3:
            match = (one.signs[i] * p[j] * p[k] * q[i] + two.signs[i] * q[j] * q[k] * p[i]) * slope[i]
        result.append(1 if match > 0 else -1)
    return result
