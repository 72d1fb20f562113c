"""Misprints of the paper: for each the printed formula fails and the corrected one holds, exactly (docs/errata.md).

Items 1–15, 23–28 and 31 of docs/errata.md; 16–22 and 29 are in test_errata_deformations.py.
"""

from __future__ import annotations

import re
from pathlib import Path
from random import Random

from integrable.phase import separation, sphere
from integrable.phase.brackets import canonical_matrix, differential, image_brackets, jacobian_matrix, over, pushed
from integrable.phase.jets import JetField
from integrable.phase.separation import Separated
from jacobian import poly
from tests.integrable.exact_points import (
    CYCLIC,
    attempt,
    dot,
    evaluate,
    over_fields,
    phase,
    random_case,
    tilted_phase,
    wrapped,
)


def test_every_item_of_the_page_names_a_test() -> None:
    """docs/errata.md: all items but 30 name a test that exists."""
    page = (Path(__file__).parents[2] / "docs" / "errata.md").read_text(encoding="utf-8")
    written = "".join(path.read_text(encoding="utf-8") for path in Path(__file__).parent.rglob("test_*.py"))
    rows = {int(row.split("|")[1]): row for row in page.splitlines() if re.match(r"\| \d+ \|", row)}
    assert sorted(rows) == list(range(1, 32))
    for item, row in rows.items():
        assert ("`test_" in row) == (item != 30)
    for name in re.findall(r"`(test_\w+)`", page):
        assert f"def {name}(" in written


class Case:
    """A ball's state with (u, p) in the field; all numbers have operators."""

    def __init__(self, K, seed, kind="ball") -> None:
        rng = Random(seed)

        def make():
            system, state = random_case(K, rng, kind)
            return system, state, system.separated(state)

        self.K = K
        self.system, self.state, self.point = attempt(make)
        self.x = phase(self.system, self.state)
        self.u, self.p = wrapped(self.system, self.point.u), wrapped(self.system, self.point.p)
        self.h1, self.h2 = self.x.H
        self.y = tuple(4 * (self.x.d * u - 1) * self.cubic(u) * p for u, p in zip(self.u, self.p, strict=True))

    def cubic(self, x):
        return (self.x.a[0] - x) * (self.x.a[1] - x) * (self.x.a[2] - x)

    def rates(self, function):
        """d/dt of function(system, state) along the motion."""
        rows = differential(self.system, function, self.state)
        rate = self.system.vector_field(self.state)
        return wrapped(self.system, [self.K.dot(row, (*rate.gamma, *rate.M)) for row in rows])

    @property
    def e(self):
        return [self.x.d / moment for moment in wrapped(self.system, self.system.inertia)]


@over_fields()
def test_item_1_the_bracket_has_the_other_sign(K) -> None:
    """chap-poi, chap-br, e3-poi: with the printed bracket, gΠdH is minus the motion."""
    for kind in ("ball", "top"):
        case = Case(K(), 1, kind)
        system, state, K_ = case.system, case.state, case.K
        (slope,) = differential(system, lambda s, y: (s.integrals(y).H1,), state)
        ours = system.poisson(state)
        printed = tuple(tuple(map(K_.neg, row)) for row in ours)
        half = K_.inv(poly.integer(K_, 2))
        g = K_.mul(half, K_.one if state.g is None else state.g)
        rate = system.vector_field(state)
        motion = (*rate.gamma, *rate.M)
        assert tuple(K_.mul(g, K_.dot(row, slope)) for row in ours) == motion
        assert tuple(K_.mul(g, K_.dot(row, slope)) for row in printed) == tuple(map(K_.neg, motion))
        # with x-Trans, the printed one does not give {u, p} = 1
        rows = differential(system, lambda s, y: _flat(s.separated(y)), state)
        assert pushed(K_, rows, ours) == canonical_matrix(K_) != pushed(K_, rows, printed)


def _flat(point):
    return (*point.u, *point.p)


