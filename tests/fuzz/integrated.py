"""Motions by integration of their equations: heyoka's Taylor series in long doubles where it is installed; else the
compiled Taylor series of :mod:`integrable.oracles.taylor_compiled`, which imports nothing of the flow, and SciPy's
DOP853.

The equations are written independently (γ̇ = γ×Ω; those of deformations: Tsiganov, Hamiltonian H/2, time of the ball).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

from tests.fuzz.case import Undecided
from tests.fuzz.distributions import Motion

MOST_STEPS = 12000
EPS = 2.0**-52


def body(a: Any, q: Any, d: Any, c: Any, x: Any, m: Any) -> tuple[Any, Any]:
    """(Ω, Ṁ) of balls and tops, q = I·a = 1 − da, c = (γ, M): d(γ, AM) = c − (γ, QM), which is accurate for heavy
    balls, while (γ, AM) is a small difference of terms of the size of M/d.
    """
    spin = (c - dot(x, times(q, m))) / dot(x, times(q, x))
    w = [a[i] * (m[i] + spin * x[i]) for i in range(3)]
    return w, cross(m, w)


def tilde(a: Any, q: Any, d: Any, c: Any, x: Any, m: Any) -> tuple[Any, Any]:
    """H = (M, AM) − s(M, M) + 2dG(γ, AM)², s = (γ, Aγ), G = 1/(1 − ds)."""
    Ax, Am, s = times(a, x), times(a, m), dot(x, times(a, x))
    spin = d * dot(x, Am) / sum(q[i] * x[i] * x[i] for i in range(3))
    w = mixed((1, Am), (-s, m), (2 * spin, Ax))
    return w, added(cross(m, w), cross(x, mixed((spin, Am), (spin * s, m), (-dot(m, m), Ax))))


def check(a: Any, q: Any, d: Any, c: Any, x: Any, m: Any) -> tuple[Any, Any]:
    """H = s(M, AM) − s²(M, M) − 2(γ, AM)²."""
    Ax, Am, s, xi = times(a, x), times(a, m), dot(x, times(a, x)), dot(x, times(a, m))
    w = mixed((s, Am), (-s * s, m), (-2 * xi, Ax))
    return w, added(cross(m, w), cross(x, mixed((dot(m, Am) - 2 * s * dot(m, m), Ax), (-2 * xi, Am))))


def hat(a: Any, q: Any, d: Any, c: Any, x: Any, m: Any) -> tuple[Any, Any]:
    """H = α(M, AM) − (σ + ατ)(M, M), σ = (γ, A^∨γ), τ = tr A − s, α = σ tr A⁻¹ − 2τ."""
    dual, Ax, Am = [a[i - 2] * a[i - 1] for i in range(3)], times(a, x), times(a, m)
    inverse, tau = sum(1 / y for y in a), sum(a) - dot(x, Ax)
    sigma = dot(x, times(dual, x))
    alpha = sigma * inverse - 2 * tau
    height = dot(m, Am) - tau * dot(m, m)
    w = mixed((alpha, Am), (-sigma - alpha * tau, m))
    pull = mixed((inverse * height - dot(m, m), times(dual, x)), (2 * height + alpha * dot(m, m), Ax))
    return w, added(cross(m, w), cross(x, pull))


def gyroscopic(a: Any, q: Any, d: Any, c: Any, x: Any, m: Any) -> tuple[Any, Any]:
    """H = (M, AM) − s(M, M) + c(M, γ×Aγ) + c²s/4."""
    Ax, Am, s = times(a, x), times(a, m), dot(x, times(a, x))
    w = mixed((1, Am), (-s, m), (c / 2, cross(x, Ax)))
    turned = added(cross(Ax, m), times(a, cross(m, x)))
    return w, added(cross(m, w), cross(x, mixed((c * c / 4 - dot(m, m), Ax), (c / 2, turned))))


def poles(a: Any, q: Any, d: Any, b: Any, x: Any, m: Any) -> tuple[Any, Any]:
    """H = (M, AM) − s(M, M) + Σb_i(a_j + a_k − 2s)/γ_i², d = 0."""
    w, momentum = tilde(a, q, 0 * d, d, x, m)
    s, inverse = dot(x, times(a, x)), [b[i] / (x[i] * x[i]) for i in range(3)]
    falls = [inverse[i] * (a[i - 2] + a[i - 1] - 2 * s) / x[i] for i in range(3)]
    slope = mixed((-1, falls), (-2 * sum(inverse), times(a, x)))
    return w, added(momentum, cross(x, slope))


class Dual:
    """A number and its slopes along γ1, γ2 and γ3."""

    def __init__(self, value: Any, slopes: Any = (0.0, 0.0, 0.0)) -> None:
        self.value, self.slopes = value, list(slopes)

    def __add__(self, other: Any) -> Dual:
        y = _dual(other)
        return Dual(self.value + y.value, added(self.slopes, y.slopes))

    def __sub__(self, other: Any) -> Dual:
        return self + _dual(other) * -1.0

    def __rsub__(self, other: Any) -> Dual:
        return _dual(other) - self

    def __mul__(self, other: Any) -> Dual:
        y = _dual(other)
        return Dual(self.value * y.value, mixed((self.value, y.slopes), (y.value, self.slopes)))

    def __truediv__(self, other: Any) -> Dual:
        y = _dual(other)
        found = self.value / y.value
        return Dual(found, [(u - found * v) / y.value for u, v in zip(self.slopes, y.slopes, strict=True)])

    def __rtruediv__(self, other: Any) -> Dual:
        return _dual(other) / self

    __radd__, __rmul__ = __add__, __mul__


def _dual(x: Any) -> Dual:
    return x if isinstance(x, Dual) else Dual(x)


def tilde_potential(a: Any, q: Any, d: Any, b: Any, squares: Any) -> Any:
    """as + b(s³ − tr A·s²) + Σb_i(a_j + a_k − 2s)/γ_i²."""
    s = dot(a, squares)
    return b[0] * s + b[1] * (s - sum(a)) * s * s + _poles(b, squares, lambda i, j, k: a[j] + a[k] - 2 * s)


def rolling_potential(a: Any, q: Any, d: Any, b: Any, squares: Any) -> Any:
    """aG + b(G³ − TG²) + Σb_i(a_j + a_k − 2κ)/(Gγ_i²), 1/G = (γ, Qγ), κ = G(γ, AQγ), T = Σ1/q_i."""
    G, trace = 1 / dot(q, squares), sum(1 / x for x in q)
    kappa = G * dot(times(a, q), squares)
    wells = _poles(b, squares, lambda i, j, k: (a[j] + a[k] - 2 * kappa) / G)
    return b[0] * G + b[1] * (G - trace) * G * G + wells


def check_potential(a: Any, q: Any, d: Any, b: Any, squares: Any) -> Any:
    """a/s + b(s⁻³ − tr A⁻¹·s⁻²) + Σb_i(1/a_j + 1/a_k − 2/s)s/(a_iγ_i²)."""
    s = dot(a, squares)
    S, trace = 1 / s, sum(1 / x for x in a)
    wells = _poles(b, squares, lambda i, j, k: (1 / a[j] + 1 / a[k] - 2 * S) * s / a[i])
    return b[0] * S + b[1] * (S - trace) * S * S + wells


def hat_potential(a: Any, q: Any, d: Any, b: Any, squares: Any) -> Any:
    """aS + b(S³ − tr A⁻¹·S²) + Σb_i(1/a_j + 1/a_k − 2S)σ/(a_ja_kγ_i²), S = tr A⁻¹ − τ/σ."""
    trace, sigma = sum(1 / x for x in a), dot([a[i - 2] * a[i - 1] for i in range(3)], squares)
    S = trace - (sum(a) - dot(a, squares)) / sigma
    wells = _poles(b, squares, lambda i, j, k: (1 / a[j] + 1 / a[k] - 2 * S) * sigma / (a[j] * a[k]))
    return b[0] * S + b[1] * (S - trace) * S * S + wells


def _poles(b: Any, squares: Any, term: Any) -> Any:
    return sum(b[2 + i] * term(i, i - 2, i - 1) / squares[i] for i in range(3))


def in_potential(kinetic: Any, energy: Any) -> Any:
    """The equations with a potential V: Ṁ has the additional term γ × ½∂V/∂γ."""

    def rates(a: Any, q: Any, d: Any, b: Any, x: Any, m: Any) -> tuple[Any, Any]:
        w, momentum = kinetic(a, q, d, 0.0, x, m)
        gamma = [Dual(x[i], [float(i == k) for k in range(3)]) for i in range(3)]
        slopes = energy(a, q, d, b, [y * y for y in gamma]).slopes
        return w, added(momentum, cross(x, [0.5 * y for y in slopes]))

    return rates


EQUATIONS = {
    "body": body,
    "tilde": tilde,
    "check": check,
    "hat": hat,
    "gyroscopic": gyroscopic,
    "poles": poles,
    "tilde in a potential": in_potential(tilde, tilde_potential),
    "rolling tilde in a potential": in_potential(tilde, rolling_potential),
    "check in a potential": in_potential(check, check_potential),
    "hat in a potential": in_potential(hat, hat_potential),
}
# the number of constants of a potential; they scale with |M|²
TERMS = {name: 3 if name == "poles" else 5 for name in EQUATIONS if name == "poles" or name.endswith("potential")}


def dot(x: Any, y: Any) -> Any:
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


def times(a: Any, x: Any) -> list[Any]:
    return [a[i] * x[i] for i in range(3)]


def cross(x: Any, y: Any) -> list[Any]:
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def mixed(*terms: Any) -> list[Any]:
    return [sum(c * v[i] for c, v in terms) for i in range(3)]


def added(x: Any, y: Any) -> list[Any]:
    return [x[i] + y[i] for i in range(3)]


class Integrated:
    """``rows`` (N, 6) of γ and M/|M(0)|, NaN beyond the horizon, and ``floor`` (N,) as in :class:`closed_forms.Closed`.

    ``equations``: a name above; ``c``: the constant of the gyroscopic terms, the three constants of the poles, the five
    of a potential, or (γ, M) of a body.
    """

    def __init__(self, start: Motion, equations: str = "body", c: Any = 0.0) -> None:
        self.start, self.equations, self.c = start, equations, c
        self.extended = heyoka() is not None

    def rows(self, wanted: Any) -> np.ndarray:
        s = self.start
        return self._rows(*map(np.longdouble, (s.inertia, s.d, s.gamma, s.M, self.c)), wanted)

    def floor(self, wanted: Any) -> np.ndarray:
        """The largest effect of two random relative changes of all inputs by 2^-46, scaled to changes of 2^-52."""
        s, wild = self.start, np.random.default_rng(0)
        base, worst = self.rows(wanted), np.zeros(len(wanted))
        for _ in range(2):
            f = 1 + np.longdouble(2.0**-46) * wild.choice([-1, 1], 11)
            for i, j in ((1, 0), (2, 0), (2, 1)):
                f[i] = f[j] if s.inertia[i] == s.inertia[j] else f[i]
            inputs = s.inertia * f[:3], s.d * f[3], s.gamma * f[4:7], s.M * f[7:10], self.c * f[10]
            worst = np.maximum(worst, abs(self._rows(*inputs, wanted) - base).max(axis=1))
        return worst / 64 + 4 * EPS + self._own_error(base, wanted)

    def _own_error(self, base: np.ndarray, wanted: Any) -> Any:
        """The error of the integrator itself: from another order of its series, or a bound per turn."""
        s = self.start
        if self.extended:
            inertia, d, gamma, M, c = map(np.longdouble, (s.inertia, s.d, s.gamma, s.M, self.c))
            order = abs(self._rows(inertia, d, gamma, M, c, wanted, 1e-17) - base).max(axis=1)
            if gamma.all() and M.all():
                return order
            # near unstable rotations a zero grows from the rounding of the first step
            nudged = [np.where(v == 0, np.finfo(np.longdouble).eps * abs(v).max(), v) for v in (gamma, M)]
            return order + abs(self._rows(inertia, d, *nudged, c, wanted) - base).max(axis=1)
        turns = np.array([1 + abs(t) * s.speed for t in wanted]) * (1 + s.d / min(s.inertia))
        return (10 * EPS if self.equations == "body" else 1e-12) * turns

    def _rows(self, inertia: Any, d: Any, gamma: Any, M: Any, c: Any, wanted: Any, tol: float = 1e-20) -> np.ndarray:
        gamma = gamma / np.sqrt(gamma @ gamma)
        if not self.start.tilted:
            M = M - (gamma @ M) * gamma
        if self.equations == "body":
            c = gamma @ M if self.start.tilted else 0 * c
        unit = np.sqrt(M @ M)
        a, wanted = 1 / (inertia + d), np.array(wanted) * unit
        c = c / (unit * unit if self.equations in TERMS else unit)
        if self.extended:
            return by_heyoka(
                _integrator(self.equations, tol),
                [*a, *(inertia * a), d, *np.atleast_1d(c)],
                [*gamma, *M / unit],
                wanted,
            )
        # motions beyond every integrator in extended precision are left to cases with shorter times
        wanted = np.where(abs(wanted) * max(a) <= MOST_STEPS / 6, wanted, np.nan)
        if self.equations == "body":
            return _by_taylor(inertia, d, gamma, M / unit, wanted)
        constants = *(np.array(v, dtype=float) for v in (a, inertia * a)), float(d), np.array(c, dtype=float)

        def rates(y: Any) -> list[Any]:
            w, momentum = EQUATIONS[self.equations](*constants, y[:3], y[3:])
            return [*cross(y[:3], w), *momentum]

        return by_scipy(rates, np.array([*gamma, *M / unit], dtype=float), wanted)


@cache
def heyoka() -> Any:
    """The module heyoka, None where it is not installed."""
    try:
        import heyoka as found
    except ImportError:
        return None
    return found


@cache
def _integrator(name: str, tol: float) -> Any:
    """heyoka's integrator of the equations with their constants as parameters, compiled once."""
    hy = heyoka()
    x, m = hy.make_vars("x1", "x2", "x3"), hy.make_vars("m1", "m2", "m3")
    a, q, d, c = [hy.par[i] for i in range(3)], [hy.par[3 + i] for i in range(3)], hy.par[6], hy.par[7]
    if name in TERMS:
        c = [hy.par[7 + i] for i in range(TERMS[name])]
    w, momentum = EQUATIONS[name](a, q, d, c, x, m)
    equations = list(zip([*x, *m], [*cross(x, w), *momentum], strict=True))
    start = np.zeros(6, np.longdouble)
    return hy.taylor_adaptive(equations, start, fp_type=np.longdouble, tol=np.longdouble(tol), compact_mode=True)


