"""The energy–momentum diagram of a body: all its motions in the plane of X = c²/H2 and Z = H1/H2, c = (γ, M).

X and Z are invariant under M ↦ λM. The diagram is the part of the strip 0 ≤ X ≤ 1 between the straight lines Z = a(1 +
Xd/I), a = 1/(I + d), of the largest and the least moment I. The line of the middle moment is the separatrix; each of
the three lines consists of the rotations about its axis. X = 1 means M ∥ γ. Let ζ be H1/H2 of the upright body. All
motions with one ζ lie on a straight line too, Z = ζ(1 − dζ(1 − X))/(1 − dζ), and every quantity is a function of X and
ζ (:meth:`integrable.portrait.ovals.Level.at`).
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import numpy as np

from integrable.moving_point.elliptic_integrals import complete
from integrable.portrait.ovals import Level, Ovals
from integrable.portrait.pictures import diagram
from jacobian import RR
from jacobian.element import Numbers
from jacobian.errors import ArgumentError, floats, shown, whole
from jacobian.immutable import Record
from jacobian.notebook import table
from jacobian.numbers.roots import root

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from integrable.phase.body import Body
    from integrable.phase.space import PhaseSpace
    from integrable.phase.state import State

MOST_COUNT = 300
"""The largest number of rows of a grid of rotation numbers; the largest grid takes about half a minute."""


class Diagram(Record):
    """The energy–momentum diagram of a system over RR. Get one from ``system.diagram()``.

    ``lines`` has the ends, (X, Z) = ((γ, M)²/H2, H1/H2), of the line of rotations about each axis, shape (3, 2, 2).
    """

    def __init__(self, system: PhaseSpace) -> None:
        if system.field is not RR:
            raise ArgumentError(f"diagram: of a body over RR, not over {system.field.name}")
        self.system = system
        a, inertia = np.array(system.a), np.array(system.inertia)
        self.lines = np.stack([np.stack([0 * a, a], axis=1), np.stack([1 + 0 * a, 1 / inertia], axis=1)], axis=1)

    def place(self, state: State) -> tuple[float, float]:
        """The point (X, Z) of a state in the diagram."""
        _, c, h1, h2 = self.system.integrals(state)
        if not h2:
            raise ArgumentError("M = (0, 0, 0): the body is at rest, which has no place in its diagram")
        # γ is a unit vector only up to rounding
        return min(c * c / h2, 1.0), h1 / h2

    def height(self, X: Numbers, zeta: Numbers) -> np.ndarray:
        """The height Z at X and ζ, which are arrays that broadcast."""
        (X, values), d = _reals(X=X, zeta=zeta), self.system.d
        if (d * values == 1).any():
            raise ArgumentError(f"zeta = {shown(zeta)}: 1 − d·ζ must not vanish")
        with np.errstate(over="ignore", invalid="ignore"):
            found: np.ndarray = values * (1 - d * values * (1 - X)) / (1 - d * values)
        if not np.isfinite(found).all():
            raise ArgumentError(f"X = {shown(X)}, zeta = {shown(zeta)}: Z is beyond the range of floats there")
        return found

    def contains(self, X: Numbers, Z: Numbers) -> np.ndarray:
        """Whether motions with (γ, M)²/H2 = X and H1/H2 = Z exist; the arguments are arrays that broadcast."""
        X, Z = _reals(X=X, Z=Z)
        least, most = min(self.system.a), max(self.system.a)
        return (X >= 0) & (X <= 1) & (self.height(X, least) <= Z) & (self.height(X, most) >= Z)

    def divergence(self, X: Numbers) -> np.ndarray:
        """The exponent χ, per unit of t and of √H2, with which nearby motions leave the unstable rotation; 0 ≤ X ≤ 1.

        χ = √H̃2·√h(a₂)·P/(πs) at H2 = 1, with the principal value P = ∫x dx/((x − a₂)√h) from a₁ to a₃ and
        h = 4H̃2(1 − d̃x)(x − a₁)(a₃ − x). Tildes and s are those of Chaplygin's transformation
        (:mod:`integrable.phase.upright`), and a₁ < a₂ < a₃ the sorted a_i.
        """
        (values,) = _reals(X=X)
        if not ((values >= 0) & (values <= 1)).all():
            raise ArgumentError(f"X = {shown(X)}: numbers from 0 to 1 are needed, X = (γ, M)²/H2")
        rates = [_divergence(self.system.body, float(x)) for x in values.ravel()]
        return np.array(rates).reshape(values.shape)

    def rotation_numbers(self, count: int = 40) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(X, Z, rotation number) on a grid in X and ζ = H1/H2 of the upright body, for contours in the diagram.

        The arrays have the shape (count, 2·count) if all moments differ. The ζ are denser near the separatrix, which is
        excluded.
        """
        count = whole(count, "count", f"an int from 2 to {MOST_COUNT}", 2, MOST_COUNT)
        a1, a2, a3 = sorted(self.system.a)
        # points on both sides of the separatrix at a₂, denser at the ends of each side
        part = (1 - np.cos(np.pi * (np.arange(count) + 0.5) / count)) / 2
        zeta = np.concatenate([a1 + (a2 - a1) * part, a2 + (a3 - a2) * part])
        X = (np.arange(count) + 0.5) / count
        X, zeta = np.meshgrid(X, zeta[np.diff(zeta, prepend=-1.0) > 0], indexing="ij")
        numbers = [
            _rotation_number(Level.at(self.system.body, x, z)) for x, z in zip(X.ravel(), zeta.ravel(), strict=True)
        ]
        return X, self.height(X, zeta), np.array(numbers).reshape(X.shape)

    def figure(self, *states: State) -> Figure:
        """A picture: contours of the rotation number, a line for the rotations about each axis, points of states."""
        return diagram(self, states)

    def _repr_html_(self) -> str:
        ends = ((*start, *end) for start, end in self.lines.tolist())
        rows = [(moment, *end) for moment, end in zip(self.system.inertia, ends, strict=True)]
        return table(repr(self), ["rotations about the axis of", "X", "Z", "to X", "Z"], rows)

    def __repr__(self) -> str:
        return f"<Diagram of {self.system!r}>"