@over_fields()
def test_item_2_the_sign_of_quad_2(K) -> None:
    case = Case(K(), 2)
    (u1, u2), (p1, p2), g = case.u, case.p, case.x.g
    speed = case.rates(lambda s, y: s.separated(y).u)
    printed = (
        4 * g * u2 * case.cubic(u1) * (case.x.d * u1 - 1) * p1 / (u1 - u2),
        4 * g * u1 * case.cubic(u2) * (case.x.d * u2 - 1) * p2 / (u2 - u1),
    )
    assert speed != printed
    assert speed == tuple(-x for x in printed)


@over_fields()
def test_item_3_the_quadratures_have_no_factor_4(K) -> None:
    case = Case(K(), 3)
    speed = [x / case.x.g for x in case.rates(lambda s, y: s.separated(y).u)]
    total = sum(du / y for du, y in zip(speed, case.y, strict=True))
    assert total == 1
    assert total != 4
    assert sum(u * du / y for u, du, y in zip(case.u, speed, case.y, strict=True)) == 0


@over_fields()
def test_item_3_the_quadratures_of_an_image_neither(K) -> None:
    """chap-ab2: along a motion, the images (ũ, p̃) under a step have Σdũ/ỹ = dτ, Σũ dũ/ỹ = 0."""
    K = K()
    rng = Random(30)

    def make():
        system, state = random_case(K, rng)
        step = system.translation([K.random(rng), K.random(rng)], multiple=2)
        rows = differential(system, lambda s, x: s.separated(step.over(s)(x)).u, state)
        return system, state, rows, system.separated(step(state))

    system, state, rows, image = attempt(make)
    x, rate = phase(system, state), system.vector_field(state)
    speed = [v / x.g for v in wrapped(system, [K.dot(row, (*rate.gamma, *rate.M)) for row in rows])]
    u = wrapped(system, image.u)
    y = wrapped(system, [K.mul(separation.phi(system.body, e), p) for e, p in zip(*image, strict=True)])
    total = sum(du / v for du, v in zip(speed, y, strict=True))
    assert total == 1
    assert total != 4
    assert sum(e * du / v for e, du, v in zip(u, speed, y, strict=True)) == 0


def _decomposition(x, factor, last):
    diagonal = [a + x.d * x.G * b for a, b in zip(x.a, x.B, strict=True)]
    second = [x.a[i] * (x.a[j] + x.a[k]) - x.a[j] * x.a[k] for i, j, k in CYCLIC]
    second[2] = last
    tail = factor * x.G * dot(x.gamma, x.M) * dot(x.gamma, [s * m for s, m in zip(second, x.M, strict=True)])
    return dot(diagonal, [m * m for m in x.M]) + tail


@over_fields()
def test_items_4_and_5_the_decomposition_of_H1(K) -> None:
    """The second term has a factor d, and A''_33 = a3(a1 + a2) − a1a2."""
    _, x = attempt(lambda: tilted_phase(K(), Random(4)))
    a1, a2, a3 = x.a
    right = a3 * (a1 + a2) - a1 * a2
    assert x.H[0] == _decomposition(x, x.d, right)
    assert x.H[0] != _decomposition(x, x.g / x.g, right)
    assert x.H[0] != _decomposition(x, x.d, a2 * (a1 + a2) - a1 * a2)


@over_fields()
def test_items_6_and_7_the_q_coordinates(K) -> None:
    """In the equation of q the second "=" must be "+"; the correct quad-1 is q̇² with 1 + q_l in the denominator."""
    case = Case(K(), 6)
    q = wrapped(case.system, separation.to_chaplygin(case.system.body, case.point).u)
    speed = case.rates(lambda s, y: separation.to_chaplygin(s.body, s.separated(y)).u)
    d = case.x.d
    for k, m in ((0, 1), (1, 0)):
        terms = [y * y / (q[k] - e) for y, e in zip(case.x.gamma, case.e, strict=True)]
        assert terms[0] + terms[1] + terms[2] == 0
        assert terms[0] + terms[1] != terms[2]
        product = (case.e[0] - q[k]) * (case.e[1] - q[k]) * (case.e[2] - q[k])
        product = product * (case.h2 * q[k] - d * case.h1 * (1 + q[k]))
        printed = q[m] ** 2 * (1 + q[k]) * product / (d**2 * (q[k] - q[m]))
        assert speed[k] != printed
        assert speed[k] ** 2 != printed
        assert speed[k] ** 2 == 4 * q[m] ** 2 * product / (d**2 * (1 + q[m]) * (q[k] - q[m]) ** 2)


