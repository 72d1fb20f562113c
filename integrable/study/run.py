"""Runs a scene. Results that the scene does not request are not computed, and their code is not imported."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from integrable.extras import without
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.scene.file import load_scene
from integrable.scene.progress import bar_of_pieces
from integrable.study.timing import Tick, silent
from jacobian.errors import ArgumentError, shown, whole
from jacobian.immutable import replaced

if TYPE_CHECKING:
    from integrable.motion.trajectory import Trajectory
    from integrable.scene.output import OutputFolder

__all__ = ["run"]

OF_MOTION = ("sphere", "coordinates")
"""Pictures that show only the states, and need no report."""


def run(
    scene: Scene | str | Path,
    *,
    digits: int | None = None,
    out: str | Path | None = None,
    progress: bool = False,
    pictures: bool = True,
    formats: tuple[str, ...] = ("png",),
    lines: Callable[[str], None] | None = None,
) -> Trajectory:
    """Runs a scene (a Scene, name or file); returns a Trajectory at its times, or an Orbit of its steps.

    The result has a ``.report`` if the scene has a ``[report]`` table; an Orbit always has one. ``digits`` overrides
    the scene's own: up to 15 means floats, above that multiprecision. ``out`` is a folder for ``result.json``,
    ``report.txt`` and the pictures. Each file is written completely or not at all, and the folder is tested before
    anything is computed. Pictures of the motion alone are written before any comparison.

    ``progress`` draws a bar on stderr. ``lines`` is called with each line of the report as soon as it is known; the
    first row is the run's own result. Parts that need a missing library are left out, with a MissingExtraWarning before
    the computation.
    """
    scene, digits = _checked(scene, digits, out)
    drawn = pictures and out is not None and bool(scene.pictures)
    missing = without(_uses(scene, drawn, progress))
    pictures, progress = drawn and "matplotlib" not in missing, progress and "tqdm" not in missing
    if out is None:
        with _ticks(progress, scene, digits) as tick:
            return _compute(scene, digits, tick, lines or silent)
    from integrable.scene.output import OutputFolder

    with OutputFolder(out) as folder, _ticks(progress, scene, digits) as tick:
        files = _Files(scene, digits, folder, formats if pictures else ())
        trajectory = _compute(scene, digits, tick, lines or silent, files.of_motion)
        files.all(trajectory)
        return trajectory


def _checked(given: Any, digits: Any, out: Any) -> tuple[Scene, int]:
    """The loaded scene and the digits of its run. Raises ArgumentError before anything is computed."""
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
    """The optional libraries that a run uses."""
    uses = {
        "scipy": "the rows of SciPy's DOP853" if scene.report is not None and scene.report.tolerances else "",
        "matplotlib": "the pictures" if drawn else "",
        "tqdm": "the progress bar" if progress else "",
    }
    return {module: what for module, what in uses.items() if what}


def _compute(
    scene: Scene, digits: int, tick: Tick, line: Tick = silent, own: Callable[[Any], None] = silent
) -> Trajectory:
    if scene.report is not None:
        from integrable.study.motions import measure

        report, run = measure(scene, digits, tick, line, own)
        measured: Trajectory = replaced(run, report=report)
        return measured
    if scene.steps is not None:
        from integrable.study.orbits import measure_orbit

        return measure_orbit(scene, digits, tick)
    tick(f"{digits} digits")
    system, state = scene.start(digits)
    trajectory: Trajectory = system.motion_through(state).at(scene.times.at(digits))
    return trajectory


def _ticks(progress: bool, scene: Scene, digits: int) -> AbstractContextManager[Tick]:
    """Yields a function to call with the name of each piece of work before it starts; it moves a bar, if any."""
    if not progress:
        return nullcontext(silent)
    total = 1
    if scene.report is not None:
        from integrable.study.motions import pieces_of_work

        total = pieces_of_work(scene, digits)
    elif scene.steps is not None:
        from integrable.study.orbits import pieces_of_orbit

        total = pieces_of_orbit(scene, digits)
    return bar_of_pieces(scene.name, total)


class _Files:
    """The output files of a run: ``result.json``, ``report.txt``, and the pictures in each of the formats."""

    def __init__(self, scene: Scene, digits: int, folder: OutputFolder, formats: tuple[str, ...]) -> None:
        self.scene, self.digits, self.folder, self.formats = scene, digits, folder, formats
        self.curve: Any = None

    def of_motion(self, trajectory: Any) -> None:
        """Writes the pictures that show the motion alone."""
        scene = self.scene
        shown = [picture for picture in scene.pictures if picture in OF_MOTION] if self.formats else []
        if shown:
            self.curve = trajectory
            if scene.steps is None:
                system, state = scene.start(FLOAT_DIGITS)
                self.curve = system.motion_through(state).at((scene.sphere or scene.times).floats())
        self._draw(shown, None)

    def all(self, trajectory: Any) -> None:
        """Writes all remaining files."""
        from integrable.scene.output import as_json, result

        if self.curve is None:
            self.of_motion(trajectory)
        report = trajectory.report
        self.folder.write_text("result.json", as_json(result(self.scene, self.digits, trajectory, self.curve)))
        if report is not None:
            self.folder.write_text("report.txt", report.table() + "\n")
        if self.formats:
            self._draw([picture for picture in self.scene.pictures if picture not in OF_MOTION], report)

    def _draw(self, pictures: Sequence[str], report: Any) -> None:
        if pictures:
            from integrable.study.plot import draw

            for picture in pictures:
                for suffix in self.formats:
                    content = draw(picture, suffix, self.scene, report, self.curve)
                    self.folder.write_bytes(f"{picture}.{suffix}", content)
