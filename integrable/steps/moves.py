"""Maps that need no choice of points: multiples of the state's own divisor, addition of the branch point 1/d, and steps
along a pencil of parabolas. Time shifts are in :mod:`integrable.steps.time_shift`.

Each map preserves H1 and H2. Its docstring states its effect on the bracket of :meth:`System.poisson`, which
:func:`integrable.phase.brackets.image_brackets` tests.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from integrable.phase import coordinates
from integrable.phase.body import square_root
from integrable.phase.jets import apply
from integrable.phase.space import PhaseSpace, check_moving
from integrable.phase.state import State
from integrable.steps.guard_digits import LARGEST, body_condition, on_principal_axis, tilt_condition, with_enough_digits
from integrable.steps.step import Abscissa, Step, check_doublings, checked_signs
from jacobian import Divisor, Jacobian, poly
from jacobian.element import Element
from jacobian.errors import ArgumentError, NotASquare, NotRepresentable, one_of, whole, written
from jacobian.fields.inexact import InexactField
from jacobian.relatives.signed import SignedDivisor, SignedGroup, reflected, sheared

if TYPE_CHECKING:
    from integrable.phase.upright import ChaplyginTransformation


class Move(Step):
    """A step defined at (γ, M) = 0. A tilted state is first mapped to an upright one by Chaplygin's
    transformation, and the image is mapped back.
    """

    def __call__(self, state: State[Element]) -> State[Element]:
        """The image of a state. Over RR and MP guard digits are used where :meth:`condition` or H1 and H2 require them.

        PrecisionLoss if H1 or H2 of the image differs from that of the state (by 10⁻⁹ in floats).
        """
        return with_enough_digits(self, self.system._checked(state))

    def plain(self, state: State) -> State:
        """The image computed in the numbers of the field, without a check of the loss of digits."""
        if not self.system._checked(state).tilted:
            return self._image(state)
        step, plain, change = self._transformed(state)
        return change.invert(step._image(plain))

    def _transformed(self, state: State) -> tuple[Move, State, ChaplyginTransformation]:
        """The map of the upright body of a tilted state, that body's state, and the transformation."""
        system, plain, change = self.system.upright(state)
        return self.over(system), plain, change

    def condition(self, state: State) -> float:
        """The amplification of rounding errors by the map, times that by Chaplygin's transformation."""
        state = self.system._checked(state)
        if not state.tilted:
            return self._condition(state)
        step, plain, change = self._transformed(state)
        return tilt_condition(change, state) * step._condition(plain)

    def _condition(self, state: State) -> float:
        return 1.0

    def _image(self, state: State) -> State:
        raise NotImplementedError


