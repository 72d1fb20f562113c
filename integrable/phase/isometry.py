"""The isometries that map the geodesic flows (d = 0) of the tilde, check and hat pairs to each other.

The pairs of integrals are those of :mod:`integrable.deformations`. A diagonal matrix B maps the sphere to itself by
γ ↦ γ' = Bγ/|Bγ|. The cotangent lift of this map, on states with (γ, M) = 0, is M' = Bγ × B⁻¹(M × γ); it is canonical.
A body is named by its matrix A; the body of the matrix A⁻¹ has the moments I'_i = a_i. With B² = diag(a_j·a_k) the
lift maps the hat pair of A to det A times the tilde pair of A⁻¹. With B² = A the lift maps the check pair of A to
−det A times this tilde pair.
"""

from __future__ import annotations

from collections.abc import Sequence

from integrable.phase.body import Vector, cross, square_root
from jacobian.element import FormulaField, Real
from jacobian.errors import NotRepresentable


def lift(K: FormulaField, B: Sequence[Real], gamma: Vector, M: Vector) -> tuple[Vector, Vector]:
    """The image (γ', M') of (γ, M) under the cotangent lift of γ ↦ Bγ/|Bγ|, B diagonal; B⁻¹ gives the inverse map.
    NotASquare where |Bγ| is not in the field, NotRepresentable where it is zero.
    """
    turned = (K.mul(B[0], gamma[0]), K.mul(B[1], gamma[1]), K.mul(B[2], gamma[2]))
    length = square_root(K, K.dot(turned, turned), "|Bγ|²")
    if length == K.zero:
        raise NotRepresentable(f"|Bγ|² = 0 over {K.name}: γ has no image")
    w = cross(K, M, gamma)
    image = (K.div(turned[0], length), K.div(turned[1], length), K.div(turned[2], length))
    return image, cross(K, turned, (K.div(w[0], B[0]), K.div(w[1], B[1]), K.div(w[2], B[2])))


def roots(field: FormulaField, squares: Sequence[Real]) -> Vector:
    """The diagonal of the matrix B of :func:`lift` from that of B²; NotASquare where the field lacks a root."""
    x, y, z = (square_root(field, value, "B²") for value in squares)
    return x, y, z
