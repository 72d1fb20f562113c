"""The ball that rolls at the top of the landing page: data, canvas and script in one piece of HTML, made at every build."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

LAST, STEP = 60, 0.1
"""The length shown, as in docs/figures/front.png, and the interval between frames, in units of time: the ball turns by
at most 0.08 rad.
"""
MOST = 200_000  # bytes: the page has to be light

HTML = """\
<figure class="rolling">
<canvas role="img" aria-label="A ball with three coloured circles rolls on a plane and draws a wavy line"></canvas>
<figcaption><button type="button">Pause</button> A Chaplygin ball with moments of inertia 1, 2, 3 and m r² = 0.7, from
t = 0 to {last}. The circles are fixed in the ball; the blue line is where it has touched the plane. Squares are one radius wide.</figcaption>
<script type="application/json">{data}</script>
<script>
{script}</script>
</figure>
"""


def html() -> str:
    """The figure; with its data it is less than `MOST` bytes."""
    script = Path(__file__).with_suffix(".js").read_text(encoding="utf-8")
    data = json.dumps(frames(), separators=(",", ":"))
    content = HTML.format(last=LAST, data=data, script=script)
    assert len(content.encode()) < MOST
    return content


def frames() -> dict[str, Any]:
    """``step``, and of every frame the ball's place in the plane, in radii, and its attitude: quaternions (w, x, y, z).

    The plane is turned by a quarter, so that the ball rolls to the right.
    """
    from integrable import ChaplyginBall

    ball, state = ChaplyginBall.example()
    run = ball.flow(state).at(np.arange(0, LAST + STEP / 2, STEP))
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    turned = quarter @ np.asarray(run.attitude, dtype=float)
    place = np.asarray(run.contact, dtype=float)[:, :2] @ quarter[:2, :2].T
    return {"step": STEP, "place": place.round(3).tolist(), "attitude": _quaternions(turned).round(4).tolist()}


def _quaternions(matrices: np.ndarray) -> np.ndarray:
    """Those of rotation matrices, with signs that do not jump from one to the next."""
    # the matrix of 4 q qᵀ: its column with the largest diagonal is a multiple of q
    m = matrices
    squares = np.stack(
        [
            1 + m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2],
            1 + m[:, 0, 0] - m[:, 1, 1] - m[:, 2, 2],
            1 - m[:, 0, 0] + m[:, 1, 1] - m[:, 2, 2],
            1 - m[:, 0, 0] - m[:, 1, 1] + m[:, 2, 2],
        ],
        axis=1,
    )
    products = np.zeros((len(m), 4, 4))
    products[:, range(4), range(4)] = squares
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        products[:, 0, i + 1] = products[:, i + 1, 0] = m[:, k, j] - m[:, j, k]
        products[:, i + 1, j + 1] = products[:, j + 1, i + 1] = m[:, i, j] + m[:, j, i]
    found = products[np.arange(len(m)), squares.argmax(axis=1)]
    found /= np.linalg.norm(found, axis=1)[:, None]
    signs = np.sign((found[1:] * found[:-1]).sum(axis=1)).cumprod()
    return np.concatenate([found[:1], signs[:, None] * found[1:]])
