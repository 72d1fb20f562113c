"""The phase space of a body: states, integrals, vector field, divisors and other coordinates."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Generic, Self

from integrable.phase.body import Body, Integrals, Vector, cross, elements, triple
from integrable.phase.made import Made
from integrable.phase.state import State, check_state
from jacobian import Field, poly
from jacobian.element import Element, Value
from jacobian.errors import ArgumentError, NotASquare, NotRepresentable, PrecisionLoss, flag, shown, written
from jacobian.immutable import replaced

if TYPE_CHECKING:
    import numpy as np

    from integrable.phase.separation import Separated
    from integrable.phase.upright import ChaplyginTransformation
    from jacobian import Divisor, HyperellipticCurve, Jacobian


class PhaseSpace(Made, Generic[Element]):
    """The states of a rigid body, by default with (γ, M) = 0. Base of :class:`integrable.systems.system.System`."""

    body: Body[Element]
    radius: Element | None = None
    """The radius of the ball, or None if none was given. Lengths are then in units of the radius."""

    @property
    def field(self) -> Field[Element]:
        """The field of the coordinates."""
        return self.body.field

    @property
    def inertia(self) -> Vector[Element]:
        """Principal moments of inertia I_i."""
        return self.body.inertia

    @property
    def d(self) -> Element:
        """m r², 0 for the Euler top."""
        return self.body.d

    @property
    def a(self) -> Vector[Element]:
        """a_i = 1/(I_i + d)."""
        return self.body.a

    def state(
        self,
        gamma: Iterable[Element | Value],
        M: Iterable[Element | Value],
        g: Element | Value | None = None,
        *,
        tilted: bool = False,
    ) -> State[Element]:
        """The State (γ, M). |γ| = 1 and (γ, M) = 0 are checked, exactly over exact fields and to eps^0.6 over inexact
        ones. ``tilted=True`` allows (γ, M) ≠ 0. Divisors, steps and the flow then use Chaplygin's transformation, which
        exists except for M ∥ γ.

        ``g`` chooses the root of g² over an exact field with d ≠ 0. The default is the field's own root; NotASquare if
        it has none. ArgumentError names the argument, its value and the accepted values.
        """
        K: Any = self.body.field
        tilted = flag(tilted, "tilted")
        x: Vector = triple(K, gamma, "gamma")
        m: Vector = triple(K, M, "M")
        tolerance, square = 0 if K.exact else K.eps**0.6, K.dot(x, x)
        if _distance(K, square, K.one) > tolerance:
            raise ArgumentError(f"gamma = {_show(x)} has (γ, γ) = {written(square)}: γ is a unit vector{_precision(K)}")
        if K.exact and self.body.rolls and self.body.conformal(x) == K.zero:
            raise NotASquare(f"gamma = {_show(x)}: 1 − d(γ, Aγ) vanishes in {K.name}, and g is infinite")
        if not tilted:
            tilt = K.dot(x, m)
            # the largest |M_i| replaces |M| where (M, M) underflows
            size = 1 if K.exact else max(K.dot(m, m) ** 0.5, *map(abs, m))
            if _distance(K, tilt, K.zero) > tolerance * size:
                raise ArgumentError(
                    f"M = {_show(m)} has (γ, M) = {written(tilt)}: this system needs (γ, M) = 0{_precision(K)}, "
                    "or tilted=True"
                )
        return State(x, m, self._root(x, g), tilted=tilted)

    def _root(self, gamma: Vector[Element], g: Element | Value | None) -> Element | None:
        """The root of g² that a state over this field stores: None over the reals and at d = 0."""
        K = self.body.field
        if not (K.exact and self.body.rolls):
            if g is not None:
                raise ArgumentError(
                    f"g = {shown(g)}: over {K.name} and at d = {self.d} the root of g² is not a choice, leave g out"
                )
            return None
        from integrable.phase import coordinates

        if g is None:
            return coordinates.root_of_g(self.body, gamma)
        root = K.coerce(g, "g")
        if K.mul(K.mul(root, root), self.body.conformal(gamma)) != K.one:
            raise ArgumentError(
                f"g = {written(root)}: g² must be 1/(1 − d(γ, Aγ)) = {written(K.inv(self.body.conformal(gamma)))}"
            )
        return root

    def integrals(self, state: State[Element]) -> Integrals[Element]:
        """The integrals C1 = (γ, γ), C2 = (γ, M), H1 = (ω, M), H2 = (M, M) of a state."""
        return self.body.integrals(*self._checked(state).vectors)

    @property
    def constants(self) -> tuple[Element, ...]:
        """The moments and d."""
        return *self.body.inertia, self.body.d

    def _of_constants(self, field: Field, values: Sequence[Any]) -> Self:
        """A system of the same kind whose :attr:`constants` are ``values``, unchecked elements of ``field``."""
        x, y, z, d = values
        return replaced(self, body=Body((x, y, z), d, field))

    def _integrals_along(self, gamma: np.ndarray, M: np.ndarray) -> Integrals:
        """The :meth:`integrals` of N real states, γ and M of shape (N, 3): four arrays of shape (N,)."""
        x, m = gamma.T, M.T
        return Integrals(sum(x * x), sum(x * m), *self.body.energies(x, m))

    def _omega_along(self, gamma: np.ndarray, M: np.ndarray) -> np.ndarray:
        """The angular velocities :meth:`omega` of N real states, shape (N, 3)."""
        from integrable.phase import attitude

        return attitude.angular_velocities(self.body, gamma, M)[0]

    def _attitude_along(self, gamma: np.ndarray, M: np.ndarray) -> np.ndarray:
        """The rotations from the body to space, shape (N, 3, 3) (:func:`integrable.phase.attitude.matrices`)."""
        from integrable.phase import attitude

        return attitude.matrices(gamma, M)

    def omega(self, state: State[Element]) -> Vector[Element]:
        """The angular velocity ω in the body frame."""
        return self.body.omega(*self._checked(state).vectors)

    def vector_field(self, state: State[Element]) -> State[Element]:
        """(γ̇, Ṁ) = (γ × ω, M × ω), as a State of derivatives."""
        omega = self.omega(state)
        gamma, M = state.vectors
        return State(cross(self.field, gamma, omega), cross(self.field, M, omega))

    def poisson(self, state: State[Element]) -> tuple[tuple[Element, ...], ...]:
        """The 6×6 matrix of the brackets of (γ, M)."""
        raise NotImplementedError

    def upright(self, state: State[Element]) -> tuple[PhaseSpace[Element], State[Element], ChaplyginTransformation]:
        """(system, state, transformation): Chaplygin's map of a tilted state to a state with (γ̃, M̃) = 0 of another
        body.

        ``transformation.invert`` is the inverse. Raises NotRepresentable at M ∥ γ, NotASquare over a field that lacks a
        square root which the map needs.
        """
        from integrable.phase.upright import ChaplyginTransformation

        state = self._checked(state)
        change = ChaplyginTransformation.of(self.body, *state.vectors)
        return replaced(self, body=change.upright), change.apply(state), change

    def curve(self, h1: Element | Value, h2: Element | Value) -> HyperellipticCurve[Element]:
        """The curve y² = 4(1 − dx)(a1 − x)(a2 − x)(a3 − x)(x·h2 − h1) of the motions with H1 = h1 and H2 = h2.

        It has genus 2 and one point at infinity for d ≠ 0, genus 1 and two such points for d = 0. SingularCurve (exact
        fields) where roots coincide.
        """
        from jacobian import HyperellipticCurve

        K = self.field
        values = K.coerce(h1, "h1"), K.coerce(h2, "h2")
        check_moving(K, values[1])
        f: poly.Poly = self.body.polynomial(*values)
        return HyperellipticCurve(K, f)

    def group(self, h1: Element | Value, h2: Element | Value) -> Jacobian[Element]:
        """The group of the motion: the Jacobian of :meth:`curve`, or for d = 0 its generalized Jacobian."""
        curve = self.curve(h1, h2)
        if self.body.rolls:
            return curve.jacobian()
        from jacobian.relatives.glued import GeneralizedJacobian

        return GeneralizedJacobian(curve)

    def divisor(self, state: State[Element]) -> Divisor[Element]:
        """The divisor (U, V) of a state in :meth:`group`; of a tilted state, the divisor of its :meth:`upright` state.

        NotASquare where g² has no root in the field.
        """
        from integrable.phase import coordinates

        state = self._checked(state)
        if state.tilted:
            system, plain, _ = self.upright(state)
            return system.divisor(plain)
        u, v = coordinates.to_mumford(self.body, coordinates.to_pairs(self.body, state))
        return self.group(*self.integrals(state)[2:]).from_mumford(u, v)

    def from_divisor(self, D: Divisor[Element], like: State[Element] | None = None) -> State[Element]:
        """The state with divisor D. Eight states share it; the signs of ``like`` choose one.

        Over an exact field ``like`` is used only if D is the divisor of ``like`` up to signs. Otherwise the signs are
        those of the field's own roots of g² and γ_i² (of (γ × M)_i² where γ_i = 0); over the reals γ_i > 0. A tilted
        ``like`` also supplies Chaplygin's transformation.

        NotASquare if a root is not in the field. NotRepresentable for a weight other than two, or for equal moments.
        CurveMismatch if D lies on no curve of this system. PrecisionLoss if H1 or H2 of the state differs from that of
        the curve (by 10⁻⁹ in floats).
        """
        from integrable.phase import coordinates
        from jacobian.law.divisor import check_divisor

        D, model = check_divisor(D, "D"), None
        if like is not None:
            like = self._checked(like)
            if like.tilted:
                system, plain, change = self.upright(like)
                return change.invert(system.from_divisor(D, plain))
            model = coordinates.to_pairs(self.body, like)
        if len(D.u) != 3:
            raise NotRepresentable(f"D = {D!r} has weight {len(D.u) - 1}: a state has a divisor of weight two")
        integrals = coordinates.integrals_of(self.body, D)
        pairs = coordinates.pairs_of(self.body, D.jacobian.curve.f, D.u, D.v, model)
        state = coordinates.from_pairs(self.body, pairs)
        K: Any = self.field
        if not K.exact:
            found = self.integrals(state)[2:]
            lost = max(abs(x - y) / abs(y) for x, y in zip(found, integrals, strict=True))
            if not lost <= K.eps**0.575:
                raise PrecisionLoss(
                    f"D = {D!r}: H1 and H2 of its state are off by {float(lost):.1e} of their size, D does not "
                    f"determine γ and M over {self.field.name}; use more digits, or step on states"
                )
        return state

    def separated(self, state: State[Element]) -> Separated:
        """The canonical coordinates (u, p) of a state (:func:`integrable.phase.separation.to_separated`)."""
        from integrable.phase import separation

        return separation.to_separated(self.body, self._checked(state))

    def from_separated(
        self, u: Iterable[Value], p: Iterable[Value], like: State[Element] | None = None
    ) -> State[Element]:
        """The state with coordinates (u, p), with the signs of ``like`` or of the field's own roots.

        See :func:`integrable.phase.separation.from_separated`.
        """
        from integrable.phase import separation

        K: Field = self.field
        (u1, u2), (p1, p2) = (elements(K, x, name, 2, "a sequence of two numbers") for x, name in ((u, "u"), (p, "p")))
        if like is not None:
            like = self._checked(like)
        return separation.from_separated(self.body, separation.Separated((u1, u2), (p1, p2)), like)

    def lifts(self, state: State[Element]) -> tuple[State[Element], ...]:
        """The eight states with the same divisor, starting with ``state``."""
        from integrable.phase import separation

        return separation.lifts(self.body, self._checked(state))

    def _checked(self, state: object) -> State[Element]:
        return check_state(self, state)

    @property
    def arguments(self) -> dict[str, object]:
        return {"inertia": self.inertia}

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        facts = [("principal moments", self.inertia), ("1/(I + d)", self.a), ("field", self.field.name)]
        return named(type(self).__name__, [*facts, ("d", self.d)] if self.body.rolls else facts)


def check_moving(K: Field[Element], h2: Element) -> None:
    """Raises ArgumentError if H2 = (M, M) is 0."""
    if h2 == K.zero:
        raise ArgumentError(f"H2 = {written(h2)}: (M, M) must not vanish; a body at rest has no curve")


def _distance(K: Field, x: Any, y: Any) -> Any:
    difference = K.sub(x, y)
    if K.exact:
        return 0 if K.is_zero(difference) else 1
    return abs(difference)


def _show(vector: Vector) -> str:
    return "(" + ", ".join(map(written, vector)) + ")"


def _precision(K: Field) -> str:
    if K.exact or K.name == "RR":
        return ""
    return f" to {K.name}; give decimal strings rather than floats"
