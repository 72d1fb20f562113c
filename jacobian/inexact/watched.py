"""Numbers that know how many of their digits are right, for sums that a field's own digits do not settle.

A :class:`Watched` number is computed three times at once: from the inputs, from the inputs moved by a few units of the
last working bit, and from the inputs moved by a few units of the last bit *that the field has*. The second difference
is what rounding does at the working precision, the third what the field's own rounding of the inputs does whatever the
algorithm. All three take the same branches. What is zero beside the third difference is zero; what is not resolved
beside the second needs more digits (:class:`MoreDigits`), which the caller tries.

Pairs (u, v) in floats lie beside the curve by rounding; :func:`on_curve` moves them onto it, each coefficient by as few
of its own last bits as possible.
"""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any

from jacobian.errors import PrecisionLoss
from jacobian.inexact.dense import Coefficients, added, least_squares, multiplication, remainder, residue
from jacobian.numbers.long_reals import BareReals

# what the fields' own test takes (jacobian.fields.inexact): zero up to this multiple of the noise, nonzero from that on
ZERO, NONZERO = 16, 4096
# a point as much apart from the opposite of another is a point of its own: the sum shows what is known of it
DISTINCT = 64
# the part of u that rounding of the inputs may move; in last bits, where points were taken for opposite
UNKNOWN, CLEAR = 2**-4, 2**20
# units of the last bit by which the inputs are moved: they may be sums themselves
JOG = 4
# a number is resolved when the working precision knows it to this part
RESOLVED = 2**16
# what remainders may be beside the terms that were set to zero
REMAINDER = 2**12
# the most of Newton's steps onto the curve
STEPS = 40

_LOST = "the digits of the summands do not determine their sum; use more digits"


class MoreDigits(Exception):
    """The working precision does not resolve a quantity: to be tried again with more."""


class Watched:
    """One number three times: ``value``, from inputs moved in the last working bit, and in the last bit they have."""

    __slots__ = ("moved", "other", "value")

    def __init__(self, value: Any, other: Any, moved: Any) -> None:
        self.value, self.other, self.moved = value, other, moved

    def __add__(self, y: Any) -> Watched:
        if isinstance(y, Watched):
            return Watched(self.value + y.value, self.other + y.other, self.moved + y.moved)
        return Watched(self.value + y, self.other + y, self.moved + y)

    __radd__ = __add__

    def __sub__(self, y: Any) -> Watched:
        if isinstance(y, Watched):
            return Watched(self.value - y.value, self.other - y.other, self.moved - y.moved)
        return Watched(self.value - y, self.other - y, self.moved - y)

    def __rsub__(self, y: Any) -> Watched:
        return Watched(y - self.value, y - self.other, y - self.moved)

    def __mul__(self, y: Any) -> Watched:
        if isinstance(y, Watched):
            return Watched(self.value * y.value, self.other * y.other, self.moved * y.moved)
        return Watched(self.value * y, self.other * y, self.moved * y)

    __rmul__ = __mul__

    def __truediv__(self, y: Any) -> Watched:
        if isinstance(y, Watched):
            if y.value == 0 or y.other == 0 or y.moved == 0:
                raise PrecisionLoss(_LOST)
            return Watched(self.value / y.value, self.other / y.other, self.moved / y.moved)
        return Watched(self.value / y, self.other / y, self.moved / y)

    def __rtruediv__(self, y: Any) -> Watched:
        return Watched(y, y, y) / self

    def __pow__(self, exponent: Any) -> Watched:
        return Watched(self.value**exponent, self.other**exponent, self.moved**exponent)

    def __neg__(self) -> Watched:
        return Watched(-self.value, -self.other, -self.moved)

    def __abs__(self) -> Watched:
        return Watched(abs(self.value), abs(self.other), abs(self.moved))

    def conjugate(self) -> Watched:
        """The complex conjugate."""
        return Watched(self.value.conjugate(), self.other.conjugate(), self.moved.conjugate())

    def phase(self) -> Watched:
        """x/|x|, or 1 for 0."""
        return Watched(*(1 + x if x == 0 else x / abs(x) for x in (self.value, self.other, self.moved)))

    def inverse(self) -> Watched:
        """1/x, or 0 for 0."""
        return Watched(*(x if x == 0 else 1 / x for x in (self.value, self.other, self.moved)))

    def __bool__(self) -> bool:
        # gmpy2's complex 0 counts as true
        return bool(self.value != 0)

    def __eq__(self, y: object) -> bool:
        return bool(self.value == (y.value if isinstance(y, Watched) else y))

    __hash__ = None  # type: ignore[assignment]

    def __lt__(self, y: Any) -> bool:
        return bool(self.value < (y.value if isinstance(y, Watched) else y))

    def __gt__(self, y: Any) -> bool:
        return bool(self.value > (y.value if isinstance(y, Watched) else y))

    def rounding(self) -> Any:
        """What the working precision leaves open."""
        return abs(self.value - self.other)

    def noise(self) -> Any:
        """What the rounding of the inputs leaves open."""
        return abs(self.value - self.moved)


