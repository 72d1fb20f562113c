"""The content of files of states: quantities with their components and units, and a description of the motion."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from integrable.files.frame import Column, Frame, version
from jacobian.errors import ArgumentError, entries, shown

__all__ = [
    "AXES", "QUANTITIES", "Quantity", "about", "checked", "columns", "made_of", "number", "reasons_text", "stamp",
    "status_column", "trajectory_frame",
]  # fmt: skip


class Quantity(NamedTuple):
    """A quantity's last dimension, the labels along it, its unit and its long name."""

    dim: str
    parts: tuple[str, ...]
    units: str
    long_name: str


AXES = ("1", "2", "3")
QUANTITIES = {
    "gamma": Quantity("axis", AXES, "1", "vertical unit vector in the body frame"),
    "M": Quantity("axis", AXES, "kg m2 s-1", "angular momentum about the contact or fixed point in the body frame"),
    "omega": Quantity("axis", AXES, "rad s-1", "angular velocity in the body frame"),
    "quaternion": Quantity("component", ("w", "x", "y", "z"), "1", "rotation from the body frame to space"),
    "contact": Quantity("direction", ("x", "y"), "m", "point of contact, in metres or radii"),
}
"""The quantities of a result, by the names of the result's attributes."""
UNITS = "those of SI, or of the consistent set that the body and M were given in"


def checked(quantities: Iterable[str] | None, among: Mapping[str, Quantity] = QUANTITIES) -> tuple[str, ...]:
    """The names ``quantities`` as a tuple. Raises ArgumentError unless ``among`` has all of these names."""
    known = ", ".join(among)
    asked = [quantities] if isinstance(quantities, str) else entries(quantities, "quantities", f"a list of {known}")
    for name in asked:
        if not isinstance(name, str) or name not in among:
            raise ArgumentError(f"quantities: {shown(name)} given; choose among {known}")
    return tuple(dict.fromkeys(asked))


def about(system: Any, **more: Any) -> dict[str, Any]:
    """The attributes that describe a motion: numbers, strings and lists of numbers."""
    return {
        **made_of(system, {"inertia": system.body.inertia, "d": system.body.d, **system.arguments}),
        "units_note": UNITS,
        **more,
    }


def made_of(system: Any, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """The description of a system or body: its ``parameters``, its number type, and the software that computed it."""
    return {
        "title": f"motion of {system!r}",
        "system": type(system).__name__,
        "system_stamp": stamp(system),
        **{name: number(x) if np.ndim(x) == 0 else [number(y) for y in x] for name, x in parameters.items()},
        "field": system.field.name,
        "source": f"jacobian-integrable {version()}",
        "version": version(),
    }


def stamp(system: Any) -> str:
    """The identity of a system as JSON: the values of its parameters, and the version of this package."""
    return json.dumps({**system.identity, "version": version()}, ensure_ascii=False)


def columns(
    dims: tuple[str, ...], arrays: Mapping[str, np.ndarray], among: Mapping[str, Quantity] = QUANTITIES
) -> dict[str, Column]:
    """The columns of the quantities in ``arrays``, along the dimensions ``dims``."""
    found = {}
    for name, values in arrays.items():
        dim, parts, units, long_name = among[name]
        found[name] = Column((*dims, dim), values, units, long_name, parts)
    return found


def status_column(dims: tuple[str, ...], status: np.ndarray, reasons: Sequence[str]) -> Column:
    """The column of status numbers: 0 where a state was computed, otherwise the number of a reason."""
    flags = ("had", *reasons[1:])
    return Column(dims, status.astype(np.int32), "1", "0: state was had, else the number of a reason", (), flags)


def reasons_text(reasons: Sequence[str]) -> str:
    """The reasons 1, 2, … as one attribute, a list in JSON."""
    return json.dumps(reasons[1:], ensure_ascii=False)


def trajectory_frame(run: Any, quantities: Iterable[str] | None) -> Frame:
    """The frame of a run along "time"; for an orbit this coordinate holds the numbers of the steps."""
    names, dims = checked(quantities), ("time",)
    orbit = run.way == "steps"
    if run.system.field.exact:
        raise ArgumentError(f"field = {run.system.field.name}: files are of runs over RR or MP(digits)")
    variables = columns(dims, {name: _values(run, name) for name in names})
    coordinate = Column(dims, run.times, "1" if orbit else "s", "number of the step" if orbit else "physical time t")
    if not orbit:
        variables["tau"] = Column(dims, run.tau, "s", "time of the flow, dτ = g dt")
    variables["status"] = status_column(dims, run.status, run.reasons)
    state = {} if orbit else {"tilted": int(run.flow.state.tilted)}
    attributes = about(run.system, way=run.way, reasons=reasons_text(run.reasons), **state)
    return Frame(dims, {"time": coordinate}, variables, attributes)


def _values(run: Any, name: str) -> np.ndarray:
    """The values of the quantity ``name`` in all rows of a run; NaN in refused rows."""
    if name in ("gamma", "M") or not run.status.any():
        values: np.ndarray = getattr(run, name)
        return values
    had = getattr(run.kept, name)
    filled = np.full((len(run), had.shape[1]), run.gamma[run.status > 0][0, 0], had.dtype)
    filled[run.status == 0] = had
    return filled


def number(x: Any) -> Any:
    """A multiprecision number as a string of its digits, any other number as a float."""
    return float(x) if isinstance(x, float) or not hasattr(x, "context") else str(x)
