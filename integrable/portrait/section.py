"""Poincaré sections, in closed form: the times at which one point of the moving divisor passes a branch point.

On the torus of a motion φ_k = 2πn is a section, where φ_k is the angle of a point in its oval. Let t_n be the time at
which the phase θ_k, which is linear in time, completes n turns. From t_n to t_{n+1} the other phases θ_j advance by
f_j/f_k, where f are the frequencies. The crossing itself is a bounded time away from t_n. Where the phases are linear
in τ rather than t, time means τ here.

For a body let u1, u2, the sorted a_i, ζ and the integrals A1 and B1 be as in :mod:`integrable.portrait.ovals`; tildes
refer to the upright body. The component of γ̃ along the axis of the largest moment vanishes where u1 = a₁; the
component along the axis of the least moment vanishes where u2 = a₃. These surfaces are the first and the
second section. Every motion crosses them transversally, once per turn of u1 or of u2.

From one crossing of the first section to the next the phase of u2 turns by −A1/B1; from one crossing of the second to
the next the phase of u1 turns by B1/A1. On the first section γ̃ is (0, cos φ, sin φ) in the sorted axes, and each
motion lies on its own curve,

    M̃₁²/h̃2 = (q − ζ)/(q − a₁),   q = (a₃cos²φ + a₂sin²φ − d̃a₂a₃)/(1 − d̃(a₂cos²φ + a₃sin²φ)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.phase.ways import rounded
from integrable.portrait.oval_angles import OvalAngles
from integrable.portrait.ovals import Level
from integrable.portrait.pictures import section_figure
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import NotRepresentable, one_of, whole, written
from jacobian.immutable import Record
from jacobian.notebook import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from integrable.portrait.separated import SeparatedTorus

ENDS, AXES = ("lower", "upper"), ("largest", "least")
MOST_CROSSINGS = 10**6
# a start within this fraction of a turn from a crossing counts as a start at the crossing
ON = 1e-12
FIRST_NODES, MOST_NODES = 64, 1 << 16
# the number of right digits of the first τ, which is computed in floats; each step of Newton's method doubles it
ROUGH_DIGITS = 12


class Section(Record):
    """The crossings of one end of an oval by the point in it. Get one from ``flow.section(count)``.

    ``run`` are the states at the crossings, and ``times`` (N,) their times. ``theta`` (N, g − 1) are the phases of the
    other points, in turns modulo 1, in which the map from one crossing to the next is the rotation by ``rotation`` (g −
    1,).
    """

    def __init__(self, run: Any, theta: np.ndarray, rotation: np.ndarray | Real) -> None:
        self.run, self.theta, self.rotation = run, theta, rotation

    @property
    def path(self) -> Any:
        """Another name of ``run``: for a system without a body the states are a ``Path``."""
        return self.run

    @property
    def times(self) -> np.ndarray:
        """The times of the crossings, shape (N,)."""
        return self.run.times

    def __len__(self) -> int:
        return len(self.theta)

    def __repr__(self) -> str:
        return f"<Section of {len(self)} crossings>"


class BodySection(Section):
    """The crossings of a body's motion with a surface γ̃_i = 0: ``axis`` (0, 1 or 2) is i.

    ``tau`` (N,) are the values of τ at the crossings. ``phi`` and ``momentum`` (N,) are the coordinates on the section:
    the angle of γ̃ from the axis of the middle moment, and M̃_i/|M̃|. One point of the divisor is then at an end of its
    oval; ``theta`` (N,) is the phase of the other, in turns, which grows by ``rotation`` from crossing to crossing.
    """

    def __init__(self, run: Any, theta: np.ndarray, rotation: Real, axes: tuple[int, int, int]) -> None:
        self.axis, j, k = axes
        # the squares of a small or a large |M| may be beyond the range of floats
        gamma, M = ((x / abs(x).max()).astype(float) for x in tilde(run.flow, run))
        self.phi = np.arctan2(gamma[:, k], gamma[:, j])
        self.momentum: np.ndarray = M[:, self.axis] / np.sqrt(np.sum(M**2, axis=1))
        super().__init__(run, theta, rotation)

    @property
    def tau(self) -> np.ndarray:
        """The values of the flow's own time τ at the crossings, shape (N,)."""
        return self.run.tau

    def figure(self) -> Figure:
        """A picture of the crossings. For the axis of the largest moment it also has curves of other motions."""
        return section_figure(self)

    def _repr_html_(self) -> str:
        columns = (self.tau, self.phi, self.momentum, self.theta)
        return table(repr(self), ["τ", "φ", "M/|M|", "ϑ"], list(zip(*(x.tolist() for x in columns), strict=True)))


def turned(
    count: int,
    oval: int,
    end: float,
    motion: tuple[Sequence[Real], Sequence[Real]],
    sums: OvalAngles | None = None,
) -> tuple[list[Real], np.ndarray, np.ndarray]:
    """The times of the next ``count`` crossings, the phases (N, g − 1) of the other points there, and their change per
    crossing. At a crossing the point of an oval has made n + ``end`` turns, where ``end`` is 0 or ½.

    ``motion`` are the frequencies of all points and their phases at the start, in turns, in long numbers. ``sums``
    determine the angles φ of the points; None if φ/2π is the phase of its oval.
    """
    count = whole(count, "count", f"the number of crossings is an int from 1 to {MOST_CROSSINGS}", 1, MOST_CROSSINGS)
    nu, place = motion
    start = np.array([place], dtype=float)
    around = (sums.at(start)[0] / (2 * math.pi) if sums else start)[0, oval] - end
    ahead = nu[oval] > 0
    first = math.floor(around + ON) + 1 if ahead else math.ceil(around - ON) - 1
    turns = [first + n if ahead else first - n for n in range(count)]
    begin = [(n + end - place[oval]) / nu[oval] for n in turns]
    fractions = [[x - math.floor(x) for x in (p + f * t for p, f in zip(place, nu, strict=True))] for t in begin]
    phases = np.array(fractions, dtype=float)
    phases[:, oval] = end
    late = sums.delays(phases, oval, np.array(nu, dtype=float)).tolist() if sums else [0] * count
    others = [k for k in range(len(nu)) if k != oval]
    rotation = np.array([float(nu[k] / nu[oval]) * (1 if ahead else -1) for k in others])
    return [t + x for t, x in zip(begin, late, strict=True)], phases[:, others], rotation


