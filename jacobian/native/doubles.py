"""The arithmetic of :class:`jacobian.numbers.words.Double` for compiled loops: residues modulo p < 2^49 as floats.

No instruction may be contracted with another, since the exactness of h + l = ab depends on each rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jacobian.native.kinds import FLOAT, Value
from jacobian.native.operators import Operators
from jacobian.numbers import words


def mul(b: Operators, K: Value, x: Value, y: Value) -> Value:
    """xy modulo p, as xy − qp, where q is the integer nearest to the rounded xy/p."""
    p, reciprocal = K.parts[0], K.parts[1]
    first, second = (b.cast(z, FLOAT).parts[0] for z in (x, y))
    high = b.fmul(first, second)
    low = b.fma(first, second, b.fneg(high))
    quotient = b.intrinsic("rint", b.fmul(high, reciprocal))
    return Value(FLOAT, (b.fadd(b.fma(b.fneg(quotient), p, high), low),))


def canonical(b: Operators, K: Value, x: Value) -> Value:
    """The residue of x in [−p/2, p/2], for |x| ≤ 4.5·p."""
    p, half, found = K.parts[0], K.parts[3], x.parts[0]
    far = b.fadd(p, half)
    for bound, step in ((far, b.fmul("3.0", p)), (half, p)):
        for relation, limit, part in (("ogt", bound, b.fneg(step)), ("olt", b.fneg(bound), step)):
            beyond = b.write(f"fcmp {relation} double {found}, {limit}")
            found = b.write(f"select i1 {beyond}, double {b.fadd(found, part)}, double {found}")
    return Value(FLOAT, (found,))


OPERATIONS: dict[Any, Callable[..., Value]] = {words.mul: mul, words.canonical: canonical}
