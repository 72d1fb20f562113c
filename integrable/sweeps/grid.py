"""The grid of a sweep: the varied numbers of a scene, their values, and the numbers of each member."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene, Times
from integrable.scene.toml import exact_number, suggestion
from jacobian.errors import ArgumentError, entries, shortened, shown

__all__ = ["MASS", "Grid", "from_words"]

MOST_VALUES = 10**7
MOST_MEMBERS = 10**8
PARTS: dict[str, Any] = {
    "inertia": slice(0, 3), "d": 3, "gamma": slice(4, 7), "M": slice(7, 10), "c": 10, "potential": slice(11, 16),
    "mass": 16, "radius": 17,
}  # fmt: skip
"""The columns of a row for each attribute of a scene; those of the first four are the columns of an ensemble."""
C, MASS, RADIUS, PLACES = PARTS["c"], PARTS["mass"], PARTS["radius"], 18
NAMES = {
    name if isinstance(place, int) else f"{name}.{i + 1}": column
    for name, place in PARTS.items()
    for i, column in enumerate([place] if isinstance(place, int) else range(place.start, place.stop))
}
SCALES = {f"{name}.scale": PARTS[name] for name in ("inertia", "M")}
WANTED = "first:last:count, first:last:count:log or values with commas, such as 0.1:2:50"


class Grid:
    """All combinations of the varied numbers; those of the last name vary fastest. ``axes`` maps names to values."""

    def __init__(self, scene: Scene, vary: Any) -> None:
        if scene.steps is not None or scene.finite_field:
            raise ArgumentError(f"scene {scene.name}: it has [steps]; a sweep is of motions, which have [run]")
        if scene.digits > FLOAT_DIGITS:
            raise ArgumentError(f"scene {scene.name}: digits = {scene.digits}; a sweep is of floats, digits = 15")
        if not isinstance(vary, Mapping):
            raise ArgumentError(f'vary = {shown(vary)}: give names with values, such as {{"d": "0.1:2:50"}}')
        self.scene, self._base = scene, _base(scene)
        known = [name for name, place in NAMES.items() if not np.isnan(self._base[place])]
        known += SCALES
        for name in vary:
            if name not in known:
                raise ArgumentError(f"vary: {shown(name)} given; {suggestion(str(name), known)}")
        self.axes = {name: _values(name, given) for name, given in vary.items()}
        self.shape = tuple(len(values) for values in self.axes.values())
        if np.prod(self.shape, dtype=float) > MOST_MEMBERS:
            raise ArgumentError(f"vary: {' × '.join(map(str, self.shape))} members; {MOST_MEMBERS:.0e} at most")

    def __len__(self) -> int:
        return int(np.prod(self.shape, dtype=np.int64))

    def values(self, begin: int, end: int) -> dict[str, np.ndarray]:
        """The varied values of members ``begin`` to ``end`` − 1, by name."""
        if not self.axes:
            return {}
        places = np.unravel_index(np.arange(begin, end), self.shape)
        return {name: values[at] for (name, values), at in zip(self.axes.items(), places, strict=True)}

    def rows(self, begin: int, end: int) -> np.ndarray:
        """All numbers of members ``begin`` … ``end`` − 1, shape (end − begin, PLACES); NaN for numbers that the scene
        lacks.
        """
        rows, values = np.tile(self._base, (end - begin, 1)), self.values(begin, end)
        for name, given in values.items():
            if name in NAMES:
                rows[:, NAMES[name]] = given
        for name, given in values.items():
            if name in SCALES:
                rows[:, SCALES[name]] *= given[:, None]
        if not np.isnan(self._base[MASS]):
            rows[:, PARTS["d"]] = rows[:, MASS] * (rows[:, RADIUS] * rows[:, RADIUS])
        return rows


def _base(scene: Scene) -> np.ndarray:
    if scene.classical:
        raise ArgumentError(f"{scene.place}: {scene.system} has no body; sweeps are of balls, tops and their relatives")
    row = np.full(PLACES, np.nan)
    for name, place in PARTS.items():
        if (given := getattr(scene, name)) is not None:
            row[place] = np.array(given, dtype=float)
    if scene.system == "tilde":
        row[PARTS["d"]] = float(scene.d or 0)
    return row


def from_words(words: Iterable[str]) -> dict[str, str]:
    """A dictionary of the command's arguments ``name=values``."""
    vary: dict[str, str] = {}
    for word in words:
        name, equals, values = word.partition("=")
        if not equals or not name or name in vary:
            raise ArgumentError(f"--vary {shortened(word)}: once for each name, NAME={WANTED} is needed")
        vary[name] = values
    return vary


def _values(name: str, given: Any) -> np.ndarray:
    if isinstance(given, str):
        found = np.array(_parsed(name, given))
    else:
        try:
            found = np.array(entries(given, f"vary: {name}"), dtype=np.float64)
        except Exception:
            raise ArgumentError(f"vary: {name} = {shown(given)}: numbers, or {WANTED}, are needed") from None
    if found.ndim != 1 or not found.size or not (abs(found) < 1e100).all():
        raise ArgumentError(f"vary: {name} = {shown(given)}: finite numbers are needed, one at least")
    return found


def _parsed(name: str, text: str) -> list[float]:
    parts = text.split(":")
    if log := parts[3:] == ["log"]:
        parts.pop()
    try:
        if len(parts) == 1:
            return [float(exact_number(part)) for part in text.split(",")]
        first, last, count = exact_number(parts[0]), exact_number(parts[1]), int(parts[2])
        if len(parts) != 3 or not 1 <= count <= MOST_VALUES or (log and not first * last > 0):
            raise ValueError
        return Times(first=first, until=last, count=count, spacing="log" if log else "linear").floats()
    except (ValueError, IndexError, OverflowError):
        raise ArgumentError(f"vary: {name}={shortened(text)}: {WANTED}, is needed") from None
