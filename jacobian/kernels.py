"""Which addition an exact Jacobian runs: explicit formulas, Cantor, NUCOMP, or Cantor on python-flint.

By measurement (``python -m benchmarks group nucomp backend heights``): genus 2 takes explicit formulas, except where
Python's arithmetic is slow; where python-flint is installed, :func:`jacobian.flint_cantor.pays` says what goes to it;
what is left goes to Cantor in Python, and to NUCOMP from a genus on that the model decides. All give the same triples.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from jacobian import cantor, flint_cantor, nucomp
from jacobian.curve import HyperellipticCurve
from jacobian.fields.prime import PrimeField
from jacobian.genus2 import ExplicitFormulas
from jacobian.genus2_prime import PrimeFormulas

NUCOMP_GENUS = {"ramified": 5, "split": 6, "inert": 6}
"""From this genus on NUCOMP takes less time than Cantor: ``python -m benchmarks nucomp`` measures it."""

Addition = Callable[[cantor.Triple, cantor.Triple], cantor.Triple]
Doubling = Callable[[cantor.Triple], cantor.Triple]


def kernel(C: HyperellipticCurve) -> tuple[Addition, Doubling]:
    """(addition, doubling) of reduced triples on C, the arithmetic model of a curve over an exact field."""
    if flint_cantor.pays(C):
        on_flint = flint_cantor.FlintCantor(C)
        return on_flint.sum_of, on_flint.double
    return python_kernel(C)


def python_kernel(C: HyperellipticCurve) -> tuple[Addition, Doubling]:
    """The :func:`kernel` without python-flint."""
    if C.genus == 2:
        formulas = PrimeFormulas(C) if type(C.field) is PrimeField else ExplicitFormulas(C)
        return formulas.sum_of, formulas.double
    chosen = nucomp if C.genus >= NUCOMP_GENUS[C.model] else cantor
    return partial(chosen.sum_of, C), partial(chosen.double, C)
