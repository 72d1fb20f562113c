"""Uniform integers from a seeded generator, numpy's or Python's, without importing numpy."""

from __future__ import annotations

from typing import Any

from jacobian.element import Rng
from jacobian.errors import ArgumentError, shown


def check_rng(rng: Rng) -> Any:
    """``rng``; ArgumentError if it is neither a numpy Generator nor a random.Random."""
    # random.Random has getrandbits, numpy's generators have bytes
    known = hasattr(rng, "random") and (hasattr(rng, "getrandbits") or hasattr(rng, "bytes"))
    if not known or isinstance(rng, type):
        raise ArgumentError(f"rng = {shown(rng)}: a seeded numpy.random.Generator or random.Random is needed")
    return rng


def random_float(rng: Rng) -> float:
    """A random float, uniform in [−2, 2)."""
    return 4.0 * float(check_rng(rng).random()) - 2.0


def random_below(rng: Rng, bound: int) -> int:
    """A uniform integer in [0, bound), of any size, from a ``numpy.random.Generator`` or a ``random.Random``."""
    source = check_rng(rng)
    if hasattr(source, "getrandbits"):
        return int(source.randrange(bound))
    bits = (bound - 1).bit_length()
    size = (bits + 7) // 8
    excess = 8 * size - bits
    while True:
        value = int.from_bytes(source.bytes(size), "little") >> excess
        if value < bound:
            return value
