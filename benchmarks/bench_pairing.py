"""Reduced Tate pairings in genus 1 and 2 with m of 20 to 60 bits over GF(p), m² | p − 1; in genus 1 compared with PARI.

For p = A² + 1 a twist of y² = x³ + ax over GF(p) has order A²; for p = 2d² + 1 a twist of y² = x⁵ + ax has order 4d⁴.
They have complex multiplication by i and √−2. m divides A or d. "ms" is the processor time of one pairing once Miller's
loop of genus 1 is compiled. "m·D, ms" is the time of one multiple, with which genus 2 checks that m annihilates D.
"PARI, ms" is PARI's ``elltatepairing`` without the last power (cypari, where it is installed).
"""

from __future__ import annotations

from importlib.util import find_spec
from random import Random
from typing import Any

from benchmarks.curves import least_seconds
from jacobian import GF, HyperellipticCurve
from jacobian.fields.primality import is_prime
from jacobian.finite.miller import COLD

BITS = (20, 29, 60)


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows for each genus and size of m. AssertionError where a pairing is trivial or not bilinear."""
    if not smoke:
        J, m, D, E = _classes(1, BITS[0])
        for _ in range(COLD):
            J.tate_pairing(D, E, m)
    return [_row(genus, bits, 1 if smoke else 9) for genus in (1, 2) for bits in (BITS[:1] if smoke else BITS)]


def _row(genus: int, bits: int, repeats: int) -> dict[str, object]:
    J, m, D, E = _classes(genus, bits)
    value = J.tate_pairing(D, E, m)
    if value == 1 or J.tate_pairing(D, 3 * E, m) != pow(value, 3, J.field.order):
        raise AssertionError(f"the pairing of {D} and {E} is {value}")
    return {
        "genus": genus,
        "bits of m": m.bit_length(),
        "bits of p": J.field.order.bit_length(),
        "ms": 1e3 * least_seconds(lambda: J.tate_pairing(D, E, m), repeats),
        "m·D, ms": 1e3 * least_seconds(lambda: m * D, repeats),
        "PARI, ms": 1e3 * _pari(J, D, E, m, repeats) if genus == 1 and find_spec("cypari") else None,
    }


def _classes(genus: int, bits: int) -> tuple[Any, int, Any, Any]:
    """The Jacobian J, the order m, a class of order m, and a random class."""
    m = next(q for q in range(1 << bits, 2 << bits) if is_prime(q))
    k, p = next((k, p) for k in range(2, 10**6, 2) if is_prime(p := (m * k) ** 2 * genus + 1))
    rng = Random(1)
    for a in range(1, 200):
        J = HyperellipticCurve(GF(p), [0, a, 0, 1] if genus == 1 else [0, a, 0, 0, 0, 1]).jacobian()
        for _ in range(9):
            D = k * J.random(rng)
            if D and not m * D:
                return J, m, D, J.random(rng)
    raise AssertionError(f"no twist over GF({p}) has classes of order {m}")


def _pari(J: Any, D: Any, E: Any, m: int, repeats: int) -> float:
    from cypari import pari

    curve = pari.ellinit([J.curve.f[1], 0], J.field.order)
    points = [[-X.u[0] % J.field.order, X.v[0] if X.v else 0] for X in (D, E)]
    return least_seconds(lambda: [pari.elltatepairing(curve, *points, m) for _ in range(100)], repeats) / 100
