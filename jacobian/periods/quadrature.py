"""Integration on a hyperelliptic curve: numbers with guard digits, nodes and weights, paths from a branch point.

Gauss–Chebyshev quadrature is used for ∫ φ(t)/√(1−t²) dt and Fejér's first rule (1933) for ∫ φ(t) dt on [−1, 1]. Both
have the same n nodes. For φ analytic in the ellipse with foci ±1 and sum of semi-axes r, their errors fall as r^(−2n)
and r^(−n).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import lru_cache
from typing import Any

from jacobian.errors import FieldError, Infeasible
from jacobian.fields.protocol import Field

Vector = list[Any]
Forms = Callable[[Any], Vector]

GUARD_DIGITS = 12
MOST_NODES = 20000


class Numbers:
    """Real and complex working numbers: doubles for RR and CC, the field's digits and a few more for MP."""

    def __init__(self, field: Any) -> None:
        if field.exact:
            raise FieldError(f"field = {field.name}: periods are numbers of RR, CC or MP(dps)")
        self.machine = field.dps is None
        self.sqrt: Any = cmath.sqrt
        self.pi: Any = math.pi
        self.digits = 16
        self.context: Any = None
        if not self.machine:
            from mpmath import MPContext

            self.context = MPContext()
            self.digits = self.context.dps = field.dps + GUARD_DIGITS
            self.sqrt, self.pi = self.context.sqrt, +self.context.pi
        self._cosines: dict[int, list[Any]] = {}
        self._weights: dict[int, list[Any]] = {}

    def real(self, x: Any) -> Any:
        """The real number x, of any kind, as a real working number."""
        if self.machine:
            return float(x)
        return self.context.make_mpf(x._mpf_) if hasattr(x, "_mpf_") else self.context.mpf(x)

    def convert(self, x: Any) -> Any:
        """The number x, of any kind, as a complex working number."""
        if self.machine:
            return complex(x)
        if hasattr(x, "_mpc_"):
            return self.context.make_mpc(x._mpc_)
        return self.context.mpc(self.real(x)) if not isinstance(x, complex) else self.context.mpc(x)

    def ten(self, exponent: int) -> Any:
        """10**exponent."""
        return 10.0**exponent if self.machine else self.context.mpf(10) ** exponent

    def working(self) -> AbstractContextManager[Any]:
        """A context manager that does nothing: the precision of these numbers does not depend on the thread."""
        return nullcontext()

    def root(self, square: Any, approximation: Any) -> Any:
        """The square root of ``square`` nearer to ``approximation``."""
        root = self.sqrt(square)
        rough, approximation = complex(root), complex(approximation)
        return root if rough.real * approximation.real + rough.imag * approximation.imag >= 0 else -root

    def cosines(self, n: int) -> list[Any]:
        """cos(jπ/(2n)) for j = 0 … n."""
        if n not in self._cosines:
            cos = math.cos if self.machine else self.context.cos
            values = [cos(j * self.pi / (2 * n)) for j in range(n)]
            self._cosines[n] = [*values, 0 * values[0]]
        return self._cosines[n]

    def nodes(self, n: int) -> list[Any]:
        """The non-negative Chebyshev nodes cos((2j−1)π/(2n)), descending; n is even."""
        return self.cosines(n)[1::2]

    def fejer(self, n: int) -> list[Any]:
        """The weights of Fejér's first rule at :meth:`nodes`, for integrals over [0, 1] of even functions; n even."""
        if n not in self._weights:
            table = self.cosines(n)[::2]  # cos(kπ/n), k = 0 … n/2
            table = table + [-c for c in table[-2::-1]]
            table = table + table[-2:0:-1]
            factors = [self.real(1) / (4 * m * m - 1) for m in range(1, n // 2 + 1)]
            size = 2 * n
            self._weights[n] = [
                (1 - 2 * sum(c * table[m * (2 * j - 1) % size] for m, c in enumerate(factors, 1))) * 2 / n
                for j in range(1, n // 2 + 1)
            ]
        return self._weights[n]

    def along_path(self, ratios: Vector, forms: Forms, rate: float) -> Vector:
        """∫₀¹ forms(s²)/Π√(1 − s²·ratio) ds, a product over ``ratios``, by Fejér's rule of ``rate`` digits per node."""
        # the number of nodes is limited, since computing the weights takes time proportional to its square
        n = self.node_count(rate, 500 + 10 * self.digits)
        return path_sums(self, self.nodes(n), self.fejer(n), ratios, forms)

    def node_count(self, digits_per_node: float, most: int = MOST_NODES) -> int:
        """The number of nodes that suffice if each adds ``digits_per_node``; Infeasible if it exceeds ``most``.

        It is rounded up to one of a few even numbers, so that fewer rules have to be computed.
        """
        needed = (self.digits + 3) / digits_per_node if digits_per_node > 0 else math.inf
        if needed > most:
            raise Infeasible(
                f"{needed:.0f} nodes of quadrature: a branch point is too near to the path; the limit is {most}"
            )
        step = max(2, 2 * (int(needed) // 16))
        return step * math.ceil(needed / step)


def complex_field(field: Any) -> Any:
    """CC for RR, MP(dps, complex=True) for MP(dps)."""
    from jacobian.fields import CC, MP

    return CC if field.dps is None else MP(field.dps, complex=True)


@lru_cache(maxsize=64)
def working_numbers(field: Field) -> Numbers:
    """The Numbers of a field. Calls with the same field share one object, so that nodes and weights are made once."""
    return Numbers(field)


def plus(a: Vector, b: Vector, factor: Any = 1) -> Vector:
    """a + factor·b."""
    return [x + factor * y for x, y in zip(a, b, strict=True)]


def ellipse(u: complex) -> float:
    """log₁₀ of the sum of the semi-axes of the ellipse with foci ±1 through u."""
    root = cmath.sqrt(u * u - 1)
    return math.log10(max(abs(u + root), abs(u - root)))


def from_branch_point(
    numbers: Numbers, roots: Vector, lead: Any, point: tuple[Any, Any], forms: Forms
) -> tuple[int, Vector]:
    """(i, ∫ forms(x) dx/Y from branch point i to the point) on Y² = lead·Π(x − e), for the i of fastest convergence."""
    rough, target = [complex(e) for e in roots], complex(point[0])
    scale = max(abs(e - target) for e in rough)
    rates = [_rate([e for j, e in enumerate(rough) if j != i], start, target, scale) for i, start in enumerate(rough)]
    i = max(range(len(roots)), key=rates.__getitem__)
    return i, path_from(numbers, i, roots, lead, point, forms, rates[i])


def path_from(
    numbers: Any, i: int, roots: Vector, lead: Any, point: tuple[Any, Any], forms: Forms, rate: float
) -> Vector:
    """∫ forms(x) dx/Y from the branch point i to the point (x, Y); each node adds ``rate`` digits."""
    x, Y = point
    e, span = roots[i], x - roots[i]
    ratios = [span / (other - e) for j, other in enumerate(roots) if j != i]
    rest = lead
    for j, other in enumerate(roots):
        if j != i:
            rest = rest * (e - other)
    total = numbers.along_path(ratios, lambda square: forms(e + span * square), rate)
    # the ordinate at e + span·s² is rest·root·s·Π√(1 − s²·ratio), root² = span/rest; the sign of root gives Y at s = 1
    root = numbers.root(span / rest, Y / (rest * _root_of_product(numbers, ratios, [complex(r) for r in ratios], 1)))
    return [2 * root * x for x in total]


def path_sums(numbers: Any, nodes: Sequence[Any], weights: Sequence[Any], ratios: Vector, forms: Forms) -> Vector:
    """The sum over the nodes s of weight · forms(s²)/Π√(1 − s²·ratio), a product over ``ratios``."""
    rough = [complex(ratio) for ratio in ratios]
    total: Vector = []
    for s, weight in zip(nodes, weights, strict=True):
        square = s * s
        factor = weight / _root_of_product(numbers, ratios, rough, square)
        terms = [factor * f for f in forms(square)]
        total = [t + f for t, f in zip(total, terms, strict=True)] if total else terms
    return total


def _rate(others: list[complex], start: complex, target: complex, scale: float) -> float:
    """The digits per node of Fejér's rule on the path from ``start`` to ``target``.

    In s, x = start + (target − start)s², singularities are ±√((e − start)/(target − start)) for e in ``others``.
    """
    if abs(target - start) < 1e-14 * scale:
        return 16.0
    return min((ellipse(cmath.sqrt((e - start) / (target - start))) for e in others), default=16.0)


def _root_of_product(numbers: Any, ratios: Vector, rough_ratios: Sequence[complex], square: Any) -> Any:
    """Π√(1 − s²·ratio) with principal roots; ``square``: s²."""
    product, rough, s2 = 1, 1 + 0j, float(square.real)
    for ratio in ratios:
        product = product * (1 - square * ratio)
    for ratio in rough_ratios:
        rough *= (1 - s2 * ratio) ** 0.5
    return numbers.root(product, rough)
