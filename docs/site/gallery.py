"""The gallery: a page for every scene that ships, with its picture, its command and the page that moves."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

FRAMES = 400
FIGURES = Path(__file__).parents[1] / "figures" / "report"


def write(source: Path, results: dict[str, Any]) -> None:
    """Write the pages into ``source``/gallery, the moving pages and plotly.js into ``source``/_static."""
    from integrable.scene.file import load_scene, scene_names
    from integrable.view.page import page, plotly_script
    from integrable.view.shown import shown

    folder, moving = source / "gallery", source / "_static" / "view"
    folder.mkdir()
    moving.mkdir()
    (moving / "plotly.js").write_text(plotly_script(), encoding="utf-8")
    cards = []
    for name in scene_names():
        scene = load_scene(name)
        content = None
        if scene.classical:
            picture, what = _drawn(scene), "Coordinates against time"
        elif scene.finite_field:
            picture, what = (
                _dots(scene),
                f"γ₁ against γ₂ after every step, numbers modulo the prime of {scene.finite_field}",
            )
        else:
            content = shown(scene, frames=FRAMES)
            drawn = "its tip after every step" if scene.steps is not None else "the path of its tip"
            what = f"γ on the sphere, {drawn}, blue in front and pale behind; the orange dot is the start"
            html = page(content, '<script src="plotly.js"></script>')
            (moving / f"{name}.html").write_text(html, encoding="utf-8")
            picture = _thumbnail(content)
        (folder / f"{name}.png").write_bytes(picture)
        (folder / f"{name}.md").write_text(_page(scene, what, content, results.get(name)), encoding="utf-8")
        cards.append(
            f"::::{{grid-item-card}} {scene.title}\n:link: {name}\n:link-type: doc\n:img-top: {name}.png\n"
            f":img-alt: {what}, {scene.title}\n\n`{name}`\n::::\n"
        )
    names = "\n".join(scene_names())
    (folder / "index.md").write_text(
        "# Gallery\n\nEvery scene that ships. The picture is the curve that γ, the direction “up” seen from the body, draws on a "
        "sphere. For a system without a body it shows the coordinates against time, over a finite field two coordinates of every state. The page of a scene "
        "explains why the motion is hard to compute, and has the commands, the run time and the body in motion.\n\n"
        f":::::{{grid}} 1 2 3 3\n:gutter: 3\n\n{''.join(cards)}:::::\n\n```{{toctree}}\n:hidden:\n\n{names}\n```\n",
        encoding="utf-8",
    )


def _page(scene: Any, what: str, content: dict[str, Any] | None, found: Any) -> str:
    heading = scene.title.replace("m r²", "m\u00a0r²")  # one term, not parted at the end of a line
    parts = [f"# {heading}\n\n{' '.join(scene.description.split())}\n"]
    parts.append(f":::{{figure}} {scene.name}.png\n:alt: {what}, {scene.title}\n:align: left\n\n{what}.\n:::\n")
    commands = f"integrable run {scene.name}\n" + (f"integrable view {scene.name}\n" if content else "")
    parts.append(f"```console\n{commands}```\n")
    if found is not None and found.best:
        from integrable.scene.tables import duration, figure

        parts.append(
            f"**Run time.** {found.flow[0]['row']['method'].capitalize()}: {duration(found.best['total'])} with set-up, largest error "
            f"of {scene.letters[0]} {figure(found.best['error_gamma'])} ([all methods](../measured/{scene.name}.md)).\n"
        )
    elif found is not None:
        parts.append(f"[Measurements](../measured/{scene.name}.md)\n")
    if content:
        parts.append(
            "## Watch it move\n\n"
            f'```{{raw}} html\n<details class="moves"><summary>Open the animated page here (5 MB)</summary>\n'
            f'<iframe class="moving" data-src="../_static/view/{scene.name}.html" '
            f'title="The motion: {scene.title}"></iframe></details>\n'
            # five megabytes of drawing code are loaded when they are asked for
            "<script>document.querySelector('.moves').addEventListener('toggle', (event) => {\n"
            "  const frame = event.target.querySelector('iframe');\n"
            "  if (!frame.src) frame.src = frame.dataset.src;\n"
            "});</script>\n"
            f'<p>Or <a href="../_static/view/{scene.name}.html">open it by itself</a>.</p>\n```\n'
        )
    if (FIGURES / f"{scene.name}.svg").exists():
        parts.append(
            f"## Error against run time\n\n![Error against run time: {scene.title}](../figures/report/{scene.name}.svg)\n"
        )
    return "\n".join(parts)


def _drawn(scene: Any) -> bytes:
    """The coordinates of a system without a body against time."""
    from integrable.study.plot import coordinates

    system, state = scene.start(15)
    run = system.motion_through(state).at((scene.sphere or scene.times).floats())
    return _light(coordinates(run.q, run.times, scene.title))


def _dots(scene: Any) -> bytes:
    """Two coordinates of the states of an orbit over a finite field, parts of its prime: they look like noise."""
    from integrable.scene.orbit import orbit

    system, state = scene.start(15)
    run = orbit(scene.step(system, 15), state, scene.steps.count)
    first, second = (np.array([int(x) for x in run.gamma[:, i]], dtype=float) for i in (0, 1))
    axes = _square()
    axes.plot(
        first / system.field.characteristic, second / system.field.characteristic, ".", color="#0072B2", markersize=2
    )
    axes.set(xlim=(-0.02, 1.02), ylim=(-0.02, 1.02), aspect="equal")
    return _light(axes.figure)


def _square() -> Any:
    """Axes that are not drawn."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(2.6, 2.6))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.96))
    axes.set_axis_off()
    return axes


def _thumbnail(content: dict[str, Any]) -> bytes:
    """γ on the sphere, small, the front half strong and the back half faint."""
    gamma = np.array(content["gamma"])
    axis = np.array([1.0, 0.7, 0.6]) / np.linalg.norm([1.0, 0.7, 0.6])
    across = np.cross([0, 0, 1], axis)
    across /= np.linalg.norm(across)
    up = np.cross(axis, across)
    x, y, depth = gamma @ across, gamma @ up, gamma @ axis
    axes = _square()
    turn = np.linspace(0, 2 * np.pi, 181)
    axes.fill(np.cos(turn), np.sin(turn), color="#f2f4f7", zorder=0)
    axes.plot(np.cos(turn), np.sin(turn), color="#9aa3ad", linewidth=0.8)
    for side, colour in ((depth < 0, "#bcd3e2"), (depth >= 0, "#0072B2")):
        if content["steps"]:
            axes.plot(x[side], y[side], ".", color=colour, markersize=3)
        else:
            axes.plot(np.where(side, x, np.nan), np.where(side, y, np.nan), color=colour, linewidth=1.1)
    axes.plot(x[0], y[0], "o", color="#D55E00", markersize=4)
    axes.set(xlim=(-1.06, 1.06), ylim=(-1.06, 1.06), aspect="equal")
    return _light(axes.figure)


def _light(figure: Any) -> bytes:
    import io

    from PIL import Image

    stored = io.BytesIO()
    figure.savefig(stored, format="png", dpi=110)
    # a few colours are enough, and forty pictures stay light; the usual choice of colours loses that of a small dot
    small = io.BytesIO()
    Image.open(stored).convert("RGB").quantize(48, Image.Quantize.MAXCOVERAGE).save(small, "png", optimize=True)
    return small.getvalue()
