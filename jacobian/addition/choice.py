"""Which addition an exact Jacobian uses: explicit formulas, Cantor, NUCOMP, Cantor on python-flint, or compiled code.

The choice follows measurements (``python -m benchmarks single nucomp heights``). Genus 2 takes explicit formulas,
except where Python's arithmetic is slow; so does genus 3 over GF(p) on y² = x⁷ + … and on split models with h = 0.
:func:`jacobian.addition.cantor_flint.pays` selects the curves for which python-flint is used. On all other curves
Cantor's algorithm runs in Python, or NUCOMP from a certain genus on, which depends on the model. All methods give the
same triples.

The compiled kernels of :mod:`jacobian.addition.calls` are faster than all of these. They exist over fields of word size
(GF(p), p < 2^63 odd; GF(p^k) of at most 2^16 elements). Where explicit formulas apply, they also exist over GF(p), 2^63
< p < 2^128, and GF(2^n), 16 < n < 128. Compiling them, once on each machine, and loading them, once in each process,
takes time. So a group starts with a kernel that is not compiled. It switches once the process has spent as much time on
additions in such groups as the switch takes: after READY additions if the kernels are on disk (``python -m jacobian
compile`` puts them there), else after COLD ones. :meth:`jacobian.group.Jacobian.compile` switches at once.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

from jacobian.addition import cantor, cantor_flint, ladder, nucomp
from jacobian.addition.explicit import GMP_BITS, ExplicitFormulas, GmpFormulas, PrimeFormulas, formulas_of
from jacobian.addition.short import short_equation
from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields.digits import DigitField
from jacobian.fields.prime import PrimeField
from jacobian.fields.protocol import Field
from jacobian.fields.table import TableField
from jacobian.numbers.binary import MOST_DEGREE
from jacobian.numbers.compiler import interpreted

log = logging.getLogger("jacobian")

NUCOMP_GENUS = {"ramified": 5, "split": 6, "inert": 6}
"""The genus from which NUCOMP takes less time than Cantor's algorithm; ``python -m benchmarks nucomp`` measures it."""

READY = 20_000
"""The number of additions that take as long as loading compiled kernels from disk (``python -m benchmarks startup``).
"""
COLD = 300_000
"""The number of additions that take as long as compiling the kernels."""
BINARY_READY, BINARY_COLD = 1_000, 8_000
"""READY and COLD over GF(2^n), where additions in Python take longer."""
SHARE = 64
"""The number of additions after which a group adds them to the common count. So a group with fewer additions never
switches."""

Addition = Callable[[cantor.Triple, cantor.Triple], cantor.Triple]
Doubling = Callable[[cantor.Triple], cantor.Triple]
Multiple = Callable[[int, cantor.Triple], cantor.Triple]


@dataclass
class Work:
    """The number of ``additions`` done so far without compiled kernels, by all groups for which such kernels exist."""

    additions: float = 0


PROCESS = Work()
"""The work of all groups of this process. They share one count because they share compiled code."""


class Kernel(NamedTuple):
    """Three functions of reduced triples on one curve: addition, doubling, and multiples by m > 0."""

    sum_of: Addition
    double: Doubling
    multiple: Multiple


def kernel(C: HyperellipticCurve, adopt: Callable[[Kernel], None] | None = None) -> Kernel:
    """The kernel for C, the ``arithmetic_model`` of a curve over an exact field.

    When the additions of this process have taken as long as the switch to the compiled kernel, ``adopt`` is called with
    that kernel. Without ``adopt`` no compiled kernel is considered.
    """
    chosen = python_kernel(C)
    if cantor_flint.pays(C):
        on_flint = cantor_flint.FlintCantor(C)
        chosen = _with_ladder(C, on_flint.sum_of, on_flint.double)
    if adopt is None or not (is_word_sized(C) or is_two_words_long(C)):
        return chosen
    counted = Counted(C, chosen, adopt)
    return Kernel(counted.sum_of, counted.double, counted.multiple)


