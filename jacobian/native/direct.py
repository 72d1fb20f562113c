"""Entries that Python calls without packing: compiled functions that read Python's ints and tuples themselves.

Packing the arguments of a call into memory takes longer than an addition of words. An entry whose last kind is
:class:`Objects` is a method of CPython instead, which gets its arguments as objects. The leading arguments are the same
in many calls; the method is bound to a bytes object that holds them.
"""

from __future__ import annotations

import ctypes
from math import prod
from typing import Any, NamedTuple

from jacobian.native.kinds import BOOL, INT, INTS, LONG, NONE, ArrayKind, CompileError, TupleKind

BYTES = ArrayKind(INT, stored="uint8")
"""The kind of a bytes object; it may not be written to."""
DECLARED = """\
declare ptr @PyBytes_AsString(ptr)
declare i64 @PyBytes_Size(ptr)
declare ptr @PyByteArray_AsString(ptr)
declare i64 @PyByteArray_Size(ptr)
declare ptr @PyTuple_GetItem(ptr, i64)
declare ptr @PyTuple_New(i64)
declare i32 @PyTuple_SetItem(ptr, i64, ptr)
declare i64 @PyLong_AsLongLong(ptr)
declare ptr @PyLong_FromLongLong(i64)
declare ptr @PyBool_FromLong(i64)
declare i32 @_PyLong_AsByteArray(ptr, ptr, i64, i32, i32, i32)
declare ptr @_PyLong_FromByteArray(ptr, i64, i32, i32)
declare ptr @PyErr_Occurred()
declare ptr @PyEval_SaveThread()
declare void @PyEval_RestoreThread(ptr)
"""
_BYTES = "ptr @PyBytes_AsString", "i64 @PyBytes_Size"
_BYTEARRAY = "ptr @PyByteArray_AsString", "i64 @PyByteArray_Size"
NAMES = tuple(line.split("@")[1].split("(")[0] for line in DECLARED.splitlines())
"""The functions of CPython that the entries call."""
FAST_CALL = 0x80
"""METH_FASTCALL: a method gets an array of its arguments and their number."""


class Scratch(NamedTuple):
    """An array of this kind and shape on the stack of a call: scratch memory that no caller passes."""

    kind: ArrayKind
    shape: tuple[int, ...]

    @property
    def words(self) -> int:
        return self.kind.parts * prod(self.shape)


class Rows(NamedTuple):
    """The kind of a bytearray that holds ``number`` rows of integers, of equal length."""

    number: int
    kind: ArrayKind = ArrayKind(INT, 2)


class Objects(NamedTuple):
    """The kinds of arguments that an entry reads from Python's objects: ints, tuples, bytes objects as :data:`BYTES`,
    bytearrays as integers or :class:`Rows`. For :class:`Scratch` the caller passes nothing.

    With ``unlocked`` a call releases Python's lock, which takes a tenth of a microsecond.
    """

    kinds: tuple[Any, ...]
    unlocked: bool = False

    @property
    def inside(self) -> tuple[Any, ...]:
        """The kinds of the arguments that the compiled function gets."""
        return tuple(kind.kind if isinstance(kind, Scratch | Rows) else kind for kind in self.kinds)


def read(body: Any, kind: Any, there: str) -> list[str]:
    """Writes the instructions that read a Python object; returns its scalars as LLVM operands with their types."""
    if kind is INT:
        return [f"i64 {body.write(f'call i64 @PyLong_AsLongLong(ptr {there})')}"]
    if kind is LONG:
        slot = body.slot("i128")
        body.write(f"call i32 @_PyLong_AsByteArray(ptr {there}, ptr {slot}, i64 16, i32 1, i32 0, i32 1)")
        return [f"i128 {body.write(f'load i128, ptr {slot}, align 8')}"]
    if kind == BYTES:
        begin, size = (body.write(f"call {of}(ptr {there})") for of in _BYTES)
        return [f"ptr {begin}", f"i64 {size}"]
    if kind == INTS or isinstance(kind, Rows):
        begin, size = (body.write(f"call {of}(ptr {there})") for of in _BYTEARRAY)
        if kind == INTS:
            return [f"ptr {begin}", f"i64 {body.write(f'lshr i64 {size}, 3')}"]
        return [f"ptr {begin}", f"i64 {kind.number}", f"i64 {body.write(f'udiv i64 {size}, {8 * kind.number}')}"]
    if not isinstance(kind, TupleKind):
        raise CompileError(f"no {kind} from an object")
    items = [body.write(f"call ptr @PyTuple_GetItem(ptr {there}, i64 {k})") for k in range(len(kind.items))]
    return [part for item, x in zip(kind.items, items, strict=True) for part in read(body, item, x)]


