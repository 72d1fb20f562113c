"""The data of the animated page of a scene: plain numbers, ready for JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State
from integrable.scene.data import Scene
from integrable.scene.file import load_scene
from integrable.scene.orbit import orbit
from integrable.view.ovals import Ovals, ovals
from jacobian import RR
from jacobian.errors import ArgumentError, NotRepresentable, PrecisionLoss, whole, written

__all__ = ["FRAMES", "shown"]

FRAMES = 600
TURNS = 12
"""The most turns of the body that are shown by default, counted at the angular velocity of the start."""
STRAIGHT = 1e-3
"""The largest deviation of the angles from a straight line in τ, in turns: a larger one would be visible, so the torus
is then not drawn.
"""
HALF = 0.5
"""The largest change of an angle between two frames, in turns: the direction of a larger one would be ambiguous."""


def shown(given: Scene | str | Path, until: float | None = None, frames: int = FRAMES) -> dict[str, Any]:
    """The data of the page: ``times``, ``gamma`` and, where they exist, ``turning``, ``contact``, ``points``,
    ``angles`` and ``ovals``.

    ``turning`` has the body's axes in space, nine numbers a frame; ``missing`` gives the reasons for absent data.
    ``until`` is the last time, by default that of the scene or of TURNS turns, whichever is less. There are ``frames``
    equally spaced times, or the first ``frames`` states of an orbit. ArgumentError over finite fields or without body.
    """
    scene = given if isinstance(given, Scene) else load_scene(given)
    frames = whole(frames, "frames", "give an int from 2 to 20000", 2, 20000)
    if scene.finite_field:
        raise ArgumentError(
            f"{scene.place}: over {scene.finite_field} there is no picture; a scene over the reals is needed"
        )
    if scene.classical:
        raise ArgumentError(
            f"{scene.place}: there is no picture that moves of {scene.system}, which has no body; "
            "`integrable run` draws its coordinates"
        )
    system, state = scene.start(FLOAT_DIGITS)
    if scene.steps is not None:
        run: Any = orbit(scene.step(system, FLOAT_DIGITS), state, min(scene.steps.count, frames - 1))
    else:
        times = np.linspace(0.0, _last(scene, system, state, until), frames)
        run = system.motion_through(state).at(times)
    content: dict[str, Any] = {
        "name": scene.name,
        "title": scene.title,
        "description": " ".join(scene.description.split()),
        "steps": scene.steps is not None,
        "times": _rounded(run.times),
        "gamma": _rounded(run.gamma),
        "missing": [],
    }
    for add in (_add_body, _add_points):
        try:
            add(content, scene, system, run)
        except (NotRepresentable, PrecisionLoss) as error:
            content["missing"].append(str(error))
    return content


def _last(scene: Scene, system: Any, state: State, until: float | None) -> float:
    if until is not None:
        last: float = RR.coerce(until, "until")
        if last <= 0:
            raise ArgumentError(f"until = {written(last)}: give a time > 0")
        return last
    rate = float(np.linalg.norm(system._omega_along(*(np.array([v]) for v in state.vectors))))
    return min(max(scene.times.floats()), 2 * np.pi * TURNS / rate)


def _add_body(content: dict[str, Any], scene: Scene, system: Any, run: Any) -> None:
    if scene.steps is not None:
        raise NotRepresentable("a step maps one state to another; nothing rolls in between")
    # the matrices map coordinates in the body to coordinates in space
    content["turning"] = _rounded(run.attitude.reshape(-1, 9))
    content["contact"] = _rounded(run.contact / (system.radius or 1.0)) if scene.system == "chaplygin_ball" else None


def _bend(found: Ovals, tau: np.ndarray) -> float:
    """The largest distance of the angles, in turns, from a straight line in τ."""
    off = found.angles - found.angles[0] - np.outer(tau - tau[0], found.rates)
    return float(np.abs(off - np.rint(off)).max())


def _add_points(content: dict[str, Any], scene: Scene, system: Any, run: Any) -> None:
    if not scene.rolls_or_spins:
        raise NotRepresentable("this motion is on two elliptic curves; the page shows γ alone")
    found = ovals(system, list(run))
    if scene.steps is None:
        if _bend(found, run.tau) > STRAIGHT:
            raise PrecisionLoss("the points on the curve are lost in rounding: the torus cannot be drawn")
        if np.abs(np.diff(run.tau)).max() * np.abs(found.rates).max() > HALF:
            raise NotRepresentable(
                f"between two of the {len(run)} frames a point of the curve goes more than half round its oval: "
                "with more frames, or until an earlier time, the torus can be drawn"
            )
    content["points"] = _rounded(np.concatenate([found.u, found.y], axis=1), 7)
    content["angles"] = _rounded(found.angles % 1.0)
    content["ovals"] = [[_rounded(x, 7), _rounded(y, 7)] for x, y in found.outlines]


def _rounded(values: Any, digits: int = 5) -> Any:
    """The values as lists of floats with ``digits`` significant digits, enough for a picture."""
    flat = [float(f"{x:.{digits}g}") for x in np.asarray(values, dtype=float).ravel()]
    return np.array(flat).reshape(np.shape(values)).tolist()