def by_heyoka(run: Any, constants: Any, start: Any, wanted: np.ndarray) -> np.ndarray:
    """The states at times from ``start``, NaN from where the integrator gives up."""
    run.pars[:] = constants[: len(run.pars)]
    rows = np.full((len(wanted), len(start)), np.nan)
    for sign in (1, -1):
        chosen = np.flatnonzero(sign * wanted > 0)
        if not len(chosen):
            continue
        grid, back = np.unique(abs(wanted[chosen]), return_inverse=True)
        run.time = np.longdouble(0)
        run.state[:] = start
        *_, values = run.propagate_grid(np.concatenate([[0], sign * grid]).astype(np.longdouble), max_steps=MOST_STEPS)
        found = np.full((len(grid), len(start)), np.nan)
        found[: max(0, len(values) - 1)] = values[1:]
        rows[chosen] = found[back]
    rows[wanted == 0] = start
    return rows


def _by_taylor(inertia: Any, d: Any, gamma: Any, M: Any, wanted: np.ndarray) -> np.ndarray:
    from integrable.oracles.methods import METHODS

    system, start = SimpleNamespace(inertia=inertia, d=d), SimpleNamespace(gamma=gamma, M=M)
    near, rows = ~np.isnan(wanted), np.full((len(wanted), 6), np.nan)
    found = METHODS["Taylor, compiled"].solve(system, start, wanted[near].tolist(), 1e-17)
    rows[near] = np.hstack([found.gamma, found.M])
    return rows


def by_scipy(rates: Callable[[Any], list[Any]], start: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The states y at times of y' = rates(y), in floats."""
    from scipy.integrate import solve_ivp

    rows = np.full((len(wanted), len(start)), np.nan)
    for sign in (1, -1):
        chosen = np.flatnonzero(sign * wanted > 0)
        if not len(chosen):
            continue
        grid, back = np.unique(abs(wanted[chosen]), return_inverse=True)
        found = solve_ivp(
            lambda _, y: rates(y), (0, sign * grid[-1]), start, "DOP853", sign * grid, rtol=3e-14, atol=1e-16
        )
        if not found.success:
            raise Undecided("SciPy gave up")
        rows[chosen] = found.y.T[back]
    rows[wanted == 0] = start
    return rows
