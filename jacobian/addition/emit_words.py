"""Writes Python code from formulas, in the operations of :mod:`jacobian.numbers.words`, for loops to be compiled.

:func:`texts` returns the code, one function for each step of the formulas; :func:`functions` returns these functions. A
sum of up to four products is reduced once. The writer bounds all numbers, in units of p, for words with and without
spare bits, and for floats. It reduces a number where an operation would exceed its bound. Binary fields and
fields with tables need no such reductions, but fields with tables of odd characteristic run the code for primes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from itertools import pairwise
from math import ceil
from typing import Any, NamedTuple

from jacobian.addition.short import MODELS
from jacobian.addition.straight import Formulas, Tape, parameters

MOST = 4
"""The largest number of products in a sum that is reduced once."""


class Size(NamedTuple):
    """Bounds of a number, in units of p, in Wide contexts, Lazy ones (:mod:`jacobian.numbers.words`) and floats."""

    wide: float
    lazy: float
    double: float


CANONICAL = Size(0.5, 0.5, 0.5)
SETTLED = Size(1, 4, 4.5)
"""The bounds within which ``K.settled`` can reduce a number; sums stay within them."""
NEAR = Size(1, 1.5, 4.5)
"""The bounds within which ``K.canonical`` can reduce a number."""


def within(size: Size, limit: Size) -> bool:
    """Whether each bound of ``size`` is at most the bound in ``limit``."""
    return all(x <= y for x, y in zip(size, limit, strict=True))


class Writer:
    """The lines of code of one step. ``sizes`` maps the name of each input to its size."""

    def __init__(self, tape: Tape, results: Sequence[int], sizes: dict[str, Size]) -> None:
        self.tape, self.sizes, self.lines = tape, dict(sizes), list[str]()
        self.live = tape.live(results)
        uses = tape.uses(self.live, results)
        self.factors = {x for i in self.live if tape.operations[i][0] == "mul" for x in tape.operands(i)}
        self.named = {i for i in self.live if uses[i] > 1 or i in self.factors or i in results or not tape.operands(i)}
        self.named -= set(self._repeated(results))
        self.names: dict[int, str] = {}
        self.negatives: dict[str, str] = {}
        self.parts = {i: self._parts(i) for i in self.live if i in self.named}
        products = [each for parts, _ in self.parts.values() for each in parts]
        self.often = Counter(x for sign, *pair in products if sign < 0 for x in pair)
        for i in self.live:
            if i in self.named:
                self.names[i] = self._written(i)

    def _repeated(self, results: Sequence[int]) -> Iterable[int]:
        """Yields the products to be computed anew in every sum that uses them, which costs no further reduction."""
        parts = {i: self._parts(i) for i in self.live if i in self.named}
        for i in self.named.difference(self.factors, results):
            sums = [products for products, others in parts.values() if i in others]
            if self.tape.operations[i][0] == "mul" and all(len(products) % MOST for products in sums):
                yield i

    def _parts(self, i: int) -> tuple[list[tuple[int, int, int]], Counter[int]]:
        """Operation i as a sum: its products (sign, x, y), and its other terms with their multiplicities."""
        products, others = list[tuple[int, int, int]](), Counter[int]()

        def gather(i: int, sign: int, inside: bool) -> None:
            name, *operands = self.tape.operations[i]
            if name in ("input", "one") or (inside and i in self.named):
                others[i] += sign
            elif name == "mul":
                products.append((sign, operands[0], operands[1]))
            else:
                for x, of in zip(operands, (-1,) if name == "neg" else (1, 1 if name == "add" else -1), strict=True):
                    gather(x, sign * of, True)

        gather(i, 1, False)
        if self.tape.binary:
            others = Counter({x: 1 for x, count in others.items() if count % 2})
        return products, others

    def _written(self, i: int) -> str:
        """Writes the lines that compute operation i; returns the name of its result."""
        name, *operands = self.tape.operations[i]
        if name == "input":
            return str(operands[0])
        if name == "one":
            self.sizes["K.one"] = CANONICAL
            return "K.one"
        products, others = self.parts[i]
        signs = sum(sign for sign, _, _ in products)
        # a sum of products most of which are negative is computed with opposite signs and subtracted
        turned = signs < 0 and (any(count > 0 for count in others.values()) or len(products) == -signs)
        dots = self._dots([(-sign if turned else sign, x, y) for sign, x, y in products])
        rest = [self.names[x] for x in others.elements()], [self.names[x] for x in (-others).elements()]
        plus, minus = ([], dots) if turned else (dots, [])
        if dots and (len(rest[0]) + len(rest[1]) > 1) and rest[0]:
            rest = [self._sum(*rest)], []
        elif dots and len(rest[1]) > 1:
            rest = [], [self._sum(rest[1], [])]
        return self._sum([*plus, *rest[0]], [*minus, *rest[1]])

    def _dots(self, products: list[tuple[int, int, int]]) -> list[str]:
        """Writes the products as sums of at most MOST products each, of about equal length; returns their names."""
        count = ceil(len(products) / MOST)
        ends = [len(products) * k // count for k in range(count + 1)] if count else [0]
        return [self._dot(products[begin:end]) for begin, end in pairwise(ends)]

    def _dot(self, products: list[tuple[int, int, int]]) -> str:
        factors = [x for each in products for x in self._factors(*each)]
        if sum(self.sizes[x].wide * self.sizes[y].wide for x, y in zip(factors[::2], factors[1::2], strict=True)) > 1:
            self._fit(factors)
        while (size := _dot_size([self.sizes[x] for x in factors])) is None:
            self._bring_back(max(factors, key=lambda x: self.sizes[x].lazy))
        return self._line(f"K.dot({', '.join(factors)})", size)

    def _factors(self, sign: int, x: int, y: int) -> tuple[str, str]:
        """The names of the factors of a product. A minus sign goes to the factor that occurs negated most often."""
        first, second = self.names[x], self.names[y]
        if sign > 0:
            return first, second
        if second in self.negatives or (first not in self.negatives and self.often[y] > self.often[x]):
            return first, self._negative(second)
        return self._negative(first), second

    def _negative(self, x: str) -> str:
        if x not in self.negatives:
            self.negatives[x] = self._line(f"K.neg({x})", self.sizes[x])
        return self.negatives[x]

    def _sum(self, plus: list[str], minus: list[str]) -> str:
        """Writes the sum of the names in ``plus`` minus those in ``minus``; returns its name."""
        if not plus:
            return self._negative(self._sum(minus, []))
        total = plus[0]
        for sign, x in [("add", x) for x in plus[1:]] + [("sub", x) for x in minus]:
            self._fit((total, x))
            while not within(size := _sum_size(self.sizes[total], self.sizes[x]), SETTLED):
                self._bring_back(max(total, x, key=lambda x: self.sizes[x].lazy))
            total = self._line(f"K.{sign}({total}, {x})", size)
        return total

    def _fit(self, terms: Iterable[str]) -> None:
        for x in dict.fromkeys(terms):
            if self.sizes[x].wide > CANONICAL.wide:
                self._line(f"K.fit({x})", self.sizes[x]._replace(wide=CANONICAL.wide), x)

    def _bring_back(self, x: str) -> None:
        self._line(f"K.{'canonical' if within(self.sizes[x], NEAR) else 'settled'}({x})", CANONICAL, x)

    def _line(self, text: str, size: Size, name: str = "") -> str:
        name = name or f"t{len(self.lines)}"
        self.sizes[name] = CANONICAL if self.tape.binary else size
        self.lines.append(f"{name} = {text}")
        return name

    def finished(self, results: Iterable[int], limit: Size) -> list[str]:
        """Reduces the results to the bounds ``limit`` where they exceed them; returns their names."""
        for i in results:
            self._fit([self.names[i]] if limit.wide < SETTLED.wide and limit != CANONICAL else [])
            if not within(self.sizes[self.names[i]], limit):
                self._bring_back(self.names[i])
        return [self.names[i] for i in results]


def _sum_size(x: Size, y: Size) -> Size:
    return Size(CANONICAL.wide, x.lazy + y.lazy, x.double + y.double)


def _dot_size(factors: list[Size]) -> Size | None:
    """The size of a sum of products after its reduction; None if the sum is too large to be reduced."""
    pairs = list(zip(factors[::2], factors[1::2], strict=True))
    wide, lazy = sum(x.wide * y.wide for x, y in pairs), sum(x.lazy * y.lazy for x, y in pairs)
    each = [x.double * y.double for x, y in pairs]
    # if the words are floats, the rounded quotient of a product by p is off by at most 1/2 plus three roundings
    size = Size(wide / 2 + 1 / 2, lazy / 8 + 1 / 2, sum(1 / 2 + 0.19 * x for x in each))
    return size if wide <= 1 and lazy <= 28 and max(each) < 16 and within(size, SETTLED) else None


@cache
def texts(model: type) -> dict[str, str]:
    """The code of every step for a class of equations of :mod:`jacobian.addition.short`, by the name of the step."""
    formulas, known = MODELS[model]
    g = formulas.genus
    places = [*reversed(range(g)), *reversed(range(g, 2 * g))]
    sizes = {"first": [CANONICAL] * 2 * g, "second": [CANONICAL] * 2 * g, "inverse": [CANONICAL]}
    u, v = (" ".join(f"K.from_word(D[{k}])," for k in part) for part in (reversed(range(g)), reversed(range(g, 2 * g))))
    access = {
        "class_at(K, C, x, j)": [f"x[{k}, j]" for k in places],
        "quotient_at(K, C, S, j)": [f"S[{k + 2}, j]" for k in range(g + 1)],
        "class_in(K, C, a)": [f"a[{k + 3 + k // g}]" for k in places],
        "encoded(K, C, u, v)": [f"K.to_word({'uv'[k // g]}[{k % g}])" for k in places],
        "decoded(K, C, D)": [f"({u} 1)", f"({v})"],
    }
    found = {head.split("(")[0]: f"def {head}:\n    return {', '.join(items)}\n" for head, items in access.items()}
    named = [("chord", formulas.chord), ("tangent", formulas.tangent), *formulas.steps, ("closed", formulas.closed)]
    for name, step in [*named, ("opposite", formulas.opposite)]:
        found[name], results = _step(formulas, known, name, step, sizes)
        result = {"chord": "quotient", "tangent": "quotient"}.get(name, name)
        before = sizes.get(result, results)
        sizes[result] = [Size(*map(max, x, y)) for x, y in zip(before, results, strict=True)]
    return found


LIMITS = {
    "product": NEAR,
    **dict.fromkeys(("u", "v", "closed", "opposite"), CANONICAL),
    **dict.fromkeys(("cubic", "bent", "meeting", "middle"), Size(0.5, 2, 3)),
}
"""The bounds to which results of a step are reduced if SETTLED is not enough, or if many steps use the results."""


def _step(
    formulas: Formulas, known: dict[str, int], name: str, step: Callable[..., Any], sizes: dict[str, list[Size]]
) -> tuple[str, list[Size]]:
    """The code of one step, and the sizes of its results."""
    tape, bounds, lines = Tape(known.get("characteristic") == 2), dict[str, Size](), []
    C = formulas.equation(known, tape, "C.")
    bounds |= {f"C.{x}": CANONICAL for x in formulas.coefficients}
    given = []
    for parameter in parameters(step):
        if parameter == "C":
            given.append(C)
            continue
        names = _names(parameter, len(sizes[parameter]))
        bounds |= zip(names, sizes[parameter], strict=True)
        terms = tape.inputs(*names)
        given.append(terms if parameter != "inverse" else terms[0])
        if parameter != "inverse":
            lines.append(f"    {', '.join(names)} = {parameter}")
    results = step(*given)
    places = [x.index for x in (results if isinstance(results, tuple) else (results,))]
    writer = Writer(tape, places, bounds)
    last = writer.finished(places, LIMITS.get(name, SETTLED))
    head = f"def {name}({', '.join(('K', 'C', *(x for x in parameters(step) if x != 'C')))}):"
    body = [*lines, *(f"    {line}" for line in writer.lines), f"    return {', '.join(last)}"]
    return "\n".join([head, *body, ""]), [writer.sizes[x] for x in last]


def _names(parameter: str, count: int) -> list[str]:
    """The names of the numbers of which a step's parameter consists."""
    letters = {"first": "ab", "second": "cd"}.get(parameter)
    if letters is None:
        return [parameter] if count == 1 else [f"{parameter}{k}" for k in range(count)]
    return [f"{letter}{k}" for letter in letters for k in reversed(range(count // 2))]


@cache
def functions(model: type) -> dict[str, Callable[..., Any]]:
    """The functions of all steps for one class of short equations; the attribute ``text`` of each is its code."""
    formulas, _ = MODELS[model]
    found = {}
    for name, text in texts(model).items():
        defined: dict[str, Any] = {"__name__": __name__}
        exec(compile(text, f"<{name} of {model.__name__}>", "exec"), defined)
        found[name] = defined[name]
        found[name].text = text
        found[name].sources = formulas.chord.__module__, model.__module__, Tape.__module__, __name__
    return found
