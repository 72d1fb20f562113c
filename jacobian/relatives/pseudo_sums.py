"""Sums on a Kummer surface modulo a prime, from the biquadratic forms of :mod:`jacobian.relatives.pseudo_group`.

With x = κ(a + b) and y = κ(a − b) the forms at κ(a), κ(b) are b_ij = x_i·y_j + x_j·y_i, b_ii = x_i·y_i, up to a common
factor. If y_i = 1, then x_i = b_ii and x_j = b_ij − b_ii·y_j, so four forms give the sum x. This holds for all points,
because the forms never all vanish. A double is the sum with the difference y = κ(0).

:mod:`jacobian.native` compiles the functions for primes of two words; Python runs them for longer ones.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from jacobian.native.kinds import INT, INTS, LONG, LONGS, ArrayKind, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.modular import CONTEXT
from jacobian.numbers.words import inverse

Forms = namedtuple("Forms", "first second ends place begin coefficient")
Forms.__doc__ = """Six tables of forms: table i < 4 has b_(i+1)1 … b_(i+1)4, table 4 has b_41 … b_44 at (a, a), table 5
the equation of the surface.

Let q_k be the quadratic monomials. Term n is q_k(a)q_l(b) + q_l(a)q_k(b) with k = ``first``[n] and l = ``second``[n];
the second product is left out for k = l, and in tables 4 and 5. Table i has the terms from ``ends``[i] to
``ends``[i + 1]. The summands m of its form j run from ``begin``[4i + j] to ``begin``[4i + j + 1], a multiple of four of
them. Summand m is ``coefficient``[m] times the term ``place``[m] of the table, counted from 0.
"""

QUADRATIC = 10
"""The number of quadratic monomials ξ₁², ξ₁ξ₂, … of a point."""
TERMS = 2 * QUADRATIC
"""The index in the scratch array at which the terms begin."""
SCRATCH = TERMS + 55


def monomials_into(K: Any, S: Any, at: Any, x: Any) -> None:
    """Writes the ten quadratic monomials of the point x into the scratch array S from index ``at`` on."""
    for i in range(4):
        for j in range(i, 4):
            S[at] = K.dot(x[i], x[j])
            at += 1


def sum_of(K: Any, F: Any, S: Any, a: Any, b: Any, difference: Any, i: Any) -> Any:
    """κ(D + E) for a = κ(D), b = κ(E) and ``difference`` = κ(D − E), difference[i] = 1; S: scratch."""
    monomials_into(K, S, 0, a)
    monomials_into(K, S, QUADRATIC, b)
    begin = F.ends[i]
    for n in range(begin, F.ends[i + 1]):
        k, m = F.first[n], F.second[n]
        if k == m:
            S[TERMS + n - begin] = K.dot(S[k], S[QUADRATIC + k])
        else:
            S[TERMS + n - begin] = K.dot(S[k], S[QUADRATIC + m], S[m], S[QUADRATIC + k])
    x = forms_of(K, F, S, i)
    own = x[i]
    return (
        own if i == 0 else K.sub(x[0], K.dot(own, difference[0])),
        own if i == 1 else K.sub(x[1], K.dot(own, difference[1])),
        own if i == 2 else K.sub(x[2], K.dot(own, difference[2])),
        own if i == 3 else K.sub(x[3], K.dot(own, difference[3])),
    )


def forms_of(K: Any, F: Any, S: Any, table: Any) -> Any:
    """The values of the four forms of a ``table`` of the Forms F; S holds the values of the table's terms."""
    return (
        form(K, F, S, 4 * table),
        form(K, F, S, 4 * table + 1),
        form(K, F, S, 4 * table + 2),
        form(K, F, S, 4 * table + 3),
    )


def form(K: Any, F: Any, S: Any, which: Any) -> Any:
    """The value of form ``which`` % 4 of table ``which`` // 4 of the Forms F; S has the values of the table's terms."""
    total = K.sub(K.one, K.one)
    for n in range(F.begin[which], F.begin[which + 1], 4):
        c, at = F.coefficient, F.place
        first, second = S[TERMS + at[n]], S[TERMS + at[n + 1]]
        third, fourth = S[TERMS + at[n + 2]], S[TERMS + at[n + 3]]
        total = K.add(total, K.dot(c[n], first, c[n + 1], second, c[n + 2], third, c[n + 3], fourth))
    return total


def identity(K: Any) -> Any:
    """The point κ(0) = (0, 0, 0, 1)."""
    zero = K.sub(K.one, K.one)
    return zero, zero, zero, K.one


def terms_twice(K: Any, F: Any, S: Any, table: Any, a: Any) -> None:
    """Writes the values at (a, a) of the terms of a table into the scratch array S."""
    monomials_into(K, S, 0, a)
    begin = F.ends[table]
    for n in range(begin, F.ends[table + 1]):
        S[TERMS + n - begin] = K.dot(S[F.first[n]], S[F.second[n]])


def double_of(K: Any, F: Any, S: Any, a: Any) -> Any:
    """κ(2D) for a = κ(D): the values at (a, a) of the module's forms b_14, …, b_44, as y = κ(0) has y_4 = 1."""
    terms_twice(K, F, S, 4, a)
    return forms_of(K, F, S, 4)


def is_point(K: Any, F: Any, S: Any, a: Any) -> Any:
    """Whether ``a`` is a point of the surface whose first nonzero coordinate is 1."""
    if a[unit(a)] != K.one:
        return False
    terms_twice(K, F, S, 5, a)
    return form(K, F, S, 20) == 0


