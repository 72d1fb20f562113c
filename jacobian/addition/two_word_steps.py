"""The steps of :mod:`jacobian.addition.two_word_loops` that depend on the genus: access to rows, and the two halves of
a sum.

A class of weight g is a tuple of 2g words in the order of the formulas (:mod:`jacobian.addition.genus2_words` and
:mod:`jacobian.addition.genus3_words`): u and v from the highest coefficient down. In an array its row is stored as a
column in the order u₀ … u_{g−1}, v₀ … v_{g−1}. Single classes are passed and returned as residues in that same order.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition.genus2_words import (
    BinaryQuintic,
    BinarySextic,
    Quintic,
    Sextic,
    chord,
    cubic,
    opposite,
    product,
    sum_u,
    sum_v,
    tangent,
)  # fmt: skip
from jacobian.addition.genus3_words import Septic
from jacobian.addition.genus3_words import chord as chord_of_septic
from jacobian.addition.genus3_words import closed as closed_on_septic
from jacobian.addition.genus3_words import product as product_of_septic
from jacobian.addition.genus3_words import tangent as tangent_of_septic
from jacobian.numbers.words import decode, encode, neg

# --- genus 2


def line(K: Any, C: Any, x: Any, j: Any) -> Any:
    """Row j as a class."""
    return x[1, j], x[0, j], x[3, j], x[2, j]


def line_quotient(K: Any, C: Any, S: Any, j: Any) -> Any:
    """The first half of row j, from the scratch array."""
    return S[2, j], S[3, j], S[4, j]


def line_chord(K: Any, C: Any, first: Any, second: Any) -> Any:
    """The first half of a sum."""
    return chord(K, first, second)


def line_closed(K: Any, C: Any, quotient: Any, inverted: Any, first: Any, second: Any) -> Any:
    """The second half, from the inverse."""
    bent = cubic(K, C, quotient, inverted, first)
    u = sum_u(K, C, bent, first, second)
    return (*u, *sum_v(K, C, bent, u, first))


def line_encoded(K: Any, C: Any, D: Any) -> Any:
    """A class of residues in words."""
    u0, u1, v0, v1 = D
    return encode(K, u1), encode(K, u0), encode(K, v1), encode(K, v0)


def line_decoded(K: Any, C: Any, D: Any) -> Any:
    """The residues of a class."""
    a1, a0, b1, b0 = D
    return decode(K, a0), decode(K, a1), decode(K, b0), decode(K, b1)


# --- genus 3


def row(K: Any, C: Any, x: Any, j: Any) -> Any:
    """Row j as a class."""
    return x[2, j], x[1, j], x[0, j], x[5, j], x[4, j], x[3, j]


def row_quotient(K: Any, C: Any, S: Any, j: Any) -> Any:
    """The first half of row j, from the scratch array."""
    return S[2, j], S[3, j], S[4, j], S[5, j]


def row_chord(K: Any, C: Any, first: Any, second: Any) -> Any:
    """The first half of a sum."""
    return chord_of_septic(K, first, second)


def row_product(K: Any, C: Any, quotient: Any) -> Any:
    """The product to be inverted."""
    return product_of_septic(K, quotient)


def row_opposite(K: Any, C: Any, D: Any) -> Any:
    """(U, −V)."""
    a2, a1, a0, b2, b1, b0 = D
    return a2, a1, a0, neg(K, b2), neg(K, b1), neg(K, b0)


def row_encoded(K: Any, C: Any, D: Any) -> Any:
    """A class of residues in words."""
    u0, u1, u2, v0, v1, v2 = D
    return encode(K, u2), encode(K, u1), encode(K, u0), encode(K, v2), encode(K, v1), encode(K, v0)


def row_decoded(K: Any, C: Any, D: Any) -> Any:
    """The residues of a class."""
    a2, a1, a0, b2, b1, b0 = D
    return decode(K, a0), decode(K, a1), decode(K, a2), decode(K, b0), decode(K, b1), decode(K, b2)


# --- one name for the steps of both; compiled code chooses at compile time


def class_at(K: Any, C: Any, x: Any, j: Any) -> Any:
    """Row j as a class."""
    return STEPS[class_at][GENUS[type(C)]](K, C, x, j)


def quotient_at(K: Any, C: Any, S: Any, j: Any) -> Any:
    """The first half of row j, from the scratch array."""
    return STEPS[quotient_at][GENUS[type(C)]](K, C, S, j)


def of_sum(K: Any, C: Any, first: Any, second: Any) -> Any:
    """The first half of a sum."""
    return STEPS[of_sum][GENUS[type(C)]](K, C, first, second)


def of_double(K: Any, C: Any, first: Any) -> Any:
    """The first half of a double."""
    return STEPS[of_double][GENUS[type(C)]](K, C, first)


def to_invert(K: Any, C: Any, quotient: Any) -> Any:
    """The product to be inverted; 0 in every special case."""
    return STEPS[to_invert][GENUS[type(C)]](K, C, quotient)


def closed(K: Any, C: Any, quotient: Any, inverted: Any, first: Any, second: Any) -> Any:
    """The second half, from the inverse: the sum."""
    return STEPS[closed][GENUS[type(C)]](K, C, quotient, inverted, first, second)


def negated(K: Any, C: Any, D: Any) -> Any:
    """The opposite class."""
    return STEPS[negated][GENUS[type(C)]](K, C, D)


def encoded(K: Any, C: Any, D: Any) -> Any:
    """A class of residues in words."""
    return STEPS[encoded][GENUS[type(C)]](K, C, D)


def decoded(K: Any, C: Any, D: Any) -> Any:
    """The residues of a class."""
    return STEPS[decoded][GENUS[type(C)]](K, C, D)


GENUS: dict[type, int] = {Quintic: 2, Sextic: 2, BinaryQuintic: 2, BinarySextic: 2, Septic: 3}
STEPS: dict[Any, dict[int, Any]] = {
    class_at: {2: line, 3: row},
    quotient_at: {2: line_quotient, 3: row_quotient},
    of_sum: {2: line_chord, 3: row_chord},
    of_double: {2: tangent, 3: tangent_of_septic},
    to_invert: {2: product, 3: row_product},
    closed: {2: line_closed, 3: closed_on_septic},
    negated: {2: opposite, 3: row_opposite},
    encoded: {2: line_encoded, 3: row_encoded},
    decoded: {2: line_decoded, 3: row_decoded},
}
"""For each step, the function of each genus."""