def python_kernel(C: HyperellipticCurve) -> Kernel:
    """The kernel for C in pure Python, without python-flint and compiled code."""
    if formulas_of(C) is not None:
        over_primes = type(C.field) is PrimeField
        if over_primes and C.field.characteristic.bit_length() >= GMP_BITS:
            on_gmp = GmpFormulas(C)
            return Kernel(on_gmp.sum_of, on_gmp.double, on_gmp.multiple)
        formulas = (PrimeFormulas if over_primes else ExplicitFormulas)(C)
        return _with_ladder(C, formulas.sum_of, formulas.double)
    chosen = nucomp if C.genus >= NUCOMP_GENUS[C.model] else cantor
    return _with_ladder(C, partial(chosen.sum_of, C), partial(chosen.double, C))


def _with_ladder(C: HyperellipticCurve, sum_of: Addition, double: Doubling) -> Kernel:
    negate = partial(cantor.negate, C)

    def doubled(a: cantor.Triple) -> cantor.Triple:
        ladder.check_growth(C.field, a[0], a[1])
        return double(a)

    step = double if C.field.characteristic else doubled
    return Kernel(sum_of, step, partial(ladder.multiple, sum_of=sum_of, double=step, negate=negate))


def is_word_sized(C: HyperellipticCurve) -> bool:
    """Whether C has a compiled kernel of word size: over GF(p), p < 2^63 odd, and GF(p^k) of at most 2^16 elements."""
    K = C.field
    return isinstance(K, TableField) or (type(K) is PrimeField and 2 < K.p < 1 << 63)


def is_two_words_long(C: HyperellipticCurve) -> bool:
    """Whether compiled formulas exist for C over a field whose elements take two words. In genus 2 they
    need h = 0 in odd characteristic, and a monic f if deg f = 5; in genus 3 they exist on y² = x⁷ + … over GF(p).
    """
    return has_two_words(C.field) and short_equation(C, int) is not None


def has_two_word_rows(C: HyperellipticCurve) -> bool:
    """Whether C is over a field whose elements take two words and has compiled loops for arrays of classes. Unlike
    in :func:`is_two_words_long`, h and f are arbitrary, since arrays are first moved to a short equation.
    """
    septic = C.genus == 3 and C.model == "ramified" and C.field.characteristic != 2
    return has_two_words(C.field) and (C.genus == 2 or septic)


def has_two_words(K: Field[Any]) -> bool:
    """Whether K is GF(p) for an odd p of two words, or GF(2^n) of at most two words but without a logarithm table."""
    if type(K) is PrimeField:
        return 1 << 63 < K.p < 1 << 128
    return isinstance(K, DigitField) and K.p == 2 and K.degree <= MOST_DEGREE


def compiled_kernel(C: HyperellipticCurve) -> Kernel | None:
    """The compiled kernel for a C that is its own ``arithmetic_model``; None if none exists or compilation is off."""
    if interpreted() or not (is_word_sized(C) or is_two_words_long(C)):
        return None
    from jacobian.addition.calls import TwoWordKernel, word_kernel

    found = TwoWordKernel(C, python_kernel(C)) if is_two_words_long(C) else word_kernel(C)
    return Kernel(found.sum_of, found.double, found.multiple)


