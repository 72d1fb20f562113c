"""Pictures of diagrams, sections and spectra, as figures of matplotlib (the extra ``app``)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.extras import needed
from integrable.portrait.ovals import zeta_through

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (6.4, 4.8)
COLORS = ("#0072B2", "#D55E00", "#009E73")
"""The colours of the three axes: blue, vermilion and green of Okabe and Ito (2008), as on the interactive page."""
CURVES = 9
# spectral lines below FAINT times the largest are not drawn; at most NAMED lines are labelled
FAINT, NAMED = 1e-6, 6
LETTERS = {"gamma": "γ", "omega": "ω"}
"""The letters with which quantities of a body are labelled."""
APART = 0.05
"""The least distance of labelled lines, as a fraction of the picture's width, at which labels do not overlap."""


def _axes(what: str, rows: int = 1, height: float = SIZE[1]) -> tuple[Figure, Any]:
    """A figure and its axes, with one pair of axes per row where there are several rows."""
    needed("matplotlib", what)
    from matplotlib.figure import Figure

    figure = Figure(figsize=(SIZE[0], height), layout="constrained")
    return figure, figure.subplots(rows, sharex=True)


def diagram(of: Any, states: Any) -> Figure:
    """Draws :meth:`integrable.portrait.diagram.Diagram.figure`."""
    figure, ax = _axes("the picture of a diagram")
    a = sorted(of.system.a)
    if a[0] < a[1] < a[2]:
        X, Z, numbers = of.rotation_numbers()
        levels = np.quantile(numbers, np.linspace(0.02, 0.98, 15))
        ax.contourf(X, Z, numbers, levels=levels, cmap="Greys", alpha=0.5, extend="both")
        lines = ax.contour(X, Z, numbers, levels=levels, colors="0.4", linewidths=0.5, linestyles="solid")
        # contours crowd near the separatrix, so only every third one is labelled, and the last ones are not
        ax.clabel(lines, levels[1:-2:3], fontsize=7, fmt="%.2f")
    for axis, line in enumerate(of.lines):
        dashes = "--" if a[0] < of.system.a[axis] < a[2] else "-"
        ax.plot(*line.T, dashes, color=COLORS[axis], label=f"rotation about axis {axis + 1}")
    for count, state in enumerate(states):
        ax.plot(*of.place(state), "ko", markersize=5, label="given states" if count == 0 else None)
    body = "I = ({:g}, {:g}, {:g})".format(*map(float, of.system.inertia))
    title = f"rotation numbers, {body}, d = {float(of.system.d):g}"
    ax.set(xlabel="X = (γ, M)²/H2", ylabel="Z = H1/H2, 1/unit of inertia", xlim=(0, 1), title=title)
    ax.legend(fontsize=8)
    return figure


def section_figure(of: Any) -> Figure:
    """Draws :meth:`integrable.portrait.section.Section.figure`."""
    figure, ax = _axes("the picture of a section")
    flow = of.run.flow
    level = flow.portrait.level
    if of.axis == level.axes[0]:
        phi, height = np.meshgrid(np.linspace(-np.pi, np.pi, 361), np.linspace(-1, 1, 201))
        a1, a2, a3 = map(float, level.a)
        zeta = zeta_through(level, phi, height)
        others = [*(a1 + (a2 - a1) * k / CURVES for k in range(1, CURVES)), a2]
        others += [a2 + (a3 - a2) * k / CURVES for k in range(1, CURVES)]
        widths = [1.2 if x == a2 else 0.6 for x in others]
        ax.contour(phi, height, zeta, levels=others, colors="0.6", linewidths=widths)
    ax.plot(of.phi, of.momentum, "o", color=COLORS[0], markersize=2.5)
    ax.set(xlabel="φ of γ̃ across the axis, radians", ylabel="M̃ along the axis / |M̃|")
    ax.set(xlim=(-np.pi, np.pi), ylim=(-1.02, 1.02))
    ax.set_title(f"γ̃ across axis {of.axis + 1}: {len(of)} crossings")
    return figure


def spectrum_figure(of: Any) -> Figure:
    """Draws :meth:`integrable.portrait.spectrum.Spectrum.figure`."""
    figure, every = _axes("the picture of a spectrum", len(of.quantities), 1.4 * SIZE[1])
    for ax, name in zip(every, of.quantities, strict=True):
        sizes = np.abs(getattr(of, name))
        floor = FAINT * sizes.max()
        for axis in range(sizes.shape[1]):
            color, seen = COLORS[axis % len(COLORS)], sizes[:, axis] > floor
            ax.vlines(of.frequencies[seen], floor, sizes[seen, axis], color=color, linewidth=1.2)
            ax.plot(of.frequencies[seen], sizes[seen, axis], "o", color=color, markersize=3, label=f"axis {axis + 1}")
        named: list[float] = []
        apart = APART * np.ptp(of.frequencies)
        for n in np.argsort(-sizes.max(axis=1)):
            place = of.frequencies[n], sizes[n].max()
            # a label that would overlap another is left out
            if len(named) < NAMED and all(abs(place[0] - other) > apart for other in named):
                named.append(place[0])
                text = f"({', '.join(map(str, of.modes[n]))})"
                ax.annotate(text, place, xytext=(0, 4), textcoords="offset points", fontsize=7, ha="center")
        ax.set(yscale="log", ylabel=f"amplitude of {LETTERS.get(name, name)}", ylim=(floor, 6 * sizes.max()))
    every[0].legend(fontsize=8)
    every[0].set_title("spectral lines at ½Σm_k f_k, labelled (m₁, m₂, …)")
    every[-1].set_xlabel("turns per unit time")
    return figure
