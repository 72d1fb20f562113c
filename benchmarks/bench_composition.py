"""Error of D + D' in floats against the distance of D' from D, by three methods: classical, stacked, kernel.

``python -m benchmarks.bench_composition --figure docs/figures/composition`` also draws it, as .png and .svg.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.classical import classical
from benchmarks.figures import command, save
from jacobian import RR
from jacobian.inexact import composition, genus2_real
from tests.jacobian.inexact.real_rows import DISTANCES, TYPICAL, WORST, Row, rows

CASES = {
    "near D": "both points of D′ near those of D",
    "near -P, other generic": "one point of D′ near the opposite of one of D",
}


def by_cramer(row: Row) -> tuple[Any, Any]:
    """U and V of a sum by the textbook composition. ZeroDivisionError if U and U' have a common zero."""
    u0, u1, v0, v1 = classical(*(tuple(map(float, part)) for part in (row.f, row.first, row.second)))
    return (u0, u1), (v0, v1)


def stacked(row: Row) -> tuple[Any, Any]:
    """U and V of a sum from both congruences at once, by orthogonal transformations (jacobian.inexact.composition)."""
    first, second = (([*map(float, pair[:2]), 1.0], [*map(float, pair[2:])]) for pair in (row.first, row.second))
    total = composition.compose(RR, 2, row.f, first, second)
    return total.u[:2], total.v


def kernel(row: Row) -> tuple[Any, Any]:
    """U and V of a sum by the stacked composition with unrolled loops (jacobian.inexact.genus2_real)."""
    total = genus2_real.add(*(tuple(map(float, part)) for part in (row.f, row.first, row.second)))[0]
    return total[:2], total[2:]


METHODS: dict[str, Callable[[Row], tuple[Any, Any]]] = {"classical": by_cramer, "stacked": stacked, "kernel": kernel}


def errors(method: Callable[[Row], tuple[Any, Any]], sample: Sequence[Row]) -> list[float | None]:
    """The errors of a method's sums in ascending order; at the end a None for each sum that divides by zero."""
    found = []
    for row in sample:
        try:
            found.append(row.error(*method(row)))
        except ZeroDivisionError:
            found.append(float("inf"))
    return [None if error == float("inf") else error for error in sorted(found)]


def run(smoke: bool) -> list[dict[str, object]]:
    """Median and worst error for every case, distance and method, 200 random curves each; None: no result."""
    table: list[dict[str, object]] = []
    for case in CASES:
        for k in (0, 8, None) if smoke else DISTANCES:
            sample = rows(case, k, count=5 if smoke else 200)
            row: dict[str, object] = {"case": case, "distance": "0" if k is None else f"1e-{k:02}"}
            for name, method in METHODS.items():
                found = errors(method, sample)
                typical, worst = found[len(found) // 2], found[-1]
                row |= {f"{name} median": typical, f"{name} worst": worst}
                if name != "classical" and (worst is None or worst > WORST or median(filter(None, found)) > TYPICAL):
                    raise AssertionError(f"{name}, {case}, {row['distance']}: median {typical}, worst {worst}")
            table.append(row)
    return table


def draw(table: list[dict[str, object]], stem: Path) -> None:
    """Draws the table as stem.png and stem.svg."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    # Okabe and Ito's colours, each with its own marker
    styles = {
        "classical": ("#D55E00", "s", "classical solve, L ≡ (V′ − V)/U mod U′"),
        "stacked": ("#0072B2", "o", "both congruences, stacked"),
        "kernel": ("#009E73", "^", "the same, unrolled kernel"),
    }
    figure, panels = pyplot.subplots(1, 2, figsize=(11, 4.8), sharey=True, layout="constrained")
    top = 1e3
    for panel, (case, title) in zip(panels, CASES.items(), strict=True):
        chosen = [row for row in table if row["case"] == case]
        places = range(len(chosen))
        for name, (colour, marker, label) in styles.items():
            typical, worst = (
                [min(row[f"{name} {kind}"] or top, top) for row in chosen] for kind in ("median", "worst")
            )  # type: ignore[type-var]
            panel.semilogy(places, typical, color=colour, marker=marker, markersize=5, label=label)
            panel.semilogy(places, worst, color=colour, linestyle=":", linewidth=1.2)
        panel.set_title(title, fontsize=11)
        ticks = [i for i in places if chosen[i]["distance"] == "0" or (i % 3 == 0 and i < len(chosen) - 2)]
        panel.set_xticks(
            ticks, ["exact" if chosen[i]["distance"] == "0" else f"$10^{{-{i}}}$" if i else "1" for i in ticks]
        )
        panel.set_xlabel("distance")
        panel.set_ylim(1e-17, 3 * top)
        panel.grid(alpha=0.25)
    panels[0].set_ylabel("relative error of D + D′ in double precision")
    panels[1].legend(loc="upper left", fontsize=9, title="solid: median, dotted: worst of 200 curves", title_fontsize=9)
    figure.suptitle(
        "Adding divisors of genus 2 in floats (squares on the top line: error ≥ 10³ or division by zero)", fontsize=11
    )
    save(figure, stem)
    pyplot.close(figure)


if __name__ == "__main__":
    command(__doc__, run, draw)
