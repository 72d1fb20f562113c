"""Arithmetic in Jacobians of hyperelliptic curves y² + h(x)y = f(x), of any genus, over any field.

>>> from jacobian import GF, HyperellipticCurve
>>> C = HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1])
>>> J = C.jacobian()
>>> D = J.from_points([(0, 1)])
>>> 5 * D
(1, 0)
"""

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
