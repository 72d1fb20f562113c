"""Fields, polynomials and curves as LaTeX: what ``latex(…)`` of Sage and notebooks ask values for."""

from __future__ import annotations

import re
from typing import Any

from jacobian import poly


def field(K: Any) -> str:
    """The sign of a field: 𝐅 with its order, 𝐐, 𝐑, 𝐂; MP(digits) is 𝐑 or 𝐂 too."""
    if K.order is None:
        letter = "Q" if K.exact else "C" if getattr(K, "complex", isinstance(K.one, complex)) else "R"
        return rf"\mathbf{{{letter}}}"
    power = f"{K.characteristic}^{{{K.degree}}}" if K.order != K.characteristic else str(K.order)
    return rf"\mathbf{{F}}_{{{power}}}"


def polynomial(K: Any, a: poly.Poly) -> str:
    """A polynomial in x, the highest power first."""
    written = re.sub(r"\^(\d+)", r"^{\1}", poly.text(K, a)).replace("·", " ").replace("j", "i")
    written = re.sub(r"(\d+)/(\d+)", r"\\tfrac{\1}{\2}", written)
    return re.sub(r"e\+?(-?)0*(\d+)", r" \\cdot 10^{\1\2}", written)


def equation(K: Any, f: poly.Poly, h: poly.Poly) -> str:
    """y² + h(x)y = f(x)."""
    linear = rf" + \left({polynomial(K, h)}\right) y" if h else ""
    return f"y^{{2}}{linear} = {polynomial(K, f)}"
