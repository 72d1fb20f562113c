"""A run as a moving picture: the turning body, the vertical in its axes, and the path of its point of contact."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np

from integrable.extras import needed
from integrable.files.whole import target_of, whole_file
from jacobian.element import File
from jacobian.errors import ArgumentError, shown, whole

SUFFIXES = (".gif", ".mp4")
# the camera's horizontal, vertical and depth directions in the laboratory: from the south, 25 degrees above the plane
UP = np.radians(25)
VIEW = np.array([[1, 0, 0], [0, np.sin(UP), np.cos(UP)], [0, -np.cos(UP), np.sin(UP)]])
COLORS = ("#1b6ca8", "#b03a2e", "#1e8449")
POINTS = 121


def animate(run: Any, path: File, fps: int) -> None:
    """Does the work of :meth:`integrable.laboratory.motion.LaboratoryRun.animate`."""
    needed("matplotlib", "animate")
    from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    fps = whole(fps, "fps", "frames a second, an int from 1 to 120", 1, 120)
    wanted = f"the path of a {' or '.join(SUFFIXES)} file"
    target = target_of(path, wanted)
    if target.suffix not in SUFFIXES:
        raise ArgumentError(f"path = {shown(str(target))}: the name ends in {' or '.join(SUFFIXES)}")
    if target.suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise ArgumentError(f"path = {shown(str(target))}: .mp4 needs ffmpeg, which is not there; .gif does without")
    if len(run) < 2:
        raise ArgumentError(f"a run of {len(run)} times has nothing that moves: give two times or more")
    rolls = run.motion._contact is not None
    panels = [_body, _vertical, *([_path] if rolls else [])]
    figure = Figure(figsize=(4.0 * len(panels), 4.0), layout="constrained")
    FigureCanvasAgg(figure)
    updates = [panel(ax, run) for panel, ax in zip(panels, figure.subplots(1, len(panels)), strict=True)]

    def update(frame: int) -> list[Any]:
        return [artist for each in updates for artist in each(frame)]

    # the layout is computed once, because it takes longer than the drawing of a frame
    update(0)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    moving = FuncAnimation(figure, update, frames=len(run), init_func=list, blit=False)
    with whole_file(target, wanted) as unfinished, _of_ffmpeg(target):
        moving.save(unfinished, writer=PillowWriter(fps) if target.suffix == ".gif" else FFMpegWriter(fps))


@contextmanager
def _of_ffmpeg(target: Path) -> Iterator[None]:
    """Turns a failure of ffmpeg in the block into an error with ffmpeg's last message as one line."""
    try:
        yield
    except CalledProcessError as error:
        said = [line.strip() for line in str(error.stderr or "").splitlines() if line.strip()]
        why = said[-1] if said else f"exit code {error.returncode}"
        raise ArgumentError(f"path = {shown(str(target))}: ffmpeg has failed ({why}); .gif does without") from error


def _body(ax: Any, run: Any) -> Any:
    """Draws ω, and the front halves of three great circles that turn with the body, one in each of its coordinate
    planes. Returns a function that updates the drawing.
    """
    angles = np.linspace(0, 2 * np.pi, POINTS)
    c, s, zero = np.cos(angles), np.sin(angles), 0 * angles
    circles = np.array([[zero, c, s], [c, zero, s], [c, s, zero]])
    _sphere(ax)
    lines = [ax.plot([], [], color=color, linewidth=2)[0] for color in COLORS]
    (spin,) = ax.plot([], [], "k-", linewidth=1.5)
    title = ax.set_title("")
    matrices, omega, times = (np.asarray(x).astype(float) for x in (run.matrices, run.omega, run.times))
    fastest = np.linalg.norm(omega, axis=1).max() or 1.0

    def update(frame: int) -> list[Any]:
        for line, circle in zip(lines, circles, strict=True):
            x, y, depth = VIEW @ matrices[frame] @ circle
            near = depth >= 0
            line.set_data(np.where(near, x, np.nan), np.where(near, y, np.nan))
        x, y, _ = VIEW @ omega[frame] / fastest
        spin.set_data([0, 1.1 * x], [0, 1.1 * y])
        title.set_text(f"t = {times[frame]:.2f} s")
        return [*lines, spin, title]

    return update


def _sphere(ax: Any) -> None:
    angles = np.linspace(0, 2 * np.pi, POINTS)
    ax.set(xlim=(-1.15, 1.15), ylim=(-1.15, 1.15), aspect="equal")
    ax.set_axis_off()
    ax.plot(np.cos(angles), np.sin(angles), color="0.5", linewidth=1)


def _vertical(ax: Any, run: Any) -> Any:
    """Draws γ and its path in the axes of the tensor, with the front half in bold. Returns a function that updates the
    drawing.
    """
    _sphere(ax)
    for axis, color in zip(VIEW.T, COLORS, strict=True):
        ax.plot([0, axis[0]], [0, axis[1]], color=color, linewidth=1)
    x, y, depth = VIEW @ np.asarray(run.matrices)[:, 2].astype(float).T
    (far,) = ax.plot([], [], color="0.75", linewidth=0.8)
    (near,) = ax.plot([], [], "k-", linewidth=1.2)
    (point,) = ax.plot([], [], "o", color=COLORS[1])
    ax.set_title("γ")

    def update(frame: int) -> list[Any]:
        gone = slice(frame + 1)
        far.set_data(x[gone], y[gone])
        near.set_data(np.where(depth[gone] >= 0, x[gone], np.nan), y[gone])
        point.set_data(x[frame : frame + 1], y[frame : frame + 1])
        return [far, near, point]

    return update


def _path(ax: Any, run: Any) -> Any:
    path = np.asarray(run.contact).astype(float)
    ax.plot(*path.T, color="0.8", linewidth=0.8)
    (line,) = ax.plot([], [], color=COLORS[0], linewidth=1.2)
    (point,) = ax.plot([], [], "o", color=COLORS[1])
    ax.set(xlabel="x, m", ylabel="y, m", aspect="equal", adjustable="datalim")

    def update(frame: int) -> list[Any]:
        line.set_data(*path[: frame + 1].T)
        point.set_data(path[frame : frame + 1, 0], path[frame : frame + 1, 1])
        return [line, point]

    return update
