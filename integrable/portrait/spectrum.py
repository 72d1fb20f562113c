"""The spectral lines of a motion: γ, M and ω as sums of e^(2πift), f = ½(m₁f₁ + m₂f₂) with the two frequencies of its
torus.

Phases linear in τ are θ, those linear in t are φ = θ + ν·S/⟨1/g⟩, S the bounded part of t(τ). On a grid of φ, Newton
steps along the flow find θ, and the torus gives the states there. Their discrete Fourier transform has the amplitudes
to rounding, without a long run, however close two lines are (Laskar 1993 estimates them from one).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.phase.attitude import angular_velocities
from integrable.torus.series import TorusSeries, needed_sizes, spectrum
from jacobian import RR
from jacobian.errors import NotRepresentable, PrecisionLoss
from jacobian.immutable import Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from integrable.torus.access import TorusFlow

FIRST_SIZE, MOST_SAMPLES, CHUNK = 32, 1 << 18, 1 << 12
# lines below this fraction of the strongest line of their quantity are rounding
NOISE = 3e-14
PASSES, SOLVED = 60, 1e-13


class Spectrum(Record):
    """The lines of a motion, the strongest first. Get one from ``flow.spectrum()``.

    ``modes`` (L, 2) are (m₁, m₂), ``frequencies`` (L,) ½(m₁f₁ + m₂f₂) ≥ 0 in turns per unit time, f of
    :class:`integrable.portrait.portrait.Portrait`; ``gamma``, ``M`` and ``omega`` (L, 3) complex amplitudes a: the
    quantity at time t is the real part of Σ a·e^(2πift). The line 0 is the mean.
    """

    def __init__(
        self, modes: np.ndarray, frequencies: np.ndarray, gamma: np.ndarray, M: np.ndarray, omega: np.ndarray
    ) -> None:
        self.modes, self.frequencies = modes, frequencies
        self.gamma, self.M, self.omega = gamma, M, omega

    def figure(self) -> Figure:
        """A picture: sizes of the lines of γ, M and ω over their frequencies."""
        from integrable.portrait.pictures import spectrum_figure

        return spectrum_figure(self)

    def __len__(self) -> int:
        return len(self.frequencies)

    def _repr_html_(self) -> str:
        from jacobian.notebook import table

        sizes = (np.linalg.norm(x, axis=1).tolist() for x in (self.gamma, self.M, self.omega))
        rows = list(zip(map(tuple, self.modes.tolist()), self.frequencies.tolist(), *sizes, strict=True))
        return table(repr(self), ["mode", "frequency", "|γ|", "|M|", "|ω|"], rows)

    def __repr__(self) -> str:
        return f"<Spectrum of {len(self)} lines>"


def lines_of(flow: Any) -> Spectrum:
    """The spectrum of a :class:`~integrable.motion.flow.Flow` over RR.

    NotRepresentable over another field and where the motion is on no torus of dimension two, PrecisionLoss where the
    grid would be too fine.
    """
    if flow.system.field != RR:
        raise NotRepresentable(f"spectrum: lines are computed in floats, this flow is over {flow.system.field.name}")
    portrait = flow.portrait
    portrait.moving("spectrum")
    torus = flow._torus
    if torus is None:
        raise NotRepresentable(
            "spectrum: floats have too few digits for the torus of this motion, next to a separatrix"
        )
    periods = [2 if (row < 0).any() else 1 for row in torus.turns]
    size = FIRST_SIZE, FIRST_SIZE
    while size[0] * size[1] <= MOST_SAMPLES:
        grids = _transformed(flow, torus, periods, size)
        parts = [grids[..., k : k + 3] for k in (0, 3, 6)]
        sizes = [np.abs(part).max(axis=-1) for part in parts]
        wanted = [needed_sizes(x, (NOISE, NOISE)) for x in sizes if x.any()]
        larger = max(n for n, _ in wanted), max(n for _, n in wanted)
        if larger == size:
            return _spectrum(torus, portrait, periods, parts)
        size = larger
    raise PrecisionLoss(f"spectrum: a grid of {size[0]} × {size[1]} is needed on the torus of this motion")


def _transformed(flow: Any, torus: TorusFlow, periods: list[int], size: tuple[int, int]) -> np.ndarray:
    """The Fourier coefficients of γ, M and ω in phases that are linear in t, of shape (*size, 9)."""
    counts = [np.arange(n) / n for n in size]
    phases = np.stack(np.meshgrid(*counts, indexing="ij"), axis=-1).reshape(-1, 2)
    if torus.clock:
        phases = _in_tau(flow, torus, periods, phases, size)
    rows = torus.at_phases(phases * periods)
    omega, _ = angular_velocities(flow.system.body, rows[:, :3], rows[:, 3:])
    samples = np.hstack([rows, omega]).reshape(*size, 9)
    grid: np.ndarray = np.fft.fft2(samples, axes=(0, 1)) / len(rows)
    return grid


def _in_tau(flow: Any, torus: TorusFlow, periods: list[int], phases: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """The phases linear in τ for given phases linear in t, both in ``periods`` of the torus."""
    rows, body = torus.at_phases(phases * periods), flow.system.body
    slowness = np.sqrt(np.sum(np.array(body.contact) * rows[:, :3] ** 2, axis=1))
    nu = tuple(x / n for x, n in zip(torus.frequencies, periods, strict=True))
    series = TorusSeries(spectrum(slowness.reshape(size)), nu, float(torus.mean))
    rates, found = np.array([float(x) for x in nu]), np.empty_like(phases)
    for first in range(0, len(phases), CHUNK):
        part = slice(first, first + CHUNK)
        late = np.zeros(len(phases[part]))
        for _ in range(PASSES):
            there = phases[part] - late[:, None] * rates
            swing, rate = series.swings_and_rates(there[:, 0], there[:, 1])
            step = (late - swing) / rate
            late = late - step
            if np.abs(step).max() * np.abs(rates).max() < SOLVED:
                break
        else:
            raise PrecisionLoss("spectrum: the clock of this motion is too uneven for floats")
        found[part] = phases[part] - late[:, None] * rates
    return found


def _spectrum(torus: TorusFlow, portrait: Any, periods: list[int], parts: list[np.ndarray]) -> Spectrum:
    size = parts[0].shape[:2]
    strength = np.max([np.abs(x).max(axis=-1) / (np.abs(x).max() or 1.0) for x in parts], axis=0)
    places = np.argwhere(strength > NOISE)
    counted = np.where(2 * places > size, places - size, places)
    # modes in the torus's own basis converted to those of the two ovals, possibly with the opposite direction
    basis = np.array(torus.lattice.chart.basis)
    own = [sum(x * int(b) for x, b in zip(torus.frequencies, column, strict=True)) for column in basis.T]
    signs = [1 if (x > 0) == (f > 0) else -1 for x, f in zip(own, portrait.wide_frequencies, strict=True)]
    modes = np.rint(2 * (counted / periods) @ np.linalg.inv(basis).T * signs).astype(int)
    f1, f2 = portrait.wide_frequencies
    frequencies = np.array([float((int(m) * f1 + int(n) * f2) / 2) for m, n in modes])
    # keep the line with f ≥ 0 of each conjugate pair, doubled
    kept = (frequencies > 0) | (modes == 0).all(axis=1)
    order = np.flatnonzero(kept)[np.argsort(-strength[tuple(places[kept].T)], kind="stable")]
    twice = np.where(frequencies[order] > 0, 2, 1)[:, None]
    chosen = tuple(places[order].T)
    return Spectrum(modes[order], frequencies[order], *(twice * part[chosen] for part in parts))
