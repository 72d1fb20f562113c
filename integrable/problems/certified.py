"""Certified trajectories: motions with proven bounds at 50 times, for testing integrators.

The data come from the flow in ball arithmetic (:mod:`integrable.motion.enclosure`); the data of deformations come from
Taylor series in ball arithmetic (:mod:`integrable.deformations.enclosed`). ``python -m benchmarks.make_certified``
makes the data.
"""

from __future__ import annotations

import hashlib
import json
from fractions import Fraction
from importlib.resources import files
from typing import Any, NamedTuple

from integrable.scene.data import Scene, Times, system_class
from jacobian.errors import ArgumentError, one_of

__all__ = ["Certified", "certified", "certified_names", "schema"]

_FOLDER = "certified"


class Certified(NamedTuple):
    """A motion with known states: ``gamma[k]`` and ``M[k]`` at ``times[k]``, as decimal strings.

    The true motion starts at ``gamma[0]``, ``M[0]`` and differs from the strings by at most ``bound[k]``, M relative to
    |M|. ``inertia``, ``d``, ``times`` and, for deformations that have them, ``potential`` and ``c`` are exact doubles.
    The unit of time is the unit of the moments divided by that of M; for deformations it is the unit of their
    equations.
    """

    name: str
    system: str
    about: str
    inertia: tuple[float, float, float]
    d: float
    tilted: bool
    times: tuple[float, ...]
    gamma: tuple[tuple[str, str, str], ...]
    M: tuple[tuple[str, str, str], ...]
    bound: tuple[float, ...]
    potential: tuple[float, ...] | None = None
    c: float | None = None

    def scene(self) -> Scene:
        """The motion of a ball or top as a scene with the same times, from the first state, rounded to doubles."""
        if self.system not in ("chaplygin_ball", "euler_top"):
            raise ArgumentError(f"system: {self.system}; a ball or a top is needed")
        gamma, M = (tuple(Fraction(float(x)) for x in rows[0]) for rows in (self.gamma, self.M))
        return Scene(
            name=self.name,
            title=self.about,
            description=self.about,
            system=self.system,
            inertia=tuple(map(Fraction, self.inertia)),
            d=Fraction(self.d) if self.system == "chaplygin_ball" else None,
            mass=None,
            radius=None,
            gamma=gamma,
            M=M,
            tilted=self.tilted,
            times=Times(given=tuple(map(Fraction, self.times))),
        )

    def start(self) -> tuple[Any, Any]:
        """The pair (system, state) of the first row, in floats."""
        given = {"d": self.d or None, "potential": self.potential, "c": self.c}
        system = system_class(self.system)(self.inertia, **{key: x for key, x in given.items() if x is not None})
        gamma, M = (tuple(map(float, rows[0])) for rows in (self.gamma, self.M))
        return system, system.state(gamma, M, **({"tilted": True} if self.tilted else {}))


def certified(name: str) -> Certified:
    """The certified motion with the given name; ArgumentError for a name not in :func:`certified_names`."""
    motions = _motions()
    given = motions[one_of(name, "name", tuple(motions), f"give one of {', '.join(motions)}")]
    rows, names = given.pop("rows"), {"times": "t", "gamma": "gamma", "M": "M", "bound": "bound"}
    given |= {name: [row[key] for row in rows] for name, key in names.items()}
    return Certified(**{name: _hashable(value) for name, value in given.items()})


def _hashable(value: Any) -> Any:
    return tuple(map(_hashable, value)) if isinstance(value, list) else value


def certified_names() -> list[str]:
    """The names of all certified motions."""
    return list(_motions())


def schema() -> dict[str, Any]:
    """The JSON Schema of the file of certified motions."""
    found: dict[str, Any] = json.loads(_text("schemas", "certified.json"))
    return found


def _motions() -> dict[str, Any]:
    text = _text(_FOLDER, "trajectories.json")
    expected = dict(line.split()[::-1] for line in _text(_FOLDER, "SHA256SUMS").splitlines())
    if hashlib.sha256(text.encode()).hexdigest() != expected["trajectories.json"]:
        raise ArgumentError("certified/trajectories.json is not what SHA256SUMS says: install the package again")
    return {motion["name"]: motion for motion in json.loads(text)["motions"]}


def _text(folder: str, name: str) -> str:
    return files("integrable").joinpath(folder, name).read_text(encoding="utf-8")
