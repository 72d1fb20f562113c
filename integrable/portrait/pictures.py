"""Pictures of diagrams, sections and spectra, as figures of matplotlib (the extra ``app``)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.extras import needed
from integrable.portrait.ovals import zeta_through

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (6.4, 4.8)
COLORS = ("#1b6ca8", "#b03a2e", "#1e8449")
CURVES = 9
# lines that are drawn, beside the strongest, and lines that are named
FAINT, NAMED = 1e-6, 6


def _axes(what: str, rows: int = 1, height: float = SIZE[1]) -> tuple[Figure, Any]:
    """A figure and its axes: those of every row where there are more than one."""
    needed("matplotlib", what)
    from matplotlib.figure import Figure

    figure = Figure(figsize=(SIZE[0], height), layout="constrained")
    return figure, figure.subplots(rows, sharex=True)


def diagram(of: Any, states: Any) -> Figure:
    """:meth:`integrable.portrait.diagram.Diagram.figure`."""
    figure, ax = _axes("the picture of a diagram")
    a = sorted(of.system.a)
    if a[0] < a[1] < a[2]:
        X, Z, numbers = of.rotation_numbers()
        levels = np.quantile(numbers, np.linspace(0.02, 0.98, 15))
        ax.contourf(X, Z, numbers, levels=levels, cmap="Greys", alpha=0.5, extend="both")
        lines = ax.contour(X, Z, numbers, levels=levels, colors="0.4", linewidths=0.5, linestyles="solid")
        ax.clabel(lines, fontsize=7, fmt="%.2f")
    for axis, line in enumerate(of.lines):
        dashes = "--" if a[0] < of.system.a[axis] < a[2] else "-"
        ax.plot(*line.T, dashes, color=COLORS[axis], label=f"rotation about axis {axis + 1}")
    for state in states:
        ax.plot(*of.place(state), "ko", markersize=5)
    ax.set(xlabel="X = (γ, M)²/H2", ylabel="Z = H1/H2", xlim=(0, 1), title=f"rotation numbers of {of.system!r}")
    ax.legend(fontsize=8)
    return figure


def section(of: Any) -> Figure:
    """:meth:`integrable.portrait.section.Section.figure`."""
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
    ax.set(xlabel="φ of γ̃ across the axis", ylabel="M̃ along the axis / |M̃|", xlim=(-np.pi, np.pi), ylim=(-1.02, 1.02))
    ax.set_title(f"γ̃ across axis {of.axis + 1}: {len(of)} crossings")
    return figure


def spectrum(of: Any) -> Figure:
    """:meth:`integrable.portrait.spectrum.Spectrum.figure`."""
    figure, every = _axes("the picture of a spectrum", 3, 1.4 * SIZE[1])
    for ax, (name, lines) in zip(every, (("γ", of.gamma), ("M", of.M), ("ω", of.omega)), strict=True):
        sizes = np.abs(lines)
        floor = FAINT * sizes.max()
        for axis, color in enumerate(COLORS):
            seen = sizes[:, axis] > floor
            ax.vlines(of.frequencies[seen], floor, sizes[seen, axis], color=color, linewidth=1.2)
            ax.plot(of.frequencies[seen], sizes[seen, axis], "o", color=color, markersize=3, label=f"axis {axis + 1}")
        for n in np.argsort(-sizes.max(axis=1))[:NAMED]:
            text = "({}, {})".format(*of.modes[n])
            place = of.frequencies[n], sizes[n].max()
            ax.annotate(text, place, xytext=(3, 3), textcoords="offset points", fontsize=7)
        ax.set(yscale="log", ylabel=f"amplitude of {name}", ylim=(floor, 3 * sizes.max()))
    every[0].legend(fontsize=8)
    every[0].set_title("lines at ½(m₁f₁ + m₂f₂), named (m₁, m₂)")
    every[-1].set_xlabel("turns a unit of t")
    return figure
