"""The bodies and states that a flow over RR accepts (docs/flow.md, "The domain of floats").

Inside this domain, states are computed from the torus in double-double numbers or, for equal moments, in closed form.
Outside it, branch points are too close together for the digits of the set-up, or numbers leave the range of floats. The
call then raises an error at once. Over MP(digits) nothing is refused here: digits are added as needed, with
PrecisionLoss where they do not suffice.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from integrable.phase.body import symmetry_axis
from integrable.phase.space import PhaseSpace
from jacobian.errors import ArgumentError

if TYPE_CHECKING:
    from integrable.phase.body import Vector
    from integrable.phase.state import State

LARGEST = 1e100
"""Moments, |M| and d ≠ 0 are at most this number and at least its inverse, so that products stay in the range of
floats.
"""
WIDEST = 1e10
"""The largest allowed ratio of the largest moment to the least, if all three differ."""
HEAVIEST = 1e16
"""The largest allowed ratio of d to the least moment, if all three moments differ."""
LIGHTEST = 1e-50
"""The least allowed ratio of d to the largest moment, if d ≠ 0 and all three moments differ."""
NEAREST = 1e-18
"""The least allowed nonzero difference of the largest and the least moment, relative to the largest plus d."""

_UNITS = "; use other units of mass, length or time, or MP(digits)"


def check_domain(system: PhaseSpace, state: State) -> None:
    """Raises ArgumentError if a flow over RR refuses a body or a state; the message names the argument, its value and a
    remedy.
    """
    body, (_, M) = system.body, state.vectors
    inertia, d = body.inertia, body.d
    momentum = max(map(abs, M))
    if max(*inertia, d, momentum) > LARGEST:
        name, x = next(pair for pair in _named(system, state) if abs(pair[1]) > LARGEST)
        raise ArgumentError(f"{name} = {x}: floats take up to {LARGEST:.0e} here{_UNITS}")
    # a tilted state with M = 0 is refused elsewhere, as M ∥ γ
    if not (momentum or state.tilted):
        raise ArgumentError("M = (0, 0, 0): the body is at rest; a flow needs M ≠ 0")
    if min(*inertia, d or 1, momentum or 1) < 1 / LARGEST:
        parts = (*_named(system, state)[:4], ("max(|M|)", momentum))
        name, x = next(pair for pair in parts if 0 < pair[1] < 1 / LARGEST)
        raise ArgumentError(f"{name} = {x}: floats take {1 / LARGEST:.0e} or more here{_UNITS}")
    if symmetry_axis(inertia) is None:
        _check_shape(inertia, d)


def _named(system: PhaseSpace, state: State) -> list[tuple[str, float]]:
    """(name, value) for each number of a body and of M, with the names used in messages."""
    moments = [(f"inertia[{i}]", x) for i, x in enumerate(system.inertia)]
    return [*moments, ("d", system.d), *((f"M[{i}]", x) for i, x in enumerate(state.vectors[1]))]


def _check_shape(inertia: Vector, d: float) -> None:
    """Checks the ratios of the moments and d of a body whose moments all differ."""
    least, most = min(inertia), max(inertia)
    if most > WIDEST * least:
        raise ArgumentError(
            f"inertia = {inertia}: the moments have the ratio {most / least:.1e}, floats take up to {WIDEST:.0e} where "
            "three differ; use MP(digits), or moments of which two are equal"
        )
    if d > HEAVIEST * least:
        raise ArgumentError(
            f"d = {d} with inertia = {inertia}: d is {d / least:.1e} of the least moment, floats take up to "
            f"{HEAVIEST:.0e}; use MP(digits), or moments of which two are equal"
        )
    if 0 < d < LIGHTEST * most:
        raise ArgumentError(
            f"d = {d} with inertia = {inertia}: d is {d / most:.1e} of the largest moment, floats take 0 or "
            f"{LIGHTEST:.0e} and more; use d = 0, from which no state can be told"
        )
    if most - least < NEAREST * (most + d):
        raise ArgumentError(
            f"inertia = {inertia} with d = {d}: the moments differ by {(most - least) / (most + d):.1e} of the largest "
            f"plus d, floats take {NEAREST:.0e} and more; use equal moments, or MP(digits)"
        )
