"""GF(q), q = p^k ≤ 2^16, by tables, without a branch for zero, with the interface of
:mod:`~jacobian.numbers.words`.

An element is the int of :class:`jacobian.fields.table.TableField`. Logarithms refer to a generator c, and zech(n) is
log(1 + c^n). The logarithm of 0 is 2(q − 1), and from this index on the table of powers is 0. So a product is one
look-up at the sum of two logarithms, and a sum is one look-up at log x + zech(log y − log x). The table of Zech
logarithms runs from −2(q − 1) to 2(q − 1). In characteristic 2 a sum is an exclusive or.

A *context* holds the tables. Its operations are compiled as they stand. Every element is canonical.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from jacobian.numbers.words import SingleProducts

_Tables = namedtuple("_Tables", "powers logarithms zech size half one")
"""Powers of a generator, from the 0-th to the 4(q − 1)-th; logarithms; Zech logarithms from −2(q − 1) on; q − 1; the
logarithm of −1; 1.
"""


class TableContext(SingleProducts, _Tables):
    """The operations that the contexts of even and odd characteristic share. Each element is its own canonical word."""

    __slots__ = ()

    def to_word(self, a: int) -> int:
        """The word that represents an element: a itself."""
        return a

    def from_word(self, x: int) -> int:
        """The element that a word represents: x as a Python int."""
        return int(x)

    def product(self, x: Any, y: Any) -> Any:
        return self.powers[self.logarithms[x] + self.logarithms[y]]

    def sub(self: Any, x: Any, y: Any) -> Any:
        return self.add(x, self.neg(y))

    def canonical(self, x: Any) -> Any:
        return x

    fit = settled = canonical

    def invert(self, x: Any) -> Any:
        return self.powers[self.size - self.logarithms[x]]


class BinaryTable(TableContext):
    """The context of a field of characteristic 2. Sums need no logarithms, so the table ``zech`` is empty."""

    __slots__ = ()

    def add(self, x: Any, y: Any) -> Any:
        return x ^ y

    def neg(self, x: Any) -> Any:
        return x


class OddTable(TableContext):
    """The context of a field of odd characteristic."""

    __slots__ = ()

    def add(self, x: Any, y: Any) -> Any:
        first = self.logarithms[x]
        return self.powers[first + self.zech[self.logarithms[y] - first + 2 * self.size]]

    def neg(self, x: Any) -> Any:
        return self.powers[self.logarithms[x] + self.half]


def table_context(K: Any) -> TableContext:
    """The context of a :class:`jacobian.fields.table.TableField`."""
    import numpy as np

    size = K.order - 1
    zero = 2 * size
    powers = np.zeros(2 * zero + 1, np.int64)
    powers[:zero] = K._exp
    logarithms = np.array(K._log, np.int64)
    logarithms[0] = zero
    if K.p == 2:
        return BinaryTable(powers, logarithms, np.zeros(0, np.int64), size, 0, 1)
    between = np.array(K._zech, np.int64)
    between[between < 0] = zero
    # the table has three parts: x = 0 ≠ y, the sum is y; two periods with x, y ≠ 0; y = 0 ≠ x, the sum is x
    left = np.arange(-zero, -size)
    right = np.zeros(size + 1, np.int64)
    zech = np.concatenate([left, between, between, right])
    return OddTable(powers, logarithms, zech, size, K._half, 1)
