"""Survey of a real torus before the walks, on bare reals, compiled or interpreted.

It finds the chart of two centres with the fewest cells, its periods, and the power series about a centre. Numbers are
floats, mpf or bare reals, or double-doubles when compiled (:mod:`integrable.torus.compiled`); the choice of a chart is
in floats.
"""

from __future__ import annotations

from math import floor, sqrt

from integrable.moving_point.addition import Real, Row
from integrable.moving_point.elliptic_integrals import mean_slowness, oval_periods
from integrable.moving_point.problem import MATRIX, MOMENTUM, SLOWNESS, TIME_SCALE

# the two points of a translation, complex conjugates, stay within this fraction of the distance from its centre to the
# next branch point
REACH = 0.4
# a torus that needs more cells counts as not compact
MOST_CELLS = 1 << 16
# the number of candidate centres. Their distances from the least branch point are in geometric progression up to
# FARTHEST·max a, but at most REMOTE times the length of the ovals, because seen from farther away the α would coincide
CENTRES = 12
FARTHEST = 2.0
REMOTE = 1e4
# more than FEW_CELLS cells are needed if branch points are close together and far from all centres, as for a heavy ball
# with one large moment. Then INNER centres from either end of a gap are tried too, the first at half the least distance
# of two branch points
FEW_CELLS = 1 << 11
INNER = 8
# the least distance of a centre from the end of a gap, relative to the length of the ovals: at distance 2^−k from a
# branch point translations lose 2k bits, and double-doubles can spare 60
NEAREST = 2.0**-30
# at this distance almost no digits are lost. It replaces NEAREST unless the centres below all branch points need more
# than MANY_CELLS cells
FAIR = 2.0**-12
MANY_CELLS = 1 << 12
# below this d·max a one period is nearly the residue at infinity
FLAT = 0.01
# the number of results of :func:`surveyed_rates`
RATES = 16


def best_chart(
    points: Row, ends: Row, origin: float, lead: float, periods: Row
) -> tuple[float, float, float, float, int, int, int, int, int, int]:
    """(c₁, c₂, reach₁, reach₂, m₁, n₁, m₂, n₂, rows, columns): the centres with the fewest cells, the largest s for
    either, the integer rows (m, n) of a reduced basis in the given periods (a₁, b₁, a₂, b₂), and the cells.

    ``points`` are the branch points and ``ends`` those of the ovals, all minus ``origin``; ``lead`` is the leading
    coefficient of f.
    """
    # at d = 0 one period is the residue of x dx/y, and a translation by a fraction of it has its points at infinity. It
    # becomes the second period, because only steps along that one can include a cell of the other (``step_over``)
    flat = len(points) == 4 or lead < FLAT
    fewest = 1 << 60
    best = (0.0, 0.0, 0.0, 0.0, 1, 0, 0, 1, 0, 0)
    tried, nearest = 0, FAIR
    for count in (CENTRES, CENTRES + 4 * INNER):
        for i in range(tried, count):
            c1 = centre_of(i, points, ends, origin, nearest)
            reach1 = reach_of(points, lead, c1)
            for j in range(i):
                c2 = centre_of(j, points, ends, origin, nearest)
                reach2 = reach_of(points, lead, c2)
                if reach1 == 0 or reach2 == 0 or c1 == c2:
                    continue
                s1, t1 = split_by(c1, c2, periods[0], periods[1])
                s2, t2 = split_by(c1, c2, periods[2], periods[3])
                s1, t1, s2, t2 = s1 / reach1, t1 / reach2, s2 / reach1, t2 / reach2
                m1, n1, m2, n2 = reduced(s1, t1, s2, t2)
                if flat and abs(m1 * periods[0] + n1 * periods[2]) < abs(m2 * periods[0] + n2 * periods[2]):
                    m1, n1, m2, n2 = m2, n2, m1, n1
                rows, columns = cells(m1 * s1 + n1 * s2, m1 * t1 + n1 * t2, m2 * s1 + n2 * s2, m2 * t1 + n2 * t2)
                if rows * columns < fewest:
                    fewest = rows * columns
                    best = (c1, c2, reach1, reach2, m1, n1, m2, n2, rows, columns)
        tried = count
        if fewest <= FEW_CELLS:
            break
        if fewest > MANY_CELLS:
            nearest = NEAREST
    return best


