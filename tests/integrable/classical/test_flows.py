"""Flows compared with an integration of the vector field, with themselves, and at far times."""

import re

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.inverse import joining
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice
from integrable.classical.veselova import Veselova
from integrable.mumford.flow import Point
from integrable.mumford.motion import Placed
from integrable.systems.on_layer import BodyOnLayer
from jacobian import CC, GF, MP, QQ, RR, ArgumentError, FieldError, NotRepresentable, PrecisionLoss
from jacobian.inexact.long_field import LongField
from tests.integrable.classical.rows import REAL, distance, extrapolated, integrated, over_cases
from tests.integrable.ways import constrained, forced, has_torus, inside

REST = Point((1.0, 0.0), (0.0, 0.0))


def error_in_many_digits(name, n, time, steps, order):
    """The error of all coordinates, signs included, relative to an integration."""
    K = MP(38)
    system, state = REAL[name](K, n)
    path = system.flow(state).at([time])
    return distance(K, (path.q[0], path.p[0]), integrated(system, state, time, steps, order))


@over_cases
def test_thirty_digits_against_an_integration(name, n) -> None:
    assert error_in_many_digits(name, n, 1.25, 8, 17) < 1e-30


@pytest.mark.slow
@over_cases
def test_thirty_digits_after_some_periods(name, n) -> None:
    assert error_in_many_digits(name, n, 10, 54, 18) < 1e-30


@pytest.mark.thinned(2)
@over_cases
@pytest.mark.parametrize("time", [1e6, *(pytest.param(t, marks=pytest.mark.slow) for t in (1e-9, -1e9, 1e15))])
def test_floats_against_forty_digits(name, n, time) -> None:
    """A run in floats is the rounded run in many digits from the same floats, at any time."""
    system, state = REAL[name](RR, n)
    path = system.flow(state).at([time])
    K = MP(40)
    fine = system.over(K)
    # the same floats, which meet |q| = 1 to their own digits only; for the ball, additions besides its own flow
    start = constrained(fine, inside(fine, state))
    exact = getattr(fine, "by_additions" if name == "ball" else "flow")(start).at([time])
    # the compiled flow of a body rounds more than once
    bound = 2e-15 if name in ("ball", "top") else 4e-16
    for a, b in ((path.q, exact.q), (path.p, exact.p)):
        assert np.abs(a - b.astype(float)).max() <= bound * np.abs(a).max()


@pytest.mark.thinned(2)
@over_cases
def test_group_property_reversal_and_integrals(name, n) -> None:
    K = MP(30)
    system, state = REAL[name](K, n)
    flow = system.flow(state)
    path = flow.at([3, 8])
    middle = system.state(path.q[0], path.p[0])
    assert distance(K, [system.flow(middle).at([5]).q[0]], [path.q[1]]) < 1e-26
    back = system.flow(system.state(path.q[0], [-x for x in path.p[0]])).at([3])
    assert distance(K, [back.q[0], [-x for x in back.p[0]]], state) < 1e-26
    for name, first in system.integrals(state).items():
        again = system.integrals(middle)[name]
        pairs = zip(again, first, strict=True) if isinstance(first, tuple) else [(again, first)]
        assert all(abs(x - y) < 1e-26 * (1 + abs(y)) for x, y in pairs), name


@pytest.mark.thinned(3)
@pytest.mark.parametrize("size", [2.0**100, 2.0**-100])
@pytest.mark.parametrize("count", [1, 24])
def test_bodies_turn_faster_in_proportion_to_their_momentum(size, count) -> None:
    """γ(t) from (γ, cM) is γ(ct) from (γ, M): the clock has no unit of its own."""
    ball, body = BodyOnLayer((1, 2, 3), 0.7), Veselova((1, 2, 3))
    for system, flow in ((body, body.flow), (ball, ball.by_additions)):
        state = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
        times = np.linspace(1, 30, count)
        path = flow(state).at(times)
        fast = flow(system.state(state.q, [size * x for x in state.p])).at(times / size)
        assert np.abs(fast.q - path.q).max() < 4e-16
        assert np.abs(fast.p / size - path.p).max() < 1e-15


@pytest.mark.parametrize("d", [1e-9, 1e-12, 1e-40])
def test_light_balls_by_additions(d) -> None:
    """The constants of the curve agree in all digits of a float: periods need as many digits more, and the clock is a
    series.
    """
    ball = BodyOnLayer((1, 2, 3), d)
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    own, other = ball.flow(state).at([10, 1e5]), ball.by_additions(state).at([10, 1e5])
    assert np.abs(own.q - other.q).max() < 2e-15
    assert np.abs(own.p - other.p).max() < 2e-15


@pytest.mark.parametrize(("d", "size", "named"), [(1e-60, 1, "d = 1e-60"), (1e40, 1, "d = 1e+40"), (0.7, 1e-150, "M")])
def test_additions_in_floats_have_the_domain_of_the_ball(d, size, named) -> None:
    ball = BodyOnLayer((1, 2, 3), d)
    state = ball.state((0.48, 0.6, 0.64), [size * x for x in (0.384, 1.28, -1.488)])
    with pytest.raises(ArgumentError, match=re.escape(named)):
        ball.by_additions(state)


