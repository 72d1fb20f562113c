"""Derivatives of the states of a motion with respect to its start and its body, at any time: secular and periodic
parts.

On a compact torus :mod:`integrable.portrait.variations` reduces the derivatives to integrals of functions of the state.
Each is a mean rate times τ plus a Fourier series (:mod:`integrable.torus.series`). Let ẋ, Y, a and b be as in
``variations``, w₁ and w₂ its right-hand sides, and σ the integral of Y(1/g) over τ with mean 0. With a = a' − σb,
da'/dτ = (w₁ + σw₂)/g and db/dτ = w₂/g the derivatives are

    S(t) = t·[ẋ ⊗ α + (Y − σẋ) ⊗ β] + bounded,

with α and β the mean rates of a' and b per unit of t, which the changes of the frequencies determine. The secular part
has rank two; the third independent integral changes only shapes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from math import ceil, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.phase.body import Body
from integrable.phase.precisions import ROUNDED_TO_FLOATS
from integrable.phase.state import State
from integrable.portrait.differences import GUARD, Inputs, differences
from integrable.portrait.growth import growth
from integrable.portrait.variations import Variation, gradient
from integrable.torus.integrals import MOST_COMPILED, periods_of, resolved_samples
from integrable.torus.series import TorusSeries, spectrum, together
from jacobian import MP, RR
from jacobian.element import Numbers, Real
from jacobian.errors import NotRepresentable
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.fields.protocol import Field
from jacobian.immutable import Record, read_only

if TYPE_CHECKING:
    from integrable.torus.access import TorusFlow

# coefficients of the rates below this fraction of the largest are rounding errors
NOISE = 3e-14
# largest relative error of derivatives on the torus; beyond it differences of motions in more digits are used
MOST_LOST = 1e-12
COLUMNS = ("gamma1", "gamma2", "gamma3", "M1", "M2", "M3", "I1", "I2", "I3", "d")


class Sensitivity(Record):
    """The derivatives ∂(γ, M)(t)/∂(γ(0), M(0), I, d) at N times, or ∂(q, p)(t)/∂(q(0), p(0), constants) of a system of
    any genus. Get one from ``flow.sensitivity(times)``.

    ``matrix`` has shape (N, 6, 10), or (N, 2n, 2n + m) for m constants: rows γ and M, or q and p. ``columns`` are the
    names of the inputs. The start varies within its constraints: columns of γ(0), q(0) and p(0) are derivatives along
    the axes projected onto the tangent plane. ``times`` has shape (N,). The entries lie in the field of the system.
    ``way`` is "torus", or "differences" of motions in more digits.
    """

    def __init__(
        self,
        times: np.ndarray,
        matrix: np.ndarray,
        secular: np.ndarray | None,
        way: str,
        grown: tuple[Any, ...] | None = None,
        columns: tuple[str, ...] = COLUMNS,
    ) -> None:
        """``secular`` is None where it is computed on request: then ``grown`` are the arguments of :func:`_grown`."""
        self.columns = columns
        self.times, self.matrix, self._secular, self.way, self._inputs = times, matrix, secular, way, grown

    @cached_property
    def secular(self) -> np.ndarray:
        """The part of ``matrix`` that grows with t, shape (N, 6, 10), for a ball or a top.

        If ``way`` is "differences", its computation needs another motion, and for a ball the modes of 1/g.
        NotRepresentable where the motion is on no torus of dimension two, PrecisionLoss where the modes are too many.
        """
        if self._secular is not None:
            return self._secular
        if self._inputs is None:
            raise NotRepresentable(
                "secular: derivatives have separate parts for a ball or top on a torus of dimension two; these are "
                "differences of motions that lie on none, or of another system"
            )
        return read_only(_grown(self.times, *self._inputs))

    @cached_property
    def periodic(self) -> np.ndarray:
        """The bounded part, ``matrix`` minus ``secular``: shape (N, 6, 10)."""
        return read_only(self.matrix - self.secular)

    def __len__(self) -> int:
        return len(self.times)

    def _repr_html_(self) -> str:
        from jacobian.notebook import table

        if not len(self):
            return table(repr(self), ["", *self.columns], [])
        rows = [(name, *row) for name, row in zip(self.columns, self.matrix[-1].tolist(), strict=False)]
        return table(f"{self!r}; at t = {self.times[-1]}", ["", *self.columns], rows)

    def __repr__(self) -> str:
        return f"<Sensitivity at {len(self)} times, by {self.way}>"


def sensitivity(flow: Any, times: Numbers) -> Sensitivity:
    """The sensitivity of a :class:`~integrable.motion.flow.Flow` at times of its field: on its torus where floats and a
    torus suffice, else by differences of motions in more digits.
    """
    run = flow.at(times)
    variations = flow._variations
    if variations:
        found: Sensitivity = variations.at(run.times, run.tau, np.hstack([run.gamma, run.M]))
        if _lost(flow, run, found.matrix) <= MOST_LOST:
            return found
    field, body, state = flow.system.field, flow.system.body, flow.state
    digits, size = _wanted(field, run.times, float(max(map(abs, flow.system.omega(state)))))

    # a motion has two phases unless a point of its divisor is at rest or the ovals have met
    parted = flow.portrait.region in ("low", "high")

    def rows(numbers: np.ndarray, K: MultiprecisionField) -> np.ndarray:
        """Returns γ and M, a row for each time; if ``parted``, a last row holds both frequencies."""
        there = flow._through(*_body_and_state(numbers, K))
        states = there.at(run.times)
        found = np.hstack([states.gamma, states.M])
        return np.vstack([found, [*there.portrait.frequencies, 0, 0, 0, 0]]) if parted else found

    heavy = min(body.inertia) + body.d
    sizes = (*[1] * 3, *[max(map(abs, state.vectors[1]))] * 3, *[heavy] * 4)
    # there is no body with d < 0
    inputs = Inputs((*state.row, *body.inertia, body.d), sizes, () if body.rolls else (9,))
    matrix = differences(rows, inputs, digits, size)
    if not parted:
        return Sensitivity(run.times, _numbers(field, matrix), None, "differences")
    slopes = tuple(tuple(row) for row in matrix[-1, :2].tolist())
    grown = flow, slopes, digits, digits + ceil(log10(size)) + GUARD
    return Sensitivity(run.times, _numbers(field, matrix[:-1]), None, "differences", grown)


def system_sensitivity(flow: Any, times: Numbers) -> Sensitivity:
    """The sensitivity of a :class:`~integrable.mumford.flow.MumfordFlow` at times of its field, by differences."""
    run, (inputs, names) = flow.at(times), flow._inputs()
    digits, size = _wanted(flow.system.field, run.times, flow._fastest)

    def rows(numbers: np.ndarray, K: MultiprecisionField) -> np.ndarray:
        states: np.ndarray = np.hstack(flow._through(numbers, K)._states(run.times))
        return states

    matrix = _numbers(flow.system.field, differences(rows, inputs, digits, size))
    return Sensitivity(run.times, matrix, None, "differences", columns=names)


def _wanted(field: Any, times: np.ndarray, rate: float) -> tuple[int, float]:
    """The digits of derivatives over a field, and their approximate size if ``rate`` is the rate of turning."""
    farthest = max((abs(float(t)) for t in times), default=0.0)
    return ROUNDED_TO_FLOATS if field == RR else field.dps, 1 + 10 * farthest * rate


def _body_and_state(numbers: Iterable[Real], K: MultiprecisionField) -> tuple[Body, State]:
    """The body and the state with the numbers γ, which is normalized, M, I and d."""
    g1, g2, g3, m1, m2, m3, i1, i2, i3, d = map(K.coerce, numbers)
    size = K.sqrt(g1 * g1 + g2 * g2 + g3 * g3)
    return Body.make((i1, i2, i3), d, K), State((g1 / size, g2 / size, g3 / size), (m1, m2, m3), tilted=True)


def _grown(times: np.ndarray, flow: Any, slopes: Sequence[Sequence[Real]], digits: int, wide: int) -> np.ndarray:
    """The secular part of differences of motions, from the derivatives of the frequencies."""
    body = flow.system.body
    there = flow._through(*_body_and_state((*flow.state.row, *body.inertia, body.d), MP(wide)))
    return _numbers(flow.system.field, growth(there.at(times), np.array(slopes, dtype=object), digits))


def _numbers(field: Field, found: np.ndarray) -> np.ndarray:
    numbers: np.ndarray = np.frompyfunc(field.coerce, 1, 1)(found).astype(float if field == RR else object)
    return numbers


class TorusVariations:
    """Sensitivities along a motion on a torus, in floats; PrecisionLoss where no grid resolves the integrands."""

    def __init__(self, torus: TorusFlow, body: Body) -> None:
        # in these units the largest 1/(I + d) and |M| are 1
        self._torus, self._unit = torus, 1 / max(body.a)
        self._size = float(torus.setup.bare.momentum)
        self._body = type(body)(tuple(x / self._unit for x in body.inertia), body.d / self._unit, body.field)
        self._pace = self._size / self._unit
        self._doubled = periods_of(torus)
        nu = torus.frequencies
        self._nu = nu[0] / self._doubled[0] / self._pace, nu[1] / self._doubled[1] / self._pace
        self._sample()
        start = self._scaled(torus.at_phases(np.zeros((1, 2))))
        self._start = Variation.at(self._body, start)
        project = np.eye(10)
        project[:3, :3] -= np.outer(start[0, :3], start[0, :3])
        self._project = project
        self._gradient = gradient(self._body, start[0])

    def _scaled(self, rows: np.ndarray) -> np.ndarray:
        """States γ and M converted to the units of the variations."""
        return np.concatenate([rows[:, :3], rows[:, 3:] / self._size], axis=1)

    def _sample(self) -> None:
        """Sets the series of σ, a' and b."""
        samples = resolved_samples(self._torus, self._integrands, _noise, MOST_COMPILED).values
        lean, along, across = np.split(samples, [1, 8], axis=2)
        self._sigma = self._series(lean[..., 0])
        values = self._sigma.on_grid(lean.shape[:2]) + self._sigma.origin
        along = along + values[..., None] * across
        self._along, self._across = ([self._series(x) for x in np.moveaxis(part, -1, 0)] for part in (along, across))

    def _series(self, samples: np.ndarray) -> TorusSeries:
        return TorusSeries(spectrum(samples), self._nu, noise=max(NOISE / 64, self._torus.closure))

    def _integrands(self, rows: np.ndarray) -> np.ndarray:
        """Y(1/g), and the rates in τ of a and of b for changes of C2, H1, H2, I1, I2, I3 and d, seven each, (N, 15)."""
        here = Variation.at(self._body, self._scaled(rows))
        turning, forced = here.rates()
        rates = np.concatenate([turning[:, :, 1:], forced], axis=2) * here.slowness[:, None, None]
        return np.column_stack([here.lean, rates.reshape(-1, 14)])

    def at(self, times: np.ndarray, tau: np.ndarray, rows: np.ndarray) -> Sensitivity:
        """The Sensitivity at ``times`` and ``tau``, where ``rows`` are the states γ and M."""
        phases = self._torus.phases(times, True, self._doubled)
        clock, steps = tau * self._pace, times * self._pace
        here = Variation.at(self._body, self._scaled(rows))
        half = len(self._along)
        sums = together([self._sigma, *self._along, *self._across], *phases)
        sigma = sums[:, 0] + self._sigma.origin
        # a and b at the start, and the derivatives of the integrals with respect to the ten inputs
        begin = np.linalg.pinv(self._start.fields[0])
        b0 = np.concatenate([begin[1], np.zeros(4)])
        a0 = np.concatenate([begin[0], np.zeros(4)]) + self._sigma.origin * b0
        rates = np.concatenate([self._gradient[1:], np.eye(4, 10, 6)])
        a, b = sums[:, 1 : half + 1] @ rates, sums[:, half + 1 :] @ rates
        mean_a, mean_b = (np.array([s.mean for s in part]) @ rates for part in (self._along, self._across))
        a, b = a + a0 + clock[:, None] * mean_a, b + b0 + clock[:, None] * mean_b
        x, Y = here.fields[:, :, 0], here.fields[:, :, 1]
        Y = Y - sigma[:, None] * x
        level = np.broadcast_to(self._gradient, (len(rows), 4, 10)).copy()
        level[:, 2, 6:] -= here.energy
        found = here.inverse @ level + x[:, :, None] * a[:, None, :] + Y[:, :, None] * b[:, None, :]
        # on average τ is t divided by the mean of 1/g
        slow = float(self._torus.mean)
        secular = x[:, :, None] * mean_a / slow + Y[:, :, None] * mean_b / slow
        secular = steps[:, None, None] * secular
        return Sensitivity(times, self._in_units(found), self._in_units(secular), "torus")

    def _in_units(self, found: np.ndarray) -> np.ndarray:
        rows = np.array([1.0] * 3 + [self._size] * 3)
        columns = np.array([1.0] * 3 + [self._size] * 3 + [self._unit] * 4)
        scaled: np.ndarray = rows[:, None] * (found @ self._project) / columns
        return scaled


