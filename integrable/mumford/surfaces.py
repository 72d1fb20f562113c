"""Systems whose positions q are on a sphere or an ellipsoid, and their constraints."""

from __future__ import annotations

from collections.abc import Sequence

from integrable.mumford.flow import Point
from integrable.mumford.system import MumfordSystem
from jacobian.element import FormulaField, Real


class SurfaceSystem(MumfordSystem):
    """Base class of systems on the surface (n, q) = 1, where n is normal to it at q; on the unit sphere n = q.

    Of the constraints (n, q) = 1, (n, p) = 0 and p ≠ 0 a system has the first, the first two or all three, as many as
    ``_constraint_names`` has.
    """

    _constraint_names: tuple[str, ...] = ("|q| = 1", "(q, p) = 0")

    def _normal(self, N: FormulaField, q: Sequence[Real]) -> Sequence[Real]:
        """Defined by subclasses: n as a linear function of q."""
        return q

    def _constraints(self, N: FormulaField, state: Point) -> Sequence[Real]:
        (q, p), count = state, len(self._constraint_names)
        normal = self._normal(N, q)
        values = [N.dot(normal, q) - N.one]
        if count > 1:
            values.append(N.dot(normal, p))
        if count > 2:
            values.append(N.zero if any(x != N.zero for x in p) else N.one)
        return values

    def _constraint_sizes(self, state: Point) -> list[Real]:
        (q, p), N = state, self.numbers
        widest, fastest = max(map(abs, q)), max(map(abs, p))
        size, other = sum(map(abs, self._normal(N, q))), sum(map(abs, self._normal(N, p)))
        return [2 * widest * size, widest * other + fastest * size, 0][: len(self._constraint_names)]

    def _constrained(self, N: FormulaField, state: Point) -> Point:
        size = N.sqrt(N.dot(self._normal(N, state.q), state.q))
        q, p = tuple(x / size for x in state.q), state.p
        if len(self._constraint_names) > 1:
            normal = self._normal(N, q)
            along = N.dot(normal, p) / N.dot(normal, normal)
            p = tuple(y - along * x for x, y in zip(normal, p, strict=True))
        return Point(q, p)
