"""The running of a scene: what it does not ask for is neither computed nor imported."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from integrable.extras import without
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.scene.file import load_scene
from integrable.scene.progress import bar_of_pieces
from jacobian.errors import ArgumentError, shown, whole
from jacobian.immutable import replaced

if TYPE_CHECKING:
    from integrable.motion.trajectory import Trajectory
    from integrable.scene.output import OutputFolder

__all__ = ["run"]


def run(
    scene: Scene | str | Path,
    *,
    digits: int | None = None,
    out: str | Path | None = None,
    progress: bool = False,
    pictures: bool = True,
    formats: tuple[str, ...] = ("png",),
) -> Trajectory:
    """Run a scene (or load and run it): a Trajectory at its times, for steps the Trajectory that an Orbit is; with
    ``.report`` if the scene asks for one, an Orbit always.

    ``digits`` overrides the scene's own: up to 15 floats, above that multiprecision. With ``out``, a folder,
    ``result.json``, ``report.txt`` and the pictures are written there, each file complete or not at all; the folder is
    tried before anything is computed. ``progress`` draws a bar on stderr. What needs a library that is not installed is
    left out, and a MissingExtraWarning says so before anything is computed.
    """
    scene, digits = _checked(scene, digits, out)
    drawn = pictures and out is not None and bool(scene.pictures)
    missing = without(_uses(scene, drawn, progress))
    pictures, progress = drawn and "matplotlib" not in missing, progress and "tqdm" not in missing
    if out is None:
        with _ticks(progress, scene, digits) as tick:
            return _compute(scene, digits, tick)
    from integrable.scene.output import OutputFolder

    with OutputFolder(out) as folder, _ticks(progress, scene, digits) as tick:
        trajectory = _compute(scene, digits, tick)
        _write(scene, digits, trajectory, folder, formats if pictures else ())
        return trajectory


def _checked(given: Any, digits: Any, out: Any) -> tuple[Scene, int]:
    """The scene, loaded, and the digits of its run; ArgumentError before anything is computed."""
    if not isinstance(given, (Scene, str, os.PathLike)):
        raise ArgumentError(f"scene = {shown(given)}: give a Scene, the name of one or the path of a .toml file")
    scene = given if isinstance(given, Scene) else load_scene(given)  # type: ignore[arg-type]
    if out is not None and not isinstance(out, (str, os.PathLike)):
        raise ArgumentError(f"out = {shown(out)}: give the path of a folder")
    digits = scene.digits if digits is None else digits
    digits = whole(digits, "digits", "a positive number of decimal digits is needed (15: floats)", 1)
    if scene.finite_field and digits != scene.digits:
        raise ArgumentError(f"digits: {digits} given; an orbit over {scene.finite_field} is exact and has none")
    system, _ = scene.start(digits)
    if scene.steps is not None:
        scene.step(system, digits)
    return scene, digits


def _uses(scene: Scene, drawn: bool, progress: bool) -> dict[str, str]:
    """What a run uses of the libraries that need not be installed."""
    uses = {
        "scipy": "the rows of SciPy's DOP853" if scene.report is not None and scene.report.tolerances else "",
        "matplotlib": "the pictures" if drawn else "",
        "tqdm": "the progress bar" if progress else "",
    }
    return {module: what for module, what in uses.items() if what}


def _compute(scene: Scene, digits: int, tick: Callable[[str], None]) -> Any:
    if scene.report is not None:
        from integrable.study.motions import measure

        report, trajectory = measure(scene, digits, tick)
        return replaced(trajectory, report=report)
    if scene.steps is not None:
        from integrable.study.orbits import measure_orbit

        return measure_orbit(scene, digits, tick)
    tick(f"{digits} digits")
    system, state = scene.start(digits)
    return system.motion_through(state).at(scene.times.at(digits))


@contextmanager
def _ticks(progress: bool, scene: Scene, digits: int) -> Iterator[Callable[[str], None]]:
    """A function to call before each piece of work, with its name; it moves a bar if there is one."""
    if not progress:
        yield lambda _label: None
        return
    total = 1
    if scene.report is not None:
        from integrable.study.motions import pieces_of_work

        total = pieces_of_work(scene, digits)
    elif scene.steps is not None:
        from integrable.study.orbits import pieces_of_orbit

        total = pieces_of_orbit(scene, digits)
    with bar_of_pieces(scene.name, total) as tick:
        yield tick


def _write(scene: Scene, digits: int, trajectory: Any, folder: OutputFolder, formats: tuple[str, ...]) -> None:
    """``result.json``, ``report.txt`` and, in each of the formats, the pictures."""
    from integrable.scene.output import as_json, result

    report = trajectory.report
    curve = None
    if formats and ("sphere" in scene.pictures or "coordinates" in scene.pictures):
        curve = trajectory
        if scene.steps is None:
            shown = scene.sphere or scene.times
            system, state = scene.start(FLOAT_DIGITS)
            curve = system.motion_through(state).at(shown.floats())
    folder.write_text("result.json", as_json(result(scene, digits, trajectory, curve)))
    if report is not None:
        folder.write_text("report.txt", report.table() + "\n")
    if formats:
        from integrable.study.plot import draw

        for picture in scene.pictures:
            for suffix in formats:
                folder.write_bytes(f"{picture}.{suffix}", draw(picture, suffix, scene, report, curve))