class Digits:
    """Numbers of ``bits`` bits, real or complex, for the elements of an inexact field; to be entered with ``with``.

    It is also the ``field`` of :mod:`jacobian.inexact.stacked` for Watched numbers.
    """

    def __init__(self, field: Any, bits: int) -> None:
        self.bits = bits
        self.field = field
        self._complex = isinstance(field.one, complex) or hasattr(field.one, "_mpc_")
        self._reals = BareReals(bits)
        self._rng = Random(0)
        # whether the numbers are all of moderate size: inputs may have lost more than their last bit
        self.even = False
        # whether points were found opposite
        self._opposite = False
        # the largest of the terms that were set to zero, beside their scale
        self._dropped: Any = 0
        self.floor = self._reals.number(2.0**-64) ** (bits // 128)
        self.eps = self._reals.number(2.0**-32) ** (bits // 32)
        self.own_eps = self._reals.number(field.eps)
        self.zero, self.one = (Watched(x, x, x) for x in map(self._reals.number, (0, 1)))

    def __enter__(self) -> Digits:
        self._reals.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        self._reals.__exit__(*error)

    def number(self, x: Any, exponent: int = 0) -> Any:
        """An element of the field times 2^exponent."""
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
        if field.eps == 2.0**-52 and not hasattr(field, "dps"):
            result = complex(x) if self._complex else float(x)
            if abs(result) == float("inf"):
                raise PrecisionLoss(f"a coefficient of the sum is beyond the range of {field.name}; use MP(digits)")
            return result
        wide = MP(field.dps)
        if self._complex:
            return field.context.mpc(self._reals.element(wide, x.real), self._reals.element(wide, x.imag))
        return self._reals.element(wide, x)

    def is_zero(self, x: Watched, scale: Any, of_degree: bool = True) -> bool:
        """Whether x is zero beside what the rounding of the inputs makes of it; PrecisionLoss where that cannot be
        told, MoreDigits where this precision does not resolve it. ``of_degree``: whether a degree depends on it, or
        only whether two points are opposite.
        """
        size, noise, rounding = abs(x.value), x.noise(), x.rounding()
        if size < RESOLVED * rounding and not size <= self.floor and ZERO * rounding > noise:
            raise MoreDigits
        if size <= ZERO * max(noise, rounding):
            self._opposite |= not of_degree
            self._dropped = max(self._dropped, size / getattr(scale, "value", scale))
            return True
        known = self.own_eps * getattr(scale, "value", scale) if self.even else 0
        if size >= (NONZERO if of_degree else DISTINCT) * noise and size >= NONZERO * known:
            return False
        raise PrecisionLoss(_LOST)

    # --- inputs

    def plain(self, values: Sequence[Any]) -> Coefficients:
        """Numbers known exactly."""
        return [Watched(x, x, x) for x in values]

    def pair(self, f: Coefficients, half: Coefficients, u: Coefficients, v: Coefficients) -> tuple[Any, Any]:
        """A pair (u, v) of numbers on y² + 2·half·y = f, as a watched pair on y² = f + half² near it."""
        last = self.own_eps
        value = on_curve(f, half, u, v, last, self.even)
        near_u, near_v = self._jogged(u, v, JOG * last)
        moved = on_curve(f, half, near_u, near_v, last, self.even)
        other = self._jogged(*value, 256 * self.eps)
        first, second = (
            [Watched(*three) for three in zip(*parts, strict=True)] for parts in zip(value, other, moved, strict=True)
        )
        return [*first[:-1], self.one], second

    def _jogged(self, u: Coefficients, v: Coefficients, size: Any) -> tuple[Coefficients, Coefficients]:
        """The pair with every coefficient, but the leading one, moved by about that part of itself."""
        near_u, near_v = ([c * (1 + size * self._part()) for c in part] for part in (u, v))
        return [*near_u[:-1], u[-1]], near_v

    # --- results

    def check(self, total: Any, rest: Any, least: float) -> None:
        """PrecisionLoss where nothing is known of a sum, beside its own points or the nearest to 0 of the summands, at
        ``least``; MoreDigits where it is not resolved.
        """
        if isinstance(rest, Watched) and rest.value > max(self.floor, REMAINDER * self._dropped):
            raise MoreDigits
        u = total.u
        for c in (*u[:-1], *total.v, *total.p, total.q):
            if isinstance(c, Watched) and not self._resolved(c):
                raise MoreDigits
        # beside opposite points that the inputs do not separate, the others too are to be known
        unknown = CLEAR * self.own_eps if self._opposite else UNKNOWN
        m = len(u) - 1
        radius = max((abs(c.value) ** (1 / (m - i)) for i, c in enumerate(u[:-1])), default=0)
        radius = max(radius, least)
        size = radius**m
        if any(c.noise() * radius**i > unknown * size for i, c in enumerate(u[:-1])):
            raise PrecisionLoss(_LOST)

    def _resolved(self, c: Watched) -> bool:
        size, rounding = abs(c.value), c.rounding()
        return size <= self.floor or rounding <= self.own_eps / 8 * size or 8 * rounding <= c.noise()

    def settled(self, total: Any) -> list[Any]:
        """(u, v, p, q) as plain numbers, with zeros for those that are zero at every precision."""
        return [*([self._plain(c) for c in part] for part in total[:3]), self._plain(total.q)]

    def _plain(self, c: Any) -> Any:
        if not isinstance(c, Watched):
            return c
        return 0 * c.value if abs(c.value) <= self.floor and 2 * c.rounding() > abs(c.value) else c.value

    def _part(self) -> float:
        return self._rng.choice((1, -1)) * self._rng.uniform(0.5, 1)


def on_curve(
    f: Coefficients, half: Coefficients, u: Coefficients, v: Coefficients, last: Any, even: bool = True
) -> tuple[Coefficients, Coefficients]:
    """(u, v + half mod u) on y² = f near the given pair, by Newton's method: each step the least one, every coefficient
    measured by itself; but where all is of moderate size (``even``) by no less than its share of the last bit.
    """
    m, size = len(u) - 1, None
    u, v = list(u), list(v)
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
        if before is not None and size < last**2 and not size < before / 4:
            return u, remainder(centred, u)
        changed = [c + s * x for c, s, x in zip([*u[:-1], *v], scales, steps, strict=True)]
        u, v = [*changed[:m], u[m]], changed[m:]
    raise MoreDigits


def _scales(f: Coefficients, u: Coefficients, v: Coefficients, last: Any, even: bool) -> Coefficients:
    """What the coefficients of u, but the first, and of v are measured by."""
    m = len(u) - 1
    radius = max(abs(c) ** (1 / (m - i)) for i, c in enumerate(u[:-1]))
    height = max(abs(c) * radius**i for i, c in enumerate(f)) ** 0.5
    floors = [*(radius ** (m - i) for i in range(m)), *(height / (radius or 1) ** i for i in range(m))]
    least = last if even else last**2
    return [
        abs(c) if c != 0 and not even else max(abs(c), least * floor)
        for c, floor in zip([*u[:-1], *v], floors, strict=True)
    ]