@over_fields()
def test_item_8_g_in_the_change_of_time(K) -> None:
    """The denominator is the product of all three 1 − da_i; as printed, with a missing "(", it is not."""
    case = Case(K(), 8)
    x = case.x
    above = (1 - x.d * case.u[0]) * (1 - x.d * case.u[1])
    assert above / (x.A[0] * x.A[1] * x.A[2]) == x.G
    assert (above - x.d * x.a[0]) * x.A[1] * x.A[2] != x.G
    assert above / (x.A[1] * x.A[2]) != x.G


def _four_points(K, seed):
    """(N, f, four points of a case's curve with different abscissas)."""
    rng = Random(seed)

    def make():
        case = Case(K, rng.random())
        N = case.x.g.field
        f = wrapped(case.system, case.system.body.polynomial(case.h1.value, case.h2.value))
        new = [N.random(rng) for _ in range(2)]
        points = [*zip(case.u, case.y, strict=True), *((e, N.sqrt(evaluate(f, e))) for e in new)]
        if len({e.value for e, _ in points}) < 4:
            raise ZeroDivisionError
        return N, f, points

    return attempt(make)


@over_fields()
def test_item_9_the_cubic(K) -> None:
    """Lagrange's cubic: the denominators of y2 and y1' end in x2 − x1 and x1' − x2'."""
    _, _, points = _four_points(K(), 9)
    (x1, y1), (x2, y2), (x3, y3), (x4, y4) = points

    def cubic(x, second, third):
        return (
            (x - x4) * (x - x3) * (x - x2) * y1 / ((x1 - x3) * (x1 - x4) * (x1 - x2))
            + (x - x4) * (x - x3) * (x - x1) * y2 / ((x2 - x3) * (x2 - x4) * second)
            + (x - x4) * (x - x2) * (x - x1) * y3 / ((x3 - x1) * (x3 - x2) * third)
            + (x - x3) * (x - x2) * (x - x1) * y4 / ((x4 - x3) * (x4 - x1) * (x4 - x2))
        )

    assert [cubic(x, x2 - x1, x3 - x4) for x, _ in points] == [y for _, y in points]
    assert cubic(x2, x1 - x2, x4 - x3) != y2
    assert cubic(x3, x1 - x2, x4 - x3) != y3


@over_fields()
def test_item_10_the_cubic_meets_the_curve_in_two_more_points(K) -> None:
    """g2-y and in-div: the further points are only P''_1 and P''_2; there is no third or fourth."""
    N, f, points = _four_points(K(), 10)
    P = ()
    for i, (e, y) in enumerate(points):
        part = poly.from_roots(N, [z for k, (z, _) in enumerate(points) if k != i])
        P = poly.add(N, P, poly.scale(N, y / evaluate(part, e), part))
    rest, remainder = poly.divide(N, poly.sub(N, poly.mul(N, P, P), f), poly.from_roots(N, [e for e, _ in points]))
    assert remainder == ()
    assert len(rest) - 1 == 2


