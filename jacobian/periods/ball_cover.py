"""The double cover Y² = f + h²/4 of the line in balls: proven branch points, half-periods with proven errors.

The coefficients count as exact: numbers of RR, CC and MP are dyadic fractions.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss
from jacobian.fields import QQ
from jacobian.periods.balls import BallNumbers, ball_numbers, exact_parts, semi_axis
from jacobian.periods.branched_cover import BranchedCover, rough_root
from jacobian.periods.quadrature import Vector, path_from

# an edge that needs more Chebyshev nodes per digit than this is integrated from both ends, in pieces
NODES_A_DIGIT = 20


class BallCover(BranchedCover):
    """The cover Y² = F(x) = f + h²/4 of a curve over QQ, RR, CC or MP(dps) in balls of ``bits`` bits."""

    numbers: BallNumbers

    def __init__(self, curve: HyperellipticCurve, bits: int) -> None:
        self.curve = check_curve(curve)
        self.genus, self.given = curve.genus, None
        self.numbers = ball_numbers(bits)
        real, imaginary = exact_equation(curve)
        with self.numbers.working():
            self.coefficients = _coefficients(self.numbers, real, imaginary)
            self.real = imaginary.degree() < 0
            self.lead = self.coefficients[-1]
            self.roots = ball_roots(self.numbers, real, imaginary)
            for e, other in combinations(self.roots, 2):
                # edges of the tree and signs of roots are chosen in doubles, which this distance makes unambiguous
                if not 2**30 * (e.rad() + other.rad()) < abs(e - other):
                    if self.real and real.gcd(real.derivative()).degree() > 0:
                        raise ArgumentError(f"curve = {curve!r}: f + h²/4 has a double root")
                    raise PrecisionLoss(f"the branch points {e} and {other} are not separated; use more digits")
        self._rough = [complex(e) for e in self.roots]

    def rounded(self, matrix: Sequence[Vector]) -> tuple[tuple[Any, ...], ...]:
        """The rows as tuples; balls are not rounded."""
        return tuple(map(tuple, matrix))

    def _moments(self, others: Vector, count: int) -> Vector:
        numbers = self.numbers
        axes = [semi_axis(u) for u in others]
        try:
            n, rho = numbers.rule([float(axis) for axis in axes], NODES_A_DIGIT * numbers.digits)
        except Infeasible:
            return self._moments_from_ends(others, count)
        cosh, size = rho.cosh(), 2 / ((2 * rho * n).exp() - 1)
        for axis in axes:
            size = size / (axis - cosh).sqrt()
        return [numbers.widened(x, size * cosh**m) for m, x in enumerate(self._means(others, n, count))]

    def _moments_from_ends(self, others: Vector, count: int) -> Vector:
        """The integrals of :meth:`_moments`, as those from −1 to 0 minus those from 1 to 0, each computed in pieces.

        This is for edges with another branch point near one of their ends.
        """
        numbers = self.numbers
        roots = [numbers.convert(-1), numbers.convert(1), *others]
        right = sum(1 for u in others if u.real > 0)
        square = numbers.convert(1)
        for u in others:
            square = square * (u if u.real > 0 else -u)
        Y = numbers.root(square, rough_root([(complex(u), u.real > 0) for u in others], 0))
        lead, middle = -1 if right % 2 == 0 else 1, (numbers.convert(0), Y)

        def powers(t: Any) -> Vector:
            return [t**m for m in range(count)]

        below, above = (path_from(numbers, i, roots, numbers.convert(lead), middle, powers, 0) for i in (0, 1))
        return [(x - y) / numbers.pi for x, y in zip(below, above, strict=True)]

    def tree(self) -> list[tuple[int, int]]:
        """The edges of the tree, chosen in floats and proven to have at most an end in common."""
        edges = super().tree()
        for first, second in combinations(edges, 2):
            if not set(first) & set(second) and not (self._aside(first, second) or self._aside(second, first)):
                raise PrecisionLoss("two edges of the tree of branch points may meet; use more digits")
        return edges

    def _aside(self, first: tuple[int, int], second: tuple[int, int]) -> bool:
        """Whether the second edge lies on one side of the line through the first, or beyond an end of the first."""
        a, b = (self.roots[k] for k in first)
        u, v = ((2 * self.roots[k] - a - b) / (b - a) for k in second)
        pairs = (u.imag, v.imag), (-u.imag, -v.imag), (u.real - 1, v.real - 1), (-1 - u.real, -1 - v.real)
        return any(x > 0 and y > 0 for x, y in pairs)


def exact_equation(curve: HyperellipticCurve) -> tuple[Any, Any]:
    """The real and the imaginary part of f + h²/4, as flint's fmpq_poly; ArgumentError over a finite field, or where
    its degree is not that of the model.
    """
    if curve.field.exact and curve.field != QQ:
        raise ArgumentError(f"curve = {curve!r}: a curve over QQ, RR, CC or MP(dps) has periods")
    (f, g), (h, k) = exact_polynomial(curve.f), exact_polynomial(curve.h)
    real, imaginary = f + (h * h - k * k) / 4, g + h * k / 2
    expected = 2 * curve.genus + (1 if curve.model == "ramified" else 2)
    if max(real.degree(), imaginary.degree()) != expected:
        raise ArgumentError(f"curve = {curve!r}: f + h²/4, taken as exact, has not the degree {expected} of the model")
    return real, imaginary


def exact_polynomial(coefficients: Sequence[Any]) -> tuple[Any, Any]:
    """The real and the imaginary part of a polynomial of numbers taken as exact, as flint's fmpq_poly."""
    from flint import fmpq, fmpq_poly

    parts = [exact_parts(c) for c in coefficients]
    return tuple(fmpq_poly([fmpq(*part[k].as_integer_ratio()) for part in parts]) for k in (0, 1))


def ball_roots(numbers: BallNumbers, real: Any, imaginary: Any) -> Vector:
    """The roots of an exact polynomial in balls that each contain one root, repeated by the multiplicity of the root.

    PrecisionLoss if the roots of a polynomial with complex coefficients are not separated.
    """
    if imaginary.degree() < 0:
        return [x for x, times in real.numer().complex_roots() for _ in range(times)]
    acb_poly, tolerance = numbers.flint.acb_poly, numbers.flint.arb(2) ** (8 - numbers.bits)
    try:
        return list(acb_poly(_coefficients(numbers, real, imaginary)).roots(tol=tolerance))
    except ValueError as error:
        raise PrecisionLoss(f"the roots are not separated: {error}") from None


def _coefficients(numbers: BallNumbers, real: Any, imaginary: Any) -> Vector:
    count = 1 + max(real.degree(), imaginary.degree())
    arb, acb = numbers.flint.arb, numbers.flint.acb
    return [acb(arb(real[k]), arb(imaginary[k])) for k in range(count)]
