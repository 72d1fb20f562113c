"""Dense univariate polynomials: tuples of raw field elements, ascending. The field is the first argument of every
function.

Over an exact field a polynomial is trimmed: its last coefficient is not zero, and the zero polynomial is ``()``. Over
an inexact field nothing is trimmed, so rounding never changes a degree; gcds exist over exact fields only. A field may
supply faster versions of the four ring operations as ``poly_add``, ``poly_sub``, ``poly_mul`` and ``poly_divmod``
(GF(p) does), with the same results.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from jacobian.element import Arithmetic, Element, Real, Rng
from jacobian.errors import FieldError, entries, shown, written

Poly = tuple[Element, ...]


def coerce(
    K: Arithmetic[Element], values: object, argument: str = "polynomial", *, constant: bool = False
) -> Poly[Element]:
    """The polynomial that ``values`` stands for: ascending coefficients, or a polynomial of galois, python-flint or
    PARI. Raises FieldError, which names ``argument``, for anything else.

    With ``constant`` a single number is accepted too. Exact zeros at the top are cut off over an exact field only.
    """
    values = _ascending(values)
    if not isinstance(values, (list, tuple)):
        single = not isinstance(values, Iterable) or getattr(values, "ndim", 1) == 0
        if isinstance(values, (str, bytes, Mapping)) or (single and not constant):
            raise FieldError(f"{argument} = {shown(values)} is not a polynomial: give its coefficients, ascending")
        if single:
            a: Poly[Element] = (K.coerce(values, argument),)
            return trim(K, a) if K.exact else a
    a = tuple([K.coerce(value, f"{argument}[{i}]") for i, value in enumerate(entries(values, argument))])
    return trim(K, a) if K.exact else a


def _ascending(values: Any) -> Any:
    """The ascending coefficients of a polynomial of galois (which is descending), python-flint or PARI; anything else
    unchanged.
    """
    system = type(values).__module__.split(".")[0]
    if system in ("galois", "flint") and hasattr(values, "coeffs"):
        return values.coeffs[::-1] if system == "galois" else values.coeffs()
    # in PARI a constant polynomial is a number, whose object has __iter__ but cannot be iterated
    pari = system.startswith("cypari") and values.type() in ("t_POL", "t_INT", "t_FRAC", "t_INTMOD")
    return list(values.Vecrev()) if pari else values


def to_galois(K: Arithmetic[Element], a: Poly[Element]) -> Any:
    """The galois.Poly of ``a`` (in galois's descending order); FieldError for a field without a galois class."""
    if not hasattr(K, "to_galois"):
        raise FieldError(f"field = {K.name}: galois has finite fields only")
    import galois

    return galois.Poly(K.to_galois(a[::-1] or (K.zero,)))


def trim(K: Arithmetic[Element], a: Sequence[Element]) -> Poly[Element]:
    """``a`` without its highest coefficients that are exactly zero."""
    size = len(a)
    while size and a[size - 1] == K.zero:
        size -= 1
    return tuple(a[:size])


def add(K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]) -> Poly[Element]:
    """a + b."""
    fast: Callable[..., Poly[Element]] | None = getattr(K, "poly_add", None)
    if fast:
        return fast(a, b)
    if len(a) < len(b):
        a, b = b, a
    total = (*map(K.add, a, b), *a[len(b) :])
    return trim(K, total) if K.exact and len(a) == len(b) else total


def neg(K: Arithmetic[Element], a: Poly[Element]) -> Poly[Element]:
    """−a."""
    return tuple(map(K.neg, a))


def sub(K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]) -> Poly[Element]:
    """a − b."""
    fast: Callable[..., Poly[Element]] | None = getattr(K, "poly_sub", None)
    return fast(a, b) if fast else add(K, a, neg(K, b))


def scale(K: Arithmetic[Element], c: Element, a: Poly[Element]) -> Poly[Element]:
    """c·a for an element c; c must not be zero over an exact field."""
    return tuple([K.mul(c, x) for x in a])


