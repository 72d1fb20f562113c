"""Code common to the inexact fields: zero and rounding decided relative to a scale."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any

from jacobian.element import Element
from jacobian.errors import FieldError, PrecisionLoss, shown, written
from jacobian.fields.protocol import OperatorField


class InexactField(OperatorField[Element]):
    """Base of RR, CC and MP: a zero test that raises PrecisionLoss when it cannot decide."""

    exact = False
    eps: Any
    dps: Any = None
    """The decimal digits of the numbers; None for RR and CC."""
    complex: bool = False
    """Whether the numbers are complex."""
    _is_finite: Callable[[Any], bool]

    def coerce(self, value: object, argument: str = "value") -> Element:
        """The element nearest to a number, as in :meth:`Field.coerce`; FieldError for anything else."""
        try:
            x = self._convert(value, argument)
        except FieldError:
            raise
        except OverflowError:
            raise FieldError(f"{argument} = {shown(value)} is beyond the range of {self.name}") from None
        except Exception:
            kind = "a number" if self.complex else "a real number"
            raise FieldError(f"{argument} = {shown(value)} is not an element of {self.name}: give {kind}") from None
        if not self._is_finite(x):
            raise FieldError(f"{argument} = {shown(value)} is not finite: give a finite number")
        return x

    def _convert(self, value: Any, argument: str) -> Element:
        """The element nearest to a number, perhaps infinite or NaN. Any exception means that ``value`` is no number."""
        raise NotImplementedError

    def is_zero(self, x: Any, scale: Any = None) -> bool:
        """Whether x, a difference of terms of size ``scale``, is zero.

        x counts as zero up to 16·eps·scale and as nonzero from 4096·eps·scale on. In between, and where the scale is
        beyond the range of floats, PrecisionLoss is raised. Without a scale only an exact 0 is zero.
        """
        if scale is None:
            return bool(x == 0)
        size, unit = abs(x), self.eps * scale
        # relative to an infinite scale everything is small, even an infinite x
        if unit < inf:
            if size <= 16 * unit:
                return True
            if size >= 4096 * unit:
                return False
        raise PrecisionLoss(
            f"x = {written(x)} beside terms of size scale = {written(scale)}: {self.name} cannot tell it from zero; "
            "use more digits"
        )

    def is_rounding(self, x: Any, scale: Any) -> bool:
        """Whether x is a possible rounding error of terms of size ``scale``, up to 10^6·eps·scale; PrecisionLoss where
        the scale is beyond the range of floats.
        """
        if scale < inf:
            return bool(abs(x) <= 1e6 * self.eps * scale)
        raise PrecisionLoss(
            f"x = {written(x)} beside terms of size scale = {written(scale)}: beyond the range of {self.name}; use "
            "MP(digits)"
        )