class Multiplication(Move):
    """The map D ↦ [ℓ]D, ℓ times the state's own divisor. It multiplies the bracket by ℓ.

    For odd ℓ the image lies over the same field. An even ℓ needs the roots of κ_i = (1 − d·a_i)(a_i − a_j)(a_i − a_k).
    Their product is −1 times a square if the 1 − d·a_i are squares, so over the reals it is refused (NotASquare);
    instead multiply :meth:`System.divisor`. NotRepresentable if moments are equal.
    """

    def __init__(self, system: PhaseSpace, factor: int) -> None:
        self.factor = whole(factor, "factor", "a divisor is multiplied by an int")
        if self.factor == 0:
            raise ArgumentError("factor = 0: the zero divisor belongs to no state")
        check_doublings(system.field, self.factor, "factor")
        if system.field.zero in coordinates.kappas(system.body):
            raise NotRepresentable(
                f"factor = {written(self.factor)}: two moments of inertia are equal, and a divisor does not determine γ"
            )
        if self.factor % 2 == 0 and isinstance(system.field, InexactField):
            raise NotASquare(
                f"factor = {written(self.factor)}: κ of the middle axis is negative, so over {system.field.name} an "
                "even factor gives no image; multiply system.divisor(state)"
            )
        self.system = system

    def _condition(self, state: State) -> float:
        """The amplification of rounding errors. NotRepresentable if a point of the divisor is a double point of the
        curve, which has no multiples.
        """
        inexact = isinstance(self.system.field, InexactField)
        if abs(self.factor) > 1 and inexact and on_principal_axis(self.system, state) is not None:
            raise NotRepresentable(
                f"M = {state.vectors[1]} is along a principal axis and γ across it: a point of the divisor is the "
                "double point of its curve, and has no multiples; give another state"
            )
        # the divisor is added to itself, so partial sums may come near special positions
        return body_condition(self.system) ** 4 * 1e8 * float(self.factor) ** 2 if abs(self.factor) > 1 else 1.0

    def __repr__(self) -> str:
        return f"<multiplication by {self.factor} on {self.system!r}>"

    def _image(self, state: State) -> State:
        """The image of an upright state. NotASquare if the image is not over the field; NotRepresentable for an image
        divisor of fewer than two points.
        """
        system, body, K = self.system, self.system.body, self.system.field
        kappas, even = coordinates.kappas(body), self.factor % 2 == 0
        roots = [square_root(K, kappa, f"κ of axis {i}") for i, kappa in enumerate(kappas)] if even else []
        pairs = coordinates.to_pairs(body, state)
        u, v = coordinates.to_mumford(body, pairs)
        group = SignedGroup(system.curve(*system.integrals(state)[2:]), coordinates.branch_points(body))
        image = group.multiple(self.factor, SignedDivisor(u, v, pairs, kappas)).pairs
        if roots:
            image = tuple((K.div(x, r), K.div(y, r)) for (x, y), r in zip(image, roots, strict=True))
        return coordinates.from_pairs(body, image)


class Keyless(Move):
    """The map D ↦ D + (1/d, 0) − ∞, Tsiganov's chap-keyless. At d = 0 it is the step of order two along the pencil
    (:class:`ConicStep`).

    For one λ the parabola y = P(x), P = V − λU, passes through D and (1/d, 0). The other zeros of y − P are D's image,
    reflected (:func:`jacobian.relatives.signed.reflected`), with ρ_i = 2σ_i|M|√(1 − d·a_i), where σ_i are the
    ``signs``. So (gγ_i, 2w_i), w = γ × M, is mapped to (2w_i/ρ_i, −ρ_igγ_i). :meth:`System.torsion` adds the same
    divisor; over the reals its image differs in the sign of γ. The image is real for every body. The map preserves the
    bracket; its square maps (γ, M) to (−γ, M).
    """

    def __init__(self, system: PhaseSpace, signs: Sequence[int] | None = None) -> None:
        self.system = system
        self.signs = checked_signs(signs, 3, "signs")

    def __repr__(self) -> str:
        return f"<keyless map on {self.system!r}>"

    def _image(self, state: State) -> State:
        """The image of an upright state. NotASquare if |M|, g̃, or √(1 − d·a_i) for an i, is not in the field."""
        body, K = self.system.body, self.system.field
        _, M = state.vectors
        h2 = K.dot(M, M)
        check_moving(K, h2)
        size = square_root(K, h2, "H2 = |M|²")
        roots = [K.add(size, size)] * 3
        if body.rolls:
            contact = [square_root(K, r, f"1 − d·a_{i + 1}") for i, r in enumerate(body.contact)]
            roots = [K.mul(root, r) for root, r in zip(roots, contact, strict=True)]
        roots = [root if sign > 0 else K.neg(root) for root, sign in zip(roots, self.signs, strict=True)]
        pairs = reflected(K, coordinates.upright_pairs(body, state), roots)
        if state.g is not None:
            sigma = [x for x, _ in pairs]
            pairs = (*pairs, (square_root(K, K.dot(sigma, sigma), "g̃²"), K.zero))
        return coordinates.from_pairs(body, pairs)

    def divisor(self, state: State[Element]) -> Divisor[Element]:
        """The divisor (1/d, 0) − ∞ on the curve of a state, or of its upright body if it is tilted. NotRepresentable at
        d = 0.
        """
        system, K = self.system, self.system.field
        if system._checked(state).tilted:
            system, state, _ = system.upright(state)
        if not system.body.rolls:
            raise NotRepresentable("d = 0: the keyless map leaves the class of a divisor, and walks along its pencil")
        group: Jacobian = system.group(*system.integrals(state)[2:])
        return group.from_mumford((K.neg(K.inv(system.d)), K.one), ())


