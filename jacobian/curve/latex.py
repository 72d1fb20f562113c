"""Fields, polynomials and curves as LaTeX, for ``latex(…)`` of Sage and for notebooks."""

from __future__ import annotations

import re
from typing import Any

from jacobian import poly
from jacobian.fields.protocol import Field

# a long int is shown as its first and last digits and the number of all its digits
_INT = r"\d+(?:…\d+\[\d+ digits\])?"


def field(K: Any) -> str:
    """The symbol of a field: 𝐅 with its order, 𝐐, 𝐑, 𝐂; MP(digits) is 𝐑 or 𝐂 too."""
    if K.order is None:
        letter = "Q" if K.exact else "C" if K.complex else "R"
        return rf"\mathbf{{{letter}}}"
    power = f"{K.characteristic}^{{{K.degree}}}" if K.order != K.characteristic else str(K.order)
    return rf"\mathbf{{F}}_{{{power}}}"


def polynomial(K: Field, a: poly.Poly, variable: str = "x") -> str:
    """A polynomial as LaTeX, the highest power first."""
    written = re.sub(r"\^(\d+)", r"^{\1}", poly.text(K, a, variable)).replace("·", " ").replace("j", "i")
    written = re.sub(rf"({_INT})/({_INT})", r"\\tfrac{\1}{\2}", written)
    written = re.sub(r"…(\d+)\[(\d+) digits\]", r"\\ldots \1_{[\2\\,\\mathrm{digits}]}", written)
    return re.sub(r"e\+?(-?)0*(\d+)", r" \\cdot 10^{\1\2}", written)


def equation(K: Field, f: poly.Poly, h: poly.Poly) -> str:
    """The equation y² + h(x)y = f(x) as LaTeX."""
    linear = term_of_y(K, h, polynomial(K, h), r"\left({}\right) y", " ")
    return f"y^{{2}}{linear} = {polynomial(K, f)}"


def term_of_y(K: Field, h: poly.Poly, written: str, bracketed: str, times: str) -> str:
    """The text of "+ h(x)y" in an equation that begins with y²; ``written`` is the text of h.

    If h is a single term whose text has no + − / j after its first character, ``times`` and y follow it. Any other h is
    put into the format ``bracketed``.
    """
    if not h:
        return ""
    if h == (K.one,):
        return " + y"
    terms = sum(c != K.zero for c in h)
    plain = terms == 1 and not any(sign in written[1:] for sign in "+-/j")
    return f" + {written}{times}y".replace("+ -", "- ") if plain else " + " + bracketed.format(written)
