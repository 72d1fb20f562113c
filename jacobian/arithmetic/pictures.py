"""Pictures of L-polynomials: histograms of a_i/p^(i/2), and the scatter of (a_1/√p, a_2/p). They need matplotlib."""

from __future__ import annotations

from math import comb, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from jacobian.arithmetic.record import LPolynomials
from jacobian.arithmetic.saved import path_of
from jacobian.element import File
from jacobian.errors import ArgumentError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLUE, VERMILION = "#0072B2", "#D55E00"
"""Colours of Okabe and Ito (2008)."""
MOST_DOTS = 20_000
"""The largest number of primes in a scatter; the largest primes are taken."""


def figure(L: LPolynomials) -> Figure:
    """Histograms of the normalised coefficients, and in genus 2 and 3 the scatter of the first two, with the boundary
    of the region that Weil's bounds allow.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ArgumentError("matplotlib is not installed: pip install 'jacobian-integrable[app]'") from None
    g, values = L.curve.genus, L.normalised()
    drawn = Figure(figsize=(4.2 * (g + (g > 1)), 3.6), layout="constrained")
    axes = np.atleast_1d(drawn.subplots(1, g + (g > 1)))
    for i, ax in enumerate(axes[:g]):
        _histogram(ax, values[:, i], i + 1, comb(2 * g, i + 1))
    if g > 1:
        _scatter(axes[g], values[-MOST_DOTS:], g)
    equation = f"${L.curve._latex_()}$".replace(r"\tfrac", r"\frac")
    drawn.suptitle(f"{equation}, {len(L)} primes up to {L.bound}")
    return drawn


def draw(L: LPolynomials, path: File) -> None:
    """Writes the picture: .png, .svg or .pdf by the name of the file."""
    figure(L).savefig(path_of(path), dpi=150)


def _name(i: int) -> str:
    return rf"$a_{i}/\sqrt{{p}}$" if i == 1 else rf"$a_{i}/p$" if i == 2 else rf"$a_{i}/p^{{3/2}}$"


def _histogram(ax: Any, values: Any, i: int, bound: int) -> None:
    bins = int(min(120, max(20, sqrt(len(values)))))
    ax.hist(values, bins=bins, range=(-bound, bound), density=True, color=BLUE)
    ax.set_xlabel(_name(i))
    ax.set_ylabel("density of primes")


def _scatter(ax: Any, values: Any, g: int) -> None:
    ax.plot(values[:, 0], values[:, 1], ".", color=BLUE, markersize=2, alpha=0.4, rasterized=True)
    a1 = np.linspace(-2 * g, 2 * g, 400)
    # the curves are the largest and the least a_2/p for a given a_1/√p
    ax.plot(a1, a1**2 * (g - 1) / (2 * g) + g, color=VERMILION, linewidth=1)
    size = np.abs(a1)
    lower = 2 * size - 2 if g == 2 else np.where(size <= 2, -1.0, 4 * size - 9)
    ax.plot(a1, lower, color=VERMILION, linewidth=1)
    ax.set_xlabel(_name(1))
    ax.set_ylabel(_name(2))
