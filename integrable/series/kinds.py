"""Compiled walks for kinds of systems: the formulas are recorded with symbolic constants and compiled once per machine.

The systems of a kind have the same formulas and differ in their constants, which are arguments of the compiled code.
Compiling takes a tenth of a second, as long as some hundred walks. Compiled objects are stored with those of
:mod:`jacobian.native`. They stay valid until the recorded formulas change.
"""

from __future__ import annotations

import logging
import struct
import threading
from collections.abc import Callable, Sequence
from ctypes import addressof, c_char
from hashlib import sha256
from typing import Any, NamedTuple

import numpy as np

from integrable.series.room import WALKS, Orders, Room
from integrable.series.steps import (
    FINEST,
    SPARE,
    Reached,
    ReachedByMany,
    Steps,
    exhausted,
    inverses,
    step_cost,
    steps_for,
)
from integrable.series.symbols import SymbolField
from integrable.series.tape import Tape, recorded, with_multiples
from integrable.series.walk import COUNTS, RESULTS, WRONG, Codes, Layout, Many, Outputs, Slots
from integrable.series.walk_text import TIMES, module
from jacobian.native import kept, machine
from jacobian.numbers.compiler import interpreted

LOG = logging.getLogger(__name__)
MODULES = [
    f"integrable.series.{name}" for name in ("room", "steps_text", "sums_text", "symbols", "tape", "text", "walk_text")
]
# alignment of memory in bytes, the length of a cache line
LINE = 64
Formula = Callable[[SymbolField, Sequence[Any]], Sequence[object]]
Departure = tuple[Sequence[float], Sequence[float]]
"""The constants and the start of a motion."""


class Formulas(NamedTuple):
    """The formulas of a kind over a field N: ``rates``(N, y) returns the derivatives of all variables y.

    ``start``(N, y) computes all ``variables`` from the first ``shown`` ones, which are q, p and any further parts, each
    of ``half`` numbers.
    """

    rates: Formula
    start: Formula
    shown: int
    variables: int
    half: int


class Near(NamedTuple):
    """The states at those times that were reached, of shape (N, parts, n): q, p and any further parts.

    ``places`` are the indices of these times, None for all times in order. ``error`` estimates the largest error,
    relative to the largest component of q, or of p.
    """

    places: np.ndarray | None
    states: np.ndarray
    error: float

    def lacks(self, count: int) -> bool:
        """Whether some of ``count`` times were not reached."""
        return self.places is not None and len(self.places) < count

    def among(self, order: np.ndarray) -> Near:
        """The same states, with places in a longer list of times, in which these times have the indices ``order``."""
        return self._replace(places=order if self.places is None else order[self.places])


