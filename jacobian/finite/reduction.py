"""Reduction of curves over QQ modulo primes."""

from __future__ import annotations

from math import lcm

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import FieldError, JacobianError
from jacobian.fields import GF, QQ
from jacobian.finite.integers import factorization


def bad_primes(C: HyperellipticCurve) -> list[int]:
    """See :meth:`jacobian.curve.questions.CurveQuestions.bad_primes`; Infeasible where factoring fails."""
    if C.field != QQ:
        raise FieldError(f"field = {C.field.name}: a curve over QQ has reductions modulo primes")
    return [p for p in factorization(suspects(C)) if not is_good(C, p)]


def suspects(C: HyperellipticCurve) -> int:
    """A number > 0 that all bad primes of the equation divide."""
    denominator = lcm(*(c.denominator for c in (*C.f, *C.h)))
    F = C.discriminant
    # F is a form of degree 2g + 2, whose roots at infinity count too: so the resultant of F and F' is multiplied by the
    # leading coefficient of F
    size = poly.resultant(QQ, F, poly.derivative(QQ, F)) * F[-1] * denominator
    return abs(size.numerator * size.denominator) * 2


def is_good(C: HyperellipticCurve, p: int) -> bool:
    """Whether the equation defines a curve of the same genus modulo p."""
    try:
        C.change_ring(GF(p))
    except JacobianError:
        return False
    return True