ESCAPING, BOUND = ((0.0625, -0.125), (0.03125, 0.0625)), ((0.01, -0.06), (0.005, 0.01))


@pytest.mark.parametrize(
    "name", ["bound", "bound behind a barrier", "escaping", "escaping behind a barrier", "garnier"]
)
def test_many_times_are_those_one_by_one(name) -> None:
    """In genus 2 they are read off the real torus, also behind a barrier and where q_0 crosses the saddle: there a
    point passes infinity, and some roots of f are complex.
    """
    system, state = REAL["garnier"](RR, 2)
    if name != "garnier":
        system = HenonHeiles((1,), "-1/2", "-1/4", 0, ("1/512",) if "barrier" in name else (0,))
        state = system.state(*(ESCAPING if "escaping" in name else BOUND))
    flow = system.flow(state)
    times = np.linspace(-1e5, 1e5, 40)
    many = flow.at(times)
    assert has_torus(flow)
    one = forced(flow, "additions").at(times[[3, 21]])
    assert np.abs(many.q[[3, 21]] - one.q).max() < 1e-14 * np.abs(many.q).max()
    assert np.abs(many.p[[3, 21]] - one.p).max() < 1e-14 * np.abs(many.p).max()


def test_threads_may_share_a_flow(monkeypatch) -> None:
    """If two threads need a result at once, both compute it, and the results agree."""
    system, state = REAL["neumann"](RR, 2)
    flow = system.flow(state)
    with LongField(200) as K:
        alone, shared = (Placed(K, flow._place).translations() for _ in range(2))
        moved = shared._moved

        def interrupted(D, E):
            monkeypatch.setattr(shared, "_moved", moved)
            shared._double(4)
            return moved(D, E)

        monkeypatch.setattr(shared, "_moved", interrupted)
        assert [shared._double(k).u for k in (4, 5)] == [alone._double(k).u for k in (4, 5)]


def test_a_flow_at_its_start_returns_it():
    system, state = REAL["neumann"](RR, 2)
    path = system.flow(state).at(0)
    assert np.allclose(path.q[0], state.q, rtol=0, atol=2e-16)
    assert path.q.shape == (1, 3)
    assert len(path) == 1
    assert system.flow(state).at([]).p.shape == (0, 3)


@pytest.mark.parametrize(
    ("q", "p"),
    [
        (("0.6", "0.8", 0, 0), (0, 0, 1, "0.5")),  # on two coordinate planes, crossing them
        ((1, 0, 0, 0), (0, 0, 0, 0)),  # an equilibrium
        (("0.6", "0.8", 0, 0), ("0.8", "-0.6", 0, 0)),  # in the plane of two axes for ever
        (("0.6", 0, "0.8", 0), (0, 0, 0, 0)),  # from rest
        (("0.6", "0.8", 0, 0), (0, 0, 0, "1e-30")),  # nearly in a coordinate sphere
    ],
)
def test_special_positions_of_neumann(q, p) -> None:
    system = Neumann((1, 2, 4, 7))
    path = system.flow(system.state(q, p)).at([1.5, 3.0])
    fine = Neumann((1, 2, 4, 7), MP(30))
    expected = integrated(fine, fine.state(q, p), 1.5, 12, 10)
    assert distance(RR, (path.q[0], path.p[0]), [[float(x) for x in a] for a in expected]) < 1e-14


@pytest.mark.parametrize(
    ("system", "q", "p"),
    [
        (Garnier((0, 1, 3)), (0, 0, 0), (0, 0, 0)),  # at an unstable rest
        (Garnier((0, 1, 3), 1, -4), (0, 0.5, 0), (0.25, 0, 0)),  # on two coordinate planes
        (Garnier((-1, -2), 2, 1), (0.5, 0), (0, 0)),  # along one axis for ever
        (Garnier((0, 1), 1, 1), (0, 1), (0, 1)),  # from the unstable rest back to it
        (HenonHeiles((1,), "-1/2", "-1/4"), ("1/12", 0), (0, 0)),  # to the saddle
        (HenonHeiles((1,), "-1/2", "-1/4", 0, ("1/8",)), (0, 0.5), (0, 0)),  # with a barrier, from rest
        (HenonHeiles((1,)), (0, 0), (0, 0)),
        (HenonHeiles((1,), "-1/2", "-1/4"), (0.125, 0), (0, 0)),  # along q_0 for ever
        (HenonHeiles((1,), "-1/2", "-1/4"), (0.125, 0), (0, 0.25)),
        (HenonHeiles((1, 2), "-1/2", "-1/4", 0, (0, "1/8")), (0, 0, -0.5), (0.1, 0, 0)),
    ],
)
def test_special_positions_in_quartic_and_cubic_potentials(system, q, p) -> None:
    path = system.flow(system.state(q, p)).at([1.5, 3.0])
    fine = system.over(MP(30))
    expected = integrated(fine, fine.state(q, p), 1.5, 12, 10)
    assert distance(RR, (path.q[0], path.p[0]), [[float(x) for x in a] for a in expected]) < 1e-14


