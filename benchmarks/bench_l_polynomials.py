"""L-polynomials at all primes up to a bound: processor time and its growth, compared with PARI prime by prime.

"PARI, s" is the time of PARI for bounds up to PARI_TO, where cypari is installed. In genus 1 it is that of ``ellap``
at all primes. In higher genus ``hyperellcharpoly`` is timed at one prime of each bit length, and each time is
multiplied by the number of such primes. "growth" is the time for this bound divided by that for a quarter of it.
"memory, MB" is the peak of this process so far. The last rows justify the arithmetic of trees. One compares a product
of two matrices in FLINT with the 75 transforms alone that the product would need. The others compare one walk from 0
with the blocks of a forest.
"""

from __future__ import annotations

import resource
from collections.abc import Callable
from importlib.util import find_spec
from random import Random
from time import process_time
from typing import Any

import numpy as np

from jacobian import QQ, HyperellipticCurve
from jacobian.arithmetic import forest, residues
from jacobian.numbers.threads import set_threads, threads

CURVES = {1: [1, -1, 0, 1], 2: [1, -1, 0, 0, 0, 1], 3: [1, -1, 0, 0, 0, 0, 0, 1]}
BOUNDS = {1: (12, 14, 16, 18, 20), 2: (12, 14, 16, 18, 20), 3: (12, 14, 16, 18)}
PROMISED = {(1, 20): 60.0, (2, 14): 4.0, (2, 16): 12.0, (2, 20): 360.0, (3, 16): 90.0, (3, 18): 600.0}
"""The promised seconds on one processor, by genus and exponent of the bound."""
PARI_TO = 1 << 12
"""The largest bound for PARI in genus 2 and 3. At one prime of 16 bits PARI takes 5 s."""
BITS = 640_000


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows measured on one thread. AssertionError if a time exceeds the promised one, or if PARI disagrees."""
    before = threads()
    set_threads(1)
    try:
        rows = []
        for genus, bounds in BOUNDS.items():
            HyperellipticCurve(QQ, CURVES[genus]).l_polynomials(300)
            last = None
            for exponent in bounds[:1] if smoke else bounds:
                row, last = _bound(genus, exponent, last)
                rows.append(row)
        return [*rows, _matrices(BITS // 20 if smoke else BITS), *_blocks(12 if smoke else 18)]
    finally:
        set_threads(before)


def _seconds(work: Callable[[], Any]) -> tuple[float, Any]:
    begun = process_time()
    found = work()
    return process_time() - begun, found


def _bound(genus: int, exponent: int, last: float | None) -> tuple[dict[str, object], float]:
    C = HyperellipticCurve(QQ, CURVES[genus])
    taken, L = _seconds(lambda: C.l_polynomials(1 << exponent))
    if taken > PROMISED.get((genus, exponent), np.inf):
        raise AssertionError(f"genus {genus}, 2^{exponent}: {taken:.1f} s are more than the promised time")
    row = {
        "what": f"genus {genus}, p ≤ 2^{exponent}",
        "processor, s": taken,
        "growth": taken / last if last else None,
        "PARI, s": _pari(C, L) if find_spec("cypari") else None,
        "memory, MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10,
    }
    return row, taken


def _pari(C: HyperellipticCurve, L: Any) -> float | None:
    if C.genus > 1 and L.bound > PARI_TO:
        return None
    from cypari import pari

    pari.allocatemem(10**9, silent=True)
    if C.genus == 1:
        taken, found = _seconds(lambda: pari(f"E = ellinit([{C.f[1]}, {C.f[0]}]); [ellap(E, p) | p <- {L.p.tolist()}]"))
        if [-int(a) for a in found] != L.coefficients[:, 0].tolist():
            raise AssertionError("PARI's traces are others")
        return taken
    F = "+".join(f"({c})*x^{i}" for i, c in enumerate(residues.integral_equation(C)))
    rng, total, lengths = Random(1), 0.0, np.array([int(p).bit_length() for p in L.p])
    for length in range(3, int(lengths[-1]) + 1):
        primes = L.p[lengths == length].tolist()
        p = rng.choice(primes)
        taken, chi = _seconds(lambda p=p: pari(f"Vec(hyperellcharpoly(Mod(1,{p})*({F})))"))
        if [int(c) for c in chi] != L.polynomial(p):
            raise AssertionError(f"PARI at p = {p}: {chi}, and not {L.polynomial(p)}")
        total += taken * len(primes)
    return total


def _matrices(bits: int) -> dict[str, object]:
    """A row with the times of a product of two 5 × 5 matrices, and of the 75 transforms that would suffice."""
    from flint import fmpz_mat

    from jacobian.finite.product_kernels import kernels
    from jacobian.numbers.convolution import LEAST, PRIMES, Convolutions

    rng = Random(1)
    A, B = (fmpz_mat(5, 5, [rng.getrandbits(bits) for _ in range(25)]) for _ in range(2))
    flint, _ = _seconds(lambda: A * B)
    # coefficients of 40 bits: sums of their products stay below the product of two primes
    length = max(LEAST, 1 << (2 * bits // 40).bit_length() - 1)
    work, values = (
        Convolutions(next(iter(PRIMES)), length, kernels()),
        np.array([float(rng.getrandbits(39)) for _ in range(length)]),
    )
    work.transform(values, length)
    once, _ = _seconds(lambda: [work.transform(values, length) for _ in range(5)])
    own = 75 * once / 5 * 2 / len(work.used)
    return {"what": f"5 × 5 matrices of {bits // 1000} kbit", "processor, s": flint, "transforms alone, s": own}


def _blocks(exponent: int) -> list[dict[str, object]]:
    """Rows with the times of the Hasse–Witt matrices of genus 2, by one walk and by forests."""
    F, rows = CURVES[2], []
    primes = HyperellipticCurve(QQ, F).l_polynomials(1 << exponent).p
    primes = primes[residues.modulo(2 * residues.exceptions(F, 2), primes) != 0]
    for size in (exponent, 15, 14) if exponent > 15 else (exponent, 10):
        taken, _ = _seconds(lambda size=size: residues.hasse_witt(F, 2, primes, 1 << size))
        name = "one walk" if size == exponent else f"blocks of 2^{size}, trees of {forest.TREE}"
        rows.append({"what": f"matrices, genus 2, p ≤ 2^{exponent}: {name}", "processor, s": taken})
    return rows
