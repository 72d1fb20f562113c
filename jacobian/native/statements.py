"""Statements of compiled loops, and whole functions."""

from __future__ import annotations

import ast
from typing import Any

from jacobian.native.code import LANES
from jacobian.native.expressions import KNOWN, Expressions
from jacobian.native.kinds import (
    BOOL,
    INT,
    NONE,
    OBJECT,
    ArrayKind,
    CompileError,
    TupleKind,
    Value,
    abreast,
    is_abreast,
    meeting,
    returned_type,
)  # fmt: skip
from jacobian.native.operators import integer
from jacobian.numbers.abreast import abreast as rounds_abreast


class _Wider(Exception):
    """Raised when a name must hold a wider kind than its first value has."""


class Statements(Expressions):
    """Compiles one function for given argument kinds; ``result`` is the kind of its result.

    A name has one kind that holds all its values. If a later value needs a wider kind than the first, compilation
    starts again.

    A condition may differ between SIMD lanes. Then a branch runs if any lane takes it, and changes only the lanes that
    take it. ``mask`` marks these active lanes; None means all.
    """

    def __init__(self, program: Any, function: Any, contract: str) -> None:
        super().__init__(program, function, contract)
        self.kinds: dict[str, Any] = {}
        self.result: Any = None
        self.loops: list[list[str]] = []
        """For each open loop the labels to which continue and break jump. A third entry marks that it contains a break.
        """
        self.open = True
        self.mask: str | None = None
        self.branches = 0
        self.results: list[str] = []
        """The stack slots for the results of the lanes that have returned."""

    def compiled(self, name: str, tree: ast.FunctionDef, kinds: tuple[Any, ...], attributes: str) -> str:
        """The LLVM text of the function ``tree`` for arguments of the given kinds, with LLVM's ``attributes``."""
        names, rest = [x.arg for x in tree.args.args], tree.args.vararg
        if rest is not None:
            names, kinds = [*names, rest.arg], (*kinds[: len(names)], TupleKind(kinds[len(names) :]))
        if len(names) != len(kinds):
            raise CompileError(f"{len(kinds)} arguments, {len(names)} are needed")
        while True:
            self.lines, self.slots, self.variables, self.loops, self.open = [], [], {}, [], True
            self.label, self._count = "entry", 0
            self.mask, self.branches, self.results = None, 0, []
            parameters = []
            try:
                for argument, kind in zip(names, kinds, strict=True):
                    parts = tuple(f"%{argument}.{k}" for k in range(len(kind.leaves)))
                    parameters += [f"{leaf} {part}" for leaf, part in zip(kind.leaves, parts, strict=True)]
                    self.assign_name(argument, Value(kind, parts))
                self.block(tree.body)
                if self.open:
                    self.give_back(Value(NONE, ()))
                if self.results:
                    self.end_of_lanes()
                break
            except _Wider:
                continue
        returned = returned_type(self.result)
        lines = [f"define internal {returned} @{name}({', '.join(parameters)}) {attributes}nounwind {{", "entry:"]
        return "\n".join([*lines, *self.slots, *self.lines, "}"])

    def block(self, body: list[ast.stmt]) -> None:
        """Compiles statements, up to the last reachable one."""
        for node in body:
            if not self.open:
                return
            try:
                self.compiler_of("do", node)(node)
            except CompileError as error:
                if error.args and not str(error).startswith("line "):
                    where = f"line {node.lineno} of {self.source.__module__}.{self.source.__name__}"
                    raise CompileError(f"{where}: {error}") from error
                raise

    def assign_name(self, name: str, value: Value) -> None:
        if value.kind is OBJECT:
            raise CompileError(f"{name}: functions are no values of variables")
        if name == "_":
            # an unused value may be of any kind
            return
        if self.mask is not None and not isinstance(value.kind, ArrayKind):
            value = self.cast(value, abreast(value.kind))
        kind = self.kinds.setdefault(name, value.kind)
        wider = meeting(kind, value.kind)
        if wider != kind:
            self.kinds[name] = wider
            raise _Wider
        if name not in self.variables:
            self.variables[name] = kind, [self.slot(leaf) for leaf in kind.leaves]
        elif self.mask is not None:
            value = self.blended(self.mask, value, self.loaded(*self.variables[name]))
        self.keep(self.cast(value, kind), self.variables[name][1])

    def assign(self, target: ast.expr, value: Value) -> None:
        if isinstance(target, ast.Name):
            self.assign_name(target.id, value)
        elif isinstance(target, ast.Tuple):
            if not isinstance(value.kind, TupleKind) or len(value.kind.items) != len(target.elts):
                raise CompileError(f"{len(target.elts)} names for {value.kind}")
            for i, part in enumerate(target.elts):
                self.assign(part, value.item(i))
        elif isinstance(target, ast.Subscript):
            row = self.value(target.value)
            if not isinstance(row.kind, ArrayKind):
                raise CompileError("items of arrays only are assigned to")
            self.all_lanes("store to an array")
            self.put(row, self.address(row, target.slice), value)
        else:
            raise CompileError(f"{type(target).__name__} on the left of =")

    def do_assign(self, node: ast.Assign) -> None:
        value = self.value(node.value)
        for target in node.targets:
            self.assign(target, value)

    def do_annassign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.assign(node.target, self.value(node.value))

    def do_augassign(self, node: ast.AugAssign) -> None:
        operator = type(node.op).__name__
        if isinstance(node.target, ast.Subscript):
            row = self.value(node.target.value)
            self.all_lanes("store to an array")
            address = self.address(row, node.target.slice)
            self.put(row, address, self.binary(operator, self.element(row, address), self.value(node.value)))
        else:
            self.assign(node.target, self.binary(operator, self.value(node.target), self.value(node.value)))

    def do_expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.value(node.value)

    def do_return(self, node: ast.Return) -> None:
        self.give_back(Value(NONE, ()) if node.value is None else self.value(node.value))

    def give_back(self, value: Value) -> None:
        """Writes the instructions of ``return value``, for the active lanes if only some are active."""
        result = value.kind if self.result is None else meeting(self.result, value.kind)
        if result != self.result:
            first, self.result = self.result is None, result
            if not first:
                raise _Wider
        value = self.cast(value, result)
        self.open = False
        if self.mask is not None:
            self.give_back_lanes(value)
        else:
            self.end(value)

    def end(self, value: Value) -> None:
        """Writes the final instruction, which returns ``value``."""
        returned, row = returned_type(value.kind), " ".join(value.parts)
        if len(value.parts) > 1:
            row = "undef"
            for k, (leaf, part) in enumerate(zip(value.kind.leaves, value.parts, strict=True)):
                row = self.write(f"insertvalue {returned} {row}, {leaf} {part}, {k}")
        self.lines.append(f"  ret {returned} {row}")

    def give_back_lanes(self, value: Value) -> None:
        """Writes a return from the lanes in the mask alone: their results are kept until all lanes have returned."""
        if value.kind is NONE or value.kind != abreast(value.kind):
            self.result = abreast(value.kind)
            raise _Wider
        if self.results:
            value = self.blended(str(self.mask), value, self.loaded(value.kind, self.results))
        else:
            self.results = [self.slot(leaf) for leaf in value.kind.leaves]
        self.keep(value, self.results)

    def end_of_lanes(self) -> None:
        """Writes the block that returns the recorded results of all lanes."""
        self.go("returned")
        self.begin("returned")
        self.end(self.loaded(self.result, self.results))

    def do_if(self, node: ast.If) -> None:
        test = self.truth(self.value(node.test))
        if is_abreast(test.kind):
            self.if_in_lanes(node, test.parts[0])
            return
        if test.parts[0] in KNOWN:
            self.block(node.body if test.parts[0] == "1" else node.orelse)
            return
        yes, no, end = self.labels("then", "else", "end")
        self.split(test.parts[0], yes, no)
        ended = []
        for label, body in ((yes, node.body), (no, node.orelse)):
            self.begin(label)
            self.open = True
            self.block(body)
            if self.open:
                self.go(end)
            ended.append(not self.open)
        self.open = not all(ended)
        if self.open:
            self.begin(end)

    def if_in_lanes(self, node: ast.If, condition: str) -> None:
        """Compiles an if whose condition differs between lanes. Each branch runs if any lane takes it and changes only
        those lanes; lanes that return take no further part.
        """
        bits, outer = abreast(BOOL).leaves[0], self.mask
        other = self.write(f"xor {bits} {condition}, {self.repeat('i1', '1')}")
        left = []
        for lanes, body in ((condition, node.body), (other, node.orelse)):
            mask = lanes if outer is None else self.write(f"and {bits} {lanes}, {outer}")
            run, end = self.labels("lanes", "end")
            self.split(self.some(mask), run, end)
            self.begin(run)
            self.mask, self.open, self.branches = mask, True, self.branches + 1
            self.block(body)
            self.branches -= 1
            if self.open:
                left.append(mask)
            self.go(end)
            self.begin(end)
        self.mask, self.open = outer, bool(left)
        if len(left) == 1:
            if self.loops or self.branches:
                raise CompileError("some lanes return in a loop, or in a branch of some")
            self.mask = left[0]
            (rest,) = self.labels("rest")
            self.split(self.some(self.mask), rest, "returned")
            self.begin(rest)

    def do_pass(self, node: ast.Pass) -> None:
        pass

    def all_lanes(self, what: str) -> None:
        """Raises CompileError if only some lanes are active: ``break``, ``continue`` and stores act on all lanes."""
        if self.mask is not None:
            raise CompileError(f"only some lanes {what}")

    def do_break(self, node: ast.Break) -> None:
        self.all_lanes("leave a round of a loop")
        self.go(self.loops[-1][1])
        self.loops[-1].append("broken")
        self.open = False

    def do_continue(self, node: ast.Continue) -> None:
        self.all_lanes("leave a round of a loop")
        self.go(self.loops[-1][0])
        self.open = False

    def do_while(self, node: ast.While) -> None:
        again, body, end = self.labels("while", "do", "end")
        self.go(again)
        self.begin(again)
        forever = isinstance(node.test, ast.Constant) and bool(node.test.value)
        if forever:
            self.go(body)
        else:
            self.split(self.condition(node.test), body, end)
        self.begin(body)
        self.open = self.around(node.body, again, end) or not forever
        if self.open:
            self.begin(end)

    def around(self, statements: list[ast.stmt], again: str, end: str) -> bool:
        """Compiles the body of a loop, which ``continue`` leaves to the block ``again`` and ``break`` to the block
        ``end``; returns whether it contains a break.
        """
        self.loops.append([again, end])
        self.block(statements)
        if self.open:
            self.go(again)
        self.open = True
        return len(self.loops.pop()) > 2

    def do_for(self, node: ast.For) -> None:
        if isinstance(node.iter, ast.Call) and isinstance(node.iter.func, ast.Name) and node.iter.func.id == "range":
            given = [self.value(x) for x in node.iter.args]
            if self.program.inlines(self.source) and all(isinstance(x, ast.Constant) for x in node.iter.args):
                self.unrolled(node, [integer(i) for i in range(*(x.known() for x in given))])
                return
            start, stop = (integer(0), given[0]) if len(given) == 1 else (given[0], given[1])
            self.counted(node, start, stop, given[2] if len(given) == 3 else integer(1), lambda i: i)
            return
        if isinstance(node.iter, ast.Call) and self.value(node.iter.func).parts == (rounds_abreast,):
            start, stop = map(self.value, node.iter.args)
            self.counted(node, start, stop, integer(LANES), lambda i: self.lanes_from(i, stop))
            return
        row = self.value(node.iter)
        if isinstance(row.kind, ArrayKind) and row.kind.ndim == 1:
            stop = Value(INT, (row.parts[1],))
            self.counted(node, integer(0), stop, integer(1), lambda i: self.element(row, self.offset(row, i)))
            return
        if not isinstance(row.kind, TupleKind):
            raise CompileError(f"a loop over {row.kind}")
        self.unrolled(node, [row.item(i) for i in range(len(row.kind.items))])

    def unrolled(self, node: ast.For, items: list[Value]) -> None:
        """Compiles a loop over known items by writing its body once for each."""
        (end,) = self.labels("end")
        for item in items:
            body, again = self.labels("do", "next")
            self.go(body)
            self.begin(body)
            self.assign(node.target, item)
            self.around(node.body, again, end)
            self.begin(again)
        self.go(end)
        self.begin(end)

    def lanes_from(self, first: Value, stop: Value) -> Value:
        """The vector (first, first + 1, …), one number for each lane; ``stop`` − 1 replaces numbers that exceed it."""
        numbers = ", ".join(f"i64 {k}" for k in range(LANES))
        places = self.binary("Add", first, Value(abreast(INT), (f"<{numbers}>",)))
        return self.extremum("Lt", [places, self.binary("Sub", stop, integer(1))])

    def counted(self, node: ast.For, start: Value, stop: Value, step: Value, item: Any) -> None:
        """Compiles a loop over integers from ``start`` to ``stop``."""
        if any(x.kind is not INT for x in (start, stop, step)):
            raise CompileError("range takes integers")
        counter = [self.slot("i64")]
        self.keep(start, counter)
        check, body, again, end = self.labels("check", "do", "next", "end")
        self.go(check)
        self.begin(check)
        i = self.loaded(INT, counter)
        self.split(self.compare("Lt" if step.known() > 0 else "Gt", i, stop).parts[0], body, end)
        self.begin(body)
        self.assign(node.target, item(i))
        self.around(node.body, again, end)
        self.begin(again)
        self.keep(self.binary("Add", self.loaded(INT, counter), step), counter)
        self.go(check)
        self.begin(end)
