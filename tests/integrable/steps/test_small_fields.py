"""Every step over small fields, where special positions are common: the textbook's image, or a refusal by name."""

from __future__ import annotations

from random import Random

import pytest

from integrable import ChaplyginBall, EulerTop, Tilde
from integrable.steps.translation import moving_branch_point, on_line
from jacobian import GF, NotRepresentable
from jacobian.errors import JacobianError
from tests.integrable.steps import textbook

PRIMES = (5, 7, 11)


def drawn(rng, rolls):
    """(p, inertia, d, γ, M) with three different moments, (γ, M) = 0."""
    while True:
        p = rng.choice(PRIMES)
        inertia, d = rng.sample(range(1, p), 3), rng.randrange(1, p) if rolls else 0
        gamma = [rng.randrange(p) for _ in range(3)]
        if all((x + d) % p for x in inertia) and sum(x * x for x in gamma) % p == 1:
            return p, inertia, d, gamma, [x % p for x in textbook.cross(gamma, [rng.randrange(p) for _ in range(3)])]


ADDED = {
    "two points": lambda s, r: ([r(), r()], r(1, 2, 3, -1, -2)),
    "one point": lambda s, r: ([r()], r(1, 2, 3, -1, -2)),
    "h1/h2": lambda s, r: ([r(), moving_branch_point], 1),
    "a fixed curve": lambda s, r: ([r(), on_line(r(), r())], 1),
    "(1/d, 0)": lambda s, r: ([s.field.inv(s.d)], 1),
    "keyless": lambda s, r: ([s.field.inv(s.d)], 1),
    "multiplication": lambda s, r: (None, r(-1, 2, 3, -3)),
}


@pytest.mark.thinned(4)
@pytest.mark.parametrize("name", ADDED)
@pytest.mark.parametrize("share", [2, pytest.param(1, marks=pytest.mark.slow)])
def test_images_of_bodies_are_sums_of_the_textbook(name, share) -> None:
    # the two 2-torsion maps need three more roots in the field
    rng, right, refused, wanted = Random(name), 0, 0, (10 if name in ("(1/d, 0)", "keyless") else 20) // share
    while right < wanted:
        rolls = name in ("one point", "(1/d, 0)", "keyless") or rng.random() < 0.5
        p, inertia, d, gamma, M = drawn(rng, rolls)
        K = GF(p)
        system = ChaplyginBall(inertia, d, field=K) if d else EulerTop(inertia, field=K)
        points, m = ADDED[name](system, lambda *among, rng=rng, p=p: rng.choice(among or range(p)))
        try:
            state = system.state(gamma, M)
            if points is None:
                image, count = system.multiplication(m)(state), abs(m) - 1
            else:
                step = system.keyless() if name == "keyless" else system.translation(points, multiple=m)
                image, count = step(state), abs(m)
        except JacobianError:
            refused += 1
            continue
        body, f = textbook.Body(p, inertia, d), textbook.Body(p, inertia, d).curve(gamma, M)
        assert body.energies(image.gamma, image.M) == body.energies(gamma, M)
        start = body.pair(gamma, M, state.g)
        if name == "keyless":
            # for singular curves too
            move = [-points[0] % p, 1], [0]
        else:
            move = start if points is None else _pair(system.translation(points).divisor(state))
        move = textbook.opposite(p, move) if m < 0 else move
        total = textbook.opposite(p, start) if points is None and m < 0 else start
        for _ in range(count):
            # None: a partial sum has fewer points, from which nothing follows for the whole sum
            total = total and textbook.sum_of(p, f, total, move)
        if total is not None:
            assert body.pair(image.gamma, image.M, image.g) == total
            right += 1
    assert refused


def _pair(D):
    return [int(x) for x in D.u], [int(x) for x in D.v]


def test_conic_steps_are_members_of_the_pencil() -> None:
    """The remaining zeros of y − P for P = V + cU through (x0, y0); or a refusal where U(x0) = 0 or a point is at
    infinity.
    """
    rng, right, refused = Random(1), 0, 0
    while right < 150 or refused < 20:
        p, inertia, _, gamma, M = drawn(rng, False)
        system = EulerTop(inertia, field=GF(p))
        x0, y0 = rng.choice((None, rng.randrange(p))), rng.randrange(p)
        body = textbook.Body(p, inertia, 0)
        (u, v), f = body.pair(gamma, M, None), body.curve(gamma, M)
        members = []
        for c in range(p):
            P = textbook.less(p, v, [-c * x for x in u])
            if c == y0 if x0 is None else textbook.at(p, u, x0) and textbook.at(p, P, x0) == y0:
                members.append(textbook.member(p, f, (u, v), P))
        try:
            image = system.conic(x0, y0)(system.state(gamma, M))
        except NotRepresentable:
            assert members in ([], [None])
            refused += 1
            continue
        except JacobianError:
            continue
        assert [body.pair(image.gamma, image.M, None)] == members
        assert tuple(M) == image.M
        right += 1


def test_the_conic_step_to_a_point_at_infinity_is_refused_by_name() -> None:
    top = EulerTop((18, 13, 33), field=GF(499))
    with pytest.raises(NotRepresentable, match="point at infinity"):
        top.conic(390, 261)(top.state((403, 138, 458), (219, 424, 391)))


@pytest.mark.parametrize(("points", "multiple", "words"), [((489, 458), -2, "H2 = d·H1"), ((65, 454), 2, "ũ1 = ũ2")])
def test_points_that_no_state_of_a_deformation_has_are_refused_by_name(points, multiple, words) -> None:
    tilde = Tilde((24, 38, 22), 19, field=GF(499))
    with pytest.raises(NotRepresentable, match=words):
        tilde.translation(points, multiple=multiple)(tilde.state((39, 151, 103), (9, 379, 95)))


def test_images_of_deformations_are_chords_and_tangents() -> None:
    """Both points of the image are those of the state after m additions of (x', ±Y')."""
    rng, right, refused = Random(1), 0, 0
    while right < 60:
        p, inertia, d, gamma, M = drawn(rng, rng.random() < 0.5)
        K = GF(p)
        system = Tilde(inertia, d, field=K)
        points, m = [rng.choice((None, *range(p))) for _ in range(2)], rng.choice((1, 2, -2, 3, 5, -1))
        try:
            step, once = (system.translation(points, multiple=n) for n in (m, 1 if m > 0 else -1))
            state = system.state(gamma, M)
            image = step(state)
            added = once.divisor(state)
        except JacobianError:
            refused += 1
            continue
        assert system.integrals(image) == system.integrals(state)
        for before, after, D in zip(*map(system.divisor, (state, image)), added, strict=True):
            e, P, Q, R = _roots(p, D), *map(_point, (before, after, D))
            for _ in range(abs(m)):
                P = textbook.added(p, e, P, R)
            assert P == Q
        right += 1
    assert refused


def _point(D):
    """(Z, Y) of a divisor on an elliptic curve, None for infinity."""
    return None if len(D.u) == 1 else (int(-D.u[0]) % D.jacobian.field.order, int(D.v[0]) if D.v else 0)


def _roots(p, D):
    return [z for z in range(p) if textbook.at(p, D.jacobian.curve.f, z) == 0]
