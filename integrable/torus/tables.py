"""The tables of a torus, on bare reals, compiled or interpreted: translations near the identity, and rows of points."""

from __future__ import annotations

from math import floor, log2
from typing import Any, NamedTuple

from integrable.moving_point.addition import Real, Row, put
from integrable.moving_point.translations import Expansion, expand_orders, expansion_of, near_identity, with_pairs
from integrable.torus.survey import about_centre
from jacobian.numbers.abreast import abreast


class TableRoom(NamedTuple):
    """Working memory: the expansions about two centres, seven numbers for each of their orders, and nine numbers."""

    first: Row
    second: Row
    numbers: Row


class AboutCentre(NamedTuple):
    """Translations near the identity about a centre: ``rows`` are the coefficients of T(eps) as power series in eps²,
    ``axes`` the abscissae α1, α2, α3, in (x − centre)/``unit`` and y/``height``.
    """

    rows: Expansion
    axes: Row
    unit: float
    height: float


class SmallSteps(NamedTuple):
    """Translations inside a cell: ``axes`` those of κ = 1, ``tables`` those of :func:`directions`, 4·``terms`` numbers
    for either centre, ``parts`` (p, q, r, s): the translation by (a, b) in periods takes the parts pa + qb and
    ra + sb of both reaches.
    """

    axes: Row
    centres: tuple[float, float]
    tables: Row
    terms: int
    parts: Row


def small_in_tuples(small: SmallSteps) -> SmallSteps:
    """The same steps with tuples for rows: compiled loops then hold their numbers in registers."""
    return SmallSteps(eight(small.axes), small.centres, small.tables, small.terms, four(small.parts))


def four(row: Row) -> Any:
    """The first four numbers of a row."""
    return row[0], row[1], row[2], row[3]


def six(row: Row) -> Any:
    """The first six numbers of a row."""
    return row[0], row[1], row[2], row[3], row[4], row[5]


def eight(row: Row) -> Any:
    """The first eight numbers of a row."""
    return row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7]


def directions(motion: Row, chart: Any, parts: Row, least: Real, room: TableRoom, tables: Row, halves: Row) -> int:
    """Writes the power series of T(s) about either centre, |s| ≤ reach, to ``tables``, and the translations by half a
    cell in either direction to ``halves``: both parts of the first, then of the second. Returns the number of terms
    after which all are below ``least``, relative to their largest; 0 where ``room`` has too few orders for that.

    With x = s/reach, z = x² and ξ from the centre, the divisor of T is ξ² + z·p(z)ξ + z·q(z), t(z)/x·ξ + x·v(z). The
    coefficients of p, q, t, v follow one another. ``motion`` is as for :func:`integrable.torus.survey.survey`,
    ``chart`` a :class:`~integrable.torus.lattice.Chart`.
    """
    one = direction(motion, chart, parts, 0, room.first, room.numbers, halves)
    other = direction(motion, chart, parts, 1, room.second, room.numbers, halves)
    terms = max(terms_above(one, least), terms_above(other, least))
    if terms > len(one.u0) - 2:
        return 0
    put_series(one, tables, 0, terms)
    put_series(other, tables, 4 * terms, terms)
    return terms


def direction(motion: Row, chart: Any, parts: Row, k: int, row: Row, numbers: Row, halves: Row) -> Expansion:
    """The expansion about the centre ``k`` in x = s/reach, and in the unit of ``motion``; writes its ``halves``."""
    centre = chart.centres[k]
    about = expansion_about(motion, centre, row, numbers)
    rows, unit, height = about.rows, about.unit, about.height
    reach = chart.reaches[k] * (height / unit) + 0 * numbers[0]
    for n in abreast(0, 2):
        eps = reach * (parts[2 * k + n] * (0.5 / chart.cells[n]))
        step = near_identity(rows, about.axes, eps, len(rows.u0))
        put(recentred(step, centre, unit, height), halves, 20 * n + 10 * k)
    power = 1 + 0 * reach
    for n in range(len(rows.u0)):
        rows.u0[n] = rows.u0[n] * (power * (unit * unit))
        rows.u1[n] = rows.u1[n] * (power * unit)
        rows.v0[n] = rows.v0[n] * (power * (reach * height))
        rows.v1[n] = rows.v1[n] * (power * height / (reach * unit))
        power = power * reach * reach
    return rows


