"""The equations of the systems of ``integrable.classical``, written independently, and their integration."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from tests.fuzz.case import Undecided
from tests.fuzz.integrated import EPS, by_heyoka, by_scipy, cross, dot, heyoka

Rates = tuple[list[Any], list[Any]]


def neumann(c: Any, q: Any, p: Any, exp: Any) -> Rates:
    """q'' = −Aq + mq, with m that keeps |q| constant."""
    m = (_sum(a * x * x for a, x in zip(c, q, strict=True)) - _square(p)) / _square(q)
    return list(p), [(m - a) * x for a, x in zip(c, q, strict=True)]


def ellipsoid(c: Any, q: Any, p: Any, exp: Any) -> Rates:
    """x'' = −νA⁻¹x."""
    normal = [x / a for a, x in zip(c, q, strict=True)]
    pull = _sum(v * v / a for a, v in zip(c, p, strict=True)) / _square(normal)
    return list(p), [-1 * pull * x for x in normal]


def garnier(c: Any, q: Any, p: Any, exp: Any) -> Rates:
    """q_i'' = (αa_i + β − 2α|q|²)q_i; c = (a_1 … a_n, α, β)."""
    *a, alpha, beta = c
    square = _square(q)
    return list(p), [(alpha * e + beta - 2 * alpha * square) * x for e, x in zip(a, q, strict=True)]


def henon_heiles(c: Any, q: Any, p: Any, exp: Any) -> Rates:
    """The forces of H = −4αq_0³ − 2αq_0|q|² − β(2q_0² + ½|q|²) − ½αΣa_i q_i² − γq_0; c = (a_1 … a_n, α, β, γ)."""
    *a, alpha, beta, gamma = c
    x, *rest = q
    first = 12 * alpha * x * x + 2 * alpha * _square(rest) + 4 * beta * x + gamma
    return list(p), [first, *((4 * alpha * x + beta + alpha * e) * y for e, y in zip(a, rest, strict=True))]


def lagrange(c: Any, q: Any, p: Any, exp: Any) -> Rates:
    """γ' = γ×Ω, M' = M×Ω + γ×e_3, Ω = (M_1, M_2, jM_3); c = (j,)."""
    omega = [p[0], p[1], c[0] * p[2]]
    weight = [q[1], -1 * q[0], 0 * q[2]]
    return cross(q, omega), [x + y for x, y in zip(cross(p, omega), weight, strict=True)]


def pendulum(c: Any, q: Any, p: Any, exp: Any) -> Rates:
    """q'' = −e_3 + tension·q."""
    tension = (q[2] - _square(p)) / _square(q)
    return list(p), [tension * q[0], tension * q[1], tension * q[2] - 1]


def toda(c: Any, q: Any, p: Any, exp: Any) -> Rates:
    links = [exp(q[(k + 1) % len(q)] - q[k]) for k in range(len(q))]
    return list(p), [links[k] - links[k - 1] for k in range(len(q))]


def veselova(c: Any, q: Any, p: Any, exp: Any) -> Rates:
    """γ' = γ×ω, M' = M×ω, ω_i = a_i Σ_j a_jγ_j(γ_jM_i − γ_iM_j)/Σ_j a_jγ_j², a_i = 1/I_i; c the moments."""
    leaning = [x / e for x, e in zip(q, c, strict=True)]
    stretch = dot(q, leaning)
    omega = []
    for x, m, e in zip(q, p, c, strict=True):
        # A(M − pull·γ) would cancel completely if moments are very different
        omega.append(dot(leaning, [y * m - x * n for y, n in zip(q, p, strict=True)]) / (e * stretch))
    return cross(q, omega), cross(p, omega)


def galaxy(c: Any, q: Any, p: Any, exp: Any) -> Rates:
    """q'' = ∇(GM/S), S² = |q|² + a² + c² + 2P, P² = a²c² + c²(x² + y²) + a²z²; c = (a, c, GM)."""
    long, short, mass = c[0] * c[0], c[1] * c[1], c[2]
    inner = (long * short + short * (q[0] * q[0] + q[1] * q[1]) + long * q[2] * q[2]) ** 0.5
    square = _square(q) + long + short + 2 * inner
    pull = -1 * mass / (square * square**0.5)
    flat = pull * (1 + short / inner)
    return list(p), [flat * q[0], flat * q[1], pull * (1 + long / inner) * q[2]]


EQUATIONS: dict[str, Callable[..., Rates]] = {
    "Neumann": neumann,
    "Ellipsoid": ellipsoid,
    "Garnier": garnier,
    "HenonHeiles": henon_heiles,
    "KuzminKutuzov": galaxy,
    "LagrangeTop": lagrange,
    "SphericalPendulum": pendulum,
    "TodaLattice": toda,
    "Veselova": veselova,
}


def _sum(terms: Any) -> Any:
    first, *rest = terms
    for term in rest:
        first = first + term
    return first


def _square(x: Any) -> Any:
    return _sum(y * y for y in x)


@dataclass(frozen=True)
class Motion:
    """A system, given by its class and its arguments (numbers and tuples of numbers), and a start: all floats but the
    size of a lattice. ``bound``: whether q lies on a quadric; ``tangent``: whether p is tangent to it.
    """

    name: str
    module: str
    arguments: tuple[Any, ...]
    q: tuple[float, ...]
    p: tuple[float, ...]
    bound: bool = False
    tangent: bool = False

    @property
    def setup(self) -> str:
        """The lines that make ``system``, ``state`` and ``flow``."""
        return (
            "import numpy as np\n"
            f"from integrable.classical.{self.module} import {self.name}\n"
            f"system = {self.name}({', '.join(map(str, self.arguments))})\n"
            f"state = system.state({self.q}, {self.p})\n"
            "flow = system.flow(state)\n"
        )

    @property
    def constants(self) -> list[float]:
        """The constants of the equations."""
        parts = (x if isinstance(x, tuple) else (x,) for x in self.arguments)
        return [x for part in parts for x in part if isinstance(x, float)]

    @property
    def speed(self) -> float:
        """The relative size of the rates of q and p."""
        c, q, p = (list(map(float, x)) for x in (self.constants, self.q, self.p))
        rates = EQUATIONS[self.name](c, q, p, np.exp)
        size, push = max(map(abs, q)), max(map(abs, p), default=0.0)
        found = max(map(abs, rates[0])) / (size or 1.0)
        return max(found, max(map(abs, rates[1])) / max(push, found * size, 1e-300))


class Integrated:
    """``rows`` (N, 2n) of q and p, NaN beyond the horizon, and ``floor`` (N,): the changes of q and p, relative to
    their sizes, for a change of one unit in the last place of every input.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion = motion

    def rows(self, wanted: Sequence[float]) -> np.ndarray:
        return self._rows(*self._inputs(), wanted)

    def floor(self, wanted: Sequence[float]) -> np.ndarray:
        base, worst, wild = self.rows(wanted), np.zeros(len(wanted)), np.random.default_rng(0)
        inputs = self._inputs()
        for _ in range(3):
            moved = [x * (1 + np.longdouble(2.0**-46) * wild.choice([-1, 1], len(x))) for x in inputs]
            worst = np.maximum(worst, beside(self._rows(*moved, wanted) - base, base))
        own = 1e-12 * np.array([1 + abs(t) * self.motion.speed for t in wanted])
        if heyoka() is not None:
            own = beside(self._rows(*inputs, wanted, 1e-17) - base, base)
        return worst / 64 + 4 * EPS + own

    def _inputs(self) -> list[np.ndarray]:
        return [np.array(x, dtype=np.longdouble) for x in (self.motion.constants, self.motion.q, self.motion.p)]

    def _rows(self, c: Any, q: Any, p: Any, wanted: Any, tol: float = 1e-20) -> np.ndarray:
        q, p = self._constrained(c, q, p)
        if heyoka() is not None:
            run = _integrator(self.motion.name, len(c), len(q), tol)
            return by_heyoka(run, c, [*q, *p], np.array(wanted))
        if max(map(abs, wanted)) * self.motion.speed > 100:
            raise Undecided("beyond SciPy's horizon")

        def rates(y: Any) -> list[Any]:
            found = EQUATIONS[self.motion.name](c.astype(float), y[: len(q)], y[len(q) :], np.exp)
            return [*found[0], *found[1]]

        return by_scipy(rates, np.array([*q, *p], dtype=float), np.array(wanted))

    def _constrained(self, c: Any, q: Any, p: Any) -> tuple[Any, Any]:
        if not self.motion.bound:
            return q, p
        weights = 1 / c if self.motion.name == "Ellipsoid" else np.ones(len(q), np.longdouble)
        q = q / np.sqrt(q @ (weights * q))
        normal = weights * q
        return q, (p - (normal @ p) / (normal @ normal) * normal if self.motion.tangent else p)


def beside(errors: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """The largest error of each row: q relative to the largest q of that row of ``rows``, p to the largest p."""
    half = rows.shape[1] // 2
    found = [
        abs(errors[:, part]).max(axis=1) / np.maximum(abs(rows[:, part]).max(axis=1), 1e-300)
        for part in (slice(half), slice(half, None))
    ]
    return np.maximum(*found)


@cache
def _integrator(name: str, constants: int, size: int, tol: float) -> Any:
    hy = heyoka()
    q, p = ([hy.expression(f"{letter}{i}") for i in range(size)] for letter in "qp")
    rates = EQUATIONS[name]([hy.par[i] for i in range(constants)], q, p, hy.exp)
    equations = list(zip([*q, *p], [*rates[0], *rates[1]], strict=True))
    start = np.zeros(2 * size, np.longdouble)
    return hy.taylor_adaptive(equations, start, fp_type=np.longdouble, tol=np.longdouble(tol), compact_mode=True)
