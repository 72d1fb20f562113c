"""Short equations: named tuples of the curve's coefficients in words, one class for each set of explicit formulas."""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from jacobian.addition import genus2, genus3
from jacobian.addition.explicit import coefficients
from jacobian.addition.straight import Formulas
from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields.prime import PrimeField


class Quintic(namedtuple("Quintic", "f2 f3 f4")):
    """The coefficients of y² = x⁵ + f₄x⁴ + … + f₀ that the formulas use."""

    genus = 2


class Sextic(namedtuple("Sextic", "f2 f3 f4 f5 f6")):
    """The coefficients of y² = f₆x⁶ + … + f₀, f₆ ≠ 0, that the formulas use."""

    genus = 2


class BinaryQuintic(namedtuple("BinaryQuintic", "h0 h1 h2 f2 f3 f4")):
    """The coefficients of y² + (h₂x² + h₁x + h₀)y = x⁵ + f₄x⁴ + … + f₀ that the formulas use in characteristic 2."""

    genus = 2


class BinarySextic(namedtuple("BinarySextic", "h0 h1 h2 h3 f2 f3 f4 f5 f6")):
    """The coefficients of y² + (h₃x³ + … + h₀)y = f₆x⁶ + … + f₀, h₃ ≠ 0, that the formulas use in characteristic 2."""

    genus = 2


class Septic(namedtuple("Septic", "f3 f4 f5 f6")):
    """The coefficients of y² = x⁷ + f₆x⁶ + … + f₀ that the formulas use."""

    genus = 3


_H = {"h0": 0, "h1": 0, "h2": 0, "h3": 0}
MODELS: dict[type, tuple[Formulas, dict[str, int]]] = {
    Quintic: (genus2.OF_DEGREE_5, {**_H, "f5": 1, "f6": 0}),
    Sextic: (genus2.OF_DEGREE_6, _H),
    BinaryQuintic: (genus2.OF_DEGREE_5, {"characteristic": 2, "h3": 0, "f5": 1, "f6": 0}),
    BinarySextic: (genus2.OF_DEGREE_6, {"characteristic": 2}),
    Septic: (genus3.OF_DEGREE_7, {"f7": 1, "f8": 0}),
}
"""The formulas of each short equation, with its known coefficients, and with the characteristic if it is 2."""


def short_equation(C: HyperellipticCurve, to_word: Any) -> Any:
    """The coefficients of C for the explicit formulas; None if the formulas do not apply."""
    K: Any = C.field
    ramified, binary = C.model == "ramified", K.characteristic == 2
    if (C.h and not binary) or (ramified and C.f[-1] != K.one):
        return None
    if C.genus == 2:
        chosen: Any = (BinaryQuintic if ramified else BinarySextic) if binary else Quintic if ramified else Sextic
    elif C.genus == 3 and ramified and type(K) is PrimeField and not binary:
        chosen = Septic
    else:
        return None
    return chosen(*map(to_word, coefficients(C, chosen._fields).values()))