def terms_above(rows: Expansion, least: Real) -> int:
    """The number of terms of an expansion that are not below ``least``, relative to the largest of their row."""
    u0, u1, v0, v1, terms = 0 * rows.u0[0], 0 * rows.u0[0], 0 * rows.u0[0], 0 * rows.u0[0], 1
    for n in range(len(rows.u0)):
        u0, u1, v0, v1 = (
            max(u0, abs(rows.u0[n])),
            max(u1, abs(rows.u1[n])),
            max(v0, abs(rows.v0[n])),
            max(v1, abs(rows.v1[n])),
        )
    for n in range(len(rows.u0)):
        # u0 and u1 begin one order later; a NaN counts as large
        if not (abs(rows.u0[n]) <= least * u0 and abs(rows.u1[n]) <= least * u1):
            terms = max(terms, n)
        if not (abs(rows.v0[n]) <= least * v0 and abs(rows.v1[n]) <= least * v1):
            terms = n + 1
    return terms


def put_series(rows: Expansion, tables: Row, first: int, terms: int) -> None:
    """Writes the first terms of p, q, t and v to ``tables`` from ``first`` on."""
    for n in range(terms):
        tables[first + n], tables[first + terms + n] = rows.u1[n + 1], rows.u0[n + 1]
        tables[first + 2 * terms + n], tables[first + 3 * terms + n] = rows.v1[n], rows.v0[n]


def expansion_about(motion: Row, centre: Real, row: Row, numbers: Row) -> AboutCentre:
    """The expansion about a centre in ``row``, with as many orders as that holds; f and the axes, in its unit, go to
    ``numbers``. The units are powers of 2 near the distance to the nearest branch point and near |y| at the centre, so
    that powers stay in the range of floats and products do not round.
    """
    place = float(centre)
    near = abs(float(motion[7]) - place)
    for i in range(3):
        near = min(near, abs(float(motion[4 + i]) - place))
    if motion[8] > 0:
        near = min(near, abs(float(motion[10] / motion[8]) - place))
    unit, rows = 2.0 ** floor(log2(near)), expansion_of(row)
    about_centre(motion, centre, unit, numbers)
    height = 2.0 ** floor(log2(-float(numbers[0])) / 2)
    for k in range(6):
        numbers[k] = numbers[k] / height / height
    expand_orders(six(numbers), rows, 0, len(rows.u0))
    return AboutCentre(rows, (numbers[6], numbers[7], numbers[8]), unit, height)


def recentred(step: Row, centre: Real, unit: float, height: float) -> Row:
    """A translation in x and y from one in (x − centre)/unit and y/height."""
    u0, u1, v0, v1 = step[0] * unit * unit, step[1] * unit, step[2] * height, step[3] * (height / unit)
    lift = height / unit
    return (
        u0 - u1 * centre + (0 * u0 + centre) * centre, u1 - 2 * centre, v0 - v1 * centre, v1,
        step[4] * unit, step[5] * unit, step[6] * unit, step[7] * lift, step[8] * lift, step[9] * lift,
    )  # fmt: skip


def small_translation(small: SmallSteps, k: int, x: Real) -> Row:
    """T(x·reach) in the direction of the centre ``k``, as a moving point with κ = 1."""
    axes, centre, table, size = small.axes, small.centres[k], small.tables, small.terms
    z = x * x
    n = (4 * k + 1) * size - 1
    u1, u0, t, v = table[n], table[n + size], table[n + 2 * size], table[n + 3 * size]
    for _ in range(size - 1):
        n -= 1
        u1 = u1 * z + table[n]
        u0 = u0 * z + table[n + size]
        t = t * z + table[n + 2 * size]
        v = v * z + table[n + 3 * size]
    around = axes[0] - centre, axes[1] - centre, axes[2] - centre
    return recentred(with_pairs(around, u0 * z, u1 * z, v * x, t / x), centre, 1.0, 1.0)
