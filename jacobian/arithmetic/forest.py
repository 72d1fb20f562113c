"""Windows of coefficients of f^((p−1)/2), modulo many primes p at once, by an accumulating remainder forest.

With f = Σ f_i x^i of degree d, f_0 ≠ 0, and c_k the coefficients of f^((p−1)/2), modulo p

    2k·f_0·c_k = Σ_{i=1…d} (i − 2k) f_i c_(k−i),

a recurrence whose coefficients do not depend on p. So the *window* at k, (c_(k−d+1), …, c_k)·(2f_0)^k·k!/c_0, is the
product of the integer matrices M(k) ⋯ M(1) of the recurrence and (0, …, 0, 1) (Harvey and Sutherland 2014, 2016). The
integers up to the largest prime are divided into blocks. For each block its window, that at its first integer, is
computed modulo the product of the primes in the block.

Eight blocks form a product tree of their matrices. These products and the window at the beginning of the tree give the
windows of its blocks, and the window at the beginning of the next tree, modulo the primes of all later trees.
For each p the window is then advanced from the beginning of the block to p, modulo p (:mod:`jacobian.arithmetic.walk`);
this is faster than smaller blocks.

Integers and matrices are those of FLINT (python-flint). FLINT multiplies matrices of 5 rows with entries of 640 kbit in
the time of 91 products of such integers (``python -m benchmarks l_polynomials``).
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import pairwise
from operator import mul
from typing import Any, NamedTuple

from flint import fmpz, fmpz_mat, fmpz_poly

BLOCK = 1 << 14
"""The number of integers in a block. Smaller blocks make the trees slower, larger ones the walks."""
WALKED_TO = 1 << 18
"""If no prime exceeds this, one block without a tree is as fast (``python -m benchmarks l_polynomials``)."""
TREE = 8
"""The number of blocks in a tree. More blocks take more memory; fewer blocks mean more trees, each of which computes a
window modulo all later primes.
"""
STEPS = 16
"""The number of matrices M(k + 1), M(k + 2), … whose product is computed as polynomials in k. For each block one matrix
product evaluates these polynomials at every STEPS-th k.
"""


class Block(NamedTuple):
    """The primes p with begin < p ≤ end, as indices ``first`` … ``last`` − 1 of the list of all primes."""

    begin: int
    first: int
    last: int


def blocks_of(primes: Sequence[int], size: int) -> list[Block]:
    """All blocks of ``size`` integers up to the last prime, in order, including blocks without primes."""
    begins = range(0, primes[-1], size)
    ends = pairwise([0, *(bisect_right(primes, begin + size) for begin in begins)])
    return [Block(begin, first, last) for begin, (first, last) in zip(begins, ends, strict=True)]


class Tree(NamedTuple):
    """The results of a tree of blocks. ``windows`` has the window of coefficients at the beginning of each block,
    modulo the product of its primes; ``behind`` that at the end of the last block, modulo the product of later primes.
    """

    windows: list[list[Any]]
    behind: list[Any]


def trees(
    f: Sequence[int], primes: Sequence[int], blocks: list[Block], window: list[Any] | None = None
) -> Iterator[Tree]:
    """Yields a :class:`Tree` for every TREE of the ``blocks``, which have one size, a multiple of STEPS.

    If the first block does not begin at 0, a tree must begin there, and ``window`` is the window at that integer.
    """
    d = len(f) - 1
    size = blocks[1].begin - blocks[0].begin if len(blocks) > 1 else 0
    first = _first_products(f)
    moduli = [_product([fmpz(p) for p in primes[block.first : block.last]]) for block in blocks]
    rest = _product(moduli)
    window = window or [fmpz(0)] * (d - 1) + [fmpz(1)]
    for start in range(0, len(blocks), TREE):
        part = moduli[start : start + TREE]
        # the product of the last block is needed only for later trees
        last = start + TREE >= len(blocks)
        matrices = [_block(first, d, block.begin, size) for block in blocks[start : start + len(part) - last]]
        products, modules = _levels(matrices, _times), _levels(part, mul)
        found = _down(products, modules, [c % modules[-1][0] for c in window])
        rest //= modules[-1][0]
        window = [] if last else _applied(products[-1][0], window, rest)
        yield Tree(found, window)


def _first_products(f: Sequence[int]) -> list[list[fmpz_poly]]:
    """The entries of M(k + STEPS) ⋯ M(k + 1), with the matrices M of the recurrence, as polynomials in k."""
    d = len(f) - 1
    total = [[fmpz_poly([int(i == j)]) for j in range(d)] for i in range(d)]
    for step in range(1, STEPS + 1):
        row = [fmpz_poly([(i - 2 * step) * f[i], -2 * f[i]]) for i in range(d, 0, -1)]
        last = [sum((a * total[i][j] for i, a in enumerate(row)), fmpz_poly([])) for j in range(d)]
        below = fmpz_poly([2 * step * f[0], 2 * f[0]])
        total = [[below * c for c in line] for line in total[1:]] + [last]
    return total


def _block(first: list[list[fmpz_poly]], d: int, begin: int, size: int) -> fmpz_mat:
    """M(begin + size) ⋯ M(begin + 1), from the polynomials of :func:`_first_products`."""
    coefficients = fmpz_mat([[c[i] for i in range(STEPS + 1)] for line in first for c in line])
    starts = range(begin, begin + size, STEPS)
    values = coefficients * fmpz_mat([[fmpz(k) ** i for k in starts] for i in range(STEPS + 1)])
    columns = values.transpose().entries()
    entries = d * d
    products = [fmpz_mat(d, d, columns[at : at + entries]) for at in range(0, len(columns), entries)]
    return _levels(products, _times)[-1][0]


def _times(first: fmpz_mat, second: fmpz_mat) -> fmpz_mat:
    return second * first


def _levels(leaves: list[Any], join: Any) -> list[list[Any]]:
    """The levels of a product tree, from leaves to root; the last of an odd number of nodes moves up unchanged."""
    levels = [leaves]
    while len(levels[-1]) > 1:
        below = levels[-1]
        above = [join(below[i], below[i + 1]) for i in range(0, len(below) - 1, 2)]
        levels.append(above + below[len(below) - len(below) % 2 :])
    return levels


def _product(factors: list[Any]) -> Any:
    return _levels(factors, mul)[-1][0] if factors else fmpz(1)


def _applied(matrix: fmpz_mat, window: list[Any], modulus: Any) -> list[Any]:
    column = matrix * fmpz_mat(len(window), 1, window)
    return [c % modulus for c in column.entries()]


def _down(products: list[list[fmpz_mat]], modules: list[list[Any]], window: list[Any]) -> list[list[Any]]:
    """The windows (module docstring) at the beginnings of all blocks of a tree, each modulo the product of the block's
    primes, from the ``window`` at the beginning of the tree.
    """
    above = [window]
    for level in range(len(modules) - 2, -1, -1):
        here = []
        for i, modulus in enumerate(modules[level]):
            carried = above[i // 2]
            if i % 2 == 0:
                here.append([c % modulus for c in carried])
            else:
                here.append(_applied(products[level][i - 1], carried, modulus))
        above = here
    return above
