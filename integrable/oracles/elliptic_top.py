"""The Euler top in closed form (Jacobi 1850; Whittaker 1904, §69): elliptic functions, and for γ an elliptic integral
of the third kind.

Name the axes so that M circles the third axis and the second is the middle one. Then, with
a_i = 1/I_i and constants A_i, λ, u_0 and n,

    M = (A_1 cn u, A_2 sn u, A_3 dn u),  u = λt + u_0,  φ = |M|a_3t + (|M|(a_1 − a_3)/λ)·(Π(n; am u) − Π(n; am u_0)).

The vector γ, fixed in space, turns by −φ about M relative to the normal to M and the third axis. Phases are reduced
modulo their periods in extended precision, so the error does not grow with t. With t taken as exact, floats are as
accurate at t = 10^12 as at t = 1. Nothing here is shared with the flow of this package.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from integrable.extras import needed
from integrable.oracles.body import Solution, cross
from jacobian.errors import ArgumentError

__all__ = ["EllipticTop"]

FLOAT_DIGITS = 15
GUARD = 25
Vector = list[Any]


class EllipticTop:
    """The motion of a top from one state. The set-up is made once; then :meth:`at` gives the states at any times.

    Up to 15 ``digits`` it computes in floats with SciPy's elliptic functions, above that with mpmath's. Raises
    ArgumentError for d ≠ 0.
    """

    def __init__(self, system: Any, state: Any, digits: int = FLOAT_DIGITS) -> None:
        import mpmath

        if system.d:
            raise ArgumentError(f"d = {system.d}: the closed form is that of the Euler top, d = 0")
        if digits < 1:
            raise ArgumentError(f"digits = {digits}: give a positive number of decimal digits")
        self.digits = digits
        # phases at large times need extra digits for their reduction
        self.context = c = mpmath.MPContext()
        c.dps = max(digits, FLOAT_DIGITS) + GUARD
        moments, gamma, M = ([c.mpf(x) for x in v] for v in (system.inertia, state.gamma, state.M))
        a = [1 / x for x in moments]
        self.steady = _steady(a, M)
        self.length = c.sqrt(c.fdot(M, M))
        if self.steady:
            self.start, self.rate = gamma, self.length and c.fdot([x * m for x, m in zip(a, M, strict=True)], M)
            self.M = M
            return
        order, self.sense = _axes(a, M)
        self.back = [order.index(i) for i in range(3)]
        a, gamma, M = ([v[i] for i in order] for v in (a, gamma, M))
        self._amplitudes(a, M)
        self._phase(a, gamma, M)

    def _amplitudes(self, a: Vector, M: Vector) -> None:
        """Sets A_i, λ, n and u_0 of the module's docstring, and the parameter m of the elliptic functions."""
        c = self.context
        square = [m * m for m in M]
        # (M, AM) − a_3|M|² and a_1|M|² − (M, AM) are computed as sums of terms of one sign, so that no digits cancel
        low = (a[0] - a[2]) * square[0] + (a[1] - a[2]) * square[1]
        high = (a[0] - a[1]) * square[1] + (a[0] - a[2]) * square[2]
        wide = c.sqrt((a[0] - a[2]) / (a[1] - a[2]))
        self.first = c.sqrt(low / (a[0] - a[2]))
        self.second = self.first * wide
        self.third = c.sqrt(high / (a[0] - a[2])) * (1 if M[2] > 0 else -1)
        self.speed = (a[1] - a[2]) * self.third * wide
        self.parameter = min(c.one, (a[0] - a[1]) * low / ((a[1] - a[2]) * high))
        self.characteristic = (a[1] - a[0]) / (a[1] - a[2])
        self.origin = c.ellipf(c.atan2(M[1] / self.second, M[0] / self.first), self.parameter)
        self.period = None if self.parameter == 1 else 2 * c.ellipk(self.parameter)

    def _phase(self, a: Vector, gamma: Vector, M: Vector) -> None:
        """Sets the constants of γ = c·e + ρ(cos β N + sin β e×N), with e and N of :func:`_frame`: c (``along``), ρ
        (``across``), and the rate and the initial value of the phase β.
        """
        c = self.context
        self.turning = self.length * a[2]
        self.weight = self.length * (a[0] - a[2]) / self.speed
        self.mean = c.zero if self.period is None else 2 * self._third_kind(self.period / 2) / self.period
        self.rate = self.turning + self.weight * self.mean * self.speed
        e, node, other = _frame(M, c.sqrt)
        self.along = c.fdot(gamma, e)
        x, y = c.fdot(gamma, node), c.fdot(gamma, other)
        self.across = c.sqrt(x * x + y * y)
        v, _ = self._reduced(self.origin)
        self.angle = c.atan2(y, x) + self.weight * self._periodic(v)

    def at(self, times: Iterable[Any]) -> Solution:
        """γ and M at ``times`` of any order, sign and size, each of shape (N, 3): float64, or mpf above 15 digits."""
        c = self.context
        wanted = [c.mpf(t) for t in times]
        rows = [self._turned(t) for t in wanted] if self.steady else self._moving([self.sense * t for t in wanted])
        if self.digits <= FLOAT_DIGITS:
            table = np.array(rows, dtype=float).reshape(len(rows), 6)
        else:
            out = type(c)()
            out.dps = self.digits
            table = np.array([[out.mpf(x) for x in row] for row in rows], dtype=object).reshape(len(rows), 6)
        return Solution(table[:, :3], table[:, 3:], len(rows))

    def _turned(self, time: Any) -> Vector:
        """γ and M of a permanent rotation: γ(t) = R(−|ω|t)γ turns about M."""
        c = self.context
        if not self.length:
            return [*self.start, *self.M]
        e = [m / self.length for m in self.M]
        angle = -time * self.rate / self.length
        turned, along = cross(e, self.start), c.fdot(e, self.start)
        cosine, sine = c.cos(angle), c.sin(angle)
        gamma = [
            cosine * x + sine * y + (1 - cosine) * along * z for x, y, z in zip(self.start, turned, e, strict=True)
        ]
        return [*gamma, *self.M]

    def _moving(self, times: Vector) -> Any:
        c = self.context
        places = [self._reduced(self.speed * t + self.origin) for t in times]
        # the angles grow with t, so they are reduced modulo 2π in extended precision
        angles = [c.fmod(self.angle - self.rate * t, 2 * c.pi) for t in times]
        if self.digits <= FLOAT_DIGITS:
            return self._floats(places, angles)
        rows = []
        for (v, flip), angle in zip(places, angles, strict=True):
            cn, sn, dn = (c.ellipfun(name, v, m=self.parameter) for name in ("cn", "sn", "dn"))
            M = [flip * self.first * cn, flip * self.second * sn, self.third * dn]
            beta = angle - self.weight * self._periodic(v)
            gamma = self._leaning(M, c.sqrt, self.along, self.across * c.cos(beta), self.across * c.sin(beta))
            rows.append([gamma[i] for i in self.back] + [M[i] for i in self.back])
        return rows

    def _leaning(self, M: Any, root: Any, along: Any, first: Any, second: Any) -> Vector:
        """The vector along·e + first·N + second·e×N, with e and N of :func:`_frame`."""
        e, node, other = _frame(M, root)
        return [along * p + first * q + second * r for p, q, r in zip(e, node, other, strict=True)]

    def _reduced(self, u: Any) -> tuple[Any, int]:
        """u minus the nearest multiple of 2K, and the sign that this shift gives cn and sn."""
        if self.period is None:
            return u, 1
        turns = int(self.context.nint(u / self.period))
        return u - turns * self.period, -1 if turns % 2 else 1

    def _periodic(self, v: Any) -> Any:
        """Π(n; am v) minus its mean growth, so a function of v of period 2K; here |v| ≤ K."""
        return self._third_kind(v) - self.mean * v

    def _third_kind(self, v: Any) -> Any:
        """Π(n; am v | m) for |v| ≤ K. At m = 1 it is an elementary function, and v may be any number."""
        c, n = self.context, self.characteristic
        if self.parameter == 1:
            root = c.sqrt(-n)
            return (v + root * c.atan(root * c.tanh(v))) / (1 - n)
        amplitude = c.atan2(c.ellipfun("sn", v, m=self.parameter), c.ellipfun("cn", v, m=self.parameter))
        return c.re(c.ellippi(n, amplitude, self.parameter))

    def _floats(self, places: list[tuple[Any, int]], angles: Vector) -> np.ndarray:
        """γ and M in floats, by SciPy. ``places`` are from :meth:`_reduced`; ``angles`` are reduced modulo 2π."""
        needed("scipy", "the closed form in floats")
        from scipy.special import ellipj, elliprf, elliprj

        v, flip = np.array([float(x) for x, _ in places]), np.array([float(s) for _, s in places])
        m, n, mean, weight = map(float, (self.parameter, self.characteristic, self.mean, self.weight))
        sn, cn, dn, _ = ellipj(v, m)
        if self.parameter == 1:
            root = (-n) ** 0.5
            third = (v + root * np.arctan(root * sn)) / (1 - n)
        else:
            square, delta = cn * cn, dn * dn
            # the integral of the third kind in Carlson's forms
            third = sn * elliprf(square, delta, 1.0) + n / 3 * sn**3 * elliprj(square, delta, 1.0, 1 - n * sn * sn)
        beta = np.array([float(x) for x in angles]) - weight * (third - mean * v)
        M = [flip * float(self.first) * cn, flip * float(self.second) * sn, float(self.third) * dn]
        along, across = float(self.along), float(self.across)
        gamma = self._leaning(M, np.sqrt, along, across * np.cos(beta), across * np.sin(beta))
        return np.array([gamma[i] for i in self.back] + [M[i] for i in self.back]).T


def _steady(a: Vector, M: Vector) -> bool:
    """Whether M × AM = 0: a permanent rotation, or no motion."""
    return not any(cross(M, [x * m for x, m in zip(a, M, strict=True)]))


def _axes(a: Vector, M: Vector) -> tuple[list[int], int]:
    """The axes in the order of the closed form, in which M circles the last one, and the sign of this permutation."""
    order = sorted(range(3), key=lambda i: a[i], reverse=True)
    i, j, k = order
    if (a[i] - a[j]) * M[i] ** 2 > (a[j] - a[k]) * M[k] ** 2:
        order.reverse()
    i, j, k = order
    return order, 1 if (j - i) % 3 == 1 else -1


def _frame(M: Any, root: Any) -> tuple[Vector, Vector, Vector]:
    """The unit vectors e along M, N normal to e and the third axis, and e × N. Components may be arrays."""
    across = root(M[0] * M[0] + M[1] * M[1])
    size = root(M[0] * M[0] + M[1] * M[1] + M[2] * M[2])
    e, node = [m / size for m in M], [-M[1] / across, M[0] / across, 0 * M[0]]
    return e, node, cross(e, node)
