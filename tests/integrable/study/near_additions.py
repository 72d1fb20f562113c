"""The error of one addition in floats by the distance of D' from D or −D, for the divisor of a scene.

D' is the divisor of the same motion at τ = δ, so that D + D' is nearly a doubling and D' − D nearly zero. No real
Bäcklund map adds such a D' (2D has no real image), so these are sums of divisors, not orbits.
"""

from __future__ import annotations

from typing import Any

from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from jacobian.errors import JacobianError

__all__ = ["DIGITS", "EXPONENTS", "near_additions"]

EXPONENTS = (0, 3, 6, 9, 12)
"""δ = 10^−k in the flow's own unit, 1/(2·max a_i·|M|)."""
DIGITS = 60


def near_additions(scene: Scene) -> dict[str, Any]:
    """For each δ the errors of U in D + D' and in D' − D, relative to 1 + |coefficient|, or the text of a refusal."""
    exact, state = scene.start(DIGITS)
    rounded, _ = scene.start(FLOAT_DIGITS)
    D, flow = exact.divisor(state), exact.flow(state)
    K = exact.field
    unit = 1 / (2 * max(exact.a) * K.sqrt(K.dot(state.M, state.M)))
    h1, h2 = map(float, exact.integrals(state)[2:])
    group = rounded.group(h1, h2)
    rows = []
    for exponent in EXPONENTS:
        moved = flow.at_tau([unit * K.coerce(10) ** -exponent])
        other = exact.divisor(exact.state(tuple(moved.gamma[0]), tuple(moved.M[0])))
        E = D.jacobian.from_mumford(other.u, other.v)
        row: dict[str, Any] = {"distance": 10.0**-exponent}
        for name, true, ours in (
            ("doubling", D + E, lambda p, q: p + q),
            ("opposite", E - D, lambda p, q: q - p),
        ):
            try:
                found = ours(*(group.from_mumford(list(map(float, x.u)), list(map(float, x.v))) for x in (D, E)))
            except JacobianError as error:
                row[name] = f"{type(error).__name__}: {error}"
                continue
            if len(found.u) != len(true.u):
                row[name] = f"degree {len(found.u) - 1}: U has degree {len(true.u) - 1} in more digits"
                continue
            row[name] = max(float(abs(a - b) / (1 + abs(a))) for a, b in zip(true.u, found.u, strict=True))
        rows.append(row)
    return {"rows": rows}