def test_a_cubic_potential_is_left_and_entered_again() -> None:
    """Beyond the saddle q_0 escapes to infinity in finite time and returns: the check goes around it in complex
    time.
    """
    system = HenonHeiles((1,), "-1/2", "-1/4")
    state = system.state((-1, 0.25), (-0.5, 0.25))
    path = system.flow(state).at([3.0])
    around = system.over(CC)

    def rate(z):
        found = around.vector_field(Point(tuple(z[:2]), tuple(z[2:])))
        return [*found.q, *found.p]

    z = [complex(x) for x in (*state.q, *state.p)]
    for leg in (1.5 + 1j, 1.5 - 1j):
        z = extrapolated(RR, rate, z, leg, 40, 8)
    expected = np.array(z)
    assert np.abs(expected.imag).max() < 1e-9
    assert np.abs([*path.q[0], *path.p[0]] - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize(
    ("system", "q", "p"),
    [
        (LagrangeTop("7/10"), (0, 0, 1), (0.25, 0.5, 1.5)),  # through the vertical
        (LagrangeTop("7/10"), (0, 0, -1), (0.25, 0.5, 1.5)),
        (LagrangeTop("7/10"), (0, 0, 1), (0, 0, 1.5)),  # a sleeping top
        (LagrangeTop("7/10"), (0, 0, 1), (1e-9, 0, 1.5)),  # nearly a sleeping top, which is unstable at this spin
        (LagrangeTop("7/10"), (1, 0, 0), (1, 0, 1)),  # a steady precession: the pair rests, γ turns
        (LagrangeTop("7/10"), (1, 0, 0), (1, 1e-12, 1)),
        (LagrangeTop(2), ("3/5", 0, "4/5"), (0, 0, 0)),  # in a vertical plane, to the vertical
        (SphericalPendulum(), (0, 0, -1), (0.5, 1, 0)),
        (SphericalPendulum(), (0, 0, 1), (0.5, 1, 0)),
        (SphericalPendulum(), ("3/5", 0, "4/5"), (0, 0, 0)),
        (SphericalPendulum(), ("3/5", 0, "-4/5"), (0, 0.6 * 1.25**0.5, 0)),  # conical, to the accuracy of floats
        (SphericalPendulum(), (0, 0, 1), (0, 0, 0)),
    ],
)
def test_special_positions_of_axes(system, q, p) -> None:
    path = system.flow(system.state(q, p)).at([1.5, 3.0])
    fine = system.over(MP(30))
    start = constrained(fine, inside(fine, system.state(q, p)))
    expected = integrated(fine, start, 1.5, 12, 10)
    assert distance(RR, (path.q[0], path.p[0]), [[float(x) for x in a] for a in expected]) < 2e-14


@pytest.mark.parametrize(
    ("q", "p"),
    [
        (("0.6", "0.8", 0), (0, 0, 1)),  # about an axis for ever, γ in a coordinate plane
        ((0, "0.6", "0.8"), (1, 0, 0)),
        ((1, 0, 0), (0, "0.6", "0.8")),  # from an axis
        (("0.6", "0.8", 0), ("0.8", "-0.6", 0)),
        (("0.6", "0.8", 0), (0, "1e-30", 1)),  # nearly in a plane
        pytest.param(("0.6", 0, "0.8"), (0, 1, 0), marks=pytest.mark.slow),  # near an unstable rotation
        pytest.param(("0.6", 0, "0.8"), ("1e-12", 1, "-0.75e-12"), marks=pytest.mark.slow),
    ],
)
def test_special_positions_of_veselova(q, p) -> None:
    """If an oval is a point, the clock is still a series; if the two ovals have met, the equations are integrated."""
    system, fine = Veselova((1, 2, 4)), Veselova((1, 2, 4), MP(30))
    start = constrained(fine, Point(*(tuple(map(fine.field.coerce, x)) for x in (q, p))))
    path = system.flow(system.state(*(list(map(float, x)) for x in start))).at([1.5, -1.5])
    for row, time in enumerate((1.5, -1.5)):
        expected = integrated(fine, start, time, 12, 10)
        assert distance(RR, (path.q[row], path.p[row]), [[float(x) for x in a] for a in expected]) < 1e-14


@pytest.mark.slow
def test_a_long_body_of_veselova_is_on_no_separatrix() -> None:
    """Moments with a ratio of 10^16: a branch point is close to the one where dt/dτ vanishes."""
    system = Veselova((5045965.14, 1.6859436e-09, 1.92284376e-08), field=MP(20))
    state = system.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
    run = system.flow(state).at([system.field.coerce("2.5e-8")])
    back = system.flow(Point(tuple(run.q[0]), tuple(run.p[0]))).at([system.field.coerce("-2.5e-8")])
    assert max(abs(x - y) for x, y in zip([*back.q[0], *back.p[0]], [*state.q, *state.p], strict=True)) < 1e-18
    floats = Veselova(system.constants).flow(Point(*(tuple(map(float, x)) for x in state))).at([2.5e-8])
    assert np.abs([floats.q - run.q.astype(float), floats.p - run.p.astype(float)]).max() < 1e-14


def test_times_far_along_a_separatrix_are_refused() -> None:
    system = Veselova((1, 2, 4))
    with pytest.raises(PrecisionLoss, match=r"^times: this motion is on a separatrix .* radians are more than"):
        system.flow(system.state((0.6, 0, 0.8), (0, 1, 0))).at(1e9)


def test_a_thin_body_on_a_separatrix_is_refused_at_once() -> None:
    """Found by fuzz: its equations were integrated for more than nine seconds before the refusal."""
    system = Veselova((8.340993217223296, 3.249635666372671, 1.858640602856178e-11))
    gamma, M = (
        (0.4259449041902133, 0.0, -0.9047491025662253),
        (-0.003250123504740791, 0.0115336933, -0.0015301187267349),
    )
    M = tuple(np.subtract(M, np.dot(gamma, M) * np.array(gamma)))
    with pytest.raises(PrecisionLoss, match="radians are more than the 64"):
        system.flow(system.state(gamma, M)).at(
            [-126.03097195175164, -483.63623918224937, -3837.469170389145, 69.52661470003248]
        )


def test_thirty_digits_on_a_separatrix() -> None:
    """About its middle axis a body turns uniformly; times as far as 30 were refused."""
    system = Veselova((1, 2, 4), field=MP(30))
    K, context, times = system.field, system.field.context, [30, -8, 0]
    path = system.flow(system.state(("0.6", 0, "0.8"), (0, 1, 0))).at(times)
    for time, q, p in zip(times, path.q, path.p, strict=True):
        c, s, x, z = context.cos(K.one * time / 2), context.sin(K.one * time / 2), K.coerce("0.6"), K.coerce("0.8")
        expected = (c * x - s * z, 0, s * x + c * z, 0, 1, 0)
        assert max(abs(a - b) for a, b in zip((*q, *p), expected, strict=True)) < 1e-29
    with pytest.raises(PrecisionLoss, match=r"^times: .* is within reach; this motion is on a separatrix"):
        system.flow(system.state(("0.6", 0, "0.8"), (0, 1, 0))).at(10**9)


def test_times_beyond_its_clock_are_refused() -> None:
    system = Veselova((1, 2, 4))
    with pytest.raises(PrecisionLoss, match="more than the 1e\\+100 of this clock"):
        system.flow(system.state((0.6, 0, 0.8), (0.8, 1, -0.6))).at(1e308)


@pytest.mark.parametrize("h", [1e-150, 1e-8, -1e8, 1e150])
def test_steps_along_geodesics_of_any_length_stay_on_the_ellipsoid(h) -> None:
    system = Ellipsoid((1, 2, 4))
    state = system.discrete(system.state((1, 0, 0), (0, 0.6, 0.8)), h)
    assert system.integrals(system.state(*state))["speed squared"] == pytest.approx(1, rel=1e-14)


def test_frequencies_are_those_of_small_motions() -> None:
    system = HenonHeiles.with_frequencies(1.5, 0.75)
    path = system.flow(system.state((1e-9, -1e-9), (0, 0))).at([2.0])
    assert np.abs(path.q[0] - [1e-9 * np.cos(3), -1e-9 * np.cos(1.5)]).max() < 1e-16


def test_a_coordinate_ellipse_closes() -> None:
    """In the plane of two axes for ever: once round is 4√a₂·E(1 − a₁/a₂) (Legendre)."""
    from mpmath import MPContext

    context = MPContext()
    context.dps = 30
    system = Ellipsoid((1, 2, 4))
    state = system.state((0, 2**0.5, 0), (1, 0, 0))
    length = 4 * context.sqrt(2) * context.ellipe(context.mpf(1) / 2)
    # the floats of (0, √2, 0) are projected onto the ellipsoid
    path = system.flow(state).at([float(length / 4), float(length / 2), float(length)])
    assert np.abs(path.q - [[1, 0, 0], [0, -(2**0.5), 0], [0, 2**0.5, 0]]).max() < 2e-15
    assert np.abs(path.p[2] - [1, 0, 0]).max() < 2e-15


@pytest.mark.parametrize(
    ("system", "q", "p"),
    [
        (Ellipsoid((1, 2, 4)), (3**-0.5, 0, (8 / 3) ** 0.5), (0.25, 0.5, -0.125)),  # an umbilic
        (Ellipsoid((1, 2, 4)), (3**-0.5, 0, (8 / 3) ** 0.5), (0, 1, 0)),
        (Garnier((0, 1)), (0, 1), (0.5, 0.25)),
        (HenonHeiles((1,), "-1/2", "-1/4"), (0.5, 0), (0, 0.25)),
        (Neumann((1, 2, 4)), (3**-0.5, 0, (2 / 3) ** 0.5), (0.25, 0.5, -0.125)),
        pytest.param(Veselova((1, 2, 4)), (3**-0.5, 0, (2 / 3) ** 0.5), (0.25, 0.5, -0.125), marks=pytest.mark.slow),
    ],
)
def test_both_points_of_a_pair_at_one_branch_point(system, q, p) -> None:
    """A double root of f, to rounding: the separatrix of the ellipsoid and of its relatives."""
    fine = system.over(MP(30))
    start = constrained(fine, Point(*(tuple(map(fine.field.coerce, x)) for x in (q, p))))
    path = system.flow(system.state(*(list(map(float, x)) for x in start))).at([1.5])
    expected = integrated(fine, start, 1.5, 12, 10)
    assert distance(RR, (path.q[0], path.p[0]), [[float(x) for x in a] for a in expected]) < 1e-14


@pytest.mark.parametrize("p", [(0, 1, 0), (0, "0.6", "0.8"), (0, 0, 1)])
def test_geodesics_from_the_ends_of_axes(p) -> None:
    """Two coordinates vanish, and with them two lifts."""
    system, fine = Ellipsoid((1, 2, 4)), Ellipsoid((1, 2, 4), MP(30))
    path = system.flow(system.state((1, 0, 0), p)).at([2.0])
    expected = integrated(fine, fine.state((1, 0, 0), p), 2, 16, 10)
    assert distance(RR, (path.q[0], path.p[0]), [[float(x) for x in a] for a in expected]) < 1e-14


def test_a_geodesic_on_the_triaxial_earth() -> None:
    """10 000 km and ten thousand times round, with semi-axes in km that nearly agree."""
    axes = ("40681077.7", "40680197.6", "40408308.7")
    fine = Ellipsoid(axes, MP(30))
    q, p = (("4000", "3000", "4000"), ("0.3", "0.5", "-0.8"))
    start = constrained(fine, Point(tuple(map(fine.field.coerce, q)), tuple(map(fine.field.coerce, p))))
    path = fine.flow(start).at([10000])
    assert distance(fine.field, (path.q[0], path.p[0]), integrated(fine, start, 10000, 10, 14)) < 1e-20
    system = Ellipsoid(axes)
    floats = system.flow(system.state(*(tuple(map(float, x)) for x in start))).at([4e8])
    assert abs((floats.q[0] ** 2 / np.array(axes, dtype=float)).sum() - 1) < 1e-15


@pytest.mark.parametrize("n", [2, 3, 4])
def test_the_lattice_at_rest_stays(n) -> None:
    """All gaps are closed: every point of the divisor is at a double point of the curve."""
    system = TodaLattice(n)
    path = system.flow(system.state([0] * n, [0.5] * n)).at([4.0])
    assert np.abs(path.q - 2).max() < 1e-14
    assert np.abs(path.p - 0.5).max() < 1e-14


def test_a_lattice_with_closed_gaps() -> None:
    """Opposite neighbours move like two particles: one of three points of the divisor is at a double point of the
    curve.
    """
    p = (1, -1, 1, -1)
    system = TodaLattice(4)
    path = system.flow(system.state([0] * 4, p)).at([1.5, 1e5])
    two = TodaLattice(2, MP(30))
    pair = two.flow(two.state([0, 0], [1, -1])).at([1.5, 1e5])
    assert np.abs(path.q - np.tile(pair.q.astype(float), 2)).max() < 1e-14
    assert np.abs(path.p - np.tile(pair.p.astype(float), 2)).max() < 1e-14


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Neumann((1, 1, 2)), "a = (1, 1, 2)"),
        (lambda: Neumann(3), "a = 3"),
        (lambda: Neumann((1, 2)).state((1, 0), (1, 0)), "(q, p) = 0"),
        (lambda: Neumann((1, 2)).state((1, 1), (1, -1)), "|q| = 1"),
        (lambda: Neumann((1, 2)).state((1, 0, 0), (0, 1)), "q = (1, 0, 0)"),
        (lambda: Neumann((1, 2)).state((1, "x"), (0, 1)), "q[1]"),
        (lambda: Ellipsoid((1, -2, 4)), "a = (1, -2, 4)"),
        (lambda: Ellipsoid((1, 2)).state((1, 1), (0, 1)), "Σq_i²/a_i = 1"),
        (lambda: Ellipsoid((1, 2)).state((1, 0), (1, 1)), "Σq_i p_i/a_i = 0"),
        (lambda: Ellipsoid((1, 2)).state((1, 0), (0, 0)), "p ≠ 0"),
        (lambda: Ellipsoid((1, 2)).discrete(Point((1, 0), (0, 1)), 0), "h = 0"),
        (lambda: Ellipsoid((1, 2), CC).discrete(Point((1, 0), (0, 1)), 1), "field = CC"),
        (lambda: Ellipsoid((1, 2)).step(Point((1, 0), (0, 1)), (3, 1)), "point = (3, 1)"),
        (lambda: Garnier((0, 1), 0), "alpha = 0"),
        (lambda: Garnier(()), "a = ()"),
        (lambda: HenonHeiles((1, 2), barriers=(1,)), "barriers = (1,)"),
        (lambda: HenonHeiles((1,), 0), "alpha = 0"),
        (lambda: HenonHeiles((1,), barriers=(1,)).state((1, 0), (0, 0)), "q_i ≠ 0"),
        (lambda: HenonHeiles((1,), barriers=(1,)).step(Point((1.0, 1.0), (0.0, 0.0)), (1, 1)), "barriers"),
        (lambda: LagrangeTop("x"), "j = 'x'"),
        (lambda: LagrangeTop().state((1, 1, 0), (0, 0, 0)), "|γ| = 1"),
        (lambda: SphericalPendulum().state((1, 0, 0), (1, 0, 0)), "(q, p) = 0"),
        (lambda: Veselova((1, 2)), "inertia = (1, 2)"),
        (lambda: Veselova((1, 2, 2)), "inertia = (1, 2, 2)"),
        (lambda: Veselova((1, 2, -3)), "inertia = (1, 2, -3)"),
        (lambda: Veselova((1, 2, 3, 4)), "inertia = (1, 2, 3, 4)"),
        (lambda: Veselova((1, 2, 3)).state((1, 0, 0), (1, 0, 0)), "(γ, M) = 0"),
        (lambda: Veselova((1, 2, 3)).state((1, 1, 0), (0, 0, 1)), "|γ| = 1"),
        (lambda: Veselova((1, 2, 3)).state((1, 0, 0), (0, 0, 0)), "M ≠ 0"),
        # for q and p of any size
        (lambda: Ellipsoid((40681077.7, 40680197.6, 40408308.7)).state((6371, 0, 0), (0, 0.6, 0.8)), "Σq_i²/a_i = 1"),
        (lambda: Neumann((1, 2, 4)).state((2, 0, 0), (0, 1e6, 0)), "|q| = 1"),
        (lambda: Neumann((1, 2, 4)).state((1, 0, 0), (100, 1e6, 0)), "(q, p) = 0"),
        (lambda: Veselova((1, 2, 3)).state((1, 0, 0), (1e-9, 1e-9, 0)), "(γ, M) = 0"),
        (lambda: TodaLattice(2, GF(101)).state((1, 0), (1, 1)), "e^q"),
        (lambda: Veselova((1, 2, 3)).omega("rest"), "state = 'rest'"),
        (lambda: Veselova((1, 2, 3)).flow("rest"), "state = 'rest'"),
        (lambda: Veselova((1, 2, 3), CC).flow(Point((1, 0, 0), (0, 1, 0))), "field = CC"),
        (lambda: BodyOnLayer((1, 1, 2)), "inertia = (1, 1, 2)"),
        (lambda: BodyOnLayer((1, 2)), "inertia = (1, 2)"),
        (lambda: BodyOnLayer((1, 2, 3), "x"), "d = 'x'"),
        (lambda: BodyOnLayer((1, 2, 3), -2), "d = -2.0"),
        (lambda: BodyOnLayer((1, 2, 3), 4, GF(7)), "d = 4"),
        (lambda: BodyOnLayer((1, 2, 3)).by_additions(Point((1, 0, 0), (0, 1, 0))), "d = 0"),
        (lambda: BodyOnLayer((1, 2, 3), 1).by_additions("rest"), "state = 'rest'"),
        (lambda: TodaLattice(1), "n = 1"),
        (lambda: TodaLattice(2.5), "n = 2.5"),
        (lambda: TodaLattice(2, GF(101)).state((0, 1), (1, 1)), "e^q"),
        (lambda: TodaLattice(2).flow(TodaLattice(2).state((0, 1), (1, 1))).at(float("nan")), "times[0]"),
        (lambda: TodaLattice(2).flow(TodaLattice(2).state((0, 1), (1, 1))).at(["x"]), "times[0]"),
        (lambda: TodaLattice(2, GF(101)).flow(TodaLattice(2, GF(101)).state((5, 1), (1, 1))), "GF(101)"),
        (lambda: TodaLattice(2).step(TodaLattice(2).state((0, 1), (1, 1)), (3, 1)), "point = (3, 1)"),
        (lambda: TodaLattice(2).step(TodaLattice(2).state((0, 1), (1, 1)), 3), "point = 3"),
        (lambda: Neumann((1, 2)).flow("rest"), "state = 'rest'"),
        (lambda: Neumann((1, 2)).flow(((1, 0), (0, 1))), "state = ((1, 0), (0, 1))"),
        (lambda: Neumann((1, 2, 4)).flow(Point((1, 0), (0, 1))), "state = Point(q=(1, 0), p=(0, 1))"),
        (lambda: Ellipsoid((1, 2)).integrals(3), "state = 3"),
        (lambda: Ellipsoid((1, 2)).direction("x"), "genus = 'x'"),
        (lambda: Neumann((1, 2)).direction(10**9), "genus = 1000000000"),
        (lambda: Neumann((1, 2)).over("RR"), "field = 'RR'"),
        (lambda: Neumann((1, 2)).state((1e308, 0), (1e308, 0)), "|q| = 1"),
        (lambda: Neumann((1, 2)).discrete(REST, 0), "h = 0"),
        (lambda: Neumann((1, 2)).discrete(REST, 1e-320), "h = 1e-320"),
        (lambda: Neumann((1, 2)).curve_point(REST, 9, "up"), "sign = 'up'"),
        (lambda: Neumann((1, 2)).step(REST, Neumann((1, 2)).curve_point(REST, -9), roots=3), "roots = 3"),
        (
            lambda: Neumann((1, 2)).step(REST, Neumann((1, 2)).curve_point(REST, -9), roots=(1, 2, 3)),
            "roots = (1, 2, 3)",
        ),
        (lambda: Neumann((1, 2)).step(REST, Neumann((1, 2)).curve_point(REST, -9), roots=(1, 2)), "their squares"),
        (lambda: Neumann((1, 2)).step(REST, Neumann((1, 2)).curve_point(REST, -9), roots=(1, "x")), "roots[1]"),
        (lambda: TodaLattice(2).discrete(TodaLattice(2).state((0, 1), (1, 1)), 0), "h = 0"),
        (lambda: TodaLattice(2, QQ).discrete(Point((1, 2), (1, 1)), 1), "field = QQ"),
        (lambda: Neumann((1, 2), GF(101)).discrete(Point((1, 0), (0, 1)), 1), "field = GF(101)"),
        (lambda: Neumann((1, 2), CC).discrete(REST, 1), "field = CC"),
        (lambda: joining(3, (1, 0), (0, 1)), "ellipsoid = 3"),
        (lambda: joining(Ellipsoid((1, 4), QQ), (1, 0), (0, 2)), "field = QQ"),
        (lambda: joining(Ellipsoid((1, 4), GF(101)), (1, 0), (0, 2)), "field = GF(101)"),
        (lambda: joining(Ellipsoid((1, 4), CC), (1, 0), (0, 2)), "field = CC"),
    ],
)
def test_bad_input_is_named(call, words) -> None:
    with pytest.raises((ArgumentError, FieldError)) as caught:
        call()
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("size", [2.0**-60, 1.0, 2.0**60])
def test_states_are_states_in_any_unit(size) -> None:
    system = Ellipsoid([e * size * size for e in (1, 2, 4)])
    state = constrained(Ellipsoid((1, 2, 4)), Point((0.5, 0.6, 0.9), (0.3, -0.8, 0.2)))
    assert system.state([size * x for x in state.q], state.p).p == state.p


