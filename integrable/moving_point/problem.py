"""What a flow is about, before any precision is chosen: the curve, the start and the units of one motion."""

from __future__ import annotations

from typing import Any

from integrable.moving_point.translations import REACH
from integrable.phase.body import Body, Vector, cross
from integrable.phase.upright import ChaplyginTransformation
from jacobian import poly
from jacobian.errors import ArgumentError
from jacobian.numbers.roots import root


class MotionProblem:
    """The motion of a body over a field from γ and M: numbers of that field, which may be balls.

    ``f`` is the curve, ascending; ``axes`` and ``start`` are those of :mod:`integrable.moving_point.addition`. Units: x
    over X = max a_i, τ' = 2X|M|·τ, t' = 2X|M|·t; ``time_scale`` is 2X|M|, ``momentum`` |M|, ``ratio`` H1/(H2·X), ``d``
    d·X, ``half_step`` half of a basic step.
    A tilted state is brought to (γ, M) = 0 by ``tilt``, Chaplygin's transformation.
    """

    def __init__(self, body: Body, gamma: Vector, M: Vector, tilted: bool) -> None:
        K = self.field = body.field
        # the constraints hold to rounding; make them hold to the last digit
        length = K.sqrt(K.dot(gamma, gamma))
        gamma = (gamma[0] / length, gamma[1] / length, gamma[2] / length)
        self.tilt: ChaplyginTransformation | None = None
        if tilted:
            self.tilt = ChaplyginTransformation.of(body, gamma, M)
            body, (gamma, M) = self.tilt.upright, self.tilt.apply_vectors(gamma, M)
        tilt = K.dot(gamma, M)
        M = (M[0] - tilt * gamma[0], M[1] - tilt * gamma[1], M[2] - tilt * gamma[2])
        h1, h2 = body.integrals(gamma, M)[2:]
        if h2 == 0:
            raise ArgumentError("M = (0, 0, 0): the body is at rest; a flow needs M ≠ 0")
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
        K = self.field
        g = 1 / K.sqrt(body.conformal(gamma))
        w = cross(K, gamma, M)
        lean = 2 * g * body.d * sum(a * x * y for a, x, y in zip(body.a, gamma, w, strict=True)) / (2 * spin)
        sigma = tuple(g * x for x in gamma)
        nu = tuple(y / spin + lean * x for x, y in zip(sigma, w, strict=True))
        u, v = [K.zero] * 3, [K.zero] * 3
        for i, (r, x, y) in enumerate(zip(body.contact, sigma, nu, strict=True)):
            others = self.axes[(i + 1) % 3], self.axes[(i + 2) % 3]
            for k, c in enumerate((others[0] * others[1], -others[0] - others[1], 1)):
                u[k] += r * x * x * c
                v[k] += r * x * y * c
        return (u[0], u[1], v[0], v[1], *sigma, *nu)


def vectors(point: Any, momentum: Any, matrix: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """(γ, M) of a moving point of bare reals, mpf or balls.

    ``momentum`` is |M|; ``matrix`` is the inverse of Chaplygin's transformation, None for an upright body.
    """
    sigma, nu = point[4:7], point[7:10]
    square = sum(x * x for x in sigma)
    lean = sum(x * y for x, y in zip(sigma, nu, strict=True)) / square
    length = root(square)
    gamma = tuple(x / length for x in sigma)
    w = [(y - lean * x) * momentum for x, y in zip(sigma, nu, strict=True)]
    M = tuple(w[i - 2] * gamma[i - 1] - w[i - 1] * gamma[i - 2] for i in range(3))
    if matrix is None:
        return gamma, M
    a, b, c, d = matrix
    return (
        tuple(a * x + b * y for x, y in zip(gamma, M, strict=True)),
        tuple(c * x + d * y for x, y in zip(gamma, M, strict=True)),
    )
