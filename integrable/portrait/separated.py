"""Motions of any genus in separated coordinates: each point of Mumford's pair turns in an oval of its own.

On y² = f(x) the k-th point moves between real branch points a and b. With x = ½(a + b) − ½(b − a)cos φ_k and f = (x −
a)(b − x)h, dx/y is dφ_k/√h, also at the ends. So an integral along the motion is a sum of functions of one angle each,
a mean rate times φ_k plus a sine series. g such sums are known linear functions of time. They determine the phases
θ_k, which are linear in time, and the frequencies; the mean of p dq over an oval is an action.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from itertools import accumulate, repeat
from operator import mul

import gmpy2
import numpy as np

from integrable.portrait.oval_angles import OvalAngles
from integrable.portrait.oval_pairs import OvalPairs
from integrable.portrait.point_ovals import (
    DIGITS_A_BIT,
    Form,
    PointOval,
    Pole,
    Separation,
    angle_in,
    least_part,
    oval_around,
    real_and_complex,
)
from integrable.torus.clock import resolved
from integrable.torus.series import TorusSeries, circle_of, fourier, needed_sizes, spectrum
from jacobian import MP, poly
from jacobian.element import Real
from jacobian.errors import NotRepresentable, PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.linear import pivoted

# largest number of nodes of an oval, a power of 2; where more are needed, branch points nearly meet
MOST_NODES = 1 << 13
# dt/dτ is sampled on FIRST_GRID, then on finer grids of up to MOST_SAMPLES points, until modes that are not sampled are
# below NOISE times the mean, the size of rounding errors
FIRST_GRID, MOST_SAMPLES, NOISE = (32, 32), 1 << 18, 1e-15
# number of correct bits after Newton's method in floats
FLOAT_BITS = 40
# an oval has SPARE_NODES extra nodes, and π has DIGITS_BEYOND extra digits; a point rests in an oval whose radius is at
# most 2^SPARE_BITS·eps, relative to the largest branch point
SPARE_NODES, DIGITS_BEYOND, SPARE_BITS = 8, 5, 20


class SeparatedTorus:
    """The ovals of a motion and integrals over them, in the numbers of a LongField, inside its ``with`` block.

    ``spectral`` is the curve f and the pair u, v of the start. NotRepresentable unless the pair has one point in each
    of g bounded real ovals, PrecisionLoss if branch points nearly meet.
    """

    def __init__(self, N: LongField, spectral: Sequence[poly.Poly], separation: Separation) -> None:
        f, u, v = spectral
        self._field, self.separation = N, separation
        curve, points = real_and_complex(N, f, separation.known), real_and_complex(N, u)[0]
        if len(points) < len(u) - 1:
            raise NotRepresentable("the points of this motion are complex: they turn in no ovals")
        self.ovals = [oval_around(f[-1], curve, x) for x in points]
        if len({oval.middle for oval in self.ovals}) < len(points):
            raise NotRepresentable("two points of this motion share an oval: it has no separate turns")
        self.start = [angle_in(N, oval, x, poly.evaluate(N, v, x)) for oval, x in zip(self.ovals, points, strict=True)]
        self._known: list[Real] = curve[0]
        self.size: Real = max(map(abs, curve[0]))
        self._close = least_part(N, curve[0])
        self._pi = N.coerce(MP(DIGITS_BEYOND + math.ceil(N.bits * DIGITS_A_BIT)).context.pi)

    @cached_property
    def forms(self) -> list[Form]:
        return [*self.separation.forms, *(form for form, _ in self.separation.turns)]

    @cached_property
    def samples(self) -> list[list[list[Real]]]:
        """For each oval and form the coefficients of dφ at φ = π(k + ½)/n, minus the parts in :attr:`poles`. From them
        means have all digits, and Fourier modes half of the digits.
        """
        return [self._sampled(oval, self.forms) for oval in self.ovals]

    @cached_property
    def poles(self) -> list[list[list[Pole]]]:
        return [[self._poles_of(oval, form) for form in self.forms] for oval in self.ovals]

    def _poles_of(self, oval: PointOval, form: Form) -> list[Pole]:
        """The parts of a form whose modes decrease slowly if a pole is near the oval."""
        N, found = self._field, []
        for k, p in enumerate(form.poles):
            if min(abs(p - e) for e in self._known) <= N.root_of_eps * max(map(abs, self._known)):
                continue
            rest = Form(form.numerator, (*form.poles[:k], *form.poles[k + 1 :]))
            weight = oval.weight(N, p)
            if weight > 0:
                gaps = oval.middle - p + oval.radius, oval.middle - p - oval.radius
                size = N.sqrt(gaps[0] * gaps[1])
                residue = rest.coefficient(p) * weight
                found.append(Pole(p, residue, residue / (size if gaps[0] > 0 else -size), N.sqrt(gaps[0] / gaps[1])))
        return found

    def _sampled(
        self, oval: PointOval, forms: Sequence[Form], factor: Callable[[Real], Real] | None = None, modes: bool = False
    ) -> list[list[Real]]:
        """Samples as in :attr:`samples`, times ``factor``. If ``modes``, n is a power of 2 such that Fourier modes have
        all digits.
        """
        N = self._field
        poles = [self._poles_of(oval, form) for form in forms]
        wanted = N.bits * math.log(2) / max(oval.decay, 1e-9) + SPARE_NODES
        if wanted > MOST_NODES:
            raise PrecisionLoss("branch points nearly meet: the motion is too near to a separatrix")
        # the sum over n nodes has the error of mode 2n
        count = 1 << math.ceil(math.log2(wanted)) if modes else math.ceil(wanted / 2) + SPARE_NODES
        rows: list[list[Real]] = [[] for _ in forms]
        for k in range(count):
            x = oval.middle - oval.radius * gmpy2.cos(self._pi * (2 * k + 1) / (2 * count))
            weight = oval.weight(N, x) * (factor(x) if factor else N.one)
            for row, form, parts in zip(rows, forms, poles, strict=True):
                value = weight * form.coefficient(x)
                for pole in parts:
                    value -= pole.residue / (x - pole.place)
                row.append(value)
        return rows

    @cached_property
    def means(self) -> list[list[Real]]:
        """The mean of the coefficient of dφ, for each oval and form."""
        return [
            [_mean(row, poles) for row, poles in zip(rows, places, strict=True)]
            for rows, places in zip(self.samples, self.poles, strict=True)
        ]

    def _phase_of(self, sums: Sequence[Real]) -> list[Real]:
        """The phases in turns, one for each oval, from the ``sums`` of the forms over the points."""
        found = pivoted([[2 * self._pi * means[j] for means in self.means] + [x] for j, x in enumerate(sums)])
        if found is None:
            raise PrecisionLoss("the periods of the motion are not independent")
        return found

    @cached_property
    def parts(self) -> np.ndarray:
        """The matrix from the forms (rows) to the sums of :class:`integrable.portrait.oval_loops.PhaseSums` (columns).

        The first sums grow by 2π with the angle of their oval. The others are angles about an axis, without their parts
        that are linear in the phases.
        """
        N, genus, width = self._field, len(self.ovals), len(self.forms)
        found = np.array([[N.one if i == j else N.zero for j in range(width)] for i in range(width)], dtype=object)
        found[:genus, :genus] = [[2 * self._pi * x for x in self._phase_of(row[:genus])] for row in found[:genus]]
        found[:genus, genus:] = -found[:genus, :genus] @ np.array(self.means, dtype=object)[:, genus:]
        return found

    @cached_property
    def waves(self) -> list[np.ndarray]:
        """For each oval the sine series of all sums, with all digits."""
        found = []
        for oval in self.ovals:
            samples = np.array(self._sampled(oval, self.forms, modes=True), dtype=object).T @ self.parts
            count, circle = len(samples), circle_of(4 * len(samples))
            modes = fourier(np.concatenate((samples, samples[::-1])), circle)
            # the nodes are shifted by half a step
            shifted = enumerate((circle[1:count, None] * modes[1:count]).tolist(), 1)
            found.append(np.array([[z.real / (n * count) for z in row] for n, row in shifted], dtype=object))
        return found

    def sums(self, angles: Sequence[Real], series: Sequence[np.ndarray]) -> list[Real]:
        """The sums with these ``series``, as in :attr:`waves`, at angles of the points: 2π times the phases, then the
        angles about an axis less their parts linear in phases.
        """
        genus = len(self.ovals)
        found = np.array([*angles, *[self._field.zero] * (len(self.forms) - genus)], dtype=object)
        for phi, waves, poles in zip(angles, series, self.poles, strict=True):
            powers = accumulate(repeat(gmpy2.mpc(gmpy2.cos(phi), gmpy2.sin(phi)), len(waves)), mul)
            found += np.array([z.imag for z in powers], dtype=object) @ waves
            s, c = gmpy2.sin_cos(phi / 2)
            for j in range(genus, len(found)):
                found[j] += sum(pole.mean * pole.swing(s, c, gmpy2.atan2) for pole in poles[j])
        return [*found]

    @cached_property
    def _sums_at_start(self) -> list[Real]:
        return self.sums(self.start, self.waves)

    @property
    def phases(self) -> list[Real]:
        """The phases of the start, in turns: one for each oval, 0 at its lower end."""
        return [x / (2 * self._pi) for x in self._sums_at_start[: len(self.ovals)]]

    def pairs(self, ends: Sequence[Real]) -> OvalPairs:
        """The function from points in their ovals to pairs with lifts at the branch points ``ends``."""
        return OvalPairs(tuple(self.ovals), tuple((self.place_of(e), e) for e in ends))

    @property
    def halves(self) -> list[tuple[Real, Real]]:
        """(sin ½φ, cos ½φ) of each point at the start."""
        return [gmpy2.sin_cos(phi / 2) for phi in self.start]

    def moves(self, oval: PointOval) -> bool:
        """Whether the point of an oval moves: the radius of the oval is larger than rounding errors."""
        return bool(oval.radius > self._field.doubled(self._field.eps, SPARE_BITS) * self.size)

    def place_of(self, e: Real) -> int:
        """The index of a branch point among the real branch points in ascending order."""
        return min(range(len(self._known)), key=lambda k: abs(self._known[k] - e))

    def angles_at(self, time: Real) -> tuple[list[Real], list[Real]]:
        """(angles φ of all points, growth of each angle about an axis) after a time from the start."""
        N, genus = self._field, len(self.ovals)
        turned, start = [2 * self._pi * nu * time for nu in self.frequencies], self._sums_at_start
        places = [x + y for x, y in zip(start[:genus], turned, strict=False)]
        whole = [2 * self._pi * N.nearest(x / (2 * self._pi)) for x in places]
        rest = [x - y for x, y in zip(places, whole, strict=True)]
        angles = [N.coerce(x) for x in self.in_floats.at(np.array([rest], dtype=float) / (2 * np.pi))[0][0].tolist()]
        # each step of Newton's method doubles the number of correct digits; the start has those of a float
        for _ in range(math.ceil(math.log2(N.bits / FLOAT_BITS)) + 1):
            gaps = [x - y for x, y in zip(self.sums(angles, self.waves), rest, strict=False)]
            slopes = np.array([*map(self._slopes, self.ovals, angles)], dtype=object) @ self.parts[:genus, :genus]
            steps = pivoted([[*row, gap] for row, gap in zip(slopes.T.tolist(), gaps, strict=True)])
            if steps is None:
                raise PrecisionLoss("the phases of the motion are not independent")
            angles = [x - y for x, y in zip(angles, steps, strict=True)]
        grown = [x + y - z for x, y, z in zip(turned, self.sums(angles, self.waves), start, strict=True)]
        return [x + y for x, y in zip(angles, whole, strict=True)], grown[genus:]

    def at_phases(self, phases: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """In floats: the angles φ in the ovals, (N, g), at phases in turns, (N, g), and the angles about an axis, (N,
        m), less their parts linear in phases.
        """
        angles, swings = self.in_floats.at(phases)
        for j, total in enumerate(swings.T, len(self.ovals)):
            for phi, poles in zip(angles.T, self.poles, strict=True):
                for pole in (Pole(*map(float, pole)) for pole in poles[j]):
                    total += pole.mean * pole.swing(np.sin(phi / 2), np.cos(phi / 2), np.arctan2)
        return angles, swings

    @cached_property
    def in_floats(self) -> OvalAngles:
        """The same sums in floats."""
        return OvalAngles([waves.astype(float) for waves in self.waves])

    def _slopes(self, oval: PointOval, phi: Real) -> list[Real]:
        """The coefficients of dφ of the g forms at an angle."""
        x = oval.middle - oval.radius * gmpy2.cos(phi)
        return [form.coefficient(x) * oval.weight(self._field, x) for form in self.separation.forms]

    @cached_property
    def frequencies(self) -> list[Real]:
        """The frequencies in turns per unit of time: first of each point, positive if it moves upwards where y > 0,
        then of the angles about an axis.
        """
        found = [nu / self.slowness for nu in self.tau_frequencies]
        genus = len(found)
        for j, (_, rate) in enumerate(self.separation.turns, genus):
            turned = sum((nu * means[j] for nu, means in zip(found, self.means, strict=False)), self._field.zero)
            found.append(rate / (2 * self._pi) + turned)
        return found

    @cached_property
    def tau_frequencies(self) -> list[Real]:
        """The frequencies of the points in turns per unit of τ."""
        return self._phase_of(self.separation.rates)

    @cached_property
    def slowness(self) -> Real:
        """The mean of dt/dτ: 1, or a quotient of determinants of integrals if time is not a sum over the points."""
        if self.separation.slow is None:
            return self._field.one
        N, (end, factor) = self._field, self.separation.slow
        slowed = [self._sampled(oval, self.separation.forms, lambda x: 1 / N.sqrt(abs(end - x))) for oval in self.ovals]
        areas = []
        for table in [[sum(row) / len(row) for row in rows] for rows in slowed], self.means:
            (a, b), (c, d) = table
            areas.append(a * d - b * c)
        return factor * areas[0] / areas[1]

    @cached_property
    def clock(self) -> TorusSeries | None:
        """t(τ) as a series on the torus, in floats; None if τ is the time."""
        if self.separation.slow is None:
            return None

        def samples(sizes: tuple[int, int], known: np.ndarray | None) -> np.ndarray:
            turns = np.meshgrid(*(np.arange(size) / size for size in sizes), indexing="ij")
            return self._rates_at(np.stack(turns, axis=-1).reshape(-1, 2)).reshape(sizes)

        def transformed(values: np.ndarray) -> tuple[np.ndarray, tuple[int, int]]:
            grid = spectrum(values)
            return grid, needed_sizes(grid, (NOISE, NOISE))

        first, second = self.tau_frequencies
        return TorusSeries(resolved(samples, transformed, FIRST_GRID, MOST_SAMPLES), (first, second), noise=NOISE)

    def _rates_at(self, turns: np.ndarray) -> np.ndarray:
        """dt/dτ in floats at phases (N, 2) in turns from the start."""
        end, factor = self.separation.slow or (self._field.one, self._field.one)
        found = np.full(len(turns), float(factor))
        angles, _ = self.in_floats.at(turns + np.array(self.phases, dtype=float))
        for oval, phi in zip(self.ovals, angles.T, strict=True):
            # differences from the nearer end of the oval lose no digits
            gap, share = end - oval.middle, np.sin(phi / 2) if end < oval.middle else np.cos(phi / 2)
            found /= np.sqrt(float(abs(gap) - oval.radius) + 2 * float(oval.radius) * share**2)
        return found

    @cached_property
    def actions(self) -> list[Real] | None:
        """The actions (1/2π)∮p dq over the cycles that belong to the frequencies; None without an action form."""
        form = self.separation.action
        if form is None:
            return None
        found = [
            _mean(self._sampled(oval, [form])[0], self._poles_of(oval, form)) if self.moves(oval) else self._field.zero
            for oval in self.ovals
        ]
        return [*found, *self.separation.momenta]

    @property
    def signs(self) -> list[Real]:
        """The signs that make the actions of ovals positive, and the frequencies of points that rest."""
        one, actions = self._field.one, self.actions
        signs = [one for _ in self.frequencies]
        for k, (oval, action) in enumerate(zip(self.ovals, actions or (), strict=False)):
            # the ends of the oval of a point that rests are a double root, known to half of the digits, and its action
            # is 0 up to rounding
            if (self.frequencies[k] if oval.radius <= self._close else action) < 0:
                signs[k] = -one
        return signs


def _mean(row: Sequence[Real], poles: Sequence[Pole]) -> Real:
    return sum(row) / len(row) + sum(pole.mean for pole in poles)
