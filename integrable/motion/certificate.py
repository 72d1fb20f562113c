"""The states of a body computed with more digits, with which a certificate compares a run."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil

from integrable.motion.precise import PreciseFlow
from integrable.motion.trajectory import Motion
from integrable.phase.body import Body, symmetry_axis
from integrable.portrait.certificate import Pairs
from jacobian import MP
from jacobian.element import Real
from jacobian.fields.multiprecision import MultiprecisionField

# spare digits in the estimate of :func:`_digits_of_turns`
SPARE = 3


def finer(flow: Motion, times: list[Real], K: MultiprecisionField) -> Pairs:
    """γ and M to the digits of K at physical times (wide numbers), by additions or by an independent formula."""
    body, state = flow.system.body, flow.state
    if body.rolls and state.tilted and symmetry_axis(flow.system.inertia) is not None:
        if len(set(flow.system.inertia)) == 1:
            return [_turned(flow, t, K) for t in times]
        # a body with two equal moments has no torus for its clock, so that the cost grows with the time; a body with
        # slightly different moments has one
        body = _beside(flow, max(map(abs, times), default=K.zero), K)
    precise = PreciseFlow(body, state, K.dps)
    return precise.vectors(precise.at(times)[1])


def _turned(flow: Motion, time: Real, K: MultiprecisionField) -> tuple[Sequence[Real], Sequence[Real]]:
    """γ and M of a ball with three equal moments: γ turns uniformly about L = M + dnγ, n = (γ, ω); L and n are
    constant.
    """
    context = MP(K.dps + _digits_of_turns(flow, time, K)).context
    body, state = flow.system.body, flow.state
    inertia, d, *vectors = map(context.mpf, (body.inertia[0], body.d, *state.row))
    length = context.sqrt(context.fdot(vectors[:3], vectors[:3]))
    gamma, M = [x / length for x in vectors[:3]], vectors[3:]
    n = context.fdot(gamma, M) / inertia
    L = [m + d * n * x for m, x in zip(M, gamma, strict=True)]
    size = context.sqrt(context.fdot(L, L))
    axis, angle = [x / size for x in L], -size * time / (inertia + d)
    c, s, along = context.cos(angle), context.sin(angle), context.fdot(axis, gamma)
    found = [
        c * gamma[i] + s * (axis[i - 2] * gamma[i - 1] - axis[i - 1] * gamma[i - 2]) + (1 - c) * along * axis[i]
        for i in range(3)
    ]
    return found, [x - d * n * y for x, y in zip(L, found, strict=True)]


def _digits_of_turns(flow: Motion, time: Real, K: MultiprecisionField) -> int:
    """SPARE plus the number of digits of the whole part of a bound, in radians, of the rotation until ``time``."""
    # |ω| ≤ |M|/min I
    fastest = sum(abs(K.coerce(m)) for m in flow.state.vectors[1]) / min(map(K.coerce, flow.system.inertia))
    return SPARE + ceil(K.context.log10(1 + abs(time) * fastest))


def _beside(flow: Motion, time: Real, K: MultiprecisionField) -> Body:
    """A body near that of ``flow``: no two of its moments are equal, but its states until ``time`` are those of
    ``flow`` to K's digits. Its field has enough digits to distinguish the moments.

    Its motion is computed by the general additions, which share nothing with the closed form for equal moments.
    """
    apart = K.dps + _digits_of_turns(flow, time, K)
    wide = MP(K.dps + apart)
    moved = [wide.coerce(x) * (1 + n * wide.coerce(10) ** -apart) for n, x in enumerate(flow.system.inertia)]
    return Body.make(moved, wide.coerce(flow.system.d), wide)