def end_of_oval(oval: int, end: str, genus: int) -> tuple[int, float]:
    """The number of an oval, and the turns of its point at the "lower" or the "upper" end: 0 or ½."""
    oval = whole(oval, "oval", f"the number of an oval is an int from 0 to {genus - 1}", 0, genus - 1)
    return oval, 0.5 if one_of(end, "end", ENDS, 'choose "lower" or "upper"') == "upper" else 0.0


def crossings(torus: SeparatedTorus, count: int, oval: int, end: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """In floats: the times of the next ``count`` crossings, and the phases of the other points with their change from
    one crossing to the next.
    """
    oval, half = end_of_oval(oval, end, len(torus.ovals))
    if not torus.moves(torus.ovals[oval]):
        raise NotRepresentable(f"section: the point in oval {written(oval)} of this motion rests, and passes no end")
    tau, theta, rotation = turned(count, oval, half, (torus.tau_frequencies, torus.phases), torus.in_floats)
    times = np.array([torus.slowness * t for t in tau], dtype=float)
    if torus.clock:
        times += torus.clock.at(*(np.array([t * nu % 1 for t in tau], dtype=float) for nu in torus.tau_frequencies))
    return times, theta, rotation


def body_section(flow: Any, count: int, axis: str) -> BodySection:
    """The next ``count`` states with γ̃_i = 0 (:func:`tilde`), i the axis of the "largest" or the "least" moment.

    NotRepresentable if the motion is not on a torus of dimension two.
    """
    oval = AXES.index(one_of(axis, "axis", AXES, 'choose "largest" or "least" (moment)'))
    portrait, K = flow.portrait, flow.system.field
    if not 0 < float(portrait.level.momentum) < math.inf:
        raise NotRepresentable(f"section: |M| = {written(portrait.level.momentum)} is beyond the range of floats")
    motion, (sums, _) = (
        (portrait.wide_tau_frequencies, portrait.wide_angles("section")),
        sums_over_ovals(portrait.level),
    )
    tau, theta, rotation = turned(count, oval, 0.0, motion, sums)
    axes = portrait.level.axes[::-1] if oval else portrait.level.axes
    run = _refined(flow, rounded(K, tau), axes[0])
    return BodySection(run, theta[:, 0], float(rotation[0]), axes)


def tilde(flow: Any, run: Any) -> tuple[np.ndarray, np.ndarray]:
    """γ + kM and M − dkH1γ along a run, shapes (N, 3): the γ̃ and M̃ of Chaplygin's transformation up to factors."""
    change = flow.setup.tilt
    if change is None:
        return run.gamma, run.M
    k, shift = (flow.system.field.coerce(x) for x in (change.k, change.shift))
    return run.gamma + k * run.M, run.M - shift * run.gamma


def _refined(flow: Any, tau: np.ndarray, axis: int) -> Any:
    """The Trajectory at the crossings near τ, by Newton steps on the flow, each of which doubles the digits."""
    K = flow.system.field
    for _ in range(1 if K is RR else math.ceil(math.log2(K.dps / ROUGH_DIGITS)) + 1):
        run = flow.at_tau(tau)
        gamma, _ = tilde(flow, run)
        rate = np.cross(gamma, run.omega)[:, axis]
        slow = np.sum(np.array(flow.system.body.contact) * run.gamma**2, axis=1) ** (K.one / 2)
        tau = tau - gamma[:, axis] / (rate * slow)
    return flow.at_tau(tau)


def sums_over_ovals(level: Level) -> tuple[OvalAngles, np.ndarray]:
    """The angles φ of both points at their phases in floats, and the frequencies in turns per unit of τ. The angles are
    0 at the outer ends: x moves from an outer end e to an inner end e' as e + (e' − e)sin²½φ.
    """
    a, b, c, e = map(float, level.ends)
    rows = [_modes(level, *oval) for oval in ((a, b, c, e), (e, c, a, b))]
    # the combinations of ∫dx/y, which is τ, and ∫x dx/y, which is constant, that grow by 2π with one of the angles
    parts = np.linalg.inv([row[0] / 2 for row in rows])
    return OvalAngles([row[1:] @ parts / np.arange(1, len(row))[:, None] for row in rows]), parts[0] / (2 * np.pi)


def _modes(level: Level, outer: float, inner: float, *others: float) -> np.ndarray:
    """The Fourier modes in φ of dx/y and x dx/y, divided by ½dφ, on the oval from ``outer`` to ``inner``: (n, 2)."""
    count = FIRST_NODES
    while True:
        x = outer + (inner - outer) * np.sin(np.pi * np.arange(count) / count) ** 2
        rest = np.abs((1 - float(level.d) * x) * (x - others[0]) * (x - others[1]))
        values = 1 / (float(level.momentum) * np.sqrt(rest))
        modes: np.ndarray = np.fft.rfft(np.stack([values, x * values], axis=1), axis=0).real / count
        if np.abs(modes[-count // 8 :, 1]).max() < 1e-15 * abs(modes[0, 1]) or count >= MOST_NODES:
            return modes
        count *= 2
