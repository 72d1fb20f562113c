"""Derivatives of the states of a motion with respect to its start and its body, at any time: secular and periodic
parts.

On a compact torus :mod:`integrable.portrait.variations` reduces the derivatives to integrals of functions of the state.
Each is a mean rate times τ plus a Fourier series (:mod:`integrable.torus.series`). Let ẋ, Y, a, b and (w₁, w₂) =
(ȧ + ρb, ḃ) be as in ``variations``, and σ the integral of Y(1/g) over τ with mean 0. With a = a' − σb, da'/dτ =
(w₁ + σw₂)/g and db/dτ = w₂/g the derivatives are

    S(t) = t·[ẋ ⊗ α + (Y − σẋ) ⊗ β] + bounded,

with α and β the mean rates of a' and b per unit of t, which the changes of the frequencies determine. The secular part
has rank two: one combination of the three independent integrals changes the shape of the motion, but no frequency.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from integrable.phase.body import Body
from integrable.phase.precisions import ROUNDED_TO_FLOATS
from integrable.phase.ways import rounded
from integrable.portrait.differences import FlowMap, differences
from integrable.portrait.variations import Variation, moved
from integrable.torus.access import TorusFlow
from integrable.torus.integrals import MOST_COMPILED, periods_of, resolved_samples
from integrable.torus.series import TorusSeries, spectrum, together
from jacobian import RR
from jacobian.immutable import Record, read_only
from jacobian.notebook import table

# Fourier coefficients of the integrands below this fraction of the largest one are rounding errors
NOISE = 3e-14
# largest relative error of derivatives on the torus; beyond it differences of motions in more digits are used
MOST_LOST = 1e-12
COLUMNS = ("gamma1", "gamma2", "gamma3", "M1", "M2", "M3", "I1", "I2", "I3", "d")


class Sensitivity(Record):
    """The derivatives ∂(γ, M)(t)/∂(γ(0), M(0), I, d) at N times, or ∂(q, p)(t)/∂(q(0), p(0), constants) of another
    system. Get one from ``flow.sensitivity(times)``.

    ``matrix`` has shape (N, 6, 10), or (N, 2n, 2n + m) for m constants: rows γ and M, or q and p. ``columns`` are the
    names of the inputs. The start varies within its constraints: columns of γ(0), q(0) and p(0) are derivatives along
    the axes projected onto the tangent plane. ``times`` has shape (N,). The entries lie in the field of the system.
    ``way`` is "torus", "differences" of motions in more digits, or "integrated", from equations of variation.
    """

    def __init__(
        self,
        times: np.ndarray,
        matrix: np.ndarray,
        secular: np.ndarray | None,
        way: str,
        flow: Any = None,
        columns: tuple[str, ...] = COLUMNS,
    ) -> None:
        """``secular`` is None where ``flow`` computes it on request."""
        self.columns = columns
        self.times, self.matrix, self._secular, self.way, self._flow = times, matrix, secular, way, flow

    @cached_property
    def secular(self) -> np.ndarray:
        """The part of ``matrix`` that grows with t, of the same shape.

        If ``way`` is "differences", this part is computed from further motions, and for a ball from the modes of 1/g.
        NotRepresentable where the motion lies on no torus, and for a system other than a body if it turns about an axis
        or moves as a whole, or if t is not linear in its phases. PrecisionLoss where the modes are too many.
        """
        return read_only(self._flow._secular(self.times) if self._secular is None else self._secular)

    @cached_property
    def periodic(self) -> np.ndarray:
        """The bounded part, ``matrix`` minus ``secular``."""
        return read_only(self.matrix - self.secular)

    def __len__(self) -> int:
        return len(self.times)

    def _repr_html_(self) -> str:
        if not len(self):
            return table(repr(self), ["", *self.columns], [])
        rows = [(name, *row) for name, row in zip(self.columns, self.matrix[-1].tolist(), strict=False)]
        return table(f"{self!r}; at t = {self.times[-1]}", ["", *self.columns], rows)

    def __repr__(self) -> str:
        return f"<Sensitivity at {len(self)} times, by {self.way}>"


def by_differences(flow: Any, times: np.ndarray) -> Sensitivity:
    """The sensitivity at ``times``, by differences of motions that are computed with more digits."""
    (inputs, names), (digits, size) = flow._inputs(), expected(flow, times)
    matrix = rounded(flow.system.field, differences(states_through(flow, times), inputs, digits, size))
    return Sensitivity(times, matrix, None, "differences", flow, names)


def states_through(flow: Any, times: np.ndarray) -> FlowMap:
    """The function that gives the states at ``times`` of the motion with given inputs, over a given field."""
    return lambda numbers, K: np.hstack(flow._through(numbers, K)._states(times))


def expected(flow: Any, times: np.ndarray) -> tuple[int, float]:
    """The number of digits to which a flow's derivatives are computed, and the approximate size of the derivatives."""
    farthest, field = max((abs(float(t)) for t in times), default=0.0), flow.system.field
    return ROUNDED_TO_FLOATS if field is RR else field.dps, 1 + 10 * farthest * flow._fastest


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
        self._gradient = self._start.gradients[0]

    def _scaled(self, rows: np.ndarray) -> np.ndarray:
        """The states with M divided by the |M| of the motion, which is the unit of M in all derivatives here."""
        return np.concatenate([rows[:, :3], rows[:, 3:] / self._size], axis=1)

    def _sample(self) -> None:
        """Sets the Fourier series of σ, a' and b, the functions of the module's docstring."""
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

    def resolved(self, flow: Any, run: Any) -> Sensitivity | None:
        """The Sensitivity along a run of the flow; None if it has lost too many digits."""
        found = self._at(run)
        return found if _lost(flow, run, found.matrix) <= MOST_LOST else None

    def _at(self, run: Any) -> Sensitivity:
        phases = self._torus.phases(run.times, True, self._doubled)
        clock, steps = run.tau * self._pace, run.times * self._pace
        here = Variation.at(self._body, self._scaled(run._rows))
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
        level = np.broadcast_to(self._gradient, (len(run), 4, 10)).copy()
        level[:, :, 6:] -= here.gradients[:, :, 6:]
        found = here.inverse @ level + x[:, :, None] * a[:, None, :] + Y[:, :, None] * b[:, None, :]
        # on average τ is t divided by the mean of 1/g
        slow = float(self._torus.mean)
        secular = x[:, :, None] * mean_a / slow + Y[:, :, None] * mean_b / slow
        secular = steps[:, None, None] * secular
        return Sensitivity(run.times, self._in_units(found), self._in_units(secular), "torus")

    def _in_units(self, found: np.ndarray) -> np.ndarray:
        rows = np.array([1.0] * 3 + [self._size] * 3)
        columns = np.array([1.0] * 3 + [self._size] * 3 + [self._unit] * 4)
        return rows[:, None] * (found @ self._project) / columns


def _noise(most: np.ndarray) -> np.ndarray:
    """For each integrand the fraction of its largest mode, given in ``most``, below which modes are rounding errors."""
    return NOISE * most.max() / np.maximum(most, NOISE * most.max())


def _lost(flow: Any, run: Any, matrix: np.ndarray) -> float:
    """The largest relative error of the derivatives in floats, estimated from two exact symmetries.

    Scaling moments, d and M together leaves γ(t) unchanged, and scaling M rescales time. Errors are relative to the
    largest element at a time. Near a separatrix the integrals are large and nearly cancel.
    """
    system, M = flow.system, np.array(flow.state.M)
    heavier = np.concatenate([np.zeros(3), M, system.inertia, [system.d]])
    faster = np.concatenate([np.zeros(3), M, np.zeros(4)])
    scaled = np.hstack([0 * run.gamma, run.M])
    later = run.times[:, None] * moved(run._rows, run.omega)
    gaps = matrix @ heavier - scaled, matrix @ faster - scaled - later
    size = np.abs(matrix).max(axis=(1, 2)) * max(1.0, float(np.abs(heavier).max()))
    return float(max((np.abs(gap).max(axis=1) / size).max(initial=0) for gap in gaps))
