"""Cantor's composition and reduction on machine words, for one pair of classes: functions to be compiled.

The steps are those of :mod:`jacobian.addition.cantor`, for every genus, model and special case. They are written once
for all contexts of :mod:`jacobian.numbers.words` and :mod:`jacobian.numbers.tables`. A polynomial is a row of one
scratch array, with ascending coefficients, and is passed with its length. Coefficients are canonical, so that zero is
always the word 0.

A class is an array of 2g + 4 words: deg u + 1, the length of v, n (0 where there is none), u padded to g + 1, v to g.
A curve is the array that :func:`packed_curve` returns.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from jacobian.curve.curve import HyperellipticCurve
from jacobian.numbers.words import inverse

ROWS = 17
"""The number of polynomials in the scratch array."""

_HEAD = 7


def packed_curve(C: HyperellipticCurve, to_word: Any) -> Any:
    """The curve as an array of words: its genus, 1 if it is split, the lengths of f, h, V₊ and V₋, the value of
    y/x^(g+1) at ∞₊, then these four polynomials.
    """
    parts = C.principal_parts if C.model == "split" else ((), ())
    polynomials = (C.f, C.h, *parts)
    lead = to_word(C.infinity_plus) if C.model == "split" else 0
    words = [C.genus, C.model == "split", *map(len, polynomials), lead]
    return np.array([*words, *[to_word(c) for a in polynomials for c in a]], np.int64)


def width(genus: int) -> int:
    """The number of words of a class."""
    return 2 * genus + 4


# --- polynomials: each function writes the result into its first array and returns its length


def _trimmed(a: Any, size: Any) -> Any:
    while size > 0 and a[size - 1] == 0:
        size -= 1
    return size


def _copy(r: Any, a: Any, size: Any) -> Any:
    for i in range(size):
        r[i] = a[i]
    return size


def _sum(K: Any, r: Any, a: Any, na: Any, b: Any, nb: Any) -> Any:
    """a + b; r may be a or b."""
    both = min(na, nb)
    for i in range(both):
        r[i] = K.canonical(K.add(a[i], b[i]))
    for i in range(both, na):
        r[i] = a[i]
    for i in range(both, nb):
        r[i] = b[i]
    return _trimmed(r, max(na, nb))


def _difference(K: Any, r: Any, a: Any, na: Any, b: Any, nb: Any) -> Any:
    """Writes a − b to r, which may be a or b, and returns its length."""
    both = min(na, nb)
    for i in range(both):
        r[i] = K.canonical(K.sub(a[i], b[i]))
    for i in range(both, na):
        r[i] = a[i]
    for i in range(both, nb):
        r[i] = K.canonical(K.neg(b[i]))
    return _trimmed(r, max(na, nb))


def _scaled(K: Any, r: Any, c: Any, a: Any, size: Any) -> Any:
    for i in range(size):
        r[i] = K.canonical(K.dot(c, a[i]))
    return size


def _product(K: Any, r: Any, a: Any, na: Any, b: Any, nb: Any) -> Any:
    """a·b, with one modular reduction for every two terms."""
    if na == 0 or nb == 0:
        return 0
    for k in range(na + nb - 1):
        i, last = max(0, k + 1 - nb), min(k, na - 1)
        total = K.canonical(K.dot(a[i], b[k - i]))
        i += 1
        while i < last:
            total = K.canonical(K.dot(total, K.one, a[i], b[k - i], a[i + 1], b[k - i - 1]))
            i += 2
        if i == last:
            total = K.canonical(K.dot(total, K.one, a[i], b[k - i]))
        r[k] = total
    return na + nb - 1


def _minus_product(K: Any, r: Any, size: Any, a: Any, na: Any, b: Any, nb: Any) -> Any:
    """r − a·b, in place."""
    if na == 0 or nb == 0:
        return size
    total = max(size, na + nb - 1)
    for i in range(size, total):
        r[i] = 0
    for i in range(na):
        c = K.canonical(K.neg(a[i]))
        for j in range(nb):
            r[i + j] = K.canonical(K.dot(r[i + j], K.one, c, b[j]))
    return _trimmed(r, total)


def _divide(K: Any, q: Any, r: Any, size: Any, b: Any, nb: Any) -> Any:
    """Divides r by b ≠ 0; returns (length of the quotient q, length of the remainder). The remainder replaces r."""
    steps = size - nb + 1
    if steps <= 0:
        return 0, size
    lead = b[nb - 1]
    monic = lead == K.one
    if not monic:
        lead = inverse(K, lead)
    for i in range(steps - 1, -1, -1):
        c = r[i + nb - 1]
        if not monic:
            c = K.canonical(K.dot(c, lead))
        q[i] = c
        c = K.canonical(K.neg(c))
        for j in range(nb - 1):
            r[i + j] = K.canonical(K.dot(r[i + j], K.one, c, b[j]))
    return steps, _trimmed(r, nb - 1)


def _half_xgcd(K: Any, S: Any, d: Any, s: Any, a: Any, na: Any, b: Any, nb: Any) -> Any:
    """Writes the monic d = gcd(a, b) and an s with s·b ≡ d modulo a; returns the lengths of d and s."""
    r0, r1, s0, s1, q = S[0], S[1], S[2], S[3], S[4]
    n0, n1, m0, m1 = _copy(r0, a, na), _copy(r1, b, nb), 0, 1
    s1[0] = K.one
    while n1 > 1:
        size, n0 = _divide(K, q, r0, n0, r1, n1)
        m0 = _minus_product(K, s0, m0, q, size, s1, m1)
        r0, r1, n0, n1 = r1, r0, n1, n0
        s0, s1, m0, m1 = s1, s0, m1, m0
    if n1 == 1:
        r0, s0, n0, m0 = r1, s1, n1, m1
    lead = r0[n0 - 1]
    if lead == K.one:
        _copy(d, r0, n0)
        return n0, _copy(s, s0, m0)
    lead = inverse(K, lead)
    _scaled(K, d, lead, r0, n0)
    d[n0 - 1] = K.one
    return n0, _scaled(K, s, lead, s0, m0)


# --- divisors


def equation(curve: Any) -> Any:
    """The tuple (f, its length, h, its length) of a curve's array."""
    begin = _HEAD + curve[2]
    return curve[_HEAD:begin], curve[2], curve[begin : begin + curve[3]], curve[3]


