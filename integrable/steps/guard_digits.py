"""Steps computed with more digits than their field has, for maps whose intermediate results lose digits.

A translation near the identity has large coefficients. At a point x' near a branch point most digits of f(x'), the
square of the ordinate, are lost to cancellation. The computation of a multiple loses digits at every doubling. The map
itself is well conditioned: its image, computed with guard digits and rounded once, has an error of one rounding times
the map's own condition.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from math import ceil, isfinite, log10
from typing import TYPE_CHECKING, Any

from integrable.phase.brackets import over
from integrable.phase.precisions import EPS_DIGITS
from integrable.phase.space import PhaseSpace
from integrable.phase.state import State, onto_constraints, state_of_row
from jacobian import MP
from jacobian.errors import NotASquare, NotRepresentable, PrecisionLoss
from jacobian.fields.inexact import InexactField

if TYPE_CHECKING:
    from integrable.phase.upright import ChaplyginTransformation
    from integrable.steps.step import Step

MOST_CONDITION = 30
"""Up to this condition a step is computed in the numbers of its field; it then loses one or two digits."""
MOST_DRIFT = 16
"""The allowed relative change of H1 and H2 in a step computed in the numbers of its field, in units of eps times the
condition. A larger change shows that digits were lost.
"""
LARGEST = 1e300
ATTEMPTS = 3


def drift(system: PhaseSpace, image: State, state: State) -> Any:
    """The larger of the relative differences of H1 and of H2 between two states."""
    (h1, h2), (k1, k2) = (system.body.energies(*x.vectors) for x in (state, image))
    return max(abs(k1 - h1) / (abs(h1) or 1), abs(k2 - h2) / (abs(h2) or 1))


def with_enough_digits(step: Step, state: State) -> State:
    """The image of a state under ``step.plain``, with guard digits where needed.

    The numbers of the field are used where :meth:`Step.condition` is small and H1 and H2 of the image agree with those
    of the state. PrecisionLoss if they do not agree to eps^0.575 (10⁻⁹ in floats) even with guard digits.
    """
    K = step.system.field
    if step.guarded or not isinstance(K, InexactField):
        return step.plain(state)
    condition, lost = step.condition(state), None
    if condition <= MOST_CONDITION:
        # near a double point of the curve the addition of divisors loses more digits than the condition says
        with suppress(PrecisionLoss):
            image = step.plain(state)
            lost = drift(step.system, image, state)
    if lost is None or not lost <= MOST_DRIFT * max(condition, 1) * K.eps:
        try:
            image = in_wider_numbers(step, state)[0]
        except NotASquare:
            # if the field's own numbers fail too, their error is raised, since its message has the user's numbers
            step.plain(state)
            raise
        lost = drift(step.system, image, state)
    if not lost <= K.eps**0.575:
        C1, C2 = step.system.integrals(state)[:2]
        raise PrecisionLoss(
            f"{step!r}: H1 and H2 of the image are off by {float(lost):.1e} of their size; the state has (γ, γ) − 1 = "
            f"{float(C1 - 1):.1e}, (γ, M) = {float(C2):.1e}; give a state made by system.state, or use more digits"
        )
    return image


def body_condition(system: PhaseSpace) -> float:
    """The amplification of errors where the a_i nearly agree (large m r²): max a_i/(max a_i − min a_i), ≤ 1/eps."""
    K: Any = system.field
    body = system.body
    low, _, high = sorted(range(3), key=lambda i: body.inertia[i])
    spread = (body.inertia[high] - body.inertia[low]) * body.a[high]
    return float(1 / max(spread, K.eps))


def tilt_condition(change: ChaplyginTransformation, state: State) -> float:
    """The factor by which cancellation may amplify errors in Chaplygin's transformation of a state and its inverse."""
    K = change.body.field
    M = change.apply_vectors(*state.vectors)[1]
    size, upright = (K.sqrt(K.dot(v, v)) for v in (state.vectors[1], M))
    a, b, c, d = map(abs, change.inverse_matrix())
    there = max(change.p * (1 + abs(change.k) * size), change.s * (size + abs(change.shift)) / upright)
    return float(there * max(a + b * upright, (c + d * upright) / size))


def in_wider_numbers(step: Step, state: State, count: int = 1) -> list[State]:
    """The states after 1, …, ``count`` steps, rounded to the field of the step only at the end.

    :meth:`Step.condition` chooses the digits. They are doubled where H1 and H2 show that there were too few.
    PrecisionLoss if that does not suffice either.
    """
    K, condition = step.system.field, step.condition(state)
    if on_principal_axis(step.system, state) is not None:
        return _beside_rotation(step, state, count, condition)
    return _wider(step, [(digits, partial(onto_constraints, state=state)) for digits in _digits(K, condition)], count)