def _noise(most: np.ndarray) -> np.ndarray:
    """For each part the fraction of its largest mode, given in ``most``, below which modes are rounding errors."""
    found: np.ndarray = NOISE * most.max() / np.maximum(most, NOISE * most.max())
    return found


def _lost(flow: Any, run: Any, matrix: np.ndarray) -> float:
    """The largest relative error of the derivatives in floats, estimated from two exact symmetries.

    Scaling moments, d and M together leaves γ(t) unchanged, and scaling M rescales time. Errors are relative to the
    largest element at a time. Near a separatrix the integrals are large and nearly cancel.
    """
    system, M = flow.system, np.array(flow.state.M)
    heavier = np.concatenate([np.zeros(3), M, system.inertia, [system.d]])
    faster = np.concatenate([np.zeros(3), M, np.zeros(4)])
    scaled = np.hstack([0 * run.gamma, run.M])
    moved = np.hstack([np.cross(run.gamma, run.omega), np.cross(run.M, run.omega)])
    gaps = matrix @ heavier - scaled, matrix @ faster - scaled - run.times[:, None] * moved
    size = np.abs(matrix).max(axis=(1, 2)) * max(1.0, float(np.abs(heavier).max()))
    return float(max((np.abs(gap).max(axis=1) / size).max(initial=0) for gap in gaps))
