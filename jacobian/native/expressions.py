"""Compiles the expressions of loops to LLVM instructions."""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable, Iterable
from typing import Any

from jacobian.native.code import LANES
from jacobian.native.complexes import METHODS, PARTS
from jacobian.native.kinds import (
    BOOL,
    INT,
    NONE,
    OBJECT,
    ArrayKind,
    CompileError,
    FunctionKind,
    TupleKind,
    Value,
    abreast,
    is_abreast,
    is_number,
    meeting,
    returned_type,
    single,
    together,
)  # fmt: skip
from jacobian.native.operators import BUILTINS, Operators, integer, real

# the literals of a condition that is known at compile time: false, true
KNOWN = ("0", "1")


class Expressions(Operators):
    """Compiles the expressions of one function. ``variables`` maps each name to its kind and its stack slots."""

    def __init__(self, program: Any, function: Any, contract: str) -> None:
        super().__init__(contract)
        self.program, self.source = program, function
        self.variables: dict[str, tuple[Any, list[str]]] = {}
        self.values: dict[str, Value] = {}
        """The arguments of a function whose expression is compiled in place of a call."""
        self.label = "entry"

    def begin(self, label: str) -> None:
        """Starts a basic block, to which the next instructions belong."""
        self.lines.append(f"{label}:")
        self.label = label

    def labels(self, *names: str) -> list[str]:
        """New labels for basic blocks, one for each name."""
        return [f"{name}{self.fresh()[2:]}" for name in names]

    def go(self, label: str) -> None:
        self.lines.append(f"  br label %{label}")

    def condition(self, node: ast.expr) -> str:
        """Whether an expression is true, as an i1."""
        test = self.truth(self.value(node))
        if is_abreast(test.kind):
            raise CompileError("a condition that differs from lane to lane, outside of if")
        return str(test.parts[0])

    def split(self, condition: str, true: str, false: str) -> None:
        self.lines.append(f"  br i1 {condition}, label %{true}, label %{false}")

    def loaded(self, kind: Any, slots: list[str]) -> Value:
        """A value loaded from the slots of its scalars."""
        loads = (self.write(f"load {leaf}, ptr {slot}") for leaf, slot in zip(kind.leaves, slots, strict=True))
        return Value(kind, tuple(loads))

    def keep(self, value: Value, slots: list[str]) -> None:
        """Stores a value in the slots of its scalars."""
        for leaf, part, slot in zip(value.kind.leaves, value.parts, slots, strict=True):
            self.lines.append(f"  store {leaf} {part}, ptr {slot}")

    def joined(self, condition: str, true: ast.expr, false: ast.expr) -> Value:
        """The value of one of two expressions; only the chosen one is computed."""
        yes, no, end = self.labels("yes", "no", "end")
        self.split(condition, yes, no)
        values, ends = [], []
        for label, expression in ((yes, true), (no, false)):
            self.begin(label)
            values.append(self.value(expression))
            ends.append((len(self.lines), self.label))
        kind = meeting(values[0].kind, values[1].kind)
        casts = self.lines
        second = self.cast(values[1], kind)
        self.go(end)
        # the cast and the jump of the first branch belong before the second block
        tail, self.lines = casts[ends[0][0] :], casts[: ends[0][0]]
        first = self.cast(values[0], kind)
        self.go(end)
        self.lines += tail
        self.begin(end)
        parts = tuple(
            self.write(f"phi {leaf} [{p}, %{ends[0][1]}], [{q}, %{ends[1][1]}]")
            for leaf, p, q in zip(kind.leaves, first.parts, second.parts, strict=True)
        )
        return Value(kind, parts)

    def value(self, node: ast.expr) -> Value:
        place = self.place(node)
        if place is not None:
            return self.loaded(*place)
        return self.compiler_of("of", node)(node)

    def compiler_of(self, prefix: str, node: ast.AST) -> Callable[..., Any]:
        """The method that compiles this class of nodes, of_name or do_if for example."""
        name = type(node).__name__
        found = getattr(self, f"{prefix}_{name.lower()}", None)
        if found is None:
            raise CompileError(f"{name} is not compiled")
        return found

    def place(self, node: ast.expr) -> tuple[Any, list[str]] | None:
        """(kind, slots) of a variable, or of a part of it whose index is known at compile time; None otherwise."""
        if isinstance(node, ast.Name):
            return self.variables.get(node.id)
        if isinstance(node, ast.Attribute) and (place := self.place(node.value)) is not None:
            kind, slots = place
            if isinstance(kind, TupleKind) and kind.has(node.attr):
                kind, begin, end = kind.place(kind.field(node.attr))
                return kind, slots[begin:end]
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
            place = self.place(node.value)
            if place is not None and isinstance(place[0], TupleKind):
                kind, begin, end = place[0].place(node.slice.value)  # type: ignore[arg-type]
                return kind, place[1][begin:end]
        return None

    def of_name(self, node: ast.Name) -> Value:
        if node.id in self.values:
            return self.values[node.id]
        return self.outside(self.program.looked_up(sys.modules[self.source.__module__], node.id))

    def outside(self, thing: Any) -> Value:
        """The :class:`Value` of a Python object known at compile time."""
        if isinstance(thing, bool):
            return Value(BOOL, ("1" if thing else "0",))
        if isinstance(thing, int):
            return integer(thing)
        if isinstance(thing, float):
            return real(thing)
        return Value(OBJECT, (thing,))

    def of_constant(self, node: ast.Constant) -> Value:
        return Value(NONE, ()) if node.value is None else self.outside(node.value)

    def of_tuple(self, node: ast.Tuple) -> Value:
        return together(self.items(node.elts))

    def items(self, nodes: list[ast.expr]) -> list[Value]:
        """The values of expressions; starred ones are unpacked."""
        values = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                row = self.value(node.value)
                values += [row.item(i) for i in range(len(row.kind.items))]
            else:
                values.append(self.value(node))
        return values

    def of_binop(self, node: ast.BinOp) -> Value:
        return self.binary(type(node.op).__name__, self.value(node.left), self.value(node.right))

    def of_unaryop(self, node: ast.UnaryOp) -> Value:
        x = self.value(node.operand)
        if isinstance(node.op, ast.USub):
            return self.negative(x)
        if isinstance(node.op, ast.Not):
            return self.logical("xor", self.truth(x), Value(BOOL, ("1",)))
        raise CompileError(f"{type(node.op).__name__} is not compiled")

    def of_compare(self, node: ast.Compare) -> Value:
        left, found = self.value(node.left), []
        for op, right in zip(node.ops, map(self.value, node.comparators), strict=True):
            found.append(self.related(op, left, right))
            left = right
        return self.logical("and", *found)

    def related(self, op: ast.cmpop, left: Value, right: Value) -> Value:
        if not isinstance(op, ast.In):
            return self.compare(type(op).__name__, left, right)
        if not isinstance(right.kind, TupleKind):
            raise CompileError(f"in of {right.kind}")
        same = (self.compare("Eq", left, right.item(i)) for i in range(len(right.kind.items)))
        return self.logical("or", Value(BOOL, ("0",)), *same)

    def of_boolop(self, node: ast.BoolOp) -> Value:
        *others, last = node.values
        both, end = isinstance(node.op, ast.And), self.labels("end")[0]
        ways: list[tuple[str, str]] = []
        for other in others:
            on = self.labels("on")[0]
            condition = self.condition(other)
            ways.append(("0" if both else "1", self.label))
            self.split(condition, *((on, end) if both else (end, on)))
            self.begin(on)
        ways.append((self.condition(last), self.label))
        self.go(end)
        self.begin(end)
        return Value(BOOL, (self.write("phi i1 " + ", ".join(f"[{x}, %{label}]" for x, label in ways)),))

    def of_ifexp(self, node: ast.IfExp) -> Value:
        test = self.truth(self.value(node.test))
        if test.parts[0] in KNOWN:
            return self.value(node.body if test.parts[0] == "1" else node.orelse)
        if not is_abreast(test.kind):
            return self.joined(test.parts[0], node.body, node.orelse)
        yes, no = self.value(node.body), self.value(node.orelse)
        kind = abreast(meeting(yes.kind, no.kind))
        return self.blended(test.parts[0], self.cast(yes, kind), self.cast(no, kind))

    def of_attribute(self, node: ast.Attribute) -> Value:
        x = self.value(node.value)
        if x.kind is OBJECT:
            return self.outside(self.program.looked_up(x.parts[0], node.attr))
        if isinstance(x.kind, ArrayKind) and node.attr == "shape":
            return Value(TupleKind((INT,) * x.kind.ndim), x.parts[1:])
        if is_number(x.kind) and node.attr in PARTS:
            return PARTS[node.attr](self, x)
        if not isinstance(x.kind, TupleKind):
            raise CompileError(f"attribute {node.attr} of {x.kind}")
        if not x.kind.has(node.attr) and hasattr(x.kind.named, node.attr):
            return self.outside(self.program.of_class(x.kind.named, node.attr))
        return x.item(x.kind.field(node.attr))

    def of_subscript(self, node: ast.Subscript) -> Value:
        row = self.value(node.value)
        if isinstance(node.slice, ast.Slice):
            return self.slice_of(row, node.slice)
        if isinstance(row.kind, ArrayKind):
            if row.kind.ndim == 2 and not isinstance(node.slice, ast.Tuple):
                place = self.binary("Mult", self.value(node.slice), Value(INT, (row.parts[2],)))
                row_there = self.offset(row, place).parts[0]
                return Value(ArrayKind(row.kind.item, 1, row.kind.parts), (row_there, row.parts[2]))
            return self.element(row, self.address(row, node.slice))
        index = self.value(node.slice)
        if row.kind is OBJECT:
            # the key of a dictionary is known at compile time
            return self.outside(row.parts[0][index.known() if index.kind is INT else index.parts[0]])
        if not isinstance(row.kind, TupleKind):
            raise CompileError(f"an item of {row.kind}")
        if index.is_known:
            return row.item(index.known())
        # with a variable index, all items are converted to the kind of the first
        found, choose = row.item(0), self.chosen
        if is_abreast(index.kind):
            found, choose = self.cast(found, abreast(found.kind)), self.blended
        for k in range(1, len(row.kind.items)):
            same = self.compare("Eq", index, integer(k)).parts[0]
            found = choose(same, self.cast(row.item(k), found.kind), found)
        return found

    def address(self, row: Value, index: ast.expr) -> Value:
        """The pointer to an item of an array; a vector of pointers if the index is a vector."""
        indices = [self.value(x) for x in (index.elts if isinstance(index, ast.Tuple) else [index])]
        if len(indices) != row.kind.ndim or any(single(x.kind) is not INT for x in indices):
            raise CompileError(f"{len(indices)} indices of an array of {row.kind.ndim} axes, integers are needed")
        place = indices[0]
        for x, size in zip(indices[1:], row.parts[2:], strict=True):
            place = self.binary("Add", self.binary("Mult", place, Value(INT, (size,))), x)
        return self.offset(row, place)

    def offset(self, row: Value, place: Value) -> Value:
        """The pointer to an item of a flat array."""
        if place.is_known and place.known() < 0:
            raise CompileError("negative indices of arrays are not compiled")
        place = self.binary("Mult", place, integer(row.kind.parts))
        index = f"{place.kind.leaves[0]} {place.parts[0]}"
        return Value(
            place.kind, (self.write(f"getelementptr inbounds {row.kind.memory}, ptr {row.parts[0]}, {index}"),)
        )

    def element(self, row: Value, address: Value) -> Value:
        """The item of an array at an address."""
        item = row.kind.item
        leaf = item.leaves[0]
        if is_abreast(address.kind):
            return self.gathered([self.element(row, self.lane(address, "ptr", k)) for k in range(LANES)])
        if row.kind.stored:
            memory, longer = row.kind.memory, "sext" if row.kind.dtype.kind == "i" else "zext"
            short = self.write(f"load {memory}, ptr {address.parts[0]}, align {row.kind.dtype.itemsize}")
            return Value(item, (self.write(f"{longer} {memory} {short} to {leaf}"),))
        parts = [self.write(f"load {leaf}, ptr {address.parts[0]}, align 8")]
        if len(item.leaves) == 2:
            beside = self.write(f"getelementptr inbounds {leaf}, ptr {address.parts[0]}, i64 1")
            parts.append(self.write(f"load {leaf}, ptr {beside}, align 8"))
        return Value(item, tuple(parts))

    def lane(self, value: Value, leaf: str, k: int) -> Value:
        """The value in lane k of a vector; ``leaf`` is the type of each of its scalars."""
        parts = (self.write(f"extractelement <{LANES} x {leaf}> {part}, i64 {k}") for part in value.parts)
        return Value(single(value.kind), tuple(parts))

    def gathered(self, lanes: list[Value]) -> Value:
        """One vector value, made from the values of its lanes."""
        parts = []
        for n, leaf in enumerate(lanes[0].kind.leaves):
            row = "poison"
            for k, value in enumerate(lanes):
                row = self.write(f"insertelement <{LANES} x {leaf}> {row}, {leaf} {value.parts[n]}, i64 {k}")
            parts.append(row)
        return Value(abreast(lanes[0].kind), tuple(parts))

    def put(self, row: Value, address: Value, value: Value) -> None:
        """Stores a value as the item of an array at an address."""
        item = row.kind.item
        if is_abreast(address.kind):
            value = self.cast(value, abreast(item))
            for k in range(LANES):
                self.put(row, self.lane(address, "ptr", k), self.lane(value, item.leaves[0], k))
            return
        if meeting(item, value.kind) != item:
            raise CompileError(f"{value.kind} into an array of {item}")
        if row.kind.stored:
            memory, word = row.kind.memory, self.cast(value, item).parts[0]
            short = self.write(f"trunc i64 {word} to {memory}")
            self.lines.append(f"  store {memory} {short}, ptr {address.parts[0]}, align {row.kind.dtype.itemsize}")
            return
        for k, part in enumerate(self.cast(value, item).parts):
            leaf, there = item.leaves[k], address.parts[0]
            there = self.write(f"getelementptr inbounds {leaf}, ptr {there}, i64 1") if k else there
            self.lines.append(f"  store {leaf} {part}, ptr {there}, align 8")

    def slice_of(self, row: Value, part: ast.Slice) -> Value:
        """A slice of a flat array, a view of the same memory; or a tuple's items from an index known when compiling."""
        if isinstance(row.kind, TupleKind) and part.lower is not None and part.upper is None and part.step is None:
            return together([row.item(i) for i in range(self.value(part.lower).known(), len(row.kind.items))])
        if not isinstance(row.kind, ArrayKind) or row.kind.ndim != 1 or part.step is not None:
            raise CompileError("slices are those of flat arrays, without a step")
        size = Value(INT, (row.parts[1],))
        end = size if part.upper is None else self.extremum("Lt", [self.value(part.upper), size])
        begin = integer(0) if part.lower is None else self.value(part.lower)
        return Value(row.kind, (*self.offset(row, begin).parts, self.binary("Sub", end, begin).parts[0]))

    def of_call(self, node: ast.Call) -> Value:
        if isinstance(node.func, ast.Attribute) and (owner := self.value(node.func.value)).kind is not OBJECT:
            # only methods of a number or of a NamedTuple's class are compiled
            if is_number(owner.kind) and node.func.attr in METHODS:
                return METHODS[node.func.attr](self, owner)
            if not isinstance(owner.kind, TupleKind) or owner.kind.named is None or node.keywords:
                raise CompileError(f"{ast.unparse(node)} is not compiled")
            return self.call(self.program.of_class(owner.kind.named, node.func.attr), [owner, *self.items(node.args)])
        called = self.value(node.func)
        known = isinstance(called.kind, FunctionKind)
        if not (known or called.kind is OBJECT) or node.keywords:
            raise CompileError(f"{ast.unparse(node)} is not compiled")
        return self.call(called.kind.thing if known else called.parts[0], self.items(node.args))

    def call(self, thing: Any, arguments: list[Value]) -> Value:
        """The value of a call to a builtin, a NamedTuple or a function to be compiled."""
        if (special := self.program.special.get(thing)) is not None:
            found: Value | None = special(self, *arguments)
            if found is not None:
                return found
        if thing is type:
            return self.outside(arguments[0].kind.named)
        if thing in BUILTINS:
            return BUILTINS[thing](self, *arguments)
        if isinstance(thing, type) and hasattr(thing, "_fields"):
            return together(arguments, thing)
        missing = getattr(thing, "__code__", None) and thing.__code__.co_argcount - len(arguments)
        if missing and 0 < missing <= len(thing.__defaults__ or ()):
            arguments = [*arguments, *map(self.outside, thing.__defaults__[-missing:])]
        arguments = [Value(FunctionKind(x.parts[0]), ()) if x.kind is OBJECT else x for x in arguments]
        if (expression := self.expression_of(thing, arguments)) is not None:
            return self.written_here(thing, expression, arguments)
        instance = self.program.instance(thing, tuple(x.kind for x in arguments))
        operands = (f"{leaf} {part}" for x in arguments for leaf, part in zip(x.kind.leaves, x.parts, strict=True))
        return Value(instance.result, self.result_of(instance, operands))

    def result_of(self, instance: Any, operands: Iterable[str]) -> tuple[str, ...]:
        """Writes the call of a compiled function, an :class:`~jacobian.native.program.Instance`; returns the scalars of
        its result.
        """
        returned, count = returned_type(instance.result), len(instance.result.leaves)
        text = f"call {returned} @{instance.name}({', '.join(operands)})"
        if not count:
            self.lines.append(f"  {text}")
            return ()
        found = self.write(text)
        if count == 1:
            return (found,)
        return tuple(self.write(f"extractvalue {returned} {found}, {k}") for k in range(count))

    def expression_of(self, function: Any, arguments: list[Value]) -> ast.expr | None:
        """The expression that a function of a field's context returns, if it has no other statement; else None."""
        if not arguments or not hasattr(getattr(arguments[0].kind, "named", None), "dot"):
            return None
        *others, last = self.program.tree(function).body
        described = all(isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) for node in others)
        return last.value if described and isinstance(last, ast.Return) else None

    def written_here(self, function: Any, expression: ast.expr, arguments: list[Value]) -> Value:
        """The value of a function's only expression, compiled in place of a call."""
        named = self.program.tree(function).args
        values = {x.arg: value for x, value in zip(named.args, arguments, strict=False)}
        if named.vararg is not None:
            values[named.vararg.arg] = together(arguments[len(named.args) :])
        outside = self.variables, self.values, self.source
        self.variables, self.values, self.source = {}, values, function
        try:
            return self.value(expression)
        finally:
            self.variables, self.values, self.source = outside
