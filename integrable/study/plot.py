"""Pictures of a run: error against run time, γ on the sphere, coordinates against time, the distance of the divisor
from its curve against the number of additions, and the error along an orbit.

Figures are made with matplotlib's objects, without pyplot and without any global state, and returned as the bytes of a
PNG or SVG file. A method has one colour and one marker in all figures (:mod:`integrable.scene.looks`).
"""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps, rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from integrable.scene.looks import BLUE, INK, ORANGE, look
from integrable.scene.tables import DOP853, plain_power
from integrable.study.plan import FLOW, INTEGRATED
from integrable.study.truth import ADDITIONS
from jacobian.errors import ArgumentError

if TYPE_CHECKING:
    from integrable.scene.data import Scene
    from integrable.study.orbits import OrbitReport
    from integrable.study.report import Report, Row

__all__ = ["FORMATS", "coordinates", "draw", "orbit_error", "residual_growth", "sphere", "work_precision"]

FORMATS = ("png", "svg")
FAINT = "#8a8a8a"
FLOOR: dict[str, Any] = {"color": "#555555", "linewidth": 1.2, "linestyle": (0, (5, 3)), "zorder": 1}
"""The style of the line for the error of inputs rounded to doubles: no method has a line with such dashes."""

UNLIKE = (FLOW, INTEGRATED, ADDITIONS)
"""The marks of these methods, for floats and for more digits, are not joined by a line."""

STYLE = {
    "font.size": 10, "axes.edgecolor": INK, "axes.linewidth": 0.8, "text.color": INK, "svg.fonttype": "none",
    "svg.hashsalt": "integrable",  # without it the names in an SVG file change each time
}  # fmt: skip
LOWER = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
WIDTH = 7.2  # inches: the text width of a page
CROWDED = 4.0
"""Marks of equal error whose run times differ by less than this factor have their labels at two heights."""
NEAR_THE_FLOOR = 3.0
"""A mark within this many decades of the floor's line may cover the label of that line."""


def look_of(method: str) -> dict[str, Any]:
    """matplotlib's options for a method. The flow's marks are not joined, since each is for a different arithmetic."""
    colour, marker, filled = look(method)
    found: dict[str, Any] = {"color": colour, "marker": marker, "linewidth": 0 if method in UNLIKE else 1.0}
    if not filled:
        found["markerfacecolor"] = "white"
    if colour == "#F0E442":  # yellow is illegible on white
        found |= {"markeredgecolor": INK, "markeredgewidth": 0.6}
    return found


def draw(picture: str, suffix: str, scene: Scene, report: Any, curve: Any) -> bytes:
    """The named picture as the bytes of a file in the format ``suffix``.

    ``curve`` is the trajectory or orbit that the pictures of the sphere and of coordinates show.
    """
    if suffix not in FORMATS:
        raise ArgumentError(f'format: "{suffix}" given; one of {", ".join(FORMATS)} is needed')
    with rc_context(STYLE):
        if picture == "sphere":
            gamma, times = np.asarray(curve.gamma, dtype=float), np.asarray(curve.times, dtype=float)
            figure = sphere(gamma, times, scene.title, dots=curve.times.dtype.kind == "i")
        elif picture == "coordinates":
            figure = coordinates(np.asarray(curve.q, dtype=float), np.asarray(curve.times, dtype=float), scene.title)
        elif report is None:
            raise ArgumentError(f'pictures: "{picture}" given, which shows the report; there is none')
        else:
            figure = _OF_THE_REPORT[picture](report)
        return as_bytes(figure, suffix, 200)


def as_bytes(figure: Figure, suffix: str, dpi: int = 160) -> bytes:
    """The bytes of a file that shows the figure; ``suffix`` is the file's format."""
    content = io.BytesIO()
    with rc_context(STYLE):
        figure.savefig(content, format=suffix, dpi=dpi, metadata={"Date": None} if suffix == "svg" else None)
    return content.getvalue()


def new_figure(width: float, height: float) -> Figure:
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def write(axes: Any, text: str, at: Any, shift: tuple[int, int], colour: str, **more: Any) -> None:
    """Writes a text at a point of a diagram, shifted by some points of print."""
    axes.annotate(text, at, xytext=shift, textcoords="offset points", color=colour, **{"fontsize": 8.5, **more})