def test_steps_along_geodesics_take_the_point_of_their_quadric() -> None:
    """The tangent meets Σy²/(a − λ) = 1 at q + hp, also backwards from the new state; all integrals are kept."""
    system, state = REAL["ellipsoid"](RR, 3)
    a, h = np.array(system.constants), 0.375
    new = system.discrete(state, h)
    ahead, behind = np.array(state.q) + h * np.array(state.p), np.array(new.q) - h * np.array(new.p)
    ratios = (np.array(new.q) / ahead) ** 2
    (x, *others) = a * (1 - 1 / ratios)
    assert np.abs(np.array(others) - x).max() < 1e-13
    assert x < 0
    assert np.abs(behind * np.sqrt(ratios) - state.q).max() < 1e-14
    for name, first in system.integrals(state).items():
        assert np.abs(np.subtract(system.integrals(new)[name], first)).max() < 1e-13
    both = [system.step(state, system.curve_point(state, x, sign)) for sign in (1, -1)]
    assert min(np.abs(np.array(found) - np.array(new)).max() for found in both) < 1e-12


@pytest.mark.parametrize("h", [1e-30, -1e-100, 1e-150])
def test_small_steps_along_geodesics_keep_their_speed(h) -> None:
    system, state = REAL["ellipsoid"](RR, 3)
    new = system.discrete(state, h)
    assert np.abs(np.subtract(new.q, state.q)).max() < 4e-16
    assert np.abs(np.subtract(new.p, state.p)).max() < 4e-16


