"""Compiles every kernel beforehand, into numba's cache on disk: ``python -m jacobian compile``.

numba keeps compiled code in ``__pycache__`` beside the source, or in the directory named by NUMBA_CACHE_DIR, for this
version of the code, of numba and of Python and for this processor. A kernel that is not there is compiled at its first
use.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from time import perf_counter

from jacobian.batch import DivisorArray
from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields import CC, GF, QQ, RR, Field

QUINTIC, SEXTIC, SEPTIC = [1, 0, 0, 0, 0, 1], [1, 1, 0, 0, 0, 0, 1], [1, 1, 0, 0, 0, 0, 0, 1]
# h in characteristic 2, by the degree of f
WITH_H = {5: [1], 6: [1, 1, 0, 1]}


def single_curves() -> dict[str, HyperellipticCurve]:
    """One curve for each kernel of single classes, by the name of the kernel."""
    word, binary, odd = GF(2**61 - 1), GF(2, 2, (1, 1, 1)), GF(3, 2, (2, 2, 1))
    return {
        "GF(p), p < 2^63, any genus": HyperellipticCurve(word, [1, 1, 0, 1]),
        "GF(p), p < 2^63, genus 2, degree 5": HyperellipticCurve(word, QUINTIC),
        "GF(p), p < 2^63, genus 2, degree 6": HyperellipticCurve(word, SEXTIC),
        "GF(p), p < 2^63, genus 3, degree 7": HyperellipticCurve(word, SEPTIC),
        "GF(2^k), k ≤ 16, any genus": HyperellipticCurve(binary, [1, 1, 0, 1], [1]),
        "GF(2^k), k ≤ 16, genus 2, degree 5": HyperellipticCurve(binary, QUINTIC, WITH_H[5]),
        "GF(2^k), k ≤ 16, genus 2, degree 6": HyperellipticCurve(binary, SEXTIC, WITH_H[6]),
        "GF(p^k) ≤ 2^16, p odd, any genus": HyperellipticCurve(odd, [1, 1, 0, 2]),
        "GF(p^k) ≤ 2^16, p odd, genus 2, degree 5": HyperellipticCurve(odd, QUINTIC),
        "GF(p^k) ≤ 2^16, p odd, genus 2, degree 6": HyperellipticCurve(odd, SEXTIC),
    }


def batch_curves() -> dict[str, HyperellipticCurve]:
    """One curve for each family of kernels of arrays, likewise."""
    fields = {
        "p < 2^29": GF(10007),
        "p < 2^31": GF(2**31 - 1),
        "p < 2^61": GF(2**61 - 1),
        "p < 2^63": GF(2**63 - 25),
        "GF(2^k), k ≤ 16": GF(2, 2, (1, 1, 1)),
        "GF(p^k) ≤ 2^16, p odd": GF(3, 2, (2, 2, 1)),
    }
    return {
        f"{name}, degree {len(f) - 1}": HyperellipticCurve(K, f, WITH_H[len(f) - 1] if K.characteristic == 2 else ())
        for name, K in fields.items()
        for f in ((QUINTIC, SEXTIC) if K.characteristic in (2, 3) else (QUINTIC, SEXTIC, SEPTIC))
    }


def two_word_curves() -> dict[str, HyperellipticCurve]:
    """One curve for each kernel of two-word arithmetic, for single classes and for arrays."""
    fields = {
        "GF(p), p < 2^128": GF(2**127 - 1),
        "GF(2^n), 16 < n < 64": GF(2, 17, [1, 0, 0, 1, *[0] * 13, 1]),
        "GF(2^n), n < 128": GF(2, 127, [1, 1, *[0] * 125, 1]),
    }
    curves = {
        f"{name}, genus 2, degree {len(f) - 1}": HyperellipticCurve(
            K, f, WITH_H[len(f) - 1] if K.characteristic == 2 else ()
        )
        for name, K in fields.items()
        for f in (QUINTIC, SEXTIC)
    }
    return curves | {"GF(p), p < 2^128, genus 3, degree 7": HyperellipticCurve(GF(2**127 - 1), SEPTIC)}


def float_curves() -> dict[str, HyperellipticCurve]:
    """One curve for each kernel of arrays of floats and of complex numbers."""
    fields: dict[str, Field] = {"floats": RR, "complex numbers": CC}
    return {
        f"{name}, degree {len(f) - 1}": HyperellipticCurve(K, f)
        for name, K in fields.items()
        for f in (QUINTIC, SEXTIC)
    }


def order_curves() -> dict[str, HyperellipticCurve]:
    """A curve whose Cartier–Manin matrix takes the kernels of large primes."""
    return {"GF(p), p > 2^20": HyperellipticCurve(GF(1_048_583), QUINTIC)}


def rational_curves() -> dict[str, HyperellipticCurve]:
    """A curve over QQ, all primes of which take the same kernels."""
    return {"QQ": HyperellipticCurve(QQ, QUINTIC)}


def single(C: HyperellipticCurve) -> None:
    """Compiles the kernels of single classes on C, or finds them in the cache."""
    J = C.jacobian()
    J.compile()
    D = J.random(Random(1))
    3 * D + D


def batch(C: HyperellipticCurve) -> None:
    """The same for arrays."""
    J = C.jacobian()
    D = J.random(Random(1))
    A = DivisorArray.stack([D, J.zero(), 2 * D])
    B = DivisorArray.from_arrays(J, A.u, A.v, A.n)
    A + B[::-1], -A, A.double(), 3 * A, A * [1, 2, 3], A.sum(), J.random(Random(1), size=2)


def order(C: HyperellipticCurve) -> None:
    """The same for the order of the group."""
    C.cartier_manin()


def all_primes(C: HyperellipticCurve) -> None:
    """The same for L-polynomials at all primes."""
    C.l_polynomials(100)


def compile_all() -> Iterator[tuple[str, float]]:
    """Compiles the kernels one after the other: (name, seconds) for each; a kernel in the cache takes tenths of a
    second.
    """
    families = (
        ("single", single, single_curves),
        ("single", single, two_word_curves),
        ("arrays", batch, batch_curves),
        ("arrays", batch, two_word_curves),
        ("arrays", batch, float_curves),
        ("orders", order, order_curves),
        ("all primes", all_primes, rational_curves),
    )
    for family, action, curves in families:
        for name, C in curves().items():
            begun = perf_counter()
            action(C)
            yield f"{family}: {name}", perf_counter() - begun
