"""The pseudo-group of a Kummer surface over GF(p): doublings, sums of points with a known difference, multiples.

On the surface D and −D are one point κ(D). So κ(D) and κ(E) have two sums, x = κ(D + E) and y = κ(D − E). The products
x_i·y_j + x_j·y_i are, up to a common factor, forms b_ij that are quadratic in κ(D) and in κ(E) (Cassels & Flynn 1996,
chapter 3). Together with y they give x (:mod:`jacobian.relatives.pseudo_sums`). The coefficients of the b_ij are found
like the doubling forms of :mod:`jacobian.relatives.kummer`: from classes over finite fields, by linear algebra modulo
primes and the Chinese remainder theorem.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from itertools import combinations_with_replacement
from random import Random
from typing import Any

import numpy as np

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import ArgumentError, FieldError, Infeasible, entries, shown
from jacobian.fields import QQ
from jacobian.group import Jacobian
from jacobian.immutable import Immutable
from jacobian.law.divisor import Divisor, check_scalar, check_scalars
from jacobian.native.library import Packed
from jacobian.native.longs import WORDS, numbers_of, pairs, words_of
from jacobian.native.modular import CONTEXT
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.threads import in_ranges
from jacobian.numbers.two_words import Residues, two_words
from jacobian.relatives import pseudo_sums
from jacobian.relatives.kummer import KummerSurface, coordinates, kummer_surface, null_vector
from jacobian.relatives.pseudo_sums import COMPILED, FORMS, SCRATCH, Forms

INDICES = list(combinations_with_replacement(range(4), 2))
"""The indices (i, j), i ≤ j, of the forms b_ij and of the quadratic monomials of a point."""
TERMS = list(combinations_with_replacement(range(len(INDICES)), 2))
"""The terms of a biquadratic form as pairs of indices of quadratic monomials (:func:`biquadratic`)."""
LEADING = TERMS.index((INDICES.index((0, 0)), INDICES.index((3, 3))))
"""The index of the term ξ₁²η₄² + ξ₄²η₁² of two points ξ and η, which has the coefficient 1 in b₁₁."""
CLASSES = 2 * len(TERMS) + 6
"""The number of pairs of classes from which two forms are found, each with a coefficient for each of the TERMS."""
STEP = 1 << 8
"""The number of points in one call of a loop over points."""

WANTED = "a point, four residues, or an array (N, 4) of them,"

Point = tuple[int, int, int, int]


class PseudoGroup(Immutable):
    """The Kummer surface of a curve of genus 2 over GF(p), p odd, with doublings, differential sums and multiples.

    A point is four residues, the first nonzero one being 1; ``zero`` is κ(0) = (0, 0, 0, 1). Every operation takes one
    point or an array (N, 4), and returns the same kind. All points are accepted, including those of 0, of classes of
    order 2 and of weight below 2. For p < 2^128 the operations are compiled, and arrays are spread over the processors.
    """

    zero: Point = (0, 0, 0, 1)

    def __init__(self, curve: HyperellipticCurve) -> None:
        self.curve = curve
        self.surface = kummer_surface(curve)
        if curve.field == QQ:
            raise FieldError(f"curve = {curve!r}: a curve of genus 2 over GF(p), p odd, is needed")
        self._p: int = curve.field.p  # type: ignore[attr-defined]

    def _value(self) -> tuple[object, ...]:
        return (self.curve,)

    def __repr__(self) -> str:
        return f"PseudoGroup({self.curve!r})"

    def __reduce__(self) -> tuple[object, ...]:
        return PseudoGroup, self._value()

    def explain(self) -> str:
        """A description of the algorithm of addition."""
        if self._is_compiled:
            return (
                "compiled code on two words, for GF(p), 2 < p < 2^128: biquadratic forms, one addition for every case"
            )
        return "biquadratic forms in Python: p has more than 128 bits, or nothing is compiled"

    @property
    def _is_compiled(self) -> bool:
        return self._p < 1 << 128 and not interpreted()

    # --- points

    def point(self, D: Divisor) -> Point:
        """κ(D), the same for −D; CurveMismatch for a class of another curve."""
        return self.surface.point(D)

    def double(self, x: Any) -> Any:
        """κ(2D) for x = κ(D)."""
        return self._run("double_point", {"x": self._residues(x, "x")})

    def add(self, x: Any, y: Any, difference: Any) -> Any:
        """κ(D + E) for x = κ(D), y = κ(E) and difference = κ(D − E).

        The difference is not checked: a wrong one gives meaningless points.
        """
        given = {"x": x, "y": y, "difference": difference}
        return self._run("add_point", {name: self._residues(points, name) for name, points in given.items()})

    def multiple(self, m: Any, x: Any) -> Any:
        """κ(mD) for x = κ(D), by Montgomery's ladder; m is an int, or a sequence with one for each point."""
        points = self._residues(x, "x")
        residues, single = points
        m = check_scalar(m, "m") if single else check_scalars(m, len(residues) // 4, "m")
        scalars = [m] if isinstance(m, int) else m
        longest = max((c.bit_length() for c in scalars), default=0) or 1
        bits = np.array([[abs(c) >> k & 1 for k in range(longest - 1, -1, -1)] for c in scalars], np.int64)
        return self._run("multiply_point", {"x": points}, bits.reshape(-1, longest))

    def _residues(self, x: Any, name: str) -> tuple[list[int], bool]:
        """The residues of x, one point after the other, and whether x is a single point.

        ArgumentError if x is neither a point nor an array of points.
        """
        if type(x) is tuple and len(x) == 4 and all(type(c) is int and 0 <= c < self._p for c in x):
            return list(x), True
        try:
            array = np.array(entries(x, name, WANTED), object)
        except ValueError:
            raise ArgumentError(f"{name} = {shown(x)}: {WANTED} is needed") from None
        if array.size == 0:
            array = array.reshape(0, 4)
        if array.ndim not in (1, 2) or array.shape[-1] != 4:
            raise ArgumentError(f"{name} = {shown(x)}: {WANTED} is needed")
        K: Any = self.curve.field
        return [K.coerce(c, name) for c in array.ravel().tolist()], array.ndim == 1

    # --- sums

    def _run(self, name: str, found: dict[str, tuple[list[int], bool]], *bits: Any) -> Any:
        """The result of the function ``name`` of pseudo_sums; ``found``: its points, read by :meth:`_residues`."""
        if len({(len(values), single) for values, single in found.values()}) > 1:
            raise ArgumentError(f"{', '.join(found)}: points, or as many of each, are needed")
        operands, single = [values for values, _ in found.values()], next(iter(found.values()))[1]
        if single:
            which, *result = self._one(name, operands, *(row[0] for row in bits))
            wrong = [which]
        else:
            wrong, result = self._many(name, operands, *bits)
        for j, which in enumerate(wrong):
            if which:
                point = tuple(operands[which - 1][4 * j : 4 * j + 4])
                raise ArgumentError(
                    f"{list(found)[which - 1]}: {point} is no point of the surface whose first coordinate ≠ 0 is 1"
                )
        return tuple(result) if single else result

    def _one(self, name: str, operands: list[list[int]], *bits: Any) -> Any:
        if self._is_compiled:
            return getattr(COMPILED, name)(*self._forms, *operands, *bits, np.empty((SCRATCH, 2), np.int64))
        which, found = getattr(pseudo_sums, name)(*self._forms, *operands, *bits, [0] * SCRATCH)
        return which, *found

    def _many(self, name: str, operands: list[list[int]], *bits: Any) -> tuple[list[int], Any]:
        compiled = self._is_compiled
        rows = [np.array(values, object).reshape(-1, 4).T for values in operands]
        columns = [pairs(words_of(x)) if compiled else x for x in rows]
        out, wrong = np.zeros_like(columns[0]), np.zeros(rows[0].shape[1], np.int64)
        loop = getattr(COMPILED if compiled else pseudo_sums, f"{name}s")

        def work(begin: int, end: int) -> None:
            scratch = np.empty((SCRATCH, 2), np.int64) if compiled else [0] * SCRATCH
            loop(*self._forms, (*columns, *bits), out, wrong, (begin, end), scratch)

        in_ranges(len(wrong), STEP, work)
        return wrong.tolist(), np.ascontiguousarray((numbers_of(out.view(WORDS)[..., 0]) if compiled else out).T)

    @cached_property
    def _forms(self) -> Any:
        """The arithmetic modulo p and the forms, as arguments of the functions of pseudo_sums."""
        K: Any = two_words(self._p) if self._p < 1 << 128 else Residues(self._p)
        forms = forms_of_surface(self.surface, self._p, K.to_word)
        if not self._is_compiled:
            return K, forms
        return Packed(K, CONTEXT), Packed(forms._replace(coefficient=pairs(words_of(forms.coefficient))), FORMS)


def forms_of_surface(surface: KummerSurface, modulus: int, to_word: Callable[[int], int]) -> Forms:
    """All forms of a surface modulo ``modulus``, packed for :mod:`jacobian.relatives.pseudo_sums`."""
    table = [[c % modulus for c in row] for row in biquadratic(surface)]
    of = {key: dict(zip(TERMS, row, strict=True)) for key, row in zip(INDICES, table, strict=True)}
    tables = [[of[min(i, j), max(i, j)] for j in range(4)] for i in range(4)]
    own = {FACTORED[key]: c % modulus for key, c in equation(surface.f).items()}
    return packed([*tables, [doubled(form, modulus) for form in tables[3]], [own]], to_word)


FACTORED = {tuple(sorted(INDICES[k] + INDICES[m])): (k, m) for k, m in reversed(TERMS)}
"""The quartic monomials of a point, by the indices of their four factors, each as the first of TERMS that gives it."""


def doubled(form: dict[tuple[int, int], int], p: int) -> dict[tuple[int, int], int]:
    """The coefficients of the quartic form in x that a biquadratic form becomes at (x, x); keys as in FACTORED."""
    found: dict[tuple[int, int], int] = {}
    for (k, m), c in form.items():
        pair = FACTORED[tuple(sorted(INDICES[k] + INDICES[m]))]
        found[pair] = (found.get(pair, 0) + (c if k == m else 2 * c)) % p
    return found


def packed(tables: Sequence[Sequence[dict[tuple[int, int], int]]], to_word: Callable[[int], int]) -> Forms:
    """The tables of forms as arrays (see Forms), without terms whose coefficient is 0."""
    pairs_of, ends, place, begin = [], [0], [], [0]
    coefficients: list[int] = []
    for table in tables:
        used = sorted({pair for form in table for pair, c in form.items() if c})
        pairs_of += used
        ends.append(len(pairs_of))
        for form in table:
            terms = [(k, form[pair]) for k, pair in enumerate(used) if form.get(pair)]
            terms += [(0, 0)] * (-len(terms) % 4)
            place += [k for k, _ in terms]
            coefficients += [to_word(c) for _, c in terms]
            begin.append(len(place))
    first, second = (np.array([pair[k] for pair in pairs_of], np.int64) for k in (0, 1))
    begin_of, ends_of, places = (np.array(a, np.int64) for a in (begin, ends, place))
    return Forms(first, second, ends_of, places, begin_of, coefficients)


def equation(f: Sequence[int]) -> dict[tuple[int, ...], int]:
    """The equation K₂ξ₄² + K₁ξ₄ + K₀ = 0 of the surface (Cassels & Flynn 1996, (3.1.8)).

    Its coefficients are returned as {indices of the four factors of a monomial: coefficient}.
    """
    f0, f1, f2, f3, f4, f5, f6 = f
    linear = {"000": 2 * f0, "001": f1, "002": 2 * f2, "012": f3, "022": 2 * f4, "122": f5, "222": 2 * f6}
    rest = {
        "0000": f1 * f1 - 4 * f0 * f2,
        "0001": -4 * f0 * f3,
        "0002": -2 * f1 * f3,
        "0011": -4 * f0 * f4,
        "0012": 4 * (f0 * f5 - f1 * f4),
        "0022": f3 * f3 + 2 * f1 * f5 - 4 * f2 * f4 - 4 * f0 * f6,
        "0111": -4 * f0 * f5,
        "0112": 4 * (2 * f0 * f6 - f1 * f5),
        "0122": 4 * (f1 * f6 - f2 * f5),
        "0222": -2 * f3 * f5,
        "1111": -4 * f0 * f6,
        "1112": -4 * f1 * f6,
        "1122": -4 * f2 * f6,
        "1222": -4 * f3 * f6,
        "2222": f5 * f5 - 4 * f4 * f6,
    }
    found = {"1133": 1, "0233": -4, **{f"{key}3": -2 * c for key, c in linear.items()}, **rest}
    return {tuple(map(int, key)): c for key, c in found.items()}


@lru_cache(maxsize=32)
def biquadratic(surface: KummerSurface) -> list[list[int]]:
    """The coefficients of the forms b_ij, in the order of INDICES; a form has a coefficient for each of the TERMS.

    The term (k, l) is q_k(x)·q_l(y) + q_l(x)·q_k(y), or q_k(x)·q_k(y) for k = l, q_k being the quadratic monomials.
    """
    return surface.integers(len(TERMS), lambda J: biquadratic_modulo(surface, J))


def biquadratic_modulo(surface: KummerSurface, J: Jacobian) -> list[int]:
    """The coefficients of :func:`biquadratic` modulo a prime of 61 bits, in one list.

    At each pair of classes the values of all forms are known up to a common factor. The ratios of two of them determine
    b₁₁ and b₁₂. The value of b₁₁ gives the factor, and linear equations then give the other forms.
    """
    from flint import nmod_mat

    rows, sums = zip(*_pairs_of_classes(surface.f, J), strict=True)
    size, p = len(TERMS), J.field.characteristic
    ratio = [
        [c * values[1] % p for c in terms] + [-c * values[0] % p for c in terms]
        for terms, values in zip(rows, sums, strict=True)
    ]
    both = null_vector(ratio, LEADING, p)
    if both is None:
        raise Infeasible(f"{surface!r}: its biquadratic forms were not found modulo {p}")
    values = []
    for terms, found in zip(rows[:size], sums[:size], strict=True):
        factor = sum(c * t for c, t in zip(both[:size], terms, strict=True)) * pow(found[0], -1, p) % p
        values += [factor * v % p for v in found]
    table = nmod_mat(size, size, [c for row in rows[:size] for c in row], p)
    solved = table.solve(nmod_mat(size, len(INDICES), values, p))
    return [int(solved[i, j]) for j in range(len(INDICES)) for i in range(size)]


def _pairs_of_classes(f: Sequence[int], J: Jacobian) -> list[tuple[list[int], list[int]]]:
    """Two lists modulo p for each of CLASSES pairs (D, E) of classes in general position: the values of the TERMS at
    κ(D), κ(E), and those of the forms up to a common factor.
    """
    p = J.field.characteristic
    rng = Random(p)
    found: list[tuple[list[int], list[int]]] = []
    D, E, step = J.random(rng), J.random(rng), J.random(rng)
    while len(found) < CLASSES:
        D, E = D + step, E + D
        classes = D, E, D + E, D - E
        if all(len(G.u) == 3 for G in classes):
            a, b, x, y = ([c % p for c in coordinates(f, G.u, [*G.v, 0, 0])] for G in classes)
            of_a, of_b = ([z[i] * z[j] % p for i, j in INDICES] for z in (a, b))
            terms = [(of_a[k] * of_b[m] + (of_a[m] * of_b[k] if k != m else 0)) % p for k, m in TERMS]
            found.append((terms, [(x[i] * y[j] + (x[j] * y[i] if i != j else 0)) % p for i, j in INDICES]))
    return found
