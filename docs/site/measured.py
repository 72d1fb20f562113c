"""The pages of error against run time: one screen, a page a scene, tables that can be sorted; from the report's page."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any, NamedTuple

INTRO = """\
# Error against run time

How near the truth does a method get, in how much time? Every scene was run by every method at several settings; the truth is
the same motion at 40 digits or more, held against an integrator that shares no code with the flow. Less of both is better.

![For each scene, how many times longer than the divisor flow the fastest other method takes that is as accurate](one_screen.svg)

*How to read it.* A row is a scene, the longest motions at the top. A filled mark says how many times the run time of the divisor flow
the fastest other method takes among those that are **at least as accurate as the flow**; an arrow: none that was tried is, at any
setting. An open mark asks for less: an error below what **rounding the inputs to doubles** does anyway, so that nobody who
knows the body to sixteen digits sees a difference. Right of the line (blue) the flow is ahead, left of it (orange) the other. Run times include
set-up.
"""


class Best(NamedTuple):
    """Of a scene: the flow's fastest row, the fastest other row that is as accurate and the fastest that
    reaches the floor; each (method, seconds, error)."""

    title: str
    flow: tuple[str, float, float] | None
    peer: tuple[str, float, float] | None
    to_the_floor: tuple[str, float, float] | None


def write(source: Path, text: str) -> dict[str, Best]:
    """Write the pages from the report's page ``text`` into ``source``/measured; what was measured of each scene."""
    folder = source / "measured"
    folder.mkdir()
    sections = re.split(r"^## ", text, flags=re.M)
    head, general, scenes = sections[0], {}, {}
    for section in sections[1:]:
        title, _, body = section.partition("\n")
        name = title.partition(":")[0]
        if re.fullmatch(r"\w+", name) and ": " in title:
            scenes[name] = (title.partition(": ")[2], body)
        else:
            general[title] = body
    floors = {row["scene"]: row["floor γ"] for row in _rows(general["The flow's error and the floor"])}
    results = {name: _best(title, body, floors.get(name, "–")) for name, (title, body) in scenes.items()}
    (folder / "one_screen.svg").write_bytes(_one_screen(results))
    lost = next(title for title in general if "not ahead" in title)
    pages = {"claims": ("Claims", general.pop("Claims"))}
    pages["rows"] = (lost, general.pop(lost))
    pages["details"] = ("Details", "".join(f"\n## {title}\n{body}" for title, body in general.items()))
    for name, (title, body) in pages.items():
        _page(folder / f"{name}.md", title, body)
    for name, (title, body) in scenes.items():
        _page(folder / f"{name}.md", title, body, name)
    _index(folder, head, text, pages["claims"][1], scenes)
    return results


def _index(folder: Path, head: str, text: str, claims: str, scenes: dict[str, tuple[str, str]]) -> None:
    about = "\n".join(head.splitlines()[2:])
    names = "\n".join(scenes)
    table = "\n".join(f"| [{name}]({name}.md) | {title} |" for name, (title, _) in scenes.items())
    (folder / "index.md").write_text(
        f"{INTRO}\n## Claims\n\n{_sortable(claims)}\n"
        "[All rows where the flow is not ahead](rows.md), in a table that can be sorted. [Details](details.md): long runs, floors, "
        f"first use, orders, additions, rows without a figure.\n\n## A page a scene\n\n| scene | |\n|---|---|\n{table}\n\n"
        f"## How it was measured\n{about}\n\n"
        f"```{{toctree}}\n:hidden:\n\nclaims\nrows\ndetails\n{names}\n```\n",
        encoding="utf-8",
    )


def _page(path: Path, title: str, body: str, name: str = "") -> None:
    also = f"\n[The scene in the gallery](../gallery/{name}.md)\n" if name else ""
    text = f"# {title}\n{also}{_sortable(body)}".replace("](figures/", "](../figures/").replace("](docs/", "](../")
    path.write_text(re.sub(r"\(docs/(\w+\.md)\)", r"([\1](../\1))", text), encoding="utf-8")