def centre_of(i: int, points: Row, ends: Row, origin: float, nearest: float) -> float:
    """The i-th candidate for a centre.

    Candidates are below all branch points, then in the gap between the ovals, from its lower end to its middle and from
    near its upper end, then in the gap behind the second oval. Distances from ends of gaps are ≥ ``nearest``·spread.
    """
    least, low, high = points[0], float(ends[0]), float(ends[3])
    near = spread = high - low
    for k in range(len(points)):
        least = min(least, points[k])
        for j in range(k):
            near = min(near, abs(points[k] - points[j]))
    farthest = min(FARTHEST * (high + origin), REMOTE * spread)
    if i < CENTRES:
        nearest = min(least + origin, spread) / 4
        return least - nearest * (farthest / nearest) ** (i / (CENTRES - 1))
    end, k = (i - CENTRES) // INNER, (i - CENTRES) % INNER
    first, last = float(ends[1]), float(ends[2])
    if end > 1:
        first, last = high, points[4] if len(points) > 4 else high + 2 * farthest
    middle = (last - first) / 2
    near = max(min(near, middle) / 2, nearest * spread)
    if near > middle:
        return first
    if end % 2 == 0:
        return first + near * (middle / near) ** (k / (INNER - 1))
    return last - near * (middle / near) ** (k / INNER)


def reach_of(points: Row, lead: float, centre: float) -> float:
    """The largest s of T(s, centre·s); 0 where f is not negative. f is computed from its roots, because near them the
    terms of the polynomial cancel.
    """
    value, near = lead, abs(points[0] - centre)
    for e in points:
        value *= e - centre
        near = min(near, abs(e - centre))
    # ``value`` is −f(centre); with d = 0 f has only four roots, and its ``lead`` is 1
    return 2 * REACH * near / sqrt(value) if value > 0 else 0.0


def split_by(c1: Real, c2: Real, a: Real, b: Real) -> tuple[Real, Real]:
    """(s₁, s₂) with (a, b) = s₁(1, c₁) + s₂(1, c₂)."""
    second = (b - c1 * a) / (c2 - c1)
    return a - second, second


def reduced(s1: float, t1: float, s2: float, t2: float) -> tuple[int, int, int, int]:
    """Integer rows (m₁, n₁), (m₂, n₂) of a basis of two short vectors (Lagrange 1773)."""
    m1, n1, m2, n2 = 1, 0, 0, 1
    for _ in range(200):
        if s1 * s1 + t1 * t1 > s2 * s2 + t2 * t2:
            s1, t1, s2, t2 = s2, t2, s1, t1
            m1, n1, m2, n2 = m2, n2, m1, n1
        square = s1 * s1 + t1 * t1
        if square == 0:
            # the periods are parallel in floats: any basis is correct, and the given one shows how many cells it needs
            return 1, 0, 0, 1
        turns = floor((s1 * s2 + t1 * t2) / square + 0.5)
        if turns == 0:
            break
        s2, t2 = s2 - turns * s1, t2 - turns * t1
        m2, n2 = m2 - turns * m1, n2 - turns * n1
    return m1, n1, m2, n2


def cells(s1: float, t1: float, s2: float, t2: float) -> tuple[int, int]:
    """The least numbers of cells, powers of 2 in either direction, for which half a cell is within both reaches."""
    s1, t1, s2, t2 = abs(s1) / 2, abs(t1) / 2, abs(s2) / 2, abs(t2) / 2
    best1, best2, first = 1 << 29, 1 << 29, 2
    while first <= MOST_CELLS:
        # what remains of either reach after half a cell in the first direction
        left_s, left_t = 1 - s1 / first, 1 - t1 / first
        if left_s > 0 and left_t > 0:
            second = 2
            while second <= MOST_CELLS and (s2 / second > left_s or t2 / second > left_t):
                second *= 2
            if first * second < best1 * best2:
                best1, best2 = first, second
        first *= 2
    return best1, best2


