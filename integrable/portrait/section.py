"""Poincaré sections in closed form.

The component of γ̃ along the axis of the largest moment vanishes where u1 = a₁; the component along the axis of the
least moment vanishes where u2 = a₃.
Every motion crosses these surfaces transversally, once per turn of u1 or of u2. From the second integral at the n-th
crossing of the first, with S_k = Σ∫x^k dx/y at the start,

    E = ∫x dx/y of u2 = S1 − 2nA1,   τ_n = 2nA0 + F − S0,   F = ∫dx/y of u2,

so that the map rotates ϑ = E/(2B1) by −A1/B1 (on the other section with A and B exchanged). On the section γ̃ is (0,
cos φ, sin φ) in the sorted axes, and each motion lies on its own curve,

    M̃₁²/h̃2 = (q − ζ)/(q − a₁),   q = (a₃cos²φ + a₂sin²φ − d̃a₂a₃)/(1 − d̃(a₂cos²φ + a₃sin²φ)).
"""

from __future__ import annotations

from math import ceil, log2
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point.newton import step_inside
from integrable.portrait.ovals import Level
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import one_of, whole
from jacobian.immutable import Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

AXES = ("largest", "least")
# initial number of nodes of an oval's series, and the largest
FIRST_NODES, MOST_NODES = 64, 1 << 16
PASSES = 60
# number of sines summed in one array operation
SINES = 1 << 20
# initial digits of floats, and the size of an angle's step below them
ROUGH_DIGITS, ROUGH = 12, 1e-13
MOST_CROSSINGS = 10**6


class Section(Record):
    """The crossings of a motion with a surface γ̃_i = 0. Get one from ``flow.section(count)``.

    ``axis`` (0, 1 or 2) is i; ``tau`` (N,) are the values of τ at the crossings, ``run`` is the Trajectory there;
    ``phi`` and ``momentum`` (N,) the coordinates on the section, the angle of γ̃ from the next axis (of sorted a) and
    M̃_i/|M̃|; ``theta`` (N,) the angle in turns in which the map is a rotation by ``rotation``.
    """

    def __init__(
        self, axis: int, run: Any, phi: np.ndarray, momentum: np.ndarray, theta: np.ndarray, rotation: Real
    ) -> None:
        self.axis, self.run, self.phi, self.momentum, self.theta = axis, run, phi, momentum, theta
        self.rotation = rotation

    @property
    def tau(self) -> Any:
        """The values of the flow's own time τ at the crossings, shape (N,)."""
        return self.run.tau

    def figure(self) -> Figure:
        """A picture: the crossings among the curves of other motions of the same upright body."""
        from integrable.portrait.pictures import section_figure

        return section_figure(self)

    def __len__(self) -> int:
        return len(self.phi)

    def _repr_html_(self) -> str:
        from jacobian.notebook import table

        columns = (self.tau, self.phi, self.momentum, self.theta)
        return table(repr(self), ["τ", "φ", "M/|M|", "ϑ"], list(zip(*(x.tolist() for x in columns), strict=True)))

    def __repr__(self) -> str:
        return f"<Section of {len(self)} crossings of axis {self.axis}, {self.run.system!r}>"


def section(flow: Any, count: int, axis: str) -> Section:
    """The next ``count`` crossings of the section of the axis of the "largest" or the "least" moment.

    NotRepresentable for a motion on no torus of dimension two.
    """
    count = whole(count, "count", f"the number of crossings is an int from 1 to {MOST_CROSSINGS}", 1, MOST_CROSSINGS)
    axis = one_of(axis, "axis", AXES, 'choose "largest" or "least" (moment)')
    portrait = flow.portrait
    level, ovals = portrait.level, portrait.moving("section")
    first = axis == "largest"
    one, two = (theta - theta.context.nint(theta) for theta in portrait.wide_angles("section"))
    sums = 2 * (one * ovals.A0 + two * ovals.B0), 2 * (one * ovals.A1 + two * ovals.B1)
    own, other = ((ovals.A0, ovals.A1), (ovals.B0, ovals.B1)) if first else ((ovals.B0, ovals.B1), (ovals.A0, ovals.A1))
    series = OvalSeries(level, 1 if first else 0)
    # n counts the crossings, downwards on the second oval. Only their τ tells which is the first with τ > 0, so a few
    # before it are computed too
    sign = 1 if first else -1
    steps = np.array([sign * n for n in range(-3, count + 4)], dtype=object)
    rest = [sums[1] - 2 * n * own[1] for n in steps]
    theta = [E / (2 * other[1]) for E in rest]
    nearest = [t.context.nint(t) for t in theta]
    short = np.array([float(E - 2 * n * other[1]) for E, n in zip(rest, nearest, strict=True)])
    part = series.first(short)
    tau = [2 * n * own[0] + 2 * m * other[0] - sums[0] for n, m in zip(steps, nearest, strict=True)]
    found = np.array([float(t) for t in tau]) + part
    chosen = np.flatnonzero(found > 0)[:count]
    K = flow.system.field
    wide = [K.coerce(tau[i] + K.coerce(float(part[i]))) for i in chosen]
    body_axis = level.axes[0] if first else level.axes[2]
    run = _refined(flow, np.array(wide, dtype=float if K == RR else object), body_axis)
    gamma, M = tilde(flow, run)
    j, k = (level.axes[1], level.axes[2]) if first else (level.axes[1], level.axes[0])
    angle = np.arctan2(gamma[:, k].astype(float), gamma[:, j].astype(float))
    size = np.sqrt(np.sum(M.astype(float) ** 2, axis=1))
    turns = np.array([float(theta[i] - theta[i].context.floor(theta[i])) for i in chosen])
    return Section(body_axis, run, angle, M[:, body_axis].astype(float) / size, turns, float(-sign * own[1] / other[1]))