class ConicStep(Move):
    """The step along the pencil y = V(x) + cU(x) to the parabola through a plane point (x0, y0), at d = 0.

    (U, V) is mapped to ((P² − f)/U made monic, −P), P = V + cU, as in
    :meth:`jacobian.relatives.conic.Representative.step`. The class on the curve is unchanged, and M̃ = M. γ is turned
    about M: its new components are those of ν/s for the pairs (σ, ν) of (U, P), s² = c² + 4H2.

    If y0 is a constant or a function of x0·H2 − H1, the map preserves {u_i, p_j} = (u_i − x0)δ_ij, which for x0 = 0 is
    the bracket W of :mod:`integrable.phase.brackets`. x0 = None means the point at infinity; y0 is then c, and the
    canonical bracket is preserved.
    """

    def __init__(self, system: PhaseSpace, x0: Abscissa | None, y0: Abscissa, sign: int = 1) -> None:
        if system.body.rolls:
            raise ArgumentError(f"d = {system.d}: the parabolas of a conic step are the pencil of the curve at d = 0")
        K = system.field
        self.system = system
        self.x0 = None if x0 is None else K.coerce(x0, "x0")
        self.y0 = y0 if callable(y0) else K.coerce(y0, "y0")
        self.sign = one_of(sign, "sign", (1, -1), "the sign of the root s is 1 or -1")

    def __repr__(self) -> str:
        return f"<conic step through ({self.x0}, {self.y0}) on {self.system!r}>"

    def _condition(self, state: State) -> float:
        """The amplification of rounding errors in c = (y0 − V(x0))/U(x0), relative to |c| + √H2."""
        system, K = self.system, self.system.field
        if self.x0 is None or K.exact:
            return 1.0
        u, v = coordinates.to_mumford(system.body, coordinates.to_pairs(system.body, state))
        h1, h2 = system.integrals(state)[2:]
        check_moving(K, h2)
        y0 = apply(K, self.y0, h1, h2) if callable(self.y0) else self.y0
        # c = (y0 − V(x0))/U(x0)
        above, below = (abs(x) for x in (y0 - poly.evaluate(K, v, self.x0), poly.evaluate(K, u, self.x0)))
        size = above + below * h2**0.5
        if not (below and size):
            return LARGEST
        return float((abs(y0) + poly.size_at(v, self.x0) + poly.size_at(u, self.x0) * above / below) / size)

    def _image(self, state: State) -> State:
        """The image of an upright state. NotASquare if c² + 4H2 is no square; NotRepresentable if it or U(x0) is 0."""
        from jacobian.relatives.conic import parameter

        system, K = self.system, self.system.field
        pairs = coordinates.to_pairs(system.body, state)
        h1, h2 = system.integrals(state)[2:]
        check_moving(K, h2)
        y0 = apply(K, self.y0, h1, h2) if callable(self.y0) else self.y0
        c = parameter(K, coordinates.to_mumford(system.body, pairs), self.x0, y0)
        s = square_root(K, K.add(K.mul(c, c), K.mul(poly.integer(K, 4), h2)), "c² + 4H2")
        if s == K.zero:
            raise NotRepresentable(
                f"c² + 4H2 = 0 at c = {written(c)}: the image's divisor has a point at infinity, no state has it"
            )
        (x1, _), (x2, _), (x3, _) = reflected(K, sheared(K, pairs, c), (s if self.sign > 0 else K.neg(s),) * 3)
        return State((x1, x2, x3), state.vectors[1])
