"""Arithmetic in Jacobians of hyperelliptic curves y² + h(x)y = f(x), of any genus, over any field.

>>> from jacobian import GF, HyperellipticCurve
>>> C = HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1])
>>> J = C.jacobian()
>>> D = J.from_points([(0, 1)])
>>> 5 * D
(1, 0)
"""

from __future__ import annotations

from jacobian.owner import say

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from jacobian.curve.curve import HyperellipticCurve
    from jacobian.curve.points import AffinePoint, PointAtInfinity
    from jacobian.errors import (
        ArgumentError,
        CurveMismatch,
        FieldError,
        Infeasible,
        JacobianError,
        NotAMultiple,
        NotASquare,
        NotOnCurve,
        NotRepresentable,
        PrecisionLoss,
        SingularCurve,
    )
    from jacobian.fields import CC, GF, MP, QQ, RR
    from jacobian.fields.protocol import Field
    from jacobian.group import Jacobian
    from jacobian.law.divisor import Divisor

__all__ = [
    "CC",
    "GF",
    "MP",
    "QQ",
    "RR",
    "AffinePoint",
    "ArgumentError",
    "CurveMismatch",
    "Divisor",
    "Field",
    "FieldError",
    "HyperellipticCurve",
    "Infeasible",
    "Jacobian",
    "JacobianError",
    "NotAMultiple",
    "NotASquare",
    "NotOnCurve",
    "NotRepresentable",
    "PointAtInfinity",
    "PrecisionLoss",
    "SingularCurve",
]

_HOME = {
    **dict.fromkeys(__all__, "jacobian.errors"),
    **dict.fromkeys(("CC", "GF", "MP", "QQ", "RR"), "jacobian.fields"),
    **dict.fromkeys(("AffinePoint", "PointAtInfinity"), "jacobian.curve.points"),
    "Divisor": "jacobian.law.divisor",
    "Field": "jacobian.fields.protocol",
    "HyperellipticCurve": "jacobian.curve.curve",
    "Jacobian": "jacobian.group",
}
"""The module of each public name: that of the errors, unless another one is given."""

__distribution__ = "jacobian-integrable"
say()

if not TYPE_CHECKING:
    # ``__getattr__`` is hidden from type checkers, which would otherwise accept any misspelt name

    def __getattr__(name: str) -> Any:
        # names are imported on first use, so that a command can handle Ctrl-C before its imports
        from importlib import import_module
        from importlib.util import find_spec

        if name in _HOME:
            found = getattr(import_module(_HOME[name]), name)
            globals()[name] = found
            return found
        if name.startswith("_") or find_spec(f"jacobian.{name}") is None:
            raise AttributeError(f"module 'jacobian' has no attribute {name!r}")
        return import_module(f"jacobian.{name}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
