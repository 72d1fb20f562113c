"""The torus of a motion of the ball or the top: any state, and 1/g on grids, by theta functions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, cached_property
from math import ceil, log2, log10
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from integrable.moving_point.addition import Row
from integrable.torus.lifts import AROUND, CHECKED, TOGETHER, Limits, RateSums, Torus
from integrable.torus.loops import BEYOND, CompiledLoops, Loops, NotClosed
from integrable.torus.states import BodyStates
from integrable.torus.theta_series import ThetaSums, shortest, theta_sums
from integrable.torus.theta_setup import CLASSES, FOUND, FREQUENCIES, IMAGINARY, MEAN, PLACING
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.periods.real_basis import Whole

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# a first grid has at least this many points in each direction
FIRST_SIZE = 16
# the start is met to CLOSED, and the equations of motion are met to RIGHT of the largest velocity
CLOSED, RIGHT = 1e-18, 1e-12
# a first grid of 1/g has POINTS·digits/(the :func:`shortest` nYn) points in each direction; mostly no finer one follows
POINTS = 1.8
# the phases in floats are integrals along a path, by the trapezoidal rule in log(v/(1 − v)) for the fraction v of the
# path: BEFORE and AFTER nodes before and after its middle, SPACING apart. The error is 1e-11, even if the next branch
# point is only e^−80 of the path beyond an end
BEFORE, AFTER, SPACING = 160, 110, 0.75


Samples = Callable[[tuple[int, int], "np.ndarray | None"], np.ndarray]
"""A function that gives values on a grid of given sizes; values on a coarser grid may be known."""
PeriodBasis = tuple[tuple[int, int], tuple[int, int]]
"""Two periods as integer rows, in the periods around the two ovals."""
Found = TypeVar("Found")
Transform = Callable[[np.ndarray], tuple[Found, tuple[int, int]]]
"""A function of samples that returns a result of them and the shape of a grid that is fine enough."""


class BodyTorus:
    """The states of a motion on its torus, by loops of :mod:`integrable.torus.loops`.

    ``turns`` are the signs that γ1, γ2, γ3 get over either period. ``basis`` has the periods as integer rows, in the
    periods around the two ovals; ``doubled`` are the periods of 1/g in the periods of the divisor. ``closure`` is the
    difference between the start and the state at the phases of the start. ``exact`` are loops with more digits for the
    set-up. PrecisionLoss where the torus is not compact. NotClosed where the states are not those of the motion.
    """

    def __init__(self, setup: Setup, loops: Loops, most: int, exact: Loops | None = None) -> None:
        self.setup, self.loops, self._most = setup, loops, most
        made = exact or loops
        # numbers of the motion, in units of length and time of its own
        self.units, self._motion, self.tilt, start, self._problem = made.begun(setup)
        found = made.room(FOUND)
        m1, n1, m2, n2 = made.periods(self._motion, made.short, made.room(4), found)
        self.basis = (m1, n1), (m2, n2)
        chars = characteristics(made.floats(self._motion[4:8]).tolist(), self.basis)
        # θ changes its sign over period k where ε_k is 1
        self.turns = np.array([[1.0 - 2.0 * char[k] for char in chars] for k in (0, 1)])
        odd = [sum(char[k] for char in chars) % 2 == 1 for k in (0, 1)]
        self.odd = odd[0], odd[1]
        # for a tilted body, a sign change of an odd number of γ_i changes 1/g, whose period is then twice the divisor's
        self.doubled = (1 + odd[0], 1 + odd[1]) if made.floats(self.tilt)[1] != 0 else (1, 1)
        self.rates, matrix, rate, units = made.room(4), made.room(4), made.room(10), self.units
        made.rates(self._problem, found, self._motion, self.tilt, (units.length, units.lift), matrix, self.rates, rate)
        torus = self._placed(made, start, found, chars)
        if exact:
            torus = in_numbers(loops, torus)
            found, matrix, rate, self._motion, self._problem, self.rates = (
                loops.row(row) for row in (found, matrix, rate, self._motion, self._problem, self.rates)
            )
        self.torus = loops.packed(BodyStates(torus, matrix))
        self._rate = RateSums(0, 3, True, self.doubled != (1, 1), rate)
        self._check(found)

    def _placed(self, loops: Loops, start: Row, found: Row, chars: Sequence[Whole]) -> Torus:
        """The torus, with the phases and the signs of the start."""
        shape = found[IMAGINARY:MEAN]
        if not np.isfinite(loops.floats(shape)).all():
            raise NotClosed(BEYOND)
        self._decay = shortest(loops.floats(shape[:3]).tolist())
        sums, scales = theta_sums(loops, shape, (0, 0, 0), chars)
        torus, limits = Torus(sums, loops.room(2), loops.room(3)), Limits(loops.noise * 1e-10, loops.nudge)
        self.closure = loops.placed(
            torus, self._motion, start, found, scales, rule_of_phases(), limits, loops.room(PLACING)
        )
        return torus

    def _check(self, found: Row) -> None:
        """Raises NotClosed if the states are not those of the motion."""
        if not self.closure <= CLOSED:
            raise NotClosed(f"the torus of this motion leads back to {self.closure:.1e} only; use more digits")
        frequencies = found[FREQUENCIES : FREQUENCIES + 2]
        room = self.loops.room(6 * (AROUND + 1) * CHECKED)
        if not self.loops.strayed(self.torus, self._motion, frequencies, room, np.empty(CHECKED)) <= RIGHT:
            raise NotClosed("the states on the torus of this motion do not obey its equations; use more digits")

    @property
    def compiled(self) -> bool:
        """Whether the loops are compiled. A state then takes microseconds, a thousandth of the interpreted time."""
        return isinstance(self.loops, CompiledLoops)

    @cached_property
    def frequencies(self) -> tuple[Real, Real]:
        """Turns of each phase per unit of τ, wide."""
        nu1, nu2 = self.loops.wide(self.rates[:2], self.setup.wide)
        return nu1, nu2

    @cached_property
    def mean(self) -> Real:
        """The mean of 1/g over the torus, wide: a determinant of elliptic integrals, independent of samples.

        A tilt does not change it: the tilt term changes its sign around an oval that contains one α_i.
        """
        return self.loops.wide(self.rates[2:3], self.setup.wide)[0]

    def at_phases(self, phases: np.ndarray) -> np.ndarray:
        """γ and M at points of the torus, shape (N, 6): ``phases`` in turns from the start, shape (N, 2)."""
        out = np.empty(6 * len(phases))
        self.loops.states_at_phases(self.torus, np.ascontiguousarray(phases, dtype=np.float64).ravel(), out)
        return out.reshape(-1, 6)

    def resolved(self, transformed: Transform[Found]) -> Found:
        """The spectrum of 1/g on a grid of its periods that resolves it: ``transformed(samples)`` are the spectrum and
        the shape of a grid that is fine enough.
        """
        return resolved(self.samples, transformed, self.first_grid(), self._most)

    def first_grid(self) -> tuple[int, int]:
        """The numbers of points of the first grid of 1/g."""
        return first_grid(self.loops.noise, self._decay)

    def samples(self, sizes: tuple[int, int], known: np.ndarray | None = None) -> np.ndarray:
        """:func:`samples_of` 1/g on a grid of its periods, with ``sizes`` points per period of the divisor."""
        return samples_of(self.loops, self.torus[0], self._rate, self.odd, sizes, known)


def samples_of(
    loops: Loops,
    torus: Torus,
    rate: RateSums,
    odd: tuple[bool, bool],
    sizes: tuple[int, int],
    known: np.ndarray | None = None,
) -> np.ndarray:
    """A rate on a grid with ``sizes`` points per period. If it is tilted, its periods are doubled where they are
    ``odd``, after which the tilt has the opposite sign. Compiled loops give double-doubles with a last axis;
    interpreted ones give long doubles, or their own numbers where these have more digits. ``known`` are the samples of
    a coarser grid.
    """
    (rows, columns), (down, across) = sizes, (1 + (rate.tilted and odd[0]), 1 + (rate.tilted and odd[1]))
    coarser = (0, 0) if known is None else (rows * down // known.shape[0], columns * across // known.shape[1])
    if coarser[1] > TOGETHER:
        coarser = 0, 0
    first, other = loops.room(rows * columns), loops.room(rows * columns)
    room = loops.room(rate.classes * torus.sums.sizes[1] * (4 * TOGETHER + 2 * rows))
    loops.gridded(torus, loops.packed(rate), sizes, coarser, room, first, other)
    table = loops.samples(first, sizes)
    if (down, across) != (1, 1):
        beside = loops.samples(other, sizes)
        whole = np.empty((down, rows, across, columns, *table.shape[2:]), dtype=table.dtype)
        for i, j in np.ndindex(down, across):
            whole[i, :, j] = beside if (i * odd[0] + j * odd[1]) % 2 else table
        table = whole.reshape(down * rows, across * columns, *table.shape[2:])
    if known is not None:
        table[:: table.shape[0] // known.shape[0], :: table.shape[1] // known.shape[1]] = known
    return table


def first_grid(noise: float, decay: tuple[float, float]) -> tuple[int, int]:
    """The numbers of points of the first grid, powers of 2; ``decay`` is the result of :func:`shortest`."""
    points = -POINTS * log10(noise)
    first, second = (max(FIRST_SIZE, 2 ** ceil(log2(max(1, points / y)))) for y in decay)
    return first, second


def resolved(samples: Samples, transformed: Transform[Found], sizes: tuple[int, int], most: int) -> Found:
    """The result of a grid that is fine enough, from a first grid of ``sizes``.

    PrecisionLoss beyond ``most`` samples.
    """
    known: np.ndarray | None = None
    while sizes[0] * sizes[1] <= most:
        known = samples(sizes, known)
        found, wanted = transformed(known)
        shape = known.shape[:2]
        if wanted == shape:
            return found
        sizes = (sizes[0] * wanted[0] // shape[0], sizes[1] * wanted[1] // shape[1])
    raise PrecisionLoss(f"a rate needs a grid of {sizes[0]} × {sizes[1]} on the torus of this motion")


def in_numbers(loops: Loops, torus: Torus) -> Torus:
    """The torus in the numbers of ``loops``."""
    table, sizes, lengths, chars, _ = torus.sums
    sums = ThetaSums(loops.row(table), sizes, loops.integers(lengths), loops.integers(chars), loops.circle)
    return Torus(sums, loops.row(torus.places), loops.row(torus.factors))


def characteristics(points: list[float], basis: PeriodBasis) -> list[Whole]:
    """(ε₁, ε₂, δ₁, δ₂) of the theta functions of α1, α2, α3; ``points`` are α1, α2, α3 and ζ."""
    # α_i that are equal in floats are distinguished by their index
    *axes, zeta = points
    low, middle, high = sorted(range(3), key=lambda i: axes[i])
    # e₂, the end of the first oval, is the lesser of the middle α_i and ζ
    classes = {low: CLASSES[0], middle: CLASSES[2 if zeta < axes[middle] else 1], high: CLASSES[3]}
    return in_basis([classes[i] for i in range(3)], basis)


def in_basis(classes: Sequence[Whole], basis: PeriodBasis) -> list[Whole]:
    """The characteristics in a ``basis`` of periods; ``classes`` are those of :data:`CLASSES`."""
    # the basis is p·a₁ + q·(a₂ − a₁), r·a₁ + s·(a₂ − a₁) with the periods a₁ and a₂ of the ovals
    p, q, r, s = basis[0][0] + basis[0][1], basis[0][1], basis[1][0] + basis[1][1], basis[1][1]
    found = []
    for e1, e2, d1, d2 in classes:
        # the signs of δ do not matter modulo 2
        found.append(((p * e1 + q * e2) % 2, (r * e1 + s * e2) % 2, (s * d1 + r * d2) % 2, (q * d1 + p * d2) % 2))
    return found


@cache
def rule_of_phases() -> np.ndarray:
    """v, 1 − v and the weight of each node of a rule for dv/√v on [0, 1]."""
    t = SPACING * np.arange(-BEFORE, AFTER + 1)
    v, rest = 1 / (1 + np.exp(-t)), 1 / (1 + np.exp(t))
    return np.ascontiguousarray(np.stack([v, rest, SPACING * np.sqrt(v) * rest], axis=1).ravel())
