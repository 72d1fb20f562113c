"""Random smooth curves of every model and genus over every kind of field, as lines of Python."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from random import Random
from typing import Any

from jacobian import GF, QQ, ArgumentError, HyperellipticCurve, poly

PRIMES = (2, 3, 5, 7, 11, 13, 101, 251, 65537, 2**31 - 1, 2**32 - 5, 2**61 - 1, 2**63 - 25, 2**64 - 59)
BIG = (2**64 + 13, 2**127 - 1, 2**255 - 19)
# (p, k) → an irreducible polynomial, ascending: galois would have to be loaded for seconds to find one
POWERS = {
    (2, 2): (1, 1, 1),
    (2, 3): (1, 1, 0, 1),
    (2, 4): (1, 1, 0, 0, 1),
    (2, 8): (1, 0, 1, 1, 1, 0, 0, 0, 1),
    (2, 11): (1, 0, 1, *[0] * 8, 1),
    (2, 16): (1, 0, 1, 1, 0, 1, *[0] * 10, 1),
    (2, 17): (1, 0, 0, 1, *[0] * 13, 1),
    (2, 40): (1, 0, 0, 1, 1, 1, *[0] * 34, 1),
    (3, 2): (2, 2, 1),
    (3, 5): (1, 2, 0, 0, 0, 1),
    (5, 3): (3, 3, 0, 1),
    (7, 2): (3, 6, 1),
    (101, 2): (2, 97, 1),
}
BIG_POWERS = {
    (65537, 2): (3, 0, 1),
    (2**31 - 1, 2): (1, 0, 1),
    (2**31 - 1, 3): (5, 0, 0, 1),
    (2**61 - 1, 2): (1, 0, 1),
    (2**64 + 13, 2): (2**64 + 11, 0, 1),
}
MODELS = ("ramified", "moved", "split", "inert")


@dataclass(frozen=True)
class Curve:
    """``setup`` makes C and J; ``C`` is the same curve, for the oracle."""

    setup: str
    C: Any


def field_text(rng: Random, rational: bool = True) -> str:
    """The text of a random field; orders below 2^64 are more frequent than larger ones."""
    p = rng.random()
    if p < 0.4:
        return f"GF({rng.choice(PRIMES)})"
    if p < 0.5:
        return f"GF({rng.choice(BIG)})"
    if p < 0.9 or not rational:
        return power_text(*rng.choice(list(POWERS if rng.random() < 0.8 else BIG_POWERS)))
    return "QQ"


def power_text(p: int, k: int) -> str:
    return f"GF({p}, {k}, {(POWERS | BIG_POWERS)[p, k]})"


@cache
def field_of(text: str) -> Any:
    return eval(text, {"GF": GF, "QQ": QQ})


def element(K: Any, rng: Random) -> Any:
    if K.order is None:
        return K.coerce(f"{rng.randrange(-9, 10)}/{rng.choice((1, 1, 1, 2, 3))}")
    return rng.randrange(K.order)


def polynomial(K: Any, size: int, rng: Random) -> Any:
    return poly.trim(K, tuple(element(K, rng) for _ in range(size)))


def random_curve(rng: Random, text: str | None = None, genus: int | None = None, model: str | None = None) -> Curve:
    """A smooth curve; ``model``, if it is given, is one of :data:`MODELS`."""
    text = text or field_text(rng)
    K, g = field_of(text), genus or rng.choice((1, 2, 2, 2, 3, 3, 4, 5, 6))
    if K.order is not None and K.order.bit_length() > 65 and "," in text:
        # beyond this a random class takes seconds
        g = min(g, 3)
    model = model or rng.choice(MODELS)
    if model == "inert" and g % 2:
        model = "split"
    for _ in range(400):
        f, h = _equation(K, g, model, rng)
        try:
            C = HyperellipticCurve(K, f, h)
        except ArgumentError:
            continue
        if C.genus == g and C.model == ("ramified" if model == "moved" else model):
            return Curve(curve_lines(text, f, h), C)
    # over so small a field there is no such curve: another choice
    return random_curve(rng, None, genus, None)


def curve_lines(text: str, f: Any, h: Any) -> str:
    name = "GF" if text.startswith("GF") else text
    h_text = f", {_listed(h)}" if h else ""
    return (
        f"from random import Random\nfrom jacobian import {name}, HyperellipticCurve\n"
        f"C = HyperellipticCurve({text}, {_listed(f)}{h_text})\nJ = C.jacobian()\n"
    )


def _listed(a: Any) -> str:
    return "[" + ", ".join(str(c) if isinstance(c, int) else repr(str(c)) for c in a) + "]"


def _equation(K: Any, g: int, model: str, rng: Random) -> tuple[Any, Any]:
    with_h = K.characteristic == 2 or rng.random() < 0.4
    ramified = model in ("ramified", "moved")
    h = polynomial(K, g + 1 + (not ramified), rng) if with_h else ()
    size = 2 * g + 2 + (not ramified)
    f = _through_points(K, size, h, rng) if K.order is None else polynomial(K, size, rng)
    if K.order is None and model == "split":
        f = _with_square_lead(K, f, h, size, rng)
    if model != "moved":
        return f, h
    move = poly.monomial(K, element(K, rng), g + 1)
    h = poly.sub(K, h, poly.add(K, move, move))
    return poly.add(K, f, poly.mul(K, move, poly.add(K, move, h))), h


def _through_points(K: Any, size: int, h: Any, rng: Random) -> Any:
    """f = v² + hv − u·w, u = Π(x − x_i): the curve passes through (x_i, v(x_i))."""
    u = poly.from_roots(K, [K.coerce(x) for x in rng.sample(range(-4, 5), min(3, size - 2))])
    v = polynomial(K, 2, rng)
    f = poly.mul(K, v, poly.add(K, v, h))
    return poly.add(K, f, poly.mul(K, u, polynomial(K, size - len(u) + 1, rng)))


def _with_square_lead(K: Any, f: Any, h: Any, size: int, rng: Random) -> Any:
    """A leading coefficient that lets y/x^(g+1) be rational at infinity."""
    f = [*f, *[K.zero] * (size - len(f))]
    z, b = K.coerce(rng.choice((1, 2, 3))), h[size // 2] if len(h) > size // 2 else K.zero
    top = K.mul(z, K.add(z, b))
    # a multiple of Π(x − x_i) would keep the points; a few curves without known ones do no harm
    f[-1] = top
    return poly.trim(K, tuple(f))