def _wider(step: Step, attempts: Sequence[tuple[int, Callable[[PhaseSpace], State]]], count: int) -> list[State]:
    """The states of :func:`in_wider_numbers`, from the first of the ``attempts`` that has enough digits. An attempt is
    (digits, function that makes the state for a system with these digits).
    """
    K = step.system.field
    for digits, made in attempts:
        last = digits == attempts[-1][0]
        system = over(step.system, MP(digits))
        moved, start = step.wider(system), made(system)
        states = [start]
        try:
            for _ in range(count):
                states.append(moved(states[-1]))
        except (NotRepresentable, PrecisionLoss):
            # with too few digits a generic position can look like a special one
            if last:
                raise
            continue
        lost = max(drift(system, image, start) for image in states[1:])
        if lost <= K.eps**1.5:
            return [state_of_row(map(K.coerce, image.row), image.tilted) for image in states[1:]]
    raise PrecisionLoss(f"{step!r}: H1 and H2 are off by {float(lost):.1e} of their size even over {system.field.name}")


def on_principal_axis(system: PhaseSpace, state: State) -> int | None:
    """The axis along which M lies, if γ is orthogonal to it; both conditions are tested to a relative eps². Otherwise
    None.

    The body then rotates about this axis, and the double point of its curve is a point of its divisor.
    """
    K: Any = system.field
    x, m = state.vectors
    i = max(range(3), key=lambda k: abs(m[k]))
    off = max(abs(x[i]), abs(m[i - 1] / m[i]), abs(m[i - 2] / m[i])) if m[i] else K.one
    return i if off <= K.eps**2 else None


def _beside_rotation(step: Step, state: State, count: int, condition: float) -> list[State]:
    """The images of a rotation about a principal axis, as limits of the images of nearby motions.

    The rotation's divisor contains the double point of its curve, where sums are not defined; divisors of nearby
    motions do not. NotRepresentable if two nearby motions, one with γ and one with M perturbed, have different
    images.
    """
    K = step.system.field
    first, *_ = _digits(K, condition)
    distance = ceil(1.5 * first)
    found = [
        _wider(
            step, [(first + factor * distance, partial(_nudged, state, distance, other)) for factor in (4, 8)], count
        )
        for other in (False, True)
    ]
    for one, two in zip(*found, strict=True):
        size = abs(max(two.vectors[1], key=abs))
        differences = [abs(x - y) for x, y in zip(one.row, two.row, strict=True)]
        gaps = [*differences[:3], *(x / size for x in differences[3:])]
        if not max(gaps) <= K.eps**0.75:
            raise NotRepresentable(
                f"{step!r}: M = {state.vectors[1]} is along a principal axis and γ across it: the images of motions "
                "beside this rotation depend on the side, and it has none"
            )
    return [_without_dust(K, image) for image in found[0]]


def _nudged(state: State, distance: int, by_momentum: bool, system: PhaseSpace) -> State:
    """The state with γ and M (only M if ``by_momentum``) turned away from their exact directions by 10^−distance."""
    K: Any = system.field
    gamma, M = (list(map(K.coerce, v)) for v in state.vectors)
    i = max(range(3), key=lambda k: abs(M[k]))
    small = K.context.mpf(10) ** -distance
    if by_momentum:
        # the change of M is orthogonal to γ, which is orthogonal to the axis
        gamma[i], M[i - 2], M[i - 1] = K.zero, -small * M[i] * gamma[i - 1], small * M[i] * gamma[i - 2]
    else:
        gamma[i], M[i - 2], M[i - 1] = small, -small * M[i] * gamma[i - 2], -small * M[i] * gamma[i - 1]
    return onto_constraints(system, state_of_row((*gamma, *M), state.tilted))


def _without_dust(field: Any, image: State) -> State:
    """The image of a perturbed state (:func:`_nudged`), with 0 for the components that are not 0 only because of the
    perturbation. The result is the state of a body that rotates about a principal axis.
    """
    sizes = field.one, max(map(abs, image.vectors[1]))
    row = [
        x if abs(x) > field.eps**2 * size else field.zero
        for v, size in zip(image.vectors, sizes, strict=True)
        for x in v
    ]
    return state_of_row(row, image.tilted)


def _digits(field: Any, condition: float) -> list[int]:
    """Numbers of digits to try: n = 2(the field's digits + those lost to the condition), 2n and 4n."""
    own = field.dps or EPS_DIGITS
    lost = log10(condition) if isfinite(condition) else log10(LARGEST)
    first = ceil(2 * (own + lost))
    return [first << k for k in range(ATTEMPTS)]
