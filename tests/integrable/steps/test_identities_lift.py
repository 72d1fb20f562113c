"""The signs: the lift of the sum at every branch point, its matrix, and the D' that have a lift."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.phase import coordinates, separation
from integrable.phase.brackets import canonical_matrix, jacobian_matrix, over, pushed
from integrable.phase.jets import JetField
from integrable.phase.separation import Separated
from jacobian import NotASquare, NotRepresentable, SingularCurve, poly
from jacobian.relatives.formal_sum import intersection
from tests.integrable.exact_points import (
    attempt,
    cross,
    dot,
    evaluate,
    over_fields,
    phase,
    random_case,
    wrapped,
)

KINDS = pytest.mark.parametrize("kind", ["ball", "top"])


class SignLaw:
    """Tuples (U, V; s_e), s_e² = U(e) at e = a_i and, at d ≠ 0, 1/d, added by the printed law of the signs."""

    def __init__(self, K, rng, kind) -> None:
        system, state = random_case(K, rng, kind)
        self.system, self.N = system, JetField(K, 0)
        self.x = phase(system, state)
        self.h1, self.h2 = self.x.H
        self.curve = system.curve(self.h1.value, self.h2.value)
        self.group = system.group(self.h1.value, self.h2.value)
        self.f = wrapped(system, self.curve.f)
        self.points = self.x.a if kind == "top" else (*self.x.a, 1 / self.x.d)

    def random(self, rng):
        """The double of a random divisor, with either sign at every e."""
        P, Q = self.curve.random_point(rng), self.curve.random_point(rng)
        D = 2 * self.group.from_points([(P.x, P.y), (Q.x, Q.y)])
        if len(D.u) != 3:
            raise NotRepresentable("weight below two")
        u, v = wrapped(self.system, D.u), wrapped(self.system, D.v)
        return u, v, tuple(rng.choice((1, -1)) * self.N.sqrt(evaluate(u, e)) for e in self.points)

    def cubic(self, D, E):
        """P through D and E, twice through D where they are equal."""
        first, second = (self.group.from_mumford(*(tuple(y.value for y in x) for x in X[:2])) for X in (D, E))
        found = intersection(first, second)
        if len(found.P) != 4 or len(found.fibres) != 1:
            raise NotRepresentable("the sum has weight below two")
        return wrapped(self.system, found.P)

    def add(self, D, E):
        N, P = self.N, self.cubic(D, E)
        b3 = P[3]
        square = poly.sub(N, poly.mul(N, P, P), self.f)
        u, rest = poly.divide(N, square, poly.scale(N, b3 * b3, poly.mul(N, D[0], E[0])))
        assert rest == ()
        s = tuple(evaluate(P, e) / (b3 * x * y) for e, x, y in zip(self.points, D[2], E[2], strict=True))
        return u, poly.neg(N, poly.mod(N, P, u)), s

    def negate(self, D):
        return D[0], poly.neg(self.N, D[1]), D[2]

    def fifth(self, D):
        """s_ζ = Res(U, V)/(4dh2s_1s_2s_3s_{1/d}), ζ = h1/h2."""
        u, (v0, v1), s = D[0], D[1], D[2]
        resultant = v1 * v1 * u[0] - v0 * v1 * u[1] + v0 * v0
        return resultant / (4 * self.x.d * self.h2 * s[0] * s[1] * s[2] * s[3])


def law_case(K, seed, kind, count):
    rng = Random(seed)

    def make():
        law = SignLaw(K, rng, kind)
        return law, [law.random(rng) for _ in range(count)]

    return make


@over_fields()
@KINDS
def test_the_lift_law_is_a_commutative_group_law(K, kind) -> None:
    """s_e'' = P(e)/(b3s_es'_e), s_e''² = U''(e), at all of a_i and 1/d: associative, commutative, inverse
    (−D, s), doubling; on divisors the sum of the group, at d = 0 that of the generalized Jacobian.

    s ↦ −s turns it into the law with "−". For the continuous one of the two see test_the_continuous_choice_of_signs.
    """
    make = law_case(K(), 21, kind, 3)

    def attempted():
        law, (A, B, C) = make()
        total = law.add(A, B)
        sums = (law.add(total, C), law.add(A, law.add(B, C)))
        double = law.add(A, A)
        return law, (A, B), total, sums, (law.add(double, B), law.add(A, total)), law.add(total, law.negate(B))

    law, (A, B), total, sums, doubles, back = attempt(attempted)
    assert law.add(B, A) == total
    assert sums[0] == sums[1]
    assert doubles[0] == doubles[1]
    assert back == A
    assert [s * s for s in total[2]] == [evaluate(total[0], e) for e in law.points]
    first, second = (law.group.from_mumford(*(tuple(y.value for y in x) for x in D[:2])) for D in (A, B))
    E = first + second
    assert (wrapped(law.system, E.u), wrapped(law.system, E.v)) == total[:2]


@over_fields()
def test_the_fifth_root_adds_like_the_others(K) -> None:
    """s_ζ = Res(U, V)/(4dh2s_1s_2s_3s_{1/d}), squared U(ζ), and s_ζ'' = P(ζ)/(b3s_ζs_ζ') with the same P."""
    make = law_case(K(), 22, "ball", 2)

    def attempted():
        law, (A, B) = make()
        return law, A, B, law.cubic(A, B), law.add(A, B), [law.fifth(D) for D in (A, B, law.add(A, B))]

    law, A, _, P, total, roots = attempt(attempted)
    zeta = law.h1 / law.h2
    assert roots[0] ** 2 == evaluate(A[0], zeta)
    assert roots[2] ** 2 == evaluate(total[0], zeta)
    assert roots[2] == evaluate(P, zeta) / (P[3] * roots[0] * roots[1])


@over_fields()
@KINDS
def test_the_matrix_of_every_axis(K, kind) -> None:
    """Γ̃_i = (n_i + L(a_i)Γ_i)/(b3s'_i), ñ_i = −b3s'_iΓ_i + (b3a_i + β̃)Γ̃_i, β̃ from (Γ̃, ñ) = 0: a matrix of
    determinant 1 on every axis, |Γ̃| = 1, and the image of the step up to the sign of each axis.
    """
    K = K()
    rng = Random(23)

    def make():
        system, state = random_case(K, rng, kind)
        step = system.translation([K.random(rng), K.random(rng)], multiple=2)
        return system, state, step, step(state)

    system, state, step, image = attempt(make)
    N = JetField(K, 0)
    pairs, after = ([wrapped(system, q) for q in coordinates.to_pairs(system.body, y)[:3]] for y in (state, image))
    u, v = (wrapped(system, q) for q in coordinates.to_mumford(system.body, coordinates.to_pairs(system.body, state)))
    move, x = step.divisor(state), phase(system, state)
    u1 = wrapped(system, move.u)
    P = wrapped(system, intersection(system.divisor(state), move).P)
    L = poly.quotient(N, poly.sub(N, P, v), u)
    b3 = L[1]
    s = [N.sqrt(evaluate(u1, e)) for e in x.a]
    upper = [(evaluate(L, e) / (b3 * t), 1 / (b3 * t)) for e, t in zip(x.a, s, strict=True)]
    # Γ and n are r times the coordinates of the pairs
    Gamma = [a * sigma + b * nu for (a, b), (sigma, nu) in zip(upper, pairs, strict=True)]
    assert dot(x.A, [y * y for y in Gamma]) == 1
    plain = [-b3 * t * sigma + b3 * e * y for t, (sigma, _), e, y in zip(s, pairs, x.a, Gamma, strict=True)]
    beta = -sum(A * y * z for A, y, z in zip(x.A, Gamma, plain, strict=True))
    for i, (a, b) in enumerate(upper):
        c, d = -b3 * s[i] + (b3 * x.a[i] + beta) * a, (b3 * x.a[i] + beta) * b
        assert a * d - b * c == 1
        sigma, nu = pairs[i]
        found = a * sigma + b * nu, c * sigma + d * nu
        assert found in (after[i], tuple(-y for y in after[i]))


@over_fields()
@KINDS
def test_images_are_divisor_sums(K, kind) -> None:
    """The lift is Poisson (test_canonical_steps), preserves all integrals, and equals the divisor sum."""
    K = K()
    rng = Random(24)

    def make():
        system, state = random_case(K, rng, kind)
        step = system.translation([K.random(rng), K.random(rng)])
        return system, state, step, step(state)

    system, state, step, image = attempt(make)
    assert system.divisor(image) == system.divisor(state) + step.divisor(state)
    assert system.integrals(image) == system.integrals(state)


@over_fields()
@KINDS
def test_the_conjugate_pair(K, kind) -> None:
    """D' = {x' = ±iη, conjugate y'}, U' = x² + η²: canonical, H1 and H2 kept."""
    K = K()
    rng = Random(25)
    assert not K.is_square(K.neg(K.one))

    def image(N, system, x, eta):
        moved, point = over(system, N), Separated((x[0], x[1]), (x[2], x[3]))
        h1, h2 = separation.integrals(moved.body, point)
        f, square = [N.coerce(c) for c in moved.body.polynomial(h1, h2)], N.constant(K.mul(eta, eta))
        f += [N.zero] * (6 - len(f))
        # f(iη) = re + iη·im = (α + iηβ)²
        re = f[0] - f[2] * square + f[4] * square * square
        im = f[1] - f[3] * square + f[5] * square * square
        alpha = N.sqrt((re + N.sqrt(re * re + square * im * im)) / 2)
        beta = im / (2 * alpha)
        assert alpha * alpha - square * beta * beta == re
        group = moved.group(h1, h2)
        D = group.from_mumford(*separation.separated_to_mumford(moved.body, point))
        total = D + group.from_mumford((square, N.zero, N.one), (alpha, beta))
        after = separation.of_mumford(moved.body, total.u, total.v)
        return (*after.u, *after.p), separation.integrals(moved.body, after), (h1, h2)

    def make():
        system, state = random_case(K, rng, kind)
        eta, point = K.random(rng), system.separated(state)
        start = (*point.u, *point.p)
        rows = jacobian_matrix(K, lambda N, x: image(N, system, x, eta)[0], start)
        return rows, image(JetField(K, 0), system, wrapped(system, start), eta)

    rows, (_, after, before) = attempt(make)
    assert pushed(K, rows, canonical_matrix(K)) == canonical_matrix(K)
    assert after == before


@pytest.mark.thinned(3)
@over_fields()
@KINDS
def test_which_images_are_over_the_field(K, kind) -> None:
    """(γ̃, M̃) is over the field iff U'(e) is a square at every a_i and, where g̃ is asked for, at 1/d; always
    for D' = [2]E.
    """
    K = K()
    rng = Random(26)
    seen = set()
    for _ in range(400):
        system, state = random_case(K, rng, kind)
        h1, h2 = system.integrals(state)[2:]
        points = [K.random(rng), K.random(rng)]
        f = system.body.polynomial(h1, h2)
        values = [poly.evaluate(K, f, e) for e in points]
        if K.zero in values or not all(map(K.is_square, values)) or points[0] == points[1]:
            continue
        branch = system.a if kind == "top" else (*system.a, K.inv(system.d))
        wanted = all(K.is_square(poly.evaluate(K, poly.from_roots(K, points), e)) for e in branch)
        found = _is_over_the_field(system.translation(points), state)
        if found is None:
            continue
        assert found == wanted
        seen.add(found)
        assert _is_over_the_field(system.translation(points, multiple=2), state) is not False
    assert seen == {True, False}


def _is_over_the_field(step, state):
    """Whether the image is over the field; None at a special position."""
    try:
        image = step(state)
    except NotASquare:
        return False
    except (NotRepresentable, SingularCurve, ZeroDivisionError):
        return None
    after, before = step.system.integrals(image), step.system.integrals(state)
    assert after == (before if step.system.field.exact else pytest.approx(before, abs=1e-12))
    return True


@pytest.mark.parametrize("kind", ["ball", "top"])
def test_which_images_are_real(kind) -> None:
    """U'(a_i) > 0: both x' beyond 1/d, both on one oval, or a conjugate pair; no other pair of points."""
    system = ChaplyginBall((3, 2, 1), 0.7) if kind == "ball" else EulerTop((3, 2, 1))
    state = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    h1, h2 = system.integrals(state)[2:]
    (a1, a2, a3), zeta = system.a, h1 / h2
    lower, upper = (a1, min(zeta, a2)), (max(zeta, a2), a3)
    places = {name: [x + t * (y - x) for t in (0.3, 0.6)] for name, (x, y) in (("1", lower), ("2", upper))}
    if kind == "ball":
        places["beyond"] = [1 / 0.7 + 0.3, 1 / 0.7 + 1]
    for first, second in product(places, repeat=2):
        step = system.translation([places[first][0], places[second][1]])
        assert (_is_over_the_field(step, state) is True) == (first == second)
    assert _is_over_the_field(system.translation([0.4 + 0.1j, 0.4 - 0.1j]), state) is True
    for name in places if kind == "ball" else ():
        assert (_is_over_the_field(system.translation(places[name][:1]), state) is True) == (name == "beyond")


# --- the 2-torsion map


@over_fields()
def test_the_keyless_map_written_out(K) -> None:
    """e = w/|M|, γ̃_i = σ_ie_i/(g̃r_i), M̃ = |M| γ̃ × (σ_ig r_iγ_i), Γ̃ = σe; B² = (−γ, M), B⁴ = id, on
    divisors an involution.
    """
    K = K()
    rng = Random(27)

    def make():
        system, state = random_case(K, rng, squares=True)
        return system, state, [(s, system.keyless(s)(state)) for s in product((1, -1), repeat=3)]

    system, state, images = attempt(make)
    x = phase(system, state)
    r, (_, h2) = [x.g.field.sqrt(A) for A in x.A], x.H
    size = x.g.field.sqrt(h2)
    for signs, image in images:
        y = phase(system, image)
        assert [y.g * t * e for t, e in zip(r, y.gamma, strict=True)] == [
            sign * e / size for sign, e in zip(signs, x.w, strict=True)
        ]
        other = [sign * x.g * t * e for sign, t, e in zip(signs, r, x.gamma, strict=True)]
        assert tuple(size * e for e in cross(y.gamma, other)) == y.M
        step = system.keyless(signs)
        twice = step(image)
        assert (twice.gamma, twice.M) == (tuple(map(K.neg, state.gamma)), state.M)
        assert step(step(twice)) == state
        assert system.divisor(twice) == system.divisor(state) != system.divisor(image)
