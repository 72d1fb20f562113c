"""The spectral lines of a motion: its quantities as sums of e^(2πift), f = ½Σm_k f_k with the frequencies f_k of its
torus.

Amplitudes are discrete Fourier coefficients on a grid of phases that are linear in t. They are accurate
to rounding without a long run, however close two lines are (Laskar 1993 estimates them from a long run).

The phases θ of a body's torus are linear in τ. With the frequencies ν in τ and the bounded part S of
t(τ), the phases φ = θ + ν·S/⟨1/g⟩ are linear in t. Newton steps along the flow find the θ that belongs to a φ.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from integrable.phase.attitude import angular_velocities
from integrable.portrait.pictures import LETTERS, spectrum_figure
from integrable.torus.integrals import TorusIntegral
from integrable.torus.series import needed_size
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import NotRepresentable, PrecisionLoss
from jacobian.immutable import Record
from jacobian.notebook import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from integrable.portrait.separated import SeparatedTorus
    from integrable.torus.access import TorusFlow

# samples of the first grid in each direction: FIRST_SIZE on tori of at most two dimensions, FIRST_OF_MANY on others
FIRST_SIZE, FIRST_OF_MANY, MOST_SAMPLES, CHUNK = 32, 16, 1 << 18, 1 << 12
# lines below this fraction of the strongest line of their quantity are rounding errors
NOISE = 3e-14
PASSES, SOLVED = 60, 1e-13
# number of samples of a turn about an axis: a state has only the harmonics 0 and ±1 of this turn
ROUND = 4


class Sampled(NamedTuple):
    """Quantities on a torus whose phases are linear in t.

    ``read`` gives the values of each quantity, (N, components), at phases (N, n) in turns from the start. The values
    return after ``doubled`` turns of each phase. The frequency of the k-th phase is the product of ``turns[k]``, a row
    of integers, and ``frequencies``. The last directions of a grid have the sizes ``given``; the first directions get
    sizes that resolve the quantities.
    """

    read: Callable[[np.ndarray], dict[str, np.ndarray]]
    doubled: tuple[int, ...]
    turns: np.ndarray
    frequencies: Sequence[Real]
    given: tuple[int, ...] = ()

    def samples(self, sizes: tuple[int, ...]) -> dict[str, np.ndarray]:
        """The values of each quantity on a grid of phases, shape (*grid, components)."""
        shape = (*sizes, *self.given)
        counts = [n * np.arange(size) / size for n, size in zip(self.doubled, shape, strict=True)]
        phases = np.stack(np.meshgrid(*counts, indexing="ij"), axis=-1).reshape(-1, len(shape))
        return {name: values.reshape(*shape, -1) for name, values in self.read(phases).items()}

    def lines(self, counted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The modes and the frequencies (L,) of L waves; ``counted`` (L, n) are their numbers of periods along each
        direction of the grid.
        """
        modes = np.rint(2 * (counted / self.doubled) @ self.turns).astype(int)
        rows = [zip(row, self.frequencies, strict=True) for row in modes.tolist()]
        return modes, np.array([float(sum(m * f for m, f in row) / 2) for row in rows])


class Spectrum(Record):
    """The lines of a motion, the strongest first. Get one from ``flow.spectrum()``.

    ``modes`` (L, n) are the integers m_k, ``frequencies`` (L,) the ½Σm_k f_k ≥ 0 in turns per unit time, with f_k from
    ``flow.portrait``. Every other attribute is a quantity named in ``quantities``: ``gamma``, ``M`` and ``omega`` of a
    body, ``q`` and ``p`` of other systems. It has complex amplitudes a, (L, components): the quantity at time t is the
    real part of Σ a·e^(2πift). The line of frequency 0 is the mean.
    """

    gamma: np.ndarray
    M: np.ndarray
    omega: np.ndarray
    q: np.ndarray
    p: np.ndarray

    def __init__(self, modes: np.ndarray, frequencies: np.ndarray, quantities: dict[str, np.ndarray]) -> None:
        self.modes, self.frequencies = modes, frequencies
        self.quantities = tuple(quantities)
        for name, amplitudes in quantities.items():
            setattr(self, name, amplitudes)

    def figure(self) -> Figure:
        """A picture: the sizes of the lines of each quantity against their frequencies."""
        return spectrum_figure(self)

    def __len__(self) -> int:
        return len(self.frequencies)

    def _repr_html_(self) -> str:
        sizes = (np.linalg.norm(getattr(self, name), axis=1).tolist() for name in self.quantities)
        rows = list(zip(map(tuple, self.modes.tolist()), self.frequencies.tolist(), *sizes, strict=True))
        names = [f"|{LETTERS.get(name, name)}|" for name in self.quantities]
        return table(repr(self), ["mode", "frequency", *names], rows)

    def __repr__(self) -> str:
        return f"<Spectrum of {len(self)} lines>"