@over_fields()
def test_right_as_printed_the_abscissas_of_the_sum(K) -> None:
    """g2-x: x''_1 + x''_2 and x''_1x''_2 from the coefficients of the cubic and of f, as printed."""
    N, f, points = _four_points(K(), 31)
    P = ()
    for i, (e, y) in enumerate(points):
        part = poly.from_roots(N, [z for k, (z, _) in enumerate(points) if k != i])
        P = poly.add(N, P, poly.scale(N, y / evaluate(part, e), part))
    rest = poly.quotient(N, poly.sub(N, poly.mul(N, P, P), f), poly.from_roots(N, [e for e, _ in points]))
    image = poly.monic(N, rest)
    (_, b1, b2, b3), (x1, x2, x3, x4) = P, (e for e, _ in points)
    total = -x1 - x2 - x3 - x4 + (f[5] - 2 * b2 * b3) / (b3 * b3)
    product = (2 * b1 * b3 + b2 * b2 - f[4]) / (b3 * b3) - (x1 + x2 + x3 + x4) * total
    product = product - x1 * (x2 + x3 + x4) - x2 * (x3 + x4) - x3 * x4
    assert image == (product, -total, N.one)


@over_fields()
def test_right_as_printed_the_integrals_and_the_separation(K) -> None:
    """chap-ham-u and chap-sep-rel: H1 and H2 in (u, p), and φ(u_k)p_k² + u_kH2 − H1 = 0, as printed."""
    case = Case(K(), 32)
    (u1, u2), (p1, p2), x = case.u, case.p, case.x
    # (u − a1)(u − a2)(u − a3)
    first, second = (-4 * (x.d * u - 1) * case.cubic(u) * p * p for u, p in ((u1, p1), (u2, p2)))
    assert (u2 * first / (u1 - u2) + u1 * second / (u2 - u1), first / (u1 - u2) + second / (u2 - u1)) == x.H
    for u, p in ((u1, p1), (u2, p2)):
        assert 4 * (x.d * u - 1) * case.cubic(u) * p * p + u * case.h2 - case.h1 == 0


@over_fields()
def test_item_11_one_minus_sign(K) -> None:
    """y'' = −P and y'' = −φ(ũ)p̃ together give D̃ = −(D + D') and {ũ, p̃} = −1; with only one of them,
    D̃ = D + D'.
    """
    K = K()
    rng = Random(11)

    def make():
        system, state = random_case(K, rng)
        step = system.translation([K.random(rng), K.random(rng)], multiple=2)

        def image(N, x, sign):
            moved = over(system, N)
            point = Separated((x[0], x[1]), (x[2], x[3]))
            h1, h2 = separation.integrals(moved.body, point)
            group = moved.group(h1, h2)
            move = step.over(moved)._move(h1, h2)[1]
            total = group.from_mumford(*separation.separated_to_mumford(moved.body, point)) + group.from_mumford(
                move.u, move.v
            )
            return _flat(separation.of_mumford(moved.body, total.u, total.v if sign > 0 else poly.neg(N, total.v)))

        start = _flat(system.separated(state))
        return [jacobian_matrix(K, lambda N, x, s=s: image(N, x, s), start) for s in (1, -1)]

    right, printed = attempt(make)
    canonical = canonical_matrix(K)
    assert pushed(K, right, canonical) == canonical
    assert pushed(K, printed, canonical) == tuple(tuple(map(K.neg, row)) for row in canonical)


@over_fields()
def test_item_12_the_curve(K) -> None:
    """It is not monic of degree 2g + 2 with one P∞, but of degree 5 with leading coefficient 4dh2; at d = 0 of degree
    4, genus 1, with two P∞.
    """
    ball, top = Case(K(), 12), Case(K(), 12, "top")
    curve = ball.system.curve(ball.h1.value, ball.h2.value)
    assert (curve.genus, len(curve.f) - 1, curve.model) == (2, 5, "ramified")
    assert curve.f[-1] == (4 * ball.x.d * ball.h2).value != ball.K.one
    curve = top.system.curve(top.h1.value, top.h2.value)
    assert (curve.genus, len(curve.f) - 1) == (1, 4)
    assert curve.model in ("split", "inert")


