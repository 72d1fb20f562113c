"""Colours and markers of the methods in all figures. No two methods have the same colour and marker. The most used
colours are those of Okabe & Ito (2008), distinguishable with any colour vision.
"""

from __future__ import annotations

__all__ = ["BLUE", "INK", "LOOKS", "ORANGE", "look"]

BLUE, ORANGE, INK = "#0072B2", "#D55E00", "#222222"

LOOKS: dict[str, tuple[str, str, bool]] = {
    "divisor flow": (BLUE, "o", True),
    "integrated": ("#004A73", "H", True),
    "additions": ("#0072B3", "8", True),
    "elliptic curves": ("#0072B4", "p", True),
    "Bäcklund steps": ("#56B4E9", "P", True),
    "SciPy DOP853": (ORANGE, "s", True),
    "SciPy DOP853, compiled": ("#F4A582", "v", False),
    "SciPy LSODA": ("#E69F00", "v", True),
    "SciPy Radau": ("#8C510A", "<", True),
    "implicit midpoint": ("#999999", "x", True),
    "Gauss-Legendre 6": ("#7F7F00", "+", True),
    "Gauss-Legendre 16": ("#009E73", "D", True),
    "Gauss-Legendre 16, adaptive": ("#66C2A5", "d", True),
    "Taylor, compiled": ("#000000", "^", True),
    "Taylor, multiprecision": ("#1B6F7A", ">", True),
    "heyoka": ("#B2182B", "*", True),
    "heyoka, long double": ("#762A83", "h", True),
    "closed elliptic form": ("#F0E442", "X", True),
    "mpmath odefun": ("#5E3C99", "4", True),
    "Moser-Veselov": ("#CC79A7", "o", False),
    "Moser-Veselov, order 4": ("#AA3377", "s", False),
    "Hirota-Kimura": ("#E7298A", "D", False),
}
"""Colour, matplotlib's name of the marker, and whether the marker is filled; markers of discretized tops are open."""
OTHER = ("#666666", "p", False)


def look(method: str) -> tuple[str, str, bool]:
    """The colour and marker of a method, and whether the marker is filled. An unknown method gets a default."""
    return LOOKS.get(method, OTHER)
