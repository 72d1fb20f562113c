"""Balls as working numbers (python-flint's arb and acb; Johansson 2017), and integrals with a proven error bound.

The quadratures are those of :mod:`jacobian.periods.quadrature`, with Gauss's nodes instead of Fejér's. Let |φ| ≤ M on
the ellipse with foci ±1 and semi-axis cosh ρ. Then their errors are at most:

* Gauss–Chebyshev, n nodes, ∫ φ/√(1−t²): 2πM/(e^(2ρn) − 1) (Chawla & Jain 1968; Molin & Neurohr 2019, section 4);
* Gauss–Legendre, n ≥ 2 nodes, ∫ φ: 64M/(15(1 − e^(−2ρ))e^(2ρn)) (Rabinowitz 1969).

For a point u outside the ellipse, |t − u| ≥ (|u − 1| + |u + 1|)/2 − cosh ρ for all t on it, by the triangle inequality.
With the singularities of φ as u, this gives M. The choice between two square roots is made in doubles. This needs the
argument of a root with an error below 30°, and no path comes so near to a branch point that the error is larger.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import AbstractContextManager
from fractions import Fraction
from functools import lru_cache
from typing import Any

from jacobian.errors import Infeasible, PrecisionLoss
from jacobian.numbers.long_reals import BallReals
from jacobian.periods.quadrature import Forms, Numbers, Vector, path_sums, plus

# the error bound is tried on ellipses of the semi-axis cosh ρ, with ρ one of these fractions of the largest ρ for which
# no singularity is inside, up to MOST_RHO
WIDTHS = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
MOST_RHO = 4.0
# a piece of a path that needs more than NODES_A_DIGIT nodes per digit plus MORE_NODES is halved, down to the
# half-length LEAST_PIECE, at which doubles give the arguments of all factors to 1e-6
NODES_A_DIGIT, MORE_NODES, LEAST_PIECE = 2, 40, 2.0**-30


class BallNumbers(Numbers):
    """Complex balls of ``bits`` bits as working numbers. Compute inside ``with numbers.working():``."""

    def __init__(self, bits: int) -> None:
        import flint

        self.machine, self.bits = False, bits
        self.digits = int(bits * math.log10(2))
        self.flint: Any = flint
        self._reals = BallReals(bits)
        self._known: dict[tuple[str, int], list[Any]] = {}
        with self._reals:
            self.pi = flint.arb.pi()

    def working(self) -> AbstractContextManager[Any]:
        return self._reals

    def real(self, x: Any) -> Any:
        """x, a real number of any kind, as a ball that contains it."""
        return self.convert(x).real

    def convert(self, x: Any) -> Any:
        """x, a number of any kind, as a complex ball that contains it."""
        if isinstance(x, self.flint.acb):
            return x
        if isinstance(x, (int, self.flint.arb)):
            return self.flint.acb(x)
        return self.flint.acb(*(self.flint.arb(self.flint.fmpq(*part.as_integer_ratio())) for part in exact_parts(x)))

    def ten(self, exponent: int) -> Any:
        return self.flint.arb(10) ** exponent

    def sqrt(self, x: Any) -> Any:
        """A square root of x. It is a small ball if x is; for Re x < 0 it is √(−x)·i."""
        if float(x.real) >= 0:
            return x.sqrt()
        return (-x).sqrt() * self.flint.acb(0, 1)

    def root(self, square: Any, approximation: Any) -> Any:
        """The square root of ``square`` nearer to ``approximation``, a number or a ball; PrecisionLoss if undecided."""
        if square.contains(0):
            return self.widened(self.convert(0), square.abs_upper().sqrt())
        root = self.sqrt(square)
        rough = complex(approximation)
        if isinstance(approximation, self.flint.acb) and not 4 * approximation.rad() < abs(approximation.mid()):
            raise PrecisionLoss("the sheet of a point is undecided; use more digits")
        near = complex(root)
        cosine = near.real * rough.real + near.imag * rough.imag
        if not 2 * abs(cosine) > abs(near) * abs(rough):
            raise PrecisionLoss("the sheet of a point is undecided; use more digits")
        return root if cosine > 0 else -root

    def widened(self, x: Any, error: Any) -> Any:
        """The ball of all numbers at a distance of at most ``error`` from x; a real ball for real x."""
        beside = self.flint.arb(0, error.abs_upper())
        return x + (beside if isinstance(x, self.flint.arb) else self.flint.acb(beside, beside))

    def nodes(self, n: int) -> list[Any]:
        """The non-negative Chebyshev nodes cos((2j−1)π/(2n)), descending; n is even."""
        found = self._known.get(("nodes", n))
        if found is None:
            cos, fraction = self.flint.arb.cos_pi_fmpq, self.flint.fmpq
            found = self._known["nodes", n] = [cos(fraction(2 * j - 1, 2 * n)) for j in range(1, n // 2 + 1)]
        return found

    def legendre(self, n: int) -> list[tuple[Any, Any]]:
        """The positive nodes of Gauss–Legendre quadrature on [−1, 1] with their weights; n is even."""
        found = self._known.get(("legendre", n))
        if found is None:
            root = self.flint.arb.legendre_p_root
            found = self._known["legendre", n] = [root(n, k, weight=True) for k in range(n // 2)]
        return found

    def along_path(self, ratios: Vector, forms: Forms, rate: float) -> Vector:
        """∫₀¹ forms(s²)/Π√(1 − s²·ratio) ds, a product over ``ratios``; ``rate`` is not used.

        Gauss's rule is applied to pieces of [0, 1], shorter ones near singularities.
        """
        pieces, total = [(0.0, 1.0)], list[Any]()
        while pieces:
            start, end = pieces.pop()
            part = self._piece(ratios, forms, start, end)
            if part is None:
                middle = (start + end) / 2
                pieces += [(start, middle), (middle, end)]
            else:
                total = plus(total, part) if total else part
        return total

    def _piece(self, ratios: Vector, forms: Forms, start: float, end: float) -> Vector | None:
        """The integral from ``start`` to ``end``, or None where that takes too many nodes."""
        arb = self.flint.arb
        # the integrand is even, so the integral from 0 is half of that over the interval [−end, end]
        middle, half = (0.0, end) if start == 0 else ((start + end) / 2, (end - start) / 2)
        axes = []
        for ratio in ratios:
            # the singularities are s = ±1/√ratio; a ratio near 0 may be a ball around 0, and s = ±10^15 is used then
            w = 1 / self.sqrt(ratio) if abs(ratio) > 1e-30 else self.convert(10**15)
            axes.append(tuple(semi_axis((sign * w - middle) / half) for sign in (1, -1)))
        most = NODES_A_DIGIT * self.digits + MORE_NODES
        try:
            n, rho = self.rule([float(axis) for pair in axes for axis in pair], most)
        except Infeasible:
            if half < LEAST_PIECE:
                raise
            return None
        cosh, largest = rho.cosh(), arb(half)
        for ratio, (first, second) in zip(ratios, axes, strict=True):
            if abs(ratio) > 1e-30:
                largest = largest / (abs(ratio) * half**2 * (first - cosh) * (second - cosh)).sqrt()
            else:
                largest = largest / (1 - abs(ratio) * (middle + half * cosh) ** 2).sqrt()
        s = middle + half * self.widened(self.convert(0), cosh)
        error = largest * 64 / 15 / (1 - (-2 * rho).exp()) / (2 * rho * n).exp()
        rows = [(middle + half * t, half * weight) for t, weight in self.legendre(n)]
        if start:
            rows += [(middle - half * t, half * weight) for t, weight in self.legendre(n)]
        nodes, weights = zip(*rows, strict=True)
        sums = path_sums(self, [self.convert(t) for t in nodes], weights, ratios, forms)
        return [self.widened(x, error * abs(form)) for x, form in zip(sums, forms(s * s), strict=True)]

    def rule(self, axes: Sequence[float], most: int) -> tuple[int, Any]:
        """(number of nodes, ρ of the ellipse in the error bound) of a rule; Infeasible beyond ``most`` nodes.

        The integrand is Π(t − u)^(−1/2) times a polynomial; ``axes``: the semi-axes of the ellipses through the u.
        """
        widest = min(MOST_RHO, *(math.acosh(max(axis, 1.0)) for axis in axes)) if axes else MOST_RHO

        def needed(rho: float) -> float:
            growth = -0.5 * sum(math.log(1 - math.cosh(rho) / axis) for axis in axes)
            return (self.bits * math.log(2) + growth) / (2 * rho)

        if not widest > 1e-12:
            self.node_count(0, most)
        rho = min((width * widest for width in WIDTHS), key=needed)
        return self.node_count((self.digits + 3) / needed(rho), most), self.flint.arb(rho)


def semi_axis(u: Any) -> Any:
    """The semi-axis of the ellipse with foci ±1 through u."""
    return (abs(u - 1) + abs(u + 1)) / 2


@lru_cache(maxsize=16)
def ball_numbers(bits: int) -> BallNumbers:
    """The BallNumbers of a precision. Calls share one object, so that its nodes and weights are made once."""
    return BallNumbers(bits)


def exact_parts(x: Any) -> tuple[Fraction, Fraction]:
    """The real and the imaginary part of a number of QQ, RR, CC or MP(dps) as exact fractions."""
    return _fraction(x.real), _fraction(x.imag)


def _fraction(x: Any) -> Fraction:
    if hasattr(x, "_mpf_"):
        sign, mantissa, exponent, _ = x._mpf_
        return Fraction(-int(mantissa) if sign else int(mantissa)) * Fraction(2) ** exponent
    return Fraction(x)
