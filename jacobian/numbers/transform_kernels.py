"""Number-theoretic transforms on floats, compiled: modulo primes below 2^49, eight numbers at once in a vector.

A block x of length 2m represents a polynomial modulo X^(2m) − W² and is mapped to its residues modulo X^m − W and X^m +
W. One factor W serves a whole block, so loops over its numbers become vector instructions (Harvey 2014 on the
arithmetic). Block b has the factor W[b] on each level; the W[b] are in the order of reversed bits. Blocks that fit into
the processor's cache are finished one after the other. The last four levels run on SIDE blocks of 16 at once and leave
the values in an interleaved order. Pointwise products and the inverse transform work in that order too.

Numbers modulo the prime q may be of size below 4.5·q on entry. :func:`forward` returns sizes below 2·q,
:func:`backward` below 4.5·q. The caller compiles the functions (:mod:`jacobian.native`).
"""

from __future__ import annotations

from typing import Any

SIDE = 64
LEAST = 16 * SIDE
"""The length of the shortest transform."""
CACHED = 1 << 16
"""The number of values of a block that stays in the processor's cache."""


def _split(Q: Any, a0: Any, a1: Any, a2: Any, a3: Any, outer: Any, inner: Any, other: Any) -> Any:
    """Two levels of :func:`forward`: from residues modulo X^(4m) − W² to those modulo X^m ∓ W' and X^m ∓ W''.

    ``outer`` is W; ``inner`` is W', W'² = W; ``other`` is W'', W''² = −W.
    """
    a0, a2, a3 = Q.dot(a0, 1.0), Q.dot(a2, outer), Q.dot(a3, outer)
    b1, b3 = Q.dot(a1 + a3, inner), Q.dot(a1 - a3, other)
    return a0 + a2 + b1, a0 + a2 - b1, a0 - a2 + b3, a0 - a2 - b3


def _join(Q: Any, c0: Any, c1: Any, c2: Any, c3: Any, outer: Any, inner: Any, other: Any) -> Any:
    """Four times the inverse of :func:`_split`; ``outer``, ``inner``, ``other`` are the 1/W, 1/W', 1/W'' there."""
    b0, b2 = Q.dot(c0 + c1, 1.0), Q.dot(c2 + c3, 1.0)
    b1, b3 = Q.dot(c0 - c1, inner), Q.dot(c2 - c3, other)
    return b0 + b2, b1 + b3, Q.dot(b0 - b2, outer), Q.dot(b1 - b3, outer)


def _halves(Q: Any, x: Any, m: Any) -> None:
    """Maps a polynomial modulo X^(2m) − 1 to its residues modulo X^m − 1 and X^m + 1, in place.

    The same function maps the two residues to twice the polynomial.
    """
    for j in range(m):
        low, high = Q.dot(x[j], 1.0), Q.dot(x[m + j], 1.0)
        x[j], x[m + j] = low + high, low - high


def _quarters(turn: Any, Q: Any, W: Any, x: Any, begin: Any, m: Any, b: Any) -> None:
    """Applies ``turn``, :func:`_split` or :func:`_join`, to the numbers of block b, which has length 4m, in place."""
    outer, inner, other = W[b], W[2 * b], W[2 * b + 1]
    x0, x1 = x[begin : begin + m], x[begin + m : begin + 2 * m]
    x2, x3 = x[begin + 2 * m : begin + 3 * m], x[begin + 3 * m : begin + 4 * m]
    for j in range(m):
        x0[j], x1[j], x2[j], x3[j] = turn(Q, x0[j], x1[j], x2[j], x3[j], outer, inner, other)


def _beside(turn: Any, Q: Any, W: Any, S: Any, m: Any, b: Any) -> None:
    """Applies ``turn`` as :func:`_quarters` does, to the SIDE blocks b, b + 1, … of 16 numbers.

    They are interleaved: number i of block b + k is S[i·SIDE + k]. For m = 1 block b + k counts as four blocks of 4
    numbers, the blocks 4(b + k) to 4(b + k) + 3.
    """
    for i in range(4):
        first = (i if m == 4 else 4 * i) * SIDE
        for k in range(SIDE):
            c, put = b + k if m == 4 else 4 * (b + k) + i, first + k
            S[put], S[put + m * SIDE], S[put + 2 * m * SIDE], S[put + 3 * m * SIDE] = turn(
                Q,
                S[put],
                S[put + m * SIDE],
                S[put + 2 * m * SIDE],
                S[put + 3 * m * SIDE],
                W[c],
                W[2 * c],
                W[2 * c + 1],
            )