def mul(K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]) -> Poly[Element]:
    """a·b, each coefficient being one dot product."""
    fast: Callable[..., Poly[Element]] | None = getattr(K, "poly_mul", None)
    if fast:
        return fast(a, b)
    if not a or not b:
        return ()
    if len(a) < len(b):
        a, b = b, a
    size, last = len(a), len(b)
    backwards = b[::-1]
    return tuple(
        [
            K.dot(a[max(0, k + 1 - last) : k + 1], backwards[max(0, last - 1 - k) : last - max(0, k + 1 - size)])
            for k in range(size + last - 1)
        ]
    )


def divide(K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]) -> tuple[Poly[Element], Poly[Element]]:
    """(quotient, remainder) of the division of ``a`` by ``b``. Over an inexact field the remainder has length min(len
    a, len b − 1).
    """
    fast: Callable[..., tuple[Poly[Element], Poly[Element]]] | None = getattr(K, "poly_divmod", None)
    if fast:
        return fast(a, b)
    if not b or b[-1] == K.zero:
        raise ZeroDivisionError(f"division by a polynomial whose leading coefficient is zero over {K.name}")
    size = len(b) - 1
    steps = len(a) - size
    if steps <= 0:
        return (), tuple(a)
    monic_divisor = b[-1] == K.one
    inverse = b[-1] if monic_divisor else K.inv(b[-1])
    rest = list(a)
    quotient = [K.zero] * steps
    for i in range(steps - 1, -1, -1):
        c = rest[i + size] if monic_divisor else K.mul(rest[i + size], inverse)
        quotient[i] = c
        for j in range(size):
            rest[i + j] = K.sub(rest[i + j], K.mul(c, b[j]))
    return tuple(quotient), trim(K, rest[:size]) if K.exact else tuple(rest[:size])


def mod(K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]) -> Poly[Element]:
    """The remainder of ``a`` modulo ``b``."""
    return divide(K, a, b)[1]


def quotient(K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]) -> Poly[Element]:
    """The quotient of ``a`` by ``b``, for divisions without remainder."""
    return divide(K, a, b)[0]


def monic(K: Arithmetic[Element], a: Poly[Element]) -> Poly[Element]:
    """``a`` divided by its leading coefficient, which becomes exactly one."""
    lead = a[-1]
    if lead == K.one:
        return a
    inverse = K.inv(lead)
    return (*[K.mul(x, inverse) for x in a[:-1]], K.one)


def gcd(K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]) -> Poly[Element]:
    """The monic greatest common divisor (exact fields); ``()`` when both are zero."""
    while b:
        a, b = b, mod(K, a, b)
    return monic(K, a) if a else a


def half_xgcd(K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]) -> tuple[Poly[Element], Poly[Element]]:
    """The pair (d, s): d is the monic gcd of a and b, not both zero, over an exact field, and s·b ≡ d modulo a."""
    r0, r1 = a, b
    s0: Poly[Element] = ()
    s1: Poly[Element] = (K.one,)
    while len(r1) > 1:
        q, r = divide(K, r0, r1)
        r0, r1 = r1, r
        s0, s1 = s1, sub(K, s0, mul(K, q, s1))
    if r1:
        # a and b are coprime: the last division, by a constant, would give the remainder 0
        return (K.one,), scale(K, K.inv(r1[0]), s1)
    if r0[-1] == K.one:
        return r0, s0
    inverse = K.inv(r0[-1])
    return (*scale(K, inverse, r0[:-1]), K.one), scale(K, inverse, s0)


def xgcd(
    K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]
) -> tuple[Poly[Element], Poly[Element], Poly[Element]]:
    """(d, r, s): d is the monic gcd of a and b, not both zero, over an exact field, and d = r·a + s·b."""
    d, s = half_xgcd(K, a, b)
    if not a:
        return d, (), s
    return d, quotient(K, sub(K, d, mul(K, s, b)), a), s


def resultant(K: Arithmetic[Element], a: Poly[Element], b: Poly[Element]) -> Element:
    """The resultant of two non-zero polynomials over an exact field, by Euclid's algorithm."""
    result = K.one
    while len(b) > 1:
        rest = mod(K, a, b)
        if not rest:
            return K.zero
        for _ in range(len(a) - len(rest)):
            result = K.mul(result, b[-1])
        if (len(a) - 1) * (len(b) - 1) % 2:
            result = K.neg(result)
        a, b = b, rest
    for _ in range(len(a) - 1):
        result = K.mul(result, b[0])
    return result


