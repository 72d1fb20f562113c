"""The field of real or complex balls, in which motions on Jacobians of any genus have proven bounds.

A composition and a reduction step are identities between exact divisors. So they map balls around divisors to balls
around results. If a resultant or a leading coefficient is a ball that contains 0, the result has no bound.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from integrable.moving_point.balls import BallField, around
from jacobian.element import Real
from jacobian.numbers.long_reals import BallReals

if TYPE_CHECKING:
    from flint import acb, acb_poly, arb, arb_poly

Values = TypeVar("Values")


class _Elementary:
    """exp and log of balls."""

    @staticmethod
    def exp(x: arb | acb) -> arb | acb:
        return x.exp()

    @staticmethod
    def log(x: arb | acb) -> arb | acb:
        return x.log()


class Balls(BallField):
    """The field of balls of ``bits`` bits, real or complex, in place of long numbers; enter it with ``with``."""

    context = _Elementary()

    def __init__(self, bits: int, complex: bool = False) -> None:
        from flint import acb

        self.bits, self.complex = bits, complex
        super().__init__(BallReals(bits))
        self._acb = acb
        self.zero, self.one = self.coerce(0), self.coerce(1)
        # a ball counts as 0 only if it is proven to be 0
        self.eps = abs(self.zero)

    def __enter__(self) -> Balls:
        self.reals.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self.reals.__exit__(*error)

    def coerce(self, value: Any, argument: str = "value") -> arb | acb:
        """The ball of radius 0 around a number; a ball is returned unchanged."""
        if not self.complex:
            return super().coerce(value)
        if isinstance(value, self._acb):
            return value
        return self._acb(self.reals.number(value.real), self.reals.number(value.imag))

    def nearest(self, x: arb | acb) -> int:
        """The integer nearest to the real part of the midpoint of x."""
        return self.reals.nearest(x.real)

    def balls(self, values: Values) -> Values:
        """Returns ``values`` unchanged: they are balls already."""
        return values

    def from_ball(self, x: Values) -> Values:
        """Returns the ball ``x`` unchanged."""
        return x


def ball_around(x: arb | acb, radius: Real) -> arb | acb:
    """A ball, real or complex like x, that contains x widened by an upper bound of ``radius``."""
    from flint import acb

    return acb(around(x.real, radius), around(x.imag, radius)) if isinstance(x, acb) else around(x, radius)


def polynomials(complex: bool) -> type[arb_poly | acb_poly]:
    """flint's class of polynomials over real or complex balls."""
    from flint import acb_poly, arb_poly

    return acb_poly if complex else arb_poly
