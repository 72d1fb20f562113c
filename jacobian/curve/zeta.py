"""The zeta function of a curve over a finite field."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from jacobian.curve import latex
from jacobian.errors import whole
from jacobian.fields import QQ

MOST_COUNTS = 10_000


class ZetaFunction(NamedTuple):
    """Z(T) = numerator/denominator, ascending integers: L(T) and (1 − T)(1 − qT) (Weil 1948)."""

    numerator: tuple[int, ...]
    denominator: tuple[int, ...]

    def count_points(self, n: int = 1) -> list[int]:
        """The numbers of points over GF(q), … GF(qⁿ): q^i + 1 − Σ α^i over the eigenvalues α of Frobenius."""
        n = whole(n, "n", f"the largest degree of the fields is an int, 1 … {MOST_COUNTS}", 1, MOST_COUNTS)
        q, sums = self.denominator[2], power_sums(self.numerator, n)
        return [q**i + 1 - sums[i] for i in range(1, n + 1)]

    def _latex_(self) -> str:
        written = latex.polynomial(QQ, self.numerator, "T")
        return rf"\frac{{{written}}}{{(1 - T)(1 - {self.denominator[2]} T)}}"

    def _repr_latex_(self) -> str:
        return f"${self._latex_()}$"


def power_sums(descending: Sequence[int], count: int) -> list[int]:
    """[0, s_1, …, s_count], s_k the sum of the k-th powers of the roots of a monic polynomial (Newton's identities).

    ``descending``: its coefficients, 1 first.
    """
    size, sums = len(descending) - 1, [0]
    for k in range(1, count + 1):
        known = sum(descending[i] * sums[k - i] for i in range(1, min(k - 1, size) + 1))
        sums.append(-known - (k * descending[k] if k <= size else 0))
    return sums
