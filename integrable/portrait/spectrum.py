"""The spectral lines of a motion: its quantities as sums of e^(2πift), f = ½Σm_k f_k with the frequencies f_k of its
torus.

Amplitudes are discrete Fourier coefficients on a grid of phases that are linear in t. They are right to rounding,
without a long run, however close two lines are (Laskar 1993 estimates them from a long run).

The phases of a body's torus are linear in τ. Those linear in t are φ = θ + ν·S/⟨1/g⟩, S the bounded part of t(τ), and
Newton steps along the flow find θ at φ.
"""

from __future__ import annotations

from math import prod
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from integrable.phase.attitude import angular_velocities
from integrable.torus.series import TorusSeries, needed_size, spectrum
from jacobian import RR
from jacobian.errors import NotRepresentable, PrecisionLoss
from jacobian.immutable import Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from integrable.torus.access import TorusFlow

# samples of the first grid in each direction, on tori of at most two dimensions and on others
FIRST_SIZE, FIRST_OF_MANY, MOST_SAMPLES, CHUNK = 32, 16, 1 << 18, 1 << 12
# lines below this fraction of the strongest line of their quantity are rounding
NOISE = 3e-14
PASSES, SOLVED = 60, 1e-13


class Sampled(Protocol):
    """Quantities on a torus whose phases are linear in t."""

    dimension: int
    """The number of directions in which the size of the grid is chosen; further directions have a given size."""

    def samples(self, sizes: tuple[int, ...]) -> dict[str, np.ndarray]:
        """The values of each quantity on a grid of ``sizes`` phases, shape (*grid, components)."""

    def lines(self, counted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The modes (L, n) and frequencies (L,) of counts (L, n) of turns along the directions of the grid."""


class Spectrum(Record):
    """The lines of a motion, the strongest first. Get one from ``flow.spectrum()``.

    ``modes`` (L, n) are m_k, ``frequencies`` (L,) ½Σm_k f_k ≥ 0 in turns per unit time, f of ``flow.portrait``. Every
    other attribute is a quantity named in ``quantities``: ``gamma``, ``M`` and ``omega`` of a body, ``q`` and ``p`` of
    other systems. It has complex amplitudes a, (L, components): the quantity at time t is the real part of
    Σ a·e^(2πift). The line 0 is the mean.
    """

    gamma: Any
    M: Any
    omega: Any
    q: Any
    p: Any

    def __init__(self, modes: Any, frequencies: Any, quantities: dict[str, Any]) -> None:
        self.modes, self.frequencies = modes, frequencies
        self.quantities = tuple(quantities)
        for name, amplitudes in quantities.items():
            setattr(self, name, amplitudes)

    def figure(self) -> Figure:
        """A picture: sizes of the lines of each quantity over their frequencies."""
        from integrable.portrait.pictures import spectrum_figure

        return spectrum_figure(self)

    def __len__(self) -> int:
        return len(self.frequencies)

    def _repr_html_(self) -> str:
        from integrable.portrait.pictures import LETTERS
        from jacobian.notebook import table

        sizes = (np.linalg.norm(getattr(self, name), axis=1).tolist() for name in self.quantities)
        rows = list(zip(map(tuple, self.modes.tolist()), self.frequencies.tolist(), *sizes, strict=True))
        names = [f"|{LETTERS.get(name, name)}|" for name in self.quantities]
        return table(repr(self), ["mode", "frequency", *names], rows)

    def __repr__(self) -> str:
        return f"<Spectrum of {len(self)} lines>"


def lines_of(source: Sampled) -> Spectrum:
    """The spectrum of quantities on a torus; PrecisionLoss where the grid would be too fine."""
    size = (FIRST_SIZE if source.dimension <= 2 else FIRST_OF_MANY,) * source.dimension
    while prod(size) <= MOST_SAMPLES:
        grids = {name: _transformed(x) for name, x in source.samples(size).items()}
        sizes = [np.abs(grid).max(axis=-1) for grid in grids.values()]
        wanted = [[_wanted(x / x.max(), k) for k in range(source.dimension)] for x in sizes if x.any()]
        larger = tuple(max(column) for column in zip(*wanted, strict=True))
        if larger == size:
            return _spectrum(source, grids)
        size = larger
    raise PrecisionLoss(f"spectrum: a grid of {' × '.join(map(str, size))} is needed on the torus of this motion")


def _transformed(samples: np.ndarray) -> np.ndarray:
    """The Fourier coefficients of samples, transformed in all directions but the last."""
    grid: np.ndarray = np.fft.fftn(samples, axes=range(samples.ndim - 1), norm="forward")
    return grid


def _wanted(sizes: np.ndarray, k: int) -> int:
    """The number of samples that resolve direction k."""
    return needed_size(sizes.max(axis=tuple(j for j in range(sizes.ndim) if j != k)), NOISE)


def _spectrum(source: Sampled, grids: dict[str, np.ndarray]) -> Spectrum:
    parts = list(grids.values())
    size = parts[0].shape[:-1]
    strength = np.max([np.abs(x).max(axis=-1) / (np.abs(x).max() or 1.0) for x in parts], axis=0)
    places = np.argwhere(strength > NOISE)
    modes, frequencies = source.lines(np.where(2 * places > size, places - size, places))
    # keep the line with f ≥ 0 of each conjugate pair, doubled
    kept = (frequencies > 0) | (modes == 0).all(axis=1)
    order = np.flatnonzero(kept)[np.argsort(-strength[tuple(places[kept].T)], kind="stable")]
    twice = np.where(frequencies[order] > 0, 2, 1)[:, None]
    chosen = tuple(places[order].T)
    return Spectrum(modes[order], frequencies[order], {name: twice * x[chosen] for name, x in grids.items()})


class BodyStates:
    """γ, M and ω on the torus of a :class:`~integrable.motion.flow.Flow` over RR.

    NotRepresentable over another field and where the motion is on no torus of dimension two.
    """

    dimension = 2

    def __init__(self, flow: Any) -> None:
        if flow.system.field != RR:
            raise NotRepresentable(
                f"spectrum: lines are computed in floats, this flow is over {flow.system.field.name}"
            )
        self._portrait, self._body = flow.portrait, flow.system.body
        self._portrait.moving("spectrum")
        if flow._torus is None:
            raise NotRepresentable(
                "spectrum: floats have too few digits for the torus of this motion, next to a separatrix"
            )
        self._torus: TorusFlow = flow._torus
        self._periods = [2 if (row < 0).any() else 1 for row in self._torus.turns]

    def samples(self, sizes: tuple[int, ...]) -> dict[str, np.ndarray]:
        """γ, M and ω at phases linear in t."""
        counts = [np.arange(n) / n for n in sizes]
        phases = np.stack(np.meshgrid(*counts, indexing="ij"), axis=-1).reshape(-1, 2)
        if self._torus.clock:
            phases = self._in_tau(phases, sizes)
        rows = self._torus.at_phases(phases * self._periods)
        omega, _ = angular_velocities(self._body, rows[:, :3], rows[:, 3:])
        parts = {"gamma": rows[:, :3], "M": rows[:, 3:], "omega": omega}
        return {name: part.reshape(*sizes, 3) for name, part in parts.items()}

    def lines(self, counted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The modes and frequencies, converted from the torus's basis to the two ovals, possibly with opposite
        direction.
        """
        basis = np.array(self._torus.lattice.chart.basis)
        own = [sum(x * int(b) for x, b in zip(self._torus.frequencies, column, strict=True)) for column in basis.T]
        f1, f2 = self._portrait.wide_frequencies
        signs = [1 if (x > 0) == (f > 0) else -1 for x, f in zip(own, (f1, f2), strict=True)]
        modes = np.rint(2 * (counted / self._periods) @ np.linalg.inv(basis).T * signs).astype(int)
        return modes, np.array([float((int(m) * f1 + int(n) * f2) / 2) for m, n in modes])

    def _in_tau(self, phases: np.ndarray, size: tuple[int, ...]) -> np.ndarray:
        """The phases linear in τ for given phases linear in t, both in periods of the torus."""
        torus, periods = self._torus, self._periods
        rows = torus.at_phases(phases * periods)
        slowness = np.sqrt(np.sum(np.array(self._body.contact) * rows[:, :3] ** 2, axis=1))
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
