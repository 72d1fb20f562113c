"""What the inexact fields share: deciding zero against a scale."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from jacobian.errors import PrecisionLoss
from jacobian.immutable import Immutable


class InexactField(Immutable):
    """Base of RR, CC and MP: bare arithmetic operators, and a zero test that admits when it cannot tell."""

    name: str
    exact = False
    characteristic = 0
    order = None
    eps: Any

    def __repr__(self) -> str:
        return self.name

    def add(self, x: Any, y: Any) -> Any:
        return x + y

    def sub(self, x: Any, y: Any) -> Any:
        return x - y

    def mul(self, x: Any, y: Any) -> Any:
        return x * y

    def neg(self, x: Any) -> Any:
        return -x

    def inv(self, x: Any) -> Any:
        return 1 / x

    def div(self, x: Any, y: Any) -> Any:
        return x / y

    def is_zero(self, x: Any, scale: Any = None) -> bool:
        """Whether x, a difference of terms of size ``scale``, is zero.

        Up to 16·eps·scale it is; from 4096·eps·scale on it is not; between the two PrecisionLoss is raised. Without a
        scale only an exact 0 is zero.
        """
        if scale is None:
            return bool(x == 0)
        size = abs(x)
        if size <= 16 * self.eps * scale:
            return True
        if size >= 4096 * self.eps * scale:
            return False
        raise PrecisionLoss(
            f"x = {x} beside terms of size scale = {scale}: {self.name} cannot tell it from zero; use more digits"
        )

    def key(self, x: Any) -> Hashable:
        """x itself."""
        result: Hashable = x
        return result

    def from_key(self, key: Any) -> Any:
        """The element with that :meth:`key`."""
        return key