@over_fields()
def test_items_13_and_14_what_a_step_preserves(K) -> None:
    """Proposition 1 needs a canonical D': x' = h1 + h2² is not; and quad-2 is kept in τ, not in t."""
    K = K()
    rng = Random(13)

    def make(points):
        system, state = random_case(K, rng)
        step = system.translation(points(), multiple=2)
        return system, state, step, *image_brackets(system, step, state)

    fixed = attempt(lambda: make(lambda: [K.random(rng), K.random(rng)]))
    generic = attempt(lambda: make(lambda: [K.random(rng), lambda h1, h2: h1 + h2 * h2]))
    assert fixed[3] == fixed[4]
    assert generic[3] != generic[4]
    system, state, step = fixed[:3]
    image = step(state)
    rows = differential(system, lambda s, x: (lambda y: (*y.gamma, *y.M))(step.over(s)(x)), state)
    before, after = (system.vector_field(x) for x in (state, image))
    moved = tuple(K.dot(row, (*before.gamma, *before.M)) for row in rows)
    assert moved != (*after.gamma, *after.M)
    ratio = K.div(state.g, image.g)
    assert moved == tuple(K.mul(ratio, x) for x in (*after.gamma, *after.M))


@over_fields()
def test_item_15_the_keyless_divisor_in_the_formulas_of_the_sum(K) -> None:
    """For D' = (1/d, 0) − ∞ the curve is y = V − λU, quadratic: b3 = 0 and b3² − a6 = 0 in g2-x."""
    K = K()
    rng = Random(15)
    system, state = attempt(lambda: random_case(K, rng))
    N, x = JetField(K, 0), phase(system, state)
    D = system.divisor(state)
    f = wrapped(system, D.jacobian.curve.f)
    u, v = wrapped(system, D.u), wrapped(system, D.v)
    lean = evaluate(v, 1 / x.d) / evaluate(u, 1 / x.d)
    assert lean == 2 * x.g * x.d * dot([a * y for a, y in zip(x.a, x.gamma, strict=True)], x.w)
    P = poly.sub(N, v, poly.scale(N, lean, u))
    b3 = P[3] if len(P) > 3 else N.zero
    a6 = f[6] if len(f) > 6 else N.zero
    assert b3 * b3 - a6 == 0
    rest = poly.divide(N, poly.sub(N, f, poly.mul(N, P, P)), poly.mul(N, u, (-1 / x.d, N.one)))
    assert rest[1] == ()
    assert rest[0][-1] == 4 * x.d * x.H[1]
    torsion = system.group(*system.integrals(state)[2:]).from_points([((1 / x.d).value, K.zero)])
    total = D + torsion
    assert wrapped(system, total.u) == poly.monic(N, rest[0])


# --- the sphere


def _sphere_case(K, seed):
    """(a, (u1, u2, p1, p2), image under the conic through (0, 0)) over the field."""
    rng = Random(seed)

    def make():
        values = [K.random(rng) for _ in range(7)]
        if len(set(values)) < 7 or K.zero in values:
            raise ZeroDivisionError
        a, x = tuple(values[:3]), Separated((values[3], values[4]), (values[5], values[6]))
        return a, x, sphere.conic(K, a, x, K.zero, K.zero)

    a, x, image = attempt(make)
    N = JetField(K, 0)
    wrap = lambda point: [N.constant(y) for y in _flat(point)]  # noqa: E731
    return N, a, wrap(x), wrap(image), x


def _phi(N, a, x):
    return 4 * (N.constant(a[0]) - x) * (N.constant(a[1]) - x) * (N.constant(a[2]) - x)


@over_fields()
def test_item_23_W_is_not_a_change_of_time(K) -> None:
    K = K()
    _, a, _, _, x = _sphere_case(K, 23)
    rows = jacobian_matrix(
        K, lambda N, y: sphere.sphere_integrals(N, a, Separated((y[0], y[1]), (y[2], y[3]))), _flat(x)
    )
    fields = [(h[2], h[3], K.neg(h[0]), K.neg(h[1])) for h in rows]
    u1, u2 = x.u
    in_w = [K.mul(w, s) for w, s in zip((u1, u2, u1, u2), fields[0], strict=True)]
    assert K.mul(in_w[0], fields[0][1]) != K.mul(in_w[1], fields[0][0])
    total = K.add(u1, u2)
    assert in_w == [K.add(s, K.mul(total, f)) for f, s in zip(*fields, strict=True)]


