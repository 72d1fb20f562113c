"""Candidates for a characteristic polynomial, eliminated by random classes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from random import Random
from typing import Any, TypeVar

Candidate = TypeVar("Candidate")
IDLE = 2
"""The search ends after this many rounds without an elimination. If some class eliminates a candidate, a random class
does so with probability at least ½. If no class does, the candidate's order is a multiple of the exponents of all
groups, and :func:`jacobian.finite.search.search` compares it with their structures."""


def alone(
    candidates: list[Candidate], groups: Sequence[tuple[Any, Callable[[Candidate], int]]], rng: Random
) -> Candidate | None:
    """The only candidate whose order annihilates random classes of each group.

    ``groups``: Jacobians, each with the function from a candidate to its order. The right candidate is never
    eliminated, so the last one left is proven. None if several are left after IDLE rounds without an elimination; a
    round takes one class of each group.
    """
    idle = 0
    while len(candidates) > 1 and idle < IDLE:
        before = len(candidates)
        for J, order in groups:
            D = J.random(rng)
            candidates = [candidate for candidate in candidates if not order(candidate) * D]
        idle = 0 if len(candidates) < before else idle + 1
    return candidates[0] if len(candidates) == 1 else None
