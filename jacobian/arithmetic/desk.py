"""The group law of curves modulo p, for one prime after another: loops to be compiled.

Curves and classes are arrays as in :mod:`jacobian.addition.cantor_words`. In genus 2, explicit formulas add classes in
general position.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from jacobian.addition.cantor_words import add_classes, double_class, negate_class
from jacobian.addition.short import Sextic
from jacobian.addition.word_steps import STEPS
from jacobian.numbers.words import inverse

HEAD = 7
"""The number of words of a packed curve before its polynomials."""


class Desk(NamedTuple):
    """The memory of a search by :mod:`jacobian.arithmetic.decision_kernels`, where s, t, c and D are explained.

    ``curve``: y² = G(t); ``scratch``: for Cantor's algorithm; ``F`` and ``moved``: the coefficients of F and of
    F(x_0 + x); ``steps`` and ``table``: the baby steps and their hash table; ``ranges``: the least and largest t for
    each s; ``found``: the candidates (s, t). ``classes`` begins with p·D, p²·D and c·D; the others are temporary.
    """

    curve: Any
    scratch: Any
    classes: Any
    F: Any
    moved: Any
    steps: Any
    table: Any
    ranges: Any
    found: Any


def class_at(K: Any, a: Any, x0: int, desk: Any) -> int:
    """Writes y² = G(t) to ``desk.curve``, and p·D, p²·D and c·D to ``desk.classes[:3]``, for the abscissa x_0; ``a`` is
    (a_1, a_2, a_3), the last two modulo p. :mod:`jacobian.arithmetic.decision_kernels` defines G, D and c.

    Returns 1 if the curve is isomorphic to y² = F(x), −1 if it is isomorphic to the quadratic twist, 0 if F(x_0) = 0.
    """
    value = model_at(K, x0, desk)
    if value == 0:
        return 0
    p, classes, g = K.p, desk.classes, desk.curve[0]
    sign = 1 if is_square(K, value) else -1
    a1, a2, a3 = a
    c, b = 1 + sign * a1 + a2, sign * a1 + p
    if g == 3:
        c, b = c + sign * a3, a2 + p * b
    set_class(K, g, (g + 1) // 2 + 1, classes[3])
    multiply(K, desk, p, classes[3], classes[0])
    multiply(K, desk, p, classes[0], classes[1])
    multiply(K, desk, b, classes[0], classes[2])
    multiply(K, desk, c, classes[3], classes[6])
    plus(K, desk, classes[2], classes[6], classes[2])
    return sign


def model_at(K: Any, x0: int, desk: Any) -> int:
    """Returns F(x_0). If it is not 0, writes y² = G(t), G(t) = t^(2g+2)·F(x_0 + 1/t)/F(x_0), to ``desk.curve``, in the
    form of :func:`jacobian.addition.cantor_words.packed_curve`.
    """
    curve, moved, n = desk.curve, desk.moved, len(desk.F)
    g = (n - 3) // 2
    for i in range(n):
        moved[i] = desk.F[i]
    for i in range(n - 1):
        for j in range(n - 2, i - 1, -1):
            moved[j] = K.add(moved[j], K.dot(x0, moved[j + 1]))
    if moved[0] == 0:
        return 0
    scale, half = inverse(K, moved[0]), (K.p + 1) // 2
    curve[0], curve[1], curve[2], curve[3], curve[4], curve[5], curve[6] = g, 1, n, 0, g + 2, g + 2, 1
    for i in range(n):
        curve[HEAD + n - 1 - i] = K.dot(moved[i], scale)
    # the principal parts ±V of y² = G(t): V has degree g + 1, and deg(G − V²) ≤ g
    top = HEAD + n + g + 1
    curve[top] = 1
    for i in range(1, g + 2):
        total = curve[HEAD + n - 1 - i]
        for j in range(1, i):
            total = K.sub(total, K.dot(curve[top - j], curve[top - i + j]))
        curve[top - i] = K.dot(total, half)
    for i in range(g + 2):
        curve[top + g + 2 - i] = K.neg(curve[top - i])
    return moved[0]


def is_square(K: Any, x: int) -> bool:
    """Whether x ≠ 0 is a square modulo p."""
    result, exponent = 1, (K.p - 1) // 2
    while exponent > 0:
        if exponent % 2 == 1:
            result = K.dot(result, x)
        x = K.dot(x, x)
        exponent = exponent // 2
    return result == 1


def set_class(K: Any, g: int, n: int, a: Any) -> None:
    """Writes into ``a`` the class of weight n at ∞₊ without affine points: ⌈g/2⌉ gives 0, ⌈g/2⌉ + 1 gives ∞₊ − ∞₋."""
    for i in range(len(a)):
        a[i] = 0
    a[0], a[2], a[3] = 1, n, 1


def multiply(K: Any, desk: Any, m: int, base: Any, result: Any) -> None:
    """result = m·base, by the non-adjacent form of m; overwrites ``desk.classes[4]`` and ``desk.classes[5]``."""
    g, square, opposite = desk.curve[0], desk.classes[4], desk.classes[5]
    set_class(K, g, (g + 1) // 2, result)
    copy(base, square)
    if m < 0:
        m = -m
        negate_class(K, desk.curve, desk.scratch, square, square)
    while m > 0:
        if m % 4 == 1:
            plus(K, desk, result, square, result)
        elif m % 4 == 3:
            negate_class(K, desk.curve, desk.scratch, square, opposite)
            plus(K, desk, result, opposite, result)
            m += 1
        m = m // 2
        if m > 0:
            twice(K, desk, square, square)


def plus(K: Any, desk: Any, a: Any, b: Any, result: Any) -> None:
    """result = a + b; the three may be one array."""
    curve = desk.curve
    if curve[0] == 2 and a[0] == 3 and b[0] == 3:
        first, second = (a[4], a[3], a[7], a[6]), (b[4], b[3], b[7], b[6])
        if closed(K, curve, STEPS[Sextic].chord(K, sextic(curve), first, second), (first, second), result):
            return
    add_classes(K, curve, desk.scratch, a, b, result)


def twice(K: Any, desk: Any, a: Any, result: Any) -> None:
    """result = a + a; the two may be one array."""
    curve = desk.curve
    if curve[0] == 2 and a[0] == 3:
        first = (a[4], a[3], a[7], a[6])
        if closed(K, curve, STEPS[Sextic].tangent(K, sextic(curve), first), (first, first), result):
            return
    double_class(K, curve, desk.scratch, a, result)


def sextic(curve: Any) -> Any:
    """The coefficients f₂ … f₆ that the explicit formulas use."""
    return Sextic(curve[HEAD + 2], curve[HEAD + 3], curve[HEAD + 4], curve[HEAD + 5], curve[HEAD + 6])


def closed(K: Any, curve: Any, quotient: Any, lines: Any, result: Any) -> bool:
    """Whether the explicit formulas of genus 2 apply; if so, sets ``result`` to the sum. ``quotient`` is what ``chord``
    or ``tangent`` of :mod:`jacobian.addition.genus2` returned, ``lines`` the (u_1, u_0, v_1, v_0) of both summands.
    """
    C, multiple = sextic(curve), STEPS[Sextic].product(K, sextic(curve), quotient)
    if multiple == 0:
        return False
    first, second = lines
    u1, u0, v1, v0 = STEPS[Sextic].closed(K, C, quotient, inverse(K, multiple), first, second)
    result[0], result[1], result[2] = 3, 2 if v1 != 0 else 1 if v0 != 0 else 0, 0
    result[3], result[4], result[5], result[6], result[7] = u0, u1, 1, v0, v1
    return True


def same(a: Any, b: Any) -> bool:
    for i in range(len(a)):  # noqa: SIM110  # a generator is not compiled
        if a[i] != b[i]:
            return False
    return True


def copy(a: Any, b: Any) -> None:
    for i in range(len(a)):
        b[i] = a[i]
