"""Candidates for a characteristic polynomial, eliminated by random classes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from random import Random
from typing import Any, TypeVar

Candidate = TypeVar("Candidate")
IDLE = 2
"""Rounds without an elimination that end the search: a candidate that a class does not eliminate with probability ½ at
least is one that none does, as its order is a multiple of the exponents. The structures of the groups tell those."""


def alone(
    candidates: list[Candidate], groups: Sequence[tuple[Any, Callable[[Candidate], int]]], rng: Random
) -> Candidate | None:
    """The only candidate whose order annihilates random classes of each group.

    ``groups``: Jacobians with the order that a candidate gives them. The right candidate is never eliminated, so one
    that is alone is proven. None where IDLE rounds, of a class of each group, have left several.
    """
    idle = 0
    while len(candidates) > 1 and idle < IDLE:
        before = len(candidates)
        for J, order in groups:
            D = J.random(rng)
            candidates = [candidate for candidate in candidates if not order(candidate) * D]
        idle = 0 if len(candidates) < before else idle + 1
    return candidates[0] if len(candidates) == 1 else None
