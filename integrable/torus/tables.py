"""The tables of a torus, on bare reals, compiled or interpreted: translations near the identity, and rows of points."""

from __future__ import annotations

from math import floor, log2
from typing import Any, NamedTuple

from integrable.moving_point.addition import Real, Row, moving_point, near_identity, put
from integrable.moving_point.translations import power_series
from integrable.torus.survey import about_centre
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root


class TableRoom(NamedTuple):
    """Working memory: two power series, nine numbers, and moving points, one for each node and two more."""

    series: Row
    roots: Row
    numbers: Row
    points: Row


class NearIdentity(NamedTuple):
    """The arguments of :func:`integrable.moving_point.addition.near_identity` other than eps, about a centre and in a
    unit.
    """

    series: Row
    roots: Row
    f0: Real
    axes: Row
    passes: int
    unit: float


class SmallSteps(NamedTuple):
    """Translations inside a cell: ``axes`` are those of κ = 1, ``tables`` those of :func:`directions`, 4·``terms``
    numbers for either centre. ``parts`` is (p, q, r, s): the translation by (a, b) in periods is that by pa + qb and ra
    + sb in units of the reaches of the two centres.
    """

    axes: Row
    centres: tuple[float, float]
    tables: Row
    terms: int
    parts: Row


def small_in_tuples(small: SmallSteps) -> SmallSteps:
    """The steps with tuples for rows, whose numbers compiled loops then hold in registers."""
    return SmallSteps(eight(small.axes), small.centres, small.tables, small.terms, four(small.parts))


def four(row: Row) -> tuple[Real, ...]:
    """The first four numbers of a row."""
    return row[0], row[1], row[2], row[3]


def six(row: Row) -> tuple[Real, ...]:
    """The first six numbers of a row."""
    return row[0], row[1], row[2], row[3], row[4], row[5]


def eight(row: Row) -> tuple[Real, ...]:
    """The first eight numbers of a row."""
    return row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7]


def directions(
    motion: Row, chart: Any, parts: Row, nodes: Row, passes: int, room: TableRoom, tables: Row, halves: Row
) -> None:
    """Writes polynomials of T(s) about either centre, |s| ≤ reach, one after the other to ``tables``. ``halves``
    receives the translations by half a cell in either direction, both parts of the first, then of the second.

    With x = s/reach and z = x² the points of T are c + m ± √r, m = z·p(z), r = z·q(z), and V' = (x − c)·t(z)/x + x·v(z)
    about the centre c. The polynomials are p, q, t, v in this order, from their values at ``nodes`` of z. ``motion`` is
    as for :func:`integrable.torus.survey.survey`, ``chart`` a :class:`~integrable.torus.lattice.Chart`; ``passes`` is
    the number of Newton steps.
    """
    size, points = len(nodes), room.points
    for k in range(2):
        centre, first = chart.centres[k], 4 * len(nodes) * k
        about = expansion_about(motion, centre, room, passes)
        unit, reach = about.unit, chart.reaches[k] / about.unit + 0 * about.f0
        # the halves are computed together with the nodes, to fill the last SIMD lanes
        for n in abreast(0, size + 2):
            beyond = max(0, n - size)
            x = root(nodes[min(n, size - 1)] + 0 * reach)
            if n >= size:
                x = parts[2 * k + beyond] * (0.5 / chart.cells[beyond])
            put(near_centre(about, reach * x), points, 10 * n)
        for n in abreast(0, size):
            step, x, place = moving_point(points, 10 * n), root(nodes[n] + 0 * reach), first + n
            m = -step[1] / 2
            tables[place] = m * unit / nodes[n]
            tables[place + size] = (m * m - step[0]) * (unit * unit) / nodes[n]
            tables[place + 2 * size] = step[3] / unit * x
            tables[place + 3 * size] = step[2] / x
        for n in range(2):
            step = moving_point(points, 10 * (size + n))
            put(recentred(step, about.axes, centre, unit), halves, 20 * n + 10 * k)
    for part in abreast(0, 8):
        to_powers(nodes, tables, size * part)


