"""Compiled functions, callable from Python."""

from __future__ import annotations

import logging
import struct
import threading
from collections.abc import Callable, Mapping
from ctypes import addressof, c_char
from hashlib import sha256
from types import MappingProxyType
from typing import Any

import numpy as np

from jacobian.native import kept, machine
from jacobian.native.direct import Method, Objects
from jacobian.native.kinds import COMPLEX, LONG, WIDE, TupleKind, Value, form_of
from jacobian.native.program import Program
from jacobian.native.special import SPECIAL
from jacobian.numbers.compiler import say_once

LOG = logging.getLogger(__name__)

from_buffer = c_char.from_buffer


class Library:
    """Functions that are compiled together, at the first call of any of them.

    ``functions`` maps each entry's name to the function and the kinds of its arguments. ``library.name(…)`` calls it.
    ``special``, in addition to :data:`jacobian.native.special.SPECIAL`, maps functions to instructions that replace
    them. Sums in ``fast`` functions may be reordered. LLVM vectorises a loop only if the functions that it calls are
    inlined. So functions whose loops all unroll are inlined, except ``inlined_but``; if that is None, LLVM decides.
    Arrays are NumPy arrays; double-doubles have a last axis (hi, lo). An argument may be :class:`Packed`. Calls
    release Python's lock. The logger of this module reports when a library is not on disk and has to be compiled.
    """

    def __init__(
        self,
        name: str,
        functions: dict[str, tuple[Any, tuple[Any, ...]]],
        special: Mapping[Any, Callable[..., Value | None]] = MappingProxyType({}),
        fast: tuple[Any, ...] = (),
        inlined_but: tuple[Any, ...] | None = None,
    ) -> None:
        self.name, self._functions, self._special, self._fast = name, functions, {**SPECIAL, **special}, fast
        self._inlined_but = inlined_but
        self._lock = threading.Lock()
        self._entries: dict[str, Any] = {}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._functions:
            raise AttributeError(f"{self.name} has no {name}; it has {', '.join(self._functions)}")
        self.load()
        for each, entry in self._entries.items():
            setattr(self, each, entry)
        return self._entries[name]

    def load(self) -> None:
        """Finds the entries on disk, or compiles them."""
        with self._lock:
            if not self._entries:
                self._load()

    def is_kept(self) -> bool:
        """Whether the compiled library is on disk, so that no compilation is needed."""
        folder = kept.place()
        return folder is not None and kept.find(folder, self.name, self._made_for()) is not None

    def _made_for(self) -> str:
        """The key of the library's object on disk. It depends on this machine and on the entries with their kinds."""
        entries = {name: (f.__module__, f.__name__, *map(said, kinds)) for name, (f, kinds) in self._functions.items()}
        called = f"{entries} {[f.__name__ for f in self._fast]} {[f.__name__ for f in self._inlined_but or ()]}"
        called += str(self._inlined_but is None)
        return f"{machine.name()} {sha256(called.encode()).hexdigest()}"

    def _load(self) -> None:
        folder, made_for = kept.place(), self._made_for()
        found = None if folder is None else kept.find(folder, self.name, made_for)
        if found is None:
            LOG.info("compiling %s: once, a few seconds", self.name.replace("_", " "))
            found = self._compiled()
            if folder is None:
                say_once()
            else:
                kept.keep(folder, self.name, made_for, found)
        entries = machine.loaded(found.code, tuple(self._functions))
        for name, (_, kinds) in self._functions.items():
            self._entries[name] = (
                Method(entries[name], name, _packing(kinds[:-1]))
                if kinds and isinstance(kinds[-1], Objects)
                else Call(entries[name], kinds, found.results[name])
            )

    def _compiled(self) -> kept.Object:
        program = Program(self._special, self._fast, self._inlined_but)
        results = {}
        for name, (function, kinds) in self._functions.items():
            result = program.entry(name, function, kinds)
            letters = letters_of((result,))
            results[name] = f"({letters})" if isinstance(result, TupleKind) else letters
        modules = program.modules | {str(way.__module__) for way in self._special.values()}
        return kept.Object(results, sorted(modules), program.numbers, machine.object_of(program.text()))


