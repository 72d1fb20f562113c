"""Messages of errors write arguments and their parts by ``shown`` or ``written``, which cannot fail.

``str`` of an int of more than 4300 digits raises Python's own ValueError, and a message must not be a page long. A name
counts as an argument if a parameter of this name may be a number, or if it is computed from an argument by arithmetic
or by functions that check and read numbers. Attributes count as arguments too, unless they are listed below.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from tests.test_architecture import modules, tree

# functions that write numbers of any size, and those that return small numbers
WRITERS = {
    "shown",
    "written",
    "_missing",
    "_show",
    "_shown",
    "shortened",
    "len",
    "np.shape",
    "poly.text",
    "text",
    "suggestion",
}
# common names of small numbers and of parts of messages
NAMES = {"digits", "i", "k", "most", "name", "argument", "wanted", "width"}
# annotations of types that are no numbers, or whose own text shortens large numbers
TEXTS = {
    "Ball", "Body", "Divisor", "Exception", "FormalSum", "GroupLaw", "HyperellipticCurve", "Jacobian",
    "JacobianError", "KummerSurface", "Path", "RayClass", "Step", "System", "bool", "date", "str",
}  # fmt: skip
# attributes that are small or shorten their own text: names, kinds, values checked when the object was made
SMALL = {
    "__name__", "_digits", "_full", "at", "attr", "characteristic", "closure", "curve", "d", "degree", "digits",
    "directions", "dtype", "field", "finite_field", "flow", "folder", "genus", "given", "group", "jacobian", "kind",
    "message", "model", "name", "named", "ndim", "order", "parameter", "path", "place", "prime", "reasons", "region",
    "scene", "shape", "source", "suffix", "system", "target", "time",
}  # fmt: skip
# functions that convert one number to another
READERS = {"abs", "check_scalar", "check_scalars", "coerce", "entries", "list", "map", "sorted", "tuple", "whole"}
# the compiler and compiled modules, and modules whose messages contain values that other rooms have checked: floats,
# digits, rows
LOW = (
    "jacobian.native.", "jacobian.numbers.", "integrable.oracles.", "integrable.ensembles.computing",
    "integrable.ensembles.members", "integrable.motion.contact", "integrable.motion.domain",
    "integrable.motion.enclosure", "integrable.motion.precise", "integrable.motion.symmetric_precise",
    "integrable.motion.trajectory", "integrable.moving_point.legendre", "integrable.portrait.events",
    "integrable.study.command", "integrable.torus.clock", "integrable.torus.panels",
)  # fmt: skip


def arguments_of(function: ast.FunctionDef) -> set[str]:
    """The parameters that may be numbers, and the names of numbers computed from them."""
    given = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    found = {a.arg for a in given if a.arg != "self" and not _is_text(a.annotation)}
    more = True
    while more:
        more = False
        for node in ast.walk(function):
            match node:
                case (
                    ast.Assign(targets=[target], value=value) | ast.AnnAssign(target=target, value=ast.expr() as value)
                ):
                    pass
                case ast.For(target=target, iter=value) | ast.comprehension(target=target, iter=value):
                    pass
                case ast.NamedExpr(target=target, value=value):
                    pass
                case _:
                    continue
            names = {x.id for x in ast.walk(target) if isinstance(x, ast.Name)}
            if not names <= found and any(_is_number_of(part, found) for part in _parts(value)):
                found |= names
                more = True
    return found


def _is_text(annotation: ast.expr | None) -> bool:
    named = {x.id for x in ast.walk(annotation) if isinstance(x, ast.Name)} if annotation else set()
    named |= {x.value for x in ast.walk(annotation) if isinstance(x, ast.Constant)} if annotation else set()
    # Divisor[Element] is written as a Divisor is
    named -= {"Coordinate", "Element", "Other"}
    by_name = annotation is not None and ast.unparse(annotation).startswith("dict[str, ")
    return by_name or (bool(named - {None}) and named - {None} <= TEXTS)


def _parts(value: ast.expr) -> list[ast.expr]:
    return value.elts if isinstance(value, ast.Tuple) else [value]


def _is_number_of(value: ast.expr, found: set[str]) -> bool:
    """Whether an expression is an argument, or is computed from one by arithmetic and functions that read numbers."""
    match value:
        case ast.Name(id=name):
            return name in found
        case ast.BinOp(left=x, right=y):
            return _is_number_of(x, found) or _is_number_of(y, found)
        case ast.Call(func=ast.Name(id="map"), args=[ast.Name(id="float"), *_]):
            return False
        case ast.UnaryOp(operand=x) | ast.Starred(value=x) | ast.Subscript(value=x):
            return _is_number_of(x, found)
        case ast.IfExp(body=x, orelse=y):
            return _is_number_of(x, found) or _is_number_of(y, found)
        case ast.List(elts=xs) | ast.Tuple(elts=xs):
            return any(_is_number_of(x, found) for x in xs)
        case ast.Call(func=function, args=xs):
            name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
            return name in READERS and any(_is_number_of(x, found) for x in xs)
    return False


def unsafe(function: ast.FunctionDef) -> Iterator[ast.FormattedValue]:
    """The values in messages of a function that are formatted without a writer, although they may be numbers given by
    the caller.
    """
    statements = [node for node in ast.walk(function) if isinstance(node, ast.Raise)]
    # only floats have a format specification, and their text is short
    formatted = [
        x for node in statements for x in ast.walk(node) if isinstance(x, ast.FormattedValue) and not x.format_spec
    ]
    found = arguments_of(function) - NAMES if formatted else set()
    yield from (node for node in formatted if _may_fail(node.value, found))


def _may_fail(value: ast.expr, found: set[str]) -> bool:
    if isinstance(value, ast.Attribute):
        return value.attr not in SMALL and not value.attr.isupper()
    if isinstance(value, ast.Call):
        inside = [*value.args, *(k.value for k in value.keywords)]
        # joined parts are safe if a writer is mapped over them
        safe = ast.unparse(value.func) in WRITERS | {"float"} or "map(written, " in ast.unparse(value)
        return not safe and any(_may_fail(x, found) for x in inside)
    if isinstance(value, ast.BinOp):
        return _may_fail(value.left, found) or _may_fail(value.right, found)
    return _is_number_of(value, found)


def test_messages_write_numbers_of_any_size():
    wrong = [
        f"{module}:{node.lineno} {function.name}: {{{ast.unparse(node.value)}}}"
        for module in modules()
        if not module.startswith(LOW)
        for function in ast.walk(tree(module))
        if isinstance(function, ast.FunctionDef)
        for node in unsafe(function)
    ]
    assert not wrong, "\n".join(sorted(set(wrong)))


def test_the_lint_sees_what_it_should():
    code = """
def f(m: int, K: Any, name: str):
    n = whole(m, "m")
    raise ArgumentError(f"{name}: {n}, {n + 1}, {shown(n)}, {len(n)}, {self.bound}, {K.name}")
"""
    (function,) = ast.parse(code).body
    assert isinstance(function, ast.FunctionDef)
    assert [ast.unparse(node.value) for node in unsafe(function)] == ["n", "n + 1", "self.bound"]