def _cofactor(K: Any, curve: Any, S: Any, q: Any, u: Any, nu: Any, v: Any, nv: Any) -> Any:
    """Writes (f − hv − v²)/u to q and returns its length."""
    f, nf, h, nh = equation(curve)
    trace, rest = S[5], S[6]
    size = _product(K, rest, v, nv, trace, _sum(K, trace, v, nv, h, nh))
    return _divide(K, q, rest, _difference(K, rest, f, nf, rest, size), u, nu)[0]


def add_classes(K: Any, curve: Any, S: Any, first: Any, second: Any, result: Any) -> Any:
    """result = first + second; the three may be one array."""
    g = curve[0]
    u1, v1, n1, m1 = first[3:], first[4 + g :], first[0], first[1]
    u2, v2, n2, m2 = second[3:], second[4 + g :], second[0], second[1]
    d, s, k, difference = S[7], S[8], S[9], S[10]
    nd, ns = _half_xgcd(K, S, d, s, u1, n1, u2, n2)
    nk = _product(K, k, s, ns, difference, _difference(K, difference, v1, m1, v2, m2))
    if nd > 1:
        _, _, h, nh = equation(curve)
        nt = _sum(K, difference, v1, m1, v2, m2)
        nt = _sum(K, difference, difference, nt, h, nh)
        nd, nk = _common_part(K, curve, S, nd, (difference, nt), nk, (u2, n2, v2, m2))
    reduced1, reduced2 = S[11], S[12]
    n1, n2 = _without(K, S, reduced1, u1, n1, d, nd), _without(K, S, reduced2, u2, n2, d, nd)
    weights = first[2] + second[2]
    _close(K, curve, S, (reduced1, n1), (reduced2, n2, v2, m2), nk, weights + nd - 1, result)


def _without(K: Any, S: Any, r: Any, u: Any, nu: Any, d: Any, nd: Any) -> Any:
    """Writes u/d to r and returns its length."""
    if nd == 1:
        return _copy(r, u, nu)
    return _divide(K, r, S[6], _copy(S[6], u, nu), d, nd)[0]


def _common_part(K: Any, curve: Any, S: Any, nd: Any, sum_of_v: Any, nk: Any, divisor: Any) -> Any:
    """Replaces d and k, in S[7] and S[9], as :func:`jacobian.addition.cantor._common_part` does; returns their lengths.

    ``sum_of_v`` (v₁+v₂+h) and ``divisor`` (u₂, v₂) are tuples in which each polynomial is followed by its length.
    """
    (trace, nt), (u, nu, v, nv) = sum_of_v, divisor
    d, k, common, t, r, other = S[7], S[9], S[11], S[12], S[13], S[14]
    size, ns = _half_xgcd(K, S, common, t, d, nd, trace, nt)
    if ns > 0:
        nr = _minus_product(K, r, _copy(r, common, size), t, ns, trace, nt)
        nr = _divide(K, other, r, nr, d, nd)[0]
        nr = _product(K, S[6], other, nr, k, nk)
        nk = _copy(k, S[6], nr)
        no = _cofactor(K, curve, S, other, u, nu, v, nv)
        nk = _sum(K, k, k, nk, S[6], _product(K, S[6], t, ns, other, no))
    return _copy(d, common, size), nk


