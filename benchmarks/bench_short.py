"""The choice of "auto" between a walk, a short run and a torus, compared with the cheapest, and the costs it rests on.

The first rows are the constants of the cost model of :mod:`integrable.motion.short`, in microseconds of processor time:
as they are ``kept`` there, and as they are ``measured`` here on each scene.

The next rows are for fresh flows with a number of times up to T. They have the milliseconds of a walk and a short run
of any length (a dash where their checks fail), of the torus, and of "auto" with its choice. ``lost`` is the time of
"auto" relative to the cheapest. A choice is good if it loses little, or if it is a torus that takes at most twice as
long. The last row says in how many cases a slower one was chosen, and the most that was lost.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.curves import least_seconds
from integrable.motion import short
from integrable.motion.flow import Flow
from integrable.motion.near import NearWalk
from integrable.motion.short import ShortRuns
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.ways import Cost, Way
from integrable.scene.doubles import in_doubles
from integrable.scene.file import load_scene
from jacobian.errors import PrecisionLoss

SCENES = ("chaplygin", "euler_top", "thin_ball", "tilted_ball")
TIMES, OUTPUTS = (1.0, 10.0, 100.0, 300.0, 1000.0, 3000.0), (1, 101, 2001, 6001)
# the times at which the costs are measured: with few panels, with many, and on the torus
NEAR, FAR, TORUS = 1.0, 60.0, 1e4
CONSTANTS = ("panel", "start", "torus set-up", "torus each")
REPEATS = 15
Row = dict[str, Any]


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows (scene, constant, kept, measured), then rows (scene, T, outputs, walk, short run, torus, auto, lost)."""
    scenes, repeats = (SCENES[:1], 1) if smoke else (SCENES, REPEATS)
    found = {name: measured_costs(name, repeats) for name in scenes}
    rows: list[Row] = []
    for place, constant in enumerate(CONSTANTS):
        for name in scenes:
            kept, measured = kept_costs(name)[place], found[name][place]
            rows.append({"scene": name, "constant": constant, "kept": kept, "measured": measured})
    for name in scenes:
        for outputs in OUTPUTS[: 1 if smoke else None]:
            rows += [chosen(name, outputs, T, repeats) for T in TIMES[: 1 if smoke else None]]
    return [*rows, summary([row["lost"] for row in rows if row.get("lost")])]


@cache
def problem(name: str) -> tuple[Any, Any]:
    """The system and the state of a scene, in doubles."""
    return in_doubles(load_scene(name)).start(FLOAT_DIGITS)


def fresh(name: str, kernel: str) -> Flow:
    """A new flow of a scene, with nothing cached."""
    return Flow(*problem(name), kernel)


def summary(lost: list[float]) -> Row:
    """The last row: how often "auto" chose a method that took over a tenth longer, and the most that was lost."""
    slower = sum(x > 1.1 for x in lost)
    return {"scene": "all", "auto": f"the slower way {slower} of {len(lost)} times", "lost": max(lost, default=1.0)}


def kept_costs(name: str) -> tuple[float, ...]:
    """The constants that the package keeps for one scene, in the order of the rows."""
    body = problem(name)[0].body
    torus = short.torus_cost(min(body.inertia), max(body.inertia), body.d)
    return short.PANEL_COST, short.START_COST, *torus


def measured_costs(name: str, repeats: int) -> tuple[float, ...]:
    """The constants measured on one scene, in the order of the rows."""
    near, far = np.array([NEAR]), np.array([FAR])
    with patch.object(short, "panels_within", lambda *_: 10**6):
        first, last = (1e6 * least_seconds(lambda t=t: ShortRuns(*problem(name)).at(t), repeats) for t in (near, far))
        panels = [_panels(name, t) for t in (near, far)]
    panel = (last - first) / (panels[1] - panels[0])
    set_up = 1e6 * least_seconds(lambda: fresh(name, "compiled").at(np.array([TORUS])), min(repeats, 5))
    flow, few = fresh(name, "compiled"), np.random.default_rng(1).uniform(0, TORUS, 100)
    flow.at(few)
    each = 1e6 * least_seconds(lambda: flow.at(few), repeats) / len(few)
    return panel, first - panel * panels[0], set_up - each, each


def _panels(name: str, times: np.ndarray) -> int:
    runs = ShortRuns(*problem(name))
    runs.at(times)
    return runs.panels


def chosen(name: str, outputs: int, T: float, repeats: int) -> Row:
    """A row for a number of times up to T: the costs of all methods, and the choice of "auto"."""
    times = np.linspace(0, T, outputs) if outputs > 1 else np.array([T])

    def milliseconds(kernel: str, way: Callable[[Flow], Way] | None = None) -> float | None:
        """The least milliseconds of fresh flows, by one way alone if it is given; None if it does not reach."""

        def run() -> Any:
            flow = fresh(name, kernel)
            if way is not None:
                vars(flow)["_ways"] = lambda: iter([way(flow)])
            return flow.at(times)

        try:
            return 1e3 * least_seconds(run, min(repeats, 5))
        except PrecisionLoss:
            return None

    row: Row = {"scene": name, "T": T, "outputs": outputs}
    row["walk ms"] = milliseconds("auto", lambda flow: NearWalk(flow, Cost(1e5, 0)))
    with patch.object(short, "panels_within", lambda *_: 10**6):
        row["short run ms"] = milliseconds("auto", lambda flow: ShortRuns(flow.system, flow.state))
    row["torus ms"] = milliseconds("compiled")
    cheapest = min(x for way, x in row.items() if way.endswith(" ms") and x is not None)
    row["auto ms"] = milliseconds("auto")
    return row | {"auto": fresh(name, "auto").at(times).way, "lost": row["auto ms"] / cheapest}
