"""Arrays of natural numbers below 2^128, the longs of compiled loops, and their conversion to and from Python ints."""

from __future__ import annotations

from typing import Any

import numpy as np

WORDS = np.dtype([("low", np.uint64), ("high", np.uint64)])
"""A number of two words."""


def words_of(numbers: Any) -> Any:
    """Numbers below 2^128 as an array of WORDS of the same shape."""
    flat = np.asarray(numbers, object)
    return np.frombuffer(b"".join([x.to_bytes(16, "little") for x in flat.ravel()]), WORDS).reshape(flat.shape)


def numbers_of(words: Any) -> Any:
    """The ints of an array of WORDS."""
    return words["low"].astype(object) | words["high"].astype(object) << 64


def pairs(words: Any) -> Any:
    """The same memory in the form that compiled loops take, with a last axis of two words."""
    return words.view(np.int64).reshape(*words.shape, 2)
