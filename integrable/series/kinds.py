"""Walks of kinds of systems, from formulas that are recorded with symbolic constants and compiled once per machine.

A kind is a class of systems together with its size and the values on which its formulas branch. The constants of a
system are arguments of the compiled code. Compiling takes a tenth of a second, as long as some hundred walks. Compiled
objects are stored with those of :mod:`jacobian.native`. They stay valid until the recorded formulas change.
"""

from __future__ import annotations

import logging
import struct
import threading
from collections.abc import Callable, Hashable, Sequence
from ctypes import addressof, c_char
from hashlib import sha256
from typing import Any, NamedTuple

import numpy as np

from integrable.series.room import WALKS, Orders, Room
from integrable.series.steps import Reached, ReachedByMany, Steps, bounds_of, inverses, step_cost
from integrable.series.symbols import SymbolField
from integrable.series.tape import Tape, recorded
from integrable.series.walk import WRONG, Bounds, Codes, Layout, Many, Outputs, Slots
from integrable.series.walk_text import TIMES, module
from jacobian.native import kept, machine
from jacobian.numbers.compiler import interpreted

LOG = logging.getLogger(__name__)
MODULES = [
    f"integrable.series.{name}" for name in ("room", "steps_text", "sums_text", "symbols", "tape", "text", "walk_text")
]
ENTRIES = ("start", "series", "ratios", "advance", "dense")
# alignment of memory in bytes, the length of a cache line
LINE = 64


Formula = Callable[[SymbolField, Sequence[Any]], Sequence[object]]


class Formulas(NamedTuple):
    """The formulas of a kind over a field N: ``rates``(N, y) returns the derivatives of all variables y.

    ``start``(N, y) returns all variables from the first ``shown`` ones. These are q, p and further parts, each of
    ``half`` numbers.
    """

    rates: Formula
    start: Formula
    shown: int
    variables: int
    half: int


class Kind:
    """The compiled walks of a kind of systems."""

    def __init__(self, name: str, formulas: Formulas) -> None:
        numbers = SymbolField()
        self.count, self.half = formulas.shown, formulas.half
        self.rates: Tape = recorded(lambda y: formulas.rates(numbers, y), formulas.variables)
        self.start: Tape = recorded(lambda y: formulas.start(numbers, y), formulas.shown)
        self._variables = formulas.variables
        said = f"{self.rates} {self.start} {self.count}".encode()
        self.name = f"walk_{name.lower()}_{sha256(said).hexdigest()[:16]}"
        self._lock = threading.Lock()
        self._walks: dict[tuple[Orders, int], Compiled] = {}

    def walk(self, orders: Orders, lanes: int = WALKS) -> Compiled | None:
        """The compiled walk, made on first use unless it is on disk; None where nothing is compiled.

        With ``lanes`` = :data:`integrable.series.room.WIDEST` it is of several motions at once.
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
        return Compiled(room, self.count, self.half, machine.loaded(found.code, ENTRIES))


# the 64-bit words that all calls with the same steps share: codes, bounds, units with their length, half, parts, order,
# highs, wide, spare, apart, lanes
FIXED = struct.Struct("=5q10dQq8q")
# the words of one call: constants and state with their lengths, the number of steps, then room, times, found, both and
# marks, each with its length. BACK are the words of its result
WORDS, BACK = struct.Struct("=QqQqd" + "Qq" * 5), struct.Struct("=qqdq")
from_buffer: Any = c_char.from_buffer


class Compiled:
    """The straight-line code of a kind, loaded into memory, and the arguments of the loop that calls it."""

    def __init__(self, room: Room, count: int, half: int, entries: dict[str, machine.Entry]) -> None:
        from integrable.series.walk_compiled import LIBRARY

        self._entries, self._count, self._shape = entries, count, (count // half, half)
        self.step_cost = step_cost(room.tape, room.orders)
        self.codes = Codes(*(entries[name].address for name in ENTRIES))
        begin = -(-room.size // 8) * 8
        self.spare, self.size = room.lanes * begin, room.lanes * begin + (2 + 2 * count) * TIMES
        self.units = inverses(room.orders.order)
        sizes = half, count // half, room.orders.order, room.begin, room.orders.wide, self.spare, room.apart, room.lanes
        self.layout = Layout(self.units, *sizes)
        self._layout_words = self.units.ctypes.data, len(self.units), *sizes
        self._walked = LIBRARY.walked.entry.call
        self._fixed: dict[Steps, bytes] = {}

    def __call__(
        self, constants: Sequence[float], state: Sequence[float], times: np.ndarray, steps: Steps, most: float
    ) -> Reached:
        """The states at times of one sign in ascending size; for times in another order the number reached is −1."""
        fixed = self._fixed.get(steps) or self._fixed.setdefault(steps, self._fixed_words(steps))
        count, known, width = len(times), len(constants), self._count
        found, both = np.empty((count, *self._shape)), 4 * count * width
        floats = FIXED.size + WORDS.size + BACK.size
        first = floats + 8 * (known + width) + LINE
        memory = bytearray(first + 8 * (self.size + both + count))
        memory[: FIXED.size] = fixed
        base = addressof(from_buffer(memory))
        struct.pack_into(f"={known + width}d", memory, floats, *constants, *state)
        room = base + first
        room -= room % LINE
        behind = room + 8 * self.size
        marks = behind + 8 * both
        WORDS.pack_into(
            memory, FIXED.size, base + floats, known, base + floats + 8 * known, width, most, room, self.size,
            addressof(from_buffer(times)), count, addressof(from_buffer(found)), found.size, behind, both, marks, count,
        )  # fmt: skip
        self._walked(base)
        reached, wrong, gap, done = BACK.unpack_from(memory, FIXED.size + WORDS.size)
        off = np.frombuffer(memory, count=reached, offset=marks - base) == WRONG if wrong and reached else None
        return Reached(reached, found, off, gap, done)

    def of_many(self, many: Many, times: np.ndarray, steps: Steps) -> ReachedByMany:
        """The states of K motions, each at its own times, as :meth:`__call__` returns them for each."""
        from integrable.series.walk_compiled import LIBRARY

        count, slots, width = len(many.most), self.layout.lanes // WALKS, self._count
        longest = int(np.diff(many.ends).max())
        found, marks, results = np.empty((len(times), *self._shape)), np.empty(len(times)), np.empty((count, 4))
        both, room = np.empty(slots * 2 * WALKS * width * longest), np.zeros(self.size + LINE // 8)
        room = room[-room.ctypes.data % LINE // 8 :]
        outputs = Outputs(times, found.reshape(-1), both, marks)
        at_work = Slots(np.full(slots, -1), np.zeros(8 * slots, dtype=np.int64), np.zeros(4 * slots))
        walk = self.codes, Bounds(*bounds_of(steps)), self.layout
        LIBRARY.walked_abreast(*walk, many, room, outputs, at_work, results.reshape(-1))
        return ReachedByMany(results, found, marks == WRONG)

    def _fixed_words(self, steps: Steps) -> bytes:
        return FIXED.pack(*self.codes, *bounds_of(steps), *self._layout_words)


_KINDS: dict[Hashable, Kind | None] = {}


def kind_of(key: Hashable, made: Callable[[], Kind | None]) -> Kind | None:
    """The kind stored under ``key``; ``made`` creates it at the first call for this key."""
    if key not in _KINDS:
        _KINDS[key] = made()
    return _KINDS[key]