def made(body: Any, kind: Any, parts: list[str]) -> str:
    """Writes the instructions that make the Python object of a value; removes its scalars from ``parts``."""
    if kind is NONE:
        return str(body.write("call ptr @PyBool_FromLong(i64 0)"))
    if isinstance(kind, TupleKind):
        row = str(body.write(f"call ptr @PyTuple_New(i64 {len(kind.items)})"))
        for k, item in enumerate(kind.items):
            body.write(f"call i32 @PyTuple_SetItem(ptr {row}, i64 {k}, ptr {made(body, item, parts)})")
        return row
    part = parts.pop(0)
    if kind is BOOL:
        return str(body.write(f"call ptr @PyBool_FromLong(i64 {body.write(f'zext i1 {part} to i64')})"))
    if kind is LONG:
        slot = body.slot("i128")
        body.lines.append(f"  store i128 {part}, ptr {slot}, align 8")
        return str(body.write(f"call ptr @_PyLong_FromByteArray(ptr {slot}, i64 16, i32 1, i32 0)"))
    return str(body.write(f"call ptr @PyLong_FromLongLong(i64 {part})"))


def method(body: Any, name: str, instance: Any, head: list[str], given: Objects) -> str:
    """The LLVM text of an entry. ``head`` are the scalars of its first arguments, which ``body`` has already loaded."""
    values, place = list(head), 0
    for kind in given.kinds:
        if isinstance(kind, Scratch):
            body.slots.append(f"  %scratch.{len(values)} = alloca [{kind.words} x i64], align 16")
            values += [f"ptr %scratch.{len(values)}", *(f"i64 {size}" for size in kind.shape)]
            continue
        there = body.write(f"getelementptr ptr, ptr %given, i64 {place}")
        values += read(body, kind, body.write(f"load ptr, ptr {there}, align 8"))
        place += 1
    failed = body.write(f"icmp ne ptr {body.write('call ptr @PyErr_Occurred()')}, null")
    body.lines += [f"  br i1 {failed}, label %failed, label %good", "failed:", "  ret ptr null", "good:"]
    state = body.write("call ptr @PyEval_SaveThread()") if given.unlocked else ""
    parts = list(body.result_of(instance, values))
    if given.unlocked:
        body.lines.append(f"  call void @PyEval_RestoreThread(ptr {state})")
    back = made(body, instance.result, parts)
    head_line = f"define ptr @{name}(ptr %self, ptr %given, i64 %count) nounwind {{"
    # a failed check returns without an exception set, for which Python raises SystemError
    check = [f"  %wrong = icmp ne i64 %count, {place}", "  br i1 %wrong, label %failed, label %counted", "counted:"]
    return "\n".join([head_line, "entry:", *body.slots, *check, *body.lines, f"  ret ptr {back}", "}"])


class _Definition(ctypes.Structure):
    _fields_ = (("name", ctypes.c_char_p), ("call", ctypes.c_void_p), ("flags", ctypes.c_int), ("doc", ctypes.c_char_p))


_new = ctypes.pythonapi.PyCFunction_NewEx
_new.restype, _new.argtypes = ctypes.py_object, [ctypes.POINTER(_Definition), ctypes.py_object, ctypes.c_void_p]


class Method:
    """An entry that reads Python's objects (:class:`Objects`). Called with the leading arguments, it returns a function
    of the other arguments.
    """

    def __init__(self, entry: Any, name: str, packed: Any) -> None:
        self._entry, self._packed = entry, packed
        # every function that a call returns points to this definition, so it lives as long as the process
        self._definition = _Definition(name.encode(), entry.address, FAST_CALL, None)
        _KEPT.append((self._definition, entry))

    def __call__(self, *leading: Any) -> Any:
        return _new(ctypes.byref(self._definition), self._packed(*leading), None)


_KEPT: list[Any] = []
"""Objects kept in memory because functions in use point to them."""