class Kind:
    """The compiled walks of a kind of systems."""

    def __init__(self, name: str, formulas: Formulas) -> None:
        numbers = SymbolField()
        self.count, self.half = formulas.shown, formulas.half
        self.rates: Tape = with_multiples(recorded(lambda y: formulas.rates(numbers, y), formulas.variables))
        self.start: Tape = recorded(lambda y: formulas.start(numbers, y), formulas.shown)
        self._variables = formulas.variables
        said = f"{self.rates} {self.start} {self.count}".encode()
        self.name = f"walk_{name.lower()}_{sha256(said).hexdigest()[:16]}"
        self._lock = threading.Lock()
        self._walks: dict[tuple[Orders, int], Compiled] = {}

    def walk(self, orders: Orders, lanes: int = WALKS) -> Compiled | None:
        """The compiled walk, made on first use unless it is on disk; None where nothing is compiled.

        With ``lanes`` = :data:`integrable.series.room.WIDEST` it computes several motions at once.
        """
        key = orders, lanes
        found = self._walks.get(key)
        if found is None and not interpreted():
            with self._lock:
                found = self._walks.get(key) or self._walks.setdefault(key, self._loaded(orders, lanes))
        return found

    def _loaded(self, orders: Orders, lanes: int) -> Compiled:
        folder, name = kept.place(), f"{self.name}_{orders.wide}_{orders.order}_{lanes}"
        found = None if folder is None else kept.find(folder, name, machine.name())
        room = Room(self.rates, self._variables, orders, lanes)
        if found is None:
            LOG.info("compiling %s, once", self.name.replace("_", " "))
            code = machine.object_of(module(room, self.start, self.count), as_written=True)
            found = kept.Object({}, MODULES, {}, code)
            if folder is not None:
                kept.keep(folder, name, machine.name(), found)
        return Compiled(room, self.count, self.half, machine.loaded(found.code, Codes._fields))

    def walked(self, given: Departure, times: np.ndarray, most: float, tolerance: float | None = None) -> Near:
        """The states at those times that are reached within about ``most`` microseconds, with coarser steps where an
        error of ``tolerance`` is allowed.
        """
        return self.reached(given, times, most, steps_for(tolerance))

    def finished(self, near: Near, given: Departure, times: np.ndarray, most: float) -> Near:
        """``near`` and the states at the remaining times, by finer steps."""
        if near.places is None or not near.lacks(len(times)):
            return near
        left = np.delete(np.arange(len(times)), near.places)
        return self._joined([near, self.reached(given, times[left], most, (FINEST,)).among(left)])

    def reached(self, given: Departure, times: np.ndarray, most: float, plan: Sequence[Steps]) -> Near:
        """The states at times of either sign, in any order, that the steps of ``plan``, tried in turn, reach.

        ``given`` are the constants and the state. A walk is given up if it would take ``most`` more microseconds.
        """
        found = self._in_order(given, times, most, plan)
        if found is not None:
            return found
        parts = []
        for order in (np.flatnonzero(times >= 0), np.flatnonzero(times < 0)):
            order = order[np.argsort(np.abs(times[order]), kind="stable")]
            part = self._in_order(given, times[order], most, plan) if len(order) else None
            if part is not None:
                parts.append(part.among(order))
        return self._joined(parts)

    def _in_order(self, given: Departure, times: np.ndarray, most: float, plan: Sequence[Steps]) -> Near | None:
        """The states at times of one sign in ascending size; None for times in another order.

        ``plan`` has several bounds on the terms of the series, from coarse to fine (``tiers`` of :class:`Steps`). A
        walk with each of them is tried for those times whose states are not known from the walks before.
        """
        parts: list[Near] = []
        left = None
        for steps in plan:
            walk, tier = self.walk(steps.orders) if len(times) else None, 0
            while walk is not None and tier < len(steps.tiers):
                now = times if left is None else times[left]
                found = walk(*given, now, steps, most / walk.step_cost, tier)
                if found.reached < 0:
                    return None
                if found.tier == len(steps.tiers):
                    # the last time is too far for all bounds
                    break
                if left is None and found.reached == len(times) and found.wrong is None:
                    return Near(None, found.states, SPARE * found.gap)
                left = np.arange(len(times)) if left is None else left
                right, given_up = found.right, bool(exhausted(found.reached, len(left), found.lost, found.tier, steps))
                error = SPARE * min(found.gap, steps.tiers[0].agreed)
                parts.append(Near(left[right], found.states[right], error))
                left, tier = np.delete(left, right), found.tier + 1
                if given_up or not len(left):
                    return self._joined(parts)
        return self._joined(parts)

    def _joined(self, parts: Sequence[Near]) -> Near:
        """The states of several walks together. The errors of walks that have found no state do not count."""
        nothing = Near(np.empty(0, dtype=np.int64), np.empty((0, self.count // self.half, self.half)), 0.0)
        had = [part for part in parts if len(part.states)] or [nothing]
        places, states = (np.concatenate(x) for x in zip(*[part[:2] for part in had], strict=True))
        return Near(places, states, max(part.error for part in had))


# the arguments of the compiled :func:`integrable.series.walk.walked` in memory, as 64-bit words; an array is its
# address and its length. SHARED has ``codes``, ``tiers`` and ``layout``, common to all calls with the same steps.
# WORKING has the constants, the state, ``room``, and the arrays ``both`` and ``marks`` of :class:`Outputs`. CALL has
# the times, the states found, the first tier, and the largest number of steps. BACK has the results
SHARED, WORKING, CALL, BACK = map(struct.Struct, ("=5qQqQq8q", "=" + "Qq" * 5, "=QqQqqd", "=qqqdqq"))
ASKED = SHARED.size + WORKING.size
RESULT = ASKED + CALL.size
# the working memory of a walk to at most this many times is kept for later walks
KEPT_TIMES = 512
from_buffer: Any = c_char.from_buffer


class Working:
    """The memory of a walk, its address ``base``, and the binary format ``numbers`` of its constants and state. At the
    position ``marks`` begin the marks of the rows (:class:`integrable.series.walk.Outputs`).

    The part SHARED of the memory has been written for ``steps``, and holds the address of the array ``tiers``.
    """

    steps: Steps | None = None
    tiers: np.ndarray

    def __init__(self, memory: bytearray, base: int, numbers: struct.Struct, marks: int) -> None:
        self.memory, self.base, self.numbers, self.marks = memory, base, numbers, marks


class Compiled:
    """The straight-line code of a kind, loaded into memory, and the arguments of the loop that calls it."""

    def __init__(self, room: Room, count: int, half: int, entries: dict[str, machine.Entry]) -> None:
        from integrable.series.walk_compiled import LIBRARY

        self._entries, self._count, self._shape = entries, count, (count // half, half)
        self.step_cost = step_cost(room.tape, room.orders)
        self.codes = Codes(*(entries[name].address for name in Codes._fields))
        begin = -(-room.size // 8) * 8
        self.spare, self.size = room.lanes * begin, room.lanes * begin + (2 + 2 * count) * TIMES
        self.units = inverses(room.orders.order)
        sizes = half, count // half, room.orders.order, room.begin, room.orders.wide, self.spare, room.apart, room.lanes
        self.layout = Layout(self.units, *sizes)
        self._layout_words = self.units.ctypes.data, len(self.units), *sizes
        self._walked = LIBRARY.walked.entry.call
        self._kept: list[Working] = []

    def __call__(
        self,
        constants: Sequence[float],
        state: Sequence[float],
        times: np.ndarray,
        steps: Steps,
        most: float,
        tier: int = 0,
    ) -> Reached:
        """The states at times of one sign in ascending size that about ``most`` steps reach.

        The walk uses the first bounds of ``steps.tiers``, from the index ``tier`` on, whose ``farthest`` includes the
        last of the times. For times in another order the number of states reached is −1.
        """
        count, found = len(times), np.empty((len(times), *self._shape))
        try:
            working = self._kept.pop() if count <= KEPT_TIMES else self._working(len(constants), count)
        except IndexError:
            working = self._working(len(constants), KEPT_TIMES)
        memory = working.memory
        if working.steps is not steps:
            working.steps, working.tiers = steps, np.array(steps.tiers).reshape(-1)
            words = *self.codes, working.tiers.ctypes.data, len(working.tiers), *self._layout_words
            SHARED.pack_into(memory, 0, *words)
        working.numbers.pack_into(memory, RESULT + BACK.size, *constants, *state)
        there = addressof(from_buffer(times)), count, addressof(from_buffer(found)), found.size
        CALL.pack_into(memory, ASKED, *there, tier, most)
        self._walked(working.base)
        reached, wrong, lost, gap, done, tier = BACK.unpack_from(memory, RESULT)
        off = np.frombuffer(memory, count=reached, offset=working.marks) == WRONG if wrong and reached else None
        if count <= KEPT_TIMES:
            self._kept.append(working)
        return Reached(reached, found, off, lost, gap, done, tier)

    def _working(self, known: int, count: int) -> Working:
        """The working memory of a walk with ``known`` constants and ``count`` times."""
        numbers, compared = struct.Struct(f"={known + self._count}d"), 4 * count * self._count
        here = RESULT + BACK.size
        memory = bytearray(here + numbers.size + LINE + 8 * (self.size + compared + count))
        base = addressof(from_buffer(memory))
        room = here + numbers.size
        room += -(base + room) % LINE
        both = room + 8 * self.size
        marks = both + 8 * compared
        WORKING.pack_into(
            memory, SHARED.size, base + here, known, base + here + 8 * known, self._count, base + room, self.size,
            base + both, compared, base + marks, count,
        )  # fmt: skip
        return Working(memory, base, numbers, marks)

    def of_many(self, many: Many, times: np.ndarray, steps: Steps) -> ReachedByMany:
        """The states of K motions, each at its own times, as :meth:`__call__` returns them for each."""
        from integrable.series.walk_compiled import LIBRARY

        count, slots, width = len(many.most), self.layout.lanes // WALKS, self._count
        longest = int(np.diff(many.ends).max())
        found, marks, results = np.empty((len(times), *self._shape)), np.empty(len(times)), np.empty((count, RESULTS))
        both, room = np.empty(slots * 2 * WALKS * width * longest), np.zeros(self.size + LINE // 8)
        room = room[-room.ctypes.data % LINE // 8 :]
        outputs = Outputs(both, marks, times, found.reshape(-1))
        at_work = Slots(np.full(slots, -1), np.zeros(COUNTS * slots, dtype=np.int64), np.zeros(4 * slots))
        walk = self.codes, np.array(steps.tiers).reshape(-1), self.layout
        LIBRARY.walked_abreast(*walk, many, room, outputs, at_work, results.reshape(-1))
        return ReachedByMany(results, found, marks == WRONG)
