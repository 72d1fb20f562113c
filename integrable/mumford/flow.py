"""The motion of one state of a system on a Jacobian of any genus: whichever way has its times soonest.

Near times in floats come from Taylor series (:mod:`integrable.series.equations`), many from the compiled torus or from
tables, all others by additions in long numbers (:mod:`integrable.mumford.motion`).
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from integrable.mumford.motion import MumfordMotion, Start
from integrable.phase.precisions import ROUNDED_TO_FLOATS
from jacobian.errors import ArgumentError, PrecisionLoss, one_or_more
from jacobian.immutable import Record
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted
from jacobian.relatives.extended import Extended

if TYPE_CHECKING:
    import numpy as np

    from integrable.mumford.body_torus import BodyTorus
    from integrable.mumford.real_torus import RealTorus
    from integrable.mumford.tabled import TabledStates
    from integrable.phase.enclosure import EnclosedPath
    from integrable.series.equations import Equations

# from so many times on the torus of a motion of genus 2 pays, and what differs from additions by more is not it
MANY, RIGHT = 24, 1e-12
# standard steps of series (Equations.weight) that take as long as a point by additions, as setting up a torus and as a
# point there, and the most that are worth trying
STEPS_BY_ADDITIONS, STEPS_TO_TORUS, STEPS_ON_TORUS, MOST_STEPS = 500, 5000, 1, 50000
# the words of Path.way
SERIES, TORUS, ADDITIONS = "series", "torus", "additions"
# where tables in double-double numbers keep what floats need
GENERA_TABLED = range(3, 7)


class Point(NamedTuple):
    """A state: positions ``q`` and momenta or velocities ``p``."""

    q: tuple[Any, ...]
    p: tuple[Any, ...]


class Path(Record):
    """States at ``times``: ``q`` and ``p`` of shape (N, n), floats, or objects over MP(digits). ``way`` says what has
    computed them: "series", "torus", "additions", or several of them.
    """

    def __init__(self, times: Any, q: Any, p: Any, way: str = ADDITIONS) -> None:
        self.times = times
        self.q = q
        self.p = p
        self.way = way

    def __len__(self) -> int:
        return len(self.times)


class MumfordFlow:
    """The motion of one state: ``at(times)``. Get it from ``system.flow(state)``."""

    _setting_up = 2000
    """Standard steps of series that take as long as setting up additions."""

    def __init__(self, system: Any, state: Point) -> None:
        self.digits = long_digits(system.field)
        self.system = system
        self.start = state
        self._genus = len(system.spectral(state).v)
        self._clock = system._clock if system.clocked else None

    @cached_property
    def _motion(self) -> MumfordMotion:
        return MumfordMotion(self._place, self._genus, self.system.complex_data)

    def _inner(self, N: Any) -> Point:
        return self.system._constrained(N, self.system._inside(N, self.start))

    def _place(self, N: LongField) -> Start:
        return self.system._start(N, self._inner(N))

    def at(self, times: Any) -> Path:
        """The states at times (a number or a sequence of them, in any order, of any sign and size).

        Floats are right to their last bits, numbers of MP(digits) to their digits; see
        :meth:`integrable.mumford.motion.MumfordMotion.row`. Floats near the start come from Taylor series
        (:mod:`integrable.series.short`). Many others of a motion of genus 2 in floats are read off its real torus, some
        units in the last place off; those of one of genus 3 to 6 come from tables. ArgumentError for times that are no
        numbers.
        """
        import numpy as np

        given = self._given(times)
        equations = None if hasattr(self.system.field, "dps") or interpreted() else self.system._equations
        if equations is None or not given:
            return self._far(given)
        places, rows = self._near(equations, np.array(given))
        if not len(places):
            return self._far(given)
        left, way = np.delete(np.arange(len(given)), places), SERIES
        states = np.empty((len(given), 2, self.system.size))
        states[places] = rows
        if len(left):
            far = self._far([given[i] for i in left])
            states[left], way = np.stack([far.q, far.p], axis=1), f"{SERIES}, {far.way}"
        return Path(np.array(given), states[:, 0], states[:, 1], way)

    def _near(self, equations: Equations, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The places of times that series reach in no more time than additions, and the states there."""
        from integrable.series.equations import BITS

        most = 0 if "_motion" in vars(self) else self._setting_up
        if len(times) >= MANY and self._may_have_torus:
            most += len(times) * STEPS_ON_TORUS + (0 if "_torus" in vars(self) else STEPS_TO_TORUS)
        else:
            most += len(times) * STEPS_BY_ADDITIONS
        with LongField(BITS) as N:
            state = self._inner(N)
            start = [*state.q, *state.p, *self.system._auxiliary(N, state)]
        return equations.around(start, times, min(most, MOST_STEPS) / equations.weight)

    def _far(self, given: list[Any]) -> Path:
        """The states at times, by additions, however they are made."""
        import numpy as np

        K = self.system.field
        if len(given) >= MANY and self._torus is not None and self._torus.reaches(np.array(given)):
            return self._path(self._torus, np.array(given))
        if given and self._tabled is not None:
            q, p = self._tabled.at(np.array(given))
            return Path(np.array(given), q, p)
        rows = [self._row(t) for t in self._places(given)]
        kind = object if hasattr(K, "dps") else float
        q, p = (
            np.array([[element(K, x) for x in row[i]] for row in rows], dtype=kind).reshape(len(rows), self.system.size)
            for i in (0, 1)
        )
        return Path(np.array(given, dtype=kind), q, p)

    def _row(self, time: Any) -> Any:
        """The state at a time, in long numbers."""
        return self._motion.row(time, self._reader(time), self.digits, self._clock)

    @property
    def _compiles(self) -> bool:
        """Whether compiled loops in floats may take the motion."""
        return not (hasattr(self.system.field, "dps") or self.system.complex_data or interpreted())

    @cached_property
    def _tabled(self) -> TabledStates | None:
        """What makes many states of a motion in floats, of more points than a torus is for."""
        if self._genus not in GENERA_TABLED or self._clock is not None or not self._compiles:
            return None
        from integrable.mumford.tabled import TabledStates

        return TabledStates(self._place, self._read_columns, lambda t: [[*map(float, x)] for x in self._row(t)])

    def _given(self, times: Any, name: str = "times") -> list[Any]:
        return [self.system.field.coerce(t, f"{name}[{i}]") for i, t in enumerate(one_or_more(times, name))]

    def enclosure(self, times: Any, digits: int | None = None) -> EnclosedPath:
        """Proven bounds of the states at times: balls of radius at most 10^(−digits) that contain them, q and p beside
        their size at the start or then, whichever is larger.

        The inputs count as exact, but that q and p are moved onto their constraints; ``digits`` are by default those of
        the field, 15 for RR. A far time costs bits only. PrecisionLoss where no such balls were found.
        (:mod:`integrable.mumford.enclosure`)
        """
        from integrable.mumford.enclosure import enclosed_path

        return enclosed_path(self, self._given(times), digits)

    def enclosure_at_tau(self, tau: Any, digits: int | None = None) -> EnclosedPath:
        """:meth:`enclosure` at values of τ, in which the motion is that of ``system.direction``; its ``times`` are None
        where time is not linear.
        """
        from integrable.mumford.enclosure import enclosed_path

        return enclosed_path(self, self._given(tau, "tau"), digits, in_tau=True)

    def tau_near(self, time: Any, digits: int) -> Any:
        """τ at a time of a motion that carries its clock, a long number."""
        return self._motion.tau_at(time, digits, self._clock)

    def _places(self, times: list[Any]) -> list[Any]:
        """What the motion is asked for to be there at these times: themselves, or τ."""
        return times

    @property
    def _may_have_torus(self) -> bool:
        """Whether there may be one, and none was looked for in vain."""
        return self._genus == 2 and self._compiles and vars(self).get("_torus", self) is not None

    @cached_property
    def _torus(self) -> RealTorus | BodyTorus | None:
        """The compiled torus of a motion of genus 2 in floats, where there is one."""
        if not self._may_have_torus:
            return None
        try:
            torus = self._made_torus()
            return torus if self._confirmed(torus) else None
        except (PrecisionLoss, ZeroDivisionError):
            return None

    def _made_torus(self) -> RealTorus | BodyTorus:
        from integrable.mumford.real_torus import RealTorus

        return RealTorus(self._place, self.system._time_rate if self.system.clocked else None)

    def _confirmed(self, torus: Any) -> bool:
        """Whether a torus has the states that additions in long numbers lead to, signs included."""
        import numpy as np

        path = self._path(torus, torus.witnesses)
        for time, *rows in zip(self._places(torus.witnesses.tolist()), path.q, path.p, strict=True):
            true = self._row(time)
            for row, other in zip(rows, true, strict=True):
                expected = np.array([float(x) for x in other])
                if not np.abs(row - expected).max() <= RIGHT * np.abs(expected).max():
                    return False
        return True

    def _path(self, torus: Any, times: Any) -> Path:
        """The states at times from a torus."""
        import numpy as np

        found = self._read_columns(times, torus.at(times))
        q, p = (np.stack([x.hi for x in part], axis=1) for part in found)
        return Path(times, q, p, TORUS)

    def _read_columns(self, times: Any, D: Extended) -> Point:
        """The states of pairs at times, all in columns."""
        from integrable.mumford.columns import Column, Columns

        N = Columns()
        return self.system._back(N, self._inner(N), D, Column(times))

    def _reader(self, time: Any) -> Any:
        return lambda N, D: self.system._back(N, self._inner(N), D, N.coerce(time))


def long_digits(K: Any) -> int:
    """How many digits long numbers need for results in K; ArgumentError but for RR and MP(digits)."""
    if K.exact or getattr(K, "complex", False) or isinstance(K.one, complex):
        raise ArgumentError(f"field = {K.name}: real numbers are needed here, RR or MP(digits)")
    return getattr(K, "dps", ROUNDED_TO_FLOATS)


def element(K: Any, x: Any) -> Any:
    """A long number as an element of RR or MP(digits)."""
    from jacobian.numbers.long_reals import BareReals

    if not hasattr(K, "dps"):
        return float(x)
    return BareReals(64).element(K, x)