def test_steps_to_infinity_are_refused() -> None:
    """The quadric of λ = a_i is a plane, whose points are those at infinity of the ellipsoid."""
    floats, exact = Ellipsoid((1, 2, 4)), Ellipsoid((1, 4), QQ)
    state = constrained(floats, Point((0.5, 0.6, 0.9), (0.3, -0.8, 0.2)))
    with pytest.raises(PrecisionLoss, match="special position"):
        floats.step(state, (1, 0))
    with pytest.raises(NotRepresentable, match=re.escape("point = (4, 0)")):
        exact.step(exact.state((1, 0), (0, 2)), (4, 0))


@pytest.mark.parametrize("sheet", [1, -1])
def test_discrete_time_of_the_lattice(sheet) -> None:
    """Suris's equations, all of them, for both points at infinity."""
    system, state = REAL["toda"](RR, 5)
    new = system.step(state, system.curve_point(state, 9.0), sheet)
    (q, p), (Q, P) = (tuple(map(np.array, s)) for s in (state, new))
    ahead, behind = np.roll(q, -1), np.roll(q, 1)
    if sheet == 1:
        first, second = np.exp(Q - q) + np.exp(q - np.roll(Q, 1)), np.exp(Q - q) + np.exp(ahead - Q)
    else:
        first, second = np.exp(np.roll(Q, -1) - q) + np.exp(q - Q), np.exp(Q - behind) + np.exp(q - Q)
    assert np.abs(p + 9 - first).max() < 1e-13
    assert np.abs(P + 9 - second).max() < 1e-13


