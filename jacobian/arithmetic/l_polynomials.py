"""The L-polynomials of a curve over QQ at all good primes up to a bound.

The Hasse–Witt matrices give their coefficients modulo p, for all primes together (:mod:`jacobian.arithmetic.residues`).
Weil's bounds leave few candidates for the coefficients, among which the group law decides, prime by prime
(:mod:`jacobian.arithmetic.decision`). Points are counted at the primes up to 16g², at those that divide
:func:`jacobian.arithmetic.residues.exceptions`, and at 2 if the equation is good there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor
from typing import Any

import numpy as np

from jacobian.arithmetic import decision, residues
from jacobian.arithmetic.record import LPolynomials
from jacobian.arithmetic.saved import Saved
from jacobian.arithmetic.walk import MOST_DEGREE, MOST_PRIME
from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.element import File
from jacobian.errors import ArgumentError, FieldError, Infeasible, flag, shown, whole
from jacobian.fields import QQ
from jacobian.finite.reduction import is_good, suspects

Tell = Callable[[int, int], None]
GENERA = (1, 2, 3)


def l_polynomials(
    C: HyperellipticCurve, bound: int, file: File | None = None, tell: Tell | None = None
) -> LPolynomials:
    """L_p(T) for all p ≤ ``bound`` at which the equation is good (Harvey and Sutherland 2014, 2016).

    C is over QQ, of genus 1, 2 or 3, with any equation; ``bound`` is 2 … 2^24. ``file``: results and state are saved
    there every few seconds, and the same call resumes from it. The file is replaced as a whole, so a run that is killed
    leaves the last state. ``tell(done, all)`` receives numbers of primes. FieldError over other fields, Infeasible for
    other genera and larger bounds.
    """
    bound = _checked(C, bound)
    if C.genus not in GENERA:
        raise Infeasible(
            f"genus {C.genus}: L-polynomials at all primes are those of genus 1, 2 and 3; hasse_witt_matrices(bound) "
            "has them modulo p in any genus"
        )
    F, g = residues.integral_equation(C), C.genus
    good, bad = _reductions(C, bound)
    together = (good > decision.least_prime(g)) & (residues.modulo(2 * residues.exceptions(F, g), good) != 0)
    primes = good[together]
    saved = Saved(file, C, bound, g) if file is not None else None
    found, place = saved.load() if saved else (np.zeros((0, g), np.int64), residues.Place())
    rows = [found]
    for part in residues.parts(F, g, primes, place):
        p = primes[part.first : part.last]
        decided, known = decision.decided(F, g, p, residues.modulo_p(part.matrices, p))
        for at in np.flatnonzero(~known).tolist():
            decided[at] = decision.counted(C, int(p[at]))
        rows.append(decided)
        if saved:
            saved.keep(rows, part.place)
        if tell:
            tell(part.last, len(primes))
    coefficients = np.empty((len(good), g), np.int64)
    coefficients[together] = np.concatenate(rows)
    for at in np.flatnonzero(~together).tolist():
        coefficients[at] = decision.counted(C, int(good[at]))
    for array in (good, coefficients):
        array.flags.writeable = False
    return LPolynomials(C, bound, good, coefficients, tuple(bad))


def with_progress(C: HyperellipticCurve, bound: int, file: File | None = None, progress: bool = False) -> LPolynomials:
    """:func:`l_polynomials`, with a progress bar if ``progress``."""
    if not flag(progress, "progress"):
        return l_polynomials(C, bound, file)
    try:
        from tqdm import tqdm
    except ImportError:
        raise ArgumentError(
            "progress = True: the bar is tqdm's, which is not installed: pip install 'jacobian-integrable[app]'"
        ) from None
    with tqdm(total=None, unit="prime", desc="L-polynomials") as bar:

        def tell(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        found = l_polynomials(C, bound, file, tell)
        # primes counted one by one have not been reported to ``tell``
        tell(len(found.p), len(found.p))
        return found


def hasse_witt_matrices(C: HyperellipticCurve, bound: int) -> tuple[np.ndarray, np.ndarray]:
    """(p, W): odd primes of good reduction up to ``bound``, (K,), and W_p, (K, g, g).

    Entry i, j of W_p is the coefficient of x^(ip−j) in F^((p−1)/2) modulo p. F, of degree at most 120, is h² + 4f times
    the square of a rational number, which does not change the power modulo p. So W_p is the transpose of
    :meth:`jacobian.curve.questions.CurveQuestions.cartier_manin`. Primes p ≤ 2g are left out, and primes that divide
    F(a) or a − b, where a ≠ b are two of the g integers of least size at which F is not 0.
    """
    bound = _checked(C, bound)
    F, g = residues.integral_equation(C), C.genus
    if len(F) - 1 > MOST_DEGREE:
        raise Infeasible(f"deg F = {len(F) - 1}: Hasse–Witt matrices are computed up to degree {MOST_DEGREE}")
    good, _ = _reductions(C, bound)
    primes = good[(good > 2 * g) & (residues.modulo(2 * residues.exceptions(F, g), good) != 0)]
    return primes, residues.hasse_witt(F, g, primes)


def of_curves(curves: Iterable[HyperellipticCurve], bound: int, executor: Executor | None = None) -> Iterator[Any]:
    """Yields :func:`l_polynomials` of many curves, in order. They are computed on an ``executor`` of
    concurrent.futures, such as that of a dask client (``client.get_executor()``), or else one after the other.
    """
    given = [check_curve(C) for C in curves]
    if executor is None:
        yield from (l_polynomials(C, bound) for C in given)
        return
    if not hasattr(executor, "submit"):
        raise ArgumentError(f"executor = {shown(executor)}: a concurrent.futures.Executor is needed")
    for future in [executor.submit(l_polynomials, C, bound) for C in given]:
        yield future.result()


def _checked(C: HyperellipticCurve, bound: int) -> int:
    if C.field != QQ:
        raise FieldError(f"field = {C.field.name}: L-polynomials at all primes are those of a curve over QQ")
    bound = whole(bound, "bound", "the largest prime is an int from 2 on", 2)
    if bound > MOST_PRIME:
        raise Infeasible(f"bound = {shown(bound)}: L-polynomials are computed for primes up to {MOST_PRIME}")
    return bound


def _reductions(C: HyperellipticCurve, bound: int) -> tuple[Any, list[int]]:
    """The primes of good reduction of this equation up to the bound, and the other primes."""
    primes = residues.primes_up_to(bound)
    suspected = primes[residues.modulo(suspects(C), primes) == 0].tolist()
    bad = [p for p in suspected if not is_good(C, p)]
    return primes[~np.isin(primes, bad)], bad