def multiple_of(K: Any, F: Any, S: Any, x: Any, i: Any, bits: Any) -> Any:
    """κ(ma) for x = κ(a), whose coordinate i is 1, by Montgomery's ladder (1987); ``bits``: those of m, descending."""
    low, high = identity(K), x
    for n in range(len(bits)):
        total = sum_of(K, F, S, low, high, x, i)
        if bits[n] == 1:
            low, high = total, double_of(K, F, S, high)
        else:
            low, high = double_of(K, F, S, low), total
    return low


def unit(x: Any) -> Any:
    """The index of the first nonzero coordinate."""
    return 0 if x[0] != 0 else 1 if x[1] != 0 else 2 if x[2] != 0 else 3


def encoded(K: Any, x: Any) -> Any:
    """The residues x of a point as words of the context K (:mod:`jacobian.numbers.words`)."""
    return K.to_word(x[0]), K.to_word(x[1]), K.to_word(x[2]), K.to_word(x[3])


def normal(K: Any, x: Any) -> Any:
    """The residues of a point x, given as words of K, scaled so that the first nonzero one is 1."""
    c = inverse(K, x[unit(x)])
    return (
        K.from_word(K.dot(x[0], c)),
        K.from_word(K.dot(x[1], c)),
        K.from_word(K.dot(x[2], c)),
        K.from_word(K.dot(x[3], c)),
    )


# --- one point: a function returns (0, the result), or (i, any point) if its argument i, counted from 1, is no point


def add_point(K: Any, F: Any, x: Any, y: Any, difference: Any, S: Any) -> Any:
    """κ(D + E) for x = κ(D), y = κ(E) and difference = κ(D − E)."""
    a, b, d = encoded(K, x), encoded(K, y), encoded(K, difference)
    if not is_point(K, F, S, a):
        return 1, x
    if not is_point(K, F, S, b):
        return 2, x
    if not is_point(K, F, S, d):
        return 3, x
    return 0, normal(K, sum_of(K, F, S, a, b, d, unit(d)))


def double_point(K: Any, F: Any, x: Any, S: Any) -> Any:
    """(0, κ(2D)) for x = κ(D); (1, x) if x is no point of the surface."""
    a = encoded(K, x)
    if not is_point(K, F, S, a):
        return 1, x
    return 0, normal(K, double_of(K, F, S, a))


def multiply_point(K: Any, F: Any, x: Any, bits: Any, S: Any) -> Any:
    """(0, κ(mD)) for x = κ(D) and the bits of m, descending; (1, x) if x is no point of the surface."""
    a = encoded(K, x)
    if not is_point(K, F, S, a):
        return 1, x
    return 0, normal(K, multiple_of(K, F, S, a, unit(a), bits))


# --- columns of points: ``wrong`` gets the number of the argument that is not a point, or 0


def add_points(K: Any, F: Any, operands: Any, out: Any, wrong: Any, span: Any, S: Any) -> None:
    """Writes the sums of a span of columns to ``out``; operands are (x, y, differences)."""
    x, y, difference = operands
    for j in range(span[0], span[1]):
        wrong[j], found = add_point(K, F, column(x, j), column(y, j), column(difference, j), S)
        out[0, j], out[1, j], out[2, j], out[3, j] = found


def double_points(K: Any, F: Any, operands: Any, out: Any, wrong: Any, span: Any, S: Any) -> None:
    """Writes the doubles of the points in a span of columns of x to ``out``; ``operands`` is (x,)."""
    for j in range(span[0], span[1]):
        wrong[j], found = double_point(K, F, column(operands[0], j), S)
        out[0, j], out[1, j], out[2, j], out[3, j] = found


def multiply_points(K: Any, F: Any, operands: Any, out: Any, wrong: Any, span: Any, S: Any) -> None:
    """Writes the multiples of a span of columns to ``out``; operands are (x, bits), with a row of bits for each
    column, or one for all.
    """
    x, bits = operands
    for j in range(span[0], span[1]):
        wrong[j], found = multiply_point(K, F, column(x, j), bits[min(j, bits.shape[0] - 1)], S)
        out[0, j], out[1, j], out[2, j], out[3, j] = found


def column(x: Any, j: Any) -> Any:
    """The four coordinates in column j of x."""
    return x[0, j], x[1, j], x[2, j], x[3, j]


FORMS = record(Forms, *[INTS] * 5, LONGS)
POINT, POINTS, SPAN = TupleKind((LONG,) * 4), ArrayKind(LONG, 2, 2), TupleKind((INT, INT))
_REST = (POINTS, INTS, SPAN, LONGS)
COMPILED = Library(
    "sums_on_kummer_surfaces",
    {
        "add_point": (add_point, (CONTEXT, FORMS, POINT, POINT, POINT, LONGS)),
        "double_point": (double_point, (CONTEXT, FORMS, POINT, LONGS)),
        "multiply_point": (multiply_point, (CONTEXT, FORMS, POINT, INTS, LONGS)),
        "add_points": (add_points, (CONTEXT, FORMS, TupleKind((POINTS,) * 3), *_REST)),
        "double_points": (double_points, (CONTEXT, FORMS, TupleKind((POINTS,)), *_REST)),
        "multiply_points": (multiply_points, (CONTEXT, FORMS, TupleKind((POINTS, ArrayKind(INT, 2))), *_REST)),
    },
)