def test_discretization_of_moser_and_veselov() -> None:
    """q_{k+1} + q_{k−1} ∥ A⁻¹q_k, and small steps follow the flow backwards in time."""
    system, state = REAL["neumann"](RR, 3)
    x = -50.0
    states = [state]
    for _ in range(2):
        states.append(system.step(states[-1], system.curve_point(states[-1], x, 1)))
    total = np.array(states[0].q) + np.array(states[2].q)
    ratio = total * np.sqrt(np.array(system.constants) - x) / np.array(states[1].q)
    assert np.ptp(ratio) < 1e-12 * abs(ratio[0])
    assert np.allclose(system.integrals(states[2])["F"], system.integrals(state)["F"], rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    ("make", "q", "p"),
    [
        (lambda K: Garnier((0, 1, 3), field=K), (1e200, 1, 1), (0, 0, 0)),
        (lambda K: HenonHeiles((1, 2), -0.5, -0.25, 0, field=K), (1e200, 1, 1), (0, 0, 0)),
        (lambda K: TodaLattice(2, K), (0, 800), (3000, -5000)),
        (lambda K: TodaLattice(3, K), (0, -1600, 5), (0, 1, 2)),
    ],
)
def test_what_is_beyond_floats_is_refused_by_name(make, q, p) -> None:
    system = make(RR)
    state = system.state(q, p)
    for use in (system.flow, system.spectral, system.divisor, system.integrals):
        with pytest.raises(PrecisionLoss, match=r"q, p = .*MP\(digits\)"):
            use(state)
    fine = make(MP(30))
    start = fine.state(q, p)
    assert all(map(fine.field.context.isfinite, fine.spectral(start).f))


