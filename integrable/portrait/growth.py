"""The secular part of the derivatives of the states x of a motion, to many digits: the part that grows with t.

Where the phases are linear in t, the secular part is tΣX_k ⊗ ∂f_k, with the frequencies f_k and the derivatives X_k of
x with respect to the phases. X_k(t) = S(t)X_k(0), where S(t) is the matrix of derivatives with respect to the start.
The change X_k(0) of the start changes one phase and no action.

The phases of a body are linear in τ, and the secular part is t·[ẋ ⊗ α + (Y − σẋ) ⊗ β]. Y is the field of H2/2
(:mod:`integrable.portrait.variations`), and σ the integral of Y(1/g) over τ with mean 0. The derivatives
∂f_k = f_kα + η_kβ of both frequencies f_k determine α and β. Here η = (B0, −A0)/(2D), with A0, B0 and D of
:mod:`integrable.portrait.ovals`, are the rates along Y − σẋ of phases that are linear in t. For a mode F·e^(2πik·θ) of
1/g, σ has the mode F·(k·η)/(k·ν), with the frequencies ν in τ.
"""

from __future__ import annotations

from math import ceil, log10
from typing import Any

import numpy as np

from integrable.phase.ways import rounded
from integrable.portrait.differences import GUARD, differences
from integrable.portrait.sensitivity import expected, states_through
from integrable.portrait.variations import commuting_spin, moved
from integrable.torus.long_clock import phases
from integrable.torus.oval_modes import modes_of_rate
from integrable.torus.series import LongSeries
from jacobian import MP
from jacobian.element import Real
from jacobian.errors import NotRepresentable, PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.linear import pivoted
from jacobian.numbers.long_reals import BallReals


def growth_on_torus(flow: Any, times: np.ndarray) -> np.ndarray:
    """The secular part of the derivatives of the states at ``times``, in an array of their shape, for a system whose
    phases are linear in t.
    """
    (inputs, _), portrait, (digits, size) = flow._inputs(), flow.portrait, expected(flow, times)
    # phases and actions determine neither an angle about an axis nor the centre of mass of a lattice
    width, free = flow._dimensions
    if portrait.actions is None or free != 2 * len(portrait.angles):
        raise NotRepresentable(f"secular: the phases of {flow.system!r} and its actions do not determine a state")
    start, digits = portrait.angles, digits + ceil(log10(size))

    def numbers_of(numbers: np.ndarray, K: MultiprecisionField) -> np.ndarray:
        found = flow._through(numbers, K).portrait
        turned = [(x - y + K.one / 2) % 1 for x, y in zip(found.angles, start, strict=True)]
        return np.array([turned, found.actions, found.frequencies], dtype=object)

    by_start = differences(states_through(flow, times), inputs, digits, size)[:, :, :width]
    angles, actions, slopes = differences(numbers_of, inputs, digits, size)
    # of all changes of the start that change one phase and no other phase or action, the least is taken
    sizes, change = np.array(inputs.sizes[:width], dtype=object), np.vstack([angles, actions])[:, :width]
    change = change * sizes
    scales = np.array([max(map(abs, row)) or 1 for row in change])
    change = change / scales[:, None]
    square = change @ change.T
    columns = [pivoted([[*row, row[0] * 0 + (i == k)] for i, row in enumerate(square)]) for k in range(len(angles))]
    if None in columns:
        raise PrecisionLoss("secular: the phases and the actions of this motion are not independent")
    moved = (by_start * sizes) @ (change.T @ np.array(columns, dtype=object).T) / scales[: len(angles)]
    return rounded(flow.system.field, times[:, None, None] * (moved @ slopes))


def growth_of_body(flow: Any, times: np.ndarray) -> np.ndarray:
    """The secular part of the derivatives of γ and M at ``times``, for a ball or top: shape (N, 6, 10). PrecisionLoss
    where the modes of 1/g are too many.
    """
    # a motion has two phases unless a point of its divisor is at rest or the ovals have met
    if flow.portrait.region not in ("low", "high"):
        raise NotRepresentable("secular: these are derivatives of motions that lie on no torus of dimension two")
    (inputs, _), (digits, size) = flow._inputs(), expected(flow, times)

    def frequencies(numbers: np.ndarray, K: MultiprecisionField) -> np.ndarray:
        return np.array([flow._through(numbers, K).portrait.frequencies], dtype=object)

    slopes = differences(frequencies, inputs, digits, size)[0]
    run = flow._through(flow._numbers, MP(digits + ceil(log10(size)) + GUARD)).at(times)
    body, portrait = run.system.body, run.flow.portrait
    ovals, (f1, f2) = portrait.ovals, portrait.frequencies
    e1, e2 = ovals.B0 / (2 * ovals.D), -ovals.A0 / (2 * ovals.D)
    determinant = f1 * e2 - f2 * e1
    alpha, beta = (e2 * slopes[0] - e1 * slopes[1]) / determinant, (f1 * slopes[1] - f2 * slopes[0]) / determinant
    x, Y = (moved(run._rows, spin) for spin in (run.omega, commuting_spin(body, run.gamma, run.M)))
    if body.rolls:
        Y = Y - _lean(run, (e1, e2), digits)[:, None] * x
    secular = run.times[:, None, None] * (x[:, :, None] * alpha + Y[:, :, None] * beta)
    return rounded(flow.system.field, secular)


def _lean(run: Any, rates: tuple[Real, Real], digits: int) -> np.ndarray:
    """σ, the integral of Y(1/g) over τ with mean 0 (see the top of this file), at the times of a run: shape (N,)."""
    import flint

    K, portrait = run.system.field, run.flow.portrait
    modes = modes_of_rate(run.flow.setup, digits)
    nu = tuple(x / n for x, n in zip(portrait.tau_frequencies, modes.doubled, strict=True))
    most = len(modes.rows[0]) // 2
    with BallReals(K.context.prec + 16) as balls:
        e1, e2 = (balls.number(x / n) for x, n in zip(rates, modes.doubled, strict=True))
        unit = flint.acb(0, 2 * flint.arb.pi()) / balls.number(portrait.mean_g * K.coerce(modes.mean))
        rows = [[c * unit * (k * e1 + (m - most) * e2) for m, c in enumerate(row)] for k, row in enumerate(modes.rows)]
    series = LongSeries(rows, (nu[0], nu[1]), K, 10.0**-digits)
    swings = series.at([phases(t, (nu[0], nu[1]), K) for t in run.tau])
    return np.array([x + series.origin for x in swings], dtype=object)
