"""The steps of the explicit formulas on words, which compiled loops call.

The arithmetic is that of :mod:`jacobian.numbers.words`. :data:`STEPS` holds the functions that
:mod:`jacobian.addition.emit_words` writes for each class of equations of :mod:`jacobian.addition.short`. Loops with
these steps run compiled, for one class of equations each, and in Python without compilation. Tests run all steps on
intervals to show that no word overflows.

A class of weight g is a tuple of 2g words, u and v from the highest coefficient down. An array stores it as a column in
the order u₀ … u_{g−1}, v₀ … v_{g−1}. Single classes are passed and returned as residues, ascending. The steps, for a
context K and an equation C, with ``of = STEPS[type(C)]``::

    of.class_at(K, C, x, j)         # the class that column j of the array x stores
    of.quotient_at(K, C, S, j)      # the quotient stored in column j of the scratch array S, from the third row on
    of.class_in(K, C, a)            # a class of weight g, read from an array of jacobian.addition.cantor_words
    of.encoded(K, C, u, v)          # a class, from its u and v as residues
    of.decoded(K, C, D)             # the pair (u, v) of the class D as residues; u includes its leading 1
    of.opposite(K, C, first)        # the negative of a class
    of.chord(K, C, first, second)   # the first half of a sum, its quotient: the resultant r, and r·s of the curve
                                    # y = V + U·s through both divisors
    of.tangent(K, C, first)         # the first half of a double: the curve is tangent at the divisor
    of.product(K, C, quotient)      # the number that a sum must invert; 0 in every special case
    of.closed(K, C, quotient, inverse, first, second)     # the second half: the sum

The parts of the second half in genus 2, then in genus 3::

    of.cubic(K, C, quotient, inverse, first)              # four numbers of the cubic through both divisors
    of.u(K, C, cubic, first, second)                      # (e₁, e₀) of the sum's u
    of.v(K, C, cubic, u, first)                           # (v₁, v₀) of the sum's v
    of.bent(K, C, quotient, inverse)                      # four numbers of the quintic through both divisors
    of.meeting(K, C, bent, first, second)                 # u', whose roots are the x of the quintic's other points
    of.middle(K, C, bent, meeting, first, second)         # the quintic modulo u'
    of.u(K, C, meeting, middle)                           # (u₂, u₁, u₀) of the sum's u
    of.v(K, C, u, middle)                                 # (v₂, v₁, v₀) of the sum's v
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from jacobian.addition.emit_words import functions
from jacobian.addition.short import MODELS

STEPS = {model: SimpleNamespace(**functions(model)) for model in MODELS}
"""The steps of each class of short equations."""


def keep(x: Any, j: Any, found: Any) -> None:
    """Stores the class ``found``, a tuple of words, in column j of the array x."""
    g = len(found) >> 1
    k = g - 1
    for a in found:
        x[k, j] = a
        k = 2 * g - 1 if k == 0 else k - 1
