"""Which way a flow has taken to its states: read from what it has built, for a study's tables."""

from __future__ import annotations

from typing import Any

__all__ = ["WAYS", "clock_of"]

WAYS = {
    "_precise": "more digits",
    "_symmetric": "closed form",
    "_torus": "torus",
    "_stepped": "steps",
    "_clock": "steps",
}
"""Parts of a flow that are built when they are needed, and what a study calls them; the first that is there counts."""


def clock_of(flow: Any) -> str:
    """The way a flow came to its states: a name of :data:`WAYS`, or "none" where no clock is needed."""
    return next((name for part, name in WAYS.items() if vars(flow).get(part)), "none")