def _last_down(Q: Any, W: Any, x: Any, begin: Any, b: Any, S: Any) -> None:
    """The last four levels of :func:`forward` for SIDE blocks of 16 numbers, from block b on."""
    for k in range(SIDE):
        for i in range(16):
            S[i * SIDE + k] = x[begin + 16 * k + i]
    _beside(_split, Q, W, S, 4, b)
    _beside(_split, Q, W, S, 1, b)
    for i in range(LEAST):
        x[begin + i] = S[i]


def _first_up(Q: Any, W: Any, x: Any, begin: Any, b: Any, S: Any) -> None:
    for i in range(LEAST):
        S[i] = x[begin + i]
    _beside(_join, Q, W, S, 1, b)
    _beside(_join, Q, W, S, 4, b)
    for k in range(SIDE):
        for i in range(16):
            x[begin + 16 * k + i] = S[i * SIDE + k]


def forward(Q: Any, W: Any, x: Any, S: Any) -> None:
    """Transforms x, of length 2^k ≥ LEAST, in place. ``W`` holds the factors, half as many as x has numbers. ``S`` is
    scratch for LEAST numbers.
    """
    whole, size = len(x), _even(len(x))
    if size < whole:
        _halves(Q, x, size)
    while size > CACHED:
        for b in range(whole // size):
            _quarters(_split, Q, W, x, b * size, size // 4, b)
        size //= 4
    for block in range(whole // size):
        part = size
        while part > 16:
            for b in range(size // part):
                _quarters(_split, Q, W, x, block * size + b * part, part // 4, block * (size // part) + b)
            part //= 4
        for begin in range(block * size, (block + 1) * size, LEAST):
            _last_down(Q, W, x, begin, begin // 16, S)


def backward(Q: Any, W: Any, x: Any, S: Any) -> None:
    """Replaces x by the inverse transform times its length; ``W`` holds the inverse factors."""
    whole, top = len(x), _even(len(x))
    size = top
    while size > CACHED:
        size //= 4
    for block in range(whole // size):
        for begin in range(block * size, (block + 1) * size, LEAST):
            _first_up(Q, W, x, begin, begin // 16, S)
        part = 64
        while part <= size:
            for b in range(size // part):
                _quarters(_join, Q, W, x, block * size + b * part, part // 4, block * (size // part) + b)
            part *= 4
    while size < top:
        size *= 4
        for b in range(whole // size):
            _quarters(_join, Q, W, x, b * size, size // 4, b)
    if top < whole:
        _halves(Q, x, top)


def _even(length: Any) -> int:
    """``length`` or half of it, whichever is LEAST times a power of 4."""
    size = LEAST
    while 4 * size <= length:
        size *= 4
    return size


def factors(Q: Any, roots: Any, W: Any) -> None:
    """Sets W[b] = Π roots[i] over the bits i that are set in b; roots[i] has order 2^(i+2)."""
    W[0] = 1.0
    filled, i = 1, 0
    while filled < len(W):
        for b in range(filled):
            W[filled + b] = Q.canonical(Q.dot(W[b], roots[i]))
        filled, i = 2 * filled, i + 1


def multiply(Q: Any, x: Any, y: Any, out: Any) -> None:
    """Sets out to the pointwise product of x and y."""
    for j in range(len(out)):
        out[j] = Q.dot(x[j], y[j])


def combined(P: Any, Q: Any, c: Any, residues: Any, begin: Any, scale: Any, out: Any) -> None:
    """Sets out = scale·N modulo p, canonical. N is the integer of least size with the residues residues[i]·c[i]
    (Garner 1959).

    ``Q``: the contexts of three primes q₁, q₂, q₃. ``residues`` (2 or 3, size): a row for each of the first two or all
    three primes, used from column ``begin`` on. ``c``: a factor for each prime, then 1/q₁ mod q₂, q₁ mod p, 1/q₁ and
    1/q₂ mod q₃, q₁q₂ mod p.
    """
    first, second, third = Q
    for j in range(len(out)):
        low = first.canonical(first.dot(residues[0, begin + j], c[0]))
        middle = second.canonical(second.dot(second.dot(residues[1, begin + j], c[1]) - low, c[3]))
        total = P.dot(low, 1.0) + P.dot(middle, c[4])
        if residues.shape[0] > 2:
            high = third.dot(third.dot(residues[2, begin + j], c[2]) - low, c[5]) - middle
            total += P.dot(third.canonical(third.dot(high, c[6])), c[7])
        out[j] = P.canonical(P.dot(total, scale[j]))