def lines_of(source: Sampled) -> Spectrum:
    """The spectrum of quantities on a torus; PrecisionLoss where the grid would be too fine."""
    dimension = len(source.doubled) - len(source.given)
    size = (FIRST_SIZE if dimension <= 2 else FIRST_OF_MANY,) * dimension
    while prod(size) <= MOST_SAMPLES:
        grids = {
            name: np.fft.fftn(x, axes=range(x.ndim - 1), norm="forward") for name, x in source.samples(size).items()
        }
        sizes = [np.abs(grid).max(axis=-1) for grid in grids.values()]
        wanted = [[_wanted(x / x.max(), k) for k in range(dimension)] for x in sizes if x.any()]
        # if all quantities vanish, any grid resolves them
        larger = tuple(max(column) for column in zip(*wanted, strict=True)) or size
        if larger == size:
            return _spectrum(source, grids)
        size = larger
    raise PrecisionLoss(f"spectrum: a grid of {' × '.join(map(str, size))} is needed on the torus of this motion")


def _wanted(sizes: np.ndarray, k: int) -> int:
    """The number of samples that resolve direction k, from the ``sizes`` of the modes."""
    return needed_size(sizes.max(axis=tuple(j for j in range(sizes.ndim) if j != k)), NOISE)


def _spectrum(source: Sampled, grids: dict[str, np.ndarray]) -> Spectrum:
    parts = list(grids.values())
    size = parts[0].shape[:-1]
    strength = np.max([np.abs(x).max(axis=-1) / (np.abs(x).max() or 1.0) for x in parts], axis=0)
    places = np.argwhere(strength > NOISE)
    modes, frequencies = source.lines(np.where(2 * places > size, places - size, places))
    # the line with f > 0 of each conjugate pair is kept, and doubled; the mean is kept as it is
    kept = (frequencies > 0) | (modes == 0).all(axis=1)
    order = np.flatnonzero(kept)[np.argsort(-strength[tuple(places[kept].T)], kind="stable")]
    twice = np.where(frequencies[order] > 0, 2, 1)[:, None]
    chosen = tuple(places[order].T)
    return Spectrum(modes[order], frequencies[order], {name: twice * x[chosen] for name, x in grids.items()})