def test_a_vector_field_beyond_floats_is_refused_by_name() -> None:
    system = Garnier((0, 1, 3))
    with pytest.raises(PrecisionLoss, match="beyond the range of"):
        system.vector_field(system.state((1e200, 1, 1), (0, 0, 0)))


def test_constraints_beyond_floats_are_refused_by_name() -> None:
    with pytest.raises(PrecisionLoss, match="beyond the range of"):
        Neumann((1, 2, 4)).state((1e200, 1e200, 0), (1e200, -1e200, 0))


@pytest.mark.parametrize("first", [0.0, 1e-60])
def test_far_along_an_unstable_plane(first) -> None:
    """A state in the plane q_1 = 0 stays there, although all nearby states leave the plane and return with another
    period. Rounding used to move it off the plane, at every precision. A state near the plane stays near up to t =
    1500.
    """
    a, alpha, beta = (0.0024411904061804155, 3.923886183455546e-05), 6.786038102469164, 0.04350103948664341
    q, p = 0.0369312856466665, -0.012792476786878755
    full, plane = Garnier(a, alpha, beta), Garnier(a[1:], alpha, beta)
    times = [-200.0, -1500.0, *([] if first else [-1939.1224864021876, 3000.0])]
    path = full.flow(full.state((first, q), (0.0, p))).at(times)
    expected = plane.flow(plane.state((q,), (p,))).at(times)
    assert np.allclose(path.q[:, 1:], expected.q, rtol=0, atol=1e-16)
    assert np.abs(path.q[:, 0]).max() < 1e-16


@pytest.mark.parametrize(("size", "times"), [(2, 3), (3, 2)])
def test_a_lattice_that_repeats_a_smaller_one_moves_as_that(size, times) -> None:
    """Most gaps are closed, and as many points of the pair are at double points of the curve, at far times too."""
    q, p = (0.3, -0.8, 0.5)[:size], (0.7, 0.2, -0.4)[:size]
    small, large = TodaLattice(size), TodaLattice(size * times)
    far = [1e5, 1e9, 1e14]
    one = small.flow(small.state(q, p)).at(far)
    many = large.flow(large.state(q * times, p * times)).at(far)
    assert np.abs(np.tile(one.p, times) - many.p).max() < 1e-14
    assert (np.abs(np.tile(one.q, times) - many.q) <= 1e-15 * np.abs(many.q)).all()
