"""Poincaré sections of a body, in closed form.

The component of γ̃ along the axis of the largest moment vanishes where u1 = a₁; the component along the axis of the
least moment vanishes where u2 = a₃. Every motion crosses these surfaces transversally, once per turn of u1 or of u2.
The crossings are computed by :mod:`integrable.portrait.torus_section`. From one crossing of the first section to the
next the phase of u2 turns by −A1/B1; from one crossing of the second to the next the phase of u1 turns by B1/A1. On the
section γ̃ is (0, cos φ, sin φ) in the sorted axes, and each motion lies on its own curve,

    M̃₁²/h̃2 = (q − ζ)/(q − a₁),   q = (a₃cos²φ + a₂sin²φ − d̃a₂a₃)/(1 − d̃(a₂cos²φ + a₃sin²φ)).
"""

from __future__ import annotations

from math import ceil, log2
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.portrait.oval_angles import OvalAngles
from integrable.portrait.ovals import Level
from integrable.portrait.torus_section import Turning
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import one_of
from jacobian.immutable import Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

AXES = ("largest", "least")
# the first and the largest number of nodes of an oval's series
FIRST_NODES, MOST_NODES = 64, 1 << 16
# the number of digits of a τ in floats, which Newton's method doubles
ROUGH_DIGITS = 12


class Section(Record):
    """The crossings of a motion with a surface γ̃_i = 0. Get one from ``flow.section(count)``.

    ``axis`` (0, 1 or 2) is i. ``tau`` (N,) are the values of τ at the crossings, ``run`` is the Trajectory there.
    ``phi`` and ``momentum`` (N,) are the coordinates on the section: the angle of γ̃ from the axis of the middle moment,
    and M̃_i/|M̃|. ``theta`` (N,) is the angle, in turns, in which the map is a rotation by ``rotation``.
    """

    def __init__(
        self, axis: int, run: Any, phi: np.ndarray, momentum: np.ndarray, theta: np.ndarray, rotation: Real
    ) -> None:
        self.axis, self.run, self.phi, self.momentum, self.theta = axis, run, phi, momentum, theta
        self.rotation = rotation

    @property
    def tau(self) -> np.ndarray:
        """The values of the flow's own time τ at the crossings, shape (N,)."""
        found: np.ndarray = self.run.tau
        return found

    def figure(self) -> Figure:
        """A picture: the crossings, with the curves of other motions of the same upright body."""
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
    """The next ``count`` crossings of the section for the axis of the "largest" or the "least" moment.

    NotRepresentable for a motion on no torus of dimension two.
    """
    oval = AXES.index(one_of(axis, "axis", AXES, 'choose "largest" or "least" (moment)'))
    portrait, K = flow.portrait, flow.system.field
    angles, sums = portrait.wide_angles("section"), sums_over_ovals(portrait.level)
    start = sums.at(np.array([angles], dtype=float))[0]
    motion = Turning(portrait.wide_tau_frequencies, angles, start, sums, np.array([1.0, 0.0]))
    tau, theta, rotation = motion.crossings(count, oval, 0.0)
    i, j, k = reversed(portrait.level.axes) if oval else portrait.level.axes
    run = _refined(flow, np.array([*map(K.coerce, tau)], dtype=float if K == RR else object), i)
    gamma, M = (x.astype(float) for x in tilde(flow, run))
    phi, height = np.arctan2(gamma[:, k], gamma[:, j]), M[:, i] / np.sqrt(np.sum(M**2, axis=1))
    return Section(i, run, phi, height, theta[:, 0], float(rotation[0]))


def tilde(flow: Any, run: Any) -> tuple[np.ndarray, np.ndarray]:
    """The vectors γ + kM and M − dkH1γ along a run, shapes (N, 3): γ̃ and M̃ up to factors."""
    change = flow.setup.tilt
    if change is None:
        return run.gamma, run.M
    k, shift = (flow.system.field.coerce(x) for x in (change.k, change.shift))
    return run.gamma + k * run.M, run.M - shift * run.gamma


def _refined(flow: Any, tau: np.ndarray, axis: int) -> Any:
    """The Trajectory at the crossings near τ, by Newton steps on the flow, each of which doubles the digits."""
    K = flow.system.field
    for _ in range(1 if K == RR else ceil(log2(K.dps / ROUGH_DIGITS)) + 1):
        run = flow.at_tau(tau)
        gamma, _ = tilde(flow, run)
        rate = np.cross(gamma, run.omega)[:, axis]
        slow = np.sum(np.array(flow.system.body.contact) * run.gamma**2, axis=1) ** (K.one / 2)
        tau = tau - gamma[:, axis] / (rate * slow)
    return flow.at_tau(tau)


def sums_over_ovals(level: Level) -> OvalAngles:
    """∫dx/y and ∫x dx/y of both points in floats, as functions of angles φ that are 0 at the outer ends: x moves from
    an outer end e to an inner end e' as e + (e' − e)sin²½φ.
    """
    a, b, c, e = map(float, level.ends)
    rows = [_modes(level, *oval) for oval in ((a, b, c, e), (e, c, a, b))]
    return OvalAngles(
        np.array([row[0] / 2 for row in rows]), tuple(row[1:] / np.arange(1, len(row))[:, None] for row in rows)
    )


def _modes(level: Level, outer: float, inner: float, *others: float) -> np.ndarray:
    """The Fourier modes in φ of dx/y and x dx/y, divided by ½dφ, on one oval, shape (n, 2)."""
    count = FIRST_NODES
    while True:
        x = outer + (inner - outer) * np.sin(np.pi * np.arange(count) / count) ** 2
        rest = np.abs((1 - float(level.d) * x) * (x - others[0]) * (x - others[1]))
        values = 1 / (float(level.momentum) * np.sqrt(rest))
        modes: np.ndarray = np.fft.rfft(np.stack([values, x * values], axis=1), axis=0).real / count
        if np.abs(modes[-count // 8 :, 1]).max() < 1e-15 * abs(modes[0, 1]) or count >= MOST_NODES:
            return modes
        count *= 2
