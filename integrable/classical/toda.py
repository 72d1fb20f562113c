"""The periodic Toda lattice of n particles (Toda 1967; Flaschka & McLaughlin 1976; Suris 2003 for its discrete time).

H = ½Σp_k² + Σe^{q_{k+1} − q_k}, indices modulo n: q' = p, p_k' = e^{q_{k+1} − q_k} − e^{q_k − q_{k−1}}. With

    L_k = [[x + p_k, e^{q_k}], [−e^{−q_k}, 0]],   L_n⋯L_1 = [[A, B], [C, D]],   Δ = A + D

the curve is y² = Δ² − 4 of genus n − 1. U is B divided by its leading coefficient, V = (A − D) mod U, and the direction
is −e_{n−2}. Conversely A = ½(Δ + V + (x + β)U), β = Δ_{n−1} − u_{n−2}. Euclid's algorithm on (A, U) has the quotients x
+ p_1, x + p_2, … and the remainders −e^{q_{k+1} − q_k} times monic polynomials. The centre of mass moves uniformly.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import accumulate
from math import prod
from operator import mul
from typing import SupportsIndex

from integrable.mumford.fields import elementary
from integrable.mumford.flow import Point
from integrable.mumford.maps import plus_point_minus_infinity
from integrable.mumford.system import IntegralsByName, MumfordSystem, Spectral, all_of
from integrable.portrait.point_ovals import Form
from jacobian import RR, poly
from jacobian.element import FormulaField, Real, Value
from jacobian.errors import one_of, whole
from jacobian.fields.protocol import Field, check_field
from jacobian.immutable import at_once
from jacobian.relatives.extended import Extended


class TodaLattice(MumfordSystem):
    """The periodic Toda lattice: n ≥ 2 particles of mass 1 on a ring, with the potential Σe^{q_{k+1} − q_k}.

    Over an exact field, which has no exponentials, the q of a state are e^{q_k}.
    """

    @at_once
    def __init__(self, n: SupportsIndex, field: Field = RR) -> None:
        wanted = "the number of particles is an int ≥ 2"
        vars(self).update(field=check_field(field, "field"), size=whole(n, "n", wanted, 2))

    @property
    def arguments(self) -> dict[str, object]:
        return {"n": self.size}

    def _constraints(self, N: FormulaField, state: Point) -> Sequence[Real]:
        # over an exact field the q are exponentials, which cannot be 0
        return (N.one if N.exact and N.zero in state.q else N.zero,)

    _constraint_names = ("e^q ≠ 0",)

    def _exponentials(self, N: FormulaField, state: Point) -> tuple[Real, ...]:
        """e^{q_k − q_1}, or e^{q_k} over an exact field; both give the same U, V and f."""
        if N.exact:
            return state.q
        return tuple(elementary(N, "exp", x - state.q[0]) for x in state.q)

    def _links(self, N: FormulaField, state: Point) -> list[Real]:
        """e^{q_{k+1} − q_k}, k = 1 … n."""
        w = self._exponentials(N, state)
        return [w[(k + 1) % self.size] / w[k] for k in range(self.size)]

    def _transfer(self, N: FormulaField, state: Point) -> list[list[poly.Poly]]:
        """The transfer matrix [[A, B], [C, D]] = L_n⋯L_1."""
        rows: list[list[poly.Poly]] = [[(N.one,), ()], [(), (N.one,)]]
        for w, p in zip(self._exponentials(N, state), state.p, strict=True):
            above, below = rows
            # [[x + p, w], [−1/w, 0]] times the rows
            pairs = zip(above, below, strict=True)
            rows = [
                [poly.add(N, poly.mul(N, (p, N.one), x), poly.scale(N, w, y)) for x, y in pairs],
                [poly.scale(N, -1 / w, x) for x in above],
            ]
        return rows

    def _spectral(self, N: FormulaField, state: Point) -> Spectral:
        (a, b), (_, d) = self._transfer(N, state)
        trace, size = poly.add(N, a, d), self.size
        f = poly.sub(N, poly.mul(N, trace, trace), (poly.integer(N, 4),))
        u = poly.monic(N, b[:size])
        return all_of(N, (f, u, poly.mod(N, poly.sub(N, a, d), u)), size - 1)

    @property
    def _ordinary_size(self) -> float:  # type: ignore[override]
        # f has exponentials of sums over the ring, which must stay in the range of floats
        return 100 / self.size

    def _genus(self) -> int:
        return self.size - 1

    def _direction(self, N: FormulaField, genus: int) -> Sequence[Real]:
        return (*[N.zero] * (genus - 1), poly.integer(N, -1))

    def _action(self, N: FormulaField, state: Point) -> Form:
        """The form −x dμ/μ = −xΔ' dx/y, where μ + 1/μ = Δ, the trace of L_n⋯L_1."""
        return Form((N.zero, *poly.neg(N, poly.derivative(N, self._trace(N, state)))))

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        if N.exact:  # q are exponentials, with the derivatives qp
            links, rates = self._links(N, state), tuple(x * y for x, y in zip(state.q, state.p, strict=True))
        else:  # exponentials of differences, since the quotients in _links may overflow
            q, rates = state.q, state.p
            links = [elementary(N, "exp", q[(k + 1) % self.size] - q[k]) for k in range(self.size)]
        return Point(rates, tuple(links[k] - links[k - 1] for k in range(self.size)))

    def _auxiliary(self, N: FormulaField, state: Point) -> tuple[Real, ...]:
        """e^{q_{k+1} − q_k} − 1, which loses no digits if all q nearly coincide."""
        q = state.q
        return tuple(elementary(N, "expm1", q[(k + 1) % self.size] - q[k]) for k in range(self.size))

    def _rational_rates(self, N: FormulaField, state: Point, auxiliary: tuple[Real, ...]) -> tuple[Real, ...]:
        p = state.p
        pulls = (auxiliary[k] - auxiliary[k - 1] for k in range(self.size))
        pushes = (p[(k + 1) % self.size] - p[k] for k in range(self.size))
        return (*p, *pulls, *(push + x * push for x, push in zip(auxiliary, pushes, strict=True)))

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """The coefficients of Δ, ascending, and H, which is a polynomial in them."""
        energy = sum(self._links(N, state), N.dot(state.p, state.p) / 2)
        return {"trace": self._trace(N, state), "H": energy}

    def _trace(self, N: FormulaField, state: Point) -> poly.Poly:
        """The trace Δ = A + D of the matrix of :meth:`_transfer`."""
        (a, _), (_, d) = self._transfer(N, state)
        return poly.add(N, a, d)

    def _back(self, N: FormulaField, start: Point, D: Extended, time: Real) -> Point:
        p, links = self._chain(N, start, (D.u, D.v))
        q = [*accumulate((elementary(N, "log", link) for link in links), initial=N.zero)]
        # the sum of the q is Σq(0) + tΣp
        total = sum(start.q, N.zero) + time * sum(start.p, N.zero)
        shift = (total - sum(q, N.zero)) / self.size
        return Point(tuple(x + shift for x in q), tuple(p))

    def _chain(self, N: FormulaField, start: Point, pair: tuple[poly.Poly, poly.Poly]) -> tuple[list[Real], list[Real]]:
        """p_1 … p_n and e^{q_{k+1} − q_k}, k < n, from a pair on the curve of ``start``."""
        u, v = pair
        size = self.size
        trace = self._trace(N, start)
        beta = trace[size - 1] - (u[size - 2] if size > 1 else N.zero)
        twice = poly.add(N, poly.add(N, trace, poly.trim(N, v) if N.exact else v), poly.mul(N, (beta, N.one), u))
        half = 1 / poly.integer(N, 2)
        above, below = poly.scale(N, half, twice), u
        p, links = [], []
        for k in range(size):
            quotient, rest = poly.divide(N, above, below)
            p.append(quotient[0])
            if k < size - 1:
                links.append(-rest[size - 2 - k])
                above, below = below, (*[c / rest[size - 2 - k] for c in rest[: size - 2 - k]], N.one)
        return p, links

    def discrete(self, state: Point, h: Value) -> Point:
        """The state after the :meth:`step` by a point with λ = 1/h, which agrees with the motion for a time h to first
        order. The motion of the centre of mass is exact.
        """
        step = self._time_step(h)
        new = self.step(state, self.curve_point(state, 1 / step))
        shift = (sum(state.q) + step * sum(state.p) - sum(new.q)) / self.size
        return Point(tuple(x + shift for x in new.q), new.p)

    def step(self, state: Point, point: Iterable[Value], sheet: int = 1) -> Point:
        """The state (q̃, p̃) after a step in discrete time (Suris 2003).

        Its divisor is D + P − ∞₊, or D + P − ∞₋ for ``sheet`` −1. D is the divisor of ``state``, and P = (λ, μ) is
        ``point``.

        p_k + λ = e^{q̃_k − q_k} + e^{q_k − q̃_{k−1}}, p̃_k + λ = e^{q̃_k − q_k} + e^{q_{k+1} − q̃_k}; for ``sheet`` −1,
        p_k + λ = e^{q̃_{k+1} − q_k} + e^{q_k − q̃_k}, p̃_k + λ = e^{q̃_k − q_{k−1}} + e^{q_k − q̃_k}. The state is real
        if μ² = f(λ) ≥ 0.
        """
        sheet = one_of(sheet, "sheet", (1, -1), "give 1 or -1")

        def formula(N: FormulaField, here: Point, x: Real, y: Real) -> Point:
            f, u, v = self._spectral(N, here)
            pair = plus_point_minus_infinity(N, f, (u, v), (x, y), N.one if sheet == 1 else -N.one)
            p, links = self._chain(N, here, pair)
            w = [*accumulate(links, mul, initial=self._first(N, here, links, x, sheet))]
            if N.exact:
                return Point(tuple(here.q[0] * c for c in w), tuple(p))
            return Point(tuple(here.q[0] + elementary(N, "log", c) for c in w), tuple(p))

        return self._mapped(state, point, formula)

    def _first(self, N: FormulaField, here: Point, new: list[Real], x: Real, sheet: int) -> Real:
        """X = e^{q̃_1 − q_1}, from the equations for p_1 and p_2, which are linear in X and 1/X."""
        old, around = self._links(N, here), prod(new, start=N.one)
        left = [here.p[k % self.size] + x for k in (0, 1)]
        if sheet == 1:
            rows = ((N.one, 1 / around), (new[0] / old[0], old[0]))
        else:
            second = new[1] * new[0] if self.size > 2 else N.one
            rows = ((new[0], N.one), (second / old[0], old[0] / new[0]))
        (a, b), (c, d) = rows
        return (left[0] * d - b * left[1]) / (a * d - b * c)
