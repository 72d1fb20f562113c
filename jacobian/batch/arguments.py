"""Checks of the arguments of DivisorArray, and conversion of Mumford pairs to one type of array."""

from __future__ import annotations

from typing import Any

import numpy as np

from jacobian.errors import ArgumentError, FieldError, shown, written
from jacobian.fields import CC, RR
from jacobian.fields.prime import PrimeField
from jacobian.group import Jacobian

# the largest number of rows: more do not fit into memory
MOST_ROWS = 100_000_000


def check_group(J: Any) -> Jacobian:
    """Returns ``J``; raises ArgumentError if it is not a Jacobian. Classes of the groups in :mod:`jacobian.relatives`
    cannot be rows.
    """
    if type(J) is not Jacobian:
        raise ArgumentError(f"J = {shown(J)}: a Jacobian is needed, such as C.jacobian()")
    return J


def elements(J: Jacobian, a: Any, name: str, width: int, compiled: bool) -> Any:
    """``a`` as an array (N, width) of raw elements of J's field: int64 if ``compiled``, else floats or objects."""
    K: Any = J.field
    if hasattr(type(a), "irreducible_poly") and np.size(a):
        K.coerce(a.ravel()[0], name)  # raises for another field
    a = np.asarray(a).view(np.ndarray) if isinstance(a, np.ndarray) else np.array(a, object)
    if a.size == 0:
        a = a.reshape(0, width)
    if a.ndim != 2 or a.shape[1] != width:
        raise ArgumentError(f"{name}: an array of shape {a.shape}; (N, {width}) is needed in genus {J.curve.genus}")
    if a.dtype.kind in "iu" and compiled:
        if isinstance(K, PrimeField):
            return (a % np.array(K.p, np.uint64 if a.dtype.kind == "u" else np.int64)).astype(np.int64)
        if a.size and not 0 <= a.min() <= a.max() < K.order:
            raise FieldError(f"{name}: elements of {K.name} are the ints 0 … {K.order - 1}")
        return a.astype(np.int64)
    known = (np.float64,) if K is RR else (np.float64, np.complex128) if K == CC else ()
    if a.dtype in known and np.isfinite(a).all():
        return a
    found = np.empty(a.shape, object)
    for i, row in enumerate(a.tolist()):
        found[i] = [K.coerce(c, f"{name}[{i}]") for c in row]
    return found.astype(np.int64) if compiled else found


def degrees(J: Jacobian, u: Any, v: Any) -> Any:
    """deg u of each row; raises ArgumentError if some u is not monic or some v is not of lower degree."""
    K, g = J.field, J.curve.genus
    degree = g - np.argmax(u[:, ::-1] != K.zero, axis=1)
    wrong = np.flatnonzero(u[np.arange(len(u)), degree] != K.one)
    if len(wrong):
        raise ArgumentError(f"u[{wrong[0]}] = {u[wrong[0]].tolist()} is not monic")
    wrong = np.flatnonzero(((v != K.zero) & (np.arange(g) >= degree[:, None])).any(axis=1))
    if len(wrong):
        i = wrong[0]
        raise ArgumentError(f"v[{i}] = {v[i].tolist()} is not of lower degree than u[{i}] = {u[i].tolist()}")
    if J.curve.model == "inert" and (degree % 2).any():
        i = np.flatnonzero(degree % 2)[0]
        raise ArgumentError(f"u[{i}] is of degree {degree[i]}: on an inert model deg u must be even")
    return degree


def weights(J: Jacobian, n: Any, degree: Any) -> Any:
    """The weight n at ∞₊ of each row, (N,), by default ⌈(g − deg u)/2⌉; None unless the model is split."""
    g = J.curve.genus
    if J.curve.model != "split":
        if n is not None:
            raise ArgumentError(f"n: a {J.curve.model} model has no weights at infinity, leave n out")
        return None
    if n is None:
        return (g - degree + 1) // 2
    n = np.asarray(n)
    if n.shape != degree.shape or n.dtype.kind not in "iu":
        raise ArgumentError(f"n: an array of {n.dtype} and shape {n.shape}; ints of shape {degree.shape} are needed")
    wrong = np.flatnonzero((n < 0) | (n > g - degree))
    if len(wrong):
        i = wrong[0]
        raise ArgumentError(
            f"n[{i}] = {written(n[i])}: beside deg u = {written(degree[i])} the weight at ∞₊ lies in 0 … "
            f"{written(g - degree[i])}"
        )
    return n
