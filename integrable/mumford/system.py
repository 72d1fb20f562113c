"""A system on a Jacobian of any genus: a table of formulas, and everything derived from them.

A system (a file of :mod:`integrable.classical`) defines the formulas marked "defined by subclasses" below, written with
operators for numbers of any field. From them :class:`MumfordSystem` derives states, divisors, the vector field and
integrals, and over RR and MP the flow at any time. Elements of exact fields have no operators, so they are wrapped in
jets without directions (:mod:`integrable.phase.jets`). Jets with directions give exact derivatives of every formula.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterable, Sequence
from inspect import signature
from typing import TYPE_CHECKING, Any, NamedTuple, Self, TypeVar

import numpy as np

from integrable.mumford.fields import padded
from integrable.mumford.flow import MumfordFlow, Point, element
from integrable.mumford.motion import Start, settled_digits
from integrable.phase.body import elements
from integrable.phase.jets import Jet, JetField
from integrable.phase.made import Made
from integrable.phase.precisions import ROUNDED_TO_FLOATS, long_digits
from integrable.portrait.point_ovals import Form, Separation
from jacobian import RR, Divisor, HyperellipticCurve, poly
from jacobian.element import Element, FormulaField, Real, Value
from jacobian.errors import (
    ArgumentError,
    JacobianError,
    NotRepresentable,
    PrecisionLoss,
    one_of,
    shown,
    whole,
)
from jacobian.fields.protocol import Field, check_field
from jacobian.immutable import made_once, quick_property, replaced
from jacobian.inexact.long_field import LongField
from jacobian.relatives.extended import Extended

if TYPE_CHECKING:
    from integrable.mumford.recorded import PairFormulas
    from integrable.series.kinds import Kind

# a constraint holds if its value is below OFF times the change that q and p cause when their last digits change
OFF = 2.0**24
# formulas stay in the range of floats if |q| and |p| are below LARGE and constants are 0 or between 1/LARGE and LARGE
LARGE = 1e9
# smallest ``tolerance`` of a flow that Taylor series in floats can meet
LEAST = 2.0**-50


Found = TypeVar("Found")

IntegralsByName = dict[str, Element]
"""The integrals of motion by name, each a number or a tuple of numbers."""


class Spectral(NamedTuple):
    """The curve y² = f(x) of a state and the pair (u, v) on it; all coefficients are in ascending order."""

    f: poly.Poly
    u: poly.Poly
    v: poly.Poly


class MumfordSystem(Made):
    """Base class of systems. The ``constants`` and ``parameters`` are elements of ``field``; ``size`` is the number of
    coordinates q.
    """

    field: Field
    constants: tuple[Real, ...] = ()
    parameters: tuple[Real, ...] = ()
    size: int

    def _set_up(self, field: Field, values: Iterable[Value], argument: str, least: int) -> None:
        """Sets ``field`` and ``constants``; the constants must be at least ``least`` different numbers."""
        wanted = f"a sequence of at least {least} different numbers"
        constants = elements(check_field(field, "field"), values, argument, None, wanted)
        if len({*constants}) < max(least, len(constants)):
            raise ArgumentError(f"{argument} = {shown(values)}: {wanted} is needed")
        vars(self).update(field=field, constants=constants, size=len(constants))

    # --- the table of a system's formulas

    def _constraints(self, N: FormulaField, state: Point) -> Sequence[Real]:
        """Defined by subclasses: the values, over N, that must be 0 at a state."""
        return ()

    def _constrained(self, N: FormulaField, state: Point) -> Point:
        """Defined by subclasses: the state projected onto its constraints to all digits of N, an inexact field."""
        return state

    def _spectral(self, N: FormulaField, state: Point) -> Spectral:
        """Defined by subclasses: the curve and the pair of a state."""
        raise NotImplementedError

    def _genus(self) -> int:
        """Defined by subclasses: the degree of U; 0 if it depends on the state."""
        return 0

    def _direction(self, N: FormulaField, genus: int) -> Sequence[Real]:
        """Defined by subclasses: the c_k of :meth:`direction`."""
        raise NotImplementedError

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        """Defined by subclasses: (q', p') by the equations of motion."""
        raise NotImplementedError

    def _auxiliary(self, N: FormulaField, state: Point) -> tuple[Real, ...]:
        """Defined by subclasses with roots or exponentials in q' and p': functions y of q and p such that q', p' and y'
        are rational functions of q, p and y.
        """
        return ()

    def _rational_rates(self, N: FormulaField, state: Point, auxiliary: tuple[Real, ...]) -> tuple[Real, ...]:
        """Defined by subclasses with :meth:`_auxiliary`: q', p' and y', by the four operations."""
        rate = self._vector_field(N, state)
        return (*rate.q, *rate.p)

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """Defined by subclasses: the integrals of motion by name, as numbers or tuples of numbers."""
        raise NotImplementedError

    def _start(self, N: FormulaField, state: Point) -> Start:
        """Defined by subclasses: the start of the motion with its data, by default none."""
        f, u, v = self._spectral(N, state)
        return Start(f, u, v, self._direction(N, len(v)))

    def _back(self, N: FormulaField, start: Point, D: Extended, time: Real) -> Point:
        """Defined by subclasses: the state of a divisor D that the motion from ``start`` reaches after ``time``."""
        raise NotImplementedError

    def _action(self, N: FormulaField, state: Point) -> Form | None:
        """Defined by subclasses: the differential form whose sum over the points of a pair is p dq, without the terms
        of angles about an axis; None if no such form is known.
        """
        return None

    def _separation(self, N: FormulaField, state: Point) -> Separation:
        """Defined by subclasses if t is not linear in τ or if there are angles about an axis: the differential forms
        whose sums over the points of a pair are linear in time or are such angles.
        """
        genus = self._genus() or len(self._spectral(N, state).v)
        forms = [Form((*[N.zero] * j, N.one)) for j in range(genus)]
        return Separation(forms, self._direction(N, len(forms)), self._action(N, state), known=self._branches(N))

    def _branches(self, N: FormulaField) -> tuple[Real, ...]:
        """Defined by subclasses: branch points that all states share."""
        return ()

    flow_type: type[MumfordFlow] = MumfordFlow
    """The class of motions."""

    complex_data = False
    """Whether the data of the motion are complex; if so, ``_start`` and ``_back`` receive complex numbers."""

    _for_all_states = True
    """Whether ``_start`` and ``_back`` do the same operations for all states, so that they can be recorded once."""

    _least_axes = 0
    """If q_i = p_i = 0 at all times of a motion that begins so, where q_i belongs to the constant a_i alone: the least
    number of constants. 0 for other systems.
    """

    clocked = False
    """Whether t is not linear in τ. ``_clock`` then reads t from a pair, unless ``flow_type`` computes τ otherwise."""

    def _clock(self, N: FormulaField, D: Extended) -> tuple[Real, Real]:
        """Defined by subclasses whose pairs have t among their data: (t, dt/dτ) at a divisor of the motion."""
        raise NotImplementedError

    # --- derived from these formulas

    @property
    def numbers(self) -> Any:
        """A field whose elements have operators: jets without directions over an exact field, otherwise ``field``."""
        K = self.field
        return JetField(K, 0) if K.exact and not isinstance(K, JetField) else K

    @property
    def arguments(self) -> dict[str, object]:
        names = [name for name in signature(type(self)).parameters if name != "field"]
        given = (self.constants, *self.parameters) if self.constants else self.parameters
        return dict(zip(names, given, strict=True))

    def over(self, field: Field) -> Self:
        """The same system over another field, to which its constants and parameters are converted."""
        return self._of(field, tuple(map(check_field(field, "field").coerce, (*self.constants, *self.parameters))))

    def _of(self, field: FormulaField, numbers: Sequence[Any]) -> Self:
        """The system whose constants and parameters are ``numbers``, unchecked elements of ``field``."""
        count = len(self.constants)
        return replaced(self, field=field, constants=tuple(numbers[:count]), parameters=tuple(numbers[count:]))

    @property
    def _varied(self) -> dict[str, float]:
        """The scale of each constant and parameter, by name, from which difference quotients take their steps; 0 for
        one with respect to which no derivative is taken.
        """
        given = (value if isinstance(value, tuple) else (value,) for value in self.arguments.values())
        names = [
            f"{name}{i if len(x) > 1 else ''}"
            for name, x in zip(self.arguments, given, strict=True)
            for i in range(len(x))
        ]
        a = [*map(float, self.constants)]
        gaps = [min((abs(x - y) for y in a[:i] + a[i + 1 :]), default=abs(x) or 1.0) for i, x in enumerate(a)]
        return dict(zip(names, [*gaps, *(float(abs(x)) or 1.0 for x in self.parameters)], strict=False))

    def state(self, q: Iterable[Value], p: Iterable[Value]) -> Point:
        """The state with these q and p; ArgumentError if it does not satisfy the constraints of the system."""
        state = Point(elements(self.field, q, "q", self.size), elements(self.field, p, "p", self.size))
        self._check(state, None if self.field.exact else state)
        return state

    def _check(self, state: Point, inside: Point | None = None) -> None:
        """ArgumentError if a state violates a constraint; ``inside`` is the state over :attr:`numbers`, if known."""
        if self._last_checked is state:
            return
        N = self.numbers
        inside = inside or self._inside(N, state)
        # with ``finite=False`` an infinite value raises no PrecisionLoss; below it counts as a violated constraint
        values = self._formula(self._constraints, state, inside, finite=False) if self._constraint_names else ()
        sizes = [None] * len(values) if N.exact or not any(values) else self._constraint_sizes(inside)
        for name, value, size in zip(self._constraint_names, values, sizes, strict=True):
            if value != N.zero and (size is None or not abs(value) < OFF * N.eps * size):
                raise ArgumentError(
                    f"q, p = {shown(tuple(state))} are no state: {name} is needed, "
                    f"and is off by {shown(self._bare(value))}"
                )
        vars(self)["_last_checked"] = state

    _caches = ("_last_checked",)
    _last_checked = Point((), ())
    """The last state that was checked; at first a value that nobody gives, None included."""

    def _constraint_sizes(self, state: Point) -> list[Real]:
        """The change of each constraint if every q changed by the largest |q|, and every p by the largest |p|."""
        jets, n = JetField(self.field, 2 * self.size), self.size
        both = jets.variables((*state.q, *state.p))
        sizes = [max(map(abs, state.q))] * n + [max(map(abs, state.p))] * n
        return [
            sum(abs(slope) * size for slope, size in zip(jets.coerce(value).slopes, sizes, strict=True))
            for value in self._constraints(jets, Point(both[:n], both[n:]))
        ]

    _constraint_names: tuple[str, ...] = ()

    def _formula(
        self,
        formula: Callable[[FormulaField, Point], Found],
        state: Point,
        inside: Point | None = None,
        finite: bool = True,
    ) -> Found:
        """``formula(N, state)`` over the field; PrecisionLoss if a value exceeds the range of floats."""
        N = self.numbers
        try:
            found = formula(N, inside or self._inside(N, state))
        except JacobianError:
            raise
        except (ArithmeticError, ValueError):
            if N.exact:
                raise
        else:
            if not finite or _in_range(found):
                return found
        raise PrecisionLoss(
            f"q, p = {shown(tuple(state))}: the formulas of {self!r} go beyond the range of {N.name} there; use "
            "MP(digits), or another unit"
        )

    def spectral(self, state: Point) -> Spectral:
        """The polynomials f, u and v of a state, with all coefficients in ascending order."""
        return Spectral(*(tuple(map(self._bare, a)) for a in self._formula(self._spectral, state)))

    def divisor(self, state: Point[Element]) -> Divisor[Element]:
        """The class of the state's pair in the Jacobian of its curve."""
        f, u, v = self.spectral(state)
        return HyperellipticCurve(self.field, f).jacobian().from_mumford(u, v)

    def integrals(self, state: Point) -> IntegralsByName:
        """The integrals of motion by name."""
        found = self._formula(self._integrals, state)
        return {name: tuple(map(self._bare, x)) if isinstance(x, tuple) else self._bare(x) for name, x in found.items()}

    def vector_field(self, state: Point[Element]) -> Point[Element]:
        """The derivatives (q', p') by the equations of motion."""
        return self._outside(self._formula(self._vector_field, state))

    def linearized(self, state: Point) -> np.ndarray:
        """The derivatives of (q', p') with respect to (q, p) at a state, shape (2n, 2n), exact over an exact field."""
        n = self.size
        jets = JetField(self.field, 2 * n)
        both = jets.variables((*state.q, *state.p))
        rates = self._vector_field(jets, Point(both[:n], both[n:]))
        slopes = [jets.coerce(x).slopes for x in (*rates.q, *rates.p)]
        return np.array(slopes, dtype=float if self.field is RR else object)

    def direction(self, genus: int) -> tuple[Real, ...]:
        """The direction c of the motion, Σ_i x_i^k dx_i/y_i = c_k dτ."""
        wanted = f"the genus of a curve of {self!r} is an int, 1 … {self.size}"
        genus = whole(genus, "genus", wanted, 1, self.size)
        return tuple(map(self._bare, self._direction(self.numbers, genus)))

    def _with(self, N: FormulaField, numbers: Sequence[Any], standing: tuple[bool, ...] | None = None) -> MumfordSystem:
        """The system with other constants and parameters, except that those parameters are 0 that are not ``standing``,
        by default those that are 0 already: their terms may divide by quantities that vanish.
        """
        standing = (*(True for _ in self.constants), *(self._standing if standing is None else standing))
        return self._of(N, [x if stands else N.zero for x, stands in zip(numbers, standing, strict=True)])

    @property
    def _standing(self) -> tuple[bool, ...]:
        return tuple([x != self.field.zero for x in self.parameters])

    @property
    def _alike(self) -> tuple[object, ...]:
        """A key: systems with equal keys differ only in their numbers, and share recorded formulas."""
        return type(self), self.size, len(self.constants), self._standing

    @quick_property
    def _kind(self) -> Kind | None:
        """The compiled walks of all systems with this :attr:`_alike`; None if the formulas cannot be recorded."""
        return made_once(("walks", *self._alike), self._made_kind)

    def _made_kind(self) -> Kind | None:
        from integrable.series.kinds import Formulas, Kind
        from integrable.series.symbols import Symbol, SymbolField

        n, count = self.size, len(self.constants) + len(self.parameters)
        system = self._with(SymbolField(), [Symbol(("constant", i)) for i in range(count)])

        def point(y: Sequence[Real]) -> Point:
            return Point(tuple(y[:n]), tuple(y[n : 2 * n]))

        def start(N: FormulaField, y: Sequence[Real]) -> tuple[Real, ...]:
            inner = system._constrained(N, point(y))
            return *inner.q, *inner.p, *system._auxiliary(N, inner)

        def rates(N: FormulaField, y: Sequence[Real]) -> tuple[Real, ...]:
            return system._rational_rates(N, point(y), tuple(y[2 * n :]))

        rest = Point((RR.zero,) * n, (RR.zero,) * n)
        try:
            variables = 2 * n + len(self._auxiliary(RR, rest))
            return Kind(type(self).__name__, Formulas(rates, start, 2 * n, variables, n))
        except (TypeError, ArgumentError):
            # the equations call a function that cannot be recorded
            return None

    @quick_property
    def _formulas(self) -> PairFormulas | None:
        """The recorded formulas between states and pairs; None if they cannot be recorded."""
        return made_once(("pairs", *self._alike), self._made_formulas) if self._for_all_states else None

    def _made_formulas(self) -> PairFormulas | None:
        from integrable.mumford.recorded import PairFormulas

        n = self.size

        def given(N: FormulaField, y: Sequence[Real]) -> tuple[MumfordSystem, Point]:
            return self._with(N, y[2 * n :]), Point(tuple(y[:n]), tuple(y[n : 2 * n]))

        def start(N: FormulaField, y: Sequence[Real]) -> tuple[Point, Start]:
            system, state = given(N, y)
            inner = system._constrained(N, state)
            return inner, system._start(N, inner)

        def back(N: FormulaField, y: Sequence[Real], D: Extended, time: Real) -> Point:
            system, state = given(N, y)
            return system._back(N, state, D, time)

        try:
            return PairFormulas(start, back, 2 * n + len(self.constants) + len(self.parameters))
        except (TypeError, ArgumentError, NotImplementedError):
            # a formula calls a function that cannot be recorded, or the system does not define _back
            return None

    @property
    def _walk_constants(self) -> tuple[float, ...]:
        """The constants and parameters of a system over RR; the final 0 keeps the tuple from being empty."""
        found: tuple[Any, ...] = (*self.constants, *self.parameters, 0.0)
        return found

    def _of_moving_axes(self, state: Point) -> tuple[MumfordSystem, Point, list[int]] | None:
        """The system with those axes alone in which a motion moves, its state, and the indices of these axes; None if
        they are all axes.
        """
        axes = [i for i, pair in enumerate(zip(*state, strict=True)) if any(x != self.field.zero for x in pair)]
        axes = sorted([*axes, *(i for i in range(self.size) if i not in axes)][: max(self._least_axes, len(axes))])
        if not self._least_axes or len(axes) == self.size:
            return None
        a = [self.constants[i] for i in axes]
        system = type(self)(**{**self.arguments, "a": a}, field=self.field)  # type: ignore[call-arg]
        return system, Point(*(tuple(x[i] for i in axes) for x in state)), axes

    def flow(self, state: Point, tolerance: float | None = None) -> MumfordFlow:
        """The motion of a state over RR or MP(digits), at any times.

        ``tolerance`` is the allowed error, over RR, of states near the start, relative to the largest component of q,
        or of p. With a tolerance these states take half the time, and ``estimate`` of the path estimates their error.
        ArgumentError if the tolerance is not between 2^−50 and 1.
        """
        self._check_range(state)
        return self.flow_type(self, state, self._tolerance(tolerance))

    def _check_range(self, state: Point) -> None:
        """:meth:`_check`, and PrecisionLoss if the formulas exceed the range of floats at the state."""
        self._check(state)
        if self.field is RR and max(map(abs, (*state.q, *state.p))) < self._ordinary_size:
            sizes = [*map(abs, filter(None, (1.0, *self.constants, *self.parameters)))]
            if min(sizes) > 1 / LARGE and max(sizes) < LARGE:
                return
        self.spectral(state)

    _ordinary_size = LARGE
    """The bound on |q_i| and |p_i| below which formulas stay in the range of floats."""

    def _tolerance(self, tolerance: float | None) -> float | None:
        if tolerance is None:
            return None
        wanted = "a number between 2^-50 and 1 is needed, of a flow over RR"
        if self.field is not RR or not isinstance(tolerance, int | float) or not LEAST <= tolerance < 1:
            raise ArgumentError(f"tolerance = {shown(tolerance)}: {wanted}")
        return float(tolerance)

    def curve_point(self, state: Point[Element], x: Value, sign: int = 1) -> tuple[Element, Element]:
        """The point (x, ±√f(x)) on the curve of a state, for a step; NotASquare if f(x) has no root in the field."""
        K, sign = self.field, one_of(sign, "sign", (1, -1), "give 1 or -1")
        at = K.coerce(x, "x")
        y = K.sqrt(poly.evaluate(K, self.spectral(state).f, at))
        return at, y if sign > 0 else K.neg(y)

    def _time_step(self, h: Value) -> Real:
        """The time step h as an element of the field, RR or MP(digits); ArgumentError if its square is 0."""
        long_digits(self.field)
        step: Real = self.field.coerce(h, "h")
        if self.field.mul(step, step) == self.field.zero:
            raise ArgumentError(f"h = {shown(h)}: a step of time other than 0 is needed")
        return step

    def _mapped(
        self, state: Point, point: Iterable[Value], formula: Callable[[FormulaField, Point, Real, Real], Point]
    ) -> Point:
        """``formula(N, state, λ, μ)`` at a point (λ, μ) of the curve.

        Over inexact fields it is evaluated in long numbers, and μ is recomputed so that the point is on the curve.
        ArgumentError if the point is not near the curve, NotRepresentable if an exact formula divides by 0,
        PrecisionLoss if no precision suffices.
        """
        N = self.numbers
        x, y = elements(N, point, "point", 2, "a pair (λ, μ)")
        f = self._formula(self._spectral, state).f
        rest = y * y - poly.evaluate(N, f, x)
        size = None if N.exact else abs(y) ** 2 + sum(abs(c * x**i) for i, c in enumerate(f))
        if (rest != N.zero) if size is None else abs(rest) > OFF * N.eps * size:
            raise ArgumentError(f"point = {shown(point)} is not on the curve of the state: μ² = f(λ) is needed")
        if N.exact:
            try:
                return self._outside(formula(N, self._inside(N, state), x, y))
            except ZeroDivisionError:
                raise NotRepresentable(
                    f"point = {shown(point)}: the step by it leads to no state; give another point"
                ) from None

        def read(L: LongField) -> Point:
            inner, at = self._constrained(L, self._inside(L, state)), L.coerce(x)
            root = L.sqrt(poly.evaluate(L, self._spectral(L, inner).f, at))
            return formula(L, inner, at, root if abs(root - L.coerce(y)) <= abs(root + L.coerce(y)) else -root)

        return self._settled(read)

    def _settled(self, read: Callable[[LongField], Point]) -> Point:
        """The state that ``read`` computes in long numbers, rounded to the digits of the field."""
        K: Any = self.field
        rows = settled_digits(read, K.dps or ROUNDED_TO_FLOATS)
        return Point(*(tuple(element(K, c) for c in row) for row in rows))

    def _inside(self, N: FormulaField, state: Point) -> Point:
        if not (isinstance(state, Point) and len(state.q) == len(state.p) == self.size):
            raise ArgumentError(f"state = {shown(state)}: give one that state(q, p) of {self!r} returns")
        return Point(tuple(map(N.coerce, state.q)), tuple(map(N.coerce, state.p)))

    def _bare(self, x: Real) -> Real:
        return x.value if self.numbers is not self.field and isinstance(x, Jet) else x

    def _outside(self, state: Point) -> Point:
        return Point(tuple(map(self._bare, state.q)), tuple(map(self._bare, state.p)))

    def _constants_in(self, N: FormulaField) -> tuple[Real, ...]:
        return tuple(map(N.coerce, self.constants))

    def _parameters_in(self, N: FormulaField) -> tuple[Real, ...]:
        return tuple(map(N.coerce, self.parameters))

    def _sums(self, N: FormulaField, weights: Sequence[Real]) -> poly.Poly:
        """The polynomial Π(x − a_i)·Σ weight_i/(x − a_i) with all coefficients, where the a_i are the constants."""
        a = self._constants_in(N)
        total = [N.zero] * len(a)
        for i, weight in enumerate(weights):
            rest = poly.from_roots(N, [*a[:i], *a[i + 1 :]])
            total = [x + weight * y for x, y in zip(total, rest, strict=True)]
        return tuple(total)


def _in_range(found: object) -> bool:
    """Whether ``found``, a number or a tuple or dict of numbers, contains only finite floats."""
    if isinstance(found, dict):
        found = tuple(found.values())
    if isinstance(found, tuple):
        return all(map(_in_range, found))
    return cmath.isfinite(found) if isinstance(found, (float, complex)) else True


def uhlenbeck(a: Sequence[Real], state: Point, first: Sequence[Real]) -> tuple[Real, ...]:
    """Uhlenbeck's integrals first_i + Σ_j (q_i p_j − q_j p_i)²/(a_i − a_j) (Moser 1980)."""
    q, p = state
    found = []
    for i, total in enumerate(first):
        for j in range(len(a)):
            if j != i:
                momentum = q[i] * p[j] - q[j] * p[i]
                total = total + momentum * momentum / (a[i] - a[j])
        found.append(total)
    return tuple(found)


def all_of(N: FormulaField, spectral: tuple[poly.Poly, poly.Poly, poly.Poly], genus: int) -> Spectral:
    """f, u, v with all coefficients of u and v restored; arithmetic over exact fields trims leading zeros."""
    f, u, v = spectral
    return Spectral(f, (*padded(N, u, genus), N.one), padded(N, v, genus))
