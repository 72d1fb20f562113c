"""A motion before any precision is chosen: its curve, start and units."""

from __future__ import annotations

from typing import Any

from integrable.moving_point.translations import REACH
from integrable.phase.body import Body, Vector
from integrable.phase.coordinates import directions_of, to_mumford, to_pairs
from integrable.phase.state import State
from integrable.phase.upright import ChaplyginTransformation
from jacobian import poly
from jacobian.errors import ArgumentError


class MotionProblem:
    """The motion of a body from γ and M, given as numbers of its field, which may be balls.

    ``f`` holds the coefficients of the curve, ascending. ``axes`` and ``start`` are those of
    :mod:`integrable.moving_point.addition`. The unit of x is X = max a_i; times are τ' = 2X|M|·τ and t' = 2X|M|·t.
    ``time_scale`` is 2X|M|, ``momentum`` |M|, ``ratio`` H1/(H2·X), ``d`` d·X and ``half_step`` half of a basic step.
    ``upright_momentum`` is M on the upright body. Chaplygin's transformation ``tilt`` maps a tilted state to
    (γ, M) = 0, and ``matrix`` is its inverse; both are None for an upright state.
    """

    def __init__(self, body: Body, gamma: Vector, M: Vector, tilted: bool) -> None:
        K = self.field = body.field
        # the given vectors satisfy the constraints only up to rounding; restore them to the last digit
        length = K.sqrt(K.dot(gamma, gamma))
        gamma = (gamma[0] / length, gamma[1] / length, gamma[2] / length)
        self.tilt: ChaplyginTransformation | None = None
        if tilted:
            self.tilt = ChaplyginTransformation.of(body, gamma, M)
            body, (gamma, M) = self.tilt.upright, self.tilt.apply_vectors(gamma, M)
        self.matrix = None if self.tilt is None else self.tilt.inverse_matrix()
        tilt = K.dot(gamma, M)
        M = (M[0] - tilt * gamma[0], M[1] - tilt * gamma[1], M[2] - tilt * gamma[2])
        self.upright_momentum = M
        h1, h2 = body.integrals(gamma, M)[2:]
        if h2 == 0:
            raise at_rest()
        top, spin = max(body.a), K.sqrt(h2)
        alphas = tuple(a / top for a in body.a)
        kappas = (r * c / (top * top) for r, c in zip(body.contact, body.differences, strict=True))
        self.axes = (*alphas, *kappas, *self._rate(top, spin))
        self.ratio, self.d = h1 / (h2 * top), body.d * top
        f: tuple[Any, ...] = (-self.ratio, K.one)
        for a in alphas:
            f = poly.mul(K, f, (a, -K.one))
        self.f = (*poly.mul(K, f, (K.one, -self.d)),)
        self.time_scale = 2 * top * spin
        self.momentum = spin
        self.start = self._moving_point(body, gamma, M, spin)
        self.half_step = 2 * REACH * min(*alphas, self.ratio) / K.sqrt(-self.f[0])

    @property
    def branch_points(self) -> tuple[Any, ...]:
        """The roots of f."""
        rest = () if self.d == 0 else (1 / self.d,)
        return (*self.axes[:3], self.ratio, *rest)

    def _rate(self, top: Any, spin: Any) -> tuple[Any, Any]:
        """(α, β) of 1/g, in the units of the flow."""
        if self.tilt is None:
            return self.field.one, self.field.zero
        upright, lean = self.tilt.rate()
        return upright, lean * top * spin

    def _moving_point(self, body: Body, gamma: Vector, M: Vector, spin: Any) -> tuple[Any, ...]:
        pairs = to_pairs(body, State(gamma, M))
        (u0, u1, _), (v0, v1) = to_mumford(body, pairs)
        top, twice = max(body.a), 2 * spin
        sigma, nu = zip(*pairs, strict=True)
        return (u0 / top**2, u1 / top, v0 / (twice * top**2), v1 / (twice * top), *sigma, *(y / twice for y in nu))


def at_rest() -> ArgumentError:
    """The error raised for M = 0."""
    return ArgumentError("M = (0, 0, 0): the body is at rest; a flow needs M ≠ 0")


def vectors(point: Any, momentum: Any, matrix: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """(γ, M) of a moving point of bare reals, mpf or balls.

    ``momentum`` is |M|; ``matrix`` is that of the :class:`MotionProblem`.
    """
    gamma, M = directions_of(point)
    M = (M[0] * momentum, M[1] * momentum, M[2] * momentum)
    if matrix is None:
        return gamma, M
    a, b, c, d = matrix
    return (
        tuple(a * x + b * y for x, y in zip(gamma, M, strict=True)),
        tuple(c * x + d * y for x, y in zip(gamma, M, strict=True)),
    )