def double_class(K: Any, curve: Any, S: Any, first: Any, result: Any) -> Any:
    """result = first + first; the two may be one array."""
    g = curve[0]
    u, v, nu, nv = first[3:], first[4 + g :], first[0], first[1]
    _, _, h, nh = equation(curve)
    d, t, k, trace, reduced = S[7], S[8], S[9], S[10], S[11]
    size = _sum(K, trace, v, nv, v, nv)
    size = _sum(K, trace, trace, size, h, nh)
    nd, nt = _half_xgcd(K, S, d, t, u, nu, trace, size)
    other = S[12]
    nk = _product(K, k, t, nt, other, _cofactor(K, curve, S, other, u, nu, v, nv))
    n = _without(K, S, reduced, u, nu, d, nd)
    _close(K, curve, S, (reduced, n), (reduced, n, v, nv), nk, 2 * first[2] + nd - 1, result)


def negate_class(K: Any, curve: Any, S: Any, first: Any, result: Any) -> Any:
    """result = −first; the two may be one array."""
    g = curve[0]
    _, _, h, nh = equation(curve)
    u, v = S[15], S[16]
    nu = _copy(u, first[3:], first[0])
    nv = _sum(K, v, first[4 + g :], first[1], h, nh)
    nv = _difference(K, v, v, 0, v, nv)
    _, nv = _divide(K, S[6], v, nv, u, nu)
    _reduce(K, curve, S, nu, nv, 2 * ((g + 1) // 2) - (nu - 1) - first[2], result)


def _close(K: Any, curve: Any, S: Any, first: Any, second: Any, nk: Any, weights: Any, result: Any) -> Any:
    """Sets result to the reduced class of (u₁u₂, v + u₂·(k mod u₁), weights − ⌈g/2⌉).

    The polynomial k is in S[9], with ``nk`` coefficients. ``first`` has u₁, ``second`` u₂ and v, each with its length.
    """
    (u1, n1), (u2, n2, v, nv) = first, second
    k, u, total = S[9], S[15], S[16]
    _, nk = _divide(K, S[6], k, nk, u1, n1)
    size = _product(K, total, u2, n2, k, nk)
    size = _sum(K, total, total, size, v, nv)
    nu = _product(K, u, u1, n1, u2, n2)
    if size >= nu:
        _, size = _divide(K, S[6], total, size, u, nu)
    _reduce(K, curve, S, nu, size, weights - (curve[0] + 1) // 2, result)


def _reduce(K: Any, curve: Any, S: Any, nu: Any, nv: Any, n: Any, result: Any) -> Any:
    """result = the reduced class of (u, v, n); the polynomials u and v are in S[15] and S[16]."""
    g, split = curve[0], curve[1]
    u, v, part = S[15], S[16], S[10]
    while nu - 1 > g + split:
        nu, nv, n = _reflect(K, curve, S, nu, nv, n)
    while split and not 0 <= n <= g - (nu - 1):
        begin, size = _HEAD + curve[2] + curve[3], curve[4]
        if n < 0:
            begin, size = begin + curve[4], curve[5]
        half = curve[begin : begin + size]
        ns = _difference(K, part, v, nv, half, size)
        _, ns = _divide(K, S[6], part, ns, u, nu)
        nv = _sum(K, v, half, size, part, ns)
        nu, nv, n = _reflect(K, curve, S, nu, nv, n)
    result[0], result[1], result[2] = nu, nv, n if split else 0
    for i in range(g + 1):
        result[3 + i] = u[i] if i < nu else 0
    for i in range(g):
        result[4 + g + i] = v[i] if i < nv else 0


def _reflect(K: Any, curve: Any, S: Any, nu: Any, nv: Any, n: Any) -> Any:
    """Applies :func:`jacobian.addition.cantor.reflect` to the polynomials u and v in S[15] and S[16]. Returns their new
    lengths and the new weight.
    """
    _, _, h, nh = equation(curve)
    u, v, other = S[15], S[16], S[13]
    size = curve[0] + 1
    no = _cofactor(K, curve, S, other, u, nu, v, nv)
    if nv - 1 > size:
        n += nv - no
    elif (v[size] if size < nv else 0) == curve[6]:
        n += nu - 1 - size
    else:
        n += size - (no - 1)
    lead = other[no - 1]
    _scaled(K, u, inverse(K, lead) if lead != K.one else lead, other, no)
    u[no - 1] = K.one
    nv = _sum(K, v, v, nv, h, nh)
    nv = _difference(K, v, v, 0, v, nv)
    _, nv = _divide(K, S[6], v, nv, u, no)
    return no, nv, n