def integer(K: Arithmetic[Element], m: int) -> Element:
    """The element m·1; ``K.coerce(m)`` differs over GF(p^k), where an int stands for an element."""
    return K.coerce(m % K.characteristic if K.characteristic else m)


def power(K: Arithmetic[Element], x: Element, exponent: int) -> Element:
    """x**exponent, exponent ≥ 0, by squaring."""
    result = K.one
    for bit in bin(exponent)[2:]:
        result = K.mul(result, result)
        if bit == "1":
            result = K.mul(result, x)
    return result


def evaluate(K: Arithmetic[Element], a: Poly[Element], x: Element) -> Element:
    """a(x), by Horner's rule."""
    value = K.zero
    for c in reversed(a):
        value = K.add(K.mul(value, x), c)
    return value


def size_at(a: Poly[Real], x: Real) -> Real:
    """Σ|aᵢ||x|ⁱ, over an inexact field: the size of the terms of a(x)."""
    size: Any = abs(x)
    found: Real = sum(abs(c) * size**i for i, c in enumerate(a))
    return found


def derivative(K: Arithmetic[Element], a: Poly[Element]) -> Poly[Element]:
    """The derivative a'."""
    result = [K.mul(integer(K, i), a[i]) for i in range(1, len(a))]
    return trim(K, result) if K.exact else tuple(result)


def shift(K: Arithmetic[Element], a: Poly[Element], c: Element) -> Poly[Element]:
    """a(x + c), by repeated synthetic division."""
    result = list(a)
    for i in range(len(a)):
        for j in range(len(a) - 2, i - 1, -1):
            result[j] = K.add(result[j], K.mul(c, result[j + 1]))
    return tuple(result)


def monomial(K: Arithmetic[Element], c: Element, degree: int) -> Poly[Element]:
    """c·x^degree; ``()`` when c is zero over an exact field."""
    if K.exact and c == K.zero:
        return ()
    return (*([K.zero] * degree), c)


def from_roots(K: Arithmetic[Element], roots: Iterable[Element]) -> Poly[Element]:
    """The monic polynomial Π (x − root) over the given roots."""
    product: Poly[Element] = (K.one,)
    for root in roots:
        product = mul(K, product, (K.neg(root), K.one))
    return product


def through(K: Arithmetic[Element], points: Sequence[tuple[Element, Element]]) -> tuple[Poly[Element], Poly[Element]]:
    """Π (x − x_k), and the coefficients of the line through both points, for two points (x_k, y_k) with x_1 ≠ x_2."""
    (x1, y1), (x2, y2) = points
    slope = K.div(K.sub(y1, y2), K.sub(x1, x2))
    return (K.mul(x1, x2), K.neg(K.add(x1, x2)), K.one), (K.sub(y1, K.mul(slope, x1)), slope)


def random(K: Any, degree: int, rng: Rng, *, monic: bool = False) -> Poly:
    """A polynomial drawn uniformly from those of degree below ``degree``; with ``monic``, from the monic ones of that
    degree.
    """
    a = tuple([K.random(rng) for _ in range(degree)])
    if monic:
        return (*a, K.one)
    return trim(K, a) if K.exact else a


def power_mod(K: Arithmetic[Element], a: Poly[Element], exponent: int, m: Poly[Element]) -> Poly[Element]:
    """a**exponent modulo m."""
    result = mod(K, (K.one,), m)
    for bit in bin(exponent)[2:]:
        result = mod(K, mul(K, result, result), m)
        if bit == "1":
            result = mod(K, mul(K, result, a), m)
    return result


def text(K: Arithmetic[Element], a: Sequence[Element], variable: str = "x") -> str:
    """``a`` as a formula, the highest power first; numbers are shortened as by :func:`jacobian.errors.written`."""
    terms = []
    for i in range(len(a) - 1, -1, -1):
        c = a[i]
        if c == K.zero:
            continue
        power = "" if i == 0 else variable if i == 1 else f"{variable}^{i}"
        coefficient = written(c)
        if power and c == K.one:
            coefficient = ""
        elif power and coefficient[0] != "(" and any(sign in coefficient[1:] for sign in "+-/j"):
            coefficient = f"({coefficient})"
        terms.append(f"{coefficient}{'·' if coefficient and power else ''}{power}")
    return " + ".join(terms).replace("+ -", "- ") or "0"
