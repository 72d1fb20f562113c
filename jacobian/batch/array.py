"""N divisor classes of one Jacobian as arrays, with the group law on all of them at once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, Generic, Literal, SupportsIndex, overload

import numpy as np

from jacobian.addition.choice import has_two_word_rows, is_word_sized
from jacobian.batch.arguments import MOST_ROWS, check_group, degrees, elements, weights
from jacobian.element import Element, Rng
from jacobian.errors import ArgumentError, CurveMismatch, FieldError, NotOnCurve, entries, one_of, shown, whole, written
from jacobian.fields import CC, RR
from jacobian.group import Jacobian
from jacobian.immutable import Immutable, read_only
from jacobian.law.divisor import Divisor, GroupLaw, check_scalars, is_zero_int
from jacobian.numbers.compiler import interpreted

Matrix = np.ndarray[tuple[int, int], np.dtype[Any]]
Vector = np.ndarray[tuple[int], np.dtype[Any]]


def engine(J: Jacobian) -> Any:
    """The object that does J's arithmetic on rows, cached on J. Its class depends on J's field."""
    found = J.__dict__.get("_rows")
    if found is None:
        K = J.field
        J.zero()  # raises if the classes of J have no Mumford form
        words = is_word_sized(J.curve)
        if words and not interpreted():
            from jacobian.batch.compiled_rows import CompiledRows

            found = CompiledRows(J)
        elif has_two_word_rows(J.curve) and not interpreted():
            from jacobian.batch.two_word_rows import TwoWordRows

            found = TwoWordRows(J)
        elif K in (RR, CC) and J.curve.genus == 2 and J.curve.arithmetic_model is J.curve:
            from jacobian.batch.float_rows import FloatRows

            found = FloatRows(J)
        else:
            from jacobian.batch.object_rows import ObjectRows

            found = ObjectRows(J, np.int64 if words else object)
        J.__dict__["_rows"] = found
    return found


class DivisorArray(Immutable, Generic[Element]):
    """N divisor classes of one Jacobian. Make one by :meth:`stack`, :meth:`from_arrays`, :meth:`zeros`, :meth:`random`.

    Operations: ``A + B``, ``A − B``, ``−A``, ``A.double()``, ``A.sum()``, ``m * A`` for one int m or one for each row.
    A single Divisor is broadcast to all rows. ``A == B`` compares row by row and returns an array (N,). ``A[i]`` is a
    Divisor, ``A[index]`` with a slice, a mask or an array of ints a DivisorArray. Arrays are immutable. Arrays of two
    curves cannot be combined (CurveMismatch), nor arrays of two lengths (ArgumentError).

    ``u`` (N, g + 1) and ``v`` (N, g) are ascending coefficients in the curve's own coordinates; each u is monic. ``n``
    (N,) is the weight at ∞₊, or None if divisors have none. Coefficients are ints over GF(p), p < 2^63, and over
    GF(p^k) of at most 2^16 elements. They are float64 or complex128 over RR and CC in genus 2, else objects (Python's
    ints over a longer GF(p)). ``degree`` (N,) is deg u. ``status`` (N,) is 0 for a row that holds a class; over an
    exact field every row does.

    The arithmetic of arrays of ints and floats is compiled, and large arrays are spread over the processors
    (:func:`jacobian.batch.set_threads`). Genus 2 has explicit formulas with one inversion for 256 rows, also for p of
    two words (p < 2^128) and GF(2^n), n < 128. Genus 3 has them for f of degree 7 over GF(p), p < 2^128. Other curves
    use Cantor's algorithm. RR and CC in genus 2 use the composition of :mod:`jacobian.inexact.composition`, unrolled.
    Over other fields the Jacobian adds row by row.
    """

    __slots__ = ("_engine", "_rows", "jacobian")

    jacobian: Jacobian[Element]
    _engine: Any
    _rows: Any

    __hash__ = None  # type: ignore[assignment]
    # without this, numpy would multiply an array of ints and a DivisorArray element by element
    __array_ufunc__ = None

    def __init__(self, J: Jacobian[Element], rows: Any) -> None:
        _fill(self, J, engine(J), rows)

    def _like(self, rows: Any) -> DivisorArray[Element]:
        made = DivisorArray.__new__(DivisorArray)
        _fill(made, self.jacobian, self._engine, rows)
        return made

    # --- making

    @classmethod
    def stack(
        cls, parts: Iterable[Divisor[Element] | DivisorArray[Element]], J: Jacobian[Element] | None = None
    ) -> DivisorArray[Element]:
        """The rows of ``parts``, Divisors and DivisorArrays, concatenated. Only an empty sequence needs ``J``."""
        parts = entries(parts, "parts", "a sequence, [D] for one Divisor,")
        J = None if J is None else check_group(J)
        for i, part in enumerate(parts):
            if not isinstance(part, Divisor | DivisorArray):
                raise ArgumentError(f"parts[{i}] = {shown(part)}: a Divisor or a DivisorArray is needed")
            J = check_group(part.jacobian) if J is None else J
            _check_same(J, part.jacobian)
        if J is None:
            raise ArgumentError("parts = []: an array of no rows needs its Jacobian, stack([], J)")
        run = engine(J)
        if all(isinstance(part, Divisor) for part in parts):
            return cls(J, run.from_divisors(parts))
        arrays = [run.from_divisors([part]) if isinstance(part, Divisor) else part._rows for part in parts]
        return cls(J, run.join(arrays))

    @classmethod
    def zeros(cls, J: Jacobian[Element], count: int) -> DivisorArray[Element]:
        """An array of ``count`` rows, all of them the identity."""
        count = whole(count, "count", f"an int ≥ 0, the number of rows, {MOST_ROWS} at most", 0, MOST_ROWS)
        return cls(J, engine(check_group(J)).zero(count))

    @classmethod
    def from_arrays(
        cls, J: Jacobian[Element], u: Any, v: Any, n: Any = None, *, check: bool = True
    ) -> DivisorArray[Element]:
        """The classes of Mumford pairs: monic u (N, g + 1) and v (N, g), ascending; on a split model also n (N,).

        The arguments are numpy or galois arrays, or nested lists. By default n is ⌈(g − deg u)/2⌉, as in
        :meth:`Jacobian.from_mumford`. ArgumentError is raised for wrong shapes, a u that is not monic or a v that is
        not of lower degree, and FieldError for elements of another field. NotOnCurve names the first row that is not on
        the curve; ``check=False`` skips this test.
        """
        run, g = engine(check_group(J)), J.curve.genus
        u, v = elements(J, u, "u", g + 1, run.compiled), elements(J, v, "v", g, run.compiled)
        if len(u) != len(v):
            raise ArgumentError(f"u, v: {len(u)} rows beside {len(v)}; as many are needed")
        degree = degrees(J, u, v)
        rows = run.from_arrays(u, v, degree, weights(J, n, degree))
        wrong = run.first_off_curve(rows) if check else -1
        if wrong >= 0:
            raise NotOnCurve(
                f"row {wrong}: (u, v) = ({u[wrong].tolist()}, {v[wrong].tolist()}) is not on {J.curve!r}: u does not "
                "divide v² + hv − f"
            )
        return cls(J, rows)

    @classmethod
    def random(cls, J: Jacobian[Element], rng: Rng, size: int) -> DivisorArray[Element]:
        """An array of ``size`` random classes, as :meth:`jacobian.group.Jacobian.random` returns it."""
        size = whole(size, "size", f"the number of classes is an int ≥ 0, {MOST_ROWS} at most", 0, MOST_ROWS)
        run = engine(check_group(J))
        if hasattr(run, "sampler"):
            from jacobian.batch.random_rows import sampler

            if (found := sampler(run)).possible:
                return cls(J, found.rows(rng, size))
        return cls(J, run.from_divisors([J.random(rng) for _ in range(size)]))

    # --- reading

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def u(self) -> Matrix:
        """The ascending coefficients of each u, (N, g + 1)."""
        return read_only(self._engine.to_arrays(self._rows)[0])

    @property
    def v(self) -> Matrix:
        """The ascending coefficients of each v, (N, g)."""
        return read_only(self._engine.to_arrays(self._rows)[1])

    @property
    def n(self) -> Vector | None:
        """The weight of each row at ∞₊, (N,), on a split model; None on other models."""
        found = self._engine.weights(self._rows)
        return None if found is None else read_only(found)

    @property
    def degree(self) -> Vector:
        """The number of affine points of each row, (N,)."""
        u = self.u
        leading: Vector = np.argmax(u[:, ::-1] != self.jacobian.field.zero, axis=1)
        return u.shape[1] - 1 - leading

    @property
    def status(self) -> Vector:
        """The status of each row, (N,): 0 if it holds a class.

        Over RR and CC it is 1 if an addition lost the row's digits. It is 2 if the sum has a point at infinity of a
        split model, which inexact divisors cannot represent.
        """
        of_rows = getattr(self._engine, "status", None)
        return of_rows(self._rows) if of_rows else np.zeros(len(self), np.uint8)

    def to_list(self) -> list[Divisor[Element]]:
        """The rows as Divisors."""
        divisors: list[Divisor[Element]] = self._engine.to_divisors(self._rows)
        return divisors

    def to_galois(self) -> tuple[Any, Any]:
        """The coefficients (u, v) as galois arrays. FieldError is raised if galois has no class for the field."""
        K: Any = self.jacobian.field
        if getattr(K, "order", None) is None:
            raise FieldError(f"field = {K.name}: galois has finite fields only")
        return K.galois(self.u), K.galois(self.v)

    def __iter__(self) -> Iterator[Divisor[Element]]:
        return iter(self.to_list())

    @overload
    def __getitem__(self, key: int | np.integer) -> Divisor[Element]: ...

    @overload
    def __getitem__(self, key: slice | list[int] | list[bool] | np.ndarray) -> DivisorArray[Element]: ...

    def __getitem__(self, key: Any) -> Divisor[Element] | DivisorArray[Element]:
        if not isinstance(key, slice | list | np.ndarray):
            i = whole(key, "index", f"an int, a slice, a mask of {len(self)} or an array of ints is needed")
            if not -len(self) <= i < len(self):
                raise IndexError(f"index = {shown(i)}: the array has {len(self)} rows")
            i %= len(self)
            return self._like(self._engine.take(self._rows, slice(i, i + 1))).to_list()[0]
        if not isinstance(key, slice):
            key = _index_array(key)
            if key.ndim != 1 or key.dtype.kind not in "iub" or (key.dtype.kind == "b" and len(key) != len(self)):
                raise ArgumentError(
                    f"index = {shown(key)}: a slice, a mask of {len(self)} or a flat array of ints is needed"
                )
            beyond = np.flatnonzero((key < -len(self)) | (key >= len(self)))
            if key.dtype.kind != "b" and len(beyond):
                raise IndexError(f"index[{beyond[0]}] = {written(key[beyond[0]])}: the array has {len(self)} rows")
        return self._like(self._engine.take(self._rows, key))

    def __repr__(self) -> str:
        shown = [repr(D) for D in self[:3].to_list()]
        return f"DivisorArray([{', '.join(shown)}{', …' if len(self) > 3 else ''}], {len(self)} rows)"

    def __reduce__(self) -> tuple[object, ...]:
        if self.status.any():
            # rows without a class have no coefficients, so the stored rows are pickled instead
            return DivisorArray, (self.jacobian, self._rows)
        return _rebuilt, (self.jacobian, self.u, self.v, self.n)

    # --- the group law

    def _operand(self, other: object) -> Any:
        """The rows of ``other``, with a single Divisor broadcast to all rows; NotImplemented if it is not a divisor."""
        if not isinstance(other, DivisorArray):
            if not isinstance(other, Divisor):
                if not is_zero_int(other):
                    return NotImplemented
                other = self.jacobian.zero()
            _check_same(self.jacobian, other.jacobian)
            return self._engine.repeat(self._engine.from_divisors([other]), len(self))
        if other._engine is not self._engine:
            _check_same(self.jacobian, other.jacobian)
        if len(other) != len(self):
            raise ArgumentError(f"other: {len(other)} rows beside {len(self)}; as many, or one Divisor, are needed")
        return other._rows

    def __add__(self, other: Divisor[Element] | DivisorArray[Element] | Literal[0]) -> DivisorArray[Element]:
        if other is self:
            return self.double()
        rows = self._operand(other)
        return NotImplemented if rows is NotImplemented else self._like(self._engine.add(self._rows, rows))

    __radd__ = __add__

    def __sub__(self, other: Divisor[Element] | DivisorArray[Element] | Literal[0]) -> DivisorArray[Element]:
        rows = self._operand(other)
        if rows is NotImplemented:
            return NotImplemented
        return self._like(self._engine.add(self._rows, self._engine.negate(rows)))

    def __rsub__(self, other: Divisor[Element] | Literal[0]) -> DivisorArray[Element]:
        return -self + other

    def __neg__(self) -> DivisorArray[Element]:
        return self._like(self._engine.negate(self._rows))

    def __pos__(self) -> DivisorArray[Element]:
        return self

    def double(self) -> DivisorArray[Element]:
        """The array of the doubles 2·A_i."""
        return self._like(self._engine.double(self._rows))

    def __mul__(self, scalar: SupportsIndex | Iterable[SupportsIndex]) -> DivisorArray[Element]:
        """The array m·A for an int m, or of the rows m_i·A_i for a sequence of N ints."""
        if isinstance(scalar, Divisor | DivisorArray):
            return NotImplemented
        scalars = check_scalars(scalar, len(self))
        if not self.jacobian.field.exact:
            self.jacobian._check_multiple(
                max(map(abs, scalars), default=0) if isinstance(scalars, list) else abs(scalars)
            )
        return self._like(self._engine.multiply(self._rows, scalars))

    __rmul__ = __mul__

    def sum(self, axis: int | None = None, out: None = None) -> Divisor[Element]:
        """The sum of all rows, by pairwise summation; the identity if there are none.

        ``axis`` and ``out`` are there because ``numpy.sum`` passes them. There is one axis, and no output array is
        supported.
        """
        if axis is not None:
            one_of(axis, "axis", (0, -1), "an array of divisors has the axis 0 alone")
        if out is not None:
            raise ArgumentError(f"out = {shown(out)}: there is nothing to write a divisor to")
        rows, run = self._rows, self._engine
        if not len(rows):
            return self.jacobian.zero()
        while len(rows) > 1:
            half = len(rows) // 2
            total = run.add(run.take(rows, slice(half)), run.take(rows, slice(half, 2 * half)))
            rows = run.join([total, run.take(rows, slice(2 * half, None))]) if len(rows) % 2 else total
        return self._like(rows).to_list()[0]

    def __eq__(self, other: object) -> Any:
        if is_zero_int(other):
            return NotImplemented
        rows = self._operand(other)
        return NotImplemented if rows is NotImplemented else self._engine.equal(self._rows, rows)

    def __ne__(self, other: object) -> Any:
        same = self.__eq__(other)
        return NotImplemented if same is NotImplemented else ~same


_set_jacobian = vars(DivisorArray)["jacobian"].__set__
_set_engine = vars(DivisorArray)["_engine"].__set__
_set_rows = vars(DivisorArray)["_rows"].__set__


def _fill(array: DivisorArray, J: Jacobian, run: Any, rows: Any) -> None:
    _set_jacobian(array, J)
    _set_engine(array, run)
    _set_rows(array, rows)


def _rebuilt(J: Jacobian, u: Any, v: Any, n: Any) -> DivisorArray[Element]:
    return DivisorArray.from_arrays(J, u, v, n, check=False)


def _index_array(key: Any) -> Any:
    try:
        return np.asarray(key, None if np.size(key) else np.int64)
    except Exception:
        # numpy refuses ragged lists, and entries that it cannot compare
        raise ArgumentError(f"index = {shown(key)}: a slice, a mask or a flat array of ints is needed") from None


def _check_same(J: GroupLaw, other: GroupLaw) -> None:
    if other is not J and other != J:
        raise CurveMismatch(f"divisors of two curves cannot be combined: {J.curve!r} and {other.curve!r}")
