"""Integrals over the two ovals of a motion's curve, in floats or to the digits of a set-up.

Let y = √|f| with f = 4(1 − d̃x)Π(a_i − x)(x·H̃2 − H̃1), the curve of the upright body, to which tildes refer
(:mod:`integrable.phase.upright`). Let a₁ < a₂ < a₃ be the sorted a_i and ζ = H̃1/H̃2. The abscissa u1 moves in the oval
[a₁, min(ζ, a₂)] and u2 in [max(ζ, a₂), a₃]. The integrals are

    A_k = ∫x^k dx/y over the first oval, B_k = ∫x^k dx/y over the second.

The integrals are computed by the arithmetic-geometric mean (:mod:`integrable.moving_point.elliptic_integrals`); an oval
that has shrunk to a point gives residues.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from integrable.moving_point.elliptic_integrals import mean_slowness, oval_periods
from integrable.moving_point.setup import Setup
from integrable.phase.body import Body
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import Mpf
from jacobian.numbers.roots import root

FLOAT_EPS = 2.0**-52


class Level(NamedTuple):
    """The data of a motion on which its periods depend: the sorted a_i and their axes, ζ between the least and the
    largest a_i, d̃, √H̃2, and s of Chaplygin's transformation. The numbers are all floats or all mpf.
    """

    a: tuple[Real, Real, Real]
    axes: tuple[int, int, int]
    zeta: Mpf
    d: Real
    momentum: Real
    s: Real

    @staticmethod
    def of(setup: Setup) -> Level:
        """The level of a set-up's motion, in its wide numbers."""
        problem = setup.problem
        top = problem.time_scale / (2 * problem.momentum)
        axes = sorted(range(3), key=lambda i: problem.axes[i])
        a1, a2, a3 = (problem.axes[i] * top for i in axes)
        zeta = min(max(problem.ratio * top, a1), a3)
        s = problem.matrix[3] if problem.matrix else setup.wide.one
        return Level((a1, a2, a3), (axes[0], axes[1], axes[2]), zeta, problem.d / top, problem.momentum, s)

    @staticmethod
    def at(body: Body, X: Real, zeta: Mpf) -> Level:
        """The level of all motions with H2 = 1, (γ, M)² = X < 1 and H1/H2 = ζ of the upright body.

        ζ is between the least and the largest a_i. Chaplygin's transformation depends on X and ζ only.
        """
        axes = sorted(range(3), key=lambda i: body.a[i])
        a1, a2, a3 = (body.a[i] for i in axes)
        d, thin = body.d, 1 - body.d * zeta
        u = 1 - d * zeta * (1 - X)
        rest = (1 - X) * thin / u
        s = root(thin * u / (1 - d * zeta * (1 - X) * (2 - d * zeta)))
        return Level((a1, a2, a3), (axes[0], axes[1], axes[2]), zeta, d * rest, root(u / thin), s)

    @property
    def low(self) -> bool:
        """Whether ζ < a₂: M̃ then circles the axis of a₁, otherwise that of a₃."""
        return bool(self.zeta < self.a[1])

    @property
    def ends(self) -> tuple[Real, Real, Real, Real]:
        """The two ends of the first oval, then the two ends of the second."""
        a1, a2, a3 = self.a
        return a1, min(self.zeta, a2), max(self.zeta, a2), a3

    @property
    def contact(self) -> tuple[Real, Real, Real]:
        """The numbers 1 − d̃a_i, with the sorted a_i and d̃ = ``d`` of this level."""
        a1, a2, a3 = self.a
        return 1 - self.d * a1, 1 - self.d * a2, 1 - self.d * a3

    @property
    def pi(self) -> Real:
        """π as a float or mpf, like the level's numbers."""
        return math.pi if isinstance(self.zeta, float) else +self.zeta.context.pi

    @property
    def eps(self) -> Real:
        """The rounding unit of the level's numbers."""
        return FLOAT_EPS if isinstance(self.zeta, float) else self.zeta.context.eps

    @property
    def parted(self) -> bool:
        """Whether the two ovals are separate."""
        ends = self.ends
        return bool(ends[2] - ends[1] > self.eps**0.75 * ends[3])


def zeta_through(level: Level, phi: np.ndarray, momentum: np.ndarray) -> np.ndarray:
    """ζ = q − (q − a₁)M̃_i²/|M̃|² of the motion of the upright body through a point of the section γ̃_i = 0.

    The point is given by its angle ``phi`` = φ and by ``momentum`` = M̃_i/|M̃|. The axis i is that of the largest moment,
    and q(φ) is given in :mod:`integrable.portrait.section`. Arguments and result are arrays of floats.
    """
    a1, a2, a3 = map(float, level.a)
    d, c, s = float(level.d), np.cos(phi) ** 2, np.sin(phi) ** 2
    q = (a3 * c + a2 * s - d * a2 * a3) / (1 - d * (a2 * c + a3 * s))
    return q - (q - a1) * momentum**2


class Ovals(NamedTuple):
    """A_k = ∫x^k dx/y over the first oval and B_k = ∫x^k dx/y over the second, k = 0, 1.

    ``slowness`` is the mean over the torus of 1/√((1 − d̃u1)(1 − d̃u2)) for u1 in the first oval and u2 in the second.
    """

    A0: Real
    A1: Real
    B0: Real
    B1: Real
    slowness: Real

    @staticmethod
    def of(level: Level) -> Ovals:
        """The periods of a level. PrecisionLoss on the separatrix, where the two ovals meet."""
        if not level.parted:
            raise PrecisionLoss(
                f"ζ = {float(level.zeta)} is the middle 1/(I + d) to all digits: on the separatrix periods are infinite"
            )
        # x is divided by a₃, so that all numbers have about the size 1
        top, size, pi = level.a[2], 2 * level.momentum, level.pi
        one = top / top
        scaled, d = tuple(x / top for x in level.ends), level.d * top
        near, out = float(level.eps) ** 0.5 / 16, [0 * one] * 4
        oval_periods(scaled, d, one, pi, near, out)
        area = out[0] * out[3] - out[1] * out[2]
        a0, a1, b0, b1 = (x / (2 * size) for x in out)
        slowness = mean_slowness(scaled, d, one, pi, near, area) if d else one
        return Ovals(a0 / top, a1, b0 / top, b1, slowness)

    @property
    def D(self) -> Real:
        """The determinant A0·B1 − A1·B0, which is positive."""
        return self.A0 * self.B1 - self.A1 * self.B0