def said(kind: Any) -> str:
    """A kind as text, with the field names of a NamedTuple."""
    if not isinstance(kind, TupleKind):
        return str(kind)
    return f"{getattr(kind.named, '_fields', '')}({', '.join(map(said, kind.items))})"


def _packing(kinds: tuple[Any, ...]) -> Callable[..., bytes]:
    """The function that packs arguments of these kinds."""
    layout, forms = struct.Struct(f"={letters_of(kinds)}"), tuple(map(form_of, kinds))

    def packed(*values: Any) -> bytes:
        words: list[Any] = []
        flatten(values, forms, words)
        return layout.pack(*words)

    return packed


class Packed:
    """An argument packed into the words of a call, once for many calls; ``value`` is the original."""

    __slots__ = ("value", "words")

    def __init__(self, value: Any, kind: Any) -> None:
        self.value = value
        self.words: list[Any] = []
        flatten((value,), (form_of(kind),), self.words)

    def __getitem__(self, index: int) -> Any:
        return self.value[index]


class Call:
    """A compiled entry of a library, callable from Python."""

    def __init__(self, entry: machine.Entry, kinds: tuple[Any, ...], result: str) -> None:
        self.entry, self._kinds, self._forms, back = entry, kinds, tuple(map(form_of, kinds)), result.strip("()")
        self._in, self._out = struct.Struct(f"={letters_of(kinds)}"), struct.Struct(f"={back}")
        self._size, self._tuple = self._in.size + self._out.size, result != back
        self._longs = LETTERS["i128"] in back

    def __call__(self, *arguments: Any) -> Any:
        words: list[Any] = []
        flatten(arguments, self._forms, words)
        memory = bytearray(self._size)
        self._in.pack_into(memory, 0, *words)
        self.entry.call(addressof(from_buffer(memory)))
        found = self._out.unpack_from(memory, self._in.size)
        if self._longs:
            found = tuple([int.from_bytes(x, "little") if type(x) is bytes else x for x in found])
        return found if self._tuple else found[0] if found else None


LETTERS = {"i64": "q", "double": "d", "i1": "q", "ptr": "Q", "i128": "16s"}


def letters_of(kinds: tuple[Any, ...]) -> str:
    """The letters of :mod:`struct` for the scalars of values of these kinds."""
    return "".join(LETTERS[leaf] for kind in kinds for leaf in kind.leaves)


def flatten(values: Any, forms: tuple[tuple[Any, ...], ...], words: list[Any]) -> None:
    """Appends the words of values to ``words``; ``forms`` are their :func:`~jacobian.native.kinds.form_of`."""
    for value, (kind, dtype, axes, items) in zip(values, forms, strict=True):
        if type(value) is Packed:
            words += value.words
        elif dtype is not None:
            # arrays are the most common arguments, and this check takes much of the time of a short call
            if (value.dtype is not dtype and value.dtype != dtype) or value.ndim != axes:
                raise _unfit(value, kind)
            try:
                # this raises if the array is not C-contiguous
                words.append(addressof(from_buffer(value)))
            except (TypeError, ValueError):
                words.append(_unwritten(value, kind))
            if axes == 1:
                words.append(len(value))
            else:
                words += value.shape if axes == kind.ndim else value.shape[: kind.ndim]
        elif items is not None:
            flatten(value, items, words)
        elif type(kind) is TupleKind or kind is WIDE:
            words += value
        elif kind is COMPLEX:
            words += (value.real, value.imag)
        elif kind is LONG:
            words.append(value.to_bytes(16, "little"))
        else:
            words.append(value)


def _unwritten(array: np.ndarray, kind: Any) -> int:
    """The address of an array that is empty or read-only, which ``from_buffer`` rejects."""
    if not array.flags.c_contiguous:
        raise _unfit(array, kind)
    return int(array.ctypes.data)


def _unfit(array: np.ndarray, kind: Any) -> TypeError:
    return TypeError(f"{array.dtype} array {array.shape}: {kind} is needed, C-contiguous")


__all__ = ["Library", "Packed"]