def body_states(flow: Any) -> Sampled:
    """γ, M and ω on the torus of a :class:`~integrable.motion.flow.Flow` over RR.

    NotRepresentable over another field and where the motion is on no torus of dimension two.
    """
    if flow.system.field is not RR:
        raise NotRepresentable(f"spectrum: lines are computed in floats, this flow is over {flow.system.field.name}")
    portrait, body = flow.portrait, flow.system.body
    portrait.moving("spectrum")
    torus: TorusFlow | None = flow._torus
    if torus is None:
        raise NotRepresentable(
            "spectrum: floats have too few digits for the torus of this motion, next to a separatrix"
        )
    contact, clock, rates = np.array(body.contact), None, np.array(torus.frequencies, dtype=float)
    if torus.clock:
        slow = TorusIntegral(torus, lambda rows: np.sqrt(rows[:, :3] ** 2 @ contact)[:, None], np.zeros(1))
        clock = OwnTime(lambda phases: slow.swings_and_rates(phases)[0], rates, float(torus.mean))

    def read(phases: np.ndarray) -> dict[str, np.ndarray]:
        rows = torus.at_phases(clock.phases(phases) if clock else phases)
        gamma, M = rows[:, :3], rows[:, 3:]
        return {"gamma": gamma, "M": M, "omega": angular_velocities(body, gamma, M)[0]}

    # the torus has its own basis of periods, and may count turns in the direction opposite to that of the portrait
    basis = np.array(torus.basis)
    own = [sum(x * int(b) for x, b in zip(torus.frequencies, column, strict=True)) for column in basis.T]
    signs = [1 if (x > 0) == (f > 0) else -1 for x, f in zip(own, portrait.wide_frequencies, strict=True)]
    doubled = tuple(2 if (row < 0).any() else 1 for row in torus.turns)
    return Sampled(read, doubled, np.linalg.inv(basis).T * signs, portrait.wide_frequencies)


class OwnTime(NamedTuple):
    """The clock of a motion whose phases are linear in τ. ``rates`` are the frequencies in τ.

    ``swings(phases)`` returns t − ``mean``·τ and dt/dτ at phases in turns from the start.
    """

    swings: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    rates: np.ndarray
    mean: float

    def phases(self, phases: np.ndarray) -> np.ndarray:
        """The phases linear in τ, (N, 2) in turns, at phases linear in t."""
        return np.concatenate([self._phases(phases[n : n + CHUNK]) for n in range(0, len(phases), CHUNK)])

    def _phases(self, phases: np.ndarray) -> np.ndarray:
        late = np.zeros(len(phases))
        for _ in range(PASSES):
            swing, rate = self.swings(phases - late[:, None] * self.rates)
            step = (late * self.mean - swing) / rate
            late = late - step
            if np.abs(step).max() * np.abs(self.rates).max() < SOLVED:
                return phases - late[:, None] * self.rates
        raise PrecisionLoss("spectrum: the clock of this motion is too uneven for floats")


def torus_states(
    torus: SeparatedTorus,
    ends: Sequence[Real],
    read: Callable[[np.ndarray, np.ndarray], np.ndarray],
    frequencies: Sequence[Real],
) -> Sampled:
    """q and p at phases that are linear in t.

    ``ends`` are the branch points e whose signed √|U(e)| the state depends on. ``read`` is as in
    :class:`integrable.mumford.phase_torus.PhaseTorus`. ``frequencies`` are the portrait's.
    """
    genus, further = len(torus.ovals), len(frequencies) - len(torus.ovals)
    places = {torus.place_of(e) for e in ends}
    doubled = [2 if {o.place, o.place + 1} & places else 1 for o in torus.ovals]
    # the portrait may count turns in the direction opposite to that of the torus
    senses = [-1.0 if own * f < 0 else 1.0 for own, f in zip(torus.frequencies, frequencies, strict=True)]
    start = np.array(torus.phases, dtype=float)
    _, swings_at_start = torus.at_phases(start[None])
    series, rates = torus.clock, np.array(torus.tau_frequencies, dtype=float)
    clock = series and OwnTime(lambda phases: series.swings_and_rates(*phases.T), rates, float(torus.slowness))

    def values(turns: np.ndarray) -> dict[str, np.ndarray]:
        phases = start + (clock.phases(turns) if clock else turns[:, :genus])
        angles, swings = torus.at_phases(phases)
        turned = 2 * np.pi * turns[:, genus:] + swings - swings_at_start
        rows = [f(x) for x in angles.T / 2 for f in (np.sin, np.cos)]
        rows += [f(x) for x in turned.T for f in (np.cos, np.sin)]
        states = read(np.stack((rows, np.zeros_like(rows)), axis=2), np.zeros(len(turns)))
        return {"q": states[:, 0], "p": states[:, 1]}

    return Sampled(values, (*doubled, *(1,) * further), np.diag(senses), frequencies, (ROUND,) * further)