def _sortable(body: str) -> str:
    """Tables inside an element that site/sort.js looks for."""
    return re.sub(r"((?:^\|.*\n)+)", r"::::{div} sortable\n\1::::\n", body + "\n", flags=re.M)


def _rows(body: str) -> list[dict[str, str]]:
    lines = [line for line in body.splitlines() if line.startswith("|")]
    if len(lines) < 3:
        return []
    cells = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]
    return [dict(zip(cells[0], row, strict=True)) for row in cells[2:] if len(row) == len(cells[0])]


def seconds(text: str) -> float:
    value, unit = text.split()
    return float(value) * {"s": 1.0, "ms": 1e-3, "µs": 1e-6, "ns": 1e-9}[unit]


def _best(title: str, body: str, floor: str) -> Best:
    rows = [row for row in _rows(body) if "run time" in row and row["error γ"] not in ("–", "")]
    entries = [(f"{row['method']}, {row['setting']}", seconds(row["run time"]), float(row["error γ"])) for row in rows]
    own = ("divisor flow", "integrated")
    flow = [e for e in entries if e[0].startswith(own) and not re.search(r"\d+ digits$", e[0])]
    peers = [e for e in entries if not e[0].startswith((*own, "Bäcklund"))]
    if not flow:
        return Best(title, None, None, None)
    best = min(flow, key=lambda e: e[1])
    bound = best[2] if floor == "–" else max(best[2], float(floor))
    as_good, enough = ([e for e in peers if e[2] <= most] for most in (best[2], bound))
    fastest = [min(those, key=lambda e: e[1]) if those else None for those in (as_good, enough)]
    return Best(title, best, *fastest)


def _marks(axes: Any, k: int, best: Best, far: float) -> None:
    assert best.flow
    if best.peer is None:
        axes.annotate("", (far, k), (far / 4, k), arrowprops={"arrowstyle": "-|>", "color": "#0072B2", "lw": 1.6})
    for entry, filled in ((best.peer, True), (best.to_the_floor, False)):
        if entry is None or (not filled and entry == best.peer):
            continue
        ratio = entry[1] / best.flow[1]
        colour, marker = ("#0072B2", "o") if ratio > 1 else ("#D55E00", "s")
        axes.plot([1, ratio], [k, k], color=colour, linewidth=1 if filled else 0.5, zorder=2)
        axes.plot(
            ratio, k, color=colour, marker=marker, markersize=6, markerfacecolor=colour if filled else "white", zorder=3
        )
        x, side = (7, "left") if ratio > 1 else (-7, "right")
        words = {"xytext": (x, 0), "textcoords": "offset points", "ha": side, "va": "center", "fontsize": 7.5}
        axes.annotate(entry[0].rpartition(",")[0], (ratio, k), **words)


def _one_screen(results: dict[str, Best]) -> bytes:
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    from integrable.scene.file import load_scene
    from integrable.study.plot import INK, STYLE, plain_power

    shown = [(name, best) for name, best in results.items() if best.flow]
    length = {name: max(load_scene(name).times.floats()) for name, _ in shown}
    shown.sort(key=lambda entry: (length[entry[0]], entry[0]))
    ratios = [e[1] / b.flow[1] for _, b in shown for e in (b.peer, b.to_the_floor) if b.flow and e]
    far = max(ratios) * 25
    with rc_context(STYLE):
        figure = Figure(figsize=(7.6, 1.1 + 0.23 * len(shown)), layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.add_subplot()
        for k, (_, best) in enumerate(shown):
            _marks(axes, k, best, far)
        axes.axvline(1, color=INK, linewidth=1)
        axes.set(xscale="log", xlabel="run time of the fastest other method ÷ run time of the flow")
        axes.set_xlim(min(ratios) / 80, far * 1.6)
        axes.set_yticks(
            range(len(shown)), [f"{name}, T = {plain_power(length[name])}" for name, _ in shown], fontsize=8
        )
        axes.set_ylim(-0.7, len(shown) - 0.3)
        axes.grid(True, axis="x", color="#e3e3e3", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
        content = io.BytesIO()
        figure.savefig(content, format="svg", metadata={"Date": None})
    return content.getvalue()
