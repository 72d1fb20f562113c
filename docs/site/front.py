"""Draw the picture of the README from the published report: ``python docs/site/front.py``.

Left: where the ball of the scene ``chaplygin`` has touched the plane, in radii. Right: the error of γ against run time
(set-up and evaluation) of methods that the report ran on this scene in floats; the flow chooses its kernel itself.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from integrable import ChaplyginBall
from integrable.study.plot import BLUE, FAINT, ORANGE, STYLE, look_of

DOCS = Path(__file__).parents[1]
FIGURE = DOCS / "figures" / "front.png"
SHOWN = (
    "divisor flow",
    "SciPy DOP853",
    "SciPy LSODA",
    "Gauss-Legendre 16",
    "Taylor, compiled",
    "heyoka",
    "heyoka, long double",
)


def main() -> None:
    """Write the picture beside the others of the documentation."""
    report = json.loads((DOCS / "error_against_run_time.json").read_text(encoding="utf-8"))
    with rc_context(STYLE):
        figure = Figure(figsize=(10.6, 3.4), layout="constrained")
        FigureCanvasAgg(figure)
        trace, errors = figure.subplots(1, 2)
        _trace(trace)
        _errors(errors, report["rows"])
        figure.savefig(FIGURE, dpi=144)


def _trace(axes: Any) -> None:
    ball, state = ChaplyginBall.example()
    contact = ball.flow(state).at(np.linspace(0, 60, 4001)).contact
    along, across = -contact[:, 1], contact[:, 0]
    axes.plot(along, across, color=BLUE, linewidth=1.3)
    axes.plot(along[0], across[0], "o", color=ORANGE, markersize=5)
    axes.set(xlabel="along, radii", ylabel="across, radii", title="trace of the ball on the plane, 0 ≤ t ≤ 60")


def _errors(axes: Any, rows: list[dict[str, Any]]) -> None:
    for method in SHOWN:
        own = [
            row["result"]
            for row in rows
            if (row["row"]["scene"], row["row"]["method"]) == ("chaplygin", method)
            and row["row"]["kind"] in ("flow", "comparator")
            and row["row"]["setting"] not in ("30 digits", "compiled")
            and row["status"] == "done"
        ]
        times, errors = ([found[key] for found in own] for key in ("total", "error_gamma"))
        axes.loglog(times, errors, label=method, markersize=5, **look_of(method))
    axes.set(
        xlabel="run time, seconds",
        ylabel="largest error of γ, 0 ≤ t ≤ 1000",
        title="error against run time, 101 states",
    )
    axes.margins(x=0.12)
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.6)
    # beside the axes: points of slow methods reach the right edge
    axes.legend(fontsize=9, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))


if __name__ == "__main__":
    main()