def work_precision(report: Report) -> Figure:
    """A diagram of run time against the error of γ or q, both logarithmic: lower left is better.

    Filled marks are whole runs; an open mark is the same run without its set-up.
    """
    figure = new_figure(WIDTH, 4.6)
    axes = figure.add_subplot()
    rows = [row for row in report.rows if row.error_gamma and row.total]
    other = [row for row in rows if row.method == DOP853]
    flow = [row for row in rows if row.method != DOP853]
    for those, side in ((other, 1), (flow, -1)):
        if those:
            _series(axes, those, side)
    first, last, count = report.times
    if report.floor and report.floor[0]:
        _mark_floor(axes, rows, report.floor[0])
    axes.set(xscale="log", yscale="log", xlabel="run time, seconds", ylabel=f"largest error of {report.letters[0]}")
    axes.margins(x=0.16, y=0.1)
    decades(axes)
    if rows:
        figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    span = f"{count} times, t = {first:g} … {plain_power(last)}; lower left is better"
    axes.set_title(f"{report.title}\n{span}", fontsize=10.5, loc="left", wrap=True)
    return figure


def _mark_floor(axes: Any, rows: list[Row], floor: float) -> None:
    axes.axhline(floor, **FLOOR)
    x, shift, side = (0, 4, "left") if _more_room_left(rows, floor) else (1, -4, "right")
    text, across = f"inputs rounded to doubles: {floor:.0e}", ("axes fraction", "data")
    write(axes, text, (x, floor), (shift, 4), FLOOR["color"], xycoords=across, ha=side, va="bottom")


def _more_room_left(rows: list[Row], floor: float) -> bool:
    times = [row.total for row in rows if row.total]
    near = [row.total for row in rows if row.total and abs(np.log10((row.error_gamma or 1) / floor)) < NEAR_THE_FLOOR]
    return bool(near) and min(near) * max(near) > min(times) * max(times)


def _series(axes: Any, rows: list[Row], side: int) -> None:
    """Draws the runs of one method, each labelled with its setting on the right or on the left.

    Runs of an integrator are joined by a line in the order of their settings. Runs of the flow are not joined: floats,
    compiled floats and numbers of more digits are not values of one parameter.
    """
    rows = sorted(rows, key=lambda row: -(row.error_gamma or 0))
    look = look_of(rows[0].method)
    times, errors = [row.total for row in rows], [row.error_gamma for row in rows]
    line = {"linewidth": 1.4 if side > 0 else 0}
    axes.plot(times, errors, **(look | line), markersize=6, label=rows[0].method, zorder=3)
    inner = [row for row in rows if row.evaluation is not None]
    if inner:
        for row in inner:
            axes.plot([row.evaluation, row.total], [row.error_gamma] * 2, color=look["color"], linewidth=0.8, zorder=2)
        axes.plot(
            [row.evaluation for row in inner],
            [row.error_gamma for row in inner],
            **(look | {"linewidth": 0, "markerfacecolor": "white", "markeredgecolor": look["color"]}),
            markersize=6,
            label="the same without its set-up",
            zorder=2.5,
        )
    for k, row in enumerate(rows):
        before = rows[k - 1].total if k else None
        crowded = before is not None and row.total is not None and max(before / row.total, row.total / before) < CROWDED
        _label(axes, row, side, look["color"], lower=crowded and row.digits == rows[k - 1].digits)


def _label(axes: Any, row: Row, side: int, colour: str, lower: bool) -> None:
    """Writes the setting of a row as a label: above an integrator's mark, whose line falls to the right, or below the
    flow's.
    """
    # a white background keeps the label legible where a line of the diagram crosses the text
    behind = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 0.6}
    shift, ha, va = ((5, 3), "left", "bottom") if side > 0 else ((0, -19 if lower else -7), "center", "top")
    write(axes, row.setting, (row.total, row.error_gamma), shift, colour, ha=ha, va=va, bbox=behind)


def decades(axes: Any, most: int = 8) -> None:
    """Puts ticks at decades, thinned to fit, and a faint grid; the vertical axis has at most ``most`` ticks."""
    for axis, (low, high), fit in ((axes.xaxis, axes.get_xlim(), 8), (axes.yaxis, axes.get_ylim(), most)):
        decades = np.log10(high / low)
        stride = next(stride for stride in (1, 2, 5, 10, 20, 50, 100, 1000) if decades / stride <= fit)
        axis.set_major_locator(LogLocator(base=10.0**stride, numticks=20))
        # over more than four decades minor ticks blur, and take half the time of drawing
        axis.set_minor_locator(LogLocator(base=10.0, subs=range(2, 10) if decades <= 4 else (1.0,), numticks=200))
        within = np.floor(np.log10(high)) < np.ceil(np.log10(low))
        axis.set_minor_formatter(FuncFormatter(lambda x, _: f"{x:g}") if within else NullFormatter())
    faint_grid(axes)


