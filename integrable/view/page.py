"""The animated page, one HTML file that loads nothing from elsewhere."""

from __future__ import annotations

import json
import os
import re
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from integrable.extras import needed
from integrable.scene.data import Scene
from integrable.scene.output import OutputFolder
from integrable.view.shown import FRAMES, shown
from jacobian.errors import ArgumentError
from jacobian.errors import shown as text_of

__all__ = ["page", "plotly_script", "view"]

ROLLING = "The ball as it rolls, seen from a camera that follows it. The line is where it has touched the plane."
TURNING = "The body as it turns about its centre of mass."


def view(scene: Scene | str | Path, out: str | Path, *, until: float | None = None, frames: int = FRAMES) -> Path:
    """Write the page of a scene (or of the scene of that name or file) to ``out``, an .html file, and return its path.

    ``until`` and ``frames`` are those of :func:`integrable.view.shown.shown`. The file is complete or absent, and opens
    without a network. ArgumentError without plotly, if ``out`` cannot be written, over finite fields, and without a
    body.
    """
    if not isinstance(out, (str, os.PathLike)) or not Path(out).name:
        raise ArgumentError(f"out = {text_of(out)}: give the path of an .html file")
    script = plotly_script()
    out = Path(out)
    with OutputFolder(out.parent) as folder:
        return folder.write_text(out.name, page(shown(scene, until, frames), f"<script>{script}</script>"))


def plotly_script() -> str:
    """The text of plotly.js, which is part of the Python package plotly."""
    needed("plotly", "the page that moves", "view")
    from plotly.offline import get_plotlyjs

    return get_plotlyjs()


def page(content: dict[str, Any], plotly: str) -> str:
    """The HTML for the data of :func:`integrable.view.shown.shown`; ``plotly`` is the element that loads plotly.js."""
    here = files("integrable.view")
    # "</" would end the element that holds the numbers
    data = json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":")).replace("</", "<\\/")
    parts = {
        "title": escape(content["title"]),
        "description": escape(content["description"]),
        "body": ROLLING if content.get("contact") else TURNING,
        "missing": "".join(f"<p>Not shown: {escape(text)}.</p>" for text in content["missing"]),
        "plotly": plotly,
        "data": data,
        "player": here.joinpath("player.js").read_text(encoding="utf-8"),
    }
    text = here.joinpath("page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found[1]], text)