def tilde(flow: Any, run: Any) -> tuple[np.ndarray, np.ndarray]:
    """The vectors γ + kM and M − dkH1γ along a run, shapes (N, 3): γ̃ and M̃ up to factors."""
    change = flow.setup.tilt
    if change is None:
        return run.gamma, run.M
    k, shift = (flow.system.field.coerce(x) for x in (change.k, change.shift))
    return run.gamma + k * run.M, run.M - shift * run.gamma


def _refined(flow: Any, tau: Any, axis: int) -> Any:
    """The Trajectory at the crossings near τ, by Newton steps on the flow, each of which doubles the digits."""
    K = flow.system.field
    for _ in range(1 if K == RR else ceil(log2(K.dps / ROUGH_DIGITS)) + 1):
        run = flow.at_tau(tau)
        gamma, _ = tilde(flow, run)
        rate = np.cross(gamma, run.omega)[:, axis]
        slow = np.sum(np.array(flow.system.body.contact) * run.gamma**2, axis=1) ** (K.one / 2)
        tau = tau - gamma[:, axis] / (rate * slow)
    return flow.at_tau(tau)


class OvalSeries:
    """∫dx/y as a function of ∫x dx/y, both from the outer end e of an oval to a point of it, in floats. They are
    Fourier series in φ, where x = e + (e' − e)sin²φ and e' is the inner end.
    """

    def __init__(self, level: Level, oval: int) -> None:
        a, b, c, e = map(float, level.ends)
        outer, inner, others = (a, b, (c, e)) if oval == 0 else (e, c, (a, b))
        count = FIRST_NODES
        while True:
            angles = np.pi * np.arange(count) / count
            x = outer + (inner - outer) * np.sin(angles) ** 2
            rest = np.abs((1 - float(level.d) * x) * (x - others[0]) * (x - others[1]))
            values = 1 / (float(level.momentum) * np.sqrt(rest))
            modes = [np.fft.rfft(y).real / count for y in (values, x * values)]
            if np.abs(modes[1][-count // 8 :]).max() < 1e-15 * abs(modes[1][0]) or count >= MOST_NODES:
                break
            count *= 2
        self._modes = modes

    def first(self, second: np.ndarray) -> np.ndarray:
        """∫dx/y at the point where ∫x dx/y is ``second``, at most half a turn in either direction."""
        size = max(1, SINES // len(self._modes[0]))
        parts = [self._first(second[begin : begin + size]) for begin in range(0, len(second), size)]
        return np.concatenate(parts)

    def _first(self, second: np.ndarray) -> np.ndarray:
        low, high = np.full(len(second), -np.pi / 2), np.full(len(second), np.pi / 2)
        angle = second / self._modes[1][0]
        for _ in range(PASSES):
            gap = self._value(1, angle) - second
            better, low, high = step_inside(angle, gap, self._slope(1, angle), low, high)
            done = np.abs(better - angle).max(initial=0) < ROUGH
            angle = better
            if done:
                break
        return self._value(0, angle)

    def _value(self, k: int, angle: np.ndarray) -> np.ndarray:
        modes = self._modes[k]
        n = np.arange(1, len(modes))
        found: np.ndarray = modes[0] * angle + np.sin(2 * np.outer(angle, n)) @ (modes[1:] / n)
        return found

    def _slope(self, k: int, angle: np.ndarray) -> np.ndarray:
        modes = self._modes[k]
        n = np.arange(1, len(modes))
        found: np.ndarray = modes[0] + 2 * np.cos(2 * np.outer(angle, n)) @ modes[1:]
        return found