def faint_grid(axes: Any) -> None:
    axes.grid(True, which="major", color="#e3e3e3", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def sphere(gamma: np.ndarray, times: np.ndarray, title: str, dots: bool = False) -> Figure:
    """γ on the unit sphere, shape (N, 3): orthographic views along one axis, of the front half and of the back half.

    The views are along the axis that γ comes closest to, so that the curve does not crowd at the rim. ``dots`` is for
    an orbit, whose ``times`` are step numbers: its points are not joined.
    """
    figure = new_figure(WIDTH, 3.9)
    left, right = figure.subplots(1, 2)
    depth = int(np.argmax((gamma**2).mean(axis=0)))
    across, up = (depth + 1) % 3, (depth + 2) % 3
    segments = np.stack([gamma[:-1], gamma[1:]], axis=1)
    middle = segments[:, :, depth].mean(axis=1)
    for axes, sign in ((left, 1.0), (right, -1.0)):
        mirror = np.array([sign, 1.0])  # the back half is seen from behind
        seen = middle * sign >= 0
        _globe(axes, sign, depth)
        if dots:
            seen = gamma[:, depth] * sign >= 0
            points = gamma[seen][:, [across, up]] * mirror
            colours = {"c": times[seen], "cmap": "cividis", "vmin": float(times.min()), "vmax": float(times.max())}
            image = axes.scatter(points[:, 0], points[:, 1], s=9, linewidths=0, zorder=3, **colours)
        else:
            image = LineCollection(
                segments[seen][:, :, [across, up]] * mirror, cmap="cividis", linewidths=0.9, capstyle="round", zorder=3
            )
            image.set_array(times[:-1][seen])
            image.set_clim(float(times.min()), float(times.max()))
            axes.add_collection(image)
        if gamma[0, depth] * sign >= 0:
            _mark_start(axes, gamma[0, [across, up]] * mirror)
    figure.suptitle(f"γ on the sphere: {title}", fontsize=10.5)
    figure.colorbar(image, ax=[left, right], shrink=0.72, aspect=24, pad=0.02).ax.set_title(
        "step" if dots else "t", fontsize=10
    )
    return figure


def coordinates(q: np.ndarray, times: np.ndarray, title: str) -> Figure:
    """Every q_i against time, ``q`` of shape (N, n)."""
    figure = new_figure(WIDTH, 3.6)
    axes = figure.add_subplot()
    for i, row in enumerate(q.T):
        shade = 0.85 * i / max(1, len(q.T) - 1)
        axes.plot(times, row, color=colormaps["cividis"](shade), linewidth=1.1, label=f"q{i + 1}".translate(LOWER))
    axes.set(xlabel="t", ylabel="q", xlim=(float(times[0]), float(times[-1])))
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside right upper", frameon=False, fontsize=9)
    axes.set_title(title, fontsize=10.5, loc="left", wrap=True)
    return figure


def _mark_start(axes: Any, start: np.ndarray) -> None:
    axes.plot(*start, marker="o", color=ORANGE, markersize=7, markeredgecolor="white", zorder=4)
    behind = {"facecolor": "white", "lw": 0, "pad": 0.8, "alpha": 0.8}
    write(axes, "start", start, (7, 6), ORANGE, fontsize=9.5, zorder=5, bbox=behind)


def _globe(axes: Any, sign: float, depth: int) -> None:
    """Draws a disc with faint parallels and meridians about the line of sight, and the ends of the other two axes."""
    angle = np.linspace(0, 2 * np.pi, 361)
    for latitude in (30, 60):
        radius = np.cos(np.radians(latitude))
        axes.plot(radius * np.cos(angle), radius * np.sin(angle), color="#dddddd", linewidth=0.6, zorder=1)
    for longitude in np.radians(np.arange(0, 360, 30)):
        # meridians start at the last parallel, so that only the curve is visible at the pole
        ends = np.cos(np.radians(60)) * np.exp(1j * longitude), np.exp(1j * longitude)
        axes.plot([end.real for end in ends], [end.imag for end in ends], color="#dddddd", linewidth=0.6, zorder=1)
    axes.plot(np.cos(angle), np.sin(angle), color=INK, linewidth=1, zorder=2)
    along, across, up = ("γ₁γ₂γ₃"[2 * k : 2 * k + 2] for k in (depth, (depth + 1) % 3, (depth + 2) % 3))
    axes.annotate(across if sign > 0 else f"−{across}", (1.03, 0), va="center", ha="left", fontsize=9)
    axes.annotate(up, (0, 1.03), va="bottom", ha="center", fontsize=9)
    name = f"front: {along} ≥ 0" if sign > 0 else f"back: {along} ≤ 0, seen from behind"
    axes.annotate(name, (0, -1.05), va="top", ha="center", fontsize=9)
    axes.set(xlim=(-1.16, 1.16), ylim=(-1.2, 1.14), aspect="equal")
    axes.set_axis_off()


def residual_growth(report: Report) -> Figure:
    """A diagram of the distance of a divisor from its curve, due to rounding, against the number of additions.

    The distance is relative to the size of the polynomials' coefficients, so one rounding is about 10⁻¹⁶.
    """
    figure = new_figure(5.4, 3.6)
    axes = figure.add_subplot()
    steps = np.array([pair[0] for pair in report.residual_growth], dtype=float)
    residual = np.array([pair[1] for pair in report.residual_growth], dtype=float)
    shown = residual > 0
    axes.plot(steps[shown], residual[shown], color=BLUE, marker="o", markersize=5, linewidth=1.4, zorder=3)
    axes.set(xscale="log", yscale="log", xlabel="additions, one after the other")
    axes.set_ylabel("|V² − f mod U| over the size of\nits coefficients: 0 on the curve")
    if shown.any():
        eps, low, high = float(np.finfo(float).eps), residual[shown].min(), residual[shown].max()
        axes.axhline(eps, **FLOOR)
        write(axes, "rounding of one double", (steps[shown][-1], eps), (0, 4), INK, ha="right")
        # growth like √n is expected if the roundings of additions have random signs, like n if all have the same sign
        span = steps[shown] / steps[shown][0]
        for power, name in ((0.5, "∝ √n"), (1.0, "∝ n")):
            line = eps * span**power
            axes.plot(steps[shown], line, color=FAINT, linewidth=0.9, linestyle=(0, (1, 2)), zorder=1)
            write(axes, name, (steps[shown][-1], line[-1]), (4, -2), INK)
        axes.set_ylim(min(low, eps) / 30, max(high, eps * span[-1]) * 10)
    axes.margins(x=0.1)
    decades(axes)
    axes.set_title("Does the point leave the curve? Floats", fontsize=10.5, loc="left")
    return figure


def orbit_error(report: OrbitReport) -> Figure:
    """A diagram of the largest error of γ up to each step of an orbit, with one line per number of digits.

    Both axes are logarithmic.
    """
    figure = new_figure(WIDTH, 3.8)
    axes = figure.add_subplot()
    colours, markers = (BLUE, ORANGE, "#009E73", "#CC79A7", INK), "osD^v"
    for k, row in enumerate(report.rows):
        steps = np.array([n for n, _ in row.growth], dtype=float)
        # the drawn value is the largest so far, so that an error that is small by chance does not look like a recovery
        error = np.maximum.accumulate(np.array([e for _, e in row.growth]))
        shown = (steps > 0) & (error > 0)
        if shown.any():
            colour = colours[k % len(colours)]
            axes.plot(steps[shown], error[shown], color=colour, linewidth=1.4)
            # different marks at the ends distinguish the lines for readers who do not see the colours
            axes.plot(steps[shown][-1], error[shown][-1], color=colour, marker=markers[k % len(markers)], markersize=5)
            write(axes, row.setting, (steps[shown][-1], error[shown][-1]), (7, 0), colour, va="center")
    axes.set(xscale="log", yscale="log", xlabel="steps", ylabel="largest error of γ so far")
    axes.margins(x=0.12, y=0.1)
    decades(axes)
    axes.set_title(f"{report.title}\n{report.count} steps of {report.map}", fontsize=10.5, loc="left", wrap=True)
    return figure


_OF_THE_REPORT: dict[str, Callable[[Any], Figure]] = {
    "work_precision": work_precision,
    "residual_growth": residual_growth,
    "orbit_error": orbit_error,
}
