"""Numbers with more digits than an inexact field, for sums that the field's own digits do not decide.

Rounding moves pairs (u, v) in floats off the curve. :func:`on_curve` moves them back, each coefficient by as few of its
last bits as possible.
"""

from __future__ import annotations

from typing import Any

from jacobian.errors import PrecisionLoss
from jacobian.inexact.dense import Coefficients, added, least_squares, multiplication, remainder, residue
from jacobian.numbers.long_reals import BareReals

Pair = tuple[Coefficients, Coefficients]

# the largest number of Newton steps onto the curve
STEPS = 40


class MoreDigits(Exception):
    """The working precision does not resolve a quantity; retry with more digits."""


class Digits:
    """Numbers of ``bits`` bits, real or complex, that stand for elements of an inexact field.

    They must be computed inside ``with digits:``, which sets the precision of the thread.
    """

    def __init__(self, field: Any, bits: int) -> None:
        self.bits = bits
        self.field = field
        self._complex = field.complex
        self._reals = BareReals(bits)
        # a computed quantity whose exact value is 0 is at most ``floor`` in size
        self.floor = self._reals.number(0.5) ** (bits // 2)
        self.eps = self._reals.number(0.5) ** bits
        self.own_eps = self._reals.number(field.eps)
        self.zero, self.one = map(self._reals.number, (0, 1))

    def __enter__(self) -> Digits:
        self._reals.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._reals.__exit__(*error)

    def number(self, x: Any, exponent: int = 0) -> Any:
        """The number x·2^exponent for an element x of the field."""
        scale = self._reals.number(2) ** exponent
        if not self._complex:
            return self._reals.number(x) * scale
        real, imaginary = self._reals.number(x.real), self._reals.number(x.imag)
        import gmpy2

        return gmpy2.mpc(real, imaginary) * scale

    def element(self, x: Any, exponent: int = 0) -> Any:
        """The element of the field nearest to x·2^exponent; PrecisionLoss beyond the range of floats."""
        from jacobian.fields import MP

        x, field = x * self._reals.number(2) ** exponent, self.field
        if field.eps == 2.0**-52 and field.dps is None:
            result = complex(x) if self._complex else float(x)
            if abs(result) == float("inf"):
                raise PrecisionLoss(f"a coefficient of the sum is beyond the range of {field.name}; use MP(digits)")
            return result
        wide = MP(field.dps)
        if self._complex:
            return field.context.mpc(self._reals.element(wide, x.real), self._reals.element(wide, x.imag))
        return self._reals.element(wide, x)


def on_curve(digits: Digits, f: Coefficients, half: Coefficients, pair: Pair, even: bool, known: Any = None) -> Pair:
    """The pair (u, v + half mod u) on y² = f near the given (u, v), by Newton's method with steps of least length.

    The length of a step is measured in units, one for each coefficient: its absolute value if that is not 0. If neither
    the points nor the coefficients of f are of very different sizes (``even``), the unit is at least the last bit of
    the size in :func:`places`. The iteration ends with a step shorter than ``known``, by default the working precision.
    """
    (u, v), size, last = map(list, pair), None, digits.own_eps
    m, known = len(u) - 1, known or digits.eps
    scales = _scales(f, u, v, last, even)
    for _ in range(STEPS):
        centred = added(v, half)
        w, rest = residue(f, u, centred)
        if all(c == 0 for c in rest):
            return u, remainder(centred, u)
        columns = [
            *zip(*multiplication(w, u), strict=True),
            *zip(*multiplication([2 * c for c in centred], u), strict=True),
        ]
        matrix = [[x * s for x, s in zip(row, scales, strict=True)] for row in zip(*columns, strict=True)]
        normal = [[sum(x * y.conjugate() for x, y in zip(a, b, strict=True)) for b in matrix] for a in matrix]
        weights = least_squares(normal, rest)
        steps = [sum(row[i].conjugate() * c for row, c in zip(matrix, weights, strict=True)) for i in range(2 * m)]
        before, size = size, max(map(abs, steps))
        changed = [c + s * x for c, s, x in zip([*u[:-1], *v], scales, steps, strict=True)]
        u, v = [*changed[:m], u[m]], changed[m:]
        if size < known or (before is not None and size < digits.floor and not size < before / 4):
            return u, remainder(added(v, half), u)
    raise MoreDigits


def _scales(f: Coefficients, u: Coefficients, v: Coefficients, last: Any, even: bool) -> Coefficients:
    """The units in which a step measures the coefficients of u, except the leading one, and of v."""
    least = last if even else last**2
    return [
        abs(c) if c != 0 and not even else max(abs(c), least * place)
        for c, place in zip([*u[:-1], *v], places(f, u), strict=True)
    ]


def places(f: Coefficients, u: Coefficients) -> Coefficients:
    """The sizes that the coefficients of u, except the leading one, and of v would have if all points were as large as
    the largest.
    """
    m = len(u) - 1
    radius = max(abs(c) ** (1 / (m - i)) for i, c in enumerate(u[:-1]))
    height = max(abs(c) * radius**i for i, c in enumerate(f)) ** 0.5
    return [*(radius ** (m - i) for i in range(m)), *(height / (radius or 1) ** i for i in range(m))]
