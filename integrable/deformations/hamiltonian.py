"""The common base of the deformations of the ball and the top: states, integrals, brackets, equations of motion.

A deformation is a Hamiltonian H on the phase space of the ball at (γ, M) = 0, of degree 2 in M, with a second
integral K, {H, K} = 0. The motion is (γ̇, Ṁ) = g{(γ, M), H/2} with the bracket of the ball, in the ball's
orientation and time (:mod:`integrable.phase.brackets`). Formulas are written with operators and run on floats, mpf, and
over exact fields on :class:`integrable.phase.jets.Jet`. (Tsiganov, "Integrable discretization and deformation of the
nonholonomic Chaplygin ball", with the corrections of docs/errata.md.)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, Self

from integrable.deformations.scalars import Potential, RateTerms, Scalars, dot, product
from integrable.phase.body import Body, Vector, finite_floats
from integrable.phase.jets import JetField
from integrable.phase.made import Made
from integrable.phase.state import State, check_state, state_of_row
from integrable.systems.chaplygin_ball import ChaplyginBall
from jacobian import RR
from jacobian.element import Element, Real, Value
from jacobian.errors import ArgumentError, NotRepresentable, shown
from jacobian.fields.protocol import Field
from jacobian.immutable import quick_property, replaced

if TYPE_CHECKING:
    import numpy as np


class _Finite:
    """A context that turns a Hamiltonian's division by 0, where γ_i, s or 1 − ds vanishes, into NotRepresentable.

    Over RR and MP(digits) a small s or 1 − ds may vanish by rounding.
    """

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        # numpy's division by 0 is a FloatingPointError
        if isinstance(error, (ZeroDivisionError, FloatingPointError)):
            raise NotRepresentable(
                "the Hamiltonian is infinite here: it divides by γ_i, s or 1 − ds that vanishes"
            ) from None


class DeformedIntegrals(NamedTuple, Generic[Element]):
    """The Casimir functions C1 = (γ, γ) and C2 = (γ, M), and the H and K of a deformation."""

    C1: Element
    C2: Element
    H: Element
    K: Element


class Isometry(NamedTuple):
    """The isometry of a check or hat pair to a tilde ``pair``: H(γ, M) = ``factor``·H̃(γ', M'), where (γ', M') is the
    cotangent lift of γ ↦ Bγ/|Bγ|, B² = diag(``squares``).
    """

    squares: Vector
    factor: Real
    pair: Any


class Hamiltonian(Made):
    """The states, integrals and equations of motion of a deformation: base of
    :class:`integrable.deformations.deformation.Deformation`.
    """

    rigid: ChaplyginBall
    body: Body
    """The body; its a_i = 1/(I_i + d) enter the Hamiltonian."""
    field: Field
    """The field of the coordinates."""
    potential: Potential | None
    further: ClassVar[tuple[str, ...]] = ()
    """The names of further constants."""

    def _build(self, inertia: Iterable[Value], d: Value, potential: Sequence[Value] | None, field: Field = RR) -> None:
        body = Body.make(inertia, d, field)
        terms = None if potential is None else _potential(field, potential)
        vars(self).update(rigid=ChaplyginBall._of(body), body=body, field=field, potential=terms)

    @property
    def a(self) -> Vector:
        """The a_i = 1/(I_i + d)."""
        return self.body.a

    @property
    def d(self) -> Real:
        """The constant d of the bracket."""
        d: Real = self.body.d
        return d

    def state(self, gamma: Iterable[Value], M: Iterable[Value], g: Value | None = None) -> State:
        """The state (γ, M); |γ| = 1 and (γ, M) = 0 are checked as by :meth:`System.state`."""
        return self.rigid.state(gamma, M, g)

    def over(self, field: Field) -> Self:
        """The same Hamiltonian over another field, to which its numbers are converted."""
        body = Body.make(self.body.inertia, self.d, field)
        return self._with(body, [field.coerce(x) for x in self.constants[4:]])

    @quick_property
    def constants(self) -> tuple[Any, ...]:
        """The moments and d, then the five numbers of a potential, then further constants."""
        further = [getattr(self, name) for name in self.further]
        return (*self.body.inertia, self.body.d, *(self.potential or ()), *further)

    def _of_constants(self, field: Field, values: Sequence[Any]) -> Self:
        """A system of the same kind whose :attr:`constants` are ``values``, unchecked elements of ``field``."""
        x, y, z, d, *rest = values
        return self._with(Body((x, y, z), d, field), rest)

    def _with(self, body: Body, rest: Sequence[Real]) -> Self:
        potential = self.potential
        if potential is not None:
            potential, rest = Potential(*rest[:5]), rest[5:]
        further, rigid = dict(zip(self.further, rest, strict=True)), ChaplyginBall._of(body)
        return replaced(self, rigid=rigid, body=body, field=body.field, potential=potential, **further)

    def poisson(self, state: State) -> tuple[tuple[Real, ...], ...]:
        """The 6×6 matrix of the Poisson brackets of (γ, M), the same as for the ball."""
        return self.rigid.poisson(self._checked(state))

    def integrals(self, state: State[Element]) -> DeformedIntegrals[Element]:
        """C1, C2, H and K; NotRepresentable if the potential is infinite (γ_i = 0 with a pole there), or if H or K is
        beyond the range of floats.
        """
        K, (gamma, M) = self.field, self._checked(state).vectors
        pair = self._pair_at(state)
        if K is RR and not all(map(isfinite, pair)):
            raise NotRepresentable(f"M = {shown(M)}: H and K are beyond the range of floats; use MP(digits)")
        return DeformedIntegrals(K.dot(gamma, gamma), K.dot(gamma, M), *pair)

    def _pair_at(self, state: State) -> tuple[Real, Real]:
        """H and K at a state that has been checked; NotRepresentable as from :meth:`integrals`."""
        gamma, M = state.vectors
        with _Finite():
            if not self.field.exact:
                return self.pair(Scalars(self.body.a, self.body.d, gamma, M), self.potential)
            wrap = self._constants()
            energy, second = self.pair(self.scalars(wrap, map(wrap, gamma), map(wrap, M)), self._terms(wrap))
        return energy.value, second.value

    def _integrals_along(self, gamma: np.ndarray, M: np.ndarray) -> DeformedIntegrals:
        """The :meth:`integrals` of N real states, each of shape (N,); γ and M have the shape (N, 3)."""
        import numpy as np

        q = self.scalars(self._constants(), gamma.T, M.T)
        with _Finite(), np.errstate(divide="raise"):
            return DeformedIntegrals(dot(q.gamma, q.gamma), dot(q.gamma, q.M), *self.pair(q, self._terms(lambda x: x)))

    def _omega_along(self, gamma: np.ndarray, M: np.ndarray) -> np.ndarray:
        """Ω = ½∂H/∂M, for which γ̇ = γ × Ω, at N real states; shape (N, 3)."""
        import numpy as np

        with _Finite(), np.errstate(divide="raise"):
            return np.stack(self.omega_at(self.scalars(self._constants(), gamma.T, M.T)), axis=1)

    def _attitude_along(self, gamma: np.ndarray, M: np.ndarray) -> np.ndarray:
        """Raises NotRepresentable, because M is not fixed in space."""
        raise NotRepresentable(f"{self!r}: M does not rest in space, and with γ alone no attitude is known")

    def vector_field(self, state: State[Element]) -> State[Element]:
        """The derivatives (γ̇, Ṁ), as a State."""
        return self._rates(self._checked(state))

    def linearized(self, state: State) -> np.ndarray:
        """The derivatives of (γ̇, Ṁ) with respect to (γ, M) at a state, shape (6, 6)."""
        import numpy as np

        jets = JetField(self.field, 6)
        state = state_of_row(jets.variables(self._checked(state).row))
        system = self._of_constants(jets, [*map(jets.constant, self.constants)])
        rates = system._rates(state).row
        return np.array([jets.coerce(x).slopes for x in rates], dtype=float if self.field is RR else object)

    def rates_in(self, numbers: Field, y: Sequence[Real]) -> list[Real]:
        """(γ̇, Ṁ) at y = (γ, M), over a field whose elements overload the operators, such as symbolic expressions."""
        return [*self.over(numbers)._rates(state_of_row(y)).row]

    def _rates(self, state: State) -> State:
        wrap = self._constants()
        q = self.scalars(wrap, *(map(wrap, v) for v in state.vectors))
        with _Finite():
            rate, momentum = self.rates_at(q)
        if self.potential is not None:
            slope = [wrap(x) for x in self._slope(state)]
            momentum = [m + x / 2 for m, x in zip(momentum, product(q.gamma, slope), strict=True)]
        if self.field.exact:
            return state_of_row([x.value for x in (*rate, *momentum)])
        return state_of_row((*rate, *momentum))

    @property
    def repels(self) -> bool:
        """Whether the potential consists of repelling poles alone, and :meth:`flow` is available for it."""
        return False

    @property
    def separates(self) -> bool:
        """Whether the motion separates on two curves, which :meth:`divisor` and :meth:`translation` require."""
        return self.has_curves and self.potential is None

    has_curves: ClassVar[bool] = False
    """Whether systems of this class separate without a potential."""
    degree: ClassVar[int] = 1
    """The degree of H in A."""

    def eigenvalue_sums(self, H: Real, K: Real) -> tuple[Real, Real]:
        """(λ1 + λ2, −λ1λ2), from the integrals H and K."""
        return H, K

    def isometry(self) -> Isometry | None:
        """The isometry of a check or hat pair to a tilde pair; None if there is none, or the system is a tilde pair."""
        return None

    def _checked(self, state: State) -> State:
        return check_state(self, state)

    def pair(self, q: Scalars, potential: Potential | None) -> tuple[Any, Any]:
        """The integrals (H, K), for any numbers with Python's operators."""
        raise NotImplementedError

    def motion(self, q: Scalars) -> RateTerms:
        """The coefficients of Ω = ½∂H/∂M and of Ṁ without the potential."""
        raise NotImplementedError

    def omega_at(self, q: Scalars) -> list[Any]:
        """Ω, for which γ̇ = γ × Ω."""
        return self.motion(q).omega(q)

    def rates_at(self, q: Scalars) -> tuple[list[Any], list[Any]]:
        """(γ̇, Ṁ) without the potential."""
        return self.motion(q).rates(q)

    def potential_energy(self, q: Scalars, potential: Potential) -> Real:
        """The potential V(γ), by which H exceeds the H without potential."""
        raise ArgumentError(f"potential = {shown(potential)}: {type(self).__name__} has none")

    def _constants(self) -> Callable[[Any], Any]:
        """The function that converts elements of the field to numbers with Python's operators."""
        return JetField(self.field, 0).constant if self.field.exact else lambda x: x

    def scalars(self, wrap: Callable[[Any], Any], gamma: Iterable[Any], M: Iterable[Any]) -> Scalars:
        """The :class:`Scalars` of γ and M; ``wrap`` converts the body's constants."""
        return Scalars([wrap(x) for x in self.a], wrap(self.d), tuple(gamma), tuple(M))

    def _terms(self, wrap: Callable[[Any], Any]) -> Potential | None:
        return None if self.potential is None else Potential(*map(wrap, self.potential))

    def _slope(self, state: State) -> tuple[Real, ...]:
        """The gradient ∂V/∂γ."""
        K = self.field
        jets = JetField(K, 3)
        zero = jets.constant(K.zero)
        terms = self._terms(jets.constant)
        assert terms is not None
        q = self.scalars(jets.constant, jets.variables(state.vectors[0]), (zero, zero, zero))
        with _Finite():
            return jets.coerce(self.potential_energy(q, terms)).slopes

    @property
    def arguments(self) -> dict[str, object]:
        offset = {"d": self.d} if self.body.rolls else {}
        terms = {} if self.potential is None else {"potential": tuple(self.potential)}
        return {"inertia": self.body.inertia, **offset, **terms}


def _potential(field: Field, values: Sequence[Value]) -> Potential:
    if field is RR and finite_floats(values) and len(values) == 5:
        return Potential(*values)
    given = list(values) if isinstance(values, (list, tuple)) else []
    if len(given) != 5:
        raise ArgumentError(f"potential = {shown(values)}: give five numbers (a, b, b_1, b_2, b_3)")
    return Potential(*(field.coerce(x, f"potential[{i}]") for i, x in enumerate(given)))
