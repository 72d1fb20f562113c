"""Times from a fresh flow to a first state at a distant time: bodies of every kind, near the separatrix, against d.

Each row has the milliseconds of processor time from ``system.flow(state)`` to one state at t = 10⁶/|M|, and its way.
The time is the least of several fresh flows in a warm process. ``python -m benchmarks.bench_setup --figure STEM`` draws
the times against the distance from the separatrix and against d.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from time import thread_time
from typing import Any

import numpy as np

from benchmarks.bench_flow import HARD, SCENES, START, system_of
from benchmarks.figures import Rows, command, save
from integrable import ChaplyginBall, EulerTop, load_scene
from integrable.scene.looks import BLUE, INK, ORANGE
from integrable.study.plot import FAINT, STYLE
from integrable.systems.system import System
from jacobian.errors import PrecisionLoss

FAR = 1e6
TICKS = (0.5, 1, 2, 4)
SEPARATRIX, MASS = "H1/H2 over a₂, less 1", "d"
# the styles of the ways in the figure
WAYS = ({"color": BLUE, "marker": "o"}, {"color": ORANGE, "marker": "s"}, {"color": INK, "marker": "^"})


def run(smoke: bool) -> Rows:
    """Rows (varied, value, ms, way) for bodies, distances from the separatrix, values of d, and deformations."""
    rows: Rows = []
    for varied, motions in (
        ("body", bodies()),
        (SEPARATRIX, beside_the_separatrix()),
        (MASS, heavier_balls()),
        ("deformation", deformations()),
    ):
        for value, (system, state) in list(motions)[: 1 if smoke else None]:
            rows.append({"varied": varied, "value": value, **cost(system, state, 1 if smoke else 15)})
    return rows


def bodies() -> Iterator[tuple[Any, tuple[System, Any]]]:
    """Pairs of a name and a motion: the bodies of ``python -m benchmarks flow``, and a tilted thin body."""
    for name in (*SCENES, *HARD):
        yield name, system_of(name)


def beside_the_separatrix() -> Iterator[tuple[Any, tuple[System, Any]]]:
    """Pairs of ε and a motion near the separatrix: M at the angle √ε from the middle axis, γ orthogonal to M."""
    ball = ChaplyginBall((1, 2, 3), 0.7)
    for k in range(1, 15):
        eps = 10.0**-k
        yield eps, (ball, ball.state((0, 0, 1), (eps**0.5, (1 - eps) ** 0.5, 0)))


def heavier_balls() -> Iterator[tuple[Any, tuple[System, Any]]]:
    """Pairs of d and a motion of the body with moments 1, 2, 3, from the free top (d = 0) to d = 10¹⁰."""
    for d in (0.0, *(10.0**k for k in range(-10, 11, 2))):
        system = ChaplyginBall((1, 2, 3), d) if d else EulerTop((1, 2, 3))
        yield d, (system, system.state(*START))


def deformations() -> Iterator[tuple[str, tuple[Any, Any]]]:
    """Pairs of a name and a motion of a deformation, which moves by additions on elliptic curves."""
    for name in ("tilde", "check", "hat", "tilde_poles"):
        yield name, load_scene(name).start(15)


def cost(system: Any, state: Any, repeats: int) -> dict[str, Any]:
    """The least time from a fresh flow to one state at a distant time, and its way. If the flow refuses the motion, it
    is the time until the exception.
    """
    times = [FAR / float(np.linalg.norm(np.array(state.M, dtype=float)))]
    best = np.inf
    for _ in range(repeats + 1):
        begun = thread_time()
        try:
            way = system.flow(state).at(times).way
        except PrecisionLoss:
            way = "refused"
        best = min(best, thread_time() - begun)
    return {"ms": 1e3 * best, "way": way}


def draw(rows: Rows, stem: Path) -> None:
    """Draws the set-up time against the distance from the separatrix and against d."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=(8, 3.4), layout="constrained")
        for axes, varied in zip(figure.subplots(1, 2, sharey=True), (SEPARATRIX, MASS), strict=True):
            part = [row for row in rows if row["varied"] == varied]
            ways = list(dict.fromkeys(row["way"] for row in part))
            for way, look in zip(ways, WAYS, strict=False):
                shown = [(row["value"], row["ms"]) for row in part if row["way"] == way and row["value"]]
                axes.loglog(*zip(*shown, strict=True), label=way, markersize=5, linewidth=1.3, **look)
            beside = varied == SEPARATRIX
            axes.set_title("near the separatrix" if beside else "light and heavy balls", fontsize=10.5)
            axes.set_xlabel("(H1/H2)/a₂ − 1, no unit" if beside else "d, in the unit of the moments 1, 2, 3")
            axes.grid(color=FAINT, alpha=0.25, linewidth=0.6)
            if len(ways) > 1:
                axes.legend(frameon=False)
        figure.axes[0].set_ylabel("set-up and a first state,\nms of processor time")
        figure.axes[0].set_yticks(TICKS, map(str, TICKS))
        figure.axes[0].minorticks_off()
        save(figure, stem)


if __name__ == "__main__":
    command(__doc__, run, draw)
