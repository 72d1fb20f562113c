"""Inertia tensors, with their checks, principal moments and axes; and rotation matrices. All numbers are wide."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from jacobian.element import Arithmetic, Real
from jacobian.errors import ArgumentError, entries, shown
from jacobian.fields.protocol import Field

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

    from jacobian.element import Table

# allowed violation of symmetry, relative to the largest entry: data from drawings are rounded
ROUNDED = 1e-9
# allowed deviation of R Rᵀ from 1
ORTHOGONAL = 1e-8
# principal moments closer than this many eps, relative to the tensor's largest entry, count as equal
ALIKE = 4
SWEEPS = 60

Matrix = np.ndarray[tuple[int, int], np.dtype[Any]]
"""Shape (3, 3), of mpf."""

Orientation: TypeAlias = "Table | Rotation"


class Principal(NamedTuple):
    """Principal moments, and the principal axes as columns in the axes of the tensor; the axes are right-handed."""

    moments: tuple[Real, Real, Real]
    axes: Matrix


def principal(K: Field, table: Matrix, eps: Any) -> Principal:
    """The principal moments and axes of a tensor over K = MP(digits). Moments that are equal up to rounding (``eps``)
    are replaced by their mean.

    ArgumentError for a tensor that is not symmetric or not positive definite.
    """
    off = abs(table - table.T)
    size = abs(table).max()
    if (off > ROUNDED * size).any():
        i, j = (int(n) for n in np.argwhere(off > ROUNDED * size)[0])
        raise ArgumentError(
            f"inertia[{i}][{j}] = {float(table[i, j])} and inertia[{j}][{i}] = {float(table[j, i])}: an inertia tensor "
            "is symmetric"
        )
    diagonal, axes = diagonalised(K, (table + table.T) / 2)
    moments = [diagonal[i] for i in range(3)]
    if (axes != np.eye(3)).any():
        moments = _joined(moments, ALIKE * eps * size)
    for i, moment in enumerate(moments):
        if not moment > 0:
            raise ArgumentError(
                f"inertia has the principal moment {float(moment)}: a moment of inertia is positive (moment {i})"
            )
    return Principal((moments[0], moments[1], moments[2]), axes)


def _joined(moments: list[Real], near: Any) -> list[Real]:
    """The moments, where moments within ``near`` of each other are replaced by their mean."""
    order = sorted(range(3), key=lambda i: moments[i])
    low, mid, high = (moments[i] for i in order)
    if mid - low <= near and high - mid <= near:
        low = mid = high = (low + mid + high) / 3
    elif mid - low <= near:
        low = mid = (low + mid) / 2
    elif high - mid <= near:
        mid = high = (mid + high) / 2
    found = dict(zip(order, (low, mid, high), strict=True))
    return [found[i] for i in range(3)]


def diagonalised(K: Any, table: Matrix) -> tuple[np.ndarray, np.ndarray]:
    """(diagonal, columns of axes) of a symmetric matrix, by rotations (Jacobi 1846), to all digits of K."""
    table, axes = table.copy(), np.array([[K.one * (i == j) for j in range(3)] for i in range(3)], dtype=object)
    for _ in range(SWEEPS):
        off = max(abs(table[0, 1]), abs(table[0, 2]), abs(table[1, 2]))
        if off <= K.eps**2 * abs(table).max():
            break
        for i, j in ((0, 1), (0, 2), (1, 2)):
            if table[i, j]:
                # of the two rotations that make this entry 0, the one by the smaller angle is chosen
                lean = (table[j, j] - table[i, i]) / (2 * table[i, j])
                t = (1 if lean >= 0 else -1) / (abs(lean) + K.sqrt(1 + lean * lean))
                c = 1 / K.sqrt(1 + t * t)
                turn = np.array([[K.one * (m == n) for n in range(3)] for m in range(3)], dtype=object)
                turn[i, i] = turn[j, j] = c
                turn[i, j], turn[j, i] = t * c, -t * c
                table, axes = turn.T @ table @ turn, axes @ turn
    return np.diagonal(table), axes


def rotation(K: Any, orientation: Orientation) -> Matrix:
    """The rotation nearest to ``orientation``, which is a matrix from the axes of the body to those of the laboratory,
    or a Rotation of SciPy.

    ArgumentError if ``orientation`` differs from a rotation by more than :data:`ORTHOGONAL`, or is a reflection.
    """
    given = matrices_of(orientation)
    table = matrix(K, given, "orientation", "one rotation, a 3×3 matrix or SciPy's Rotation")
    one = np.eye(3, dtype=int)
    off = abs(table @ table.T - one).max()
    if not off <= ORTHOGONAL:
        raise ArgumentError(
            f"orientation = {shown(given)}: R Rᵀ differs from 1 by {float(off):.1e}, a rotation has orthonormal rows"
        )
    if table[0] @ cross(table[1], table[2]) < 0:
        raise ArgumentError(f"orientation = {shown(given)} has determinant −1: a reflection is no rotation")
    # the polar factor is computed to all digits (Björck and Bowie 1971); each step squares the error
    while off > 8 * K.eps:
        table = table @ (3 * one - table.T @ table) / 2
        off = off * off
    return table


def matrices_of(orientation: Any) -> Any:
    """The matrices of a Rotation of SciPy; anything else unchanged."""
    made = hasattr(orientation, "as_matrix") and not isinstance(orientation, type)
    return orientation.as_matrix() if made else orientation


def matrix(K: Arithmetic, values: Any, argument: str, wanted: str, moments: bool = False) -> Matrix:
    """The values as a 3×3 matrix over K; ArgumentError for other shapes. If ``moments``, three numbers give a diagonal
    matrix.
    """
    try:
        rows = entries(values, argument, wanted)
        given = np.array([_row(row, argument) for row in rows], dtype=object)
    except Exception:
        given = np.empty(0, dtype=object)
    if given.shape == (3,) and moments:
        diagonal = [K.coerce(x, f"{argument}[{i}]") for i, x in enumerate(given)]
        return np.array([[diagonal[i] if i == j else K.zero for j in range(3)] for i in range(3)], dtype=object)
    if given.shape != (3, 3):
        raise ArgumentError(f"{argument} = {shown(values)}: give {wanted}")
    table = [[K.coerce(given[i, j], f"{argument}[{i}][{j}]") for j in range(3)] for i in range(3)]
    return np.array(table, dtype=object)


def _row(row: Any, argument: str) -> Any:
    return row if isinstance(row, str) or not hasattr(row, "__iter__") else entries(row, argument)


def cross(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """x × y of two vectors of mpf; numpy's is ten times slower on three objects."""
    return np.array([x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)], dtype=object)
