"""The steps of the explicit formulas on words, which compiled loops call.

The arithmetic is that of :mod:`jacobian.numbers.words`. A step takes a context K and a short equation C, whose class
selects the code: :data:`STEPS` holds the functions that :mod:`jacobian.addition.emit_words` writes for each class.
Loops with these steps run in Python and compiled. Tests run all steps on intervals to show that no word overflows.

A class of weight g is a tuple of 2g words, u and v from the highest coefficient down. An array stores it as a
column in the order u₀ … u_{g−1}, v₀ … v_{g−1}. Single classes are passed and returned as residues, ascending.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jacobian.addition.emit_words import functions
from jacobian.addition.short import MODELS

# --- access


def class_at(K: Any, C: Any, x: Any, j: Any) -> Any:
    """The class that column j of the array x stores, as a tuple of words."""
    return STEPS["class_at"][type(C)](K, C, x, j)


def keep(x: Any, j: Any, found: Any) -> None:
    """Stores the class ``found``, a tuple of words, in column j of the array x."""
    g = len(found) >> 1
    k = g - 1
    for a in found:
        x[k, j] = a
        k = 2 * g - 1 if k == 0 else k - 1


def quotient_at(K: Any, C: Any, S: Any, j: Any) -> Any:
    """The quotient (the first half of a sum) stored in column j of the scratch array S, from the third row on."""
    return STEPS["quotient_at"][type(C)](K, C, S, j)


def class_in(K: Any, C: Any, a: Any) -> Any:
    """A class of weight g as a tuple of words, read from an array of :mod:`jacobian.addition.cantor_words`."""
    return STEPS["class_in"][type(C)](K, C, a)


def encoded(K: Any, C: Any, u: Any, v: Any) -> Any:
    """A class as a tuple of words, from its u and v as residues."""
    return STEPS["encoded"][type(C)](K, C, u, v)


def decoded(K: Any, C: Any, D: Any) -> Any:
    """The pair (u, v), as residues, of a class D given in words; u includes its leading 1."""
    return STEPS["decoded"][type(C)](K, C, D)


# --- a sum in two halves


def opposite(K: Any, C: Any, first: Any) -> Any:
    """The negative of a class."""
    return STEPS["opposite"][type(C)](K, C, first)


def chord(K: Any, C: Any, first: Any, second: Any) -> Any:
    """The first half of a sum: the resultant r, and r·s of the curve y = V + U·s through both divisors."""
    return STEPS["chord"][type(C)](K, C, first, second)


def tangent(K: Any, C: Any, first: Any) -> Any:
    """The first half of a double: r and r·s as in :func:`chord`, for the curve y = V + U·s tangent at the divisor."""
    return STEPS["tangent"][type(C)](K, C, first)


def product(K: Any, C: Any, quotient: Any) -> Any:
    """The product that a sum must invert; 0 in every special case."""
    return STEPS["product"][type(C)](K, C, quotient)


def closed(K: Any, C: Any, quotient: Any, inverse: Any, first: Any, second: Any) -> Any:
    """The sum, from its quotient and the inverse of :func:`product`: the second half of the computation."""
    return STEPS["closed"][type(C)](K, C, quotient, inverse, first, second)


# --- the parts of the second half in genus 2


def cubic(K: Any, C: Any, quotient: Any, inverse: Any, first: Any) -> Any:
    """Four numbers of the cubic through both divisors, from the inverse of :func:`product`."""
    return STEPS["cubic"][type(C)](K, C, quotient, inverse, first)


def sum_u(K: Any, C: Any, cubic: Any, first: Any, second: Any) -> Any:
    """(e₁, e₀) of the sum's u."""
    return STEPS["u"][type(C)](K, C, cubic, first, second)


def sum_v(K: Any, C: Any, cubic: Any, u: Any, first: Any) -> Any:
    """(v₁, v₀) of the sum's v."""
    return STEPS["v"][type(C)](K, C, cubic, u, first)


# --- the parts of the second half in genus 3


def quintic(K: Any, C: Any, quotient: Any, inverse: Any) -> Any:
    """Four numbers of the quintic through both divisors, from the inverse of :func:`product`."""
    return STEPS["bent"][type(C)](K, C, quotient, inverse)


def next_u(K: Any, C: Any, bent: Any, first: Any, second: Any) -> Any:
    """The coefficients of u', whose roots are the four other points of the quintic on the curve."""
    return STEPS["meeting"][type(C)](K, C, bent, first, second)


def next_v(K: Any, C: Any, bent: Any, meeting: Any, first: Any, second: Any) -> Any:
    """The coefficients of the quintic modulo u'."""
    return STEPS["middle"][type(C)](K, C, bent, meeting, first, second)


def last_u(K: Any, C: Any, meeting: Any, middle: Any) -> Any:
    """(u₂, u₁, u₀) of the sum's u."""
    return STEPS["u"][type(C)](K, C, meeting, middle)


def last_v(K: Any, C: Any, u: Any, middle: Any) -> Any:
    """(v₂, v₁, v₀) of the sum's v."""
    return STEPS["v"][type(C)](K, C, u, middle)


STEPS: dict[str, dict[type, Callable[..., Any]]] = {}
"""For each step, the function of each short equation."""
for _model in MODELS:
    for _name, _function in functions(_model).items():
        STEPS.setdefault(_name, {})[_model] = _function