def survey(
    motion: Row, near: float, points: Row, out: Row
) -> tuple[float, float, float, float, int, int, int, int, int, int]:
    """Returns :func:`best_chart` of a motion, and fills ``out``.

    ``out`` gets the basis Λ₁, Λ₂ (four numbers) and its frequencies ν₁, ν₂. Then follow s₁ of Λ₁ and Λ₂ over the first
    reach, s₂ of Λ₁ and Λ₂ over the second, and :func:`mean_slowness`.

    ``motion`` holds the ends of both ovals, α1, α2, α3, ζ, d, π, r and the origin x₀. x₀ is subtracted from all
    abscissae, so the last factor of f is r − dx with r = 1 − dx₀. ``points`` is memory for floats, as many as there are
    branch points (four where d = 0); ``near`` as for :func:`oval_periods`.
    """
    ends, d, pi, r = (motion[0], motion[1], motion[2], motion[3]), motion[8], motion[9], motion[10]
    oval_periods(ends, d, r, pi, near, out)
    for k in range(4):
        points[k] = float(motion[4 + k])
    lead = 1.0
    if len(points) > 4:
        points[4], lead = float(r / d), float(d)
    periods = (float(out[0]), float(out[1]), float(out[2]), float(out[3]))
    chart = best_chart(points, ends, float(motion[11]), lead, periods)
    c1, c2, reach1, reach2, m1, n1, m2, n2, _, _ = chart
    a1, b1 = m1 * out[0] + n1 * out[2], m1 * out[1] + n1 * out[3]
    a2, b2 = m2 * out[0] + n2 * out[2], m2 * out[1] + n2 * out[3]
    determinant = a1 * b2 - b1 * a2
    out[0], out[1], out[2], out[3] = a1, b1, a2, b2
    # (1, −x₀) is the direction of the flow
    out[4], out[5] = (b2 + motion[11] * a2) / determinant, -(b1 + motion[11] * a1) / determinant
    # the centres are exact floats; the term 0·a₁ gives the gap the digits of the periods
    gap = c2 + 0 * a1 - c1
    second1, second2 = (b1 - c1 * a1) / gap, (b2 - c1 * a2) / gap
    out[6], out[7] = (a1 - second1) / reach1, (a2 - second2) / reach1
    out[8], out[9] = second1 / reach2, second2 / reach2
    out[10] = mean_slowness(ends, d, r, pi, near, determinant)
    return chart


def surveyed_rates(
    problem: Row, found: Row, motion: Row, units: tuple[float, float], doubled: tuple[int, int], out: Row
) -> None:
    """Writes numbers of a :func:`survey` in the user's units, in this order:

    - the matrix of a :class:`~integrable.torus.states.Torus` (four numbers)
    - the turns of both phases per unit of t, then per unit of τ
    - the means of dτ/dt and of dt/dτ
    - the turns of both ``doubled`` periods per unit of τ, dt/dτ again, 2π
    - Σ∫dξ/η and Σ∫ξ dξ/η per unit of τ

    ``problem`` is a :func:`~integrable.moving_point.problem.problem_row`, ``motion`` as for :func:`survey`, ``units``
    the length and the lift of those of the survey.
    """
    length, lift = units
    momentum, scale = problem[MOMENTUM] * lift, problem[TIME_SCALE] * (length * lift)
    mean = problem[SLOWNESS] * found[10] / (lift * lift)
    nu1, nu2 = found[4] * scale, found[5] * scale
    out[0], out[1] = problem[MATRIX], problem[MATRIX + 1] * momentum
    out[2], out[3] = problem[MATRIX + 2], problem[MATRIX + 3] * momentum
    out[4], out[5], out[6], out[7], out[8], out[9] = nu1 / mean, nu2 / mean, nu1, nu2, 1 / mean, mean
    out[10], out[11], out[12], out[13] = nu1 / doubled[0], nu2 / doubled[1], mean, 2 * motion[9]
    out[14], out[15] = scale, -(motion[11] * scale)


def about_centre(motion: Row, centre: Real, unit: float, out: Row) -> None:
    """Writes f = (x − ζ)·Π(α_i − x)·(r − dx) in powers of (x − centre)/unit to out[0 … 5], and (α_i − centre)/unit to
    out[6 … 8]. f is expanded from its roots, near which its coefficients about 0 would cancel. ``motion`` is as for
    :func:`survey`.
    """
    d = motion[8]
    out[0], out[1] = centre - motion[7], unit + 0 * d
    for k in range(2, 6):
        out[k] = 0 * d
    for i in range(4):
        constant, slope = motion[10] - d * centre, -d * unit
        if i < 3:
            constant, slope = motion[4 + i] - centre, -unit + 0 * d
            out[6 + i] = constant / unit
        for k in range(i + 2, 0, -1):
            out[k] = constant * out[k] + slope * out[k - 1]
        out[0] = constant * out[0]