@over_fields()
def test_items_24_to_26_the_parabola(K) -> None:
    """comp-int has x'', y'' instead of x', y'; A_2, A_1 and the constant belong to (f − P²)/U; y'' = +P contradicts p̃
    = −P/φ.
    """
    N, a, (u1, u2, p1, p2), (v1, v2, q1, q2), point = _sphere_case(K(), 24)
    f1, f2 = _phi(N, a, u1), _phi(N, a, u2)
    y1, y2 = f1 * p1, f2 * p2

    def parabola(x):
        return x * ((x - u2) * y1 / ((u1 - u2) * u1) + (x - u1) * y2 / ((u2 - u1) * u2))

    for x, q in ((v1, q1), (v2, q2)):
        assert q == -parabola(x) / _phi(N, a, x)
        # with the paper's y'' = −φ(ũ)p̃
        assert -_phi(N, a, x) * q == parabola(x) != -parabola(x)
    rows = [(x * x, x, x / x, y) for x, y in ((u1, y1), (u2, y2), (v1, parabola(v1)), (v2, parabola(v2)))]
    assert _determinant(rows) == 0
    # the only P' is the plane point (0, 0); with any second point there is no relation
    rows[2:] = [(N.zero, N.zero, N.one, N.zero), (N.one, N.one, N.one, parabola(N.one) + 1)]
    assert _determinant(rows) != 0
    h1, h2 = (N.constant(h) for h in sphere.sphere_integrals(N.base, a, point))
    f = poly.mul(N, tuple(map(N.constant, sphere.phi_poly(N.base, a))), (h2, h1))
    slope = (y1 / u1 - y2 / u2) / (u1 - u2)
    P = (N.zero, y1 / u1 - slope * u1, slope)
    U = poly.from_roots(N, (u1, u2))
    psi = poly.quotient(N, poly.sub(N, poly.mul(N, P, P), f), U)
    printed = _pencil_polynomial(N, a, (u1, u2), (p1, p2))
    assert printed == poly.neg(N, psi)
    assert printed != psi


def _pencil_polynomial(N, a, u, p):
    """(constant, A_1, A_2) of the paper, from (u, p)."""
    (u1, u2), (p1, p2) = u, p
    f1, f2, (e1, e2, e3) = _phi(N, a, u1), _phi(N, a, u2), map(N.constant, a)
    return (
        4 * e1 * e2 * e3 * (f1 * p1**2 / (u1 * (u2 - u1)) + f2 * p2**2 / (u2 * (u1 - u2))),
        (4 * u1**2 * (e1 + e2 + e3 - u1) - f1) * f1 * p1**2 / (u1**2 * (u1 - u2))
        + (4 * u2**2 * (e1 + e2 + e3 - u2) - f2) * f2 * p2**2 / (u2**2 * (u2 - u1)),
        (4 * u1**2 * (u2 - u1) - f1) * f1 * p1**2 / (u1**2 * (u1 - u2) ** 2)
        + 2 * f1 * f2 * p1 * p2 / (u1 * u2 * (u1 - u2) ** 2)
        + (4 * u2**2 * (u1 - u2) - f2) * f2 * p2**2 / (u2**2 * (u2 - u1) ** 2),
    )


@over_fields()
def test_right_as_printed_the_hat_variables(K) -> None:
    """new-u2 and new-p2: û are the roots of ρ(A_2)x² + ρ(A_1)x + …, ρ: p ↦ up, and p̂ = −ℓ(û)/φ(û)."""
    K = K()
    rng = Random(33)

    def make():
        values = [K.random(rng) for _ in range(7)]
        if len(set(values)) < 7 or K.zero in values:
            raise ZeroDivisionError
        a, x = tuple(values[:3]), Separated((values[3], values[4]), (values[5], values[6]))
        return a, x, sphere.hat(K, a, x)

    a, x, image = attempt(make)
    N = JetField(K, 0)
    (u1, u2, p1, p2), (v1, v2, q1, q2) = map(N.constant, _flat(x)), map(N.constant, _flat(image))
    f1, f2 = _phi(N, a, u1), _phi(N, a, u2)
    polynomial = _pencil_polynomial(N, a, (u1, u2), (u1 * p1, u2 * p2))
    assert poly.monic(N, polynomial) == poly.from_roots(N, (v1, v2))
    for v, q in ((v1, q1), (v2, q2)):
        assert q == -((v - u2) * f1 * p1 / (u1 - u2) + (v - u1) * f2 * p2 / (u2 - u1)) / _phi(N, a, v)


