"""``python -m jacobian sato-tate``: L-polynomials up to a bound, their moments, and the compatible Sato–Tate groups."""

from __future__ import annotations

import argparse
import json
import re
from fractions import Fraction
from typing import Any

from jacobian.arithmetic.record import LPolynomials
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import ArgumentError, shown
from jacobian.fields import QQ

TERM = re.compile(r"([+-]?)(\d+(?:/\d+)?)?\*?(x(?:(?:\^|\*\*)(\d+))?)?")
MOST_DEGREE = 1000


def polynomial_of(text: str) -> list[Fraction]:
    """The ascending coefficients of a polynomial in x written as "x^5 - x + 1", or of a list, "[1, -1, 0]"."""
    if text.strip().startswith("["):
        try:
            return [Fraction(str(c)) for c in json.loads(text)]
        except ValueError:
            raise ArgumentError(f"{shown(text)}: a list of coefficients is needed, as in [1, -1, 0, 0, 0, 1]") from None
    written, found, at = re.sub(r"\s+", "", text), dict[int, Fraction](), 0
    while at < len(written):
        match = TERM.match(written, at)
        if not match or match.end() == at or not (match[2] or match[3]) or (at and not match[1]):
            raise ArgumentError(f"{shown(text)}: a polynomial in x is needed, as in x^5 - x + 1 or 3/2*x^6 + 1")
        sign, number, power, exponent = match.groups()
        degree = int(exponent or 1) if power else 0
        if degree > MOST_DEGREE:
            raise ArgumentError(f"{shown(text)}: x^{degree} is beyond degree {MOST_DEGREE}")
        found[degree] = found.get(degree, Fraction(0)) + Fraction(f"{sign}{number or 1}")
        at = match.end()
    if not found:
        raise ArgumentError("the polynomial is empty: as in x^5 - x + 1")
    return [found.get(i, Fraction(0)) for i in range(max(found) + 1)]


def curve_of(text: str) -> HyperellipticCurve:
    """The curve y² = f for the text "f", y² + hy = f for "[f, h]"; f, h: polynomials in x or lists of coefficients."""
    inner = text.strip()
    if inner.startswith("[") and inner.endswith("]") and re.search(r"[x\[]", inner[1:]):
        parts = re.findall(r"\[[^\]]*\]|[^,\[\]]+", inner[1:-1])
        parts = [part for part in parts if part.strip()]
        if len(parts) > 2:
            raise ArgumentError(f"curve = {shown(text)}: [f, h] has two polynomials")
        f, h = parts[0], parts[1] if len(parts) > 1 else "0"
        return HyperellipticCurve(QQ, polynomial_of(f), polynomial_of(h) if h.strip() != "[]" else ())
    return HyperellipticCurve(QQ, polynomial_of(inner))


def bound_of(text: str) -> int:
    """The int that a text such as 1000 or 2^20 stands for."""
    match = re.fullmatch(r"(\d{1,9})(?:(?:\^|\*\*)(\d{1,2}))?", text.strip())
    if not match:
        raise ArgumentError(f"bound = {shown(text)}: an int is needed, as 1000 or 2^20")
    return int(match[1]) ** int(match[2] or 1)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of ``sato-tate``."""
    parser.add_argument("curve", help='f of y² = f(x), as in "x^5-x+1", or "[f, h]" of y² + h(x)y = f(x)')
    parser.add_argument("--bound", default="2^14", help="the largest prime (default: 2^14)")
    parser.add_argument("--file", help="a file for the state of a long run, from which the same command resumes")
    parser.add_argument("--csv", metavar="FILE", help="write p, a1, …, ag there")
    parser.add_argument("--parquet", metavar="FILE", help="the same as Parquet")
    parser.add_argument(
        "--picture", metavar="FILE", help="draw histograms and the scatter of (a1, a2): .png, .svg, .pdf"
    )
    parser.add_argument("--progress", action="store_true", help="show a bar")


def run(arguments: argparse.Namespace) -> None:
    """Prints :func:`text_of` and writes the requested files."""
    C = curve_of(arguments.curve)
    L: Any = C.l_polynomials(bound_of(arguments.bound), arguments.file, arguments.progress)
    if arguments.csv:
        L.to_csv(arguments.csv)
    if arguments.parquet:
        L.to_parquet(arguments.parquet)
    if arguments.picture:
        from jacobian.arithmetic.pictures import draw

        draw(L, arguments.picture)
    print(text_of(L))


def text_of(L: LPolynomials) -> str:
    """A report on L: its repr, the moments and, in genus 1 and 2, the compatible Sato–Tate groups and probabilities."""
    from jacobian.arithmetic.sato_tate import FROM, bound_with, sato_tate_groups

    lines = [repr(L)]
    for i, row in enumerate(L.moments(8).tolist(), 1):
        power = "√p" if i == 1 else "p" if i == 2 else "p^(3/2)"
        lines.append(f"moments of a{i}/{power}: " + ", ".join(f"{x:.2f}" for x in row[1:]))
    if L.curve.genus > 2:
        return "\n".join([*lines, "Sato–Tate group: identified in genus 1 and 2"])
    if sum(L.p > FROM) < 100:
        return "\n".join([*lines, f"Sato–Tate group: too few primes beyond {FROM}; take a larger bound"])
    verdicts = sato_tate_groups(L)
    lines.append("Sato–Tate group (evidence, not proof), by the probability of means as far from the group's:")
    for name, probability, primes in verdicts:
        left = f"; {primes} primes, up to about {bound_with(primes)}, would decide" if primes else ""
        lines.append(f"  {name}: {probability:.3f}{left}")
    return "\n".join(lines if verdicts else [*lines, "  none of the groups over QQ: a larger bound may tell"])
