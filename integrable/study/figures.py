"""Figures of a study: error against run time for each scene, and the flow's error against the floor for all."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap
from typing import Any

from matplotlib import rc_context
from matplotlib.lines import Line2D

from integrable.scene.looks import BLUE, INK, ORANGE
from integrable.scene.tables import plain_power
from integrable.study.findings import SCENE_FLOOR_FACTOR, SceneFindings
from integrable.study.plan import FLOW, INTEGRATED
from integrable.study.plot import FAINT, FLOOR, STYLE, WIDTH, as_bytes, decades, faint_grid, look_of, new_figure

__all__ = ["as_bytes", "drawings", "error_against_run_time", "floors"]

OWN = (FLOW, INTEGRATED)
DEEP = 1e-17
"""Errors below this come from computations in more than double precision."""
TITLE = 48
"""Characters in a line of a title: more would reach the legend beside the axes."""
RING = 1.5
"""The mark of compiled floats, a ring, is larger than a dot by this factor, so both are visible at one place."""


def drawings(findings: Sequence[SceneFindings]) -> dict[str, Any]:
    """The figures of a study by name: one for each scene, and "floors" for all. Those that are empty are left out."""
    drawn = {f.scene.name: error_against_run_time(f) for f in findings} | {"floors": floors(findings)}
    return {name: drawing for name, drawing in drawn.items() if drawing is not None}


def error_against_run_time(found: SceneFindings) -> Any:
    """A figure of the largest error of γ (or q) against the run time, one line per method; None if empty.

    Errors below 10⁻¹⁷, which are those of multiprecision rows, are in a separate panel below.
    """
    rows = [c for c in (*found.comparators, *found.backlund, *found.flow) if c["result"]["error_gamma"] > 0]
    if not rows:
        return None
    deep = [c for c in rows if c["result"]["error_gamma"] < DEEP]
    with rc_context(STYLE):
        figure = new_figure(WIDTH, 4.9 if deep else 4.3)
        panels = [(c for c in rows if c not in deep), deep] if deep else [rows]
        grid = {"height_ratios": [3.4, 1], "hspace": 0.06} if deep else {}
        every = figure.subplots(len(panels), 1, sharex=True, squeeze=False, gridspec_kw=grid)[:, 0]
        methods = list(dict.fromkeys(c["row"]["method"] for c in rows[::-1]))
        for axes, panel in zip(every, map(list, panels), strict=True):
            axes.set(xscale="log", yscale="log")
            for method in methods:
                _series(axes, method, [c for c in panel if c["row"]["method"] == method])
            axes.margins(x=0.11, y=0.09 if panel is not deep else 0.25)
        top, bottom = every[0], every[-1]
        handles = _handles(methods, rows, found)
        if found.floor is not None:
            handles.append(_mark_floor(top, found.floor["floor_gamma"]))
        _at_least_two_decades(bottom)
        if deep:
            top.spines["bottom"].set_linestyle((0, (1, 3)))
            bottom.set_ylabel("more digits")
            errors = [c["result"]["error_gamma"] for c in deep]
            bottom.set_ylim(min(errors) / 1e3, max(errors) * 1e3)
            decades(bottom, most=5)
        decades(top)
        bottom.set_xlabel("run time of a start, seconds")
        top.set_ylabel(f"largest error of {found.scene.letters[0]} over the run")
        figure.legend(handles=handles, loc="outside right upper", frameon=False, fontsize=8)
        title = "\n".join(wrap(found.scene.title, TITLE))
        top.set_title(f"{title}\n{_span(found)}; lower left is better", fontsize=10, loc="left")
    return figure


def _handles(methods: Sequence[str], rows: Sequence[dict[str, Any]], found: SceneFindings) -> list[Line2D]:
    """The entries of the legend: the runs of the flow by their arithmetic, the other methods, and the methods without a
    result. † marks a method without a result at some setting.
    """
    lost = {c["row"]["method"] for c in found.failures if c["row"]["kind"] == "comparator"}
    handles = []
    for method in methods:
        settings = [c["row"]["setting"] for c in rows if c["row"]["method"] == method] if method in OWN else [""]
        for setting in settings:
            name = ", ".join(filter(None, (method, setting))) + (" †" if method in lost else "")
            handles.append(Line2D([], [], label=name, **_look(method, setting, 6.0)))
    if lost & set(methods):
        handles.append(Line2D([], [], linestyle="none", label="† at some settings too slow,\nor it gave up"))
    if silent := sorted(lost - set(methods)):
        names = "\n".join(silent)
        handles.append(Line2D([], [], linestyle="none", label=f"no result at any setting:\n{names}"))
    return handles


def _mark_floor(axes: Any, floor: float) -> Line2D:
    axes.axhline(floor, **FLOOR)
    return Line2D([], [], **FLOOR, label=f"what rounding the\ninputs does, {floor:.0e}")


def _at_least_two_decades(axes: Any) -> None:
    """Widens the axis of run times, if need be, to two decades, so that it has two labels."""
    low, high = axes.get_xlim()
    short = max(1.0, 10 / (high / low) ** 0.5)
    axes.set_xlim(low / short, high * short)


def _series(axes: Any, method: str, rows: list[dict[str, Any]]) -> None:
    """Draws the runs of a method as a line. Runs of the flow are separate marks, each for a different arithmetic."""
    parts = [[c] for c in rows] if method in OWN else [rows] if rows else []
    for part in parts:
        setting = part[0]["row"]["setting"] if method in OWN else ""
        points = [(c["result"]["total"], c["result"]["error_gamma"]) for c in part]
        look = _look(method, setting, 7.0 if method in OWN else 5.5)
        axes.plot(*zip(*points, strict=True), **look, zorder=4 if method in OWN else 3)


def _look(method: str, setting: str, size: float) -> dict[str, Any]:
    """Colour, shape and size of a method's marks; for the flow they show its arithmetic, so points need no labels."""
    ring = {"markerfacecolor": "none", "markersize": RING * size}
    face = {"compiled": ring, "floats": {}, "": {}}.get(setting, {"fillstyle": "bottom"})
    return {**look_of(method), "markersize": size, **(face if method in OWN else {})}


