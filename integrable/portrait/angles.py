"""The angles of a start: the phases of u1 and u2 on their ovals, 0 at the outer ends u1 = a₁ and u2 = a₃."""

from __future__ import annotations

from typing import TYPE_CHECKING

from integrable.moving_point.setup import Setup
from integrable.torus.oval_modes import OvalTorus
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.numbers.long_reals import BallReals

if TYPE_CHECKING:
    from integrable.phase.space import PhaseSpace
    from integrable.phase.state import State

# digits of angles beyond those of the set-up, and trial numbers of digits that the ovals may lose: first for ordinary
# motions, then near a separatrix
SPARE, LOST = 4, (0, 40, 160, 640)


def start_angles(system: PhaseSpace, state: State, wide: MultiprecisionField, digits: int) -> tuple[Real, Real]:
    """The angles θ of the start, Σ∫(dx, x dx)/y = θ1·2(A0, A1) + θ2·2(B0, B1), modulo 1, to ``digits`` in the ``wide``
    field; PrecisionLoss if the ovals have nearly met.
    """
    for lost in LOST:
        setup = Setup(system.body, *state.vectors, state.tilted, digits=wide.dps + lost)
        balls = BallReals(setup.reals.bits + 32)
        try:
            with balls:
                found = balls.elements(wide, OvalTorus(setup, balls, digits + SPARE, (1, 0)).start)
            break
        except PrecisionLoss:
            if lost == LOST[-1]:
                raise
    # phases start at the inner end of the second oval
    first, second = found[0], found[1] + wide.one / 2
    floor = wide.context.floor
    return first - floor(first), second - floor(second)
