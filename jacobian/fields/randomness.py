"""Uniform integers from a seeded generator, numpy's or Python's, without importing numpy."""

from __future__ import annotations

from typing import Any

from jacobian.errors import ArgumentError


def random_below(rng: Any, bound: int) -> int:
    """A uniform integer in [0, bound), of any size, from a ``numpy.random.Generator`` or a ``random.Random``."""
    if hasattr(rng, "getrandbits"):
        return int(rng.randrange(bound))
    if not hasattr(rng, "bytes"):
        raise ArgumentError(f"rng = {rng!r}: a seeded numpy.random.Generator or random.Random is needed")
    bits = (bound - 1).bit_length()
    size = (bits + 7) // 8
    excess = 8 * size - bits
    while True:
        value = int.from_bytes(rng.bytes(size), "little") >> excess
        if value < bound:
            return value
