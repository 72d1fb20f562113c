"""Candidates for a characteristic polynomial that fall by random classes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from random import Random
from typing import Any, TypeVar

Candidate = TypeVar("Candidate")
DRAWS = 20


def alone(
    candidates: list[Candidate], groups: Sequence[tuple[Any, Callable[[Candidate], int]]], rng: Random
) -> Candidate | None:
    """The candidate that is left when those go whose order does not annihilate a random class of each group.

    ``groups``: Jacobians with the order that a candidate gives them. The right one among them never goes, so that one
    alone is proven; None where several stay for DRAWS classes.
    """
    for _ in range(DRAWS):
        for J, order in groups:
            if len(candidates) == 1:
                return candidates[0]
            D = J.random(rng)
            candidates = [candidate for candidate in candidates if not order(candidate) * D]
    return None
