"""Iterations of a loop in lanes compared with the same iterations one after the other."""

from math import ceil, floor, frexp

import numpy as np
import pytest
from mpmath import mp

from jacobian.inexact.genus2_real import add
from jacobian.native.kinds import FLOATS, INT, INTS, WIDES, CompileError
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.numbers.double_double import pack
from jacobian.numbers.roots import negligible, root


def branches(xs, n, out, counts):
    """Conditions that hold in some lanes: branches with and without else, nested branches, conditional values, items of
    tuples.
    """
    for i in abreast(n, len(xs)):
        x, steps = xs[i], 0
        y = x
        if x < 0:
            y = -2 * x
            steps = 1
        elif x > 2:
            if n > 0:
                y, steps = root(x), 2
            else:
                steps = 3
        if x != 1:
            for k in range(2):
                y += max(x, y, 0.5) / (k + 1)
        if not 0 < x < 2:
            y += bool(steps)
        elif x in (1, 9):
            y += 2
        sign = -1.0 if early(y) == 0 else 1.0
        out[i] = sign * min(y, abs(x) - 3, 7) / (y * y + 1) - (1, 2, 5)[i % 3]
        counts[i] = steps * (i // 3 - 2) % 5 + floor(x) + ceil(y) + int(-x) + abs(i - 3)


def early(y):
    """Some lanes return before others."""
    if y < 1.5:
        return 0
    z = y - 1
    if z < 1:
        y = z
    if z < 2:
        return y
    return 1


def wide_branches(xs, y, out):
    for i in abreast(0, len(xs)):
        x = xs[i]
        total = x * y + x / 3 - i
        if total * x < 0.5 + 0 * x:
            total -= root(abs(x)) / y
        if negligible(x * 1e-60, x):
            total = total * total / x
        first, second = apart(total, x)
        out[i] = first - second


def apart(total, x):
    if float(total) > 2:
        return total, x
    return x / (1 + total * total), total


def sums(f, points, steps, out):
    """Sums of divisors, some of which are opposite, so that their sum takes another branch."""
    curve = f[0], f[1], f[2], f[3], f[4], f[5]
    for i in abreast(0, len(points) // 4):
        k = 4 * i
        first = points[k], points[k + 1], points[k + 2], points[k + 3]
        second = steps[k], steps[k + 1], steps[k + 2], steps[k + 3]
        (u0, u1, v0, v1), _ = add(curve, first, second)
        out[k], out[k + 1], out[k + 2], out[k + 3] = u0, u1, v0, v1


LOOPS = Library(
    "test_abreast",
    {
        "branches": (branches, (FLOATS, INT, FLOATS, INTS)),
        "wide_branches": (wide_branches, (WIDES, INT, WIDES)),
        "sums": (sums, (WIDES, WIDES, WIDES, WIDES)),
    },
    SPECIAL,
)


@pytest.mark.parametrize("count", [0, 1, 3, 8, 9, 21])
@pytest.mark.parametrize("n", [0, 2])
def test_branches_of_some_lanes(count, n):
    rng = np.random.default_rng(count)
    xs = rng.choice([-1.5, 0.25, 1.0, 1.25, 2.5, 9.0], count)
    out, counts = np.full(count, -100.0), np.full(count, -100)
    found = out.copy(), counts.copy()
    branches(xs.tolist(), n, out, counts)
    LOOPS.branches(xs, n, *found)
    # iterations before n are not touched
    assert found[0].tolist() == pytest.approx(out.tolist(), rel=1e-15)
    assert found[1].tolist() == counts.tolist()


def exactly(numbers):
    """Double-doubles as numbers of the current precision."""
    return [mp.mpf(high) + mp.mpf(low) for high, low in numbers.tolist()]


def test_double_doubles_of_some_lanes():
    found, out = np.zeros((19, 2)), [0] * 19
    with mp.workdps(40):
        xs = pack([mp.mpf(k) / 7 - 1.001 for k in range(19)])
        wide_branches(exactly(xs), 3, out)
        LOOPS.wide_branches(xs, 3, found)
        assert all(abs(x - true) <= 1e-29 * (1 + abs(true)) for x, true in zip(exactly(found), out, strict=True))


def test_additions_of_divisors():
    """Every fourth sum is of nearly opposite divisors: each lane follows its own branch."""

    def divisor(x1, x2, sign):
        y1, y2 = (sign * mp.sqrt(((x**3 + 3) * x + 1) * x + 10) for x in (x1, x2))
        slope = (y2 - y1) / (x2 - x1)
        return x1 * x2, -x1 - x2, y1 - slope * x1, slope

    rng = np.random.default_rng(5)
    with mp.workdps(40):
        f, points, steps = [mp.mpf(x) for x in (10, 1, 3, 0, 1, 0)], [], []
        for k in range(21):
            x1, x2, x3, x4 = map(mp.mpf, rng.uniform(0.1, 2, 4))
            points += divisor(x1, x2, 1)
            steps += divisor(x1 + 1e-9, x2 - 2e-9, -1) if k % 4 == 0 else divisor(x3, x4, 1)
        rows = [pack(row) for row in (f, points, steps)]
        found, out = np.zeros((84, 2)), [0] * 84
        LOOPS.sums(*rows, found)
        sums(*map(exactly, rows), out)
        assert all(abs(x - true) <= 1e-12 * (1 + abs(true)) for x, true in zip(exactly(found), out, strict=True))
        plain = [k for k in range(84) if k // 4 % 4]
        found, out = exactly(found[plain]), [out[k] for k in plain]
        assert all(abs(x - true) <= 1e-24 * (1 + abs(true)) for x, true in zip(found, out, strict=True))


# --- what is not compiled


def leaves_a_loop(xs):
    for i in abreast(0, len(xs)):
        for _ in range(3):
            if xs[i] > 0:
                break


def returns_from_a_loop(xs):
    for i in abreast(0, len(xs)):
        xs[i] = ends_in_a_loop(xs[i])


def ends_in_a_loop(x):
    for _ in range(3):
        if x > 0:
            return x
        x += 1
    return x


def has_both_kinds(xs):
    total = 0.0
    for i in abreast(0, len(xs)):
        total = (xs, xs[i])
    return total


def repeats(xs):
    for i in abreast(0, len(xs)):
        x = xs[i]
        while x > 0:
            x -= 1


def takes_one_number(xs):
    for i in abreast(0, len(xs)):
        xs[i], _ = frexp(xs[i])


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (takes_one_number, "float abreast"),
        (leaves_a_loop, "some lanes leave a round of a loop"),
        (returns_from_a_loop, "some lanes return in a loop"),
        (has_both_kinds, "in one variable"),
        (repeats, "a condition that differs from lane to lane"),
    ],
)
def test_what_is_refused(function, words):
    library = Library("test_refused_abreast", {"loop": (function, (FLOATS,))}, SPECIAL)
    with pytest.raises(CompileError, match=words):
        library.loop(np.ones(3))