def _span(found: SceneFindings) -> str:
    times = found.scene.times.floats()
    last = f"t = {plain_power(max(times))}"
    return f"{len(times)} times" if last in found.scene.title else f"{len(times)} times to {last}"


def floors(findings: Sequence[SceneFindings]) -> Any:
    """A figure of the flow's error in floats divided by the floor, for γ and M, or q and p; None if empty."""
    shown = [(f, f.best, f.floor) for f in findings if f.best and f.floor and f.moved_by_divisors]
    if not shown:
        return None
    with rc_context(STYLE):
        figure = new_figure(WIDTH, 1.3 + 0.24 * len(shown))
        axes = figure.add_subplot()
        for k, (_, best, floor) in enumerate(shown):
            for part, colour, marker, shift in (("gamma", BLUE, "o", 0.14), ("M", ORANGE, "s", -0.14)):
                factor = best[f"error_{part}"] / floor[f"floor_{part}"]
                axes.plot(factor, shift - k, color=colour, marker=marker, markersize=5, linestyle="none", zorder=3)
        for x, colour, dashes, label, side in (
            (SCENE_FLOOR_FACTOR, INK, (0, (5, 3)), f"{SCENE_FLOOR_FACTOR:g} floors", "left"),
            (1, FAINT, "-", "floor", "right"),
        ):
            axes.axvline(x, color=colour, linewidth=1.2, linestyle=dashes, zorder=2)
            place: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "ha": side, "va": "bottom"}
            axes.text(x, 1.01, label, fontsize=8.5, color=INK, **place)
        axes.set(xscale="log", xlabel="largest error of the flow in floats / floor; left is better")
        axes.set_yticks(range(0, -len(shown), -1), [f.scene.name for f, _, _ in shown], fontsize=8.5)
        faint_grid(axes)
        handles = [
            Line2D([], [], color=colour, marker=marker, linestyle="none", label=label)
            for label, colour, marker in (("γ or q", BLUE, "o"), ("M or p", ORANGE, "s"))
        ]
        figure.legend(handles=handles, loc="outside right upper", frameon=False, fontsize=8.5)
    return figure