def expansion_about(motion: Row, centre: Real, room: TableRoom, passes: int) -> NearIdentity:
    """The expansion about a centre, with as many terms as ``room`` holds. Its unit is a power of 2 near the distance to
    the nearest branch point, so that powers stay in the range of floats and products do not round.
    """
    place = float(centre)
    near = abs(float(motion[7]) - place)
    for i in range(3):
        near = min(near, abs(float(motion[4 + i]) - place))
    if motion[8] > 0:
        near = min(near, abs(float(motion[10] / motion[8]) - place))
    unit, numbers = 2.0 ** floor(log2(near)), room.numbers
    about_centre(motion, centre, unit, numbers)
    power_series(numbers, -1, room.series)
    power_series(numbers, 1, room.roots)
    return NearIdentity(room.series, room.roots, numbers[0], (numbers[6], numbers[7], numbers[8]), passes, unit)


def near_centre(about: NearIdentity, eps: Real) -> Row:
    """T(eps) in the abscissa of an expansion."""
    return near_identity(about.series, about.roots, about.f0, about.axes, eps, about.passes)


def recentred(step: Row, axes: Row, centre: Real, unit: float) -> Row:
    """A translation in x from one in (x − centre)/unit; ``axes`` begins with the α_i in that variable.

    Each σ_i gets the sign of α_i − centre: near the identity it is about α_i − centre, for any centre.
    """
    unit1, unit2, unit3 = signed_like(axes[0], unit), signed_like(axes[1], unit), signed_like(axes[2], unit)
    u0, u1, v0, v1 = step[0] * unit * unit, step[1] * unit, step[2], step[3] / unit
    return (
        u0 - u1 * centre + (0 * u0 + centre) * centre,
        u1 - 2 * centre,
        v0 - v1 * centre,
        v1,
        step[4] * unit1,
        step[5] * unit2,
        step[6] * unit3,
        step[7] / unit1,
        step[8] / unit2,
        step[9] / unit3,
    )


def signed_like(x: Real, size: Real) -> Real:
    """``size`` with the sign of x."""
    return -size if x < 0 else size


def to_powers(nodes: Row, table: Row, first: int) -> None:
    """Replaces values at the nodes, in ``table`` from ``first`` on, by their polynomial's coefficients, ascending."""
    size = len(nodes)
    # divided differences give Newton's form, which is then expanded in powers of z
    for k in range(1, size):
        for n in range(size - 1, k - 1, -1):
            table[first + n] = (table[first + n] - table[first + n - 1]) / (nodes[n] - nodes[n - k])
    for k in range(size - 2, -1, -1):
        for n in range(k, size - 1):
            table[first + n] = table[first + n] - nodes[k] * table[first + n + 1]


def small_translation(small: SmallSteps, k: int, x: Real) -> Row:
    """T(x·reach) in the direction of the centre ``k``, as a moving point with κ = 1."""
    axes, centre, table, size = small.axes, small.centres[k], small.tables, small.terms
    z = x * x
    n = (4 * k + 1) * size - 1
    m, r, t, v = table[n], table[n + size], table[n + 2 * size], table[n + 3 * size]
    for _ in range(size - 1):
        n -= 1
        m = m * z + table[n]
        r = r * z + table[n + size]
        t = t * z + table[n + 2 * size]
        v = v * z + table[n + 3 * size]
    m, r, t1, t0 = m * z, r * z, t / x, v * x
    a1, a2, a3 = axes[0] - centre, axes[1] - centre, axes[2] - centre
    x1, x2, x3 = a1 - m, a2 - m, a3 - m
    # near the identity σ_i is α_i − c, whose sign is that of ``a1``, ``a2`` or ``a3``
    r1, r2, r3 = (
        signed_like(a1, root(x1 * x1 - r)),
        signed_like(a2, root(x2 * x2 - r)),
        signed_like(a3, root(x3 * x3 - r)),
    )
    middle = m + centre
    return (
        middle * middle - r,
        -2 * middle,
        t0 - t1 * centre,
        t1,
        r1,
        r2,
        r3,
        (t0 + t1 * a1) / r1,
        (t0 + t1 * a2) / r2,
        (t0 + t1 * a3) / r3,
    )
