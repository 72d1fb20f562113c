"""Problems: equations and a start in doubles, integrals, and the solution at any time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from integrable.mumford.flow import Point
from integrable.oracles.methods import time_scale
from integrable.oracles.reference import body_equations
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.problems.arrays import Arrays, columns, stacked
from integrable.problems.motion import UnitMotion
from integrable.scene.data import Scene
from integrable.scene.doubles import in_doubles
from jacobian.element import Number, Numbers, Value
from jacobian.errors import ArgumentError, JacobianError, shown, whole
from jacobian.immutable import replaced

__all__ = ["Problem", "Truth"]

STEP = 1e-200
"""The step h of complex differences Im f(x + ih)/h, which have no cancellation: if h² is 0 in doubles, they are right
to rounding.
"""
UNIT_ROUNDING = 2.0**-52


class Truth(NamedTuple):
    """The solution at some times, and its uncertainty: every component of ``y`` is right to within ``radius``.

    ``y`` and ``radius`` have shape (…, n). If ``proven``, the radius comes from ball arithmetic. Otherwise it is an
    estimate: twice the difference of two runs, the second with 12 more digits, plus the rounding of ``y``. ``y`` holds
    doubles up to 16 digits, mpmath numbers above.
    """

    y: np.ndarray
    radius: np.ndarray
    proven: bool


class Problem:
    """The initial value problem y' = f(y), y(0) = ``y0``. ``problem(name)`` makes one.

    ``y0`` and the constants of f are doubles, which are exact by definition. The first half of y is γ or q, the second
    half M or p; ``letters`` names them. ``system`` is the system of the package, in floats. ``times`` are those of the
    scene; ``reference`` cites a description of the motion.
    """

    def __init__(self, scene: Scene) -> None:
        if scene.steps is not None:
            raise ArgumentError(f'name = "{scene.name}": an orbit of a map; a problem is a motion, such as "chaplygin"')
        if not (scene.rolls_or_spins or scene.classical):
            raise ArgumentError(
                f'name = "{scene.name}": the {scene.system} system is known for |γ| = 1 only, which no doubles meet '
                "exactly; integrable.problems.certified has such motions"
            )
        self.scene = in_doubles(scene)
        self.name, self.title, self.reference, self.letters = scene.name, scene.title, scene.reference, scene.letters
        self.description = " ".join(scene.description.split())
        self.y0 = np.array([*map(float, self.scene.gamma), *map(float, self.scene.M)])
        self.y0.flags.writeable = False
        self.times = tuple(self.scene.times.floats())
        self.motion = UnitMotion(self.scene)
        self.system: Any = self.motion.in_floats

    def __repr__(self) -> str:
        return f"problem({self.name!r})"

    # --- the equations

    def rhs(self, t: Number, y: Sequence[Number] | np.ndarray) -> np.ndarray:
        """f(y) for states of shape (…, n), float64 or complex128; t, which solvers pass, is not used."""
        given = np.asarray(y)
        if given.ndim == 1 and given.dtype == np.float64:
            # for a single state Python's floats are faster than NumPy's
            return np.array(self.rates(Arrays(), given.tolist()))
        return stacked(self.rates(Arrays(), columns(given)))

    def jacobian(self, t: Number, y: Sequence[Number] | np.ndarray) -> np.ndarray:
        """∂f_i/∂y_j at states of shape (…, n), an array of shape (…, n, n), right to rounding.

        It is computed by complex steps (Squire & Trapp 1998).
        """
        given = np.asarray(y, dtype=float)
        moved = given[..., None, :] + 1j * STEP * np.eye(given.shape[-1])
        return np.swapaxes(self.rhs(t, moved).imag / STEP, -1, -2)

    def rates(self, numbers: Any, y: Sequence[Any]) -> list[Any]:
        """f at y of any type that overloads the operators, such as another library's expressions.

        ``numbers`` has the methods of :class:`integrable.problems.arrays.Arrays`.
        """
        if self.scene.classical:
            return list(self.system.rates_in(numbers, y))
        return body_equations([numbers.coerce(x) for x in self.system.inertia], numbers.coerce(self.system.d))(y)

    def invariants(self, y: Sequence[Number] | np.ndarray) -> np.ndarray:
        """The integrals of the motion at states of shape (…, n): shape (…, k), named by ``invariant_names``."""
        return stacked(self._invariants(columns(np.asarray(y, dtype=float))).values())

    @cached_property
    def invariant_names(self) -> tuple[str, ...]:
        """The names of the integrals that :meth:`invariants` returns, in the same order."""
        return tuple(self._invariants(columns(self.y0)))

    def _invariants(self, y: list[Any]) -> dict[str, Any]:
        """The left sides of the constraints, such as |q|², and the integrals of the motion scaled to |q| = 1."""
        half, found = len(y) // 2, dict[str, Any]()
        q, p = y[:half], y[half:]
        unit, system = self.motion.unit, self.system
        if unit is not None:
            weights = [float(x) for x in self.motion.weights]
            q_name, p_name = self.letters
            found[f"|{q_name}|²"] = unit.square(weights, q)
            if unit.normal or not self.scene.classical:
                found[f"({q_name}, {p_name})"] = unit.along(weights, q, p)
            size = np.sqrt(found[f"|{q_name}|²"])
            q, p = [x / size**unit.q for x in q], [x / size**unit.p for x in p]
        if not self.scene.classical:
            return found | dict(zip(("H1", "H2"), system.body.energies(q, p), strict=True))
        for name, value in system.system._integrals(Arrays(), Point(tuple(q), tuple(p))).items():
            several = value if isinstance(value, tuple) else (value,)
            found |= {f"{name} {i}" if len(several) > 1 else name: x for i, x in enumerate(several)}
        return found

    # --- scales

    @cached_property
    def time_scale(self) -> float:
        """The time in which q or p changes by about its own size, at the start."""
        return time_scale(*self.motion.start(FLOAT_DIGITS))

    def condition(self, t: Numbers) -> np.ndarray:
        """The condition number of the state at times t, with respect to relative changes of the inputs.

        It is Σ|x ∂y/∂x| over all constants and components x of the start, with q and p relative to their sizes.
        Multiplied by 2⁻⁵² it is the effect of rounding the inputs to doubles.
        """
        given = _times(t)
        return np.array([self._condition(time) for time in given.ravel().tolist()]).reshape(given.shape)

    def _condition(self, time: float, digits: int = FLOAT_DIGITS) -> float:
        from integrable.motion.conditioning import conditioning

        try:
            system, state = self.motion.start(digits)
            found = conditioning(system, state, [system.field.coerce(time) * self.motion.scales(system).time])
        except (JacobianError, ArithmeticError):
            if digits > FLOAT_DIGITS:
                raise
            return self._condition(time, 30)
        return max(found.gamma, found.M)

    def error(self, y: Sequence[Number] | np.ndarray, truth: Truth) -> np.ndarray:
        """The largest error over the components at each time of ``truth``; infinite where y is not finite.

        Errors of γ are absolute, those of M relative to |M|; those of q and p are relative to the largest component at
        the start or at that time.
        """
        given = np.asarray(y, dtype=float)
        return np.where(np.isfinite(given).all(axis=-1), self.relative(given - truth.y, truth), np.inf)

    def relative(self, differences: np.ndarray, truth: Truth) -> np.ndarray:
        """The ``differences`` from ``truth.y``, or the ``truth.radius``, scaled as :meth:`error` scales errors."""
        gaps, sizes = (np.abs(np.asarray(x).astype(float)) for x in (differences, truth.y))
        half, found = len(self.y0) // 2, []
        for part, length in ((slice(0, half), 1.0), (slice(half, None), float(np.linalg.norm(self.y0[half:])))):
            size: Any = length
            if self.scene.classical:
                size = np.maximum(np.abs(self.y0[part]).max(), sizes[..., part].max(axis=-1))
            found.append(gaps[..., part].max(axis=-1) / size)
        return np.asarray(np.maximum(*found))

    # --- the solution

    def truth(self, t: Numbers, digits: int = 16, proven: bool = False) -> Truth:
        """The solution at times t, as a :class:`Truth`. The times are doubles, taken as exact, in any order and shape.

        ``digits`` are relative to the largest component of q, and of p. ``proven`` selects ball arithmetic, which is
        slower; its run time grows in proportion to t if a body rolls or is tilted. Raises PrecisionLoss where that many
        digits were not reached.
        """
        digits = whole(digits, "digits", "give an int ≥ 1, a number of decimal digits (16: doubles)", 1)
        given = _times(t)
        times = given.ravel().tolist()
        rows, gaps = (self.motion.enclosed if proven else self.motion.settled)(times, digits)
        exact, shape = np.array(rows, dtype=object), (*given.shape, len(self.y0))
        y = exact.astype(float) if digits <= FLOAT_DIGITS + 1 else exact
        radius = np.array(gaps, dtype=object) + (abs(exact - y) if y is not exact else 0)
        return Truth(y.reshape(shape), np.nextafter(radius.astype(float), np.inf).reshape(shape), proven)

    # --- other starts

    def starting(self, y0: Iterable[Value]) -> Problem:
        """The same equations with another start. ArgumentError unless its doubles satisfy the constraints exactly."""
        given = np.asarray(y0, dtype=float)
        if given.shape != self.y0.shape or not np.isfinite(given).all():
            raise ArgumentError(f"y0 = {shown(y0)}: {len(self.y0)} finite numbers are needed")
        q, p = (tuple(map(Fraction, part.tolist())) for part in np.split(given, 2))
        return Problem(replaced(self.scene, gamma=q, M=p))

    def another(self, rng: np.random.Generator) -> Problem:
        """The same equations with a random start of about the same size, which satisfies the constraints exactly."""
        return self.starting(self.motion.another(rng))


def _times(t: Any) -> np.ndarray:
    given = np.asarray(t, dtype=float)
    if not np.isfinite(given).all():
        raise ArgumentError(f"t = {shown(t)}: finite times are needed")
    return given
