"""A state of a tilde, check or hat pair as two points, one on each of its elliptic curves, and the maps that add points
there.

ũ_k are the roots of Σ w_i²(x − a_j)(x − a_k), w = γ × M; λ_k = H1 − ũ_kH2; y_k = dũ_k/dτ along the flow of H̃. With μ_k
= λ_kΠ(1 − da_i) the point (Z, Y) = (μ_kũ/(1 − dũ), μ_ky/(1 − dũ)²) lies on Y² = 4Π(Z − μ_k/I_i). The curves are ordered
by λ: over the reals ũ1 < ũ2, over an exact field by the field's numbering. To find the points, the quadratic of ũ is
solved; the inverse needs square roots of w_i² and of g². (Tsiganov's separation.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from integrable.deformations.hamiltonian import Hamiltonian
from integrable.deformations.separated_flow import SeparatedFlow
from integrable.mumford.elliptic_torus import EllipticOval
from integrable.phase import coordinates
from integrable.phase.body import Vector, cross, square_root
from integrable.phase.isometry import lift, roots
from integrable.phase.jets import Jet
from integrable.phase.space import check_moving
from integrable.phase.state import State
from integrable.steps.step import Step, checked_multiple, checked_signs
from jacobian import HyperellipticCurve, poly
from jacobian.element import Arithmetic, Real, Value
from jacobian.errors import ArgumentError, NotASquare, NotRepresentable, PrecisionLoss, entries, shown, written
from jacobian.fields.quadratic import quadratic_roots
from jacobian.relatives.signed import Pair

if TYPE_CHECKING:
    from jacobian import Divisor


Abscissas = Sequence[Value | None]
"""Values of ũ on both curves; None adds nothing."""


class TwoPoints(NamedTuple):
    """A divisor on each of the two elliptic curves of a state."""

    first: Divisor
    second: Divisor


class _Image(NamedTuple):
    """The image of a state: ũ, y = dũ/dτ and λ of both curves, and the pairs (w_i, N_i).

    w_iN_i = V(a_i)/c_i, where V is linear with V(ũ_k) = y_k, and c_i = (a_j − a_i)(a_k − a_i).
    """

    u: list[Real]
    y: list[Real]
    lambdas: list[Real]
    pairs: tuple[Pair, ...]


def divisors(system: Hamiltonian, state: State) -> TwoPoints:
    """The two points of a state of a pair without potential; for a check or hat pair, those on its tilde pair's curves.

    NotASquare if ũ1, ũ2 (as in the module's docstring) or g are not in the field. NotRepresentable if moments are
    equal, ũ1 = ũ2, or K = 0.
    """
    system, state = curves_of(system), lifted(system, state)
    image = _image(system, state)
    points = []
    K = system.field
    for u, y, value in zip(image.u, image.y, image.lambdas, strict=True):
        if value == K.zero:
            raise NotRepresentable("λ = 0: K vanishes, and one of the two curves degenerates")
        mu = K.mul(value, _contact(system))
        slow = K.sub(K.one, K.mul(system.d, u))
        if slow == K.zero:
            raise NotRepresentable(f"ũ = {u} = 1/d: the point is at infinity")
        z, v = K.div(K.mul(mu, u), slow), K.div(K.mul(mu, y), K.mul(slow, slow))
        f = poly.from_roots(K, [K.div(mu, moment) for moment in system.body.inertia])
        curve = HyperellipticCurve(K, poly.scale(K, poly.integer(K, 4), f))
        points.append(curve.jacobian().from_points([(z, v)]))
    return TwoPoints(*points)


def from_divisors(system: Hamiltonian, points: TwoPoints, like: State | None = None) -> State:
    """The state that belongs to two points, with the signs of ``like``; raises the errors of :func:`divisors`.

    Without ``like`` the signs are those of the field's square roots. Over an exact field ``like`` has an effect only if
    it is the same state up to signs.
    """
    if not isinstance(points, TwoPoints):
        raise ArgumentError(f"D = {shown(points)}: give TwoPoints, as the system's divisor(state)")
    given, system = system, curves_of(system)
    K, body = system.field, system.body
    like = None if like is None else lifted(given, like)
    known_pairs = (None,) * 3 if like is None else _image(system, like).pairs
    named = zip(points._fields, points, strict=True)
    u, y, lambdas = zip(*(_on_curve(system, name, D) for name, D in named), strict=True)
    gap = K.sub(u[1], u[0])
    if gap == K.zero:
        raise NotRepresentable(f"ũ1 = ũ2 = {written(u[0])}: M is infinite there, and no state has both points")
    h2 = K.div(K.sub(lambdas[0], lambdas[1]), gap)
    if h2 == K.zero:
        raise NotRepresentable("λ1 = λ2: the two curves are one, and M is not determined")
    h1 = K.add(lambdas[0], K.mul(u[0], h2))
    quadratic, v = poly.through(K, list(zip(u, y, strict=True)))
    square = poly.mul(K, poly.trim(K, v), poly.trim(K, v)) if K.exact else poly.mul(K, v, v)
    cofactor = poly.quotient(K, poly.sub(K, body.polynomial(h1, h2), square), quadratic)
    pairs = []
    for a, c, known in zip(system.a, body.differences, known_pairs, strict=True):
        w2, product = (K.div(poly.evaluate(K, p, a), c) for p in (quadratic, v))
        other = K.neg(K.div(poly.evaluate(K, cofactor, a), K.mul(c, h2)))
        pairs.append(coordinates.root_pair(K, K.mul(w2, h2), product, other, known))
    return unlifted(given, _state(system, pairs, u, h1, h2, like))


def _on_curve(system: Hamiltonian, name: str, D: Divisor) -> tuple[Real, Real, Real]:
    """(ũ, y, λ) of the divisor D on one curve; messages call it ``name``."""
    K = system.field
    if len(D.u) != 2:
        raise NotRepresentable(f"{name} = {D!r} is the point at infinity: no state has it")
    mu = _mu_of(system, D.jacobian.curve.f)
    z, v = K.neg(D.u[0]), poly.evaluate(K, D.v, K.zero)
    rest = K.add(mu, K.mul(system.d, z))
    if rest == K.zero:
        raise NotRepresentable(f"{name} = {D!r}: ũ is infinite there, and no state has it")
    slow = K.div(mu, rest)
    return K.div(z, rest), K.div(K.mul(v, K.mul(slow, slow)), mu), K.div(mu, _contact(system))


def _contact(system: Hamiltonian) -> Real:
    """The product Π(1 − da_i), which is μ_k/λ_k on both curves k."""
    K, r = system.field, system.body.contact
    return K.mul(r[0], K.mul(r[1], r[2]))


def _mu_of(system: Hamiltonian, f: poly.Poly) -> Real:
    """μ of the curve f = 4Π(Z − μ/I_i), from Σ1/I; if that is 0 in the field, from ΣI and the lowest coefficients."""
    K, inertia = system.field, system.body.inertia
    four, total = poly.integer(K, 4), K.dot([K.inv(x) for x in inertia], (K.one,) * 3)
    if not K.is_zero(total):
        return K.neg(K.div(f[2], K.mul(four, total)))
    if len(f) < 2 or K.is_zero(f[1]):
        raise NotRepresentable(f"Σ1/I and ΣI vanish in {K.name}: the curve does not determine its μ")
    return K.neg(K.mul(K.div(f[0], f[1]), K.dot(inertia, (K.one,) * 3)))


def _image(system: Hamiltonian, state: State) -> _Image:
    K, body, a = system.field, system.body, system.a
    if any(c == K.zero for c in body.differences):
        raise NotRepresentable("two moments of inertia are equal: the separated variables do not determine γ")
    h1, h2 = body.integrals(*state.vectors)[2:]
    check_moving(K, h2)
    w = cross(K, *state.vectors)
    squares = [K.div(K.mul(x, x), h2) for x in w]
    total = K.dot(squares, [K.add(a[i - 2], a[i - 1]) for i in range(3)])
    u = quadratic_roots(K, K.neg(total), K.neg(K.dot(squares, [K.mul(a[i - 2], a[i - 1]) for i in range(3)])))
    if not u:
        raise NotASquare(f"ũ1 and ũ2 are conjugate over {K.name}: the two curves are not defined there")
    if len(u) == 1:
        raise NotRepresentable(f"ũ1 = ũ2 = {u[0]}: the two curves are one")
    lambdas = [K.sub(h1, K.mul(x, h2)) for x in u]
    if not _first(K, *lambdas):
        u, lambdas = u[::-1], lambdas[::-1]
    pairs = _pairs(system, state, w, h2)
    y = []
    for x in u:
        terms = [K.mul(K.sub(x, a[i - 2]), K.sub(x, a[i - 1])) for i in range(3)]
        y.append(K.dot([K.mul(*pair) for pair in pairs], terms))
    return _Image(u, y, lambdas, pairs)


def _first(K: Any, x: Any, y: Any) -> bool:
    """Whether λ = x precedes λ = y: over the reals if x > y, over an exact field if ``K.key(x) < K.key(y)``."""
    if not K.exact:
        return bool(x > y)
    while isinstance(x, Jet):
        K, x, y = K.base, x.value, y.value
    return bool(K.key(x) < K.key(y))


def _pairs(system: Hamiltonian, state: State, w: Vector, h2: Real) -> tuple[Pair, ...]:
    """The pairs (w_i, N_i), N_i = c·w_i − 2g(1 − da_i)γ_i, with c such that (w, N) = 0."""
    K, body, (gamma, _) = system.field, system.body, state.vectors
    g = coordinates.g_of(body, state) if body.rolls else K.one
    scaled = [K.mul(K.add(g, g), K.mul(r, x)) for r, x in zip(body.contact, gamma, strict=True)]
    lean = K.div(K.dot(w, scaled), h2)
    return tuple((x, K.sub(K.mul(lean, x), y)) for x, y in zip(w, scaled, strict=True))


def _state(
    system: Hamiltonian, pairs: Sequence[Pair], u: Sequence[Real], h1: Real, h2: Real, like: State | None
) -> State:
    K, body = system.field, system.body
    w, n = (tuple(column) for column in zip(*pairs, strict=True))
    over = [K.div(x, r) for x, r in zip(w, body.contact, strict=True)]
    lean = K.div(K.dot(over, n), K.dot(over, w))
    g = K.one
    if body.rolls:
        above = K.sub(h2, K.mul(body.d, h1))
        below = K.mul(h2, K.mul(*(K.sub(K.one, K.mul(body.d, x)) for x in u)))
        if above == K.zero:
            raise NotRepresentable("H2 = d·H1: g vanishes at these points, and no state has them")
        g = square_root(K, K.div(above, below), "g²")
        if like is not None and like.g is not None and K.neg(g) == like.g:
            g = K.neg(g)
    half = K.inv(K.add(g, g))
    x1, x2, x3 = (K.mul(half, K.div(K.sub(K.mul(lean, x), y), r)) for x, y, r in zip(w, n, body.contact, strict=True))
    gamma = (x1, x2, x3)
    return State(gamma, cross(K, w, gamma), g if body.rolls and K.exact else None)


class CurveTranslation(Step):
    """The map that adds, on each curve, ``multiple`` times the point with a given abscissa.

    ``points`` = (x1, x2) are the abscissas, as values of ũ; None adds nothing on that curve. The map preserves λ1 and
    λ2, hence H and K. It preserves the bracket, because on each curve it is the time-1 map of the Hamiltonian F = δ√λ
    with δ fixed: the motion for the time 2F'(λ). It commutes with the flow in τ. Over RR and MP the signs of γ follow
    by continuity from the identity; over exact fields they are those of the field's square roots. NotASquare if the
    image is not over the field. Over the reals the image is real if μ_kx_k/(1 − dx_k) ≥ every μ_k/I_i.
    """

    def __init__(
        self, system: Hamiltonian, points: Abscissas, sheets: Sequence[int] | None = None, multiple: int = 1
    ) -> None:
        self.system = system
        wanted = "two abscissas, one for each curve, None for no addition"
        given = entries(points, "points", wanted)
        if len(given) != 2 or all(x is None for x in given):
            raise ArgumentError(f"points = {shown(points)}: give {wanted}")
        K = system.field
        self.points = tuple(None if x is None else K.coerce(x, f"points[{k}]") for k, x in enumerate(given))
        # in floats the product of d and a neighbour of 1/d may be 1, and that of d and 1/d may not
        there = [x for x in self.points if x is not None]
        if system.body.rolls and any(x == K.inv(system.d) or K.mul(system.d, x) == K.one for x in there):
            raise ArgumentError(
                f"points = {shown(points)}: 1/d is the point at infinity, which adds nothing; give None for it"
            )
        self.sheets = checked_signs(sheets, 2, "sheets")
        self.multiple = checked_multiple(multiple)

    def __repr__(self) -> str:
        return f"<addition of {self.multiple}·{self.points} on the curves of {self.system!r}>"

    def __mul__(self, m: int) -> CurveTranslation:
        return CurveTranslation(self.system, self.points, self.sheets, self.multiple * checked_multiple(m))

    __rmul__ = __mul__

    def __neg__(self) -> CurveTranslation:
        return self * -1

    def over(self, system: Any) -> CurveTranslation:
        return CurveTranslation(system, self.points, self.sheets, self.multiple)

    def __call__(self, state: State) -> State:
        """The image of a state."""
        state = self.system._checked(state)
        if self.system.field.exact:
            here = divisors(self.system, state)
            return from_divisors(self.system, TwoPoints(*map(self._sum, range(2), here)), like=state)
        try:
            return SeparatedFlow(self.system, state).translated(self._time)
        except PrecisionLoss as error:
            raise PrecisionLoss(f"multiple = {written(self.multiple)}: as of a motion for so long, {error}") from None

    def divisor(self, state: State) -> TwoPoints:
        """The divisors that are added on the curves of a state."""
        return TwoPoints(*(self._sum(k, D) - D for k, D in enumerate(self.system.divisor(state))))

    def _sum(self, k: int, D: Divisor) -> Divisor:
        x, K, jacobian = self.points[k], self.system.field, D.jacobian
        if x is None:
            return D
        z = self._height(K, _mu_of(curves_of(self.system), jacobian.curve.f), x)
        y = square_root(K, poly.evaluate(K, jacobian.curve.f, z), f"points[{k}]: the square of the ordinate")
        return D + self.multiple * jacobian.from_points([(z, y if self.sheets[k] > 0 else K.neg(y))])

    def _height(self, K: Arithmetic, mu: Real, x: Real) -> Real:
        return K.div(K.mul(mu, x), K.sub(K.one, K.mul(K.coerce(curves_of(self.system).d), x)))

    def _time(self, k: int, curve: EllipticOval, mu: Real) -> Real:
        """The time, in long numbers, for which motion along curve k is the addition of ``multiple`` times its point.

        It is ∓multiple·∫dZ/|Y| from the point's Z to ∞, with the upper sign for a point with Y > 0.
        """
        x, K = self.points[k], curve.field
        if x is None:
            return K.zero
        z = self._height(K, mu, K.coerce(x))
        largest = max(mu / K.coerce(moment) for moment in curves_of(self.system).body.inertia)
        if z < largest:
            raise NotASquare(
                f"points[{k}] = {written(x)}: the image of a state is not real; take x with Z = μx/(1 − dx) ≥ μ/I_i, "
                f"here Z = {float(z):g} and the largest μ/I_i = {float(largest):g}"
            )
        return -self.sheets[k] * self.multiple * curve.time_above(z - largest)


def curves_of(system: Hamiltonian) -> Hamiltonian:
    """The tilde pair on whose two curves the system moves: the system itself, or that with A⁻¹ in place of A."""
    isometry = system.isometry()
    return system if isometry is None else isometry.pair


def lifted(system: Hamiltonian, state: State) -> State:
    """The state of the tilde pair that corresponds to a state.

    NotASquare if √a_i or |Bγ| (:class:`integrable.deformations.hamiltonian.Isometry`) is not in the field.
    """
    K, isometry = system.field, system.isometry()
    return state if isometry is None else State(*lift(K, roots(K, isometry.squares), *state.vectors))


def unlifted(system: Hamiltonian, state: State) -> State:
    """The state of a system that corresponds to a state of the tilde pair: the inverse of :func:`lifted`."""
    K, isometry = system.field, system.isometry()
    if isometry is None:
        return state
    return State(*lift(K, [K.inv(x) for x in roots(K, isometry.squares)], *state.vectors))