def _reals(**given: Numbers) -> tuple[np.ndarray, ...]:
    """The named arguments, broadcast to arrays of one shape."""
    found = [floats(values, argument, "real numbers are needed") for argument, values in given.items()]
    for argument, values in zip(given, found, strict=True):
        if not np.isfinite(values).all():
            raise ArgumentError(f"{argument} = {shown(given[argument])}: finite numbers are needed")
    try:
        return tuple(np.broadcast_arrays(*found))
    except ValueError:
        shapes = " and ".join(str(x.shape) for x in found)
        raise ArgumentError(f"{', '.join(given)}: shapes that broadcast are needed, not {shapes}") from None


def _rotation_number(level: Level) -> float:
    if not level.parted:
        return -1.0
    ovals = Ovals.of(level)
    return float(-ovals.B1 / ovals.A1)


def _divergence(body: Body, X: float) -> float:
    """χ at X. P is a complete elliptic integral (Bulirsch 1969), and every sum here is one of positive numbers."""
    axes = sorted(range(3), key=lambda i: body.a[i])
    middle = body.contact[axes[1]]
    lean = body.d * body.a[axes[1]] * X
    # the numbers 1 − d̃a_i of the upright body, and √H̃2/s
    r1, r2, r3 = ((X + (1 - X) * middle * body.contact[i]) / (middle + lean) for i in axes)
    size = root(middle * middle + lean * (1 + middle)) / middle
    integral = complete(root(r3 / r1), r2 / r1, 1.0, 1 / r1, pi, 1e-9)
    return 2 * size * root(r2 / r1 * abs(body.differences[axes[1]])) * integral / pi
