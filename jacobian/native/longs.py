"""Arrays of natural numbers below 2^128, the longs of compiled loops, and their conversion to and from Python ints."""

from __future__ import annotations

from typing import Any

import numpy as np

WORDS = np.dtype([("low", np.uint64), ("high", np.uint64)])
"""The NumPy dtype of a number below 2^128 as two 64-bit words."""


def words_of(numbers: Any) -> Any:
    """Numbers below 2^128 as an array of WORDS of the same shape."""
    flat = np.asarray(numbers, object)
    return np.frombuffer(b"".join([x.to_bytes(16, "little") for x in flat.ravel()]), WORDS).reshape(flat.shape)


def numbers_of(words: Any) -> Any:
    """An array of dtype WORDS as Python ints, of the same shape."""
    return words["low"].astype(object) | words["high"].astype(object) << 64


def pairs(words: Any) -> Any:
    """A view of an array of WORDS as int64 with a last axis (low, high), the form that compiled loops take."""
    return words.view(np.int64).reshape(*words.shape, 2)