class Counted:
    """A kernel that counts its additions. It switches to the compiled kernel when all groups of the process have done
    enough additions together.
    """

    def __init__(self, C: HyperellipticCurve, chosen: Kernel, adopt: Callable[[Kernel], None]) -> None:
        self._curve, self._adopt = C, adopt
        self._sum_of, self._double, self._multiple = chosen
        self._left = SHARE

    def sum_of(self, a: cantor.Triple, b: cantor.Triple) -> cantor.Triple:
        self._left -= 1
        if self._left < 0:
            self._account()
        return self._sum_of(a, b)

    def double(self, a: cantor.Triple) -> cantor.Triple:
        self._left -= 1
        if self._left < 0:
            self._account()
        return self._double(a)

    def multiple(self, m: int, a: cantor.Triple) -> cantor.Triple:
        # a multiple takes a doubling for each bit of m and an addition for every fifth bit
        self._left -= m.bit_length() * 6 // 5
        if self._left < 0:
            self._account()
        return self._multiple(m, a)

    def _account(self) -> None:
        PROCESS.additions += SHARE - self._left
        self._left = SHARE
        ready, cold = costs(self._curve)
        if PROCESS.additions < ready:
            return
        try:
            if interpreted():
                raise RuntimeError("NUMBA_DISABLE_JIT is set")
            from jacobian.addition.calls import is_kept

            worth = PROCESS.additions >= cold or is_kept(self._curve, is_two_words_long(self._curve))
            chosen = compiled_kernel(self._curve) if worth else None
        except (ImportError, RuntimeError) as error:
            # the user did not ask for compilation, so without llvmlite the Python kernel is kept
            PROCESS.additions = -math.inf
            log.warning("no compiled kernels in this process: %s", error)
            return
        if chosen is not None:
            self._sum_of, self._double, self._multiple = chosen
            self._adopt(chosen)


def costs(C: HyperellipticCurve) -> tuple[int, int]:
    """Numbers of additions that take as long as loading C's compiled kernels from disk, and as compiling them."""
    return (BINARY_READY, BINARY_COLD) if not is_word_sized(C) and C.field.characteristic == 2 else (READY, COLD)


# --- an explanation of the choice


def explained(C: HyperellipticCurve, sum_of: Addition) -> str:
    """One line that names the kernel of the addition ``sum_of`` of C, and the reason for it.

    If another kernel may replace it, a second line says when.
    """
    runner = getattr(sum_of, "__self__", sum_of)
    if isinstance(runner, Counted):
        return f"{explained(C, runner._sum_of)}\n{_prospects(*costs(C))}"
    if isinstance(runner, partial):
        limit = NUCOMP_GENUS[C.model]
        if runner.func is nucomp.sum_of:
            return f"NUCOMP in Python: from genus {limit} on it is faster than Cantor on {C.model} models"
        return f"Cantor in Python: below genus {limit} it is faster than NUCOMP on {C.model} models"
    if isinstance(runner, cantor_flint.FlintCantor):
        return f"Cantor on python-flint's polynomials: over {C.field.name} in genus {C.genus} faster than Python"
    if isinstance(runner, GmpFormulas):
        return f"explicit formulas on gmpy2's integers: genus {C.genus} over GF(p), p of {GMP_BITS} bits or more"
    if isinstance(runner, PrimeFormulas):
        return f"explicit formulas on ints: genus {C.genus} over GF(p), p of less than {GMP_BITS} bits"
    if isinstance(runner, ExplicitFormulas):
        return f"explicit formulas: genus 2 over {C.field.name}"
    if is_two_words_long(C):
        fields = "GF(2^n), 16 < n < 128" if C.field.characteristic == 2 else "GF(p), 2^63 < p < 2^128"
        return (
            f"compiled code on two words, for genus {C.genus} over {fields}: explicit formulas, and the kernel in "
            "Python in special positions"
        )
    return f"compiled code, for GF(p), p < 2^63 odd, and GF(p^k) of at most 2^16 elements: {_compiled(C)}"


def _compiled(C: HyperellipticCurve) -> str:
    if C.genus == 2 and short_equation(C, int) is None:
        wanted = "" if C.field.characteristic == 2 else "h = 0 and "
        return f"Cantor, as explicit formulas want {wanted}in degree 5 a monic f"
    if C.genus == 3 and short_equation(C, int) is None:
        return "Cantor, as explicit formulas in genus 3 want GF(p), h = 0 and a monic f of degree 7"
    if C.genus not in (2, 3):
        return "Cantor, as explicit formulas are for genus 2 and 3"
    return "explicit formulas, and Cantor in special positions"


def _prospects(ready: int, cold: int) -> str:
    if math.isinf(PROCESS.additions):
        return "compiled code failed in this process: the logger jacobian has the reason"
    return (
        f"compiled code after {ready} additions in this process if it is on disk already, else after {cold} "
        f"({round(PROCESS.additions)} so far); J.compile() changes over now"
    )
