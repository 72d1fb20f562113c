"""Figures of a study: error against run time for each scene, and the flow's error against the floor for all."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

from matplotlib import rc_context
from matplotlib.lines import Line2D

from integrable.scene.tables import plain_power
from integrable.study.findings import SCENE_FLOOR_FACTOR, SceneFindings
from integrable.study.plan import FLOW, INTEGRATED
from integrable.study.plot import (
    BLUE,
    FAINT,
    FLOOR,
    INK,
    ORANGE,
    STYLE,
    WIDTH,
    decades,
    look_of,
    new_figure,
)

__all__ = ["as_bytes", "error_against_run_time", "floors"]

DEEP = 1e-17
"""Errors below this are those of more than double precision."""


def as_bytes(figure: Any, suffix: str) -> bytes:
    """The figure as a file of that format."""
    content = io.BytesIO()
    with rc_context(STYLE):
        figure.savefig(content, format=suffix, dpi=160, metadata={"Date": None} if suffix == "svg" else None)
    return content.getvalue()


def error_against_run_time(found: SceneFindings) -> Any:
    """Largest error of γ (or q) against run time with set-up, a line for every method; None without points.

    Errors beyond doubles, of multiprecision rows, are in a panel of their own below.
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
        handles = [_handle(method) for method in methods]
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
        _named(top, [c for c in found.flow if c in rows and c not in deep])
        _named(bottom, [c for c in found.flow if c in deep])
        bottom.set_xlabel("run time with set-up, seconds")
        top.set_ylabel(f"largest error of {found.scene.letters[0]} over the run")
        figure.legend(handles=handles, loc="outside right upper", frameon=False, fontsize=8)
        top.set_title(f"{found.scene.title}\n{_span(found)}; lower left is better", fontsize=10, loc="left")
    return figure


def _mark_floor(axes: Any, floor: float) -> Line2D:
    """A line at the floor, and its handle for the legend."""
    axes.axhline(floor, **FLOOR)
    return Line2D([], [], **FLOOR, label=f"what rounding the\ninputs does, {floor:.0e}")


def _at_least_two_decades(axes: Any) -> None:
    """Widen the axis of run times to 100 : 1, so that it has two labels."""
    low, high = axes.get_xlim()
    short = max(1.0, 10 / (high / low) ** 0.5)
    axes.set_xlim(low / short, high * short)


def _series(axes: Any, method: str, rows: list[dict[str, Any]]) -> None:
    if not rows:
        return
    own = method in (FLOW, INTEGRATED)
    points = [(c["result"]["total"], c["result"]["error_gamma"]) for c in rows]
    axes.plot(*zip(*points, strict=True), **look_of(method), markersize=7.5 if own else 5.5, zorder=4 if own else 3)


def _named(axes: Any, rows: list[dict[str, Any]]) -> None:
    """The settings of the flow's rows beside their points: below, the fastest to its left; above at the right edge."""
    low, high = axes.get_xlim()
    for k, content in enumerate(sorted(rows, key=lambda content: float(content["result"]["total"]))):
        point = content["result"]["total"], content["result"]["error_gamma"]
        first, at_edge = k == 0 and len(rows) > 1, point[0] > (low * high**4) ** 0.2
        x, y, side, height = (-5, -4, "right", "top") if first else (5, -4, "left", "top")
        if at_edge and not first:
            x, y, side, height = 0, 5, "center", "bottom"
        place: dict[str, Any] = {"xytext": (x, y), "textcoords": "offset points", "ha": side, "va": height}
        back = {"facecolor": "white", "linewidth": 0, "pad": 0.4, "alpha": 0.6}
        axes.annotate(content["row"]["setting"], point, **place, fontsize=8, color=BLUE, bbox=back, zorder=2.5)


def _handle(method: str) -> Line2D:
    return Line2D([], [], markersize=6, label=method, **look_of(method))


def _span(found: SceneFindings) -> str:
    times = found.scene.times.floats()
    last = f"t = {plain_power(max(times))}"
    return f"{len(times)} times" if last in found.scene.title else f"{len(times)} times to {last}"


def floors(findings: Sequence[SceneFindings]) -> Any:
    """The flow's error in floats over the floor, γ and M, for every scene; None where no scene has both."""
    shown = [
        (f, f.best, f.floor) for f in findings if f.best is not None and f.floor is not None and f.moved_by_divisors
    ]
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
            axes.text(x, 1.01, label, fontsize=8.5, color=colour, **place)
        axes.set(xscale="log", xlabel="largest error of the flow in floats / floor;  left is better")
        axes.set_yticks(range(0, -len(shown), -1), [f.scene.name for f, _, _ in shown], fontsize=8.5)
        axes.grid(True, which="major", color="#e3e3e3", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
        handles = [
            Line2D([], [], color=colour, marker=marker, linestyle="none", label=label)
            for label, colour, marker in (("γ", BLUE, "o"), ("M", ORANGE, "s"))
        ]
        figure.legend(handles=handles, loc="outside right upper", frameon=False, fontsize=8.5)
    return figure