def _determinant(rows):
    if len(rows) == 1:
        return rows[0][0]
    total = 0
    for k, row in enumerate(rows):
        rest = [r[1:] for i, r in enumerate(rows) if i != k]
        total = total + (row[0] if k % 2 == 0 else -row[0]) * _determinant(rest)
    return total


@over_fields()
def test_items_27_and_28_the_hat_pair(K) -> None:
    """The printed metric belongs to Ĥ = ν1 + ν2, not to half of it; the printed K̂(u, p) is 4ν1ν2."""
    K = K()
    rng = Random(27)

    def make():
        values = [K.random(rng) for _ in range(7)]
        if K.zero in values:
            raise ZeroDivisionError
        a, x = tuple(values[:3]), Separated((values[3], values[4]), (values[5], values[6]))
        return a, x, sphere.hat_eigenvalues(K, a, x)

    a, x, nu = attempt(make)
    N = JetField(K, 0)
    (u1, u2, p1, p2), (n1, n2) = map(N.constant, _flat(x)), map(N.constant, nu)
    f1, f2, (e1, e2, e3) = _phi(N, a, u1), _phi(N, a, u2), map(N.constant, a)
    mixed = u1 * u2 * (1 / e1 + 1 / e2 + 1 / e3)
    energy = f1 * u1 * (2 * u1 + u2 - mixed) / (u1 - u2) * p1**2
    energy = energy + f2 * u2 * (u1 + 2 * u2 - mixed) / (u2 - u1) * p2**2
    assert n1 + n2 == energy
    assert (n1 + n2) / 2 != energy
    quartic = f1 * f2 / (e1 * e2 * e3) * ((u1**2 * p1 - u2**2 * p2) / (u1 - u2)) ** 2
    quartic = quartic * (f1 * u1 * p1**2 - f2 * u2 * p2**2) / (u1 - u2)
    assert quartic == 4 * n1 * n2
    assert quartic != n1 * n2


@over_fields()
def test_item_31_the_rolling_constraint_belongs_to_a_vertical_that_points_down(K) -> None:
    """The point of contact is at −rγ from the centre if γ points up, at +rγ if it points down. The body is at rest
    there, and its momentum about this point is M = Iω + d(ω − (γ, ω)γ), the M of ω = A_γM.
    """
    K = K()
    _, x = tilted_phase(K, Random(31))
    AM = x.AM
    spin = x.d * x.G * dot(x.gamma, AM)
    omega = [m + spin * a * y for m, a, y in zip(AM, x.a, x.gamma, strict=True)]
    # mass 1 and r² = d: only r·r occurs
    inertia = [1 / a - x.d for a in x.a]

    def at_contact(direction, sign):
        """(velocity of the point of contact over r, momentum about it less M), for v = sign·r ω×γ."""
        arm = [direction * y for y in x.gamma]
        velocity = [sign * y for y in _cross(omega, x.gamma)]
        slip = [v + y for v, y in zip(velocity, _cross(omega, arm), strict=True)]
        about = [-x.d * y for y in _cross(arm, velocity)]
        return slip, [i * w + y - m for i, w, y, m in zip(inertia, omega, about, x.M, strict=True)]

    zero = [0 * x.d] * 3
    assert at_contact(1, -1) == (zero, zero)
    assert at_contact(-1, 1) == (zero, zero)
    for slip, rest in (at_contact(-1, -1), at_contact(1, 1)):
        assert slip != zero
        assert rest != zero


def _cross(x, y):
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]
